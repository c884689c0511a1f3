"""The C files of a robot: headers, kernels, self-test, build files and the support headers copied beside them."""

import re
from bisect import bisect
from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import accumulate
from pathlib import Path, PurePosixPath

from walkgen import __version__
from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.c_composite import rest_functions
from walkgen.emit.c_constants import macros
from walkgen.emit.c_declaration import CFunction, function_name
from walkgen.emit.c_each import header as each_header
from walkgen.emit.c_function import (
    batch_function,
    callback_function,
    composite_function,
    kernel,
    program_function,
    repeating_function,
    table_lines,
    usual_kernel,
)
from walkgen.emit.c_lanes import Laned, laned
from walkgen.emit.c_planar import HEADER as PLANAR
from walkgen.emit.c_planar import planar_functions
from walkgen.emit.c_printer import DOUBLE, FLOAT, CPrinter, Precision
from walkgen.emit.c_rest import may_leave
from walkgen.emit.c_rows import NO_BATCHES, Part, Rows, first_parts, guard, last_parts, read_rows, row_headers
from walkgen.emit.c_small import Small
from walkgen.emit.c_text import banner, comment_text, words
from walkgen.emit.layout import lay_out
from walkgen.graph.program import Composite, Program
from walkgen.graph.usual import for_all

Functions = Sequence[tuple[CFunction, tuple[CFunction, ...]]]
"""Each with those of many rows."""

_SUPPORT = Path(__file__).parent / "csupport"
_INCLUDE = re.compile(r'^#include "(walkgen_\w+\.h)"', re.MULTILINE)
_LARGE = 12_000
"""Lines of functions and support routines from which on two compilers are worth what both must read."""

_ALWAYS = ("walkgen_status.h", "walkgen_math.h", "walkgen_trig.h")


def c_sources(code: RobotCode) -> tuple[Artifact, ...]:
    """What the library is compiled from: `<robot>.h`, `<robot>.c`, with float32 the same in float, and the support headers."""
    pairs = [artifact for precision in _precisions(code) for artifact in _pair(code, precision)]
    return (*pairs, *(_support(name) for name in support_headers(code)))


def _pair(code: RobotCode, precision: Precision) -> tuple[Artifact, Artifact]:
    """The header and the source in one precision."""
    lanes = {each.body: each for each in laned(code)}
    printer = CPrinter(precision, code.fma)
    kernels = _kernels(code, printer, {each.program for each in lanes.values() if not each.leaves})
    programs = {body: program_function(body, printer) for body in code.functions if isinstance(body, Program)}
    small = Small(code, frozenset(kernels), precision)
    known = {program: small.answered(program, function) for program, function in (kernels | programs).items()}
    functions = [(_public(code, body, known, printer, small), _of_rows(code, body, lanes.get(body), precision)) for body in code.functions]
    rows = read_rows(code, tuple(lanes.values()), known, functions, precision)
    called_back = dict.fromkeys(callback for body in code.functions if isinstance(body, Composite) for callback in body.all_callbacks)
    callbacks = [callback_function(callback, known, printer) for callback in called_back]
    own = (body for body in code.functions if isinstance(body, Composite) and body not in code.repeated)
    rests = [rest for body in own for rest in rest_functions(body, known, printer)]
    return _header(code, precision, functions), _source(
        code, precision, [*(each for program in kernels for each in _both(known[program])), *callbacks, *rests], functions, rows
    )


def _of_rows(code: RobotCode, body: Program | Composite, lanes: Laned | None, precision: Precision) -> tuple[CFunction, ...]:
    """The batch, and where it is asked for what takes component-major arrays."""
    earlier = code.repeated.get(body)
    planar = planar_functions(body, lanes, precision, earlier) if code.planar else ()
    return (batch_function(body, lanes, precision, earlier), *planar)


def support_headers(code: RobotCode) -> tuple[str, ...]:
    """Names of the csupport headers that the robot's sources include."""
    named = (
        *_ALWAYS,
        *row_headers(code),
        *each_header(code),
        *_planar_header(code),
        *(precision.header for precision in _precisions(code)),
        *_workspaces(code),
        *_routine_headers(code),
    )
    return tuple(dict.fromkeys(_with_included(named)))


def _with_included(names: Iterable[str]) -> Iterator[str]:
    """The headers and those of csupport that they include."""
    for name in names:
        yield name
        yield from _with_included(_INCLUDE.findall(_support(name).text))


def _precisions(code: RobotCode) -> tuple[Precision, ...]:
    return (DOUBLE, FLOAT) if code.float32 else (DOUBLE,)


def _planar_header(code: RobotCode) -> tuple[str, ...]:
    return (PLANAR,) if code.planar else ()


def _routine_headers(code: RobotCode) -> list[str]:
    return [header for body in code.functions if isinstance(body, Composite) for header in body.headers]


def _workspaces(code: RobotCode) -> tuple[str, ...]:
    """The headers of what callers keep between calls."""
    return tuple(dict.fromkeys(f"{body.signature.workspace}.h" for body in code.functions if body.signature.workspace))


@cache
def _support(name: str) -> Artifact:
    return Artifact(PurePosixPath(name), (_SUPPORT / name).read_text(encoding="utf-8"))


def _stem(code: RobotCode, precision: Precision) -> str:
    return "_".join(part for part in (code.mechanism.name, precision.tag) if part)


def _header(code: RobotCode, precision: Precision, functions: Functions) -> Artifact:
    stem = _stem(code, precision)
    return lay_out(
        "robot.h.jinja",
        f"{stem}.h",
        banner=banner(code, f"Functions in {precision.real}; arrays are row-major, SI units, radians."),
        guard=f"WALKGEN_{words(stem)}_H",
        includes=("walkgen_status.h", *_workspaces(code)) if precision is DOUBLE else (f"{code.mechanism.name}.h",),
        macros=macros(code) if precision is DOUBLE else (),
        functions=functions,
        planar=code.planar,
    )


