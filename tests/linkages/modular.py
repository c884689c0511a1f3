"""Robots of two platforms on a chain whose legs have linkages of the shipped specs, after a joint that turns them, and joints in series."""

import re
from pathlib import Path

import numpy as np

SPECS = Path(__file__).parents[2] / "specs"
FUNCTIONS = ("adapt", "foot_positions", "platform_poses", "inverse", "inverse_near")
YAW = """[[leg_designs.{name}.joints]]
name = "yaw"
type = "revolute"
a = 0.0
alpha_deg = 0
d = 0.0
limits = [-0.8, 0.8]
[leg_designs.{name}.links.frame]"""
HEAD = """walkgen = 1
{parameters}
[robot]
name = "modular"
gravity = [0.0, 0.0, -9.81]
[generate]
functions = {functions}
targets = ["c", "numpy"]
[adapt]
clearance = 0.25
[chain_designs.waist]
dh = "classic"
joints = [
  {{ name = "yaw", type = "revolute", a = 0.10, alpha_deg = 90, d = 0.0, limits = [-0.4, 0.4] }},
  {{ name = "pitch", type = "revolute", a = 0.0, alpha_deg = 90, d = 0.0, theta_deg = 90, limits = [-0.4, 0.4] }},
  {{ name = "roll", type = "revolute", a = 0.0, alpha_deg = 0, d = 0.25, limits = [-0.4, 0.4] }},
]
[leg_designs.serial]
dh = "classic"
joints = [
  {{ name = "yaw", type = "revolute", a = 0.05, alpha_deg = 90, d = 0.0, limits = [-0.7, 0.7] }},
  {{ name = "thigh", type = "revolute", a = 0.2, alpha_deg = 0, d = 0.0, limits = [-0.4, 1.4] }},
  {{ name = "shank", type = "revolute", a = 0.25, alpha_deg = 0, d = 0.0, limits = [-2.5, -0.7] }},
]
"""
PLATFORMS = """
[[platforms]]
name = "front"
[[platforms]]
name = "rear"
parent = "front"
chain = "waist"
root = { xyz = [-0.30, 0.0, 0.0], rpy_deg = [0, 0, 180] }
end = { xyz = [0.05, 0.02, 0.01], rpy_deg = [5, -10, 0] }
"""
LEG = """[[legs]]
name = "{name}"
design = "{design}"
platform = "{platform}"
mount = {{ xyz = {xyz}, rpy_deg = [0, 0, {turn}] }}
"""
WEIGHTS = (1.0, 4.0, 20.0, 0.25)


def _shipped(spec):
    """The tables of a shipped spec's leg designs."""
    text = (SPECS / f"{spec}.toml").read_text(encoding="utf-8")
    return text[text.index("[leg_designs") : text.index("[[platforms]]")]


def five_bar():
    """Minitaur's, in an upright plane; the parameter `rod` is the length of both rods."""
    text = _shipped("minitaur").replace("plane = { xyz = [0.0, 0.0, -0.03] }", "plane = { xyz = [0.03, 0.0, 0.0], rpy_deg = [90, 0, 0] }")
    text = text.replace("P = [0.0, 0.2]", 'P = [0.0, "rod"]')
    return _limited(_yawed(text, "five_bar"), {"right": "[1.6, 2.9]", "left": "[1.6, 2.9]"})


def pantograph():
    return _yawed(_shipped("pantograph"), "pantograph")


def bessonov(crank):
    """With these limits of its crank."""
    return _limited(_shipped("bessonov"), {"crank": crank})


def garrec():
    """Its one drive behind a joint that turns and one that slides: its rows take a search, adaption goes on without them."""
    slide = '[[leg_designs.garrec.joints]]\nname = "slide"\ntype = "prismatic"\na = 0.02\nalpha_deg = 20\nd = 0.1\nlimits = [-0.1, 0.1]\n'
    yaw = "d = 0.0\nlimits = [-0.5, 0.5]\n"
    return _shipped("garrec").replace("d = 0.0\n", f"{yaw}{slide}", 1)


