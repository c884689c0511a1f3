"""How many operations do the unmounted leg's foot and dynamics take, and the whole robot's dynamics? Writes results/operations.json.

The interpreter evaluates the emitted Program on numbers that count: sin and cos one each, a fused multiply-add two, and every input that
is read and every output one. CasADi's graphs of the same functions are counted by the same rule: every instruction but constants.
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import casadi
import numpy as np

import leg
import motions
from peers import casadi_c, dynamics_casadi, dynamics_walkgen
from peers.dynamics_source import LEG_FORMS
from peers.formulas import FORMS
from peers.source import HERE
from peers.walkgen_c import SPEC
from report import packages, table, write
from trimmed import write_spec
from walkgen import pipeline
from walkgen.graph.interpret import interpret
from walkgen.graph.program import Code, Program

BOUNDS = {"foot_position": 27, "foot_position_jacobian": 45}


@dataclass
class Tally:
    """A context for the interpreter whose numbers count what is done with them."""

    done: Counter[str] = field(default_factory=Counter)

    def mpf(self, value: Any) -> "Counted":
        return Counted(self, float(value))

    def sin(self, angle: "Counted") -> "Counted":
        return angle.applied("sin", math.sin)

    def cos(self, angle: "Counted") -> "Counted":
        return angle.applied("cos", math.cos)

    def isfinite(self, number: "Counted") -> bool:
        return math.isfinite(number.value)


@dataclass(frozen=True)
class Counted:
    """A double that tells its tally of every operation."""

    tally: Tally
    value: float

    def applied(self, name: str, function: Any, *others: "Counted") -> "Counted":
        self.tally.done[name] += 1
        return Counted(self.tally, function(self.value, *(other.value for other in others)))

    def __add__(self, other: "Counted") -> "Counted":
        return self.applied("add", float.__add__, other)

    def __sub__(self, other: "Counted") -> "Counted":
        return self.applied("sub", float.__sub__, other)

    def __mul__(self, other: "Counted") -> "Counted":
        return self.applied("mul", float.__mul__, other)

    def __truediv__(self, other: "Counted") -> "Counted":
        return self.applied("div", float.__truediv__, other)

    def __neg__(self) -> "Counted":
        return self.applied("neg", float.__neg__)


def count(program: Program, given: Mapping[str, Sequence[float]], right: Any) -> Counter[str]:
    """What one evaluation does; its numbers are compared with the reference first."""
    tally = Tally()
    ports = interpret(program, given, tally).values()
    off = motions.error(np.array([x.value for port in ports for x in port]), np.ravel(right))
    if not off <= leg.TOLERANCE:
        raise AssertionError(f"{program.signature.name} is off by {off}")
    return tally.done + Counter(input=sum(op.code is Code.INPUT for op in program.ops), output=len(program.outputs))


def instructions(function: Any) -> int:
    """Of CasADi's graph, constants left out."""
    codes = (function.instruction_id(k) for k in range(function.n_instructions()))
    return sum(code != casadi.OP_CONST for code in codes)


Counts = tuple[str, Counter[str], dict[str, int]]
"""Function, walkgen's operations, CasADi's by form."""


def programs(spec: Path) -> dict[str, Program]:
    """The emitted Programs of a spec by function."""
    return {body.signature.name: body for body in pipeline.generate(spec).functions if isinstance(body, Program)}


def kinematics() -> Iterator[Counts]:
    """Of the foot."""
    inputs, made = leg.draw(1, "limits"), programs(SPEC)
    peers = {form: {graph.name(): instructions(graph) for graph in casadi_c.functions(form)} for form in FORMS}
    for function in leg.FUNCTIONS:
        if function.name in BOUNDS:
            done = count(made[function.name], {"q": inputs.q[0].tolist()}, leg.expected(function, inputs))
            yield function.name, done, {form: peers[form][function.name] for form in FORMS}


def dynamics(spec: str, functions: Iterable[motions.DynamicFunction]) -> Iterator[Counts]:
    """Of one robot, of what is one Program; CasADi is given recursions, and the leg's equations simplified by hand."""
    asked = dynamics_walkgen.ASKED[spec]
    made = programs(write_spec(spec, asked, dynamics_walkgen.OUTPUT))
    for name, function in zip(asked, functions, strict=True):
        if name not in made:
            continue
        ports = motions.draw(function, 1).ports
        given = {port: row[0].tolist() for (port, _), row in zip(function.inputs, ports, strict=True)}
        done = count(made[name], given, motions.expected(function, 1))
        forms = LEG_FORMS if function.robot == "leg" else dynamics_casadi.FORMS
        yield function.name, done, {form: instructions(dynamics_casadi.graph(function, form)) for form in forms}


def main() -> None:
    """Count, print, write."""
    found = [*kinematics(), *dynamics("mero_leg", dynamics_casadi.LEG), *dynamics("mero", dynamics_casadi.MERO)]
    rows, content = [], {}
    for name, done, peers in found:
        others = {f"CasADi {form}": number for form, number in peers.items()}
        shares = ", ".join(f"{form} {number} ({number / done.total():.2f})" for form, number in peers.items())
        rows.append((name, str(done.total()), str(BOUNDS.get(name, "")), shares))
        content[name] = {"walkgen": done.total(), "of_which": dict(done), "bound": BOUNDS.get(name), **others}
    print(table(("function", "walkgen", "bound", "CasADi (/ walkgen)"), rows))
    path = write("operations", {"packages": packages(("casadi", "sympy")), "counts": content})
    print(f"written: {path.relative_to(HERE.parents[1])}")


if __name__ == "__main__":
    main()
