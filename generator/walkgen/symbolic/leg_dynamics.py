"""Dynamics of one leg on a platform that is held: efforts, mass and Coriolis matrices, energies, accelerations."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import chain

import sympy

from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.base_parameters import base_regressor, kept_by_regrouping
from walkgen.symbolic.composite_bodies import CompositeBodies
from walkgen.symbolic.coriolis import Coriolis
from walkgen.symbolic.driven_motions import driven_motions
from walkgen.symbolic.drives import drives, effort_unit
from walkgen.symbolic.first_moments import FirstMoments
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.inertia import Inertia
from walkgen.symbolic.linked_tree import whole_bodies
from walkgen.symbolic.minimal import free_motions
from walkgen.symbolic.newton_euler import Motion, NewtonEuler
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.regressor import PARAMETERS, regressor_of
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.tangents import tangents
from walkgen.symbolic.tape import Tape, Vec, constant_vector, dot, scaled, symbols_of
from walkgen.symbolic.tree import Tree
from walkgen.symbolic.triangular import solved
from walkgen.symbolic.turning import Turning
from walkgen.symbolic.velocities import Velocities

Exprs = Sequence[sympy.Expr]
_ZERO = sympy.S.Zero
_DIFFERENTIATED_JOINTS = 3


class LegDynamics:
    """What a builder works with: one leg's tree, on a tape of its own."""

    def __init__(self, mechanism: Mechanism, leg: Limb, tree: Tree, spread: Spread, tape: Tape) -> None:
        self.mechanism, self.leg, self.tree, self.tape = mechanism, leg, tree, tape
        self.spread = spread.on(tape)
        self.ports = {port.name: port for port in dynamics_ports(leg.joints)}
        self.symbols = {name: symbols_of(port) for name, port in self.ports.items()}
        self.drives = drives([(joint.name, joint) for joint in leg.joints], mechanism, self.tape)
        x, y, z = (expression(component, parameter_symbols(mechanism)) for component in mechanism.gravity)
        self.gravity: Vec = constant_vector((x, y, z))

    @cached_property
    def turning(self) -> Turning:
        """At q."""
        return Turning(self.tree, self.tape, self.spread.values)

    @property
    def still(self) -> tuple[sympy.Expr, ...]:
        """Rates or accelerations that are all 0."""
        return (_ZERO,) * len(self.leg.joints)

    def named(self, port: str) -> list[tuple[str, sympy.Symbol]]:
        """Elements of a joint port, each with a name."""
        return [(f"{port}_{joint.name}", symbol) for joint, symbol in zip(self.leg.joints, self.symbols[port], strict=True)]

    def efforts(self, rates: Exprs, accelerations: Exprs, force: Exprs = ()) -> Exprs:
        """Of links and springs."""
        return self.spread.borne(self.virtual_efforts(rates, accelerations, force))

    def inertial(self, rates: Exprs) -> Exprs:
        """Of the links, without gravity and without acceleration."""
        return self.spread.borne(self._pushed(rates, self.still, Motion()).efforts)

    def _pushed(self, rates: Exprs, accelerations: Exprs, base: Motion, forces: Sequence[Vec] = ()) -> NewtonEuler:
        return NewtonEuler(self.turning, self.spread.rates(rates), self.spread.accelerations(rates, accelerations), base, forces)

    def virtual_efforts(self, rates: Exprs, accelerations: Exprs, force: Exprs = ()) -> Exprs:
        """Of the tree's own coordinates, against springs and with the ground's force on the foot."""
        base = Motion(origin=scaled(sympy.S.NegativeOne, self.gravity))
        return self.spread.sprung(self._pushed(rates, accelerations, base, _forces(force)).efforts)

    def rubbed(self, rates: Exprs, force: Exprs = ()) -> Exprs:
        """Efforts against friction in pairs of a linkage, but for that of the drives' own joints."""
        return self.spread.rubbed(rates, lambda: self.virtual_efforts(rates, self.still, force))

    def held(self, turning: Turning, base: Motion) -> Exprs:
        """Efforts that keep links at rest on an accelerated base, against springs."""
        still = (_ZERO,) * len(turning.links)
        return self.spread.borne(self.spread.sprung(NewtonEuler(turning, still, still, base).efforts))

    def moving(self) -> NewtonEuler:
        """At qd and qdd."""
        base = Motion(origin=scaled(sympy.S.NegativeOne, self.gravity))
        return self._pushed(self.symbols["qd"], self.symbols["qdd"], base)

    def newton_euler(self, rates: Exprs, accelerations: Exprs, force: Exprs = ()) -> Exprs:
        """Efforts of the joints, springs, friction and rotors included."""
        efforts = self.efforts(rates, accelerations, force)
        own = (drive.effort(*pair) for drive, pair in zip(self.drives, zip(rates, accelerations, strict=True), strict=True))
        return tuple(map(sympy.Add, efforts, own, self.rubbed(rates, force)))

    @cached_property
    def mass_matrix(self) -> dict[tuple[int, int], sympy.Expr]:
        """Nonzero entries, rotors included."""
        entries = self.spread.matrix({(row, column): value for row, column, value in CompositeBodies(self.turning).joint_entries()})
        for index, drive in enumerate(self.drives):
            entries[index, index] += drive.rotor
        return entries

    def velocities(self) -> Velocities:
        """Of the links, at qd."""
        return Velocities(self.turning, self.spread.rates(self.symbols["qd"]))


