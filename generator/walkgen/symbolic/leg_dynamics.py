"""Dynamics of one leg on a platform that is held: efforts, mass and Coriolis matrices, energies, accelerations."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import sympy

from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.composite_bodies import CompositeBodies
from walkgen.symbolic.coriolis import Coriolis
from walkgen.symbolic.drives import drives, effort_unit
from walkgen.symbolic.first_moments import FirstMoments
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.inertia import Inertia
from walkgen.symbolic.newton_euler import Motion, NewtonEuler
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.regroup import regrouped
from walkgen.symbolic.tape import Tape, Vec, constant_vector, dot, scaled, symbols_of
from walkgen.symbolic.tree import Tree, leg_tree
from walkgen.symbolic.triangular import SingularMatrixError, solved
from walkgen.symbolic.turning import Turning
from walkgen.symbolic.velocities import Velocities

Exprs = Sequence[sympy.Expr]
_ZERO = sympy.S.Zero


class LegDynamics:
    """What a builder works with: one leg's tree, on a tape of its own."""

    def __init__(self, mechanism: Mechanism, leg: Limb, tree: Tree, tape: Tape) -> None:
        self.leg, self.tree, self.tape = leg, tree, tape
        self.ports = {port.name: port for port in _ports(leg.joints)}
        self.symbols = {name: symbols_of(port) for name, port in self.ports.items()}
        self.drives = drives([(joint.name, joint) for joint in leg.joints], mechanism, self.tape)
        x, y, z = (expression(component, parameter_symbols(mechanism)) for component in mechanism.gravity)
        self.gravity: Vec = constant_vector((x, y, z))

    @cached_property
    def turning(self) -> Turning:
        """At q."""
        return Turning(self.tree, self.tape, self.symbols["q"])

    @property
    def still(self) -> tuple[sympy.Expr, ...]:
        """Rates or accelerations that are all 0."""
        return (_ZERO,) * len(self.leg.joints)

    def newton_euler(self, rates: Exprs, accelerations: Exprs, force: Exprs = ()) -> Exprs:
        """Efforts of the joints, friction and rotors included."""
        base = Motion(origin=scaled(sympy.S.NegativeOne, self.gravity))
        forces = [(force[0], force[1], force[2])] if force else []
        efforts = NewtonEuler(self.turning, rates, accelerations, base, forces).efforts
        own = (drive.effort(*pair) for drive, pair in zip(self.drives, zip(rates, accelerations, strict=True), strict=True))
        return tuple(effort + more for effort, more in zip(efforts, own, strict=True))

    @cached_property
    def mass_matrix(self) -> dict[tuple[int, int], sympy.Expr]:
        """Nonzero entries, rotors included."""
        entries = {(row, column): value for row, column, value in CompositeBodies(self.turning).joint_entries()}
        for index, drive in enumerate(self.drives):
            entries[index, index] += drive.rotor
        return entries

    def velocities(self) -> Velocities:
        """Of the links, at qd."""
        return Velocities(self.turning, self.symbols["qd"])


def _inverse_dynamics(leg: LegDynamics) -> Exprs:
    return leg.newton_euler(leg.symbols["qd"], leg.symbols["qdd"], leg.symbols["f"])


def _bias(leg: LegDynamics) -> Exprs:
    return leg.newton_euler(leg.symbols["qd"], leg.still)


def _gravity_torque(leg: LegDynamics) -> Exprs:
    """With masses counted as weights where gravity is a number, so that constants meet."""
    sizes = [abs(component) for component in leg.gravity if component != 0 and component.is_number]
    size = sizes[0] if sizes else sympy.S.One
    base = Motion(origin=constant_vector(scaled(-1 / size, leg.gravity)))
    links = tuple(replace(link, inertia=_weighed(link.inertia, size, leg.tape)) for link in leg.tree.links)
    turning = Turning(replace(leg.tree, links=links), leg.tape, leg.symbols["q"])
    return NewtonEuler(turning, leg.still, leg.still, base).efforts


def _weighed(inertia: Inertia, size: sympy.Expr, tape: Tape) -> Inertia:
    return Inertia(tape.let("weight", size * inertia.mass), tape.vector("weight_moment", scaled(size, inertia.moment)))


def _matrix(entries: dict[tuple[int, int], sympy.Expr], count: int) -> Exprs:
    return tuple(entries.get((row, column), _ZERO) for row in range(count) for column in range(count))


def _mass_matrix(leg: LegDynamics) -> Exprs:
    return _matrix(leg.mass_matrix, len(leg.still))


def _coriolis_matrix(leg: LegDynamics) -> Exprs:
    return _matrix(Coriolis(leg.velocities()).entries(), len(leg.still))


def _forward_dynamics(leg: LegDynamics) -> Exprs:
    bias = leg.newton_euler(leg.symbols["qd"], leg.still, leg.symbols["f"])
    right = [tau - known for tau, known in zip(leg.symbols["tau"], bias, strict=True)]
    return solved(leg.mass_matrix, right, leg.tape)


