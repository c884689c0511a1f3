"""Where functions with lanes stand in a robot's C file, which includes itself to read them a second time."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from walkgen.emit.artifact import RobotCode
from walkgen.emit.c_declaration import CFunction
from walkgen.emit.c_lanes import Laned, closest_lines, lane_lines, laned, read_twice
from walkgen.emit.c_printer import Precision
from walkgen.graph.program import Program

NO_BATCHES = "#if !defined(WALKGEN_NO_BATCHES)"
"""What keeps batches out of the Python library, whose loops are NumPy's."""
_BATCH, _LANES = "walkgen_batch.h", "walkgen_lanes.h"


@dataclass(frozen=True)
class Part:
    """Functions that are compiled together, between the lines of a guard."""

    opening: tuple[str, ...]
    functions: tuple[CFunction, ...]
    closing: tuple[str, ...]


def guard(part: int) -> str:
    """What keeps a part out of the others' compilers; all parts are compiled where none is chosen."""
    return f"#if !defined(WALKGEN_PART) || WALKGEN_PART == {part}"


@dataclass(frozen=True)
class Rows:
    """Functions of one row that are read twice, public ones and kernels, what makes blocks of them, and their batches."""

    public: tuple[CFunction, ...] = ()
    kernels: tuple[CFunction, ...] = ()
    blocks: tuple[str, ...] = ()
    closest: tuple[str, ...] = ()
    batches: tuple[CFunction, ...] = ()

    @property
    def names(self) -> frozenset[str]:
        """Of all functions that stand here and nowhere else."""
        return frozenset(function.name for function in (*self.public, *self.kernels, *self.batches))

    @property
    def headers(self) -> tuple[str, ...]:
        """To include after the precision's."""
        return (_BATCH,) if self.batches else ()


def row_headers(code: RobotCode) -> tuple[str, ...]:
    """Support headers of lanes, for a robot that has any."""
    return (_BATCH, _LANES) if laned(code) else ()


def read_rows(
    code: RobotCode,
    lanes: Sequence[Laned],
    known: Mapping[Program, CFunction],
    functions: Sequence[tuple[CFunction, tuple[CFunction, ...]]],
    precision: Precision,
) -> Rows:
    """The robot's functions with lanes; `known` is how each Program is written, `functions` each function with those of many rows."""
    own = [(each, _kernel(each, known)) for each in lanes if each.owns_table]
    bodies = {each.body for each in lanes}
    public, kernels = (
        tuple(map(read_twice, dict.fromkeys(kernel for each, kernel in own if (each.program in code.public) == wanted)))
        for wanted in (True, False)
    )
    return Rows(
        public,
        kernels,
        blocks=tuple(line for each, kernel in own for line in lane_lines(each, kernel, precision)),
        closest=tuple(line for each in lanes if each.body not in code.repeated for line in _closest(each, precision)),
        batches=tuple(each for body, (_, of_rows) in zip(code.functions, functions, strict=True) if body in bodies for each in of_rows),
    )


def _kernel(each: Laned, known: Mapping[Program, CFunction]) -> CFunction:
    """What a block calls."""
    whole = known[each.program]
    return whole.usual if each.leaves and whole.usual else whole


def _closest(each: Laned, precision: Precision) -> Iterator[str]:
    """Where lanes are, what serves targets out of reach."""
    lines = tuple(closest_lines(each, precision))
    yield from (each.opening, *lines, "#endif") if lines else ()


def first_parts(rows: Rows, *, split: bool) -> tuple[Part, ...]:
    """What is read twice: public functions, which one part of a file in parts has, kernels, which both need, and then only the blocks."""
    if not rows.names:
        return ()
    public = Part(("", guard(1)), rows.public, ("", "#endif")) if split else Part((), rows.public, ())
    blocks = Part(("", "#if defined(WALKGEN_ROWS)", "#if WALKGEN_ROWS == 2", *rows.blocks, "", "#endif", "#else"), (), ())
    return (public, Part((), rows.kernels, ()), blocks)


def last_parts(rows: Rows, file: str, *, split: bool) -> tuple[Part, ...]:
    """The second reading, and the batches that stand on it."""
    if not rows.names:
        return ()
    opening = (
        "",
        *([guard(1)] if split else []),
        NO_BATCHES,
        "#if defined(WALKGEN_BLOCKS)",
        "#define WALKGEN_ROWS 2",
        f'#include "{_LANES}"',
    )
    lanes = (*opening, f'#include "{file}"', "#undef WALKGEN_ROWS", *rows.closest, "#endif")
    return (Part(lanes, rows.batches, ("", "#endif", *(["#endif"] if split else []), "#endif")),)
