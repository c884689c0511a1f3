"""How long does a load take to spread over feet on elastic legs, their compliances included? Writes results/contact_stiffness.json.

Generated C of a leg of mero gives each foot's place and compliance, `wg_contact_stiffness_blocks` spreads the load. Stances are drawn at
random on level ground; the stronger friction keeps most feet in their cones, the weaker makes them slide. The yardstick, three libm
sincos, runs in the same process between them.
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
from trimmed import write_spec
from walkgen.emit.emit import emit
from walkgen.pipeline import BuildOptions, generate

CSUPPORT = Path(__file__).parents[1] / "generator" / "walkgen" / "emit" / "csupport"
FLAGS = ("-O3", "-ffp-contract=off")
ROWS, CASES = 4096, ((3, 2.0), (4, 2.0), (6, 2.0), (12, 2.0), (4, 0.3), (6, 0.3))
"""Feet and friction."""
BOUND = 2000.0
"""ns: six feet that stick, compliances included."""
ADAPTER = """
#include "walkgen_real_f64.h"
#include "walkgen_contact_stiffness.h"
enum { PLACE = 3 * FEET, FRICTION = 6 * FEET, LOAD = 6 * FEET + 1 };
__attribute__((visibility("default"))) int32_t bench_stance(const double *in, int32_t spread, double *out, int32_t *status);
int32_t bench_stance(const double *in, int32_t spread, double *out, int32_t *status) {
    double points[3 * FEET], normals[3 * FEET], mu[FEET], misfit[3 * FEET] = {0.0}, C[9 * FEET], displacement[6], violation;
    int32_t state[FEET];
    *status = 0;
    for (int i = 0; i < FEET; ++i) {
        mero_front_left_foot_position(in + 3 * i, points + 3 * i);
        mero_front_left_foot_compliance(in + 3 * i, C + 9 * i);
        for (int j = 0; j < 3; ++j) {
            points[3 * i + j] += in[PLACE + 3 * i + j];
            normals[3 * i + j] = j == 2;
            out[3 * i + j] = C[9 * i + j] + C[9 * i + 3 + j] + C[9 * i + 6 + j] + points[3 * i + j];
        }
        mu[i] = in[FRICTION];
    }
    if (spread)
        wg_contact_stiffness_blocks(FEET, points, normals, mu, in + LOAD, C, misfit, out, status, state, displacement, &violation);
    return *status;
}
"""


@dataclass(frozen=True)
class Case:
    """So many feet and so much friction."""

    feet: int
    mu: float
    library: Any
    harness: Any

    @cached_property
    def rows(self) -> np.ndarray:
        """Joint values, places of the legs, friction, load [rows, 6 feet + 7]."""
        random, k = np.random.default_rng(20240301), self.feet
        angle = 2.0 * np.pi * np.arange(k) / k
        places = np.column_stack([0.5 * np.cos(angle), 0.4 * np.sin(angle), np.zeros(k)]).ravel()
        q = np.array([0.0, 0.45, -1.75]) + random.uniform(-0.05, 0.05, (ROWS, k, 3))
        load = random.uniform(-20.0, 20.0, (ROWS, 6)) + np.array([0.0, 0.0, -600.0, 0.0, 0.0, 0.0])
        load[:, 3:] += np.cross(_middle(q), [0.0, 0.0, -600.0])
        return np.hstack([q.reshape(ROWS, -1), np.tile(places, (ROWS, 1)), np.full((ROWS, 1), self.mu), load])

    @property
    def stance(self) -> Any:
        return ctypes.cast(self.library.bench_stance, ctypes.c_void_p)

    def answered(self) -> float:
        """The share of stances with an answer."""
        out, status = np.zeros(3 * self.feet), np.zeros(1, np.int32)
        call = self.library.bench_stance
        return float(np.mean([call(*map(_at, (row,)), 1, _at(out), _at(status)) == 0 for row in self.rows]))

    def measure(self, *, spread: bool) -> float:
        """ns a stance: with the spreading, or what its input costs alone."""
        kind, out, status = np.full(ROWS, int(spread), np.int32), np.zeros(3 * self.feet), np.zeros(1, np.int32)
        return float(self.harness.time_throughput(self.stance, ctypes.c_size_t(ROWS), *map(_at, (self.rows, kind, out, status))))


def _middle(q: np.ndarray) -> np.ndarray:
    """The feet's centre in the pose that all poses are near: the legs stand all round and reach to the left."""
    reach = 0.20 + 0.35 * np.cos(0.45) + 0.40 * np.cos(0.45 - 1.75)
    return np.tile([0.0, reach, 0.0], (len(q), 1))


def _at(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def _leg() -> tuple[str, Path]:
    """Generated C of mero's feet, and the folder of what it includes."""
    folder = FOLDER / "contact_stiffness"
    spec = write_spec("mero", ("foot_position", "foot_compliance"), folder)
    found = {artifact.path.name: artifact.text for artifact in emit(generate(spec, BuildOptions(targets=("c",))))}
    for name, text in found.items():
        if name.endswith(".h"):
            (folder / name).write_text(text)
    return found["mero.c"], folder


def _compiled(text: str, includes: tuple[Path, ...], flags: tuple[str, ...]) -> Any:
    build = compile_one(Source("walkgen", "C", text, includes=includes, flags=flags), flags)
    assert not build.message, build.message
    return ctypes.CDLL(str(build.library))


def _case(feet: int, mu: float, code: str, folder: Path) -> Case:
    library = _compiled(f"{code}\n#define FEET {feet}\n{ADAPTER}", (folder, CSUPPORT), FLAGS)
    harness = _compiled(f"#define WIDTH {6 * feet + 7}\n{(HERE.parent / 'harness.c').read_text()}", (), ("-O2",))
    harness.time_throughput.restype = ctypes.c_double
    return Case(feet, mu, library, harness)


def _yardstick(case: Case, library: Any) -> float:
    """ns of three libm sincos."""
    kind, out, status = np.zeros(ROWS, np.int32), np.zeros(6), np.zeros(1, np.int32)
    function = ctypes.cast(library.bench_three_sincos, ctypes.c_void_p)
    return float(case.harness.time_throughput(function, ctypes.c_size_t(ROWS), *map(_at, (case.rows, kind, out, status))))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repetitions", type=int, default=51)
    repetitions = parser.parse_args().repetitions
    code, folder = _leg()
    sincos = _compiled((HERE.parent / "yardstick.c").read_text(), (), ("-O2",))
    results = []
    for feet, mu in CASES:
        case = _case(feet, mu, code, folder)
        times = [(case.measure(spread=True), case.measure(spread=False), _yardstick(case, sincos)) for _ in range(repetitions)]
        whole, legs, yard = (statistics.median(column) for column in zip(*times, strict=True))
        results.append(
            {
                "feet": feet,
                "mu": mu,
                "answered": case.answered(),
                "ns": whole,
                "compliances_ns": legs,
                "sincos_ns": yard,
                "ratio": whole / yard,
            }
        )
    heads = ("feet", "friction", "answered", "ns", "compliances", "3 sincos", "ratio")
    print(table(heads, [(str(r["feet"]), *(f"{value:.4g}" for value in list(r.values())[1:])) for r in results]))
    print(f"six feet, compliances included: {results[2]['ns']:.0f} ns, at most {BOUND:.0f}")
    print(write("contact_stiffness", {"compilers": versions(), "flags": FLAGS, "rows": ROWS, "repetitions": repetitions, "cases": results}))


if __name__ == "__main__":
    main()
