"""A cam whose measures may vary as a problem: small pressure angles and forces; the follower pressed on, no undercut, no slack spring."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from walkgen.design.balance import Balance
from walkgen.design.problem import Constraint, Objective, Problem, Reals, Values
from walkgen.design.statics import Numbers
from walkgen.model.cam_potential import Cam, CamError, Weight, bend, level_set
from walkgen.model.cams import gravity_of, potential_of, weight_of
from walkgen.model.walk import CONTEXT, defaults
from walkgen.spec.scalar import Scalar

_CLOSE, _STEP = 1e-14, 1e-6
"""Of Newton's method; of differences, as a share of the bounds."""
_STEPS = 3
_NODES, _EVEN = 16, 21
_LEAST_PRESS, _LEAST_BEND = 0.05, 0.02
"""Of the follower's press at the first angle; of 1 less the roller's radius by the cam's."""
_SIZE = 0.1
"""Margins of lengths are shares of it (m)."""


@dataclass(frozen=True)
class Shape:
    """Of a cam at some angles.

    Attributes:
        ways: from the hip to the roller's centre (m).
        tangent: of the pressure angle.
        force: on the roller (N).
        press: slope of the potential by the way, as a share of the first.
        bends: 1 less the roller's radius by the cam's.
        lengths: of the spring (m).
        free: its free length.
    """

    ways: Reals
    tangent: Reals
    force: Reals
    press: Reals
    bends: Reals
    lengths: Reals
    free: float


