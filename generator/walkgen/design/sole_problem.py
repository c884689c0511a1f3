"""A sole's design as a problem: the largest angular acceleration of the foot and the largest moment of the ankle are to be small.

A largest value is a variable of its own, which nothing at any instant may exceed: that keeps all slopes defined.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from walkgen.design.problem import Constraint, Objective, Problem, Reals, Values, Variable
from walkgen.design.sole_roll import Course, SoleRoll

PEAKS = {"acceleration": "foot_acceleration", "moment": "ankle_moment"}
"""The objectives, and whose largest size each is."""
UNITS = {"acceleration": "rad/s^2", "moment": "N m"}
_ROOM = 4.0
"""How far a largest value may be from that of the spec's own design, in its own size."""
_LEAST_SHARE = 0.02
_SLACK = 1.1
"""Room between a largest value and what it is the largest of, as a search begins: without any, first steps lead nowhere."""
_LEAST_BULGE = 1e-3
"""By how much the foot turns over the whole of a curve, as slowly as anywhere (rad); a straight one is no sole."""
_LEAST_ROOM = 1e-6
"""What is left of the curve's range at the end of the roll."""
Limit = Callable[[Reals], Values]


@dataclass(frozen=True)
class SoleProblem:
    """Of one roll; x are its variables, then one largest value for each of `PEAKS`."""

    roll: SoleRoll

    @property
    def count(self) -> int:
        """Of the roll's own variables."""
        return len(self.roll.names)

    def sizes(self) -> dict[str, float]:
        """Of the peaks at the spec's own values, by which they are weighed; 1 where those cannot roll."""
        course = self.roll.at(self.start())
        found = {name: course.peak(quantity) for name, quantity in PEAKS.items()}
        return {name: peak if math.isfinite(peak) and peak > 0.0 else 1.0 for name, peak in found.items()}

    def start(self) -> Reals:
        """The spec's own values, inside the bounds."""
        variables = self.roll.variables
        return np.clip(*(np.array([getattr(variable, key) for variable in variables]) for key in ("start", "low", "high")))

    def problem(self, weights: dict[str, float], most: dict[str, float] | None = None, start: Reals | None = None) -> Problem:
        """The weighted sum of squared peaks, in shares of the spec's own.

        Args:
            weights: of the peaks.
            most: what peaks may be at most, in their units.
            start: of the roll's variables, instead of the spec's values.
        """
        sizes, begin = self.sizes(), self.start() if start is None else start
        course = self.roll.at(begin)
        own = [replace(variable, start=float(value)) for variable, value in zip(self.roll.variables, begin, strict=True)]
        peaks = []
        for name, quantity in PEAKS.items():
            peak, high = course.peak(quantity), min(_ROOM * sizes[name], (most or {}).get(name, math.inf))
            start_at = min(_SLACK * peak, high) if math.isfinite(peak) else high
            peaks.append(Variable(f"largest_{name}", _LEAST_SHARE * high, high, start_at, UNITS[name]))
        objectives = tuple(
            Objective(name, self._share(number, sizes[name]), weights[name]) for number, name in enumerate(PEAKS) if weights[name] > 0.0
        )
        constraints = [Constraint(f"largest_{name}", self._above(number, name, sizes[name])) for number, name in enumerate(PEAKS)]
        return Problem((*own, *peaks), objectives, (*constraints, *self._limits()))

    def _share(self, number: int, size: float) -> Limit:
        def residual(x: Reals) -> Values:
            slopes = np.zeros((1, len(x)))
            slopes[0, self.count + number] = 1.0 / size
            return Values(np.array([x[self.count + number] / size]), slopes)

        return residual

    def _above(self, number: int, name: str, size: float) -> Limit:
        """A largest value less the size of what it is the largest of."""

        def margins(x: Reals) -> Values:
            found = self.roll.at(x[: self.count]).of(PEAKS[name])
            values = np.concatenate([x[self.count + number] - sign * found.values for sign in (1.0, -1.0)]) / size
            slopes = self._wide(np.concatenate([-found.slopes, found.slopes]) / size)
            slopes[:, self.count + number] = 1.0 / size
            return Values(values, slopes)

        return margins

    def _wide(self, slopes: Reals) -> Reals:
        """With columns for the largest values."""
        return np.concatenate([slopes, np.zeros((len(slopes), len(PEAKS)))], axis=1)

    # ---- what the table limits

    def _limits(self) -> Iterator[Constraint]:
        table = self.roll
        if (flat := table.pair("flat")) is not None:
            yield Constraint("flat", self._between(flat, self._flat_length))
        if (used := table.pair("used")) is not None:
            used = (used[0], used[1] - _LEAST_ROOM * (used[1] - used[0]))
            yield Constraint("used", self._between(used, self._last_of("contact")))
        if used is None or used[1] > self._least_end():
            yield Constraint("end", self._beyond(self._last_of("room"), _LEAST_ROOM, 1.0))
        if (curvature := table.pair("curvature")) is not None:
            yield Constraint("curvature", self._between(curvature, self._all_of("curvature")))
        if (reach := table.number("reach")) is not None:
            yield Constraint("reach", self._beyond(self._all_of("extension"), reach, -1.0))
        knee = table.number("knee")
        yield Constraint("knee", self._beyond(self._all_of("knee"), 0.0 if knee is None else knee, 1.0))
        yield Constraint("forward", self._beyond(self._all_of("contact_rate"), 0.0, 1.0))
        yield Constraint("convex", self._beyond(self._bulge, _LEAST_BULGE, 1.0))

    def _between(self, limits: tuple[float, float], value: Limit) -> Limit:
        low, high = limits

        def margins(x: Reals) -> Values:
            found = value(x)
            values = np.concatenate([found.values - low, high - found.values]) / (high - low)
            return Values(values, self._wide(np.concatenate([found.slopes, -found.slopes]) / (high - low)))

        return margins

    def _beyond(self, value: Limit, limit: float, sign: float) -> Limit:
        def margins(x: Reals) -> Values:
            found = value(x)
            return Values(sign * (found.values - limit), self._wide(sign * found.slopes))

        return margins

    def _flat_length(self, x: Reals) -> Values:
        return self.roll.flat_length(x[: self.count])

    def _least_end(self) -> float:
        """Of the curve, at either end of the variables' bounds and at the spec's values."""
        ends = (np.array([getattr(variable, key) for variable in self.roll.variables]) for key in ("low", "start", "high"))
        return min(self.roll.bounds(x)[1] for x in ends)

    def _bulge(self, x: Reals) -> Values:
        return self.roll.bulge(x[: self.count])

    def _all_of(self, quantity: str) -> Limit:
        return lambda x: self._course(x).of(quantity)

    def _last_of(self, quantity: str) -> Limit:
        def last(x: Reals) -> Values:
            found = self._course(x).of(quantity)
            return Values(found.values[-1:], found.slopes[-1:])

        return last

    def _course(self, x: Reals) -> Course:
        return self.roll.at(x[: self.count])
