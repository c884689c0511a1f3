"""How long does `walkgen build specs/mero.toml` take, compile included; and `import walkgen.runtime`? Writes results/build_time.json.

Every build is a process of its own with an empty output folder and no compiler cache. The import is timed as a whole process, beside
a process that imports numpy alone and one that imports nothing.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from compiling import versions
from report import packages, table, write

ROOT = Path(__file__).parents[1]
SPECS = ("mero", "mero_leg")
IMPORTS = {"nothing": "pass", "numpy": "import numpy", "walkgen.runtime": "import walkgen.runtime"}
BOUNDS = {"build mero": 10.0, "import walkgen.runtime": 0.3}
"""Seconds."""


def _seconds(command: Sequence[str], environment: Mapping[str, str]) -> float:
    start = time.perf_counter()
    subprocess.run(command, cwd=ROOT, env=environment, check=True, capture_output=True)
    return time.perf_counter() - start


def build_seconds(spec: str) -> float:
    """One build from nothing."""
    with tempfile.TemporaryDirectory() as folder:
        fresh = {**os.environ, "XDG_CACHE_HOME": folder, "CCACHE_DISABLE": "1"}
        walkgen = str(Path(sys.executable).with_name("walkgen"))
        return _seconds((walkgen, "build", f"specs/{spec}.toml", "-o", f"{folder}/generated"), fresh)


def import_seconds(statement: str) -> float:
    """One process that does nothing else."""
    return _seconds((sys.executable, "-c", statement), os.environ)


def measure(builds: int, imports: int) -> dict[str, list[float]]:
    """All samples, the kinds of import taking turns."""
    found = {f"build {spec}": [build_seconds(spec) for _ in range(builds)] for spec in SPECS}
    turns = [{name: import_seconds(statement) for name, statement in IMPORTS.items()} for _ in range(imports)]
    return found | {f"import {name}": [turn[name] for turn in turns] for name in IMPORTS}


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--builds", type=int, default=5)
    parser.add_argument("--imports", type=int, default=21)
    options = parser.parse_args()
    samples = measure(options.builds, options.imports)
    medians = {name: statistics.median(times) for name, times in samples.items()}
    shares = {name: f"{medians[name] / bound:.3f} of {bound} s" for name, bound in BOUNDS.items()}
    rows = [(name, f"{medians[name]:.3f}", f"{min(times):.3f}", shares.get(name, "")) for name, times in samples.items()]
    print(table(("", "median s", "least s", "of the bound"), rows))
    content = {"compilers": versions(), "packages": packages(("sympy", "casadi", "numpy")), "median_s": medians, "samples_s": samples}
    print(f"written: {write('build_time', content | {'bounds_s': BOUNDS}).relative_to(ROOT)}")


if __name__ == "__main__":
    main()
