"""Solves a problem from many starts: sequential quadratic programming from each, and more closely from the best answer.

Least squares with soft constraints before that lead to no better answers, and their costs say nothing of what hard constraints will make
of them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from walkgen.design.blocks import blocks_of
from walkgen.design.problem import Problem, Reals, Values

Progress = Callable[[str], None]
_ROUGHLY, _CLOSELY = 1e-10, 1e-15
"""Changes of the cost that are none: from every start, from the best answer."""
_STEPS = 300
_FEASIBLE = 1e-7
_BAD = 10.0
"""A residual or a broken constraint where there is none: a linkage that does not assemble."""


@dataclass(frozen=True)
class Found:
    """An answer: variables [n], half the weighted sum of squares, how far the worst constraint is broken."""

    x: Reals
    cost: float
    violation: float

    @property
    def feasible(self) -> bool:
        """Whether no constraint is broken by more than rounding, and all residuals exist."""
        return self.violation <= _FEASIBLE and bool(np.isfinite(self.cost))

    @property
    def _order(self) -> tuple[bool, float]:
        return not self.feasible, self.cost if self.feasible else self.violation

    def better(self, other: "Found") -> bool:
        """Feasible before infeasible, then the lesser cost; of infeasible ones the less broken."""
        return self._order < other._order


def solved(problem: Problem, starts: int, seed: int = 0, progress: Progress = lambda _: None) -> Found:
    """The best answer from the problem's own start and from random ones, part by part where it falls apart; the same for the same seed.

    Args:
        problem: with exact slopes.
        starts: random starts, spread evenly between the bounds of each variable.
        seed: of the starts.
        progress: is told after every start.
    """
    names = [variable.name for variable in problem.variables]
    x = problem.start
    for part in blocks_of(problem, seed):
        x[[names.index(variable.name) for variable in part.variables]] = _solved(part, starts, seed, progress).x
    return Found(x, problem.cost(x), problem.violation(x))


def _solved(problem: Problem, starts: int, seed: int, progress: Progress) -> Found:
    unit = _Unit(problem)
    best = Found(problem.start, problem.cost(problem.start), problem.violation(problem.start))
    for number, y in enumerate(_starts(problem, starts, seed), 1):
        found = unit.polished(y, _ROUGHLY)
        best = found if found.better(best) else best
        progress(f"start {number} of {starts + 1}, best {best.cost:.4g}")
    found = unit.polished(unit.y(best.x), _CLOSELY)
    return found if found.better(best) else best


def _starts(problem: Problem, starts: int, seed: int) -> Iterator[Reals]:
    """As shares of the bounds: the problem's own, then a Latin hypercube, which leaves out no part of any variable's bounds."""
    generator = np.random.default_rng(seed)
    yield (problem.start - problem.low) / (problem.high - problem.low)
    cells = generator.permuted(np.tile(np.arange(starts), (len(problem.variables), 1)), axis=1).T
    yield from (cells + generator.uniform(size=cells.shape)) / max(starts, 1)


class _Unit:
    """The problem in shares of its bounds."""

    def __init__(self, problem: Problem) -> None:
        self._problem, self._low, self._span = problem, problem.low, problem.high - problem.low
        self._last: tuple[bytes, Values, Values] | None = None

    def x(self, y: Reals) -> Reals:
        """In the variables' own units."""
        return self._low + self._span * np.clip(y, 0.0, 1.0)

    def _at(self, y: Reals) -> tuple[Values, Values]:
        """Residuals and margins; solvers ask for values and slopes one after the other."""
        key = y.tobytes()
        if self._last is None or self._last[0] != key:
            x = self.x(y)
            self._last = (key, self._finite(self._problem.residuals(x), _BAD), self._finite(self._problem.margins(x), -_BAD))
        return self._last[1], self._last[2]

    def _finite(self, part: Values, bad: float) -> Values:
        """With slopes by shares of the bounds; what does not exist is bad."""
        return Values(np.nan_to_num(part.values, nan=bad), np.nan_to_num(part.slopes * self._span))

    def y(self, x: Reals) -> Reals:
        """Shares of the bounds."""
        return (x - self._low) / self._span

    def polished(self, y: Reals, closeness: float) -> Found:
        """Sequential quadratic programming from there, until the cost changes by no more."""
        constraint = {"type": "ineq", "fun": lambda y: self._at(y)[1].values, "jac": lambda y: self._at(y)[1].slopes}
        answer = minimize(
            lambda y: 0.5 * float(np.sum(self._at(y)[0].values ** 2)),
            y,
            jac=lambda y: self._at(y)[0].slopes.T @ self._at(y)[0].values,
            bounds=[(0.0, 1.0)] * len(y),
            constraints=[constraint] if len(self._at(y)[1].values) else [],
            method="SLSQP",
            options={"maxiter": _STEPS, "ftol": closeness},
        )
        found = [self._found(answer.x), self._found(y)]
        return found[0] if found[0].better(found[1]) else found[1]

    def _found(self, y: Reals) -> Found:
        x = self.x(y)
        return Found(x, self._problem.cost(x), self._problem.violation(x))
