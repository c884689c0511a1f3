"""What the self-test expects: every forward function of a path of limbs, from a 50-digit matrix walk over the Mechanism.

A leg's linkage is closed by Newton's method on its loops; second derivatives are central differences there. A curved sole's foot point is
where it touches the ground, and slopes are those of the foot's point there.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from walkgen.emit.touching import normal_in_foot, touched
from walkgen.model.closing import KnownStart, Posture, closed
from walkgen.model.curved_sole import CurvedSole
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import CORNERS, Joint, Limb, Mechanism
from walkgen.model.walk import CONTEXT, Matrix, along, defaults, limb_frames, moved, number

Numbers = list[Any]
_STEP = CONTEXT.mpf(10) ** -16


@dataclass(frozen=True)
class Sample:
    """A path of limbs at given joint values, rates and accelerations, with a force on its tip."""

    mechanism: Mechanism
    limbs: tuple[Limb, ...]
    q: tuple[Any, ...]
    qd: tuple[Any, ...]
    qdd: tuple[Any, ...]
    f: tuple[Any, ...]
    start: KnownStart | None = None

    @cached_property
    def _held(self) -> tuple[Limb, ...]:
        """The limbs, a curved sole with its foot point held where it touches the ground."""
        leg = self.limbs[-1]
        return (*self.limbs[:-1], touched(self.mechanism, leg, self.q[len(self.q) - len(leg.joints) :]))

    @cached_property
    def _walked(self) -> "Walk":
        return _walk(self.mechanism, self._held, self.q, self.start)

    @property
    def poses(self) -> list[Matrix]:
        """The first limb's mount, the frame that moves with each joint, the tip; a drive's frame is that of the link that it moves."""
        return self._walked.poses

    @property
    def columns(self) -> list[tuple[Numbers, Numbers]]:
        """Linear and angular column of every joint, at the tip."""
        return self._walked.columns

    @cached_property
    def bias(self) -> Numbers:
        """Jdot qd [6]."""
        return _combined(self._change(self.qd), self.qd)

    def second(self, first: int, last: int) -> Numbers:
        """D_first D_last p for first <= last: a revolute joint turns later columns about its own axis, a prismatic one leaves them."""
        if self.limbs[-1].linkage is None:
            return cross(self.columns[first][1], self.jacobian[last])
        return self._slopes[first][last][:3]

    @cached_property
    def _slopes(self) -> list[list[Numbers]]:
        units = ([CONTEXT.mpf(place == joint) for place in range(len(self.q))] for joint in range(len(self.q)))
        return [self._change(unit) for unit in units]

    def _change(self, rates: Sequence[Any]) -> list[Numbers]:
        """Of every column [6] while q moves at these rates, by central differences."""
        ahead, behind = (_walk(self.mechanism, self._held, self._moved(side * _STEP, rates), self.start).columns for side in (1, -1))
        return [
            [(a - b) / (2 * _STEP) for a, b in zip(_six(*new), _six(*old), strict=True)] for new, old in zip(ahead, behind, strict=True)
        ]

    def _moved(self, time: Any, rates: Sequence[Any]) -> Numbers:
        return [q + time * rate for q, rate in zip(self.q, rates, strict=True)]

    @cached_property
    def posture(self) -> Posture:
        """Of the leg's linkage."""
        leg = self.limbs[-1]
        assert leg.linkage is not None
        stop = len(self.q) - leg.beyond
        return _closed(leg.linkage, self.q[stop - leg.linkage.drive_count : stop], self.mechanism, self.start)

    @property
    def pairs(self) -> list[Numbers]:
        """Where every pair of the leg's linkage is [3]."""
        plane, pairs = self._walked.plane, self.posture.loops.linkage.structure.pairs
        places = [self.posture.pin(number) for number in range(len(pairs))]
        return [[plane[row, 0] * x + plane[row, 1] * y + plane[row, 3] for row in range(3)] for x, y in places]

    @property
    def jacobian(self) -> list[Numbers]:
        """Linear columns."""
        return [linear for linear, _ in self.columns]

    @property
    def position(self) -> Numbers:
        """The tip [3]."""
        return [self.poses[-1][row, 3] for row in range(3)]


@dataclass(frozen=True)
class Walk:
    """`Sample.poses` and `Sample.columns`; `plane` is a linkage's, and the tip's frame of other legs."""

    plane: Matrix
    poses: list[Matrix]
    columns: list[tuple[Numbers, Numbers]]


