"""How long a simulated walk takes: 100 cycles of MERO at 200 instants a second, chains held and chains adapted, part by part."""

import json
import platform
import tempfile
import time
from pathlib import Path

import numpy as np

import walkgen
from walkgen.gait.ground import Relief, Slope
from walkgen.gait.simulate import Options, simulate
from walkgen.gait.trajectory import Trajectory
from walkgen.pipeline import BuildOptions, build, mechanism_of
from walkgen.runtime import load
from walkgen.walking import functions_of

ROOT = Path(__file__).parents[1]
SPEC = ROOT / "specs" / "mero.toml"
RUNS = 5
HILLS = Relief(lambda x, y: 0.03 * np.sin(2 * x) * np.cos(y))
CASES = {
    "level, chains held": (Slope(), Options(cycles=100, rate=200.0)),
    "15 degrees, chains held": (Slope(np.radians(15)), Options(cycles=100, rate=200.0)),
    "hills, chains adapted": (HILLS, Options(cycles=100, rate=200.0, adapt=True)),
}


def main():
    with tempfile.TemporaryDirectory() as folder:
        built = build(SPEC, Path(folder), BuildOptions(targets=("c",), functions=functions_of(mechanism_of(SPEC))))
        robot = load(built.folder)
        trajectory = Trajectory.of(robot.gaits["tripod"])
        rows = {name: measured(robot, trajectory, *case) for name, case in CASES.items()}
    print(f"{'100 cycles of mero tripod':32} {'instants':>9} {'s':>7} {'us/instant':>11}")
    for name, row in rows.items():
        print(f"{name:32} {row['instants']:9d} {row['seconds']:7.3f} {1e6 * row['seconds'] / row['instants']:11.2f}")
    result = {"machine": platform.processor() or platform.machine(), "walkgen": walkgen.__version__, "numpy": np.__version__, "walks": rows}
    (ROOT / "benchmarks" / "results" / "walks.json").write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


def measured(robot, trajectory, ground, options):
    """Least processor time of some runs: others work on the machine too."""
    times = []
    for _ in range(RUNS):
        start = time.process_time()
        walk = simulate(robot, trajectory, ground, options)
        times.append(time.process_time() - start)
    return {"instants": len(walk.times), "seconds": min(times), "least_margin": walk.least_margin, "slip": walk.slip}


if __name__ == "__main__":
    main()
