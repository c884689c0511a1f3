"""The total potential of a link on a hip, its cam's follower and spring, and the roller's way that keeps it the same at every angle.

phi is the link's angle from the horizontal X, counter-clockwise; Y points up. r is the way from the hip to the roller's centre, along
the vertical guide (the chapter's BD = Y, cam on the link, Fig. 15) or along the link (BD, cam on the frame, Fig. 16). Numbers are of any
kind that has sine, cosine and root: `maths` is math, numpy or a context of mpmath.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

_NEWTON_STEPS = 60
_FLAT = 1e-9
"""Of the first slope of the potential: below it the follower is not pressed on the cam."""


class CamError(Exception):
    """A cam that cannot be: why, and at which angle of the link (rad), None where it is wrong at all."""

    def __init__(self, kind: Literal["contact", "undercut", "slack", "hinge"], message: str, angle: float | None = None) -> None:
        super().__init__(message)
        self.kind, self.angle = kind, angle


@dataclass(frozen=True)
class Weight:
    """What acts on the link besides follower and spring: the moment a cos(phi) + b sin(phi), counter-clockwise (N m)."""

    a: Any
    b: Any = 0.0


@dataclass(frozen=True)
class Pull:
    """Of a spring: constant + stiffness length (N, N/m); constant is initial tension less stiffness times free length."""

    stiffness: Any
    constant: Any


@dataclass(frozen=True)
class Potential:
    """Of all, at an angle and a way of the roller: its value (J), its slopes by phi (p) and by r, once and twice; the spring's length."""

    value: Any
    p: Any
    r: Any
    pp: Any
    pr: Any
    rr: Any
    length: Any


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
    spring: Pull
    gravity: Any
    arm: Any
    reach: Any
    mass: Any

    def potential(self, phi: Any, r: Any, maths: Any) -> Potential:
        """V(phi, Y), with the spring's energy from no length on."""
        sine, cosine = maths.sin(phi), maths.cos(phi)
        own, lift = _turning(self.weight, sine, cosine), self.gravity * self.mass
        gravity = (own[0] + lift * r, own[1], lift + 0 * r, own[2], 0 * r, 0 * r)
        return _with_spring(self.spring, stretched(self.arm, r - self.reach, sine, cosine), gravity, maths)


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
    spring: Pull
    gravity: Any
    anchor: Any
    reach: Any
    masses: tuple[Any, Any, Any]
    centre: Any

    def potential(self, phi: Any, r: Any, maths: Any) -> Potential:
        """V(phi, r), with the spring's energy from no length on."""
        sine, cosine, far = maths.sin(phi), maths.cos(phi), r + self.reach
        end, follower, roller = self.masses
        moment = self.gravity * (end * far + follower * (r + self.centre) + roller * r)
        mass, own = self.gravity * (end + follower + roller), _turning(self.weight, sine, cosine)
        gravity = (own[0] + moment * sine, own[1] + moment * cosine, mass * sine, own[2] - moment * sine, mass * cosine, 0 * r)
        return _with_spring(self.spring, stretched(self.anchor, far, sine, cosine), gravity, maths)


Cam = OnLink | OnFrame


@dataclass(frozen=True)
class Bend:
    """Of the roller's way and of the curve of its centre on what bears the cam, at an angle: dr/dphi (m/rad), the curvature, positive where
    its centre is on the hip's side (1/m), and the curve's length by angle (m/rad).
    """

    slope: Any
    curvature: Any
    size: Any


def bend(found: Potential, r: Any, maths: Any) -> Bend:
    """Where the roller's centre is `r` from the hip and keeps the potential."""
    slope = -found.p / found.r
    second = -(found.pp + 2 * found.pr * slope + found.rr * slope**2) / found.r
    size = maths.sqrt(r**2 + slope**2)
    return Bend(slope, (r**2 + 2 * slope**2 - r * second) / size**3, size)


