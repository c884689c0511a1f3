"""Yaw-pitch-pitch legs described in every way a spec can, all of them in one robot, so that it is built once."""

import numpy as np

TOGETHER = "inverse_velocity_acceleration"
FUNCTIONS = ("foot_position", "foot_jacobian", "inverse", "inverse_branch", "inverse_velocity", "inverse_acceleration", TOGETHER)
JOINTS = ("yaw", "thigh", "shank")
EPSILON, LAMBDA = 0.02, 0.05
"""The damping of every leg, m/rad."""
HEAD = """
walkgen = 1
[robot]
name = "{name}"
gravity = [0.0, 0.0, -9.81]
[generate]
functions = [{functions}]
[[platforms]]
name = "body"
"""


def spec(name: str, designs: dict[str, str], parameters: str = "") -> str:
    """One robot with a leg of every design, each under the design's name."""
    head = HEAD.format(name=name, functions=", ".join(f'"{function}"' for function in FUNCTIONS))
    return "\n".join([head, parameters, *designs.values()])


def mounted(name: str, mount: str = "", signs: str = "") -> str:
    lines = ["[[legs]]", f'name = "{name}"', f'design = "{name}"', 'platform = "body"']
    return "\n".join([*lines, *([f"mount = {{ {mount} }}"] if mount else []), signs])


def design(name: str, rows: list[str], foot: str, convention: str = "", more: str = "") -> str:
    lines = [f"[leg_designs.{name}]", f"foot = {{ xyz = [{foot}] }}", f"damping = {{ epsilon = {EPSILON}, lambda_max = {LAMBDA} }}"]
    lines += [f'dh = "{convention}"', more] if convention else [more]
    for joint, row in zip(JOINTS, rows, strict=True):
        lines += [f"[[leg_designs.{name}.joints]]", f'name = "{joint}"', 'type = "revolute"', row]
    return "\n".join(lines)


def dh(a: float, alpha: float, d: float, theta: float) -> str:
    return f"a = {a}\nalpha_deg = {alpha}\nd = {d}\ntheta_deg = {theta}"


def origin(xyz: str, rpy_deg: str, axis: str) -> str:
    return f"xyz = [{xyz}]\nrpy_deg = [{rpy_deg}]\naxis = [{axis}]"


def leg(name: str, rows: list[str], foot: str, convention: str = "", *, more: str = "", mount: str = "", signs: str = "") -> str:
    return design(name, rows, foot, convention, more) + "\n" + mounted(name, mount, signs)


def mirrored(name: str, original: str) -> str:
    return f'[[legs]]\nname = "{name}"\nmirror_of = "{original}"'


# ---- the legs ----------------------------------------------------------------------------------------------------------------

