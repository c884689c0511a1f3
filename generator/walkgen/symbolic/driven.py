"""Kinematics of a path whose leg ends in a planar linkage: a serial path to the foot, two of whose joints slide and one turns in the plane
as the drives say.

The foot's place in the plane (X, Y, angle) and its slopes by the drives come from the placing; space, from the path.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Literal

import sympy

from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Body, Joint, Limb, Transform
from walkgen.model.transform import QUARTER_TURN, X, Y, rotation
from walkgen.spec.scalar import ZERO, neg
from walkgen.symbolic.closure import forward_placing
from walkgen.symbolic.frames import Parameters
from walkgen.symbolic.path import Kinematics, path_of
from walkgen.symbolic.planar import Planar
from walkgen.symbolic.planar_motion import Coordinate, PlanarMotion
from walkgen.symbolic.tape import Columns, Tape, Vec, dot, plus

_PLANAR = 3
Exprs = Sequence[sympy.Expr]


def kinematics_of(limbs: Sequence[Limb], q: Exprs, parameters: Parameters, tape: Tape) -> "Kinematics | DrivenKinematics":
    """Of limbs end to end; only the last may have a linkage."""
    if limbs[-1].linkage is None:
        return Kinematics(path_of(limbs, q, parameters), tape)
    return DrivenKinematics(limbs, limbs[-1].linkage, q, parameters, tape)


class DrivenKinematics:
    """What `Kinematics` has, by the joints in series and the drives."""

    def __init__(self, limbs: Sequence[Limb], linkage: Linkage, q: Exprs, parameters: Parameters, tape: Tape) -> None:
        count = linkage.drive_count
        self._linkage, self.parameters = linkage, parameters
        self.tape, self._serial, self._drives = tape, len(q) - count, tuple(q[len(q) - count :])
        self.placing = forward_placing(limbs[-1], self._drives, parameters, tape)
        self._foot = self.placing.pose(linkage.foot[0])
        x, y = self.placing.point(linkage.foot[0], self.placing.planar(linkage.foot[1]))
        self._at = (tape.let("foot_x", x), tape.let("foot_y", y))
        places = (Coordinate("foot_x", self._at[0]), Coordinate("foot_y", self._at[1]), Coordinate("foot_angle", rotor=self._foot.rotor))
        self._motion = PlanarMotion(tape, self._drives, places)
        virtual = (*q[: self._serial], *self._at, tape.let("foot_angle", places[2].value))
        self._inner = Kinematics(path_of((*limbs[:-1], carrier(limbs[-1])), virtual, parameters), tape)

    @property
    def carrier(self) -> Kinematics:
        """Of the joints in series and the foot's motion in the plane."""
        return self._inner

    @property
    def plane(self) -> Columns:
        """The plane's X, Y and normal in the base's axes."""
        x, y, z = self._inner.axes[self._serial :]
        return (x, y, z)

    @property
    def position(self) -> Vec:
        """The foot's origin in the base's axes."""
        return self._inner.position

    @property
    def rotation(self) -> Columns:
        """The foot's axes, by columns: those of its link."""
        return self._inner.rotation

    def _by_drives(self, columns: Sequence[Vec]) -> tuple[Vec, ...]:
        """Columns by the path's joints as columns by q."""
        serial, planar = tuple(columns[: self._serial]), columns[self._serial :]
        return (*serial, *(_mixed(planar, [row[drive] for row in self._motion.slopes]) for drive in range(len(self._drives))))

    @cached_property
    def jacobian(self) -> tuple[Vec, ...]:
        """Columns dp/dq_i in the base's axes."""
        return tuple(self.tape.vector(f"J_{index}", column) for index, column in enumerate(self._by_drives(self._inner.jacobian), 1))

    @cached_property
    def angular(self) -> tuple[Vec, ...]:
        """Angular velocity of the foot's link per unit rate of every q."""
        return tuple(self.tape.vector(f"w_{index}", column) for index, column in enumerate(self._by_drives(self._inner.angular), 1))

    def second(self, first: int, last: int) -> Vec:
        """d2p / dq_first dq_last for first <= last."""
        planar = range(self._serial, self._serial + _PLANAR)
        if last < self._serial:
            return self._inner.second(first, last)
        slopes = [row[last - self._serial] for row in self._motion.slopes]
        if first < self._serial:
            return _mixed([self._inner.second(first, joint) for joint in planar], slopes)
        bends = [row[first - self._serial][last - self._serial] for row in self._motion.bends]
        return _mixed(self._inner.jacobian[self._serial :], bends)  # the plane's own axes do not turn with the drives

    def link_frame(self, body: int) -> tuple[Columns, Vec]:
        """A link's axes, by columns, and its origin in the base's axes."""
        x, y, z = self.plane
        pose, (foot_x, foot_y) = self.placing.pose(body), self._at
        cosine, sine = pose.rotor
        columns = (_mixed((x, y), (cosine, sine)), _mixed((x, y), (-sine, cosine)), z)
        away = _mixed((x, y), (pose.origin[0] - foot_x, pose.origin[1] - foot_y))
        return columns, self.tape.vector(f"link_{body}_origin", plus(self.position, away))

    def place(self, at: Planar) -> Vec:
        """A point of the plane in the base's axes."""
        axes, (foot_x, foot_y) = self._inner.axes[self._serial : self._serial + 2], self._at
        return plus(self.position, _mixed(axes, (at[0] - foot_x, at[1] - foot_y)))

    @property
    def frames(self) -> tuple[tuple[Columns, Vec], ...]:
        """The mount, the frame that moves with every joint in series, then that of the link that each drive moves."""
        return (*self._inner.frames[: self._serial + 1], *(self.link_frame(body) for body in moved_links(self._linkage)))

    def bias(self, rates: Exprs) -> tuple[Vec, Vec]:
        """Jdot qd, linear and angular."""
        drives = rates[self._serial :]
        linear, angular = self._inner.bias((*rates[: self._serial], *self._motion.rates(drives)))
        own = self._motion.curved(drives)
        columns = (self._inner.jacobian[self._serial :], self._inner.angular[self._serial :])
        return plus(linear, _mixed(columns[0], own)), plus(angular, _mixed(columns[1], own))


