"""Where legs with curved soles can walk: over planes, in their own planes, with a platform that goes along with both."""

from collections.abc import Callable, Iterator

import numpy as np

from walkgen.gait.footholds import Footholds
from walkgen.gait.ground import Ground
from walkgen.gait.motion import Motion
from walkgen.gait.rolling import FLAT, is_rolling
from walkgen.runtime.robot import Leg, Robot

_LEVEL = 1e-6
"""m, or rad times 1 m; no sole notices more."""
_LOOKS = 400
_POSTURES = ((-1.2, -2.2, FLAT), (-1.0, -2.2, FLAT))


def hindrances(
    robot: Robot, footholds: Footholds, body: Callable[[np.ndarray], Motion], ground: Ground, times: np.ndarray
) -> Iterator[str]:
    """What keeps the robot from a walk on soles that roll, in words; nothing of robots without.

    Args:
        robot: that is to walk.
        footholds: of the walk.
        body: motion of the first platform at times.
        ground: that it goes over.
        times: instants of the walk [t] (s).
    """
    rolls = [number for number, leg in enumerate(robot.legs.values()) if is_rolling(leg)]
    if not rolls:
        return
    motion = body(times)
    axes = motion.rotation[0]
    lanes = [_lane(footholds.points[number], ground) for number in rolls]
    height = np.concatenate(lanes) @ axes[:, 2]
    if np.isfinite(height).all() and np.ptp(height) > _LEVEL:
        yield f"soles roll on planes, and the ground under the feet is off one by {0.5 * np.ptp(height):.4g} m"
    elif np.abs(motion.rotation - axes).max() > _LEVEL:
        yield "legs roll on their soles in planes that do not turn, and the platform turns"
    for leg in robot.legs.values():
        if is_rolling(leg) and (leg.platform != robot.platforms[0] or _askew(leg) > _LEVEL):
            yield f"{leg.name}: it does not roll forward along the first platform's x, with the foot down along its z"


def _lane(points: np.ndarray, ground: Ground) -> np.ndarray:
    """Points of the ground along a leg's footholds [m,3]."""
    first, last = points[0], points[-1]
    lane: np.ndarray = first + np.linspace(0.0, 1.0, _LOOKS)[:, None] * (last - first)
    lane[:, 2] = ground.height(lane[:, 0], lane[:, 1])
    return lane


def _askew(leg: Leg) -> float:
    """By how much the flat foot moves otherwise than a leg whose plane is along the platform's x and z says (m)."""
    q = np.zeros((2, len(leg.joints)))
    q[:, -3:] = leg.joint_angles(np.array(_POSTURES))
    moved = np.diff(leg.foot_position(q), axis=0)[0]
    said = -np.diff(leg.hip_position(np.array(_POSTURES), 0.0)[0], axis=0)[0]
    return float(np.abs(moved - [said[0], 0.0, said[1]]).max())
