"""Functions that only legs with a linkage have: whether it assembles, how well it transmits, what drives and pairs carry."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.spec.assur import SIDES, Group, Triad
from walkgen.symbolic.branches import BAD_INPUT, OK, SINGULAR, UNREACHABLE
from walkgen.symbolic.choices import less
from walkgen.symbolic.closure import assembled_port, forward_placing
from walkgen.symbolic.driven import DrivenKinematics
from walkgen.symbolic.drives import effort_unit
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.free_bodies import FreeBodies, Load
from walkgen.symbolic.function import Angle, Finite, Function, Less, Residue, Select
from walkgen.symbolic.leg_dynamics import LegDynamics, dynamics_ports
from walkgen.symbolic.linked_tree import spread_leg
from walkgen.symbolic.placing import Placing
from walkgen.symbolic.planar import difference, inner, outer
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.rubbing import Rubbed, demands, end_points
from walkgen.symbolic.tape import Tape, symbols_of
from walkgen.symbolic.triads import transmission

Exprs = Sequence[sympy.Expr]
_DEAD = sympy.Rational(1, 10**12)
"""Of a margin, the square of a transmission angle's sine: below it a dyad is at its dead point."""
_MOTION = ("q", "qd", "qdd", "f")


@dataclass(frozen=True)
class Entry:
    """Inputs, builder of ports and values, words."""

    inputs: tuple[str, ...]
    build: Callable[["PlacedLinkage"], tuple[tuple[Port, ...], Exprs]]
    doc: str
    source: str


def linkage_function(mechanism: Mechanism, leg: Limb, name: str) -> Function:
    """One of `LINKAGE`, of one leg."""
    assert leg.linkage is not None
    entry, placed = LINKAGE[name], PlacedLinkage(mechanism, leg, leg.linkage)
    ports, values = entry.build(placed)
    available = {port.name: port for port in dynamics_ports(leg.joints)}
    inputs = [available[port] for port in entry.inputs]
    listed = {"pairs": placed.end_names, "groups": [group.name for group in placed.groups], "joints": placed.pair_names}
    doc = entry.doc.format(**{key: ", ".join(names) for key, names in listed.items()})
    return placed.tape.function(signature(mechanism, leg.name, name, inputs, ports, doc, entry.source), values)


