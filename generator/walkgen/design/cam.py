"""The shape of a cam that balances a link on a hip exactly: pitch curve, edge, pressure angle, curvature, force on the roller."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from walkgen.model.cam_potential import Cam, OnLink, bend, level_set, refuse_unfit

Reals = NDArray[np.float64]
_CLOSE = 1e-14


@dataclass(frozen=True)
class Profile:
    """A cam at angles of the link.

    Attributes:
        phi: angles [n] (rad).
        r: from the hip to the roller's centre [n] (m).
        slopes: dr/dphi [n] (m/rad).
        level: the total potential, the same everywhere (J).
        pitch: the roller's centre in the cam's axes [n, 2] (m).
        contact: the cam's edge [n, 2] (m).
        pressure: pressure angle [n] (rad).
        curvature: of the pitch curve, positive where its centre is on the hip's side [n] (1/m).
        force: of the cam on the roller, outwards positive, one sign all along [n] (N).
        lengths: of the spring [n] (m).
    """

    phi: Reals
    r: Reals
    slopes: Reals
    level: float
    pitch: Reals
    contact: Reals
    pressure: Reals
    curvature: Reals
    force: Reals
    lengths: Reals


def profile(cam: Cam, phi: Reals, start: float, radius: float, free: float = 0.0) -> Profile:
    """The cam whose roller is at `start` where the link is at the first of its angles.

    Args:
        cam: with its spring and weights, in doubles.
        phi: angles [n], growing (rad).
        start: from the hip to the roller's centre (m).
        radius: of the roller (m).
        free: length of the spring (m).

    Raises:
        CamError: somewhere the follower is not pressed on the cam, the roller is too large for the cam's bends, or the spring is slack.
    """
    r = np.array(level_set(cam, [float(angle) for angle in phi], start, math, _CLOSE))
    found = cam.potential(phi, r, np)
    bent = bend(found, r, np)
    refuse_unfit(list(phi), list(zip(found.r, bent.curvature, found.length, strict=True)), radius, free)
    centre, normal, side = pitch(cam, phi, r), _normal(cam, phi, r, bent.slope), np.sign(found.r[0])
    return Profile(
        *(phi, r, bent.slope, float(found.value[0]), centre),
        contact=centre - side * radius * normal,
        pressure=np.arctan2(bent.slope, r),
        curvature=bent.curvature,
        force=found.r * bent.size / r,
        lengths=found.length,
    )


def pitch(cam: Cam, phi: Reals, r: Reals) -> Reals:
    """The roller's centre in the axes of what bears the cam, link or frame [n, 2]."""
    ways = [r * np.cos(phi), r * np.sin(phi)]
    return np.stack(ways[::-1] if isinstance(cam, OnLink) else ways, -1)


def _normal(cam: Cam, phi: Reals, r: Reals, slopes: Reals) -> Reals:
    """Of the pitch curve, outwards [n, 2]."""
    turn = 1 if isinstance(cam, OnLink) else -1
    along = pitch(cam, phi, slopes) + turn * np.stack([1.0, -1.0]) * pitch(cam, phi, r)[:, ::-1]
    normal: Reals = turn * np.stack([-along[:, 1], along[:, 0]], -1) / np.linalg.norm(along, axis=1)[:, None]
    return normal


def residual(cam: Cam, cut: Profile) -> Reals:
    """What is left on the link of a cam that is cut through the profile's points, its tangents by central differences [n] (N m)."""
    found = cam.potential(cut.phi, cut.r, np)
    left: Reals = -(found.p + found.r * np.gradient(cut.r, cut.phi, edge_order=2))
    return left
