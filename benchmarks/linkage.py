"""What does it cost to close the loops of a leg of ODEX's kind: foot -> drives -> foot? Writes results/linkage.json.

Generated C (`inverse_branch`, then `foot_position`) beside Newton's method on the loop equations of the same leg, written by hand in
odex_newton.c: 18 unknowns of six links, started from a pose a few degrees away. The yardstick, three libm sincos, runs in the same process
between them.
"""

import argparse
import ctypes
import statistics
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
"""Of both."""
ROWS, LINKS = 4096, 6
BOX = np.array([[-1.0, 0.19, 0.24], [1.0, 0.27, 0.36]])
"""Least and largest yaw and drives."""
A1, A2, W = np.array([0.05, -0.20]), np.array([0.28, -0.34]), np.array([-0.02, -0.22])
"""Points of the frame, as in specs/odex.toml."""
STEP = (0.008, 0.010)
"""How far the drives of the pose that Newton starts from are off at most (m): a few degrees of the links."""
BOUND, RATIO = 300.0, 10.0
"""ns, and how many times slower Newton is: asked for."""
ADAPTER = """
__attribute__((visibility("default"))) int32_t bench_closed(const double *in, int32_t branch, double *out, int32_t *status);
int32_t bench_closed(const double *in, int32_t branch, double *out, int32_t *status) {
    *status = odex_front_inverse_branch(in, branch & 15, out);
    if (branch < 16) /* else the drives are all that is asked for */
        odex_front_foot_position(out, out + 3);
    return *status;
}
"""


def _direction(angle: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(angle), np.sin(angle)], -1)


def _angle(vector: np.ndarray) -> np.ndarray:
    return np.arctan2(vector[..., 1], vector[..., 0])


def _circles(p: np.ndarray, r: Any, q: np.ndarray, s: float, side: int) -> np.ndarray:
    """Points at distance r of p and s of q, on the left of p -> q for side 1."""
    span = q - p
    length = np.linalg.norm(span, axis=-1)
    along = (length**2 + r**2 - s**2) / (2 * length)
    across = side * np.sqrt(r**2 - along**2)
    x, y = (span / length[..., None]).T
    return p + along[..., None] * np.stack([x, y], -1) + across[..., None] * np.stack([-y, x], -1)


def _poses(drives: np.ndarray) -> np.ndarray:
    """x, y, angle of thigh, shank, coupler, rocker, bell and link [rows, 18], dyad after dyad."""
    (lift, swing), zero = drives.T, np.zeros((len(drives), 2))
    thigh = _angle(_circles(zero + A1, lift, zero, 0.20, -1))
    bell = _angle(_circles(zero + A2, swing, zero + W, 0.12, 1) - W) - np.pi / 2
    s1 = W + 0.11 * _direction(bell)
    s2 = _circles(s1, np.full(len(s1), 0.22), zero, 0.10, 1)
    rocker = _angle(s2) - np.pi / 2
    parts = (
        (zero, thigh),
        (0.45 * _direction(thigh), rocker + np.pi),
        (0.12 * _direction(rocker), thigh),
        (zero, rocker),
        (zero + W, bell),
        (s1, _angle(s2 - s1)),
    )
    return np.concatenate([np.column_stack([origin, angle]) for origin, angle in parts], axis=1)


def _problems() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Joint values, rows of foot and start [rows, 21], and how far the start's links are turned (degrees)."""
    random = np.random.default_rng(20261128)
    q = random.uniform(*BOX, (ROWS, 3))
    start = np.clip(q[:, 1:] + random.uniform(-1, 1, (ROWS, 2)) * STEP, *BOX[:, 1:])
    pose, near = _poses(q[:, 1:]), _poses(start)
    tip = pose[:, 3:5] + 0.60 * _direction(pose[:, 5])
    foot = np.column_stack([0.4 + np.cos(q[:, 0]) * tip[:, 0], np.sin(q[:, 0]) * tip[:, 0], tip[:, 1]])
    turned = np.degrees(np.abs(np.angle(np.exp(1j * (pose - near)[:, 2::3]))).max(axis=1))
    return q, np.ascontiguousarray(np.hstack([foot, near])), turned


