"""How large is the leg's code on a Cortex-M7, and how long does its C take to compile? Prints bytes and ratios, writes results/size.json.

Nine functions of specs/mero_leg.toml: position, position and Jacobian, Hessian, Jdot qd, inverse of one branch and of four, inverse
dynamics, mass matrix, rates and accelerations of the joints; at -Os, in double, with the C library's sine, cosine and arctangent, which
do not count. CasADi's and the hand-written C compute the same numbers, each from its smallest form; walkgen's inverses have statuses,
closest points of targets out of reach, wrapped angles and damping besides, so it counts three times: whole, with functions that answer
through one another (WALKGEN_SMALL), and so without closest points and damping (WALKGEN_NO_CLOSEST, WALKGEN_NO_DAMPING). The macros mean
nothing to the others. Compilation is timed with this machine's compiler at walkgen's flags: processor time, least of some runs.
"""

import argparse
import importlib
import os
import re
import resource
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from compiling import versions
from peers.source import HERE, Source
from report import packages, table, write
from trimmed import write_spec
from walkgen import pipeline, toolchain

GCC, NM = "arm-none-eabi-gcc", "arm-none-eabi-nm"
TARGET = ("-mcpu=cortex-m7", "-mthumb", "-mfpu=fpv5-d16", "-mfloat-abi=hard")
SIZED = ("-std=gnu99", "-Os", "-ffp-contract=off", "-fno-math-errno", "-DWALKGEN_LIBM")
ASKED = {"bytes": 3000, "compile time": 0.4}
FUNCTIONS = (
    *("foot_position", "foot_position_jacobian", "foot_hessian", "foot_bias_acceleration", "inverse_branch", "inverse"),
    *("inverse_dynamics", "mass_matrix", "inverse_velocity_acceleration"),
)
PEERS = {
    "by hand": ("peers.hand_c", "peers.dynamics_hand"),
    "CasADi": ("peers.casadi_c", "peers.dynamics_casadi"),
}
NOT_COUNTED = re.compile(r"^bench_|_batch(\.|$)|forward_dynamics|^mero_(?!leg)")
"""The harness's ways in, batches, and the functions that only benchmarks/dynamics.py has."""
SMALL = ("-DWALKGEN_SMALL",)
LEAST = (*SMALL, "-DWALKGEN_NO_CLOSEST", "-DWALKGEN_NO_DAMPING")
"""Also without answers that only targets out of reach and poses near singular ones need."""


@dataclass(frozen=True)
class Measured:
    """One contestant: bytes whole, with each set of macros, seconds to compile, and without batches (walkgen's own)."""

    name: str
    form: str
    bytes: int
    small: int
    least: int
    seconds: float
    single: float


def walkgen_source() -> Source:
    """Generated for these functions alone."""
    output = HERE.parent / "_build" / "size"
    folder = pipeline.build(write_spec("mero_leg", FUNCTIONS, output), output, pipeline.BuildOptions(targets=("c",))).folder
    return Source("walkgen", "spec", (folder / "mero_leg.c").read_text(), includes=(folder,))


def symbols(source: Source, folder: Path, *defined: str) -> dict[str, int]:
    """Bytes of every counted function and table of the object."""
    unit, made = folder / "unit.c", folder / "unit.o"
    unit.write_text(source.text)
    subprocess.run([GCC, *SIZED, *TARGET, *defined, *_includes(source), "-c", str(unit), "-o", str(made)], check=True, capture_output=True)
    listed = subprocess.run([NM, "-S", "--size-sort", str(made)], check=True, capture_output=True, text=True).stdout
    rows = [line.split() for line in listed.splitlines()]
    return {row[3]: int(row[1], 16) for row in rows if len(row) == 4 and not NOT_COUNTED.search(row[3])}


def seconds(source: Source, folder: Path, runs: int, *defined: str) -> float:
    """Least processor time of a compilation here."""
    unit = folder / "unit.c"
    unit.write_text(source.text)
    flags = ["-std=gnu99", *(flag for flag in toolchain.FLAGS if not flag.startswith("-std")), *defined]
    spent = []
    for _ in range(runs):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(["gcc", *flags, *_includes(source), "-c", str(unit), "-o", os.devnull], check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(spent)


def _includes(source: Source) -> list[str]:
    return [f"-I{path}" for path in (*source.includes, HERE)]


def measured(name: str, sources: Sequence[Source], folder: Path, runs: int) -> Measured:
    """All of a contestant's sources together."""
    sizes = (sum(sum(symbols(source, folder, *defined).values()) for source in sources) for defined in ((), SMALL, LEAST))
    whole, single = (sum(seconds(source, folder, runs, *defined) for source in sources) for defined in ((), ("-DWALKGEN_NO_BATCHES",)))
    return Measured(name, "; ".join(source.form for source in sources), *sizes, whole, single)


def smallest(module: str, folder: Path) -> Source:
    """A peer's C in the form that takes the least room."""
    made: Sequence[Source] = importlib.import_module(module).PEER.make()
    of_leg = [source for source in made if "bench_mero_" not in source.text]
    return min(of_leg, key=lambda source: sum(symbols(source, folder).values()))


def show(found: Sequence[Measured]) -> None:
    """A row for each, then what was asked."""
    by_name = {each.name: each for each in found}
    times = {each.name: (f"{each.seconds:.2f}", f"{each.single:.2f}") for each in found}
    rows = [[each.name, *map(str, (each.bytes, each.small, each.least)), *times[each.name], each.form] for each in found]
    columns = ["bytes", "small", "without closest points and damping too", "s to compile", "without batches", "form"]
    print(table(["nine functions", *columns], rows))
    own, peer = by_name["walkgen"], by_name["CasADi"]
    whole, single = own.seconds / peer.seconds, own.single / peer.single
    print(f"walkgen {own.bytes}, {own.small} and {own.least} bytes, asked {ASKED['bytes']}")
    print(f"compile time over CasADi's {whole:.2f}, asked {ASKED['compile time']}; {single:.2f} without batches")


def main() -> None:
    """Compile, count, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5, help="compilations of each, of which the least counts")
    options = parser.parse_args()
    if shutil.which(GCC) is None:
        print(f"NOT MEASURED  {GCC} is missing; in Debian gcc-arm-none-eabi and libnewlib-arm-none-eabi")
        return
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        peers = {peer: [smallest(module, folder) for module in modules] for peer, modules in PEERS.items()}
        found = [measured(each, sources, folder, options.runs) for each, sources in {"walkgen": [walkgen_source()], **peers}.items()]
    show(found)
    cross = subprocess.run([GCC, "--version"], check=True, capture_output=True, text=True).stdout.splitlines()[0]
    compilers = {**versions(), GCC: cross}
    settings = {"settings": vars(options), "asked": ASKED, "flags": [*SIZED, *TARGET], "compilers": compilers}
    path = write("size", {**settings, "packages": packages(("casadi",)), "entries": [vars(each) for each in found]})
    print(f"written: {path.relative_to(HERE.parents[1])}")


if __name__ == "__main__":
    main()
