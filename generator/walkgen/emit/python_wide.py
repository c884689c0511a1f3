"""Prints `<robot>_python_wide.c`: the functions with lanes once more, for vectors wider than every processor has."""

from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.c_declaration import function_name
from walkgen.emit.c_lanes import Laned, closest_lines, has_closest, laned
from walkgen.emit.c_printer import Precision
from walkgen.emit.c_text import banner
from walkgen.emit.layout import lay_out

HEADER = "walkgen_wide.h"


@dataclass(frozen=True)
class Wide:
    """Of one precision: its header and C type of tables, the robot's name in it, functions that serve targets out of reach."""

    header: str
    type: str
    robot: str
    closest: tuple[str, ...]


@dataclass(frozen=True)
class WideLoop:
    """A loop's function with lanes: what runs its rows, its number in the table, the place of its status or -1, a bit for the place of
    each integer among its inputs, what serves targets out of reach.
    """

    robot: str
    run: str
    number: int
    status: int
    integers: int
    closest: str


def stem(code: RobotCode, precision: Precision) -> str:
    """`mero`, or `mero_f32`."""
    return _tagged(code.mechanism.name, precision)


def wide(code: RobotCode, lanes: tuple[Laned, ...], precision: Precision) -> Wide:
    """For the head of the loops' file."""
    closest = tuple(line for each in lanes if each.body not in code.repeated for line in closest_lines(each, precision))
    return Wide(precision.header, _tagged("walkgen_wide", precision), stem(code, precision), closest)


def _tagged(name: str, precision: Precision) -> str:
    return "_".join(part for part in (name, precision.tag) if part)


def wide_loops(code: RobotCode, lanes: tuple[Laned, ...], precision: Precision) -> dict[str, WideLoop]:
    """By the functions' full names."""
    tables = [each.table for each in lanes if each.owns_table]
    robot, run = stem(code, precision), _tagged("walkgen_wide_rows", precision)
    return {
        each.signature.full_name: WideLoop(robot, run, tables.index(each.table), _status(each), _integers(each), _closest(each, precision))
        for each in lanes
    }


def _status(each: Laned) -> int:
    inputs, outputs = each.signature.inputs, each.signature.outputs
    return next((place for place, port in enumerate(outputs, len(inputs)) if port.kind != "real"), -1)


def _integers(each: Laned) -> int:
    return sum(1 << place for place, port in enumerate(each.signature.inputs) if port.kind != "real")


def _closest(each: Laned, precision: Precision) -> str:
    return f"{function_name(each.signature, precision)}_closest" if has_closest(each.body) else "NULL"


def wide_sources(code: RobotCode, precisions: tuple[Precision, ...]) -> tuple[Artifact, ...]:
    """One file for each precision, and the header; none for a robot without such functions."""
    lanes = laned(code)
    if not lanes:
        return ()
    header = (Path(__file__).parent / "csupport" / HEADER).read_text(encoding="utf-8")
    return (*(_source(code, lanes, precision) for precision in precisions), Artifact(PurePosixPath(HEADER), header))


def _source(code: RobotCode, lanes: tuple[Laned, ...], precision: Precision) -> Artifact:
    name = stem(code, precision)
    return lay_out(
        "python_wide.c.jinja",
        f"{name}_python_wide.c",
        banner=banner(code, "Functions with lanes for AVX2 and for AVX-512: part of the Python library only, compiled once for each."),
        defines=() if code.fma else ("WALKGEN_NO_FMA",),
        header=precision.header,
        source=f"{name}.c",
        robot=name,
        names=[function_name(each.signature, precision) for each in lanes if each.owns_table],
    )
