"""Functions of the whole robot on a floating base: mass centre, momentum, mass matrix, efforts and what the ground must give."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import sympy

from walkgen.model.mechanism import Joint, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.composite_bodies import CompositeBodies
from walkgen.symbolic.floating import FloatingDynamics, tau_unit, triple
from walkgen.symbolic.forward import flat
from walkgen.symbolic.function import Function
from walkgen.symbolic.linked_tree import spread_robot
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.regroup import regrouped
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.tape import IDENTITY, ZERO_VECTOR, Tape, cross, plus, scaled, symbols_of, times
from walkgen.symbolic.tree import Tree
from walkgen.symbolic.velocities import Velocities, Velocity

Exprs = Sequence[sympy.Expr]
_ZERO = sympy.S.Zero


def _com(robot: FloatingDynamics) -> Exprs:
    return plus(robot.place, robot.world(robot.moments.centre, "centre_world"))


def _com_jacobian(robot: FloatingDynamics) -> Exprs:
    """The base turns the centre about its origin; a joint's column is momentum per mass."""
    reciprocal = robot.tape.let("reciprocal_mass", 1 / robot.moments.mass)
    turns = [robot.world(cross(axis, robot.moments.centre), f"turn_{name}") for axis, name in zip(IDENTITY, "xyz", strict=True)]
    joints = []
    for index, link in enumerate(robot.tree.links):
        unit = robot.tape.vector(f"{link.name}_unit", scaled(reciprocal, robot.moments.unit(index)))
        joints.append(robot.tape.vector(f"{link.name}_column", times(robot.group_axes[index], unit)))
    return flat([*robot.axes, *turns, *robot.by_coordinate(joints)])


def _centroidal(robot: FloatingDynamics) -> Exprs:
    """Momentum for unit rates: the base's columns are those of one rigid body, a joint's those of what it moves."""
    bodies, centre, mass = CompositeBodies(robot.turning), robot.moments.centre, robot.moments.mass
    about = bodies.base.seen_from(scaled(sympy.S.NegativeOne, centre)).named(robot.tape, "centroidal")
    linear = [robot.tape.vector(f"push_{name}", scaled(mass, axis)) for axis, name in zip(robot.axes, "xyz", strict=True)]
    turns = [robot.world(scaled(mass, cross(axis, centre)), f"turn_{name}") for axis, name in zip(IDENTITY, "xyz", strict=True)]
    spins = [robot.world(column, f"spin_{name}") for column, name in zip(about.columns, "xyz", strict=True)]
    forces, moments = [], []
    for index, link in enumerate(robot.tree.links):
        unit, axes = bodies.unit_wrench(index), robot.group_axes[index]
        forces.append(robot.tape.vector(f"{link.name}_force", times(axes, unit.force)))
        moment = plus(times(axes, unit.moment), cross(robot.from_centre[index], forces[-1]))
        moments.append(robot.tape.vector(f"{link.name}_moment", moment))
    upper = flat([*linear, *turns, *robot.by_coordinate(forces)])
    return (*upper, *flat([ZERO_VECTOR] * 3 + spins + robot.by_coordinate(moments)))


def _centroidal_inertia(robot: FloatingDynamics) -> Exprs:
    """The base's columns of angular momentum by spins about its own axes, by the world's instead."""
    about = CompositeBodies(robot.turning).base.seen_from(scaled(sympy.S.NegativeOne, robot.moments.centre)).named(robot.tape, "centroidal")
    spins = [robot.world(column, f"spin_{name}") for column, name in zip(about.columns, "xyz", strict=True)]
    found = {
        (row, column): robot.tape.let(
            f"inertia_{row}{column}", sum((spin[row] * axis[column] for spin, axis in zip(spins, robot.axes, strict=True)), _ZERO)
        )
        for row in range(3)
        for column in range(row + 1)
    }
    return tuple(found[max(row, column), min(row, column)] for row in range(3) for column in range(3))


def _momentum(robot: FloatingDynamics) -> Exprs:
    velocity = Velocity(triple(robot.symbols["v"], 3), triple(robot.symbols["v"], 0))
    return robot.about_centre(Velocities(robot.turning, robot.spread.rates(robot.symbols["v"][6:]), velocity).base_momentum, "momentum")


def _momentum_rate(robot: FloatingDynamics) -> Exprs:
    return robot.about_centre(robot.newton_euler(ZERO_VECTOR).base_wrench, "rate")