def _source(code: RobotCode, precision: Precision, kernels: list[CFunction], functions: Functions, rows: Rows) -> Artifact:
    stem = _stem(code, precision)
    tables = (line for table in code.tables for line in ("", *table_lines(table, CPrinter(precision, code.fma))))
    halves = _halves(code, functions, rows)
    split = len(halves) > 1
    return lay_out(
        "robot.c.jinja",
        f"{stem}.c",
        banner=banner(code, f"Straight-line code in {precision.real}."),
        defines=() if code.fma else ("WALKGEN_NO_FMA",),
        includes=(
            f"{stem}.h",
            precision.header,
            *rows.headers,
            *each_header(code),
            *_planar_header(code),
            *dict.fromkeys(_routine_headers(code)),
        ),
        once=bool(rows.names),
        parts=(
            *first_parts(rows, split=split),
            Part(tuple(tables), tuple(function for function in kernels if function.name not in rows.names), ()),
            *(part for number, half in enumerate(halves, 1) for part in _parts(half, rows, guard(number) if split else "")),
            *last_parts(rows, f"{stem}.c", split=split),
        ),
    )


def _halves(code: RobotCode, functions: Functions, rows: Rows) -> tuple[Functions, ...]:
    """All in one, or in two of like weight that two compilers can share where it is worth it."""
    ends = list(accumulate(_weights(code, functions, rows)))
    if not ends or ends[-1] < _LARGE:
        return (functions,)
    middle = bisect(ends, ends[-1] // 2)
    return functions[:middle], functions[middle:]


def _parts(functions: Functions, rows: Rows, opening: str) -> tuple[Part, Part]:
    """Functions, then their batches, but for those that are read twice."""
    single = tuple(function for function, _ in functions if function.name not in rows.names)
    batches = tuple(each for _, of_rows in functions for each in of_rows if each.name not in rows.names)
    closing = ("", "#endif") if opening else ()
    guarded = Part(("", NO_BATCHES), batches, ("", "#endif", *closing)) if batches else Part((), (), closing)
    return Part(("", opening) if opening else (), single, ()), guarded


def _weights(code: RobotCode, functions: Functions, rows: Rows) -> Iterator[int]:
    """Lines of each function, those of the support routines that it is the first to call among them."""
    met: set[str] = set()
    for body, (function, _) in zip(code.functions, functions, strict=True):
        needed = set(_with_included(body.headers)) if isinstance(body, Composite) else set()
        own = 0 if function.name in rows.names else len(function.lines)
        yield own + sum(_support(name).text.count("\n") for name in needed - met)
        met |= needed


def _public(code: RobotCode, body: Program | Composite, known: Mapping[Program, CFunction], printer: CPrinter, small: Small) -> CFunction:
    function, earlier = known[body] if isinstance(body, Program) else composite_function(body, known, printer), code.repeated.get(body)
    if earlier:
        return repeating_function(function, body.signature, earlier.signature, printer.precision)
    return small.answered(body, function) if isinstance(body, Composite) else function


def _kernels(code: RobotCode, printer: CPrinter, in_lanes: Container[Program]) -> dict[Program, CFunction]:
    """Every Program that Composites alone call, once each, as `<function>_kernel`, numbered where two share the name; for usual inputs as
    `<function>_usual` too.

    What is called at one place becomes part of it, or a batch that takes up its caller would leave it behind.
    """
    public = code.public
    calls = (call.callee for body in code.functions if isinstance(body, Composite) for call in body.all_calls)
    uses = Counter(callee for callee in calls if isinstance(callee, Program) and callee not in public)
    leaving = {may_leave(body) for body in code.functions if isinstance(body, Composite)}
    kernels: dict[Program, CFunction] = {}
    taken: set[str] = set()
    for program, count in uses.items():
        name = function_name(program.signature, printer.precision)
        storage = "static" if program in in_lanes else "WG_INLINE" if count == 1 else "WG_REPEATED"
        whole = _free(f"{name}_kernel", taken)
        if program in leaving:
            rest = kernel(for_all(program), whole, replace(printer, inputs="rest"), storage)
            kernels[program] = replace(rest, usual=usual_kernel(program, _free(f"{name}_usual", taken), printer))
        else:
            kernels[program] = kernel(program, whole, printer, storage)
    return kernels


def _both(function: CFunction) -> Iterator[CFunction]:
    """The function, and what serves usual inputs alone."""
    yield from (function.usual, function) if function.usual else (function,)


def _free(wanted: str, taken: set[str]) -> str:
    name, number = wanted, 1
    while name in taken:
        number += 1
        name = f"{wanted}_{number}"
    taken.add(name)
    return name


def build_files(code: RobotCode) -> tuple[Artifact, ...]:
    """CMakeLists.txt and `<robot>.pc`."""
    robot = code.mechanism.name
    stems = [_stem(code, precision) for precision in _precisions(code)]
    described = comment_text(code.mechanism.description).replace("$", "$$") or f"Kinematics of {robot}"
    values = {
        "robot": robot,
        "version": __version__,
        "sources": [f"{stem}.c" for stem in stems],
        "headers": [*(f"{stem}.h" for stem in stems), *support_headers(code)],
    }
    return (
        lay_out("CMakeLists.txt.jinja", "CMakeLists.txt", **values),
        lay_out("robot.pc.jinja", f"{robot}.pc", robot=robot, version=__version__, description=described),
    )