def _walk(mechanism: Mechanism, limbs: Sequence[Limb], q: Sequence[Any], start: KnownStart | None) -> Walk:
    """Poses along the path, then the column of every joint about or along its frame's z axis."""
    values = defaults(mechanism)
    base, place = CONTEXT.eye(4), 0
    poses: list[Matrix] = []
    axes: list[tuple[Joint, Matrix]] = []
    for limb in limbs:
        stop = place + len(limb.serial)
        local = limb_frames(mechanism, limb.inner, q[place:stop], values, base)
        poses += local[1:-1] if poses else local[:-1]
        axes += [(joint, along(frame, joint.before, values)) for joint, frame in zip(limb.serial, local, strict=False)]
        base, place = local[-1], stop
    leg, linkage = limbs[-1], limbs[-1].linkage
    if linkage is None:
        return Walk(base, [*poses, base], _columns(base, axes))
    stop = place + linkage.drive_count
    (*links, end), columns = _driven(_closed(linkage, q[place:stop], mechanism, start), base)
    _, *beyond, tip = hung = limb_frames(mechanism, leg.outer, q[stop:], values, end)
    after = [(joint, along(frame, joint.before, values)) for joint, frame in zip(leg.distal, hung, strict=False)]
    driven = [_carried(column, end, tip) for column in columns]
    return Walk(base, [*poses, *links, *beyond, tip], _columns(tip, axes) + driven + _columns(tip, after))


def _carried(column: tuple[Numbers, Numbers], end: Matrix, tip: Matrix) -> tuple[Numbers, Numbers]:
    """A column at the end of a linkage as one at the tip, which moves with it."""
    linear, angular = column
    swung = cross(angular, [tip[row, 3] - end[row, 3] for row in range(3)])
    return [a + b for a, b in zip(linear, swung, strict=True)], angular


def _closed(linkage: Linkage, drives: Sequence[Any], mechanism: Mechanism, start: KnownStart | None) -> Posture:
    found = closed(linkage, defaults(mechanism), drives, start)
    assert found is not None
    return found


def _driven(posture: Posture, plane: Matrix) -> tuple[list[Matrix], list[tuple[Numbers, Numbers]]]:
    """Frames of the links that the drives move, then at the linkage's end, and the drives' columns there."""
    linkage = posture.loops.linkage
    body, point = linkage.foot[0], posture.loops.planar(linkage.foot[1])
    origins = [(link, (CONTEXT.zero, CONTEXT.zero)) for link in _moved_links(linkage)]
    x, y, z = ([plane[row, axis] for row in range(3)] for axis in range(3))
    columns = [
        ([a * along_x + b * along_y for a, b in zip(x, y, strict=True)], [entry * turn for entry in z])
        for along_x, along_y, turn in posture.slopes(body, point)
    ]
    return [_placed(plane, *posture.place(link, at)) for link, at in (*origins, (body, point))], columns


def _placed(plane: Matrix, x: Any, y: Any, angle: Any) -> Matrix:
    return moved(moved(moved(plane, "translate", 0, x), "translate", 1, y), "rotate", 2, angle)


def _moved_links(linkage: Linkage) -> list[int]:
    """A pin's second link, a slider's runner, the link at a cylinder's second end."""
    pairs = linkage.structure.pairs
    links = [pairs[index].bodies[1] if pairs[index].kind == "R" else pairs[index].bodies[0] for index in linkage.driven]
    return links + [[pair.bodies[0] for pair in pairs if bar in pair.bodies][1] for bar in sorted(linkage.structure.bars)]


def _columns(pose: Matrix, axes: list[tuple[Joint, Matrix]]) -> list[tuple[Numbers, Numbers]]:
    tip = [pose[row, 3] for row in range(3)]
    return [_column(joint, frame, tip) for joint, frame in axes]


def _column(joint: Joint, frame: Matrix, tip: Numbers) -> tuple[Numbers, Numbers]:
    axis = [joint.sign * frame[row, 2] for row in range(3)]
    if joint.kind == "prismatic":
        return axis, [CONTEXT.zero] * 3
    return cross(axis, [tip[row] - frame[row, 3] for row in range(3)]), axis


def cross(a: Sequence[Any], b: Sequence[Any]) -> Numbers:
    """A x b."""
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def _six(linear: Numbers, angular: Numbers) -> Numbers:
    return [*linear, *angular]


def _combined(columns: Sequence[Numbers], rates: Sequence[Any]) -> Numbers:
    """The columns weighted by the rates, summed."""
    return [sum(column[row] * rate for column, rate in zip(columns, rates, strict=True)) for row in range(len(columns[0]))]


def flat(columns: Sequence[Numbers]) -> Numbers:
    """Row-major elements of a matrix given by columns."""
    return [column[row] for row in range(len(columns[0])) for column in columns]


