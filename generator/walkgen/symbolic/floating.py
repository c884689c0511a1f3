"""The whole robot on a floating base: its tree of links, and vectors carried between the base's axes and the world's."""

from collections.abc import Iterator, Sequence
from functools import cached_property

import sympy

from walkgen.model.mechanism import Joint, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.drives import Drive, drives, effort_unit
from walkgen.symbolic.first_moments import FirstMoments
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.newton_euler import Motion, NewtonEuler
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.tape import ZERO_VECTOR, Columns, Tape, Vec, constant_vector, cross, dot, minus, plus, scaled, symbols_of, times
from walkgen.symbolic.tree import BASE, Tree
from walkgen.symbolic.turning import Turning
from walkgen.symbolic.wrench import Wrench

Exprs = Sequence[sympy.Expr]
_ZERO = sympy.S.Zero


class FloatingDynamics:
    """What a builder works with: the robot's tree, on a tape of its own."""

    def __init__(self, mechanism: Mechanism, tree: Tree, spread: Spread, tape: Tape) -> None:
        self.mechanism, self.tree, self.spread, self.tape = mechanism, tree, spread.on(tape), tape
        self.joints = tuple(joint for limb in mechanism.limbs for joint in limb.joints)
        self.ports = {port.name: port for port in _ports(self.joints, len(mechanism.legs))}
        self.symbols = {name: symbols_of(port) for name, port in self.ports.items()}
        x, y, z = (expression(component, parameter_symbols(mechanism)) for component in mechanism.gravity)
        self.gravity: Vec = constant_vector((x, y, z))

    @cached_property
    def turning(self) -> Turning:
        """At q."""
        return Turning(self.tree, self.tape, self.spread.values)

    @cached_property
    def drives(self) -> tuple[Drive, ...]:
        """Friction and rotor of every joint."""
        return drives(
            [(f"{limb.name}_{joint.name}", joint) for limb in self.mechanism.limbs for joint in limb.joints], self.mechanism, self.tape
        )

    @cached_property
    def moments(self) -> FirstMoments:
        """Of the robot, at q."""
        return FirstMoments(self.turning)

    @cached_property
    def axes(self) -> Columns:
        """The base's axes in the world."""
        pose = self.symbols["base_pose"]
        x, y, z = ((pose[column], pose[4 + column], pose[8 + column]) for column in range(3))
        return (x, y, z)

    @property
    def place(self) -> Vec:
        """The base's origin in the world."""
        pose = self.symbols["base_pose"]
        return (pose[3], pose[7], pose[11])

    def world(self, vector: Vec, name: str) -> Vec:
        """A vector of the base's axes in the world's."""
        return self.tape.vector(name, times(self.axes, vector))

    def local(self, vector: Vec, name: str) -> Vec:
        """A vector of the world's axes in the base's."""
        x, y, z = (dot(column, vector) for column in self.axes)
        return self.tape.vector(name, (x, y, z))

    def motion(self, gravity: Vec, a: Exprs) -> Motion:
        """The base's, from v and its time derivative a; its origin accelerates by dv/dt + w x v less gravity (world axes)."""
        velocity, spin = (triple(self.symbols["v"], start) for start in (0, 3))
        linear, angular = (triple(a, start) for start in (0, 3))
        x, y, z = spin
        origin = plus(minus(linear, self.local(gravity, "gravity")), cross(spin, velocity))
        pole = (self.tape.let("base_pole_x", x * z + angular[1]), self.tape.let("base_pole_y", y * z - angular[0]))
        return Motion(spin, angular[2], pole, self.tape.vector("base_acceleration", origin))

    def newton_euler(self, gravity: Vec, forces: Sequence[Vec] = ()) -> NewtonEuler:
        """At v and a."""
        return self._accelerated(self.symbols["a"], gravity, forces)

    def steady(self, gravity: Vec, forces: Sequence[Vec]) -> NewtonEuler:
        """At v, with a = 0."""
        return self._accelerated((_ZERO,) * len(self.symbols["a"]), gravity, forces)

    def _accelerated(self, a: Exprs, gravity: Vec, forces: Sequence[Vec]) -> NewtonEuler:
        rates = self.symbols["v"][6:]
        own = self.spread.rates(rates), self.spread.accelerations(rates, a[6:])
        return NewtonEuler(self.turning, *own, self.motion(gravity, a), forces)

    def about_centre(self, wrench: Wrench, name: str) -> Exprs:
        """Of the base's origin and axes, about the centre of mass in the world's axes."""
        moment = self.tape.vector(f"{name}_about_centre", minus(wrench.moment, cross(self.moments.centre, wrench.force)))
        return (*self.world(wrench.force, f"{name}_force_world"), *self.world(moment, f"{name}_moment_world"))

    @cached_property
    def group_axes(self) -> tuple[Columns, ...]:
        """Of every link's group, in the world."""
        found: list[Columns] = []
        for link in self.tree.links:
            if link.turn is None:
                found.append(found[link.parent])
                continue
            before = self.axes if link.parent == BASE else self._link_axes(link.parent, found[link.parent])
            x, y, z = (
                self.tape.vector(f"{link.name}_group_{axis}", times(before, column)) for axis, column in zip("xyz", link.turn, strict=True)
            )
            found.append((x, y, z))
        return tuple(found)

    def _link_axes(self, index: int, group: Columns) -> Columns:
        name = self.tree.links[index].name
        cosine, sine = self.turning.cosine_sine(index)
        x = self.tape.vector(f"{name}_frame_x", plus(scaled(cosine, group[0]), scaled(sine, group[1])))
        y = self.tape.vector(f"{name}_frame_y", minus(scaled(cosine, group[1]), scaled(sine, group[0])))
        return (x, y, group[2])

    @cached_property
    def from_centre(self) -> tuple[Vec, ...]:
        """From the centre of mass to every link's origin, in the world's axes."""
        start = scaled(sympy.S.NegativeOne, self.world(self.moments.centre, "centre_world"))
        found: list[Vec] = []
        for index, link in enumerate(self.tree.links):
            before = start if link.parent == BASE else found[link.parent]
            way = times(self._side_axes(index), self.turning.lever(index))
            found.append(self.tape.vector(f"{link.name}_from_centre", plus(before, way)))
        return tuple(found)

    def _side_axes(self, index: int) -> Columns:
        """Of a link's parent's side, in the world."""
        link = self.tree.links[index]
        if link.parent == BASE:
            return self.axes
        return self.group_axes[index] if link.turn is None else self._link_axes(link.parent, self.group_axes[link.parent])

    def by_coordinate(self, columns: Sequence[Vec]) -> list[Vec]:
        """Columns in the order of the links, as columns in the order of q."""
        found = [ZERO_VECTOR] * len(columns)
        for link, column in zip(self.tree.links, columns, strict=True):
            found[link.coordinate] = column
        rows = [self.spread.borne([column[row] for column in found]) for row in range(3)]
        return [(x, y, z) for x, y, z in zip(*rows, strict=True)]


def triple(values: Exprs, start: int) -> Vec:
    """Three elements in a row."""
    return (values[start], values[start + 1], values[start + 2])


def _ports(joints: Sequence[Joint], feet: int) -> Iterator[Port]:
    """base_pose is world_T_platform; v and a hold the base's linear and angular components, in its axes, then the joints'."""
    rate, acceleration = (f"m/s{power}, rad/s{power}, then {joint_port('q', joints).unit}/s{power}" for power in ("", "^2"))
    yield Port("base_pose", (4, 4), "1 and m")
    yield joint_port("q", joints)
    yield Port("v", (6 + len(joints),), rate)
    yield Port("a", (6 + len(joints),), acceleration)
    yield Port("foot_forces", (feet, 3), "N", default=(0.0,) * (3 * feet))


def tau_unit(joints: Sequence[Joint]) -> str:
    """Of base wrench and efforts."""
    return f"N, N m, then {effort_unit(joints)}"
