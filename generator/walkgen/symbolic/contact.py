"""Functions of a stance of any feet in contact: how the ground's forces share a load (theory 4.3)."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from walkgen.model.mechanism import Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.contact_newton import MULTIPLIERS, Multipliers
from walkgen.symbolic.function import Derivation, Solve, Step
from walkgen.symbolic.ports import signature

FEWEST_FEET = 2
"""A robot of fewer legs distributes no load."""

_POINTS = Port("points", ("k", 3), "m")
_NORMALS = Port("normals", ("k", 3))
_MU = Port("mu", ("k",))
_WRENCH = Port("wrench", (6,), "N, N m")
_WEIGHT = Port("weight", ("k",), default=(1.0,))
_N_MAX = Port("n_max", ("k",), "N", default=(float("inf"),))
_FACETS = Port("facets", kind="integer", default=(0.0,))
_STANCE = (_POINTS, _NORMALS, _MU, _WRENCH)
_FORCES = Port("f", ("k", 3), "N")
_STATUS = Port("status", kind="integer")
_STATE = Port("state", ("k",), kind="integer")
_CERTIFICATE = Port("certificate", (6,), "1/N, 1/(N m)")
_VIOLATION = Port("violation", (), "N")
_WORK = "walkgen_contact_work"
_STEPS, _LAST_STEPS = 30, 2
_FRAME = (
    "All in one frame; wrench is the load on the robot (force, moment about the frame's origin), f the ground's force on each foot: "
    "G f + wrench = 0"
)


def contact_functions(mechanism: Mechanism) -> dict[str, Callable[[], Derivation]]:
    """Those of a robot with feet to share a load."""
    if len(mechanism.legs) < FEWEST_FEET:
        return {}
    return {
        "contact_forces": lambda: least_squares(mechanism),
    }


def least_squares(mechanism: Mechanism) -> Solve:
    """The least forces within friction cones."""
    inputs = (*_STANCE, _WEIGHT, _N_MAX, _FACETS)
    outputs = (_FORCES, _STATUS, _STATE, _CERTIFICATE, _VIOLATION)
    doc = (
        f"{_FRAME} with the least sum of weight |f|^2 and |T| <= mu N, 0 <= N <= n_max; facets 0 for round cones, else corners of the "
        "polygon inside them. state: 0 sticks, 1 slides, 2 free. INFEASIBLE: f is NaN, certificate . (force, moment) <= 0 for all that "
        "the feet can exert and certificate . wrench = 1 proves it, violation is how far balanced forces at least are from their cones; "
        "else violation is what f lacks of balance."
    )
    words = signature(mechanism, "", "contact_forces", inputs, outputs, doc, "theory 4.2 P1; Farkas' lemma; semi-smooth Newton on the dual")
    return replace(_solve(words, "wg_contact_least_squares", _WORK), closed_form=_closed(mechanism, words))


def _closed(mechanism: Mechanism, words: Signature) -> Solve:
    """With a foot for each leg, round cones, and a fixed number of steps."""
    feet = {"k": len(mechanism.legs)}
    inputs, outputs = (tuple(port.sized(feet) for port in ports) for ports in (words.inputs, words.outputs))
    given = tuple(port.name for port in inputs)

    def kernel(name: str, taken: Sequence[Port], given: Sequence[Port]) -> Signature:
        return Signature(words.robot, "", f"contact_{name}", tuple(taken), tuple(given), "", words.source)

    later, after = (*inputs, MULTIPLIERS), replace(MULTIPLIERS, name="next")
    dual = Multipliers(inputs)
    steps = (
        Step(dual.first(kernel("first", inputs, (MULTIPLIERS,))), (*given, "multipliers")),
        Step(dual.step(kernel("step", later, (after,))), (*given, "multipliers", "multipliers"), repeat=_STEPS),
        Step(dual.step(kernel("newton", later, (after,)), last=True), (*given, "multipliers", "multipliers"), repeat=_LAST_STEPS),
        Step(dual.verdict(kernel("verdict", later, outputs)), (*given, "multipliers", *(port.name for port in outputs))),
    )
    return Solve(replace(words, inputs=inputs, outputs=outputs), (MULTIPLIERS,), steps)


def _solve(words: Signature, routine: str, workspace: str = "") -> Solve:
    """A routine that takes counts, the inputs, the workspace and the outputs, as the C function does."""
    inputs = tuple(port.name for port in words.inputs if port.name != "param")
    outputs = tuple(port.name for port in words.outputs)
    step = Step(routine, (*words.counts, *inputs, *(("work",) if workspace else ()), *outputs))
    return Solve(replace(words, workspace=workspace), (), (step,))
