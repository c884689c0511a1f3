"""What does one call from Python cost? Prints ns, writes results/python_calls.json.

The leg of specs/mero_leg.toml: foot position, Jacobian and inverse of one row, direct calls beside NumPy's ufuncs over the same compiled
loops, and beside the formulas as someone writes them with NumPy for one row. `np.empty(3)` is what the answer's array alone costs.
"""

import argparse
import os
import statistics
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

import leg
from peers.source import HERE
from peers.walkgen_c import SPEC
from report import packages, table, write
from timing import pin_core
from walkgen import pipeline
from walkgen.runtime import load

OUTPUT = HERE.parent / "_build" / "python_calls"
ASKED = 200
"""ns: a direct call of the foot position."""
_LOOPS = 1000
Calls = Mapping[tuple[str, str], Callable[[], Any]]


def loaded(folder: Any, backend: str) -> Any:
    """The leg as one backend calls it."""
    os.environ["WALKGEN_BACKEND"] = backend
    return load(folder).legs["leg"]


def position(q: np.ndarray) -> np.ndarray:
    """The foot as someone writes it with NumPy."""
    knee = q[1] + q[2]
    rho = leg.A2 * np.cos(q[1]) + leg.A3 * np.cos(knee)
    return np.array([np.cos(q[0]) * rho, np.sin(q[0]) * rho, leg.S1 + leg.A2 * np.sin(q[1]) + leg.A3 * np.sin(knee)])


def calls(direct: Any, ufunc: Any) -> Calls:
    """Everything that is timed, by function and way."""
    q, numbers = np.array([0.1, 0.2, 0.3]), [0.1, 0.2, 0.3]
    p = direct.foot_position(q)
    assert np.allclose(p, position(q), rtol=0, atol=1e-12)
    assert np.array_equal(p, ufunc.foot_position(numbers))
    return {
        ("foot_position", "direct"): lambda f=direct.foot_position: f(q),
        ("foot_position", "direct, of a list"): lambda f=direct.foot_position: f(numbers),
        ("foot_position", "ufunc"): lambda f=ufunc.foot_position: f(q),
        ("foot_position", "by hand with NumPy"): lambda: position(q),
        ("foot_jacobian", "direct"): lambda f=direct.foot_jacobian: f(q),
        ("foot_jacobian", "ufunc"): lambda f=ufunc.foot_jacobian: f(q),
        ("inverse", "direct"): lambda f=direct.inverse: f(p),
        ("inverse", "ufunc"): lambda f=ufunc.inverse: f(p),
        ("np.empty(3)", "yardstick"): lambda f=np.empty: f(3),
        ("nothing", "yardstick"): lambda f=None: f,
    }


def timed(runners: Calls, repetitions: int) -> dict[tuple[str, str], float]:
    """Median ns a call of each, in turn, less what a lambda costs that calls nothing."""
    times: dict[tuple[str, str], list[float]] = {name: [] for name in runners}
    for _ in range(repetitions):
        for name, run in runners.items():
            start = time.thread_time_ns()
            for _ in range(_LOOPS):
                run()
            times[name].append((time.thread_time_ns() - start) / _LOOPS)
    medians = {name: statistics.median(values) for name, values in times.items()}
    nothing = medians.pop(("nothing", "yardstick"))
    return {name: value - nothing for name, value in medians.items()}


def main() -> None:
    """Build, time, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=201, help="medians are taken of so many")
    options = parser.parse_args()
    folder, core = pipeline.build(SPEC, OUTPUT).folder, pin_core()
    ns = timed(calls(loaded(folder, "direct"), loaded(folder, "ufunc")), options.repetitions)
    print(table(["ns a call", "way", "median"], [[name, way, f"{value:.0f}"] for (name, way), value in ns.items()]))
    print(f"foot position: {ns['foot_position', 'direct']:.0f} ns, asked {ASKED}")
    entries = [{"function": name, "way": way, "ns": value} for (name, way), value in ns.items()]
    settings = {"settings": {**vars(options), "core": core}, "asked_ns": ASKED}
    path = write("python_calls", {**settings, "packages": packages(("numpy",)), "entries": entries})
    print(f"written: {path.relative_to(HERE.parents[1])}")


if __name__ == "__main__":
    main()
