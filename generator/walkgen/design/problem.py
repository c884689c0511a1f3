"""A search for parameters: variables between bounds, a sum of squares to make small, and what must not be negative."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]


@dataclass(frozen=True)
class Variable:
    """A parameter of the spec that may move between its bounds."""

    name: str
    low: float
    high: float
    start: float
    unit: str = "1"


@dataclass(frozen=True)
class Values:
    """Of functions of the variables: what they are [m], and their slopes [m, n]."""

    values: Reals
    slopes: Reals


Functions = Callable[[Reals], Values]
"""Of the variables [n], each in its own unit."""


@dataclass(frozen=True)
class Objective:
    """Half the sum of squares of its residuals, `weight` times, is to be small."""

    name: str
    residuals: Functions
    weight: float = 1.0


@dataclass(frozen=True)
class Constraint:
    """Every value must be 0 or more; values are of the size of 1."""

    name: str
    margins: Functions


@dataclass(frozen=True)
class Problem:
    """Variables, objectives whose weighted sum counts, constraints."""

    variables: tuple[Variable, ...]
    objectives: tuple[Objective, ...]
    constraints: tuple[Constraint, ...] = ()

    @property
    def start(self) -> Reals:
        """What the spec says, inside the bounds [n]."""
        return np.clip([variable.start for variable in self.variables], self.low, self.high)

    @property
    def low(self) -> Reals:
        """Least values [n]."""
        return np.array([variable.low for variable in self.variables], dtype=float)

    @property
    def high(self) -> Reals:
        """Largest values [n]."""
        return np.array([variable.high for variable in self.variables], dtype=float)

    def residuals(self, x: Reals) -> Values:
        """Of all objectives, each with the root of its weight."""
        parts = [(np.sqrt(objective.weight), objective.residuals(x)) for objective in self.objectives]
        return _stacked([Values(root * part.values, root * part.slopes) for root, part in parts], len(x))

    def margins(self, x: Reals) -> Values:
        """Of all constraints."""
        return _stacked([constraint.margins(x) for constraint in self.constraints], len(x))

    def cost(self, x: Reals) -> float:
        """Half the weighted sum of squares."""
        return float(0.5 * np.sum(self.residuals(x).values ** 2))

    def violation(self, x: Reals) -> float:
        """By how much the worst constraint is broken; 0 where none is, infinite where one cannot be told."""
        worst = float(np.min(self.margins(x).values, initial=0.0))
        return -worst if np.isfinite(worst) else np.inf


def _stacked(parts: list[Values], variables: int) -> Values:
    values = np.concatenate([part.values for part in parts]) if parts else np.zeros(0)
    slopes = np.concatenate([part.slopes for part in parts]) if parts else np.zeros((0, variables))
    return Values(values, slopes)