def _demanded_wrench(robot: FloatingDynamics) -> Exprs:
    wrench = robot.newton_euler(robot.gravity).base_wrench
    force, moment = robot.world(wrench.force, "force_world"), robot.world(wrench.moment, "moment_world")
    load = (force, plus(moment, cross(robot.place, force)))
    return tuple(-component for component in chain.from_iterable(load))


def _mass_matrix(robot: FloatingDynamics) -> Exprs:
    bodies = CompositeBodies(robot.turning)
    size = 6 + len(robot.joints)
    found: dict[tuple[int, int], sympy.Expr] = {}
    wrenches = [wrench for _, wrench in bodies.columns]
    forces, moments = (robot.by_coordinate([getattr(wrench, part) for wrench in wrenches]) for part in ("force", "moment"))
    units = [*_base_units(bodies), *([*force, *moment] for force, moment in zip(forces, moments, strict=True))]
    for column, entries in enumerate(units):
        for row, entry in enumerate(entries):
            found[row, column] = found[column, row] = entry
    joints = robot.spread.matrix({(row, column): value for row, column, value in bodies.joint_entries()})
    for (row, column), value in joints.items():
        found[6 + row, 6 + column] = value
    for index, drive in enumerate(robot.drives):
        found[6 + index, 6 + index] += drive.rotor
    return tuple(found.get((row, column), _ZERO) for row in range(size) for column in range(size))


def _base_units(bodies: CompositeBodies) -> Iterator[list[sympy.Expr]]:
    """Force and moment that unit accelerations of the base take."""
    base = bodies.base
    for axis in IDENTITY:
        yield [*scaled(base.mass, axis), *cross(base.moment, axis)]
    for axis in IDENTITY:
        yield [*cross(axis, base.moment), *base.angular(axis)]


def _inverse_dynamics(robot: FloatingDynamics) -> Exprs:
    forces = robot.symbols["foot_forces"]
    local = [robot.local(triple(forces, 3 * foot), f"force_on_{leg.name}") for foot, leg in enumerate(robot.mechanism.legs)]
    motion = robot.newton_euler(robot.gravity, local)
    rates, accelerations = robot.symbols["v"][6:], robot.symbols["a"][6:]
    own = (drive.effort(*pair) for drive, pair in zip(robot.drives, zip(rates, accelerations, strict=True), strict=True))
    rubbed = robot.spread.rubbed(rates, lambda: robot.spread.sprung(robot.steady(robot.gravity, local).efforts))
    efforts = map(sympy.Add, robot.spread.borne(robot.spread.sprung(motion.efforts)), own, rubbed)
    return (*motion.base_wrench.force, *motion.base_wrench.moment, *efforts)


@dataclass(frozen=True)
class Entry:
    """One generated function: inputs, the output's name, shape for 6 + nq components of v, and unit, builder, words."""

    inputs: tuple[str, ...]
    output: str
    shape: Callable[[int], tuple[int, ...]]
    unit: Callable[[Sequence[Joint]], str]
    build: Callable[[FloatingDynamics], Exprs]
    doc: str
    source: str
    needs_mass: bool = True


def _always(unit: str) -> Callable[[Sequence[Joint]], str]:
    return lambda _: unit


_STATE = "world axes; v is the base's linear and angular velocity in its axes, then the joint rates"
_MOMENTUM = "linear momentum, then angular about the centre of mass"
_NEWTON_EULER = "recursive Newton-Euler (Luh, Walker, Paul 1980) with regrouped inertial parameters"
_EULER = "composite rigid bodies (Walker and Orin 1982) with regrouped inertial parameters"
_RATES = "a holds the time derivatives of v's components"

