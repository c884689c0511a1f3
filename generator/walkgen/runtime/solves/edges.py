"""Chains of closed loops at rest where a loop ceases to close: the reference of walkgen_edges.h and walkgen_chart.h.

There the foot's slopes are infinite: its place is a smooth function of the root of the loop's margin, which is itself smooth. In a chart
the roots u of small margins stand for as many joint values, those that move them most: margin(q) = u^2, u >= a bound.
"""

from dataclasses import dataclass, replace

import numpy as np

from walkgen.runtime.solves.boxed import Box
from walkgen.runtime.solves.resting import edges_stand, settle_down
from walkgen.runtime.solves.rows import Reals, Truths
from walkgen.runtime.solves.serial import EPSILON, Arm, Motion, Places, Stance, every, reaches, stance_at

_CHARTS, _STEPS = 8, 20
_LONGEST, _SMALL, _LEAST_SLOPE, _TIRED = 0.1, 1e-2, 1e-3, 0.01
_LEVELS = (2.0**-10, 2.0**-15, 2.0**-20)
_LAST = (2.0**-22, 2.0**-23, 2.0**-24, 2.0**-25)
_POSITION = 3


def come_to_rest(arm: Arm, box: Box, at: Stance) -> tuple[Stance, Truths]:
    """Lead stances to rest where no way leads down: which get there [b]."""
    at, rests = settle_down(arm, box, at)
    if arm.motion is None:
        return at, rests
    plain = (rests | reaches(arm, at)) & every(at.edge == 0.0)
    rows = np.flatnonzero(~plain & np.isfinite(at.gap))
    if rows.size:
        found, ended = _along_edges(arm.take(rows), arm.motion.take(rows), box.take(rows), at.take(rows))
        stand = rests[rows] & edges_stand(arm.take(rows), box.take(rows), at.take(rows))
        taken = np.flatnonzero(ended | (~stand & (found.gap < at.gap[rows])))
        at, rests[rows] = at.put(rows[taken], found.take(taken)), ended | stand
    return at, rests


