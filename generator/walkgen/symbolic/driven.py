"""Kinematics of a path whose leg has a planar linkage: a serial path to the foot, two of whose joints slide and one turns in the plane
as the drives say.

The place of the linkage's end in the plane (X, Y, angle), where the foot is or the joints beyond it begin, and its slopes by the drives
come from the placing; space, from the path.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Literal

import sympy

from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Body, Joint, Limb, Transform
from walkgen.model.transform import QUARTER_TURN, X, Y, rotation
from walkgen.spec.assur import SIDES, Triad
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
        count, beyond = linkage.drive_count, limbs[-1].beyond
        self._linkage, self.parameters, self._beyond = linkage, parameters, beyond
        self._serial, self._distal = len(q) - count - beyond, tuple(q[len(q) - beyond :])
        self.tape, self._drives = tape, tuple(q[self._serial : self._serial + count])
        self.placing = forward_placing(limbs[-1], self._drives, parameters, tape)
        self._foot = self.placing.pose(linkage.foot[0])
        x, y = self.placing.point(linkage.foot[0], self.placing.planar(linkage.foot[1]))
        self._at = (tape.let("foot_x", x), tape.let("foot_y", y))
        places = (Coordinate("foot_x", self._at[0]), Coordinate("foot_y", self._at[1]), Coordinate("foot_angle", rotor=self._foot.rotor))
        self._motion = PlanarMotion(tape, self._drives, places)
        virtual = (*q[: self._serial], *self._at, tape.let("foot_angle", places[2].value), *self._distal)
        self._inner = Kinematics(path_of((*limbs[:-1], carrier(limbs[-1])), virtual, parameters), tape)
        groups = [margin for margin in self.placing.margins if isinstance(margin.group, Triad) or SIDES[margin.group.kind]]
        self._margins = tuple(Coordinate(f"{margin.group.name}_margin", tape.let("margin", margin.value)) for margin in groups)

    @property
    def carrier(self) -> Kinematics:
        """Of the joints in series and the motion in the plane of the linkage's end."""
        return self._inner

    @property
    def plane(self) -> Columns:
        """The plane's X, Y and normal in the base's axes."""
        x, y, z = self._inner.axes[self._planar]
        return (x, y, z)

    @property
    def _planar(self) -> slice:
        """The path's joints that stand for the linkage."""
        return slice(self._serial, self._serial + _PLANAR)

    @property
    def end(self) -> Vec:
        """The linkage's end in the base's axes."""
        return self._inner.frames[self._serial + _PLANAR][1] if self._beyond else self.position

    @property
    def position(self) -> Vec:
        """The foot's origin in the base's axes."""
        return self._inner.position

    @property
    def rotation(self) -> Columns:
        """The foot's axes, by columns; where no joints follow the linkage, those of its link."""
        return self._inner.rotation

    def _by_drives(self, columns: Sequence[Vec]) -> tuple[Vec, ...]:
        """Columns by the path's joints as columns by q."""
        planar, distal = columns[self._planar], columns[self._serial + _PLANAR :]
        driven = (_mixed(planar, [row[drive] for row in self._motion.slopes]) for drive in range(len(self._drives)))
        return (*columns[: self._serial], *driven, *distal)

    @cached_property
    def jacobian(self) -> tuple[Vec, ...]:
        """Columns dp/dq_i in the base's axes."""
        return tuple(self.tape.vector(f"J_{index}", column) for index, column in enumerate(self._by_drives(self._inner.jacobian), 1))

    @cached_property
    def angular(self) -> tuple[Vec, ...]:
        """Angular velocity of the foot per unit rate of every q."""
        return tuple(self.tape.vector(f"w_{index}", column) for index, column in enumerate(self._by_drives(self._inner.angular), 1))

    def second(self, first: int, last: int) -> Vec:
        """d2p / dq_first dq_last for first <= last."""
        ways = [self._ways(index) for index in (first, last)]
        terms = [
            (self._inner.second(min(one, other), max(one, other)), left * right)
            for one, left in ways[0].items()
            for other, right in ways[1].items()
        ]
        drives = range(self._serial, self._serial + len(self._drives))
        if first in drives and last in drives:
            bends = [row[first - self._serial][last - self._serial] for row in self._motion.bends]
            terms = terms if self._beyond else []  # the plane's own axes do not turn with the drives
            terms += zip(self._inner.jacobian[self._planar], bends, strict=True)
        return _mixed([column for column, _ in terms], [factor for _, factor in terms])

    def _ways(self, index: int) -> dict[int, sympy.Expr]:
        """How fast the path's joints move with a q."""
        drive = index - self._serial
        if 0 <= drive < len(self._drives):
            return {self._serial + place: row[drive] for place, row in enumerate(self._motion.slopes)}
        return {index if drive < 0 else drive - len(self._drives) + self._serial + _PLANAR: sympy.S.One}

    def margins(self, most: int) -> tuple[tuple[sympy.Expr, tuple[sympy.Expr, ...], tuple[tuple[sympy.Expr, ...], ...]], ...]:
        """Of dyads and triads that can cease to close, so many at most: how far they are from there, slopes and second derivatives by q."""
        motion, count = PlanarMotion(self.tape, self._drives, self._margins[:most]), len(self._drives)
        before, after = ([sympy.S.Zero] * number for number in (self._serial, self._beyond))
        none = tuple([sympy.S.Zero] * (self._serial + count + self._beyond))
        return tuple(
            (
                margin.value,
                (*before, *slopes, *after),
                (*(none for _ in before), *((*before, *row, *after) for row in bends), *(none for _ in after)),
            )
            for margin, slopes, bends in zip(self._margins, motion.slopes, motion.bends, strict=False)
        )

    def link_frame(self, body: int) -> tuple[Columns, Vec]:
        """A link's axes, by columns, and its origin in the base's axes."""
        x, y, z = self.plane
        pose, (foot_x, foot_y) = self.placing.pose(body), self._at
        cosine, sine = pose.rotor
        columns = (_mixed((x, y), (cosine, sine)), _mixed((x, y), (-sine, cosine)), z)
        away = _mixed((x, y), (pose.origin[0] - foot_x, pose.origin[1] - foot_y))
        return columns, self.tape.vector(f"link_{body}_origin", plus(self.end, away))

    def place(self, at: Planar) -> Vec:
        """A point of the plane in the base's axes."""
        axes, (foot_x, foot_y) = self._inner.axes[self._serial : self._serial + 2], self._at
        return plus(self.end, _mixed(axes, (at[0] - foot_x, at[1] - foot_y)))

    @property
    def frames(self) -> tuple[tuple[Columns, Vec], ...]:
        """The mount, the frame that moves with every joint in series, of a drive that of the link that it moves."""
        driven = (self.link_frame(body) for body in moved_links(self._linkage))
        return (*self._inner.frames[: self._serial + 1], *driven, *self._inner.frames[self._serial + _PLANAR + 1 :])

    def bias(self, rates: Exprs) -> tuple[Vec, Vec]:
        """Jdot qd, linear and angular."""
        stop = len(rates) - self._beyond
        drives = rates[self._serial : stop]
        linear, angular = self._inner.bias((*rates[: self._serial], *self._motion.rates(drives), *rates[stop:]))
        own = self._motion.curved(drives)
        columns = (self._inner.jacobian[self._planar], self._inner.angular[self._planar])
        return plus(linear, _mixed(columns[0], own)), plus(angular, _mixed(columns[1], own))


def moved_links(linkage: Linkage) -> tuple[int, ...]:
    """The link that each drive moves: a pin's second, a slider's runner, the one at a cylinder's second end."""
    pairs = linkage.structure.pairs
    moved = [pairs[index].bodies[1 if pairs[index].kind == "R" else 0] for index in linkage.driven]
    ends = [[pair.bodies[0] for pair in pairs if bar in pair.bodies] for bar in sorted(linkage.structure.bars)]
    return (*moved, *(second for _, second in ends))


def carrier(leg: Limb) -> Limb:
    """The leg with the sliding and turning of the linkage's end in the plane instead of the linkage."""
    along, up, turn = planar_joints()
    planar = (replace(along, before=leg.tip + along.before), up, turn)
    return Limb(leg.name, leg.platform, leg.mount, (*leg.serial, *planar, *leg.distal), leg.foot)


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
