"""Legs of every sequence of one to three turning and sliding joints, at right angles, parallel or askew, all in one robot."""

from collections.abc import Sequence
from functools import cache
from itertools import product

import numpy as np

from oracles.screws import Screws, screws
from oracles.walker import read

SEQUENCES = tuple("".join(kinds) for count in (1, 2, 3) for kinds in product("rp", repeat=count))
TWISTS = {"z": 0.0, "p": 90.0, "m": -90.0, "x": None}
"""Between two axes: parallel, at a right angle, at the other, askew."""
FUNCTIONS = ("inverse",)
HEAD = """walkgen = 1
[robot]
name = "{name}"
gravity = [0.0, 0.0, -9.81]
[generate]
functions = [{functions}]
targets = [{targets}]
[[platforms]]
name = "body"
"""


def head(name: str, functions: tuple[str, ...] = FUNCTIONS, targets: tuple[str, ...] = ("c", "numpy")) -> str:
    words = (", ".join(f'"{word}"' for word in group) for group in (functions, targets))
    return HEAD.format(name=name, functions=next(words), targets=next(words))


def design(name: str, rows: list[str], foot: str, mount: str = "") -> str:
    """A leg of its own design: the text of every joint, the foot in the last frame, the mount's keys."""
    lines = [f"[leg_designs.{name}]", 'dh = "classic"', f"foot = {{ xyz = [{foot}] }}"]
    for index, row in enumerate(rows):
        lines += [f"[[leg_designs.{name}.joints]]", f'name = "joint{index}"', row]
    lines += ["[[legs]]", f'name = "{name}"', f'design = "{name}"', 'platform = "body"']
    return "\n".join([*lines, *([f"mount = {{ {mount} }}"] if mount else []), ""])


def row(kind: str, a: float, alpha: str, d: float, theta_deg: float, limits: str = "") -> str:
    """A joint; `alpha` and `limits` with their keys."""
    return f'type = "{"revolute" if kind == "r" else "prismatic"}"\na = {a}\n{alpha}\nd = {d}\ntheta_deg = {theta_deg}\n{limits}'


def leg(name: str, kinds: str, twists: str, generator: np.random.Generator, limits: Sequence[str] = ()) -> str:
    """A leg of random lengths and angles with the given twists after every joint but the last, whose twist is random."""

    def length(most: float) -> float:
        return round(float(generator.choice([-1.0, 1.0]) * generator.uniform(0.05, most)), 3)

    foot, rows = f"{length(0.2)}, {length(0.2)}, {length(0.2)}", []
    for kind, twist, limit in zip(kinds, (*twists, "x"), limits or [""] * len(kinds), strict=True):
        alpha = TWISTS[twist] if TWISTS[twist] is not None else round(float(generator.uniform(-170, 170)), 2)
        theta = round(float(generator.uniform(-180, 180)), 1)
        rows.append(row(kind, length(0.5), f"alpha_deg = {alpha}", length(0.3), theta, limit))
    mount = f"xyz = [{length(0.3)}, {length(0.3)}, {length(0.3)}], rpy_deg = [{generator.integers(-90, 90)}, 20, 30]"
    return design(name, rows, foot, mount)


NAMES = tuple(f"{kinds}_{''.join(twists)}" for kinds in SEQUENCES for twists in product(TWISTS, repeat=len(kinds) - 1))
"""146 legs: the kinds of the joints, and how each axis lies to the one before."""
SAMPLE = tuple(name for name in NAMES if len(name) < 6 or name[4:] in ("zz", "zm", "pz", "mp", "xx"))
FEW = (
    *("r_", "p_", "rr_z", "rr_x", "rp_p", "pr_m", "pp_z", "rrr_zz", "rrr_pz"),
    *("rrp_zm", "rpr_mp", "rpp_zz", "prr_mp", "prp_pz", "ppr_xx", "ppp_zz"),
)
"""Of these, what the ordinary run builds: every sequence of joints, every twist."""


@cache
def text(robot: str) -> str:
    """The robot `few`, or of all legs whose first joint is an `r` or a `p`; a leg is the same in both."""
    names = FEW if robot == "few" else [name for name in NAMES if name[0] == robot]
    legs = [leg(name, *name.split("_"), np.random.default_rng(list(name.encode()))) for name in names]
    return head(f"robot_{robot}") + "\n".join(legs)


@cache
def anatomies() -> dict[str, Screws]:
    return {limb.name: screws(limb) for robot in "rp" for limb in read(text(robot)).legs}
