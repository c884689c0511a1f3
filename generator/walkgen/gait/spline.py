"""Cubic splines through evenly spaced points: smooth paths of platforms and connecting chains, straight where the points are."""

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Spline:
    """Continuous up to the second derivative; that is 0 at both ends (natural), or the first is (flat).

    Attributes:
        start: where the first point is.
        spacing: from point to point.
        values: the points [m, n], two at least.
        flat: whether it is level at both ends.
    """

    start: float
    spacing: float
    values: np.ndarray
    flat: bool = False
    bends: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "bends", _bends(self.values, self.spacing, flat=self.flat))

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


def _bends(values: np.ndarray, spacing: float, *, flat: bool) -> np.ndarray:
    """Second derivatives at the points: the tridiagonal system of the spline, eliminated in one pass."""
    scaled = 6.0 * np.diff(values, axis=0) / spacing**2
    right = (
        np.concatenate([scaled[:1], np.diff(scaled, axis=0), -scaled[-1:]]) if flat else np.pad(np.diff(scaled, axis=0), ((1, 1), (0, 0)))
    )
    size, ends = len(values), 1.0 if flat else 0.0
    above = np.zeros(size)
    for i in range(size):
        inner = 0 < i < size - 1
        below = 1.0 if inner else ends * (i > 0)
        pivot = (4.0 if inner else 2.0) - below * above[i - 1]
        above[i] = (1.0 if inner else ends * (i == 0)) / pivot
        right[i] = (right[i] - below * right[i - 1]) / pivot
    for i in range(size - 2, -1, -1):
        right[i] -= above[i] * right[i + 1]
    return right
