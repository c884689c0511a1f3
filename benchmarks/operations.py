"""How many operations do foot position and Jacobian of the unmounted leg take? Writes results/operations.json.

The interpreter evaluates the emitted Program on numbers that count: sin and cos one each, a fused multiply-add two, and every input and
output one. CasADi's graphs of the same leg are counted by the same rule: every instruction but constants.
"""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import casadi
import numpy as np

from leg import FUNCTIONS as MEASURED
from leg import TOLERANCE, draw, error, expected
from peers import casadi_c
from peers.formulas import FORMS
from peers.source import HERE
from peers.walkgen_c import SPEC
from report import packages, table, write
from walkgen import pipeline
from walkgen.graph.interpret import interpret
from walkgen.graph.program import Program

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

    def __neg__(self) -> "Counted":
        return self.applied("neg", float.__neg__)


def count(program: Program) -> Counter[str]:
    """What one evaluation does; its numbers are compared with the reference first."""
    function = next(function for function in MEASURED if function.name == program.signature.name)
    inputs, tally = draw(1, "limits"), Tally()
    given = {"q": inputs.q[0].tolist()}
    answer = np.array([[x.value for port in interpret(program, given, tally).values() for x in port]])
    off = error(function, answer, expected(function, inputs))
    if not off <= TOLERANCE:
        raise AssertionError(f"{function.name} is off by {off}")
    return tally.done + Counter(input=program.signature.inputs[0].size, output=len(program.outputs))


def programs() -> Iterable[Program]:
    """The emitted Programs of the two functions."""
    for body in pipeline.generate(SPEC).functions:
        if body.signature.name in BOUNDS and isinstance(body, Program):
            yield body


def casadi_counts(form: str) -> dict[str, int]:
    """Instructions of CasADi's graphs, constants left out."""
    found = {}
    for function in casadi_c.functions(form):
        codes = [function.instruction_id(k) for k in range(function.n_instructions())]
        found[function.name()] = sum(code != casadi.OP_CONST for code in codes)
    return found


def main() -> None:
    """Count, print, write."""
    counts = {program.signature.name: count(program) for program in programs()}
    peers = {form: casadi_counts(form) for form in FORMS}
    rows, content = [], {}
    for name, done in counts.items():
        others = {f"CasADi {form}": peers[form][name] for form in FORMS}
        rows.append((name, str(done.total()), str(BOUNDS[name]), *(f"{n} ({n / done.total():.2f})" for n in others.values())))
        content[name] = {"walkgen": done.total(), "of_which": dict(done), "bound": BOUNDS[name], **others}
    print(table(("function", "walkgen", "bound", *(f"CasADi {form} (/ walkgen)" for form in FORMS)), rows))
    path = write("operations", {"packages": packages(("casadi", "sympy")), "counts": content})
    print(f"written: {path.relative_to(HERE.parents[1])}")


if __name__ == "__main__":
    main()
