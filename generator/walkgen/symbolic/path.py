"""A path of joints from a platform to a tip, cut into groups of parallel axes whose angles add up.

Inside a group every vector turns in one plane, so sin and cos are taken of the summed angle and the foot's
position is accumulated from the tip towards the base: the least work a DH product can be done with.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import sympy

from walkgen.model.mechanism import Joint, Limb
from walkgen.signature import Port
from walkgen.symbolic.frames import Frame, Parameters, cosine_sine, expression, frame_of
from walkgen.symbolic.tape import IDENTITY, ZERO_VECTOR, Columns, Tape, Vec, cross, plus, scaled, symbols_of, times


@dataclass(frozen=True)
class Path:
    """`links[i]` is the constant pose before joint i's motion, `links[n]` leads to the tip; `q` are the user's joint values."""

    joints: tuple[Joint, ...]
    links: tuple[Frame, ...]
    afters: tuple[Frame, ...]
    mount: Frame
    q: tuple[sympy.Expr, ...]
    parameters: Parameters


def path_of(limbs: Sequence[Limb], q: Sequence[sympy.Expr], parameters: Parameters) -> Path:
    """Join limbs end to end: connecting chains from the root, then a leg, or a single limb."""
    links: list[Frame] = []
    afters: list[Frame] = []
    pending = Frame()
    for limb in limbs:
        pending = pending * frame_of(limb.mount, parameters)
        for joint in limb.joints:
            links.append(pending * frame_of(joint.before, parameters))
            pending = frame_of(joint.after, parameters)
            afters.append(pending)
        pending = pending * frame_of(limb.tip, parameters)
    if limbs[-1].curved_sole is not None:
        pending = pending * touched(limbs[-1])
    joints = tuple(joint for limb in limbs for joint in limb.joints)
    mount = frame_of(limbs[0].mount, parameters)
    return Path(joints, (*links, pending), tuple(afters), mount, tuple(q), parameters)


def touched(leg: Limb) -> Frame:
    """From the foot frame of a leg with a curved sole to where that touches the ground, an unknown."""
    x, y = symbols_of(touch_port(leg))
    return Frame(origin=(x, y, sympy.S.Zero))


def touch_port(leg: Limb) -> Port:
    """The foot point of a leg with a curved sole, in its foot's axes."""
    return Port(f"{leg.name}_touch", (2,), "m")


@dataclass(frozen=True)
class Place:
    """Orientation world * Rz(angle + offset) * diag(1, flip, flip): `world` is the group's, by columns.

    `angle` sums the group's joint angles, `offset` is its constant part, `label` names it.
    """

    world: Columns = IDENTITY
    angle: sympy.Expr = sympy.S.Zero
    offset: sympy.Expr = sympy.S.Zero
    flip: int = 1
    label: str = ""
    group: int = 0