ROBOT_DYNAMICS: dict[str, Entry] = {
    "com": Entry(("base_pose", "q"), "c", lambda _: (3,), _always("m"), _com, "Centre of mass in the world.", "sum of m p / sum of m"),
    "com_jacobian": Entry(
        ("base_pose", "q"),
        "J",
        lambda size: (3, size),
        _always("m per unit of v"),
        _com_jacobian,
        f"Velocity of the centre of mass by v; {_STATE}.",
        "momentum per mass of what each joint moves",
    ),
    "centroidal_momentum_matrix": Entry(
        ("base_pose", "q"),
        "A",
        lambda size: (6, size),
        _always("kg m/s and kg m^2/s per unit of v"),
        _centroidal,
        f"Momentum by v: {_MOMENTUM}; {_STATE}.",
        f"{_EULER}; Orin and Goswami 2008",
    ),
    "centroidal_inertia": Entry(
        ("base_pose", "q"),
        "I",
        lambda _: (3, 3),
        _always("kg m^2"),
        _centroidal_inertia,
        "Rotational inertia of the robot about its centre of mass, world axes, its joints locked; rotors left out.",
        f"{_EULER}; Orin, Goswami and Lee 2013",
    ),
    "momentum": Entry(
        ("base_pose", "q", "v"),
        "h",
        lambda _: (6,),
        _always("kg m/s and kg m^2/s"),
        _momentum,
        f"Momentum of the robot: {_MOMENTUM}; {_STATE}.",
        "sum over the links, from the feet inwards",
    ),
    "momentum_rate": Entry(
        ("base_pose", "q", "v", "a"),
        "hd",
        lambda _: (6,),
        _always("N and N m"),
        _momentum_rate,
        f"Time derivative of the momentum: {_MOMENTUM}; {_STATE}; {_RATES}.",
        _NEWTON_EULER,
    ),
    "demanded_wrench": Entry(
        ("base_pose", "q", "v", "a"),
        "w",
        lambda _: (6,),
        _always("N and N m"),
        _demanded_wrench,
        "Load of gravity and inertia on the robot: force, then moment about the world's origin, world axes. The ground has to give the "
        f"opposite, and contact_forces takes it as wrench; {_RATES}.",
        _NEWTON_EULER,
        needs_mass=False,
    ),
    "floating_mass_matrix": Entry(
        ("base_pose", "q"),
        "M",
        lambda size: (size, size),
        _always("kg, kg m and kg m^2"),
        _mass_matrix,
        "Mass matrix of v: the base's linear and angular components in its axes, then the joints; rotors included.",
        _EULER,
        needs_mass=False,
    ),
    "floating_inverse_dynamics": Entry(
        ("base_pose", "q", "v", "a", "foot_forces"),
        "tau",
        lambda size: (size,),
        tau_unit,
        _inverse_dynamics,
        "Efforts of a motion, dual to v: the base's force and moment in its axes, then the joints, friction included. foot_forces are the "
        f"ground's on the feet, world axes; {_RATES}.",
        _NEWTON_EULER,
        needs_mass=False,
    ),
}


class FloatingFunctions:
    """Functions of the robot on a floating base; its tree of links is made once."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism, self._tape = mechanism, Tape()

    @cached_property
    def _described(self) -> tuple[Tree, Spread]:
        q = symbols_of(joint_port("q", [joint for limb in self._mechanism.limbs for joint in limb.joints]))
        return spread_robot(self._mechanism, q, self._tape)

    @cached_property
    def _tree(self) -> Tree:
        return regrouped(self._described[0], self._tape, floating=True)

    def function(self, name: str) -> Function | None:
        """One of `ROBOT_DYNAMICS`; None where it does not exist: there is no centre of a mass that is 0."""
        entry, tree = ROBOT_DYNAMICS[name], self._tree
        robot = FloatingDynamics(self._mechanism, tree, self._described[1], self._tape.fork())
        if entry.needs_mass and robot.moments.mass == 0:
            return None
        output = Port(entry.output, entry.shape(6 + len(robot.joints)), entry.unit(robot.joints))
        inputs = [robot.ports[port] for port in entry.inputs]
        words = signature(self._mechanism, "", name, inputs, [output], entry.doc, entry.source)
        return robot.tape.function(words, entry.build(robot))

    def mass(self, tape: Tape) -> sympy.Expr:
        """Of the robot, onto another tape: it depends on runtime parameters alone."""
        tree = self._described[0]
        masses = dict(self._tape.lines)
        total = sum((link.inertia.mass for link in tree.links), tree.base.mass)
        while names := total.free_symbols & masses.keys():
            total = total.xreplace({name: masses[name] for name in names})
        return tape.let("own_mass", total)

    def weight(self) -> Function | None:
        """What gravity does to the robot held in its joints: where, in the base's frame, and the force, in the world; None without mass."""
        tree = self._tree
        robot = FloatingDynamics(self._mechanism, tree, self._described[1], self._tape.fork())
        if robot.moments.mass == 0:
            return None
        outputs = [Port("centre_of_mass", (3,), "m"), Port("weight", (3,), "N")]
        words = signature(self._mechanism, "", "weight", [robot.ports["q"]], outputs, "", "sum of m p / sum of m; m g")
        return robot.tape.function(words, [*robot.moments.centre, *scaled(robot.moments.mass, robot.gravity)])
