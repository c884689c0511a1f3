"""A leg as Denavit and Hartenberg's links, worked out of its screws: what the general elimination and its Newton steps compute with.

Joint i turns by its pair (cos, sin) about z of frame i, or slides along it; then frame i + 1 stands at `t` of frame i, turned about x by
the twist. Where two axes are well apart in direction their frames stand on the common normal, so t has no y; where they are nearly
parallel that normal may be far away, and the frames stand side by side instead.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import sympy

from walkgen.symbolic.choices import chosen, less
from walkgen.symbolic.roots import Pair
from walkgen.symbolic.tape import DIGITS, ZERO_VECTOR, Tape, Vec, constant, cross, dot, minus, plus, scaled

_APART = sympy.Rational(1, 10)
_NONE = sympy.Rational(1, 10**16)
_FOLDED = sympy.Rational(1, 10**9)
_NOTHING = sympy.Float("1e-280", DIGITS)


@dataclass(frozen=True)
class Screw:
    """A joint at q = 0: R or P, its unit axis and a point on it, in one fixed frame."""

    kind: str
    axis: Vec
    point: Vec


@dataclass(frozen=True)
class Link:
    """The place of the next joint's frame: translation, then the twist's cosine and sine."""

    t: Vec
    twist: Pair


@dataclass(frozen=True)
class Links:
    """`offsets` are the joints' pairs at q = 0, `links` join them, `target` is seen from the first frame, `foot` from the last."""

    kinds: str
    offsets: tuple[Pair, ...]
    links: tuple[Link, ...]
    target: Vec
    foot: Vec


@dataclass(frozen=True)
class _Joined:
    """Two neighbours: x of their frames, the points these stand in, and the step between them."""

    normal: Vec
    here: Vec
    there: Vec
    t: Vec


def links_of(screws: Sequence[Screw], foot: Vec, target: Vec, tape: Tape) -> Links:
    """The links of one to three joints; the target is seen from the first frame, which does not move."""
    start, normals, links = screws[0].point, [], []
    here = start
    for index, (screw, following) in enumerate(pairwise(screws)):
        beyond = foot if index + 2 == len(screws) else screws[index + 2].point
        joined = _joined(index, screw, following, here, beyond, tape)
        start, here = joined.here if index == 0 else start, joined.there
        normals.append(joined.normal)
        links.append(Link(joined.t, _turn(joined.normal, screw.axis, following.axis, tape)))
    if len(screws) == 1 and screws[0].kind == "P":
        start = here = foot
    last = screws[-1]
    beyond = minus(foot, here)
    normals.append(_across(last.axis, beyond, tape) if last.kind == "R" else (normals or [_any(last.axis, tape)])[-1])
    seen = _seen(beyond, normals[-1], last.axis, tape, "foot")
    return Links(
        "".join(screw.kind for screw in screws),
        tuple(
            _turn(screw.axis, first, second, tape) for screw, first, second in zip(screws, [normals[0], *normals], normals, strict=False)
        ),
        tuple(links),
        _seen(minus(target, start), normals[0], screws[0].axis, tape, "target"),
        (seen[0], sympy.S.Zero, seen[2]) if last.kind == "R" else seen,
    )


def may_fold(links: Links) -> bool:
    """Whether joint 3 can bring the foot onto axis 2, about which joint 2 then turns in vain; runtime parameters may always allow it."""
    if len(links.kinds) < 3 or links.kinds[1] == "P":
        return False
    (tx, ty, _), (c, s), (x, _, z) = links.links[1].t, links.links[1].twist, links.foot
    if not all(number.is_number for number in (tx, ty, c, s, x, z)):
        return True
    if links.kinds[2] == "P":
        return bool(abs(tx) < _FOLDED and (abs(s) > _FOLDED or abs(ty) < _FOLDED))
    if abs(c) < _FOLDED:
        return bool(abs(ty - s * z) < _FOLDED and abs(tx) < abs(x) + _FOLDED)
    cosine, sine = -tx / x, (s * z - ty) / (c * x)
    return bool(abs(cosine**2 + sine**2 - 1) < _FOLDED)


def _turn(axis: Vec, start: Vec, end: Vec, tape: Tape) -> Pair:
    """Cosine and sine of the angle about an axis between two unit vectors across it."""
    if start == end:
        return sympy.S.One, sympy.S.Zero
    return tape.let("turn_cos", dot(start, end)), tape.let("turn_sin", dot(axis, cross(start, end)))


def _seen(vector: Vec, x: Vec, z: Vec, tape: Tape, name: str) -> Vec:
    """A vector's components along x, z x x and z."""
    side = tape.vector("side", cross(z, x))
    return tape.vector(name, (dot(vector, x), dot(vector, side), dot(vector, z)))


