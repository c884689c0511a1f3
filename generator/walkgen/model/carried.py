"""What two joints can do for the foot of a leg whose linkage has one drive: read off their axes, before any algebra."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from walkgen.model.mechanism import Joint, Limb
from walkgen.model.walk import CONTEXT, along, moved
from walkgen.spec.scalar import evaluate

_NEGLIGIBLE = CONTEXT.mpf(10) ** -30
_TURNS = 12
"""Of the link that bears the foot: at how many angles axes are compared."""


@dataclass(frozen=True)
class _Posture:
    """Frames (4x4) of the two joints, z their axes, that of the link, x and y along the plane, and of the foot."""

    joints: tuple[Any, ...]
    link: Any
    foot: Any

    def columns(self, kinds: tuple[str, ...]) -> Iterator[Any]:
        """How the foot moves with the joints, and with a link that slides and turns."""
        for kind, frame in zip(kinds, self.joints, strict=True):
            yield frame[:3, 2] if kind == "prismatic" else self._turned(frame)
        slide = self.link[:3, 0] * CONTEXT.mpf("0.37") + self.link[:3, 1] * CONTEXT.mpf("0.61")
        yield slide + self._turned(self.link) * CONTEXT.mpf("1.3")

    def _turned(self, frame: Any) -> Any:
        a, b = frame[:3, 2], self.foot[:3, 3] - frame[:3, 3]
        return CONTEXT.matrix([a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)])

    def second_axis(self) -> Any:
        """That of the second joint in the first one's frame."""
        first, second = self.joints
        return first[:3, :3].T * second[:3, 2]


def joint_pair(leg: Limb) -> tuple[Joint, Joint]:
    """The two joints, before the linkage or after it."""
    first, second = (*leg.serial, *leg.distal)
    return first, second


def on_a_surface(leg: Limb, values: dict[str, Any]) -> bool:
    """Whether the joints and the drive leave the foot on a surface, wherever the linkage puts its link."""
    kinds = tuple(joint.kind for joint in joint_pair(leg))
    for posture in _postures(leg, values):
        columns = list(posture.columns(kinds))
        if abs(CONTEXT.det(CONTEXT.matrix([[column[row] for column in columns] for row in range(3)]))) > _NEGLIGIBLE:
            return False
    return True


def solved_first(leg: Limb, values: dict[str, Any]) -> int:
    """Which of two equations gives the second joint, if it turns: one on which it has a part.

    Of a first joint that turns they are the height along its axis (0) and the distance from it (1), of one that slides the two ways
    across it, of which the second joint has the greater part on the one, at whatever angle of the link.
    """
    axes = [posture.second_axis() for posture in _postures(leg, values)]
    if joint_pair(leg)[0].kind == "revolute":
        return int(all(axis[0] ** 2 + axis[1] ** 2 < _NEGLIGIBLE for axis in axes))
    return int(max(abs(axis[0]) for axis in axes) > max(abs(axis[1]) for axis in axes))


def _postures(leg: Limb, values: dict[str, Any]) -> Iterator[_Posture]:
    """With the link at some angles, in no special places."""
    for number in range(_TURNS):
        yield _posture(leg, values, CONTEXT.mpf(number) * 2 * CONTEXT.pi / _TURNS + CONTEXT.mpf("0.3"))


def _posture(leg: Limb, values: dict[str, Any], turn: Any) -> _Posture:
    frame, joints = along(CONTEXT.eye(4), leg.mount, values), []
    for place, joint in enumerate((*leg.serial, None, *leg.distal)):
        if joint is None:
            frame = along(frame, leg.tip, values)
            frame = moved(moved(frame, "translate", 0, CONTEXT.mpf("0.23")), "translate", 1, CONTEXT.mpf("-0.41"))
            frame = link = moved(frame, "rotate", 2, turn)
            continue
        frame = along(frame, joint.before, values)
        joints.append(frame)
        amount = turn / 3 + CONTEXT.mpf("0.7") * place + evaluate(joint.zero, CONTEXT, values)
        frame = along(moved(frame, "rotate" if joint.kind == "revolute" else "translate", 2, amount), joint.after, values)
    return _Posture(tuple(joints), link, along(frame, leg.foot, values))
