"""Robots of elastic links as spec text: the stands of the theory's oracles, and random ones of any convention."""

from collections.abc import Sequence

import numpy as np

SECTIONS = """
[sections]
upper = { E = 70e9, G = 26e9, A = 4e-4, Iy = 3e-8, Iz = 6e-8, J = 5e-8 }
middle = { E = 70e9, G = 26e9, A = 3e-4, Iy = 1.5e-8, Iz = 4e-8, J = 3e-8 }
lower = { E = 70e9, G = 26e9, A = 2e-4, Iy = 0.8e-8, Iz = 2e-8, J = 1.5e-8 }
waist = { E = 70e9, G = 26e9, A = 9e-4, Iy = 20e-8, Iz = 25e-8, J = 30e-8 }
"""
HEAD = 'walkgen = 1\n[robot]\nname = "bench"\ngravity = [0.0, 0.0, -9.81]\n'
CHAPTER_LEG = """
[leg_designs.chapter]
dh = "classic"
joints = [
    { name = "yaw", type = "revolute", a = 0.08, alpha_deg = 90, d = 0.0, link = { section = "upper" } },
    { name = "thigh", type = "revolute", a = 0.35, alpha_deg = 0, d = 0.0, link = { section = "middle" } },
    { name = "shank", type = "revolute", a = 0.40, alpha_deg = 0, d = 0.0, link = { section = "lower" } },
]
"""
MOUNTS = {"front_left": (0.35, 0.2, 90), "front_right": (0.35, -0.2, -90), "rear_left": (-0.35, 0.2, 90), "rear_right": (-0.35, -0.2, -90)}


def stand() -> str:
    """The four-legged stand of O12 to O14."""
    legs = "".join(_leg(name, "chapter", "base", (x, y, 0.0), (0, 0, yaw)) for name, (x, y, yaw) in MOUNTS.items())
    return f'{HEAD}{CHAPTER_LEG}{SECTIONS}[[platforms]]\nname = "base"\n{legs}'


def module() -> str:
    """Two platforms joined by an elastic chain, three of the stand's legs."""
    chain = (
        '[chain_designs.waist]\ndh = "classic"\njoints = [\n'
        '    { name = "yaw", type = "revolute", a = 0.1, alpha_deg = 90, d = 0.0, link = { section = "waist" } },\n'
        '    { name = "pitch", type = "revolute", a = 0.2, alpha_deg = 0, d = 0.0, link = { section = "waist" } },\n]\n'
    )
    rear = 'name = "rear"\nparent = "base"\nchain = "waist"\nroot = { rpy_deg = [0, 0, 180] }\nend = { rpy_deg = [-90, 0, 180] }\n'
    places = {"front_left": "base", "front_right": "base", "rear_left": "rear"}
    legs = "".join(_leg(name, "chapter", place, (0.0, MOUNTS[name][1], 0.0), (0, 0, MOUNTS[name][2])) for name, place in places.items())
    return f'{HEAD}{CHAPTER_LEG}{chain}{SECTIONS}[[platforms]]\nname = "base"\n[[platforms]]\n{rear}{legs}'


def _leg(name: str, design: str, platform: str, xyz: Sequence[float], rpy_deg: Sequence[float]) -> str:
    mount = f"{{ xyz = {list(xyz)}, rpy_deg = {list(rpy_deg)} }}"
    return f'[[legs]]\nname = "{name}"\ndesign = "{design}"\nplatform = "{platform}"\nmount = {mount}\n'


def _joint(rng: np.random.Generator, index: int, convention: str, size: float, section: str) -> str:
    kind = "revolute" if rng.random() < 0.7 else "prismatic"
    head = f'name = "joint{index}", type = "{kind}", link = {{ section = "{section}" }}'
    if convention == "origin":
        xyz, rpy = (np.round(rng.uniform(-1, 1, 3), 3).tolist() for _ in range(2))
        axis = ([1, 0, 0], [0, -1, 0], [0, 0, 1], [0.6, 0.0, 0.8])[rng.integers(4)]
        return f"{{ {head}, xyz = {[round(size * x, 4) for x in xyz]}, rpy = {rpy}, axis = {axis} }}"
    a, d = np.round(size * rng.uniform(-1, 1, 2), 3)
    alpha, theta = rng.choice([0, 90, -90, 35, 120]), rng.integers(-180, 180)
    return f"{{ {head}, a = {a}, alpha_deg = {alpha}, d = {d}, theta_deg = {theta} }}"


def _design(rng: np.random.Generator, table: str, joints: int, convention: str, size: float, sections: Sequence[str]) -> str:
    rows = ",\n    ".join(_joint(rng, index, convention, size, sections[index % len(sections)]) for index in range(joints))
    dh = "" if convention == "origin" else f'dh = "{convention}"\n'
    foot = "foot = { xyz = [0.05, -0.3, 0.1], rpy_deg = [20, -40, 10] }\n" if table.startswith("leg") else ""
    return f"[{table}]\n{dh}{foot}joints = [\n    {rows},\n]\n"


def random_stand(rng: np.random.Generator, feet: int, *, platforms: int = 1, elastic: bool = True) -> str:
    """Random legs of any convention, one a design, mirrored ones among them, on one to three platforms joined by (elastic) chains."""
    conventions = ("classic", "craig", "origin")
    text, legs, bodies = [HEAD, SECTIONS], [], ['[[platforms]]\nname = "body0"\n']
    for index in range(1, platforms):
        sections = ("waist",) if elastic else ("",)
        design = _design(rng, f"chain_designs.chain{index}", 2, conventions[index % 3], 0.2, sections)
        text.append(design if elastic else design.replace(', link = { section = "" }', ""))
        parent = f"body{rng.integers(index)}"
        root = f"root = {{ xyz = [-0.3, 0.05, 0.02], rpy_deg = [0, 10, {rng.integers(360)}] }}\nend = {{ xyz = [0.2, 0.0, 0.1] }}\n"
        bodies.append(f'[[platforms]]\nname = "body{index}"\nparent = "{parent}"\nchain = "chain{index}"\n{root}')
    for index in range(feet):
        if index % 3 == 2:
            legs.append(f'[[legs]]\nname = "leg{index}"\nmirror_of = "leg{index - 1}"\n')
            continue
        joints = int(rng.integers(2, 5))
        sections = ("upper", "middle", "lower")
        text.append(_design(rng, f"leg_designs.design{index}", joints, conventions[rng.integers(3)], 0.4, sections))
        xyz, rpy = np.round(rng.uniform(-0.5, 0.5, 3), 3).tolist(), rng.integers(-90, 90, 3).tolist()
        legs.append(_leg(f"leg{index}", f"design{index}", f"body{index % platforms}", xyz, rpy))
    return "".join([*text, *bodies, *legs])


def soled(text: str, sole: str, *designs: str) -> str:
    """The text with a sole in these leg designs."""
    for design in designs:
        assert f"[leg_designs.{design}]\n" in text
        text = text.replace(f"[leg_designs.{design}]\n", f"[leg_designs.{design}]\nsole = {{ {sole} }}\n")
    return text