def _generated() -> str:
    folder = FOLDER / "linkage"
    spec = write_spec("odex", ("inverse_branch", "foot_position"), folder)
    found = {artifact.path.name: artifact.text for artifact in emit(generate(spec, BuildOptions(targets=("c",))))}
    for name, text in found.items():
        if name.endswith((".h", ".c")):  # a unit includes itself for the rows of batches
            (folder / name).write_text(text)
    return found["odex.c"] + ADAPTER


def _compiled(text: str, flags: tuple[str, ...]) -> Any:
    build = compile_one(Source("linkage", "C", text, includes=(FOLDER / "linkage",), flags=flags), flags)
    assert not build.message, build.message
    return ctypes.CDLL(str(build.library))


def _at(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def _answers(function: Any, rows: np.ndarray, branch: int) -> tuple[np.ndarray, np.ndarray]:
    """Drives and foot [rows,6], and what is returned."""
    out, status, codes = np.full((len(rows), 6), np.nan), np.zeros(1, np.int32), []
    for row, found in zip(rows, out, strict=True):
        codes.append(function(_at(row), branch, _at(found), _at(status)))
    return out, np.array(codes)


def _branch(function: Any, q: np.ndarray, rows: np.ndarray) -> int:
    """The one on which all these poses are."""
    for branch in range(16):
        out, status = _answers(function, rows, branch)
        if (status == 0).all() and np.abs(out[:, :3] - q).max() < 1e-10:
            return branch
    raise AssertionError("no branch gives the drives back")


def _check(answers: np.ndarray, q: np.ndarray, rows: np.ndarray) -> float:
    """The largest error of the feet; drives and feet must be right before anything is timed."""
    assert np.abs(answers[:, :3] - q).max() < 1e-10
    worst = float(np.abs(answers[:, 3:] - rows[:, :3]).max())
    assert worst < 1e-11
    return worst


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repetitions", type=int, default=51)
    repetitions = parser.parse_args().repetitions
    core = pin_core()
    q, rows, turned = _problems()
    ours, newton = _compiled(_generated(), FLAGS), _compiled((HERE.parent / "odex_newton.c").read_text(), FLAGS)
    sincos = _compiled((HERE.parent / "yardstick.c").read_text(), ("-O2",))
    harness = _compiled(f"#define WIDTH {rows.shape[1]}\n{(HERE.parent / 'harness.c').read_text()}", ("-O2",))
    harness.time_throughput.restype = ctypes.c_double
    branch = _branch(ours.bench_closed, q, rows)
    (closed, _), (iterated, steps) = _answers(ours.bench_closed, rows, branch), _answers(newton.bench_newton, rows, 0)
    errors = {"walkgen": _check(closed, q, rows), "Newton": _check(iterated, q, rows)}
    timed = {
        "walkgen": (ours.bench_closed, branch),
        "walkgen, drives alone": (ours.bench_closed, branch + 16),
        "Newton": (newton.bench_newton, 0),
        "Newton, drives alone": (newton.bench_newton, -1),
        "3 sincos": (sincos.bench_three_sincos, 0),
    }
    out, status = np.zeros(6), np.zeros(1, np.int32)

    def measure(function: Any, number: int) -> float:
        arguments = map(_at, (rows, np.full(ROWS, number, np.int32), out, status))
        return float(harness.time_throughput(ctypes.cast(function, ctypes.c_void_p), ctypes.c_size_t(ROWS), *arguments))

    samples = [{name: measure(*contestant) for name, contestant in timed.items()} for _ in range(repetitions)]
    ns = {name: statistics.median(sample[name] for sample in samples) for name in timed}
    ratio = ns["Newton"] / ns["walkgen"]
    print(table(("foot -> drives -> foot", "ns"), [(name, f"{value:.1f}") for name, value in ns.items()]))
    print(f"start: {np.median(turned):.1f} degrees off (median), {turned.max():.1f} at most; {steps.mean():.1f} Newton steps both ways")
    print(f"{ns['walkgen']:.0f} ns, asked for: under {BOUND:.0f}; Newton is {ratio:.1f} times slower, asked for: {RATIO:.0f}")
    start = {"median_degrees": float(np.median(turned)), "most_degrees": float(turned.max()), "newton_steps": float(steps.mean())}
    content = {"compilers": versions(), "flags": FLAGS, "rows": ROWS, "repetitions": repetitions, "core": core, "start": start}
    print(write("linkage", {**content, "foot_errors": errors, "ns": ns, "ratio": ratio}))


if __name__ == "__main__":
    main()