class Kinematics:
    """Position, rotation, Jacobian and second derivatives of a path's tip, written on a tape when asked for."""

    def __init__(self, path: Path, tape: Tape) -> None:
        self.path = path
        self.tape = tape
        self.parameters = path.parameters

    @cached_property
    def _places(self) -> tuple[tuple[Place, Place], ...]:
        """For every joint, the place before its motion and after it."""
        places = []
        place = Place()
        for joint, link, value in zip(self.path.joints, self.path.links, self._values, strict=False):
            before = self._turned(place, link.rotation)
            place = self._moved(before, joint, value)
            places.append((before, place))
        return tuple(places)

    @cached_property
    def _values(self) -> tuple[sympy.Expr, ...]:
        """The mechanism's joint values, sign * q + zero, split as in `_moved`."""
        return tuple(joint.sign * q for joint, q in zip(self.path.joints, self.path.q, strict=True))

    def _zero(self, joint: Joint) -> sympy.Expr:
        return expression(joint.zero, self.path.parameters)

    def _moved(self, place: Place, joint: Joint, value: sympy.Expr) -> Place:
        if joint.kind == "prismatic":
            return place
        angle = self.tape.let(f"angle_{_join(place.label, joint.name)}", place.angle + place.flip * value)
        label = _join(place.label, joint.name)
        return replace(place, angle=angle, offset=place.offset + place.flip * self._zero(joint), label=label)

    def _turned(self, place: Place, rotation: Columns) -> Place:
        """The place after a constant rotation: the same group if the z axis stays on its line, a new one otherwise."""
        yaw = yaw_of(rotation)
        if yaw is not None:
            return replace(place, offset=place.offset + place.flip * yaw, flip=place.flip * int(rotation[2][2]))
        here = self._columns(place)
        x, y, z = (
            self.tape.vector(f"group_{place.label}_{name}", times(here, column)) for name, column in zip("xyz", rotation, strict=True)
        )
        return Place(world=(x, y, z), group=place.group + 1)

    def _cos_sin(self, place: Place) -> tuple[sympy.Expr, sympy.Expr]:
        """Of the place's whole angle."""
        if place.angle == 0:
            return cosine_sine(place.offset)
        return quarter_turned(place.label, place.angle, place.offset, self.tape)

    def _planar(self, place: Place, vector: Vec, name: str) -> Vec:
        """Rz(angle) diag(1, flip, flip) * vector: into the group's axes."""
        cosine, sine = self._cos_sin(place)
        x, y, z = vector[0], place.flip * vector[1], place.flip * vector[2]
        return self.tape.vector(name, (cosine * x - sine * y, sine * x + cosine * y, z))

    def _columns(self, place: Place) -> Columns:
        """The place's orientation in the base's axes."""
        if place.angle == 0 and place.offset == 0 and place.flip == 1:
            return place.world
        cosine, sine = self._cos_sin(place)
        wx, wy, wz = place.world
        x = self.tape.vector(f"frame_{place.label}_x", plus(scaled(cosine, wx), scaled(sine, wy)))
        y = self.tape.vector(f"frame_{place.label}_y", scaled(sympy.Integer(place.flip), plus(scaled(-sine, wx), scaled(cosine, wy))))
        return (x, y, scaled(sympy.Integer(place.flip), wz))

    @cached_property
    def _levers(self) -> tuple[Vec, ...]:
        """From the base, then from every joint, to the tip, in the group's axes; found from the tip inwards."""
        levers: list[Vec] = []
        name = self.path.joints[-1].name
        lever = self._planar(self._places[-1][1], self.path.links[-1].origin, f"{name}_to_tip")
        for index in reversed(range(len(self.path.joints))):
            levers.append(lever)
            lever = self._through(index, self._shifted(index, lever))
        return (lever, *reversed(levers))

    def _shifted(self, index: int, lever: Vec) -> Vec:
        """The lever seen from before a joint's shift along its axis."""
        joint = self.path.joints[index]
        if joint.kind == "revolute":
            return lever
        shift = self._places[index][0].flip * (self._values[index] + self._zero(joint))
        return self.tape.vector(f"{joint.name}_shift", (lever[0], lever[1], lever[2] + shift))

    def _through(self, index: int, lever: Vec) -> Vec:
        """The lever carried from joint `index` back over the link before it."""
        previous = self._places[index - 1][1] if index else Place()
        link = self.path.links[index]
        name = f"{self.path.joints[index - 1].name}_to_tip" if index else "position"
        if self._places[index][0].group == previous.group:
            offset = self._planar(previous, link.origin, f"{name}_link")
            return self.tape.vector(name, plus(offset, lever))
        inner = self.tape.vector(f"{name}_inner", plus(link.origin, times(link.rotation, lever)))
        return self._planar(previous, inner, name)

    @cached_property
    def position(self) -> Vec:
        """The tip's origin in the base's axes."""
        return self._levers[0]

    @cached_property
    def rotation(self) -> Columns:
        """The tip's axes, by columns."""
        x, y, z = (self._oriented(self._places[-1][1], column, "tip") for column in self.path.links[-1].rotation)
        return (x, y, z)

    def _oriented(self, place: Place, vector: Vec, name: str) -> Vec:
        return self.tape.vector(f"{name}_axis", times(self._columns(place), vector))

    @cached_property
    def axes(self) -> tuple[Vec, ...]:
        """Every joint's axis in the base's axes, positive for growing q."""
        return tuple(
            scaled(sympy.Integer(before.flip * joint.sign), before.world[2])
            for joint, (before, _) in zip(self.path.joints, self._places, strict=True)
        )

    @cached_property
    def angular(self) -> tuple[Vec, ...]:
        """Angular velocity of the tip per unit rate of every joint."""
        return tuple(axis if joint.kind == "revolute" else ZERO_VECTOR for joint, axis in zip(self.path.joints, self.axes, strict=True))

    def _sign(self, index: int) -> int:
        return self._places[index][0].flip * self.path.joints[index].sign

    def _local_column(self, index: int) -> Vec:
        """A Jacobian column in the axes of the joint's group: D_i p of the chapter's eq. for J, z x lever or z."""
        sign = sympy.Integer(self._sign(index))
        if self.path.joints[index].kind == "prismatic":
            return (sympy.S.Zero, sympy.S.Zero, sign)
        lever = self._levers[index + 1]
        return (-sign * lever[1], sign * lever[0], sympy.S.Zero)

    @cached_property
    def jacobian(self) -> tuple[Vec, ...]:
        """Columns dp/dq_i in the base's axes."""
        return tuple(self._in_base(index, self._local_column(index), f"J_{joint.name}") for index, joint in enumerate(self.path.joints))

    def _in_base(self, index: int, vector: Vec, name: str) -> Vec:
        return self.tape.vector(name, times(self._places[index][0].world, vector))

    def second(self, first: int, last: int) -> Vec:
        """d2p / dq_first dq_last for first <= last: D_first D_last p, z_first x J_last or 0 (theory, D_i operators)."""
        names = f"H_{self.path.joints[first].name}_{self.path.joints[last].name}"
        if self.path.joints[first].kind == "prismatic":
            return ZERO_VECTOR
        if self._places[first][0].group == self._places[last][0].group:
            x, y, _ = self._local_column(last)
            sign = self._sign(first)
            return self._in_base(last, (-sign * y, sign * x, sympy.S.Zero), names)
        return self.tape.vector(names, cross(self.axes[first], self.jacobian[last]))

    def bias(self, rates: Sequence[sympy.Expr], columns: Sequence[Vec] = (), start: Vec = ZERO_VECTOR) -> tuple[Vec, Vec]:
        """Jdot qd, linear and angular: sum of (w_i + w_(i-1)) x J_i qd_i and of w_(i-1) x z_i qd_i, w_i the rate through joint i.

        Where `columns` of J are given they are not computed; the linear sum may `start` from something else.
        """
        tape = self.tape
        linear, angular, rate = start, ZERO_VECTOR, ZERO_VECTOR
        for joint, column, axis, qd in zip(self.path.joints, columns or self.jacobian, self.angular, rates, strict=True):
            spin = tape.vector(f"spin_{joint.name}", scaled(qd, axis))
            flow = tape.vector(f"flow_{joint.name}", scaled(qd, column))
            through = tape.vector(f"rate_{joint.name}", plus(rate, spin))
            twice = tape.vector(f"rates_{joint.name}", plus(through, rate))
            linear = tape.vector(f"bias_{joint.name}", plus(linear, cross(twice, flow)))
            angular = tape.vector(f"turn_{joint.name}", plus(angular, cross(rate, spin)))
            rate = through
        return linear, angular

    @cached_property
    def frames(self) -> tuple[tuple[Columns, Vec], ...]:
        """The mount, then the frame that moves with every joint: axes by columns and origin, in the base's axes."""
        return ((self.path.mount.rotation, self.path.mount.origin), *self._moving_frames())

    def _moving_frames(self) -> Iterator[tuple[Columns, Vec]]:
        origin, previous = ZERO_VECTOR, Place()
        for index, (joint, (before, place)) in enumerate(zip(self.path.joints, self._places, strict=True)):
            origin = self.tape.vector(f"{joint.name}_origin", plus(origin, times(self._columns(previous), self.path.links[index].origin)))
            if joint.kind == "prismatic":
                shift = joint.sign * self.path.q[index] + self._zero(joint)
                along = scaled(before.flip * shift, before.world[2])
                origin = self.tape.vector(f"{joint.name}_shifted", plus(origin, along))
            columns, after = self._columns(place), self.path.afters[index]
            x, y, z = (self.tape.vector(f"{joint.name}_axis", times(columns, column)) for column in after.rotation)
            yield (x, y, z), self.tape.vector(f"{joint.name}_frame", plus(origin, times(columns, after.origin)))
            previous = place


def quarter_turned(label: str, angle: sympy.Expr, offset: sympy.Expr, tape: Tape) -> tuple[sympy.Expr, sympy.Expr]:
    """cos and sin of angle + offset; quarter turns only swap and negate, so that the names keep their meaning."""
    quarters = 2 * offset / sympy.pi
    if not quarters.is_integer:
        label, angle, quarters = f"turned_{label}", tape.let(f"turned_{label}", angle + offset), sympy.S.Zero
    cosine, sine = tape.let(f"cos_{label}", sympy.cos(angle)), tape.let(f"sin_{label}", sympy.sin(angle))
    return ((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine))[int(quarters) % 4]


def yaw_of(rotation: Columns) -> sympy.Expr | None:
    """The angle of a constant rotation that keeps the z axis on its line: Rz(yaw) diag(1, flip, flip); None for others."""
    if abs(rotation[2][2]) != 1 or not all(entry.is_number for entry in rotation[0]):
        return None
    cosine, sine = rotation[0][0], rotation[0][1]
    if cosine.is_Integer and sine.is_Integer:
        return sympy.atan2(sine, cosine)
    return sympy.atan2(sine, cosine).evalf(50)


def _join(label: str, name: str) -> str:
    return f"{label}_{name}" if label else name