class PlacedLinkage:
    """What a builder works with: one leg's linkage placed on a tape of its own, and its dynamics once they are asked for."""

    def __init__(self, mechanism: Mechanism, leg: Limb, linkage: Linkage) -> None:
        self._mechanism, self._leg, self.linkage, self.tape = mechanism, leg, linkage, Tape()
        self.q, self.parameters = symbols_of(joint_port("q", leg.joints)), parameter_symbols(mechanism)
        self.drives = leg.drives

    @property
    def _driven(self) -> slice:
        """The drives among the leg's q."""
        return slice(len(self._leg.serial), len(self._leg.serial) + len(self.drives))

    @cached_property
    def placing(self) -> Placing:
        """Every link in the plane."""
        return forward_placing(self._leg, self.q[self._driven], self.parameters, self.tape)

    @cached_property
    def kinematics(self) -> DrivenKinematics:
        """Of the leg in space, on the same tape, with a placing of its own."""
        return DrivenKinematics((self._leg,), self.linkage, self.q, self.parameters, self.tape)

    @cached_property
    def dynamics(self) -> LegDynamics:
        """Of the leg, on the same tape."""
        return LegDynamics(self._mechanism, self._leg, *spread_leg(self._mechanism, self._leg, self.q, self.tape), self.tape)

    @property
    def assembled(self) -> sympy.Symbol:
        """Whether triads were closed: a status."""
        return symbols_of(assembled_port(self._leg))[0]

    @property
    def groups(self) -> tuple[Group | Triad, ...]:
        """Those that have a transmission angle."""
        return tuple(group for group in self.linkage.forward.groups if SIDES[group.kind] or isinstance(group, Triad))

    @property
    def ends(self) -> list[tuple[int, int]]:
        """Every pair with every link that it joins."""
        structure = self.linkage.structure
        return [(index, body) for index, pair in enumerate(structure.pairs) for body in pair.bodies if body not in structure.bars]

    @property
    def pair_names(self) -> list[str]:
        """Of all pairs, in the structure's order."""
        return [pair.name for pair in self.linkage.structure.pairs]

    @property
    def end_names(self) -> list[str]:
        """Of `ends`, then of passive cylinders with friction."""
        structure = self.linkage.structure
        pairs = [(structure.pairs[pair].name, body) for pair, body in self.ends]
        cylinders = [(each.name, body) for each in self.linkage.frictions if each.pair is None for body, _ in each.ends]
        return [f"{name} on {structure.names[body]}" for name, body in pairs + cylinders]

    def forces(self) -> Exprs:
        """Efforts of the drives at their motion."""
        return self.efforts()[self._driven]

    def efforts(self) -> Exprs:
        """Of all q at their motion."""
        symbols = self.dynamics.symbols
        return self.dynamics.newton_euler(symbols["qd"], symbols["qdd"], symbols["f"])

    def demands(self) -> dict[int, Load]:
        """By link, what its pairs must give it, friction apart."""
        qd, qdd, f = (self.dynamics.symbols[name] for name in ("qd", "qdd", "f"))
        return demands(self.linkage, self.placing, self.dynamics.virtual_efforts(qd, qdd, f)[len(self._leg.serial) :])

    def friction(self) -> list[Rubbed]:
        """What friction in every pair without a drive does to the pair's links."""
        dynamics = self.dynamics
        qd, f, still = dynamics.symbols["qd"], dynamics.symbols["f"], dynamics.still
        return [
            each
            for rubbing in dynamics.spread.rubbings
            for each in rubbing.loads(rubbing.against(qd, dynamics.virtual_efforts(qd, still, f) if rubbing.loaded else ()))
        ]


def _assembly_status(leg: PlacedLinkage) -> tuple[tuple[Port, ...], Exprs]:
    """The first group that fails decides: those after it have no place."""
    status: sympy.Expr = OK
    for margin in reversed(leg.placing.margins):
        status = Select(less(margin.value, 0), UNREACHABLE, Select(less(margin.value, _DEAD), SINGULAR, status))
    if leg.linkage.forward.triads:
        status = Select(Less(0, leg.assembled), leg.assembled, status)
    taint = leg.tape.let("taint", sympy.Add(*(Residue(value) for value in (*leg.q, *leg.parameters.values()))))
    return (Port("status", kind="integer"),), [Select(Finite(taint), status, BAD_INPUT)]


def _transmission_angles(leg: PlacedLinkage) -> tuple[tuple[Port, ...], Exprs]:
    return (Port("angles", (len(leg.groups),), "rad"),), [_angle(leg.placing, group) for group in leg.groups]


def _angle(placing: Placing, group: Group | Triad) -> sympy.Expr:
    if isinstance(group, Triad):
        push, velocity = transmission(placing, group)
        return Angle(inner(push, velocity), outer(push, velocity))
    if group.kind == "RRR":
        p, q, pin = (placing.joint(pair) for pair in group.pairs)
        a, b = difference(p, pin), difference(q, pin)
        return Angle(outer(a, b), inner(a, b))
    rod, along = placing.rod(group)
    return Angle(inner(rod, along), -outer(rod, along))


def _pair_positions(leg: PlacedLinkage) -> tuple[tuple[Port, ...], Exprs]:
    kinematics, count = leg.kinematics, len(leg.pair_names)
    points = [kinematics.place(kinematics.placing.joint(pair)) for pair in range(count)]
    return (Port("points", (count + 1, 3), "m"),), [entry for point in (*points, kinematics.position) for entry in point]


