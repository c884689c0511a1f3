"""How long does `walkgen build specs/mero.toml` take, compile included, and how large is what it makes? Writes results/build_time.json.

Every build is a process of its own with an empty output folder and no compiler cache, whose modules are bytecode already, as those
of an installed package are; processor time, of all its processes, is what a busy machine tells of it. Sizes are those of the robot
with every function: all C files together, and the largest function's machine code at -O2. `import walkgen.runtime` is timed as a
whole process, beside a process that imports numpy alone and one that imports nothing.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from compiling import versions
from report import packages, table, write
from trimmed import write_spec
from walkgen.spec.functions import CHAIN_FUNCTIONS, FORWARD_FUNCTIONS, INVERSE_FUNCTIONS, KINEMATIC_FUNCTIONS
from walkgen.toolchain import FLAGS

ROOT = Path(__file__).parents[1]
KINEMATICS = tuple(dict.fromkeys((*FORWARD_FUNCTIONS, *INVERSE_FUNCTIONS, *CHAIN_FUNCTIONS, *KINEMATIC_FUNCTIONS)))
BUILDS: dict[str, tuple[str, Sequence[str] | None]] = {
    "mero": ("mero", None),
    "mero, kinematics": ("mero", KINEMATICS),
    "mero_leg": ("mero_leg", None),
}
"""By name: the spec, and the functions asked for (None: all)."""
IMPORTS = {"nothing": "pass", "numpy": "import numpy", "walkgen.runtime": "import walkgen.runtime"}
BOUNDS = {"build mero": 30.0, "build mero, kinematics": 10.0, "import walkgen.runtime": 0.3}
"""Seconds."""
SIZES = {"all C files": 3_000_000, "largest function at -O2": 65_536}
"""Most bytes."""


@dataclass(frozen=True)
class Duration:
    """Seconds by the clock, and of processors at work."""

    clock: float
    processor: float


def _duration(command: Sequence[str], environment: Mapping[str, str]) -> Duration:
    worked, start = _processor(), time.perf_counter()
    subprocess.run(command, cwd=ROOT, env=environment, check=True, capture_output=True)
    return Duration(time.perf_counter() - start, _processor() - worked)


def _processor() -> float:
    """Of all processes that this one waited for, and theirs."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def build(name: str, folder: Path) -> Duration:
    """One build from nothing, into `folder`/generated."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    fresh = {**kept, "XDG_CACHE_HOME": str(folder), "CCACHE_DISABLE": "1"}
    walkgen = str(Path(sys.executable).with_name("walkgen"))
    spec, functions = BUILDS[name]
    return _duration((walkgen, "build", str(write_spec(spec, functions, folder)), "-o", str(folder / "generated")), fresh)


def imported(statement: str) -> Duration:
    """One process that does nothing else."""
    return _duration((sys.executable, "-c", statement), os.environ)


def sizes(folder: Path) -> tuple[dict[str, int], str]:
    """Bytes of a built robot's C, as SIZES names them, and the name of its largest function."""
    written = sum(path.stat().st_size for pattern in ("*.c", "*.h") for path in folder.glob(pattern))
    with tempfile.TemporaryDirectory() as scratch:
        target = f"{scratch}/robot.o"
        subprocess.run(["gcc", *FLAGS, "-O2", "-c", f"{folder / folder.name}.c", "-o", target], check=True)
        listing = subprocess.run(["nm", "-S", "-t", "d", "--defined-only", target], check=True, capture_output=True, text=True).stdout
    symbols = [line.split() for line in listing.splitlines()]
    size, largest = max((int(symbol[1]), symbol[3]) for symbol in symbols if len(symbol) == 4 and symbol[2] in "tT")
    return {"all C files": written, "largest function at -O2": size}, largest


def measure(builds: int, imports: int) -> tuple[dict[str, list[Duration]], dict[str, int], str]:
    """All samples, the kinds of import taking turns; sizes and the largest function of the first robot."""
    found: dict[str, list[Duration]] = {f"build {name}": [] for name in BUILDS}
    made: tuple[dict[str, int], str] = ({}, "")
    for name in BUILDS:
        for _ in range(builds):
            with tempfile.TemporaryDirectory() as folder:
                found[f"build {name}"].append(build(name, Path(folder)))
                made = made if made[1] else sizes(Path(folder) / "generated" / name)
    turns = [{name: imported(statement) for name, statement in IMPORTS.items()} for _ in range(imports)]
    return found | {f"import {name}": [turn[name] for turn in turns] for name in IMPORTS}, *made


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--builds", type=int, default=3)
    parser.add_argument("--imports", type=int, default=21)
    options = parser.parse_args()
    samples, made, largest = measure(options.builds, options.imports)
    clocks = {name: statistics.median(each.clock for each in times) for name, times in samples.items()}
    work = {name: statistics.median(each.processor for each in times) for name, times in samples.items()}
    shares = {name: f"{clocks[name] / bound:.3f} of {bound} s" for name, bound in BOUNDS.items()}
    rows = [(name, f"{clocks[name]:.3f}", f"{work[name]:.3f}", shares.get(name, "")) for name in samples]
    print(table(("medians", "s", "processor s", "of the bound"), rows))
    lines = [(name, str(size), f"{size / SIZES[name]:.3f} of {SIZES[name]}") for name, size in made.items()]
    print("\n" + table(("mero, every function", "bytes", "of the bound"), lines) + f"\nthe largest is {largest}")
    versions_of = {"compilers": versions(), "packages": packages(("sympy", "casadi", "numpy"))}
    listed = {name: [each.clock for each in times] for name, times in samples.items()}
    content = {**versions_of, "median_s": clocks, "median_processor_s": work, "samples_s": listed}
    bounds = {"bounds_s": BOUNDS, "bytes": made, "largest_function": largest, "bounds_bytes": SIZES}
    print(f"written: {write('build_time', content | bounds).relative_to(ROOT)}")


if __name__ == "__main__":
    main()
