"""What does a rolling state of a leg with a curved sole cost? Writes results/soles.json.

Generated C: `toe_motion` (contact parameter by Newton's method, arc length by Gauss's rule, angles, rates and accelerations), then
`stance_forces_load` (all forces and torques under a load), of specs/anthropomorphic_leg.toml and specs/anthropomorphic_leg_poly.toml. The
yardstick, three libm sincos, runs in the same process between them.
"""

import argparse
import ctypes
import statistics
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from compiling import FOLDER, compile_one, versions
from peers.source import HERE, Source
from report import table, write
from timing import pin_core
from trimmed import write_spec
from walkgen.emit.emit import emit
from walkgen.pipeline import BuildOptions, generate

FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math")
ROWS, WIDTH = 4096, 10
SPECS = ("anthropomorphic_leg", "anthropomorphic_leg_poly")
BOUND = 40.0
"""Times three sincos: asked for."""
FUNCTIONS = ("toe_motion", "stance_forces_load", "toe_rolling")
ADAPTER = """
#define EXPORTED __attribute__((visibility("default")))
EXPORTED int32_t bench_rolling(const double *in, int32_t branch, double *out, int32_t *status);
EXPORTED int32_t bench_kinematics(const double *in, int32_t branch, double *out, int32_t *status);
EXPORTED void bench_ankle(const double *in, double *out);
void bench_ankle(const double *in, double *out) {
    double angle[3], arc[3], point[2];
    NAME_leg_toe_rolling(in[0], in[1], angle, arc, point, out);
}
int32_t bench_kinematics(const double *in, int32_t branch, double *out, int32_t *status) {
    double ankle[6], margins[2];
    (void)branch;
    *status = NAME_leg_toe_motion(in, in + 6, in[9], out, out + 3, out + 12, ankle, margins);
    out[14] = ankle[0];
    return *status;
}
int32_t bench_rolling(const double *in, int32_t branch, double *out, int32_t *status) {
    static const double load[2] = {-30.0, -500.0};
    double force[8], margins[3], centre;
    int32_t own;
    bench_kinematics(in, branch, out, status);
    own = NAME_leg_stance_forces_load(in, out + 3, load, out[12] - out[14], 0.6, out + 15, force, force + 2, force + 4, force + 6, &centre,
                                      margins);
    return *status ? *status : own;
}
"""


@dataclass(frozen=True)
class Leg:
    """A spec's code, and rows of hip, thigh and edge [rows, 10] in which its foot rolls over the toe."""

    name: str

    @cached_property
    def library(self) -> Any:
        """Compiled for this machine."""
        folder = FOLDER / "soles"
        spec = write_spec(self.name, FUNCTIONS, folder)
        found = {artifact.path.name: artifact.text for artifact in emit(generate(spec, BuildOptions(targets=("c",))))}
        for file, text in found.items():
            if file.endswith((".h", ".c")):  # the code includes itself, once for each width of its lanes
                (folder / file).write_text(text)
        text = found[f"{self.name}.c"] + ADAPTER.replace("NAME", self.name)
        return _compiled(Source("soles", "C", text, includes=(folder,), flags=FLAGS), FLAGS)

    @cached_property
    def rows(self) -> np.ndarray:
        """Forward kinematics makes them: a contact parameter and a shank's angle first, then the hip that belongs to these."""
        random = np.random.default_rng(20261129)
        end = {"anthropomorphic_leg": 1.2, "anthropomorphic_leg_poly": 0.09}[self.name]
        contact = random.uniform(0.02 * end, 0.98 * end, ROWS)
        shank, thigh = random.uniform(-2.7, -2.1, ROWS), random.uniform(-1.5, -1.0, ROWS)
        edge = random.uniform(-0.5, 0.5, ROWS)
        ankle = np.array([self._ankle(at, start) for at, start in zip(contact, edge, strict=True)])
        hip = ankle - 0.42 * _direction(shank) - 0.42 * _direction(thigh)
        rates, thigh_rates = random.uniform(-1, 1, (ROWS, 4)), random.uniform(-3, 3, (ROWS, 2))
        return np.ascontiguousarray(np.column_stack([hip, rates, thigh, thigh_rates, edge]))

    def _ankle(self, contact: float, edge: float) -> np.ndarray:
        given, ankle = np.array([contact, edge]), np.zeros(6)
        self.library.bench_ankle(_at(given), _at(ankle))
        return ankle[:2]


def _direction(angle: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(angle), np.sin(angle)], -1)


def _compiled(source: Source, flags: tuple[str, ...]) -> Any:
    build = compile_one(source, flags)
    assert not build.message, build.message
    return ctypes.CDLL(str(build.library))


def _plain(file: Path, opening: str = "") -> Any:
    return _compiled(Source(file.stem, "C", opening + file.read_text()), ("-O2",))


def _at(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def _solved(leg: Leg) -> int:
    """How many rows have a state: a shank's angle may be such that another place of the foot is met before."""
    out, status = np.zeros(18), np.zeros(1, np.int32)
    return sum(leg.library.bench_rolling(_at(row), 0, _at(out), _at(status)) == 0 for row in leg.rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repetitions", type=int, default=51)
    repetitions = parser.parse_args().repetitions
    core = pin_core()
    legs = [Leg(name) for name in SPECS]
    contestants = {f"{leg.name}: {part}": (leg, leg.library[f"bench_{part}"]) for leg in legs for part in ("rolling", "kinematics")}
    sincos = _plain(HERE.parent / "yardstick.c")
    harness = _plain(HERE.parent / "harness.c", f"#define WIDTH {WIDTH}\n")
    harness.time_throughput.restype = harness.time_latency.restype = ctypes.c_double
    contestants["three sincos"] = (legs[0], sincos.bench_three_sincos)
    out, status, branch = np.zeros(64), np.zeros(1, np.int32), np.zeros(ROWS, np.int32)
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in contestants}
    for _ in range(repetitions):
        for name, (leg, function) in contestants.items():
            given = (ctypes.cast(function, ctypes.c_void_p), ctypes.c_size_t(ROWS), *map(_at, (leg.rows, branch, out, status)))
            times[name].append((harness.time_throughput(*given), harness.time_latency(*given, ctypes.c_size_t(5))))
    medians = {name: tuple(statistics.median(entry) for entry in zip(*found, strict=True)) for name, found in times.items()}
    yard = medians["three sincos"][0]
    rows = [(name, f"{a:.0f}", f"{b:.0f}", f"{a / yard:.1f}") for name, (a, b) in medians.items()]
    print(table(("ns", "throughput", "latency", "times three sincos"), rows))
    solved = {leg.name: _solved(leg) for leg in legs}
    worst = max(medians[f"{leg.name}: rolling"][0] for leg in legs) / yard
    print(f"rows with a state: {solved} of {ROWS}; a rolling state takes {worst:.1f} times three sincos, at most {BOUND:g} asked for")
    content = {
        "rows": ROWS,
        "solved": solved,
        "ns": medians,
        "times_three_sincos": worst,
        "bound": BOUND,
        "core": core,
        "compilers": versions(),
    }
    print("written:", write("soles", content))
    assert worst <= BOUND


if __name__ == "__main__":
    main()