class CamProblem:
    """Of a balance by a cam.

    Args:
        balance: whose variables are in the cam's table, or anywhere.

    Raises:
        CamError: the joint is not level, or there is no gravity.
    """

    def __init__(self, balance: Balance) -> None:
        self.balance, (self.cam,), (self.range,) = balance, balance.leg.cams, balance.ranges
        values = defaults(balance.mechanism)
        self._gravity = float(gravity_of(balance.mechanism, balance.leg, self.cam, values))
        scalars = (*self.cam.masses, self.cam.lever, self.cam.reach, self.cam.centre, self.cam.start, self.cam.roller)
        spring = self.cam.spring
        self._scalars: tuple[Scalar, ...] = (*scalars, spring.stiffness, spring.free_length, spring.tension)
        self._numbers = Numbers(balance.mechanism, self._scalars, balance.names)
        nodes, weights = self.range.gauss(_NODES)
        self._angles, order = np.unique(np.concatenate([[self.range.low], nodes, self.range.dense(_EVEN)]), return_index=True)
        self._nodes = np.flatnonzero((order >= 1) & (order <= _NODES))
        self._roots = np.sqrt(weights)
        self._last: tuple[bytes, Reals, Reals] | None = None

    @cached_property
    def problem(self) -> Problem:
        """To be solved."""
        table = self.balance.table.cam
        assert table is not None
        pressure, force = (1.0 if entry is None else self.balance.number(entry) for entry in (table.weights.pressure, table.weights.force))
        objectives = (
            Objective("pressure", lambda x: self._part(x, 0, _NODES), pressure),
            Objective("force", lambda x: self._part(x, _NODES, 2 * _NODES), force),
        )
        return Problem(self.balance.variables, objectives, (Constraint("cam", lambda x: self._part(x, 2 * _NODES, None)),))

    def _part(self, x: Reals, start: int, end: int | None) -> Values:
        if self._last is None or self._last[0] != x.tobytes():
            self._last = x.tobytes(), *self._rows_and_slopes(x)
        return Values(self._last[1][start:end], self._last[2][start:end])

    def _rows_and_slopes(self, x: Reals) -> tuple[Reals, Reals]:
        """Residuals, then margins; NaN where there is no cam."""
        try:
            shape = self.shape(x)
        except CamError:
            none = np.full(2 * _NODES + len(self._angles) * (3 + bool(self._stretch[1]) + 2 * bool(self._steepest)), np.nan)
            return none, np.zeros((len(none), len(x)))
        here, span = self._rows(shape), self.problem.high - self.problem.low
        steps = np.where(x + _STEP * span > self.problem.high, -_STEP, _STEP) * span
        beside = (self._rows(self.shape(x + step * unit, shape.ways)) for step, unit in zip(steps, np.eye(len(x)), strict=True))
        return here, np.stack([(rows - here) / step for rows, step in zip(beside, steps, strict=True)], -1)

    def _rows(self, shape: Shape) -> Reals:
        residuals = [part[self._nodes] * self._roots for part in (shape.tangent, shape.force / self._force)]
        return np.concatenate([*residuals, self._margins(shape)])

    def shape(self, x: Reals, near: Reals | None = None) -> Shape:
        """For the variables' values.

        Args:
            x: the values.
            near: ways of a cam that is hardly another one.

        Raises:
            CamError: somewhere the follower is not pressed on the cam.
        """
        numbers = dict(zip(self._scalars, map(float, self._numbers.at(x)[0]), strict=True))
        cam: Cam = potential_of(self.cam, self._weight(x), self._gravity, numbers.__getitem__)
        r = self._ways(cam, numbers[self.cam.start], near)
        found = cam.potential(self._angles, r, np)
        bent, side = bend(found, r, np), math.copysign(1.0, found.r[0])
        bends = 1.0 - side * numbers[self.cam.roller] * bent.curvature
        free = numbers[self.cam.spring.free_length]
        return Shape(r, bent.slope / r, found.r * bent.size / r, found.r / found.r[0], bends, found.length, free)

    def _ways(self, cam: Cam, start: float, near: Reals | None) -> Reals:
        if near is None:
            return np.array(level_set(cam, list(map(float, self._angles)), start, math, _CLOSE))
        level = cam.potential(self._angles[0], start, np).value
        for _ in range(_STEPS):
            found = cam.potential(self._angles, near, np)
            near = near - (found.value - level) / found.r
        return near

    def _margins(self, shape: Shape) -> Reals:
        parts = [shape.press - _LEAST_PRESS, shape.bends - _LEAST_BEND]
        low, high = self._stretch
        parts += [(shape.lengths - low * shape.free) / _SIZE] + ([(high * shape.free - shape.lengths) / _SIZE] if high else [])
        return np.concatenate(parts + [self._steepest - sign * shape.tangent for sign in (1, -1) if self._steepest])

    @cached_property
    def _stretch(self) -> tuple[float, float]:
        """Least and largest length in free lengths; any above 1 where the spec is silent."""
        given = self.balance.table.stretch
        return (1.0, 0.0) if given is None else (self.balance.number(given[0]), self.balance.number(given[1]))

    @cached_property
    def _steepest(self) -> float:
        table = self.balance.table.cam
        most = None if table is None else table.most_pressure_deg
        return 0.0 if most is None else math.tan(math.radians(self.balance.number(most)))

    @cached_property
    def _force(self) -> float:
        """That which would hold the largest moment without cam at the hip's distance `start`."""
        start = self._numbers.at(self.problem.start)[0][self._scalars.index(self.cam.start)]
        return self.balance.size / float(start)

    def _weight(self, x: Reals) -> Weight:
        """Of what the joint moves; the same for all where no variable has to do with it."""
        return self._weights_at(x) if self._weight_moves else self._weight_given

    @cached_property
    def _weight_given(self) -> Weight:
        return self._weights_at(self.problem.start)

    @cached_property
    def _weight_moves(self) -> bool:
        return any(self._weights_at(x) != self._weight_given for x in (self.problem.low, self.problem.high))

    def _weights_at(self, x: Reals) -> Weight:
        values = defaults(self.balance.mechanism) | {
            name: CONTEXT.mpf(float(entry)) for name, entry in zip(self.balance.names, x, strict=True)
        }
        found = weight_of(self.balance.mechanism, self.balance.leg, self.cam, values)
        return Weight(float(found.a), float(found.b))

    def unsuited(self, x: Reals) -> str:
        """What is worst of a cam that does not suit, and where."""
        try:
            shape = self.shape(x)
        except CamError as error:
            return f"fails: {error} at {self.range.name} = {error.angle:.4g} rad"
        words = ["is hardly pressed on", "is undercut", "has a spring that is too short", "has a spring that is too long", "is too steep"]
        named = words[:3] + words[3:4] * bool(self._stretch[1]) + words[4:] * (2 * bool(self._steepest))
        margins = self._margins(shape).reshape(len(named), -1)
        row, place = np.unravel_index(int(margins.argmin()), margins.shape)
        return f"{named[row]} at {self.range.name} = {self._angles[place]:.4g} rad"
