"""Pinocchio's C++ interface on both robots, as its CMake target has it: algorithms of the library that its wheels carry."""

from collections.abc import Iterator, Sequence

from compiling import COMMON
from motions import places
from multibody import Body, Robot, leg_robot, mero_robot, numbers
from peers.dynamics_source import HEAD
from peers.eigen import HEADERS
from peers.pinocchio_cpp import LINK, PREFIX
from peers.source import HERE, Peer, Source

FLAGS = (*COMMON, "-O3")
"""Not -march=native: Eigen aligns by it, and the library is compiled without."""
INSTANTIATED = "-DPINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION"

_TYPES = """struct body {
    const char *name;
    int parent, axis;
    double rotation[9], place[3], mass, centre[3], inertia[9];
};
"""


def _text(convention: str) -> str:
    tables = "".join(_table(name, robot) for name, robot in (("leg", leg_robot()), ("mero", mero_robot())))
    order = f"static const int mero_places[] = {{{', '.join(map(str, places()))}}};\n"
    body = (HERE / "dynamics_pinocchio.cpp").read_text()
    return f"{HEAD}#define CONVENTION pinocchio::Convention::{convention}\n{_TYPES}{tables}{order}{body}"


def _table(name: str, robot: Robot) -> str:
    """The base, then the bodies depth first, each with its parent's place in the table."""
    rows = {-1: 0} | {index: row for row, index in enumerate(robot.depth_first, start=1)}
    lines = [
        _line(robot.base, "base", 0),
        *(_line(robot.bodies[index], str(index), rows[robot.bodies[index].parent]) for index in robot.depth_first),
    ]
    return f"static const body {name}_bodies[] = {{\n" + "".join(lines) + "};\n"


def _line(body: Body, name: str, parent: int) -> str:
    groups = [_braced(body.rotation), _braced(body.place), repr(float(body.mass)), _braced(body.centre), _braced(body.inertia)]
    return f'    {{"{name}", {parent}, {body.axis}, {", ".join(groups)}}},\n'


def _braced(values: Sequence[object]) -> str:
    return f"{{{', '.join(map(repr, map(float, numbers(values).ravel())))}}}"


def sources(label: str, extra: tuple[str, ...], flags: tuple[str, ...]) -> Iterator[Source]:
    """Both of its ways to composite and articulated bodies, in joint axes or the world's."""
    for convention in ("LOCAL", "WORLD"):
        yield Source("Pinocchio", f"{label}, {convention.lower()}", _text(convention), "c++", (PREFIX / "include", HEADERS), extra, flags)


PEER = Peer("Pinocchio", lambda: tuple(sources("its library", (*LINK, INSTANTIATED), FLAGS)), "pin")