def _kinetic_energy(leg: LegDynamics) -> Exprs:
    rotors = (drive.rotor * rate**2 for drive, rate in zip(leg.drives, leg.symbols["qd"], strict=True))
    return ((leg.velocities().energy + sympy.Add(*rotors)) / 2,)


def _potential_energy(leg: LegDynamics) -> Exprs:
    return (-dot(leg.gravity, FirstMoments(leg.turning).moment),)


@dataclass(frozen=True)
class Entry:
    """One generated function of a leg: inputs, the output's name, unit and whether it is a vector, matrix or number, builder, words."""

    inputs: tuple[str, ...]
    output: str
    rank: int
    unit: Callable[[Sequence[Joint]], str]
    build: Callable[[LegDynamics], Exprs]
    doc: str
    source: str


def _mass_unit(joints: Sequence[Joint]) -> str:
    kinds = frozenset(joint.kind for joint in joints)
    return {frozenset({"revolute"}): "kg m^2", frozenset({"prismatic"}): "kg"}.get(kinds, "kg m^2, kg m or kg")


def _ports(joints: Sequence[Joint]) -> Iterator[Port]:
    yield from (joint_port("q", joints), joint_port("qd", joints, "/s"), joint_port("qdd", joints, "/s^2"))
    yield Port("tau", (len(joints),), effort_unit(joints))
    yield Port("f", (3,), "N", default=(0.0, 0.0, 0.0))


_HELD = "the platform is held, gravity is the spec's in the platform's axes"
_NEWTON_EULER = "recursive Newton-Euler (Luh, Walker, Paul 1980) with regrouped inertial parameters"
_EULER = "composite rigid bodies (Walker and Orin 1982) with regrouped inertial parameters"
_FORCE = "f is the ground's force on the foot, in the platform's axes"

DYNAMICS: dict[str, Entry] = {
    "inverse_dynamics": Entry(
        ("q", "qd", "qdd", "f"),
        "tau",
        1,
        effort_unit,
        _inverse_dynamics,
        f"Joint efforts of a motion, M qdd + C qd + gravity + friction - J' f; {_HELD}, {_FORCE}.",
        _NEWTON_EULER,
    ),
    "forward_dynamics": Entry(
        ("q", "qd", "tau", "f"),
        "qdd",
        1,
        lambda joints: joint_port("qdd", joints, "/s^2").unit,
        _forward_dynamics,
        f"Joint accelerations of efforts tau; {_HELD}, {_FORCE}.",
        f"{_EULER}, then L' D L (Featherstone 2005)",
    ),
    "mass_matrix": Entry(("q",), "M", 2, _mass_unit, _mass_matrix, "Mass matrix, rotors included.", _EULER),
    "bias": Entry(
        ("q", "qd"),
        "h",
        1,
        effort_unit,
        _bias,
        f"Joint efforts without acceleration, C qd + gravity + friction; {_HELD}.",
        _NEWTON_EULER,
    ),
    "gravity_torque": Entry(("q",), "g", 1, effort_unit, _gravity_torque, f"Joint efforts that hold the leg; {_HELD}.", _NEWTON_EULER),
    "coriolis_matrix": Entry(
        ("q", "qd"),
        "C",
        2,
        lambda joints: f"{effort_unit(joints)} s",
        _coriolis_matrix,
        "Coriolis matrix of Christoffel symbols: dM/dt - 2 C is skew; friction is left out.",
        "composite bodies with moments of their velocities (after Echeandia and Wensing 2021)",
    ),
    "kinetic_energy": Entry(
        ("q", "qd"), "T", 0, lambda _: "J", _kinetic_energy, "Kinetic energy, rotors included; the platform is held.", "sum of p . v / 2"
    ),
    "potential_energy": Entry(
        ("q",),
        "U",
        0,
        lambda _: "J",
        _potential_energy,
        "Potential energy of gravity, 0 for masses at the platform's origin; gravity is the spec's in the platform's axes.",
        "U = - m g . c",
    ),
}


class LegFunctions:
    """Functions of one leg; its tree of links is made once."""

    def __init__(self, mechanism: Mechanism, leg: Limb) -> None:
        self._mechanism, self._leg, self._tape = mechanism, leg, Tape()

    @cached_property
    def _tree(self) -> Tree:
        return regrouped(leg_tree(self._mechanism, self._leg, self._tape), self._tape, floating=False)

    def function(self, name: str) -> Function | None:
        """One of `DYNAMICS`; None where it does not exist: accelerations of a leg that can move without moving mass."""
        entry, joints, tree = DYNAMICS[name], self._leg.joints, self._tree
        leg = LegDynamics(self._mechanism, self._leg, tree, self._tape.fork())
        output = Port(entry.output, (len(joints),) * entry.rank, entry.unit(joints))
        inputs = [leg.ports[port] for port in entry.inputs]
        words = signature(self._mechanism, self._leg.name, name, inputs, [output], entry.doc, entry.source)
        try:
            return leg.tape.function(words, entry.build(leg))
        except SingularMatrixError:
            return None
