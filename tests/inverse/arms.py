"""Arms of four to seven joints, and legs on modules whose routes from the first platform have six and seven, in one robot."""

import numpy as np
from sequences import design, head, row

from oracles.screws import route, screws
from oracles.walker import read

FUNCTIONS = ("inverse_near", "inverse_pose", "inverse_admissible", "within_limits", "foot_pose")
MODULES = """
[chain_designs.waist]
dh = "classic"
joints = [
  { name = "yaw", type = "revolute", a = 0.10, alpha_deg = 90, d = 0.0, limits = [-0.8, 0.8] },
  { name = "pitch", type = "revolute", a = 0.0, alpha_deg = 90, d = 0.0, theta_deg = 90, limits = [-0.6, 0.6] },
  { name = "roll", type = "revolute", a = 0.0, alpha_deg = 0, d = 0.25, limits = [-0.7, 0.7] },
]
[chain_designs.slide]
dh = "classic"
joints = [{ name = "out", type = "prismatic", a = 0.0, alpha_deg = 30, d = 0.2, limits = [-0.1, 0.3] }]
[[platforms]]
name = "middle"
parent = "body"
chain = "waist"
root = { xyz = [-0.3, 0.0, 0.1], rpy_deg = [0, 10, 180] }
end = "level"
end_xyz = [-0.3, 0.0, 0.0]
[[platforms]]
name = "rear"
parent = "middle"
chain = "slide"
root = { xyz = [-0.3, 0.1, 0.0], rpy_deg = [0, 90, 0] }
end = { xyz = [0.1, 0.0, 0.2], rpy_deg = [5, 0, 0] }
"""


def arm(name, kinds, twists, seed, *, limited=False, platform="body"):
    """A limb of random lengths; its joints within +-1.5 rad or +-0.25 m where limited."""
    rng = np.random.default_rng(seed)
    rows = []
    for kind, twist in zip(kinds, twists, strict=True):
        a, d, theta = (round(float(value), 3) for value in rng.uniform((0.05, -0.2, -90), (0.35, 0.2, 90)))
        limit = ("limits = [-1.5, 1.5]" if kind == "r" else "limits = [-0.25, 0.25]") if limited else ""
        rows.append(row(kind, a, f"alpha_deg = {twist}", d, theta, limit))
    text = design(name, rows, "0.05, 0.02, 0.1", "xyz = [0.1, 0.2, -0.1], rpy_deg = [10, 20, 30]")
    return text.replace('platform = "body"', f'platform = "{platform}"')


def wrist():
    """Three joints, then three whose axes meet."""
    shoulder = [
        row("r", 0.0, "alpha_deg = -90", 0.2, 0.0),
        row("r", 0.4, "alpha_deg = 0", 0.1, 0.0),
        row("r", 0.02, "alpha_deg = 90", 0.0, 90.0),
    ]
    hand = [
        row("r", 0.0, "alpha_deg = -90", 0.38, 0.0),
        row("r", 0.0, "alpha_deg = 90", 0.0, 0.0),
        row("r", 0.0, "alpha_deg = 0", 0.0, 0.0),
    ]
    return design("wrist", shoulder + hand, "0, 0, 0.1")


ARMS = {
    "four": arm("four", "rrrr", (90, 0, -90, 30), 1),
    "four_limited": arm("four_limited", "rrrr", (90, 0, -90, 30), 1, limited=True),
    "four_mixed": arm("four_mixed", "rprr", (90, -60, 90, 0), 2, limited=True),
    "five": arm("five", "rrrrr", (90, 0, 0, -90, 45), 3, limited=True),
    "six": arm("six", "rrrrrr", (70, -20, 90, 35, -80, 0), 4),
    "six_limited": arm("six_limited", "rrrrrr", (70, -20, 90, 35, -80, 0), 4, limited=True),
    "six_mixed": arm("six_mixed", "rrprrp", (90, 0, 90, -90, 90, 30), 5, limited=True),
    "wrist": wrist(),
    "seven": arm("seven", "rrrrrrr", (-90, 90, -90, 90, -90, 90, 0), 6, limited=True),
}
ROUTED = {
    "middle_three": arm("middle_three", "rrr", (90, 0, 0), 7, limited=True, platform="middle"),
    "rear_three": arm("rear_three", "rrp", (90, 40, 0), 8, limited=True, platform="rear"),
}
FEW = ("four", "four_mixed", "six_limited", "wrist", "seven", *(f"root_to_{name}" for name in ROUTED))
"""Owners that the ordinary run builds: four to seven joints, turning and sliding, with limits and without, routes."""


def spec(path):
    """With the few, or with all where this path is another."""
    arms = [text for name, text in ARMS.items() if name in FEW or path not in FEW]
    return head("arms", FUNCTIONS) + MODULES + "\n".join([*arms, *ROUTED.values()])


WALKER = read(spec("all"))
PATHS = {limb.name: screws(limb) for limb in WALKER.legs if limb.name in ARMS} | {f"root_to_{name}": route(WALKER, name) for name in ROUTED}