FIG7 = [dh(0.08, 90, 0.1, 0), dh(0.35, 0, 0.03, 0), dh(0.4, 0, -0.05, 0)]
OBLIQUE = "xyz = [0.1, -0.2, 0.3], rpy_deg = [37, -21, 118]"
HAND_MADE = {
    "general": leg("general", FIG7, "0.02, -0.03, 0.01", "classic", mount=OBLIQUE),
    "general_mirrored": mirrored("general_mirrored", "general"),
    "mapped": leg("mapped", FIG7, "0.02, -0.03, 0.01", "classic", signs="signs = [-1, 1, -1]\nzeros_deg = [30, -100, 200]"),
    "chapter": leg("chapter", [dh(0, 90, 0, 0), dh(0.35, 0, 0, 0), dh(0.4, 0, 0, 0)], "0, 0, 0", "classic"),
    "turned": leg("turned", [dh(-0.07, -90, 0.02, 33), dh(-0.3, 180, 0.05, -71), dh(0.25, 17, -0.11, 140)], "0.1, 0.2, -0.1", "classic"),
    "equal": leg("equal", [dh(0, 90, 0, 0), dh(0.3, 0, 0, 0), dh(0.3, 0, 0, 0)], "0, 0, 0", "classic", mount=OBLIQUE),
    "equal_offset": leg("equal_offset", [dh(0.1, 90, 0, 0), dh(0.3, 0, 0.04, 0), dh(0.3, 0, 0, 25)], "0, 0, 0", "classic"),
    "equal_wide": leg("equal_wide", [dh(0, 90, 0.2, 0), dh(0.3, 0, 0.04, 10), dh(0.3, 180, 0.02, 0)], "0, 0, 0", "classic"),
    "distant": leg("distant", [dh(1.1, 90, 0, 0), dh(0.3, 0, 0.02, 0), dh(0.2, 0, 0, 0)], "0, 0.05, 0", "classic"),
    "distant_behind": leg("distant_behind", [dh(-0.9, 90, 0, 0), dh(0.2, 0, 0.3, 0), dh(0.25, 0, 0, 0)], "0, 0, 0", "classic"),
    "wide": leg("wide", [dh(0.05, 90, 0, 0), dh(0.2, 0, 0.4, 0), dh(0.3, 0, 0.1, 0)], "0, 0, 0", "classic"),
    "craig": leg(
        "craig", [dh(0.1, 40, 0.2, 15), dh(0.06, -90, 0.03, 60), dh(0.32, 180, 0.02, -45)], "0.3, 0.1, -0.2", "craig", mount=OBLIQUE
    ),
    "craig_mirrored": mirrored("craig_mirrored", "craig"),
    "roll": leg(
        "roll",
        [
            origin("0.19, 0.05, 0", "0, 0, 0", "1, 0, 0"),
            origin("0, 0.06, 0", "0, 0, 0", "0, 1, 0"),
            origin("0, 0, -0.16", "0, 0, 0", "0, 1, 0"),
        ],
        "0, 0.01, -0.16",
        more="signs = [1, -1, -1]\nzeros_deg = [0, 45, -90]",
    ),
    "axes": leg(
        "axes",
        [
            origin("0.1, 0.2, -0.1", "20, -50, 70", "0.6, 0, 0.8"),
            origin("0.05, 0.1, 0.03", "0, 0, 0", "0.8, 0, -0.6"),
            origin("-0.1, 0.2, 0.15", "0, 90, 0", "-0.6, 0, -0.8"),
        ],
        "0.1, -0.3, 0.2",
    ),
}


def _random_dh(name: str, generator: np.random.Generator, convention: str) -> str:
    def length() -> float:
        return round(float(generator.choice([0.0, 1.0, 1.0]) * generator.uniform(-0.5, 0.5)), 3)

    def bone() -> float:
        return round(float(generator.choice([-1.0, 1.0]) * generator.uniform(0.02, 0.6)), 3)

    free = [round(float(angle), 1) for angle in generator.uniform(-180, 180, 5)]
    square, flat = generator.choice([-90, 90]), generator.choice([0, 180])
    twists = (square, flat, free[3]) if convention == "classic" else (free[3], square, flat)
    bones = (length(), bone(), length()) if convention == "classic" else (length(), length(), bone())
    rows = [dh(a, alpha, length(), theta) for a, alpha, theta in zip(bones, twists, free, strict=False)]
    signs = ", ".join(str(sign) for sign in generator.choice([-1, 1], 3))
    zeros = ", ".join(str(round(float(zero), 1)) for zero in generator.uniform(-360, 360, 3))
    more = f"signs = [{signs}]\nzeros_deg = [{zeros}]" if generator.random() < 0.5 else ""
    mount = f"xyz = [{length()}, {length()}, {length()}], rpy_deg = [{free[4]}, {free[3]}, {free[0]}]" if generator.random() < 0.5 else ""
    return leg(name, rows, f"{bone()}, {length()}, {length()}", convention, more=more, mount=mount)


def random_legs(count: int, seed: int) -> dict[str, str]:
    generator = np.random.default_rng(seed)
    names = [f"random_{index}" for index in range(count)]
    return {name: _random_dh(name, generator, ("classic", "craig")[index % 2]) for index, name in enumerate(names)}


LEGS = {**HAND_MADE, **random_legs(3, 11)}
TEXT = spec("zoo", LEGS)
