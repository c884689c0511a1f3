"""Functions of a stance of any feet in contact: how the ground's forces share a load (theory 4.3)."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from walkgen.model.mechanism import Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.contact_elastic import sticking
from walkgen.symbolic.contact_newton import MULTIPLIERS, Multipliers
from walkgen.symbolic.function import Derivation, Solve, Step
from walkgen.symbolic.ports import signature

FEWEST_FEET = 2
"""A robot that stands on fewer points distributes no load."""

_POINTS = Port("points", ("k", 3), "m")
_NORMALS = Port("normals", ("k", 3))
_MU = Port("mu", ("k",))
_WRENCH = Port("wrench", (6,), "N, N m")
_WEIGHT = Port("weight", ("k",), default=(1.0,))
_N_MAX = Port("n_max", ("k",), "N", default=(float("inf"),))
_FACETS = Port("facets", kind="integer", default=(0.0,))
_BLOCKS = Port("compliance", ("k", 3, 3), "m/N")
_COUPLED = Port("compliance", ("k", 3, "k", 3), "m/N")
_MISFIT = Port("misfit", ("k", 3), "m", default=(0.0,))
_STANCE = (_POINTS, _NORMALS, _MU, _WRENCH)
_FORCES = Port("f", ("k", 3), "N")
_STATUS = Port("status", kind="integer")
_STATE = Port("state", ("k",), kind="integer")
_CERTIFICATE = Port("certificate", (6,), "1/N, 1/(N m)")
_VIOLATION = Port("violation", (), "N")
_FOUND = ("f", "status", "state", "certificate", "violation")
_WORK = "walkgen_contact_work"
_STEPS, _LAST_STEPS = 30, 2
_SOURCE = "theory 4.2, P1; Farkas' lemma; semi-smooth Newton on the dual"
_FRAME = (
    "All in one frame; wrench is the load on the robot (force, moment about the frame's origin), f the ground's force on each foot: "
    "G f + wrench = 0"
)


def contact_functions(mechanism: Mechanism) -> dict[str, Callable[[], Derivation]]:
    """Those of a robot with feet to share a load."""
    if mechanism.contacts < FEWEST_FEET:
        return {}
    return {
        "contact_forces": lambda: least_squares(mechanism),
        "contact_forces_limited": lambda: limited(mechanism),
        "contact_forces_stiffness": lambda: stiffness(mechanism, "contact_forces_stiffness", _BLOCKS, "wg_contact_stiffness_blocks"),
        "contact_forces_coupled": lambda: stiffness(mechanism, "contact_forces_coupled", _COUPLED, "wg_contact_stiffness"),
        "contact_forces_vertical": lambda: vertical(mechanism),
    }


def least_squares(mechanism: Mechanism) -> Solve:
    """The least forces within friction cones."""
    inputs = (*_STANCE, _WEIGHT, _N_MAX, _FACETS)
    outputs = (_FORCES, _STATUS, _STATE, _CERTIFICATE, _VIOLATION)
    doc = (
        f"{_FRAME} with the least sum of weight |f|^2 and |T| <= mu N, 0 <= N <= n_max; facets 0 for round cones, else corners of the "
        "polygon inside them. state: 0 sticks, 1 slides, 2 free. INFEASIBLE: f is NaN, certificate . (f, p x f) >= 0 for all that "
        "the feet can exert and certificate . wrench = 1 proves it, violation is how far balanced forces at least are from their cones; "
        "else violation is what f lacks of balance."
    )
    words = signature(mechanism, "", "contact_forces", inputs, outputs, doc, _SOURCE)
    arguments = ("k", "points", "normals", "mu", "wrench", "weight", "n_max", "facets", "work", *_FOUND)
    solve = routine_solve(replace(words, workspace=_WORK), "wg_contact_least_squares", arguments)
    return replace(solve, closed_form=_closed(mechanism, words))


def _closed(mechanism: Mechanism, words: Signature) -> Solve:
    """With a foot for each point that the legs stand on, round cones, and a fixed number of steps."""
    inputs, outputs = (tuple(port.sized(_feet(mechanism)) for port in ports) for ports in (words.inputs, words.outputs))
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


def limited(mechanism: Mechanism) -> Solve:
    """The least forces within friction cones and limits of joint torques."""
    inputs = (*_STANCE, Port("torque_rows", ("r", "k", 3), "m"), Port("torque_limits", ("r",), "N m"), _WEIGHT, _N_MAX, _FACETS)
    outputs = (_FORCES, _STATUS, _STATE, _CERTIFICATE, _VIOLATION, Port("multipliers", ("r",)))
    doc = (
        f"{_FRAME} as contact_forces has it, with sum_i torque_rows[r,i] . f_i <= torque_limits[r]: rows of -J^T for the most that a joint "
        "gives one way, of J^T for the other. INFEASIBLE: certificate . wrench - multipliers . torque_limits = 1 while certificate . "
        "(f, p x f) + multipliers . rows f >= 0 for all forces that the feet can exert."
    )
    words = replace(signature(mechanism, "", "contact_forces_limited", inputs, outputs, doc, _SOURCE), workspace=_WORK)
    limits = ("r", "torque_rows", "torque_limits", "work")
    arguments = ("k", "points", "normals", "mu", "wrench", "weight", "n_max", "facets", *limits, *_FOUND, "multipliers")
    return routine_solve(words, "wg_contact_limited", arguments)


def stiffness(mechanism: Mechanism, name: str, compliance: Port, routine: str) -> Solve:
    """Forces as elastic legs and ground share the load."""
    inputs = (*_STANCE, compliance, _MISFIT)
    outputs = (_FORCES, _STATUS, _STATE, Port("displacement", (6,), "m, rad"), _VIOLATION)
    shared = "of feet that may share links" if "coupled" in name else "of legs that share no link"
    doc = (
        f"{_FRAME} that elastic legs and ground make of the load: the least energy of the compliance {shared}, springs of the "
        "ground in series, with the feet's misfit; feet that would pull are released, sliding ones are on their "
        "cones. displacement: of the platform at the frame's origin. INFEASIBLE where no forces in the cones carry the load, SINGULAR for "
        "fewer than three feet or feet on a line."
    )
    words = signature(mechanism, "", name, inputs, outputs, doc, "theory 4.3: K = G C^-1 G', f = -C^-1 (G' delta + e)")
    arguments = ("k", "points", "normals", "mu", "wrench", "compliance", "misfit", "f", "status", "state", "displacement", "violation")
    solve = routine_solve(words, routine, arguments)
    return replace(solve, closed_form=sticking(words, _feet(mechanism))) if compliance is _BLOCKS else solve


def _feet(mechanism: Mechanism) -> dict[str, int]:
    """CasADi has a foot for each point that the legs stand on."""
    return {"k": mechanism.contacts}


def vertical(mechanism: Mechanism) -> Solve:
    """Three feet without friction."""
    outputs = (_FORCES, _STATUS, _STATE, _VIOLATION)
    doc = (
        f"{_FRAME} along the normals of three feet without friction; violation is what they leave unbalanced. INFEASIBLE with NaN where a "
        "foot would have to pull, SINGULAR where the feet are on a line."
    )
    words = signature(mechanism, "", "contact_forces_vertical", (_POINTS, _NORMALS, _WRENCH), outputs, doc, "theory 4.2, P0")
    return routine_solve(words, "wg_contact_vertical", ("k", "points", "normals", "wrench", "f", "status", "state", "violation"))


def routine_solve(words: Signature, routine: str, arguments: tuple[str | int, ...]) -> Solve:
    """A function that is one support routine; a workspace stands in `words` and among the arguments, as `work`."""
    return Solve(words, (), (Step(routine, arguments),))