def refuse_unfit(angles: Sequence[Any], found: Sequence[tuple[Any, Any, Any]], radius: Any, free: Any) -> None:
    """Where the edge of the cam would run backwards, or its spring would have to push.

    Args:
        angles: of the link (rad).
        found: at each the slope of the potential by r, the curvature, the spring's length.
        radius: of the roller (m).
        free: length of the spring (m).

    Raises:
        CamError: with the worst angle.
    """
    side = 1 if found[0][0] > 0 else -1
    left = [1 - side * radius * curvature for _, curvature, _ in found]
    place = left.index(min(left))
    if left[place] <= 0:
        largest = float(1 / abs(found[place][1]))
        message = f"a roller of {float(radius):.4g} m cuts into the cam, {largest:.4g} m is the most"
        raise CamError("undercut", message, float(angles[place]))
    lengths = [length for *_, length in found]
    place = lengths.index(min(lengths))
    if lengths[place] < free:
        message = f"the spring of the cam would have to push: it is {float(lengths[place]):.4g} m long, shorter than {float(free):.4g} m"
        raise CamError("slack", message, float(angles[place]))


Stretch = tuple[Any, tuple[Any, Any], tuple[Any, Any, Any]]
"""The square of a length, and its slopes by phi and r: once, and twice (phi phi, phi r, r r)."""


def stretched(lever: Any, end: Any, sine: Any, cosine: Any) -> Stretch:
    """Of the spring between a point `lever` from the hip along one arm and one `end` along the other: the vertical and the link."""
    square = lever**2 + end**2 - 2 * lever * end * sine
    first = (-2 * lever * end * cosine, 2 * end - 2 * lever * sine)
    return square, first, (2 * lever * end * sine, -2 * lever * cosine, 2 + 0 * end)


def _turning(weight: Weight, sine: Any, cosine: Any) -> tuple[Any, Any, Any]:
    """Potential of the link's own weight, and its slopes by phi."""
    moment = weight.a * cosine + weight.b * sine
    return weight.b * cosine - weight.a * sine, -moment, weight.a * sine - weight.b * cosine


def _with_spring(spring: Pull, stretch: Stretch, gravity: tuple[Any, ...], maths: Any) -> Potential:
    """Gravity's potential and slopes with the spring's."""
    square, w, ww = stretch
    length = maths.sqrt(square)
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


def level_set(cam: Cam, angles: Sequence[Any], start: Any, maths: Any, close: Any) -> list[Any]:
    """The roller's way at every angle, `start` at the first: V(phi, r) = V0 by Newton's method from angle to angle.

    Args:
        cam: with its spring and weights.
        angles: growing (rad).
        start: from the hip to the roller's centre (m).
        maths: of the numbers' kind.
        close: the relative step at which Newton's method ends.

    Raises:
        CamError: somewhere the follower is not pressed on the cam, or the roller would pass the hip.
    """
    here = cam.potential(angles[0], start, maths)
    level, press, r, before, found = here.value, here.r, start, angles[0], []
    if press == 0:
        raise CamError("contact", "nothing presses the follower on the cam", float(angles[0]))
    for angle in angles:
        r, here = _next(cam, angle, r - here.p / here.r * (angle - before), (level, press), maths, close)
        if r <= 0:
            raise CamError("contact", "the roller would pass the hip", float(angle))
        found.append(r)
        before = angle
    return found


def _next(cam: Cam, angle: Any, r: Any, kept: tuple[Any, Any], maths: Any, close: Any) -> tuple[Any, Potential]:
    """The way at an angle from a guess, and the potential there or hardly beside it."""
    level, press = kept
    for _ in range(_NEWTON_STEPS):
        here = cam.potential(angle, r, maths)
        if not abs(here.r) > _FLAT * abs(press) or here.r * press <= 0:
            raise CamError("contact", "the follower is not pressed on the cam", float(angle))
        step = (here.value - level) / here.r
        r = r - step
        if abs(step) < close * abs(r):
            return r, here
    raise CamError("contact", "no cam keeps the balance", float(angle))
