"""Joint limits and seeds: the branch nearest to a seed, the closest configuration inside the limits, how far branches miss."""

import sympy

from walkgen.model.classify import FLAT_SOLE, inverse_class
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import STATUSES, Port
from walkgen.symbolic.driven import kinematics_of
from walkgen.symbolic.flat_inverse import flat_distance
from walkgen.symbolic.forward import Route
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Both, Derivation, Finite, Function, Indicator, LessEqual, Solve, Step
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.rows import TARGET, branch_rows, parameters_of, row_ports
from walkgen.symbolic.screws import geometry_port, geometry_step, limits_of, limits_port, limits_step, sequence_of
from walkgen.symbolic.selection import NEAREST_BRANCH, nearest
from walkgen.symbolic.tape import Tape, minus, symbols_of

STATUS = Port("status", kind="integer")
ADMISSIBLE_DOC = "Joint values within the limits that bring the foot to p (of several those nearest to the middle), or closest to it."
_UNREACHABLE = sympy.Integer(STATUSES.index("UNREACHABLE"))


def within_limits(mechanism: Mechanism, route: Route) -> Function:
    """Whether every joint value is finite and inside its limits."""
    port = joint_port("q", route.joints)
    doc = "Whether every joint is within its limits; 0 for NaN."
    words = signature(mechanism, route.owner, "within_limits", [port], [Port("within", kind="truth")], doc, "")
    truths = []
    for symbol, joint in zip(symbols_of(port), route.joints, strict=True):
        least, greatest = limits_of(joint, parameter_symbols(mechanism))
        truths.append(Finite(symbol) if joint.limits is None else Both(LessEqual(least, symbol), LessEqual(symbol, greatest)))
    everything = truths[0]
    for truth in truths[1:]:
        everything = Both(everything, truth)
    return Tape().function(words, [Indicator(everything)])


def inverse_near(mechanism: Mechanism, leg: Limb) -> Solve:
    """The branch nearest to a seed."""
    seed = joint_port("q_seed", leg.joints)
    words = signature(
        mechanism, leg.name, "inverse_near", [TARGET, seed], [joint_port("q", leg.joints), STATUS], NEAREST_BRANCH, "as inverse"
    )
    rows = branch_rows(mechanism, leg)
    slots = rows.ports[1].size
    routine = Step("wg_nearest_row", ("rows", "states", "q_seed", sequence_of(leg.joints), slots, "q", "status"))
    chosen = Step(nearest(mechanism, leg, slots), ("rows", "states", "q_seed", "q", "status"))
    return Solve(words, rows.ports, (*rows.steps, routine), rows.closed_form(words, chosen))


def inverse_admissible(mechanism: Mechanism, leg: Limb) -> Solve:
    """The closest configuration inside the joint limits."""
    outputs = [joint_port("q", leg.joints), STATUS]
    words = signature(mechanism, leg.name, "inverse_admissible", [TARGET], outputs, ADMISSIBLE_DOC, "as inverse")
    route, sequence = Route(leg.name, (leg,)), sequence_of(leg.joints)
    limits = limits_step(mechanism, leg.name, leg.joints)
    guard = ("wg_any_unreachable", ("status", 1))
    geometry = geometry_step(mechanism, route)
    search = Step("wg_closest_within", ("screws", "p", "limits", sequence, "q", "status"), guard)
    screws = Step(geometry.callee, (*geometry.arguments[:-1], "screws"), guard)
    ports = (limits_port(leg.joints), Port("screws", geometry_port(leg.joints).shape, "m and 1"))
    if not inverse_class(mechanism, leg).name:
        return Solve(words, ports, (limits, Step(middle(mechanism, leg), (*parameters_of(mechanism), "q", "status")), screws, search))
    rows = branch_rows(mechanism, leg)
    row = Step("wg_admissible_row", ("rows", "states", "limits", sequence, rows.ports[1].size, "q", "status"))
    return Solve(words, (*rows.ports, *ports), (*rows.steps, limits, row, screws, search))


def inverse_distance(mechanism: Mechanism, leg: Limb) -> Derivation:
    """How far each branch of the inverse is from the target."""
    found = inverse_class(mechanism, leg)
    output = Port("distance", (len(found.branch_names),), "m")
    if found.name == FLAT_SOLE:
        return flat_distance(mechanism, leg, TARGET, output)
    doc = "Distance from p of the foot at every branch of inverse: 0 but for rounding where it reaches, NaN for a bad input."
    words = signature(mechanism, leg.name, "inverse_distance", [TARGET], [output], doc, "as inverse")
    rows = branch_rows(mechanism, leg)
    last = Step(row_distances(mechanism, leg, output), ("rows", "p", *parameters_of(mechanism), "distance"))
    return Solve(words, rows.ports, (*rows.steps, last), rows.closed_form(words, last))


def row_distances(mechanism: Mechanism, leg: Limb, output: Port) -> Function:
    """rows [b,n], p -> how far from p the foot is at each."""
    rows = row_ports(leg, inverse_class(mechanism, leg), "rows", "states")[0]
    tape = Tape()
    values, count = symbols_of(rows), len(leg.joints)
    x, y, z = symbols_of(TARGET)
    gaps = []
    for start in range(0, rows.size, count):
        foot = kinematics_of((leg,), values[start : start + count], parameter_symbols(mechanism), tape).position
        gap = tape.vector("gap", minus(foot, (x, y, z)))
        gaps.append(sympy.sqrt(sympy.Add(*(part**2 for part in gap))))
    return tape.function(signature(mechanism, leg.name, "row_distances", [rows, TARGET], [output], "", ""), gaps)


def middle(mechanism: Mechanism, leg: Limb) -> Function:
    """The middle of the limits, 0 where there are none, as a first guess that does not reach."""
    bounds = (tuple(limits_of(joint, parameter_symbols(mechanism))) for joint in leg.joints)
    middles = [
        sympy.S.Zero if joint.limits is None else (least + most) / 2 for joint, (least, most) in zip(leg.joints, bounds, strict=True)
    ]
    words = signature(mechanism, leg.name, "middle", [], [joint_port("q", leg.joints), STATUS], "", "")
    return Tape().function(words, [*middles, _UNREACHABLE])
