"""How long does a whole robot's C take to compile beside CasADi's? Prints seconds and ratios, writes results/robot_compile_time.json.

The nine functions of benchmarks/size.py for specs/mero.toml: six legs, and the routes from the first platform through the chains to the
feet of the others. CasADi's C comes from one CodeGenerator: of legs the closed forms that benchmarks/size.py takes, once for each; of
routes the foot's position as walkgen gives it to CasADi, its other functions by CasADi's own derivatives, rates without damping. Both
are compiled here at walkgen's flags and at others: processor time, least of some runs; walkgen's also without batches.
"""

import argparse
import os
import resource
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import casadi as ca

from compiling import versions
from peers import casadi_c, dynamics_casadi
from peers.source import HERE
from report import packages, table, write
from size import FUNCTIONS
from trimmed import write_spec
from walkgen import pipeline, toolchain
from walkgen.runtime import load

OUTPUT = HERE.parent / "_build" / "robot_compile_time"
LEGS, ROUTES, ASKED = 6, 4, 0.4
OWN = tuple(flag for flag in toolchain.FLAGS if not flag.startswith("-std"))
FLAGS = {"walkgen's flags": OWN, **{level: (level, "-ffp-contract=off") for level in ("-O2", "-Os", "-O3")}}


def legs() -> Iterator[Any]:
    """CasADi's nine functions, under another name for each leg."""
    functions = [*casadi_c.functions("closed")]
    functions += [dynamics_casadi.graph(each, "closed") for each in dynamics_casadi.LEG if each.name != "leg_forward_dynamics"]
    for leg in range(LEGS):
        for function in functions:
            inputs = function.sx_in()
            yield ca.Function(f"leg{leg}_{function.name()}", inputs, function.call(inputs), {"cse": True})


def route(owner: str, position: Any) -> Iterator[Any]:
    """CasADi's functions of a way from the root platform to a foot."""
    q, qd, v, a = (ca.SX.sym(name, size) for name, size in zip("qrva", (*[position.size1_in(0)] * 2, 3, 3), strict=True))
    foot = position(q)
    J = ca.jacobian(foot, q)
    bias = ca.jtimes(ca.jtimes(foot, q, qd), q, qd)
    rates = J.T @ ca.solve(J @ J.T, v)
    further = J.T @ ca.solve(J @ J.T, a - ca.substitute(bias, qd, rates))
    H = ca.vertcat(*(ca.vec(ca.jacobian(ca.jacobian(foot[row], q), q)) for row in range(3)))
    functions = {
        "foot_position": ([q], [foot]),
        "foot_position_jacobian": ([q], [foot, ca.densify(J.T)]),
        "foot_hessian": ([q], [ca.densify(H)]),
        "foot_bias_acceleration": ([q, qd], [bias]),
        "inverse_velocity_acceleration": ([q, v, a], [rates, further]),
    }
    for name, (inputs, outputs) in functions.items():
        yield ca.Function(f"{owner}_{name}", inputs, outputs, {"cse": True})


def casadi_source(folder: Path) -> Path:
    """All of CasADi's functions in one C file."""
    built = pipeline.build(write_spec("mero", ("foot_position",), OUTPUT / "positions"), OUTPUT / "positions").folder
    robot, generator = load(built), ca.CodeGenerator("peer.c")
    for function in legs():
        generator.add(function)
    owners = [
        found.removesuffix("_foot_position") for name in robot.functions if (found := name.removeprefix("mero_")).startswith("root_to_")
    ]
    assert len(owners) == ROUTES
    for owner in owners:
        for function in route(owner, robot.casadi(f"{owner}_foot_position")):
            generator.add(function)
    return Path(generator.generate(f"{folder}/"))


def seconds(unit: Path, flags: Sequence[str], runs: int) -> float:
    """Least processor time of a compilation."""
    spent = []
    for _ in range(runs):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = ["gcc", "-std=gnu99", *flags, f"-I{unit.parent}", "-c", str(unit), "-o", os.devnull]
        subprocess.run(command, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(spent)


def measured(own: Path, peer: Path, runs: int) -> dict[str, Mapping[str, float]]:
    """By flags: both, and walkgen without batches."""
    return {
        name: {
            "walkgen": seconds(own, flags, runs),
            "without batches": seconds(own, (*flags, "-DWALKGEN_NO_BATCHES"), runs),
            "CasADi": seconds(peer, flags, runs),
        }
        for name, flags in FLAGS.items()
    }


def main() -> None:
    """Generate, compile, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=3, help="compilations of each, of which the least counts")
    options = parser.parse_args()
    built = pipeline.build(write_spec("mero", FUNCTIONS, OUTPUT), OUTPUT, pipeline.BuildOptions(targets=("c",))).folder
    with tempfile.TemporaryDirectory() as name:
        found = measured(built / "mero.c", casadi_source(Path(name)), options.runs)
    rows = [
        [
            flags,
            *(f"{time:.2f}" for time in times.values()),
            *(f"{times[own] / times['CasADi']:.2f}" for own in ("walkgen", "without batches")),
        ]
        for flags, times in found.items()
    ]
    print(table(["mero, s to compile", "walkgen", "without batches", "CasADi", "walkgen / CasADi", "without batches / CasADi"], rows))
    print(f"asked: at most {ASKED}")
    settings = {"settings": vars(options), "asked": ASKED, "flags": {name: list(flags) for name, flags in FLAGS.items()}}
    path = write("robot_compile_time", {**settings, "compilers": versions(), "packages": packages(("casadi",)), "seconds": found})
    print(f"written: {path.relative_to(HERE.parents[1])}")


if __name__ == "__main__":
    main()
