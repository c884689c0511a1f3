"""What does a leg cost among many? Prints ns a row and ratios, writes results/batches.json.

The leg of specs/mero_leg.toml: its position and Jacobian, its Jacobian alone, all four branches of its inverse and one of them, 256 rows
that stay in the nearest cache and a million that do not, in double and in float. Lanes are beside the same functions row after row, and
beside the same with the C library's sine and cosine; planar are both on arrays whose like elements lie together. At a million rows the
bytes that are read and written count beside what memcpy moves. From Python: walkgen's call beside the formulas written with NumPy.
"""

import argparse
import ctypes
import json
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

import leg
from compiling import compile_one, versions
from leg import Array
from peers.source import HERE, Source
from peers.walkgen_c import SPEC
from report import packages, table, write
from timing import pin_core
from walkgen import pipeline, toolchain
from walkgen.runtime import load

OUTPUT = HERE.parent / "_build" / "batches"
ROWS = {"in cache": 256, "a million rows": 1_000_000}
COMMON = tuple(flag for flag in toolchain.FLAGS if flag != "-std=c99")
BUILDS = {
    "C library, row by row": ("-O3", "-march=native", "-DWALKGEN_LIBM"),
    "row by row": ("-O3", "-march=native", "-DWALKGEN_NO_BLOCKS"),
    "lanes": ("-O3", "-march=native"),
    "lanes, any x86-64": ("-O3",),
}
PLANAR, LIBRARY_PLANAR = "lanes, planar", "C library, planar"
_PLANAR = {LIBRARY_PLANAR: "C library, row by row", PLANAR: "lanes"}
_PADDING = 16
"""Numbers between planes: those whose lengths are powers of two would compete for the same lines of the cache."""
_LINE = 64
_MOST_ARRAYS = 4
_JACOBIAN, _INVERSE = {"double": 10, "float": 15}, {"double": 7, "float": 20}
ASKED = {"foot_position_jacobian": _JACOBIAN, "foot_jacobian": _JACOBIAN, "inverse": _INVERSE, "inverse_branch": _INVERSE}
"""How many times faster than the C library's loop, in the cache, with AVX-512."""


def harness() -> ctypes.CDLL:
    """Loops in C: for few rows a call from Python would cost more than what it calls."""
    build = compile_one(Source("harness", "", (HERE.parent / "harness.c").read_text()), ("-O2",))
    found = ctypes.CDLL(str(build.library))
    found.time_arrays.restype = found.time_planes.restype = found.time_copies.restype = ctypes.c_double
    return found


@dataclass(frozen=True)
class Call:
    """One function on all rows: its arrays, those read first."""

    harness: ctypes.CDLL
    function: Any
    arrays: tuple[Array, ...]

    def __call__(self) -> float:
        """ns a row."""
        rows = len(self.arrays[0])
        places = [ctypes.c_void_p(array.ctypes.data) for array in self.arrays]
        function = ctypes.cast(self.function, ctypes.c_void_p)
        answer: float = self.harness.time_arrays(
            function, *map(ctypes.c_size_t, (_calls(rows), rows)), *places, *[None] * (_MOST_ARRAYS - len(places))
        )
        return answer

    @property
    def bytes(self) -> int:
        """Read and written, a row."""
        return sum(array.nbytes for array in self.arrays) // len(self.arrays[0])


@dataclass(frozen=True)
class PlanarCall:
    """One function on all rows, like elements side by side: its arrays [element, row], those read first."""

    harness: ctypes.CDLL
    function: Any
    rows: int
    arrays: tuple[Array, ...]

    def __call__(self) -> float:
        """ns a row."""
        sizes = map(ctypes.c_size_t, (_calls(self.rows), self.rows, self.arrays[0].shape[1]))
        places = [ctypes.c_void_p(array.ctypes.data) for array in self.arrays]
        function = ctypes.cast(self.function, ctypes.c_void_p)
        answer: float = self.harness.time_planes(function, *sizes, *places, *[None] * (_MOST_ARRAYS - len(places)))
        return answer


