"""Cubic splines through evenly spaced points: smooth paths of platforms and connecting chains, straight where the points are."""

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Spline:
    """Natural: continuous up to the second derivative, which is 0 at both ends.

    Attributes:
        start: where the first point is.
        spacing: from point to point.
        values: the points [m, n], two at least.
    """

    start: float
    spacing: float
    values: np.ndarray
    bends: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "bends", _bends(self.values, self.spacing))

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Value, first and second derivative [t, n] at x [t], which lies between the first and the last point."""
        place = (x - self.start) / self.spacing
        left = np.clip(np.floor(place).astype(int), 0, len(self.values) - 2)
        b = (place - left)[:, None]
        a, h = 1.0 - b, self.spacing
        low, high, bent, bending = self.values[left], self.values[left + 1], self.bends[left], self.bends[left + 1]
        value = a * low + b * high + ((a**3 - a) * bent + (b**3 - b) * bending) * h**2 / 6.0
        slope = (high - low) / h + ((3.0 * b**2 - 1.0) * bending - (3.0 * a**2 - 1.0) * bent) * h / 6.0
        return value, slope, a * bent + b * bending


def _bends(values: np.ndarray, spacing: float) -> np.ndarray:
    """Second derivatives at the points: the tridiagonal system of a natural spline, eliminated in one pass."""
    right = np.zeros_like(values)
    right[1:-1] = 6.0 * (values[2:] - 2.0 * values[1:-1] + values[:-2]) / spacing**2
    above = np.zeros(len(values))
    for i in range(1, len(values) - 1):
        pivot = 4.0 - above[i - 1]
        above[i] = 1.0 / pivot
        right[i] = (right[i] - right[i - 1]) / pivot
    for i in range(len(values) - 2, 0, -1):
        right[i] -= above[i] * right[i + 1]
    return right
