"""Functions of a stance of any feet in contact: what it can carry, the friction that it needs, how it begins to slip (theory 4.2)."""

from collections.abc import Callable

from walkgen.model.mechanism import Mechanism
from walkgen.signature import Port
from walkgen.symbolic.contact import FEWEST_FEET, routine_solve
from walkgen.symbolic.function import Derivation, Solve
from walkgen.symbolic.ports import signature

_POINTS = Port("points", ("k", 3), "m")
_NORMALS = Port("normals", ("k", 3))
_MU = Port("mu", ("k",))
_WRENCH = Port("wrench", (6,), "N, N m")
_THREE_POINTS = Port("points", (3, 3), "m")
_THREE_NORMALS = Port("normals", (3, 3))
_STATUS = Port("status", kind="integer")
_TWIST = Port("twist", (6,), "m/s, rad/s")


def stance_functions(mechanism: Mechanism) -> dict[str, Callable[[], Derivation]]:
    """Those of a robot with feet to share a load."""
    if mechanism.contacts < FEWEST_FEET:
        return {}
    functions = (grasp_map, friction_needed, friction_share, load_margin, foot_admissible, slip)
    return {function.__name__: lambda function=function: function(mechanism) for function in functions}  # type: ignore[misc]


def grasp_map(mechanism: Mechanism) -> Solve:
    """G and how well it is conditioned."""
    outputs = (
        Port("G", (6, "k", 3), "1 and m"),
        _STATUS,
        Port("rank", kind="integer"),
        Port("condition"),
        Port("singular_values", (6,)),
        Port("lost", (3, 6)),
    )
    doc = (
        "Grasp map of feet: the wrench (force, moment about the frame's origin) of forces f [k,3] is G f; its rank and condition, lengths "
        "in the feet's root mean square distance from their centre; lost: load components that the feet cannot carry, rows of zeros where "
        "there are fewer. SINGULAR with any: fewer than three feet, coincident or collinear ones."
    )
    words = signature(mechanism, "", "grasp_map", (_POINTS,), outputs, doc, "theory 4.3: G = [...[1; [P_i]x]...]")
    return routine_solve(words, "wg_grasp", ("k", "points", "G", "singular_values", "lost", "condition", "rank", "status"))


def friction_needed(mechanism: Mechanism) -> Solve:
    """P1."""
    outputs = (Port("mu"), _STATUS, Port("f", ("k", 3), "N"), _TWIST)
    doc = (
        "The least coefficient of friction, common to all feet, with which they carry the load, and forces that do; twist is how they slip "
        "with less. INFEASIBLE where no friction helps: mu infinite, f NaN, and the twist proves it: wrench . twist = 1 while no foot "
        "moves but away from the ground."
    )
    words = signature(mechanism, "", "friction_needed", (_POINTS, _NORMALS, _WRENCH), outputs, doc, "theory 4.2, P1")
    return routine_solve(words, "wg_friction_needed", ("k", "points", "normals", "wrench", "mu", "f", "twist", "status"))


def friction_share(mechanism: Mechanism) -> Solve:
    """P1 for coefficients that are known."""
    inputs = (_POINTS, _NORMALS, _MU, _WRENCH)
    doc = "The share of their friction that the feet need: the least factor on all mu with which they carry the load; above 1 they slip."
    words = signature(mechanism, "", "friction_share", inputs, (Port("share"), _STATUS), doc, "theory 4.2, P1")
    return routine_solve(words, "wg_friction_share", ("k", "points", "normals", "mu", "wrench", "share", "status"))


def load_margin(mechanism: Mechanism) -> Solve:
    """How far a load is from slip and lift-off."""
    inputs = (_POINTS, _NORMALS, _MU, _WRENCH, Port("direction", (6,), "N, N m"))
    outputs = (Port("reach"), _STATUS, Port("lift", (), "N"))
    doc = (
        "Margins of a stance: reach, the most of `direction` that the feet carry on top of the load; lift, the greatest normal force that "
        "every foot can have at once above what its friction needs, N - |T| / mu: the distance from slipping and lifting off."
    )
    words = signature(mechanism, "", "load_margin", inputs, outputs, doc, "theory 4.2, P1")
    return routine_solve(words, "wg_load_margin", ("k", "points", "normals", "mu", "wrench", "direction", "reach", "lift", "status"))


def foot_admissible(mechanism: Mechanism) -> Solve:
    """Where one foot may stand."""
    inputs = (
        *(_POINTS, _NORMALS, _MU, _WRENCH),
        Port("foot", kind="integer"),
        Port("candidate", (3,), "m"),
        Port("candidate_normal", (3,)),
    )
    doc = (
        "The share of friction needed with a foot, by its number, on a candidate point instead of its own: it may stand there where the "
        "share is at most 1. Broadcast over candidates it is the field of stable contact points."
    )
    words = signature(
        mechanism, "", "foot_admissible", inputs, (Port("share"), _STATUS), doc, "theory 4.2: field of contact points, T <= mu N"
    )
    arguments = ("k", "points", "normals", "mu", "wrench", "foot", "candidate", "candidate_normal", "share", "status")
    return routine_solve(words, "wg_foot_admissible", arguments)


def slip(mechanism: Mechanism) -> Solve:
    """P2."""
    outputs = (
        Port("mu"),
        _STATUS,
        _TWIST,
        Port("normal_forces", (3,), "N"),
        Port("f", (3, 3), "N"),
        Port("axis", (6,), "m and 1"),
        Port("pitch", (), "m/rad"),
    )
    doc = (
        "The slip of a tripod that is about to begin: the friction on whose verge it stands, the twist (velocity of the frame's origin, "
        "angular velocity; length 1), the forces, a point and the direction of the twist's axis, advance over turn. SINGULAR for a "
        "translation, which has no axis, and for feet on a line."
    )
    words = signature(mechanism, "", "slip", (_THREE_POINTS, _THREE_NORMALS, _WRENCH), outputs, doc, "theory 4.2, P2")
    return routine_solve(
        words, "wg_slip", (3, "points", "normals", "wrench", "normal_forces", "f", "twist", "mu", "axis", "pitch", "status")
    )