def elements(matrix: Matrix, size: int = 4) -> Numbers:
    """Row-major elements of the leading square."""
    return [matrix[row, column] for row in range(size) for column in range(size)]


def _hessian(sample: Sample) -> Numbers:
    count = len(sample.q)
    second = {(i, j): sample.second(i, j) for i in range(count) for j in range(i, count)}
    return [second[min(i, j), max(i, j)][row] for row in range(3) for i in range(count) for j in range(count)]


def _spatial(sample: Sample) -> Numbers:
    return flat([_six(*column) for column in sample.columns])


def _acceleration(sample: Sample) -> Numbers:
    return [a + b for a, b in zip(_combined(sample.jacobian, sample.qdd), sample.bias[:3], strict=True)]


def _torque(sample: Sample) -> Numbers:
    return [sum(a * b for a, b in zip(column, sample.f, strict=True)) for column in sample.jacobian]


def _frames(sample: Sample) -> Numbers:
    return [element for pose in sample.poses[:-1] for element in elements(pose)]


def sole_corners(sample: Sample) -> list[Numbers]:
    """The points that the path's leg stands on: its sole's corners, the ends of a rolling sole's contact line, else its tip."""
    sole, rolling = sample.limbs[-1].sole, sample.limbs[-1].curved_sole
    if rolling is not None:
        return _rolling_points(sample, rolling)
    if sole is None:
        return [sample.position]
    frame, sizes = _sole_frame(sample), [number(size, sample.mechanism) / 2 for size in (sole.length, sole.width)]
    return [
        [frame[row, 3] + sum(frame[row, axis] * sizes[axis] * corner[axis] for axis in (0, 1)) for row in range(3)] for corner in CORNERS
    ]


def _rolling_points(sample: Sample, sole: CurvedSole) -> list[Numbers]:
    """Front and rear, which are one where the sole rolls."""
    frame, width = sample.poses[-1], sole.width
    half = CONTEXT.zero if width is None else number(width, sample.mechanism) / 2
    sides = (1,) if width is None else (1, -1)
    ends = {side: [frame[row, 3] + side * half * frame[row, 2] for row in range(3)] for side in sides}
    return [ends[1], *(ends[side] for side in sides), *(ends[side] for side in sides[1:])]


def sole_normal(sample: Sample) -> Numbers:
    """The z axis of the leg's sole; the ground's normal under a rolling one."""
    leg = sample.limbs[-1]
    if leg.curved_sole is not None:
        frame, own = sample.poses[-1], sample.q[len(sample.q) - len(leg.joints) :]
        down, ahead = normal_in_foot(sample.mechanism, leg, own)
        return [down * frame[row, 0] + leg.curved_sole.side * ahead * frame[row, 1] for row in range(3)]
    return [_sole_frame(sample)[row, 2] for row in range(3)]


def _sole_frame(sample: Sample) -> Matrix:
    sole = sample.limbs[-1].sole
    return along(sample.poses[-1], sole.turn if sole else (), defaults(sample.mechanism))


EXPECTED: Mapping[str, Callable[[Sample], tuple[Numbers, ...]]] = {
    "foot_position": lambda sample: (sample.position,),
    "foot_rotation": lambda sample: (elements(sample.poses[-1], 3),),
    "foot_pose": lambda sample: (elements(sample.poses[-1]),),
    "foot_jacobian": lambda sample: (flat(sample.jacobian),),
    "foot_position_jacobian": lambda sample: (sample.position, flat(sample.jacobian)),
    "foot_spatial_jacobian": lambda sample: (_spatial(sample),),
    "foot_hessian": lambda sample: (_hessian(sample),),
    "foot_velocity": lambda sample: (_combined(sample.jacobian, sample.qd),),
    "foot_acceleration": lambda sample: (_acceleration(sample),),
    "foot_bias_acceleration": lambda sample: (sample.bias,),
    "foot_torque": lambda sample: (_torque(sample),),
    "joint_frames": lambda sample: (_frames(sample),),
    "sole_points": lambda sample: ([element for corner in sole_corners(sample) for element in corner],),
    "sole_normal": lambda sample: (sole_normal(sample),),
    "transmission_angles": lambda sample: (sample.posture.angles,),
    "pair_positions": lambda sample: ([entry for point in (*sample.pairs, sample.position) for entry in point],),
    "pose": lambda sample: (elements(sample.poses[-1]),),
    "jacobian": lambda sample: (_spatial(sample),),
    "frames": lambda sample: (_frames(sample),),
}
"""Elements of every output port, by the function's name."""
