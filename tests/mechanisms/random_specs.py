"""Random robots as spec text, for hypothesis: what no hand would think of trying."""

from collections.abc import Callable, Sequence
from typing import Any

from hypothesis import strategies as st

from walkgen.spec.functions import CHAIN_FUNCTIONS, FORWARD_FUNCTIONS

Draw = Callable[[st.SearchStrategy[Any]], Any]

LENGTHS = st.one_of(st.just("0.0"), st.integers(-500, 500).map(lambda n: f"{n / 1000}"))
ANGLES_DEG = st.one_of(st.sampled_from(["0", "90", "-90", "180", "45", "-30"]), st.integers(-18000, 18000).map(lambda n: f"{n / 100}"))
ANGLES = st.one_of(
    st.sampled_from(["0.0", "1.5707963267948966", "-1.5707963267948966", "3.141592653589793", '"pi/2"', '"-pi/3"']),
    st.integers(-3141, 3141).map(lambda n: f"{n / 1000}"),
)
UNIT_AXES = ("[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]", "[-1, 0, 0]", "[0, -1, 0]", "[0, 0, -1]", "[0.6, 0.0, 0.8]", "[0.36, 0.48, -0.8]")
CONVENTIONS = ("classic", "craig", "origin")
FUNCTIONS = ", ".join(f'"{name}"' for name in (*FORWARD_FUNCTIONS, *CHAIN_FUNCTIONS, "platform_poses", "foot_positions", "foot_jacobians"))
"""What random robots are tested for elsewhere is derived there."""


@st.composite
def poses(draw: Draw) -> str:
    """An inline table of xyz and rpy, in either unit."""
    xyz = ", ".join(draw(LENGTHS) for _ in range(3))
    if draw(st.booleans()):
        return f"{{ xyz = [{xyz}], rpy_deg = [{', '.join(draw(ANGLES_DEG) for _ in range(3))}] }}"
    return f"{{ xyz = [{xyz}], rpy = [{', '.join(draw(ANGLES) for _ in range(3))}] }}"


def _angle(draw: Draw, key: str) -> str:
    return f"{key}_deg = {draw(ANGLES_DEG)}" if draw(st.booleans()) else f"{key} = {draw(ANGLES)}"


def _length(draw: Draw, key: str) -> str:
    number = draw(LENGTHS)
    return f"{key}_mm = {float(number) * 1000:.0f}" if draw(st.booleans()) else f"{key} = {number}"


def _joint(draw: Draw, table: str, index: int, kind: str, convention: str) -> list[str]:
    lines = [f"[[{table}.joints]]", f'name = "joint{index}"', f'type = "{kind}"']
    if convention != "origin":
        return [*lines, _length(draw, "a"), _angle(draw, "alpha"), _length(draw, "d"), _angle(draw, "theta")]
    xyz = ", ".join(draw(LENGTHS) for _ in range(3))
    rpy = ", ".join(draw(ANGLES) for _ in range(3))
    return [*lines, f"xyz = [{xyz}]", f"rpy = [{rpy}]", f"axis = {draw(st.sampled_from(UNIT_AXES))}"]


def _signs_and_zeros(draw: Draw, kinds: list[str]) -> list[str]:
    """Optional `signs` and `zeros` (or `zeros_deg`) of a design or a leg."""
    lines = []
    if draw(st.booleans()):
        lines.append(f"signs = [{', '.join(draw(st.sampled_from(['1', '-1'])) for _ in kinds)}]")
    if draw(st.booleans()):
        degrees = all(kind == "revolute" for kind in kinds) and draw(st.booleans())
        zeros = ", ".join(draw(ANGLES_DEG if degrees else LENGTHS) for _ in kinds)
        lines.append(f"zeros{'_deg' if degrees else ''} = [{zeros}]")
    return lines


def _design(draw: Draw, table: str, most: int, conventions: Sequence[str]) -> tuple[list[str], list[str]]:
    """Lines of a leg or chain design, and its joints' kinds."""
    convention = draw(st.sampled_from(conventions))
    kinds = draw(st.lists(st.sampled_from(["revolute", "revolute", "prismatic"]), min_size=1, max_size=most))
    lines = [f"[{table}]"]
    if convention != "origin":
        lines.append(f'dh = "{convention}"')
    if table.startswith("leg") and draw(st.booleans()):
        lines.append(f"foot = {draw(poses())}")
    lines += _signs_and_zeros(draw, kinds)
    for index, kind in enumerate(kinds):
        lines += _joint(draw, table, index, kind, convention)
    return lines, kinds


def _platform(draw: Draw, count: int) -> str:
    """The name of one of the first `count` platforms."""
    return draw(st.sampled_from(["base", *(f"platform{index}" for index in range(1, count))]))


def _platforms(draw: Draw, count: int, conventions: Sequence[str]) -> tuple[list[str], list[str]]:
    """Lines of the chain designs and of the platforms: a series, a star or any tree."""
    designs, lines = [], ["[[platforms]]", 'name = "base"']
    for index in range(1, count):
        designs += _design(draw, f"chain_designs.chain{index}", 3, conventions)[0]
        lines += ["[[platforms]]", f'name = "platform{index}"', f'parent = "{_platform(draw, index)}"']
        lines += [f'chain = "chain{index}"', f"root = {draw(poses())}"]
        if draw(st.booleans()):
            lines += ['end = "level"', f"end_xyz = [{', '.join(draw(LENGTHS) for _ in range(3))}]"]
        else:
            lines.append(f"end = {draw(poses())}")
    return designs, lines


def _legs(draw: Draw, platforms: int, most: int, conventions: Sequence[str]) -> tuple[list[str], list[str]]:
    """Lines of the leg designs and of the legs, some of them mirrored."""
    designs, lines = [], []
    for index in range(draw(st.integers(1, 3))):
        design, kinds = _design(draw, f"leg_designs.design{index}", most, conventions)
        designs += design
        lines += ["[[legs]]", f'name = "leg{index}"', f'design = "design{index}"', f'platform = "{_platform(draw, platforms)}"']
        if draw(st.booleans()):
            lines.append(f"mount = {draw(poses())}")
        if draw(st.booleans()):
            lines += _signs_and_zeros(draw, kinds)
        if draw(st.booleans()):
            lines += ["[[legs]]", f'name = "mirrored{index}"', f'mirror_of = "leg{index}"']
    return designs, lines


@st.composite
def specs(draw: Draw, most_joints: int = 7, conventions: Sequence[str] = CONVENTIONS) -> str:
    """The text of a valid spec: 1 to 4 platforms, 1 to 3 legs (and mirror images) of 1 to 7 joints."""
    count = draw(st.integers(1, 4))
    chains, platforms = _platforms(draw, count, conventions)
    designs, legs = _legs(draw, count, most_joints, conventions)
    head = ["walkgen = 1", "[robot]", 'name = "robot"', "gravity = [0.0, 0.0, -9.80665]", "[generate]", f"functions = [{FUNCTIONS}]"]
    return "\n".join([*head, *designs, *chains, *platforms, *legs]) + "\n"
