"""Cams that balance a link on a hip exactly: the roller follows a level set of the total potential, which gives the cam without a
differential equation.

phi is the link's angle from the horizontal X, counter-clockwise; Y points up. r is the way from the hip to the roller's centre, along
the vertical guide (the chapter's BD = Y, cam on the link, Fig. 15) or along the link (BD, cam on the frame, Fig. 16).
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
_NEWTON_STEPS = 50
_CLOSE = 1e-14
_FLAT = 1e-9
"""Of the largest slope of the potential: below it the follower is not pressed on the cam."""


class CamError(Exception):
    """A cam that cannot be: why, and at which angle of the link (rad)."""

    def __init__(self, kind: Literal["contact", "undercut"], message: str, angle: float) -> None:
        super().__init__(message)
        self.kind, self.angle = kind, angle


@dataclass(frozen=True)
class Weight:
    """What acts on the link besides follower and spring: the moment a cos(phi) + b sin(phi), counter-clockwise (N m)."""

    a: float
    b: float = 0.0


@dataclass(frozen=True)
class Spring:
    """Pulls with constant + stiffness length (N, N/m): constant is initial tension less stiffness times free length."""

    stiffness: float
    constant: float


@dataclass(frozen=True)
class Potential:
    """Of all, at angles and ways of the roller: its value (J) and its slopes, by phi (p) and by r, once and twice."""

    value: Reals
    p: Reals
    r: Reals
    pp: Reals
    pr: Reals
    rr: Reals
    length: Reals


@dataclass(frozen=True)
class OnLink:
    """The cam is on the link; the follower slides on a vertical guide of the frame (Fig. 15).

    Attributes:
        weight: of link and load, with what the spring weighs on the link.
        spring: from the link to the follower.
        gravity: m/s^2, more than 0.
        arm: from the hip to the spring's end on the link, on its axis (BF, m).
        reach: from the roller's centre down to the spring's end on the follower (DH, m).
        mass: of follower and roller, and of the spring's end there (kg).
    """

    weight: Weight
    spring: Spring
    gravity: float
    arm: float
    reach: float
    mass: float
    turn = 1
    """The outward normal is the curve's tangent turned so many quarters."""

    def potential(self, phi: Reals, r: Reals) -> Potential:
        """V(phi, Y), with the spring's energy from no length on."""
        sine, cosine, end = np.sin(phi), np.cos(phi), r - self.reach
        square = self.arm**2 + end**2 - 2 * self.arm * end * sine
        w = (-2 * self.arm * end * cosine, 2 * end - 2 * self.arm * sine)
        ww = (2 * self.arm * end * sine, -2 * self.arm * cosine, 2.0 + 0 * r)
        own = _turning(self.weight, sine, cosine)
        lift = self.gravity * self.mass
        return _with_spring(self.spring, square, w, ww, (own[0] + lift * r, own[1], lift + 0 * r, own[2], 0 * r, 0 * r))

    def pitch(self, phi: Reals, r: Reals) -> Reals:
        """The roller's centre in the link's axes [n, 2]."""
        return np.stack([r * np.sin(phi), r * np.cos(phi)], -1)


@dataclass(frozen=True)
class OnFrame:
    """The cam is on the frame; the follower slides along the link (Fig. 16).

    Attributes:
        weight: of link and load, without the follower.
        spring: from the follower to the frame.
        gravity: m/s^2, more than 0.
        anchor: from the hip up to the spring's end on the frame (Y_H, m).
        reach: from the roller's centre outwards to the spring's end on the follower (DF, m).
        masses: of the spring's end, of the follower, of the roller (kg).
        centre: from the roller's centre outwards to the follower's centre of mass (DG8, m).
    """

    weight: Weight
    spring: Spring
    gravity: float
    anchor: float
    reach: float
    masses: tuple[float, float, float]
    centre: float
    turn = -1

    def potential(self, phi: Reals, r: Reals) -> Potential:
        """V(phi, r), with the spring's energy from no length on."""
        sine, cosine, far = np.sin(phi), np.cos(phi), r + self.reach
        square = far**2 + self.anchor**2 - 2 * far * self.anchor * sine
        w = (-2 * far * self.anchor * cosine, 2 * far - 2 * self.anchor * sine)
        ww = (2 * far * self.anchor * sine, -2 * self.anchor * cosine, 2.0 + 0 * r)
        end, follower, roller = self.masses
        moment = self.gravity * (end * far + follower * (r + self.centre) + roller * r)
        mass = self.gravity * sum(self.masses)
        own = _turning(self.weight, sine, cosine)
        gravity = (own[0] + moment * sine, own[1] + moment * cosine, mass * sine, own[2] - moment * sine, mass * cosine, 0 * r)
        return _with_spring(self.spring, square, w, ww, gravity)

    def pitch(self, phi: Reals, r: Reals) -> Reals:
        """The roller's centre in the frame's axes [n, 2]."""
        return np.stack([r * np.cos(phi), r * np.sin(phi)], -1)