def _joined(index: int, here: Screw, there: Screw, stand: Vec, beyond: Vec, tape: Tape) -> _Joined:
    """Join two neighbours, the first standing in a point that the first joint of all may still choose, as any sliding joint may."""
    if there.kind == "P" and index == 0 and here.kind == "R":
        return _Joined(_common(here.axis, there.axis, ZERO_VECTOR, tape)[0], stand, stand, ZERO_VECTOR)
    point = beyond if there.kind == "P" else there.point
    if index == 0 and here.kind == "P":
        return _Joined(_common(here.axis, there.axis, ZERO_VECTOR, tape)[0], point, point, ZERO_VECTOR)
    offset = tape.vector("between", minus(point, stand))
    normal, sine2 = _common(here.axis, there.axis, offset, tape)
    if there.kind == "P":
        return _Joined(normal, stand, point, _seen(offset, normal, here.axis, tape, "step"))
    apart = sine2.is_number and sine2 > _APART**2
    along = sympy.S.Zero
    if apart and index == 0:
        stand = _slid(stand, here.axis, dot(cross(offset, there.axis), cross(here.axis, there.axis)) / sine2, tape)
    elif index == 0:
        stand = _slid(stand, here.axis, dot(offset, here.axis), tape)
    if apart:
        along = dot(cross(offset, here.axis), cross(here.axis, there.axis)) / sine2
    elif index > 0:
        along = -dot(offset, there.axis)
    point = _slid(point, there.axis, along, tape)
    step = _seen(minus(point, stand), normal, here.axis, tape, "step")
    if not apart and sine2 != 0:
        return _Joined(normal, stand, point, step)
    return _Joined(normal, stand, point, (step[0], sympy.S.Zero, sympy.S.Zero if index == 0 else step[2]))


def _slid(point: Vec, axis: Vec, along: sympy.Expr, tape: Tape) -> Vec:
    return tape.vector("stand", plus(point, scaled(tape.let("slide", along), axis)))


def _common(z: Vec, other: Vec, offset: Vec, tape: Tape) -> tuple[Vec, sympy.Expr]:
    """A unit vector across two axes, along the offset where they are parallel; the square of the sine between them, 0 for nothing."""
    normal = tape.vector("normal", cross(z, other))
    sine2 = tape.let("sine2", dot(normal, normal))
    if not sine2.is_number:
        parallel = less(sine2, _NONE**2)
        scale = tape.let("normal_scale", 1 / sympy.sqrt(chosen(parallel, sympy.S.One, sine2)))
        return _picked(parallel, _any(z, tape), scaled(scale, normal), tape), sine2
    if sine2 > _NONE**2:
        return tape.vector("normal", scaled(1 / sympy.sqrt(sine2), normal)), sine2
    return _across(z, offset, tape), sympy.S.Zero


def _across(z: Vec, offset: Vec, tape: Tape) -> Vec:
    """The direction of an offset across an axis; any direction across it where there is none."""
    away = tape.vector("away", minus(offset, scaled(tape.let("along", dot(offset, z)), z)))
    square = tape.let("away2", dot(away, away))
    if square.is_number:
        return tape.vector("away", scaled(1 / sympy.sqrt(square), away)) if square > _NONE**2 else _any(z, tape)
    component = [index for index in range(3) if away[index] != 0]
    if len(component) == 1:  # one component is a direction without a root, and never nothing
        x, y, up = (sympy.Integer(index == component[0]) for index in range(3))
        return (x, y, up)
    none = less(square, _NOTHING)
    scale = tape.let("away_scale", 1 / sympy.sqrt(chosen(none, sympy.S.One, square)))
    return _picked(none, _any(z, tape), scaled(scale, away), tape)


def _picked(truth: sympy.Basic, then: Vec, otherwise: Vec, tape: Tape) -> Vec:
    return tape.vector("across", [chosen(truth, a, b) for a, b in zip(then, otherwise, strict=True)])


def _any(z: Vec, tape: Tape) -> Vec:
    """A unit vector across an axis, without a division by a small number (Duff et al. 2017)."""
    x, y, up = z
    sign = tape.let("up_sign", chosen(less(up, sympy.S.Zero), -sympy.S.One, sympy.S.One))
    a = tape.let("up_scale", -1 / (sign + up))
    return tape.vector("across", (1 + sign * x**2 * a, sign * x * y * a, -sign * x))


def folded(vector: Sequence[sympy.Expr]) -> Vec:
    """Numbers to 50 digits."""
    x, y, z = (_folded(sympy.sympify(item)) for item in vector)
    return (x, y, z)


def _folded(item: sympy.Expr) -> sympy.Expr:
    if not item.is_number:
        return item
    return constant(sympy.Float(item, DIGITS) if item.is_Float else item)
