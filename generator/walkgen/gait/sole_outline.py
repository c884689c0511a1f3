"""Curved soles as lines: the section of each on both its sides, the generatrices where its parts meet."""

import numpy as np

from walkgen.gait.rolling import FLAT, is_rolling
from walkgen.runtime.robot import Leg
from walkgen.signature import STATUSES

_NEEDED = ("hip_position", "link_angles", "joint_frames", "foot_position", "sole_points")
_LOOKS = 181
_POINTS = 12
_OK = STATUSES.index("OK")


def soles(leg: Leg, q: np.ndarray) -> np.ndarray | None:
    """Lines [t,p,3] (m) in the platform's frame, set apart by NaN; None where the leg has no such sole, or was built without what it takes.

    Args:
        leg: whose plane is along its platform's x and z.
        q: its joint values [t,n].
    """
    if not is_rolling(leg) or not all(name in leg.functions for name in _NEEDED):
        return None
    outline = section(leg)
    angle, foot = leg.link_angles(q)[:, 2], leg.foot_position(q)
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    ankle = leg.joint_frames(q)[:, -1, :3, 3]
    ends = leg.sole_points(q)[:, :, 1]
    sides = [foot[:, 1] + side * 0.5 * np.ptp(ends, axis=1) for side in (1.0, -1.0)]
    x, z = ankle[:, 0, None] + c * outline[:, 0] - s * outline[:, 1], ankle[:, 2, None] + s * outline[:, 0] + c * outline[:, 1]
    loops = [np.stack([x, np.broadcast_to(side[:, None], x.shape), z], axis=-1) for side in sides]
    gap = np.full((len(q), 1, 3), np.nan)
    across = [part for place in _corners(outline) for part in (loops[0][:, place, None], loops[1][:, place, None], gap)]
    return np.concatenate([part for loop in loops for part in (loop, loop[:, :1], gap)] + across, axis=1)


def section(leg: Leg) -> np.ndarray:
    """Of the sole, from the end of its heel to that of its toe [p,2] in the foot's axes, from the ankle (m).

    Each foot angle at which it rolls shows the point that then lies on the ground.
    """
    angles = np.concatenate([_side(leg, 1.0), _side(leg, -1.0)])
    links = np.stack([np.full(len(angles), FLAT), np.full(len(angles), FLAT), angles], axis=-1)
    _, _, _, ankle, point, _ = leg.hip_position(links, 0.0)
    away, c, s = point - ankle, np.cos(angles), np.sin(angles)
    return np.stack([c * away[:, 0] + s * away[:, 1], c * away[:, 1] - s * away[:, 0]], axis=-1)


def _side(leg: Leg, way: float) -> np.ndarray:
    """Foot angles from the heel's end to its edge, or from the toe's edge to its end."""
    turned = np.linspace(1e-7, np.pi, _LOOKS)
    links = np.stack([np.full(_LOOKS, FLAT), np.full(_LOOKS, FLAT), FLAT + way * turned], axis=-1)
    lost = np.flatnonzero(leg.hip_position(links, 0.0)[-1] != _OK)
    last = turned[max(lost[0] - 1, 0)] if len(lost) else turned[-1]
    found: np.ndarray = FLAT + way * np.linspace(1e-7, last, _POINTS)
    return found[::-1] if way > 0.0 else found


def _corners(outline: np.ndarray) -> tuple[int, ...]:
    """Ends of the curves."""
    return 0, _POINTS - 1, _POINTS, len(outline) - 1