Cam = OnLink | OnFrame


def _turning(weight: Weight, sine: Reals, cosine: Reals) -> tuple[Reals, Reals, Reals]:
    """Potential of the link's own weight, and its slopes by phi."""
    moment = weight.a * cosine + weight.b * sine
    return weight.b * cosine - weight.a * sine, -moment, weight.a * sine - weight.b * cosine


def _with_spring(
    spring: Spring, square: Reals, w: tuple[Reals, Reals], ww: tuple[Reals, Reals, Reals], gravity: tuple[Reals, ...]
) -> Potential:
    """Gravity's potential and slopes with the spring's, whose length has this square, with these slopes."""
    length = np.sqrt(square)
    first, second = (spring.stiffness + spring.constant / length) / 2, -spring.constant / (4 * length**3)
    value, p, r, pp, pr, rr = gravity
    return Potential(
        value + spring.constant * length + spring.stiffness * square / 2,
        p + first * w[0],
        r + first * w[1],
        pp + second * w[0] ** 2 + first * ww[0],
        pr + second * w[0] * w[1] + first * ww[1],
        rr + second * w[1] ** 2 + first * ww[2],
        length,
    )


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


def profile(cam: Cam, phi: Reals, start: float, radius: float) -> Profile:
    """The cam whose roller is at `start` where the link is at the first of its angles.

    Args:
        cam: with its spring and weights.
        phi: angles [n], growing (rad).
        start: from the hip to the roller's centre (m).
        radius: of the roller (m).

    Raises:
        CamError: somewhere the follower is not pressed on the cam, or the roller is too large for the cam's bends.
    """
    r, level = _level_set(cam, phi, start)
    found = cam.potential(phi, r)
    slopes = -found.p / found.r
    bends = -(found.pp + 2 * found.pr * slopes + found.rr * slopes**2) / found.r
    size = np.sqrt(r**2 + slopes**2)
    curvature = (r**2 + 2 * slopes**2 - r * bends) / size**3
    side = np.sign(found.r[0])
    pitch, normal = cam.pitch(phi, r), _normal(cam, phi, r, slopes)
    _refuse_undercut(phi, curvature, side, radius)
    return Profile(
        *(phi, r, slopes, level, pitch),
        contact=pitch - side * radius * normal,
        pressure=np.arctan2(slopes, r),
        curvature=curvature,
        force=found.r * size / r,
        lengths=found.length,
    )


def _level_set(cam: Cam, phi: Reals, start: float) -> tuple[Reals, float]:
    """Newton's method on V(phi, r) = V0 from angle to angle."""

    def at(angle: float, r: float) -> Potential:
        return cam.potential(np.asarray(angle), np.asarray(r))

    first = at(phi[0], start)
    level, press, found = float(first.value), float(first.r), np.empty(len(phi))
    if press == 0.0:
        raise CamError("contact", "nothing presses the follower on the cam", float(phi[0]))
    r, before, here = start, float(phi[0]), first
    for place, angle in enumerate(phi):
        r = float(r - here.p / here.r * (angle - before))
        for _ in range(_NEWTON_STEPS):
            here = at(angle, r)
            step = float((here.value - level) / here.r) if abs(here.r) > _FLAT * abs(press) else np.inf
            if not np.isfinite(step) or here.r * press <= 0.0:
                raise CamError("contact", "the follower is not pressed on the cam", float(angle))
            r -= step
            if abs(step) < _CLOSE * abs(r):
                break
        else:
            raise CamError("contact", "no cam keeps the balance", float(angle))
        if r <= 0.0:
            raise CamError("contact", "the roller would pass the hip", float(angle))
        found[place], before = r, float(angle)
    return found, level


def _normal(cam: Cam, phi: Reals, r: Reals, slopes: Reals) -> Reals:
    """Of the pitch curve, outwards [n, 2]."""
    along = cam.pitch(phi, slopes) + cam.turn * np.stack([1.0, -1.0]) * cam.pitch(phi, r)[:, ::-1]
    normal: Reals = cam.turn * np.stack([-along[:, 1], along[:, 0]], -1) / np.linalg.norm(along, axis=1)[:, None]
    return normal


def _refuse_undercut(phi: Reals, curvature: Reals, side: float, radius: float) -> None:
    """The cam's edge runs forwards everywhere."""
    left = 1.0 - side * radius * curvature
    place = int(left.argmin())
    if left[place] <= 0.0:
        largest = 1.0 / float(np.abs(curvature[place]))
        raise CamError("undercut", f"a roller of {radius:.4g} m cuts into the cam, {largest:.4g} m is the most", float(phi[place]))


def residual(cam: Cam, cut: Profile) -> Reals:
    """What is left on the link of a cam that is cut through the profile's points, its tangents by central differences [n] (N m)."""
    found = cam.potential(cut.phi, cut.r)
    return -(found.p + found.r * np.gradient(cut.r, cut.phi, edge_order=2))
