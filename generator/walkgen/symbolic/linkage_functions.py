"""Functions that only legs with a linkage have: whether it assembles, how well it transmits, what drives and pairs carry."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.spec.assur import SIDES, Group, Triad
from walkgen.symbolic.branches import BAD_INPUT, OK, SINGULAR, UNREACHABLE
from walkgen.symbolic.choices import less
from walkgen.symbolic.closure import assembled_port, forward_placing
from walkgen.symbolic.drives import effort_unit
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.free_bodies import FreeBodies, Load, at
from walkgen.symbolic.function import Angle, Finite, Function, Less, Residue, Select
from walkgen.symbolic.leg_dynamics import LegDynamics
from walkgen.symbolic.linked_tree import bodies_with_mass, spread_leg
from walkgen.symbolic.placing import Placing
from walkgen.symbolic.planar import difference, inner, outer
from walkgen.symbolic.ports import joint_port, signature
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
    build: Callable[["LinkageFunctions"], tuple[tuple[Port, ...], Exprs]]
    doc: str
    source: str


class LinkageFunctions:
    """Of one leg, each on a tape of its own."""

    def __init__(self, mechanism: Mechanism, leg: Limb) -> None:
        assert leg.linkage is not None
        self._mechanism, self.leg, self.linkage = mechanism, leg, leg.linkage
        self.parameters = parameter_symbols(mechanism)

    def function(self, name: str) -> Function:
        """One of `LINKAGE`."""
        entry = LINKAGE[name]
        self.tape = Tape()
        tree, spread = spread_leg(self._mechanism, self.leg, symbols_of(joint_port("q", self.leg.joints)), self.tape)
        self.dynamics = LegDynamics(self._mechanism, self.leg, tree, spread, self.tape)
        self.drives = self.leg.joints[len(self.leg.serial) :]
        self.placing = forward_placing(self.leg, self.dynamics.symbols["q"][len(self.leg.serial) :], self.parameters, self.tape)
        ports, values = entry.build(self)
        inputs = [self.dynamics.ports[port] for port in entry.inputs]
        doc = entry.doc.format(pairs=", ".join(self._ends), groups=", ".join(group.name for group in self.groups))
        return self.tape.function(signature(self._mechanism, self.leg.name, name, inputs, ports, doc, entry.source), values)

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
    def _ends(self) -> list[str]:
        structure = self.linkage.structure
        return [f"{structure.pairs[pair].name} on {structure.names[body]}" for pair, body in self.ends]

    def efforts(self) -> Exprs:
        """Of all q at their motion."""
        symbols = self.dynamics.symbols
        return self.dynamics.newton_euler(symbols["qd"], symbols["qdd"], symbols["f"])

    def demands(self) -> dict[int, Load]:
        """By link, what its pairs must give it in the plane: what the tree's joints of each link would."""
        virtual = self.dynamics.virtual_efforts()
        start, found = len(self.leg.serial), dict[int, Load]()
        for body, mass in bodies_with_mass(self.linkage):
            centre = self.placing.point(body, self.placing.planar(mass.com))
            found[body] = at(centre, (virtual[start], virtual[start + 1])) + Load(moment=virtual[start + 2])
            start += 3
        body, point = self.linkage.foot
        foot = at(self.placing.point(body, self.placing.planar(point)), (virtual[start], virtual[start + 1]))
        found[body] = found.get(body, Load()) + foot
        return found


def _assembly_status(leg: LinkageFunctions) -> tuple[tuple[Port, ...], Exprs]:
    """The first group that fails decides: those after it have no place."""
    status: sympy.Expr = OK
    for margin in reversed(leg.placing.margins):
        status = Select(less(margin.value, 0), UNREACHABLE, Select(less(margin.value, _DEAD), SINGULAR, status))
    if leg.linkage.forward.triads:
        (assembled,) = symbols_of(assembled_port(leg.leg))
        status = Select(Less(0, assembled), assembled, status)
    taint = leg.tape.let("taint", sympy.Add(*(Residue(value) for value in (*leg.dynamics.symbols["q"], *leg.parameters.values()))))
    return (Port("status", kind="integer"),), [Select(Finite(taint), status, BAD_INPUT)]


def _transmission_angles(leg: LinkageFunctions) -> tuple[tuple[Port, ...], Exprs]:
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


def _driving_forces(leg: LinkageFunctions) -> tuple[tuple[Port, ...], Exprs]:
    efforts = leg.efforts()[-len(leg.drives) :]
    return (Port("forces", (len(efforts),), effort_unit(leg.drives)),), efforts


def _power(leg: LinkageFunctions) -> tuple[tuple[Port, ...], Exprs]:
    efforts = leg.efforts()
    powers = [leg.tape.let("power", effort * rate) for effort, rate in zip(efforts, leg.dynamics.symbols["qd"], strict=True)]
    positive = [Select(Less(power, 0), 0, power) for power in powers]
    ports = (Port("power", (len(powers),), "W"), Port("total", (), "W"), Port("positive", (), "W"))
    return ports, [*powers, sympy.Add(*powers), sympy.Add(*positive)]


def _joint_reactions(leg: LinkageFunctions) -> tuple[tuple[Port, ...], Exprs]:
    found = FreeBodies(leg.linkage, leg.placing, leg.demands(), leg.tape)
    rows = []
    for pair, body in leg.ends:
        load = found.given.get((pair, body), Load())
        rows += [*load.force, load.about(leg.placing.joint(pair))]
    return (Port("reactions", (len(leg.ends), 3), "N, N, N m"),), rows


_MOTION_DOC = "gravity, inertia, friction of the drives and the ground's force f on the foot, in the platform's axes"

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
    "driving_forces": Entry(
        _MOTION,
        _driving_forces,
        f"Efforts of the drives: thrust of cylinders and sliders, torque of pins: {_MOTION_DOC}. The last of inverse_dynamics.",
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