@dataclass(frozen=True)
class _Chart:
    """Which margins' roots stand for which joints of arms that slide or turn, and the arms' function.

    What it is called with besides the chart's values y [b, n] is a pose q [b, n], the bounds of the joints [b, n] twice, the arms' size
    [b], and what their function takes.
    """

    sliding: Truths
    motion: Motion
    edge: Places
    joint: Places

    def __call__(self, y: Reals, q: Reals, low: Reals, high: Reals, size: Reals, *data: Reals) -> Reals:
        """The foot with its derivatives by the chart's values, as a chain's function."""
        _, there, (feet, slopes, bends) = self.pose(y, q, low, high, size, *data)
        lines, joint, (count, n) = _POSITION + self.edge, self.joint, y.shape
        own, each = np.ones(n), np.arange(len(joint))
        own[joint] = 0.0
        matrix, fine = _regular(slopes[:, lines][:, :, joint])
        inverse, by = np.linalg.inv(matrix), -own * slopes[:, lines]
        by[:, each, joint] = 2.0 * np.sqrt(np.maximum(feet[:, lines], 0.0))
        moves = np.broadcast_to(np.diag(own), (count, n, n)).copy()
        moves[:, joint] = inverse @ by
        bent = np.einsum("bli,bklm,bmj->bkij", moves, bends, moves)
        lacks = -bent[:, lines]
        lacks[:, each, joint, joint] += 2.0
        along = slopes[:, :_POSITION]
        bent = bent[:, :_POSITION] + np.einsum("brk,bkl,blij->brij", along[:, :, joint], inverse, lacks)
        values = np.concatenate([feet[:, :_POSITION], (along @ moves).reshape(count, 3 * n), bent.reshape(count, 3 * n * n)], -1)
        return np.where((there & fine)[:, None], values, np.nan)

    def pose(
        self, y: Reals, q: Reals, low: Reals, high: Reals, size: Reals, *data: Reals
    ) -> tuple[Reals, Truths, tuple[Reals, Reals, Reals]]:
        """The poses [b, n] that the chart's values stand for, which rows have one within bounds, and the motion there."""
        lines, motion, joint = _POSITION + self.edge, replace(self.motion, data=data), self.joint
        found, step = y.copy(), np.zeros((len(y), len(joint)))
        found[:, joint] = q[:, joint]
        before, part, ended = np.full(len(y), np.inf), np.ones(len(y)), np.zeros(len(y), bool)
        for _ in range(_STEPS):
            *parts, there = motion.at(self.sliding, size.astype(int), found)
            with np.errstate(invalid="ignore", over="ignore"):
                lack = y[:, joint] ** 2 - parts[0][:, lines]
                matrix, fine = _regular(parts[1][:, lines][:, :, joint])
                own = np.linalg.solve(matrix, np.where(fine[:, None], lack, 0.0)[..., None])[..., 0]
                fine &= every(np.isfinite(own)) & every(np.isfinite(lack))
                worst = np.where(fine, np.max(np.abs(lack), axis=-1), np.inf)
            ended = ended | (there & ((worst <= 0.0) | ((worst <= 64.0 * EPSILON) & ~(worst < 0.5 * before))))
            if ended.all():
                break
            part = np.where(fine, 1.0, 0.5 * part)
            own = np.clip(np.where(fine[:, None], own, 0.0), -_LONGEST, _LONGEST)
            moved = np.where(fine[:, None], own, -part[:, None] * step)  # back where loops are open before it can be told
            found[:, joint] += np.where(ended[:, None], 0.0, moved)
            step, before = np.where(fine[:, None], own, step), worst
        mine = found[:, joint]
        slack = 8.0 * EPSILON * (1.0 + np.abs(mine))
        inside = (mine >= low[:, joint] - slack) & (mine <= high[:, joint] + slack)
        return found, ended & every(inside), (parts[0], parts[1], parts[2])

    def chains(self, arm: Arm, box: Box, q: Reals, margins: Reals, data: tuple[Reals, ...]) -> tuple[Arm, Box, Stance]:
        """The chart of arms as arms, their bounds, of roots the first one, and where they start."""
        sliding, low, high, y = self.sliding.copy(), box.low.copy(), box.high.copy(), q.copy()
        sliding[self.joint], low[:, self.joint], high[:, self.joint] = False, _LEVELS[0], np.inf
        y[:, self.joint] = np.maximum(np.sqrt(np.maximum(margins[:, self.edge], 0.0)), _LEVELS[0])
        charted = replace(arm, sliding=sliding, size=np.zeros_like(arm.size), motion=Motion(self, data, charted=True))
        return charted, Box(low, high), stance_at(charted, y)

    def rest(self, arm: Arm, box: Box, here: Stance) -> tuple[Stance, Truths]:
        """Led to rest above the roots' first bound, then closer to the edge as bounds sink; whether the first is at rest."""
        here, rests = settle_down(arm, box, here)
        rows = np.flatnonzero(rests)
        for level in _LEVELS[1:] if rows.size else ():
            low = box.low[rows].copy()
            low[:, self.joint] = level
            here = here.put(rows, settle_down(arm.take(rows), Box(low, box.high[rows]), here.take(rows))[0])
        return here, rests

    def left(self, arm: Arm, box: Box, here: Stance, data: tuple[Reals, ...]) -> Stance:
        """Back to q, roots at their last bound made smaller if that leads nearer."""
        best = None
        for level in (None, *_LAST):
            y = here.q.copy()
            if level:
                y[:, self.joint] = np.where(y[:, self.joint] <= _LEVELS[-1], level, y[:, self.joint])
            q, there, (_, slopes, _) = self.pose(y, *data)
            q = box.clamped(q)
            found = stance_at(arm, q)
            there &= self._firm(arm, q, slopes) if level else True
            found = replace(found, gap=np.where(there, found.gap, np.inf))
            nearer = np.flatnonzero(found.gap < best.gap) if best else np.zeros(0, np.intp)
            best = best.put(nearer, found.take(nearer)) if best else found
        assert best
        return best

    def _firm(self, arm: Arm, q: Reals, slopes: Reals) -> Truths:
        """Whether the foot is there however the last digits of q are rounded: with margins made smaller by that."""
        roundings = 2.0 * EPSILON * (np.where(arm.sliding, 0.0, np.pi) + np.abs(q))  # a turn may be taken off or added
        tried = [stance_at(arm, q - np.sign(slopes[:, _POSITION + edge]) * roundings) for edge in self.edge]
        return every(np.isfinite(np.stack([stance.gap for stance in tried], -1)))