def moved_links(linkage: Linkage) -> tuple[int, ...]:
    """The link that each drive moves: a pin's second, a slider's runner, the one at a cylinder's second end."""
    pairs = linkage.structure.pairs
    moved = [pairs[index].bodies[1 if pairs[index].kind == "R" else 0] for index in linkage.driven]
    ends = [[pair.bodies[0] for pair in pairs if bar in pair.bodies] for bar in sorted(linkage.structure.bars)]
    return (*moved, *(second for _, second in ends))


def carrier(leg: Limb) -> Limb:
    """The leg with the foot's sliding and turning in the plane instead of its linkage."""
    along, up, turn = planar_joints()
    return Limb(leg.name, leg.platform, leg.mount, (*leg.serial, replace(along, before=leg.tip + along.before), up, turn), ())


def planar_joints(sliding: Body | None = None, turning: Body | None = None) -> tuple[Joint, Joint, Joint]:
    """A body's motion in a plane, along its X, its Y and about its normal, with what slides and what turns as well."""
    to_x, to_y = rotation(Y, QUARTER_TURN), rotation(X, neg(QUARTER_TURN))
    return (
        _joint("along", "prismatic", to_x, rotation(Y, neg(QUARTER_TURN)), None),
        _joint("up", "prismatic", to_y, rotation(X, QUARTER_TURN), sliding),
        _joint("turn", "revolute", (), (), turning),
    )


def _joint(name: str, kind: Literal["revolute", "prismatic"], before: Transform, after: Transform, body: Body | None) -> Joint:
    return Joint(name, kind, before, 1, ZERO, after, body=body)


def _mixed(columns: Sequence[Vec], factors: Exprs) -> Vec:
    x, y, z = (dot([column[row] for column in columns], factors) for row in range(3))
    return (x, y, z)
