"""Newton steps on the foot's position, along links: what makes each row of the general inverse exact.

They also make the derivatives exact: of q' = q - J^-1 (foot(q) - p) at a solution, the part that comes in through q vanishes and J^-1
remains, which is what the implicit function theorem gives, however the start q was found.
"""

from dataclasses import dataclass, replace

import sympy

from walkgen.symbolic.choices import at_most, both, chosen, less
from walkgen.symbolic.elimination import Pose
from walkgen.symbolic.links import Links
from walkgen.symbolic.roots import Pair, advanced, back
from walkgen.symbolic.tape import Tape, Vec, cross, dot, minus, plus, scaled

_TINY = sympy.Float("1e-300", 50)
_FARTHEST = 100  # |step|^2 is at most this times the gap: near a double root they are of one order, elsewhere it is much less

Truths = tuple[sympy.Basic, ...]


@dataclass(frozen=True)
class Motion:
    """The foot's gap to the target in frame 1, and how it grows with each joint."""

    gap: Vec
    columns: tuple[Vec, ...]


def motion(links: Links, pose: Pose, tape: Tape) -> Motion:
    """Of a pose."""
    point, columns = links.foot, list[Vec]()
    for joint in range(len(links.kinds) - 1, 0, -1):
        pair, link = pose.pairs[joint], links.links[joint - 1]
        point = _turned(pair, point, tape)
        columns = [_turned(pair, column, tape) for column in columns]
        if links.kinds[joint] == "R":
            columns.insert(0, (-point[1], point[0], sympy.S.Zero))
        else:
            point = (point[0], point[1], point[2] + pose.slides[joint])
            columns.insert(0, (sympy.S.Zero, sympy.S.Zero, sympy.S.One))
        columns = [tape.vector("column", _twisted(link.twist, column)) for column in columns]
        point = tape.vector("point", plus(link.t, _twisted(link.twist, point)))
    if links.kinds[0] == "P":
        along = (sympy.S.Zero, sympy.S.Zero, sympy.S.One)
        gap = minus(plus(point, scaled(pose.slides[0], along)), links.target)
        return Motion(tape.vector("gap", gap), (along, *columns))
    goal = _turned(back(pose.pairs[0]), links.target, tape)
    return Motion(tape.vector("gap", minus(point, goal)), ((-goal[1], goal[0], sympy.S.Zero), *columns))


def stepped(links: Links, pose: Pose, still: Truths, tape: Tape) -> Pose:
    """The pose one step nearer; joints that are `still` stay, and so does all where the step would lead far away."""
    now = motion(links, pose, tape)
    columns = _held(now.columns, still, tape)
    parts, size = _solved(columns, now.gap, tape)
    parts = tuple(tape.let("step_part", chosen(truth, sympy.S.Zero, part)) for truth, part in zip(still, parts, strict=False))
    size = tape.let("determinant", size)
    gap2, length2 = tape.let("gap2", dot(now.gap, now.gap)), tape.let("length2", dot(parts, parts))
    if "R" in links.kinds:
        near = both(less(_TINY, abs(size)), at_most(length2**2, _FARTHEST**2 * gap2 * size**4))
    else:
        near = less(_TINY, abs(size))
    gain = tape.let("gain", chosen(near, 1 / chosen(near, size, sympy.S.One), sympy.S.Zero))
    pairs, slides = list(pose.pairs), list(pose.slides)
    for joint, (kind, part) in enumerate(zip(links.kinds, parts, strict=True)):
        step = tape.let("step", -part * gain)
        if kind == "R":
            pairs[joint] = advanced(pose.pairs[joint], step, tape, "joint")
        else:
            slides[joint] = tape.let("slide", pose.slides[joint] + step)
    return replace(pose, pairs=tuple(pairs), slides=tuple(slides))


def _held(columns: tuple[Vec, ...], still: Truths, tape: Tape) -> tuple[Vec, ...]:
    """Columns of three joints, a still one's across the other two: then these bring the foot as near as they can."""
    if len(columns) < 3:
        return columns
    held = []
    for joint, (truth, column) in enumerate(zip(still, columns, strict=True)):
        if truth is sympy.false:
            held.append(column)
            continue
        normal = tape.vector("normal", cross(columns[(joint + 1) % 3], columns[(joint + 2) % 3]))
        held.append(tape.vector("column", [chosen(truth, a, b) for a, b in zip(normal, column, strict=True)]))
    return tuple(held)


def _solved(columns: tuple[Vec, ...], gap: Vec, tape: Tape) -> tuple[tuple[sympy.Expr, ...], sympy.Expr]:
    """The step times the determinant, and that: Cramer; least squares for fewer than three joints."""
    if len(columns) == 1:
        return (tape.let("step_part", dot(columns[0], gap)),), dot(columns[0], columns[0])
    a, b = columns[:2]
    ab = tape.vector("minor", cross(a, b))
    c = columns[2] if len(columns) == 3 else ab
    bc, ca = tape.vector("minor", cross(b, c)), tape.vector("minor", cross(c, a))
    minors = (bc, ca, ab)[: len(columns)]
    return tuple(tape.let("step_part", dot(minor, gap)) for minor in minors), dot(a, bc)


def _turned(pair: Pair, vector: Vec, tape: Tape) -> Vec:
    """About z."""
    (c, s), (x, y, z) = pair, vector
    return tape.let("turned_x", c * x - s * y), tape.let("turned_y", s * x + c * y), z


def _twisted(pair: Pair, vector: Vec) -> Vec:
    """About x."""
    (c, s), (x, y, z) = pair, vector
    return x, c * y - s * z, s * y + c * z