def _regular(matrix: Reals) -> tuple[Reals, Truths]:
    """Matrices [b, k, k], the unit matrix instead of singular ones, and which are not."""
    fine = every(every(np.isfinite(matrix)))
    some = np.where(fine[:, None, None], matrix, np.eye(matrix.shape[-1]))
    fine = fine & (np.linalg.det(some) != 0.0)
    return np.where(fine[:, None, None], some, np.eye(matrix.shape[-1])), fine


def _charted(margins: Reals, slopes: Reals, held: Truths, tired: Truths) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Of one pose the small margins and as many joints, not at their bounds, that move these margins' roots most; rather not tired ones."""
    closed = ~held & np.isfinite(slopes) & (margins < _SMALL)[:, None]
    left = np.where(closed, 0.5 * slopes / np.sqrt(np.maximum(margins, EPSILON**2))[:, None], 0.0) * np.where(tired, _TIRED, 1.0)
    pairs = []
    while left.size and np.max(np.abs(left)) > _LEAST_SLOPE:
        edge, joint = np.unravel_index(np.argmax(np.abs(left)), left.shape)
        left = left - np.outer(left[:, joint] / left[edge, joint], left[edge])
        left[edge], left[:, joint] = 0.0, 0.0
        pairs.append((int(edge), int(joint)))
    return tuple(edge for edge, _ in pairs), tuple(joint for _, joint in pairs)


def _along_edges(arm: Arm, motion: Motion, box: Box, at: Stance) -> tuple[Stance, Truths]:
    """Lead stances, near where loops cease to close, to rest there or elsewhere, by at most eight charts: which get there [b]."""
    rests, tired, rows = np.zeros(len(at.q), bool), np.zeros(at.q.shape, bool), np.arange(len(at.q))
    for _ in range(_CHARTS):
        feet, slopes, _, there = motion.take(rows).at(arm.sliding, arm.size[rows], at.q[rows])
        slack = 64.0 * EPSILON * (1.0 + np.abs(at.q))
        held = (at.q <= box.low + slack) | (at.q >= box.high - slack)
        margins, slopes = feet[:, _POSITION:], slopes[:, _POSITION:]
        charts = [_charted(*items) for items in zip(margins, slopes, held[rows], tired[rows], strict=True)]
        tired[:] = False
        again = [np.zeros(0, np.intp)]
        for edge, joint in sorted({chart for chart, fine in zip(charts, there, strict=True) if chart[0] and fine}):
            own = np.array([place for place, chart in enumerate(charts) if chart == (edge, joint) and there[place]])
            some, places = rows[own], np.array(joint)
            chart = _Chart(arm.sliding, motion, np.array(edge), places)
            found, rests[some], fine = _by(chart, arm.take(some), box.take(some), at.take(some), margins[own])
            nearer = np.flatnonzero(np.isfinite(found.gap) & (rests[some] | (found.gap < at.gap[some])))
            rests[some] &= np.isfinite(found.gap)
            at = at.put(some[nearer], found.take(nearer))
            tired[np.ix_(some, places)] = True
            again.append(some[fine & ~rests[some]])
        rows = np.sort(np.concatenate(again))
        if not rows.size:
            break
    return at, rests


def _by(chart: _Chart, arm: Arm, box: Box, at: Stance, margins: Reals) -> tuple[Stance, Truths, Truths]:
    """Stances led to rest in a chart, which are at rest, and for which it was one."""
    assert arm.motion
    data: tuple[Reals, ...] = (at.q, box.low, box.high, arm.size.astype(float), *arm.motion.data)
    charted, bounds, here = chart.chains(arm, box, at.q, margins, data)
    fine = np.isfinite(here.gap)
    rows, rests = np.flatnonzero(fine), np.zeros(len(fine), bool)
    if rows.size:
        led, rests[rows] = chart.rest(charted.take(rows), bounds.take(rows), here.take(rows))
        here = here.put(rows, led)
    found = chart.left(arm, box, here, data)
    return replace(found, gap=np.where(fine, found.gap, np.inf)), rests, fine