def inverse_dynamics(leg: LegDynamics) -> Exprs:
    """Efforts of a motion against a foot force."""
    return leg.newton_euler(leg.symbols["qd"], leg.symbols["qdd"], leg.symbols["f"])


def bias(leg: LegDynamics) -> Exprs:
    """Efforts without acceleration."""
    return leg.newton_euler(leg.symbols["qd"], leg.still)


def gravity_torque(leg: LegDynamics) -> Exprs:
    """With masses counted as weights where gravity is a number, so that constants meet."""
    sizes = [abs(component) for component in leg.gravity if component != 0 and component.is_number]
    size = sizes[0] if sizes else sympy.S.One
    base = Motion(origin=constant_vector(scaled(-1 / size, leg.gravity)))
    links = tuple(replace(link, inertia=_weighed(link.inertia, size, leg.tape)) for link in leg.tree.links)
    return leg.held(Turning(replace(leg.tree, links=links), leg.tape, leg.spread.values), base)


def _weighed(inertia: Inertia, size: sympy.Expr, tape: Tape) -> Inertia:
    return Inertia(tape.let("weight", size * inertia.mass), tape.vector("weight_moment", scaled(size, inertia.moment)))


def _matrix(entries: dict[tuple[int, int], sympy.Expr], count: int) -> Exprs:
    return tuple(entries.get((row, column), _ZERO) for row in range(count) for column in range(count))


def mass_matrix(leg: LegDynamics) -> Exprs:
    """Row-major."""
    return _matrix(leg.mass_matrix, len(leg.still))


def coriolis_matrix(leg: LegDynamics) -> Exprs:
    """Half the slope of C qd by qd where that is cheaper: Christoffel's symbols are symmetric."""
    if leg.spread.free and len(leg.still) > _DIFFERENTIATED_JOINTS:
        return _matrix(Coriolis(leg.velocities()).entries(), len(leg.still))
    slopes = tangents(leg.tape, leg.inertial(leg.symbols["qd"]), leg.named("qd"))
    return tuple(slope / 2 for slope in chain.from_iterable(slopes))


def forward_dynamics(leg: LegDynamics) -> Exprs:
    """Accelerations of efforts and a foot force."""
    bias = leg.newton_euler(leg.symbols["qd"], leg.still, leg.symbols["f"])
    right = [tau - known for tau, known in zip(leg.symbols["tau"], bias, strict=True)]
    return solved(leg.mass_matrix, right, leg.tape)


def kinetic_energy(leg: LegDynamics) -> Exprs:
    """Of links and rotors."""
    rotors = (drive.rotor * rate**2 for drive, rate in zip(leg.drives, leg.symbols["qd"], strict=True))
    return ((leg.velocities().energy + sympy.Add(*rotors)) / 2,)


def potential_energy(leg: LegDynamics) -> Exprs:
    """Of gravity and springs."""
    stored = (energy for springs in leg.spread.springs for energy in springs.energies())
    return (sympy.Add(-dot(leg.gravity, FirstMoments(leg.turning).moment), *stored),)


def inverse_dynamics_derivatives(leg: LegDynamics) -> Exprs:
    """By q, then by qd; a rotor's share depends on neither, of a joint's friction the viscous part on qd."""
    qd = leg.symbols["qd"]
    efforts = tuple(map(sympy.Add, leg.efforts(qd, leg.symbols["qdd"]), leg.rubbed(qd)))
    slopes = tangents(leg.tape, efforts, [*leg.named("q"), *leg.named("qd")])
    count = len(efforts)
    by_q, by_qd = [row[:count] for row in slopes], [row[count:] for row in slopes]
    for index, drive in enumerate(leg.drives):
        by_qd[index][index] += drive.viscous
    return (*chain.from_iterable(by_q), *chain.from_iterable(by_qd))


def regressor(leg: LegDynamics) -> Exprs:
    """Row-major."""
    return tuple(chain.from_iterable(regressor_of(leg.moving(), leg.spread, whole_bodies(leg.leg))))


def base_parameters(leg: LegDynamics) -> Exprs:
    """The regressor of the fewest parameters, row-major, then their values."""
    tree = leg.tree
    if leg.spread.free:
        candidates, motions = kept_by_regrouping(tree), free_motions(tree)
    else:
        candidates = [(index, number) for index in whole_bodies(leg.leg) for number in range(len(PARAMETERS))]
        motions = driven_motions(leg.mechanism, leg.leg, leg.spread)
    rows, values = base_regressor(leg.mechanism, leg.moving(), leg.gravity, leg.spread, candidates, motions)
    return (*chain.from_iterable(rows), *values)


def _forces(force: Exprs) -> list[Vec]:
    return [(force[0], force[1], force[2])] if force else []


def dynamics_ports(joints: Sequence[Joint]) -> Iterator[Port]:
    """What functions of dynamics take."""
    yield from (joint_port("q", joints), joint_port("qd", joints, "/s"), joint_port("qdd", joints, "/s^2"))
    yield Port("tau", (len(joints),), effort_unit(joints))
    yield Port("f", (3,), "N", default=(0.0, 0.0, 0.0))
    yield Port("load", (), "kg")