@dataclass(frozen=True)
class Copy:
    """memcpy that reads and writes as many bytes together."""

    harness: ctypes.CDLL
    source: Array
    target: Array

    def __call__(self) -> float:
        """ns a row."""
        rows = len(self.source)
        sizes = map(ctypes.c_size_t, (_calls(rows), rows, self.source.nbytes // rows))
        answer: float = self.harness.time_copies(*sizes, *(ctypes.c_void_p(array.ctypes.data) for array in (self.source, self.target)))
        return answer


def _calls(rows: int) -> int:
    """Short ones are run some times at once."""
    return max(1, 20_000 // rows)


def folder() -> Any:
    """The robot with a float library, made by the pipeline."""
    return pipeline.build(SPEC, OUTPUT, pipeline.BuildOptions(float32=True, planar=True)).folder


def library(place: Any, source: str, flags: Sequence[str]) -> ctypes.CDLL:
    """One C file under some flags."""
    digest = json.loads((place / "manifest.json").read_text())["digest"]
    text = f"/* sources {digest} */\n{(place / source).read_text()}"
    build = compile_one(Source("walkgen", source, _exported(text), includes=(place,), flags=COMMON), (*COMMON, *flags))
    if build.message:
        raise SystemExit(build.message)
    return ctypes.CDLL(str(build.library))


def _exported(text: str) -> str:
    """Visible outside the library, which is compiled with hidden symbols, and read a second time under the name of its file."""
    return f"#pragma GCC visibility push(default)\n{text}\n"


def _inputs(rows: int, real: type) -> dict[str, tuple[Array, ...]]:
    """Of each function; feet are reached."""
    inputs = leg.draw(rows, "limits")
    q, p, branch = inputs.q.astype(real), inputs.p.astype(real), inputs.branch.astype(np.int32).reshape(rows, 1)
    return {"foot_position_jacobian": (q,), "foot_jacobian": (q,), "inverse": (p,), "inverse_branch": (p, branch)}


def _outputs(real: type) -> dict[str, tuple[tuple[int, type], ...]]:
    """How many elements a row of each output has, and of what type."""
    whole = np.int32
    return {
        "foot_position_jacobian": ((3, real), (9, real)),
        "foot_jacobian": ((9, real),),
        "inverse": ((12, real), (4, whole)),
        "inverse_branch": ((3, real), (1, whole)),
    }


def calls(timer: ctypes.CDLL, found: ctypes.CDLL, tag: str, real: type, rows: int) -> dict[str, Call]:
    """Each function on arrays of rows."""
    outputs = {name: tuple(np.zeros((rows, size), kind) for size, kind in each) for name, each in _outputs(real).items()}
    functions = {name: found[f"mero_leg{tag}_leg_{name}_batch"] for name in outputs}
    return {name: Call(timer, functions[name], (*given, *outputs[name])) for name, given in _inputs(rows, real).items()}


def _planes(elements: int, rows: int, kind: type) -> Array:
    """Zeros, the first of each plane at the start of a line of the cache."""
    room = np.zeros((rows + _PADDING) * elements + _LINE, kind)
    start = -room.ctypes.data % _LINE // room.itemsize
    return room[start : start + (rows + _PADDING) * elements].reshape(elements, -1)


def planar_calls(timer: ctypes.CDLL, found: ctypes.CDLL, tag: str, real: type, rows: int) -> dict[str, PlanarCall]:
    """The same on planes."""
    outputs = {name: tuple(_planes(size, rows, kind) for size, kind in each) for name, each in _outputs(real).items()}
    functions = {name: found[f"mero_leg{tag}_leg_{name}_planar"] for name in outputs}
    given = {name: tuple(_in_planes(array) for array in arrays) for name, arrays in _inputs(rows, real).items()}
    return {name: PlanarCall(timer, functions[name], rows, (*given[name], *outputs[name])) for name in outputs}


def _in_planes(array: Array) -> Array:
    planes = _planes(array.shape[1], len(array), array.dtype.type)
    planes[:, : len(array)] = array.T
    return planes


def medians(runners: Mapping[str, Callable[[], float]], repetitions: int) -> dict[str, float]:
    """Of what each says, asked in turn."""
    times: dict[str, list[float]] = {name: [] for name in runners}
    for _ in range(repetitions):
        for name, run in runners.items():
            times[name].append(run())
    return {name: statistics.median(values) for name, values in times.items()}


def compiled(place: Any, repetitions: int) -> list[dict[str, Any]]:
    """Every build, precision, function and number of rows."""
    entries, timer = [], harness()
    for kind, tag, real in (("double", "", np.float64), ("float", "_f32", np.float32)):
        built = {name: library(place, f"mero_leg{tag}.c", flags) for name, flags in BUILDS.items()}
        for span, rows in ROWS.items():
            made = {name: calls(timer, found, tag, real, rows) for name, found in built.items()}
            planes = {name: planar_calls(timer, built[build], tag, real, rows) for name, build in _PLANAR.items()}
            for function in ASKED:
                runners: dict[str, Callable[[], float]] = {name: each[function] for name, each in (made | planes).items()}
                count = made["lanes"][function].bytes
                runners["memcpy of as many bytes"] = Copy(
                    timer, np.ones((rows, count // 2), np.int8), np.zeros((rows, count // 2), np.int8)
                )
                ns = medians(runners, repetitions if rows < 10_000 else max(3, repetitions // 20))
                entries.append({"function": function, "real": kind, "rows": rows, "span": span, "bytes": count, "ns": ns})
    return entries


def by_hand(q: Array) -> Array:
    """The Jacobian as someone writes it with NumPy."""
    c1, s1, knee = np.cos(q[:, 0]), np.sin(q[:, 0]), q[:, 1] + q[:, 2]
    shank_x, shank_z = leg.A3 * np.cos(knee), leg.A3 * np.sin(knee)
    rho, h = leg.A2 * np.cos(q[:, 1]) + shank_x, leg.A2 * np.sin(q[:, 1]) + shank_z
    rows = [[-s1 * rho, -h * c1, -shank_z * c1], [c1 * rho, -h * s1, -shank_z * s1], [np.zeros(len(q)), rho, shank_x]]
    return np.moveaxis(np.array(rows), -1, 0)


def from_python(place: Any, repetitions: int) -> list[dict[str, Any]]:
    """A million rows, results allocated by the call."""
    rows = ROWS["a million rows"]
    inputs, own = leg.draw(rows, "limits"), load(place).legs["leg"]
    assert np.allclose(own.foot_jacobian(inputs.q), by_hand(inputs.q))
    pairs: dict[str, dict[str, Callable[[], Any]]] = {
        "foot_jacobian": {"walkgen": lambda: own.foot_jacobian(inputs.q), "NumPy": lambda: by_hand(inputs.q)},
        "inverse": {"walkgen": lambda: own.inverse(inputs.p), "NumPy": lambda: leg.expected(leg.FUNCTIONS[4], inputs)},
    }
    return [{"function": name, "rows": rows, "ns": _timed(pair, max(3, repetitions // 20), rows)} for name, pair in pairs.items()]


def _timed(pair: Mapping[str, Callable[[], Any]], repetitions: int, rows: int) -> dict[str, float]:
    def ns(run: Callable[[], Any]) -> float:
        start = time.thread_time_ns()
        run()
        return (time.thread_time_ns() - start) / rows

    return medians({name: partial(ns, run) for name, run in pair.items()}, repetitions)


def _gains(entry: Mapping[str, Any]) -> tuple[float, float]:
    """How many times faster lanes are than the C library's loop on the same arrays: on rows, and on planes."""
    ns = entry["ns"]
    return ns["C library, row by row"] / ns["lanes"], ns[LIBRARY_PLANAR] / ns[PLANAR]


def show(entries: Sequence[dict[str, Any]], python: Sequence[dict[str, Any]]) -> None:
    """A row for each function, precision and number of rows."""
    names = list(entries[0]["ns"])
    heads = ["ns a row", *names, "times faster than the C library's", "planar", "share of memcpy's bytes", "planar"]
    rows = []
    for entry in entries:
        ns = entry["ns"]
        first = f"{entry['function']}, {entry['real']}, {entry['span']}"
        shares = [ns["memcpy of as many bytes"] / ns[name] for name in ("lanes", PLANAR)]
        asked = ASKED[entry["function"]][entry["real"]] if entry["span"] == "in cache" else None
        own, planar = _gains(entry)
        numbers = [f"{own:.1f}{f' (asked {asked})' if asked else ''}", f"{planar:.1f}", *(f"{share:.2f}" for share in shares)]
        rows.append([first, *(f"{ns[name]:.1f}" for name in names), *numbers])
    print(table(heads, rows))
    for entry in python:
        ns = entry["ns"]
        gain = f"{ns['NumPy'] / ns['walkgen']:.1f} times faster than NumPy's {ns['NumPy']:.0f}"
        print(f"from Python, {entry['function']}: {ns['walkgen']:.0f} ns a row, {gain}")


def main() -> None:
    """Build, time, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=101, help="medians are taken of so many; a twentieth for a million rows")
    options = parser.parse_args()
    place, core = folder(), pin_core()
    entries, python = compiled(place, options.repetitions), from_python(place, options.repetitions)
    show(entries, python)
    builds = {name: [*COMMON, *flags] for name, flags in BUILDS.items()}
    settings = {"settings": {**vars(options), "core": core, "asked_with_avx512": ASKED}, "builds": builds, "compilers": versions()}
    path = write("batches", {**settings, "packages": packages(("numpy",)), "entries": entries, "from_python": python})
    print(f"written: {path.relative_to(HERE.parents[1])}")


if __name__ == "__main__":
    main()