def with_ankle():
    """The pantograph whose foot hangs on a joint behind it."""
    after = (
        'dh = "classic"\nlinkage_end = { point = "shank.F", xyz = [0.01, -0.02, 0.03], rpy_deg = [20, 70, 0] }\n'
        "foot = { xyz = [0.01, 0.02, -0.15] }\n"
        'joints_after = [{ name = "ankle", type = "revolute", a = 0.02, alpha_deg = 10, d = 0.01, limits = [-0.6, 0.6] }]'
    )
    return _shipped("pantograph").replace('foot = "shank.F"', after, 1)


def _yawed(text, name):
    return text.replace("foot =", 'dh = "classic"\nfoot =', 1).replace(f"[leg_designs.{name}.links.frame]", YAW.format(name=name), 1)


def _limited(text, limits):
    for name, own in limits.items():
        text = text.replace(f'name = "{name}"\n', f'name = "{name}"\nlimits = {own}\n', 1)
    return text


def robot(designs, legs, functions=FUNCTIONS, parameters=""):
    """The spec; `legs` are name, design, platform, place and turn."""
    head = HEAD.format(functions=re.sub("'", '"', str(list(functions))), parameters=parameters)
    rows = (LEG.format(name=name, design=design, platform=on, xyz=xyz, turn=turn) for name, design, on, xyz, turn in legs)
    return f"{head}{''.join(designs)}{PLATFORMS}{''.join(rows)}"


def three(design, name):
    """A robot of one leg in series in front, and two with the linkage behind."""
    sides = (("left", "[0.0, 0.2, 0.0]", 90), ("right", "[0.0, -0.2, 0.0]", -90))
    rear = [(f"rear_{side}", name, "rear", place, turn) for side, place, turn in sides]
    return robot([design], [("front_left", "serial", "front", "[0.1, 0.2, 0.0]", 90), *rear])


def mixed():
    """Two kinds of linkages and joints in series behind, one leg in front."""
    legs = [
        ("front_left", "five_bar", "front", "[0.1, 0.2, 0.0]", 90),
        ("rear_left", "pantograph", "rear", "[0.0, 0.2, 0.0]", 90),
        ("rear_right", "five_bar", "rear", "[0.0, -0.2, 0.0]", -90),
        ("rear_back", "serial", "rear", "[-0.1, 0.0, 0.0]", 180),
    ]
    return robot([five_bar(), pantograph()], legs, parameters="[parameters]\nrod = { value = 0.2, runtime = true }")


def criterion(robot, q, targets, weights=WEIGHTS):
    """Phi of theory note 1, section 3.3, by the robot's platforms; every foot but the first stands on the second one."""
    limited = np.isfinite(robot.limits).all(axis=1)
    low, high = robot.limits[limited].T
    share = (2.0 * q[limited] - low - high) / (high - low)
    normal = np.linalg.svd(targets - targets.mean(axis=0))[2][-1]
    pose, normal = robot.platform_poses(q)[1], normal * np.sign(normal[2])
    height = normal @ (pose[:3, 3] - targets[1:].mean(axis=0)) - weights[3]
    return weights[0] * share @ share + weights[1] * (1 - normal @ pose[:3, 2]) + weights[2] * height**2


def walking():
    """The robot of the tests of walks on Bessonov's legs, which yaw freely there, with a crawl."""
    text = (SPECS.parent / "tests" / "gait" / "duo.toml").read_text(encoding="utf-8")
    legs = bessonov("[0.4, 2.6]").replace("d = 0.0\n", "d = 0.0\nlimits_deg = [-70, 70]\n", 1)
    head, chains = text[: text.index("[leg_designs.leg]")], text[text.index("[chain_designs.waist]") : text.index("[[terrain]]")]
    sides = ("front_left", 0.0, 0.22), ("front_right", 0.0, -0.22), ("rear_left", -0.6, 0.22), ("rear_right", -0.6, -0.22)
    stance = ", ".join(f"{name} = [{x}, {y}, -0.585]" for name, x, y in sides)
    gait = f"""[gait.crawl]
kind = "crawl"
period = 2.0
stride = 0.12
lift = 0.02
left = ["front_left", "rear_left"]
right = ["front_right", "rear_right"]
stance = {{ {stance} }}
"""
    return f"{head}{legs}{chains}{gait}".replace('design = "leg"', 'design = "bessonov"').replace("[parameters]\nl = 0.3\n", "")