def _driving_forces(leg: PlacedLinkage) -> tuple[tuple[Port, ...], Exprs]:
    efforts = leg.forces()
    return (Port("forces", (len(efforts),), effort_unit(leg.drives)),), efforts


def _power(leg: PlacedLinkage) -> tuple[tuple[Port, ...], Exprs]:
    efforts = leg.efforts()
    powers = [leg.tape.let("power", effort * rate) for effort, rate in zip(efforts, leg.dynamics.symbols["qd"], strict=True)]
    positive = [Select(Less(power, 0), 0, power) for power in powers]
    ports = (Port("power", (len(powers),), "W"), Port("total", (), "W"), Port("positive", (), "W"))
    return ports, [*powers, sympy.Add(*powers), sympy.Add(*positive)]


def _joint_reactions(leg: PlacedLinkage) -> tuple[tuple[Port, ...], Exprs]:
    """Friction is a load on the links that its pair joins, and part of what the pair gives them."""
    demand, rubbed = leg.demands(), leg.friction()
    for _, ends in rubbed:
        for body, load in ends:
            demand[body] = demand.get(body, Load()) + -load
    given = dict(FreeBodies(leg.linkage, leg.placing, demand, leg.tape).given)
    cylinders = []
    for friction, ends in rubbed:
        for (body, load), point in zip(ends, end_points(friction, leg.placing), strict=True):
            if friction.pair is None:
                cylinders += [*load.force, load.about(point)]
            else:
                given[friction.pair, body] = given.get((friction.pair, body), Load()) + load
    rows = []
    for pair, body in leg.ends:
        load = given.get((pair, body), Load())
        rows += [*load.force, load.about(leg.placing.joint(pair))]
    return (Port("reactions", (len(leg.end_names), 3), "N, N, N m"),), rows + cylinders


_MOTION_DOC = "gravity, inertia, friction and the ground's force f on the foot, in the platform's axes"

LINKAGE: dict[str, Entry] = {
    "assembly_status": Entry(
        ("q",),
        _assembly_status,
        "Whether the linkage assembles for the drives' values: UNREACHABLE where a dyad cannot close, or a dead point lies between them "
        "and a triad's start (its functions give NaN there), SINGULAR at a dead point: the sine of a transmission angle is below 1e-6.",
        "the discriminant of every dyad",
    ),
    "transmission_angles": Entry(
        ("q",),
        _transmission_angles,
        "Transmission angle of every dyad and triad, in (-pi, pi], 0 and pi at its dead points, one sign on each side: at the inner pin "
        "from the first outer pin to the second; of a slider, between rod and the guide's normal; of a triad, between its third strut's "
        "push and the normal of the way that the pushed point would take without this strut. In order: {groups}.",
        "eqs. (17), (18) of the chapter",
    ),
    "pair_positions": Entry(
        ("q",),
        _pair_positions,
        "Where every pair is, a slider's sliding point, and last the foot, in the platform's frame. Rows: {joints}, foot.",
        "dyad by dyad",
    ),
    "driving_forces": Entry(
        _MOTION,
        _driving_forces,
        f"Efforts of the drives: thrust of cylinders and sliders, torque of pins: {_MOTION_DOC}. Their part of inverse_dynamics.",
        "virtual work; eqs. (14), (15) as corrected",
    ),
    "power": Entry(
        _MOTION,
        _power,
        f"Mechanical power of every q, their sum, and the sum of those above 0 (no energy comes back): {_MOTION_DOC}.",
        "eqs. (16), (20) as corrected: effort times rate, pair by pair",
    ),
    "joint_reactions": Entry(
        _MOTION,
        _joint_reactions,
        f"What every pair gives each link that it joins: force along the plane's X and Y, moment about the pair's point: {_MOTION_DOC}. "
        "Rows: {pairs}.",
        "free bodies, cut free against the order of placement",
    ),
}
