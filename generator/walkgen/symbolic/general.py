"""The closed-form inverse of any leg of one to three joints, turning or sliding in any order, as straight-line code: all rows at once.

The rows stand as those of walkgen_inverse_general.h do; only where the target is out of reach they hold some pose, not the closest one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import sympy

from walkgen.signature import STATUSES
from walkgen.symbolic.choices import at_most, both, chosen, either, finite, indicator, less
from walkgen.symbolic.elimination import Pose, poses
from walkgen.symbolic.function import Epsilon, Opposite, Residue
from walkgen.symbolic.links import Screw, folded, links_of, may_fold
from walkgen.symbolic.newton import Truths, motion, stepped
from walkgen.symbolic.redundancy import superfluous
from walkgen.symbolic.roots import angle, back, turned
from walkgen.symbolic.tape import Tape, Vec, constant, dot, minus, plus, scaled

Row = tuple[tuple[sympy.Expr, ...], sympy.Expr]
"""Joint values and a status."""

_OK, _UNREACHABLE, _BAD_INPUT, _SINGULAR, _DUPLICATE = (
    sympy.Integer(STATUSES.index(name)) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR", "DUPLICATE")
)
_TOLERANCE = sympy.Rational(1, 10**12)
_ORDER = sympy.Rational(1, 10**9)
_SAME = sympy.Rational(1, 10**7)
_TWOFOLD = sympy.Rational(1, 10**12)
_FAR = sympy.Float("1e60", 50)
_SLOTS = {"RRR": 4, "RRP": 4, "RPR": 4, "PRR": 4, "RPP": 2, "PRP": 2, "PPR": 2, "RR": 2, "RP": 2, "PR": 2}  # others have one
_EXCHANGES = {1: (), 2: ((0, 1),), 4: ((0, 1), (2, 3), (0, 2), (1, 3), (1, 2))}
_STEPS = 2
_CLOSE = sympy.Rational(1, 100)


@dataclass(frozen=True)
class _Branch:
    """A candidate: joint values (m in units of the leg's size), and 1 or 0: whether it reaches the target, whether it is not isolated.

    `twofold` is the truth that another branch with the same joint values makes them a double root, and is not merely the same again.
    """

    q: tuple[sympy.Expr, ...]
    reaches: sympy.Expr
    singular: sympy.Expr
    twofold: sympy.Basic = sympy.true


def general_rows(geometry: Sequence[sympy.Expr], p: Vec, sequence: int, tape: Tape) -> list[Row]:
    """All solutions, sorted by their joint values, then unused slots.

    Args:
        geometry: for every joint its unit axis, positive for growing q, and a point on it at q = 0, then the foot at q = 0: 6 n + 3 numbers
            or expressions in runtime parameters, m, in the frame of p.
        p: the foot's target, m.
        sequence: 1, then a binary digit a joint, base to foot: 0 turns, 1 slides (RRR is 8).
        tape: where the steps are written.

    Returns:
        For every slot n joint values (rad or m) and a status: OK; SINGULAR where q is not isolated (a joint is free everywhere, or the foot
        is on its axis; it is 0); DUPLICATE where it repeats the row before; UNREACHABLE where no solution is left: the first row again, or
        some pose where there is none; BAD_INPUT with NaN.
    """
    kinds = "".join("RP"[int(digit)] for digit in f"{sequence:b}"[1:])
    screws, foot = _screws(kinds, geometry)
    size = _size(screws, foot)
    screws = tuple(Screw(screw.kind, screw.axis, scaled(1 / size, screw.point)) for screw in screws)
    foot = scaled(1 / size, foot)
    leg = _Leg(screws, foot, p, size, tape)
    return _rows(kinds, leg.branches(), leg.taint, size, tape)


class _Leg:
    """One leg on one tape: which joints count, in which order they are eliminated, and the branches."""

    def __init__(self, screws: tuple[Screw, ...], foot: Vec, p: Vec, size: sympy.Expr, tape: Tape) -> None:
        self._tape, self._count = tape, len(screws)
        numbers = (*foot, *(x for screw in screws for x in (*screw.axis, *screw.point)))
        symbols = sorted({symbol for number in numbers for symbol in number.free_symbols}, key=str)
        self.taint = tape.let("taint", sympy.Add(*(Residue(x) for x in (*p, *symbols))))
        bounded = [tape.let("near", chosen(less(abs(x), _FAR), x, 0)) for x in p]
        target = tape.vector("scaled_target", [x / size for x in bounded])
        idle = superfluous(screws, foot)
        self._joints = [joint for joint in range(len(screws)) if joint not in idle]
        self._idle = bool(idle)
        used = [screws[joint] for joint in self._joints]
        kinds = "".join(screw.kind for screw in used)
        self._tolerance2 = self._tolerance(used, foot, target)
        if kinds in ("PPR", "RRP"):  # seen from the foot, so that what is eliminated last turns
            self._joints.reverse()
            used = [Screw(screw.kind, scaled(sympy.S.NegativeOne, screw.axis), screw.point) for screw in reversed(used)]
            foot, target = target, foot
        self._links = links_of(used, foot, target, tape)

    def _tolerance(self, used: Sequence[Screw], foot: Vec, target: Vec) -> sympy.Expr:
        """The square of 1e-12 of the reach, or of what rounding leaves of it in single precision."""
        tape = self._tape
        reach, beyond = sympy.S.Zero, foot
        for screw in reversed(used):
            if screw.kind == "R":
                along = tape.let("along", dot(minus(beyond, screw.point), screw.axis))
                stand = tape.vector("stand", plus(screw.point, scaled(along, screw.axis)))
                arm = tape.vector("arm", minus(beyond, stand))
                reach = reach + tape.let("arm", sympy.sqrt(dot(arm, arm)))
                beyond = stand
        roundoff = 8 * tape.let("epsilon", Epsilon())
        part = tape.let("tolerance", chosen(less(_TOLERANCE, roundoff), roundoff, _TOLERANCE))
        if any(screw.kind == "P" for screw in used):
            away = tape.vector("far_target", minus(target, used[0].point))
            reach = reach + tape.let("target_distance", sympy.sqrt(dot(away, away) + sympy.Float("1e-200", 50)))
        return tape.let("tolerance2", (part * reach) ** 2)

    def branches(self) -> list[_Branch]:
        """All of them, reachable or not."""
        return [self._branch(pose) for pose in poses(self._links, self._tape)]

    def _free(self) -> Truths:
        """Whether the foot is on the first joint's axis, or on the last one's: they turn in vain."""
        kinds, links, tape = self._links.kinds, self._links, self._tape
        free: list[sympy.Basic] = [sympy.false] * len(kinds)
        if len(kinds) == 3:
            for joint, (x, y, _) in ((0, links.target), (2, links.foot)):
                square = tape.let("off_axis2", x**2 + y**2)
                if kinds[joint] == "R" and not square.is_number:
                    free[joint] = at_most(square, self._tolerance2)
        return tuple(free)

    def _steps(self) -> int:
        """How many Newton steps: one more where axes nearly are what they are not, for there the starts are less exact."""
        if len(self._links.kinds) == 1:
            return 0
        return _STEPS + any(_nearly(number) for link in self._links.links for number in link.twist)

    def _branch(self, pose: Pose) -> _Branch:
        tape, links, free = self._tape, self._links, self._free()
        still = tuple(sympy.true if joint == pose.frozen else truth for joint, truth in enumerate(free))
        rest = [
            (tape.let("start", chosen(truth, a[0], b[0])), tape.let("start", chosen(truth, a[1], b[1])))
            for truth, a, b in zip(free, links.offsets, pose.pairs, strict=True)
        ]
        pose = replace(pose, pairs=tuple(rest))
        for _ in range(self._steps()):
            pose = stepped(links, pose, still, tape)
        now = motion(links, pose, tape)
        reaches = both(at_most(tape.let("gap2", dot(now.gap, now.gap)), self._tolerance2), pose.usable)
        if may_fold(links):  # the foot may come to lie on axis 2
            free = (free[0], at_most(tape.let("arm2", dot(now.columns[1], now.columns[1])), self._tolerance2), free[2])
        singular: sympy.Basic = sympy.true if self._idle or pose.frozen >= 0 else sympy.false
        values = [sympy.S.Zero] * self._count
        for index, joint in enumerate(self._joints):
            singular = either(singular, free[index])
            if links.kinds[index] == "R":
                value = angle(turned(pose.pairs[index], back(links.offsets[index]), tape, "joint"), tape, "angle")
                values[joint] = tape.let("angle", chosen(free[index], sympy.S.Zero, value))
            else:
                values[joint] = pose.slides[index]
        twofold = at_most(pose.margin, _TWOFOLD) if len(links.kinds) == 2 else sympy.true
        return _Branch(tuple(values), tape.let("reaches", indicator(reaches)), tape.let("singular", indicator(singular)), twofold)


def _nearly(number: sympy.Expr) -> bool:
    return bool(number.is_number and 0 < abs(number) < _CLOSE)


def _rows(kinds: str, branches: list[_Branch], taint: sympy.Expr, size: sympy.Expr, tape: Tape) -> list[Row]:
    branches = _sorted(branches, tape)
    first, bad = branches[0], Opposite(finite(taint))
    rows: list[Row] = []
    for index, branch in enumerate(branches):
        there = less(0, branch.reaches)
        q = branch.q if index == 0 else tuple(tape.let("q", chosen(there, a, b)) for a, b in zip(branch.q, first.q, strict=True))
        status = chosen(less(0, branch.singular), _SINGULAR, _OK) if branch.singular != 0 else _OK
        if index > 0:
            again = chosen(branch.twofold, _DUPLICATE, _UNREACHABLE)
            status = chosen(_alike(kinds, branches[index - 1], branch, tape), again, status)
        rows.append((q, chosen(bad, _BAD_INPUT, chosen(there, status, _UNREACHABLE))))
    rows += [(rows[0][0], chosen(bad, _BAD_INPUT, _UNREACHABLE))] * (_SLOTS.get(kinds, 1) - len(rows))
    return [(tuple(_checked(kind, value, taint, size, tape) for kind, value in zip(kinds, q, strict=True)), status) for q, status in rows]


def _checked(kind: str, value: sympy.Expr, taint: sympy.Expr, size: sympy.Expr, tape: Tape) -> sympy.Expr:
    """In m or rad, NaN for a bad input."""
    value = value if kind == "R" else value * size
    return tape.let("q", tape.let("q", value) + taint)


def _sorted(branches: list[_Branch], tape: Tape) -> list[_Branch]:
    """Reachable ones first, then by joint values."""
    found = [_finite(branch, tape) for branch in branches]
    for low, high in _EXCHANGES[len(found)]:
        a, b = found[low], found[high]
        late = less(_ORDER, tape.let("later", a.q[-1] - b.q[-1]))
        for x, y in reversed(list(zip(a.q[:-1], b.q[:-1], strict=True))):
            gap = tape.let("later", x - y)
            late = either(less(_ORDER, gap), both(at_most(-_ORDER, gap), late))
        swap = tape.let("swap", chosen(less(a.reaches, b.reaches), 1, chosen(both(at_most(a.reaches, b.reaches), late), 1, 0)))
        other = less(0, swap)
        found[low], found[high] = _exchanged(other, b, a, tape), _exchanged(other, a, b, tape)
    return found


def _finite(branch: _Branch, tape: Tape) -> _Branch:
    """What does not reach may have got lost on its way: 0 instead of NaN."""
    sane = finite(tape.let("sum", sympy.Add(*branch.q)))
    return replace(branch, q=tuple(tape.let("sane", chosen(sane, x, 0)) for x in branch.q))


def _exchanged(truth: sympy.Basic, then: _Branch, otherwise: _Branch, tape: Tape) -> _Branch:
    q = tuple(tape.let("sorted", chosen(truth, a, b)) for a, b in zip(then.q, otherwise.q, strict=True))
    reaches, singular = (
        tape.let("sorted", chosen(truth, a, b)) for a, b in ((then.reaches, otherwise.reaches), (then.singular, otherwise.singular))
    )
    return _Branch(q, reaches, singular, then.twofold)


def _alike(kinds: str, a: _Branch, b: _Branch, tape: Tape) -> sympy.Basic:
    """Whether two branches are one, angles modulo a turn."""
    turn = constant(2 * sympy.pi)
    truth: sympy.Basic | None = None
    for kind, x, y in zip(kinds, a.q, b.q, strict=True):
        gap = tape.let("apart", abs(x - y))
        one = at_most(gap, _SAME)
        if kind == "R":
            one = either(one, at_most(turn - _SAME, gap))
        truth = one if truth is None else both(truth, one)
    assert truth is not None
    return truth


def _screws(kinds: str, geometry: Sequence[sympy.Expr]) -> tuple[tuple[Screw, ...], Vec]:
    numbers = [sympy.sympify(item) for item in geometry]
    screws = []
    for index, kind in enumerate(kinds):
        axis, point = folded(numbers[6 * index : 6 * index + 3]), folded(numbers[6 * index + 3 : 6 * index + 6])
        length2 = dot(axis, axis)
        if length2.is_number and abs(constant(length2) - 1) > sympy.Float("1e-40", 50):  # printed with some digits only
            axis = folded(scaled(1 / sympy.sqrt(length2), axis))
        screws.append(Screw(kind, axis, point))
    return tuple(screws), folded(numbers[6 * len(kinds) :])


def _size(screws: Sequence[Screw], foot: Vec) -> sympy.Expr:
    """A power of two near the leg's length where that is known and not about 1 m: thresholds count on it."""
    parts = [x for vector in (*(screw.point for screw in screws[1:]), foot) for x in minus(vector, screws[0].point)]
    if not all(part.is_number for part in parts):
        return sympy.S.One
    largest = max(float(abs(part)) for part in parts)
    return sympy.S.One if largest == 0 or 0.25 <= largest <= 4 else sympy.Integer(2) ** int(sympy.ceiling(sympy.log(largest, 2).evalf()))
