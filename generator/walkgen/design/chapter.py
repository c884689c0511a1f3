"""One link on a hip and springs from it to the frame, as the chapter has them: reduced unknowns, and the exact answer without free length.

The link's angle to the frame is phi, counter-clockwise from X. A spring reaches from a point of the frame to a point of the link, at
distances rH and rF from the hip; delta is the angle from the link's point, at phi = 0, to the frame's.
"""

from dataclasses import dataclass
from math import atan2, hypot, sqrt

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]


@dataclass(frozen=True)
class Spring:
    """Pulls with constant + stiffness length (N, N/m, m); `constant` is initial tension less stiffness times free length."""

    lever: float
    anchor: float
    angle: float
    stiffness: float
    constant: float

    def length(self, phi: Reals) -> Reals:
        """Of the spring (m)."""
        return np.sqrt(self.lever**2 + self.anchor**2 - 2 * self.lever * self.anchor * np.cos(self.angle - phi))

    def moment(self, phi: Reals) -> Reals:
        """On the link, counter-clockwise (N m): eq. (21) as corrected."""
        return self.lever * self.anchor * np.sin(self.angle - phi) * (self.stiffness + self.constant / self.length(phi))

    @property
    def reduced(self) -> "Reduced":
        """What its moment depends on."""
        product = self.lever * self.anchor
        return Reduced(self.stiffness * product, self.constant * sqrt(product), (self.lever**2 + self.anchor**2) / product, self.angle)


@dataclass(frozen=True)
class Reduced:
    """The four numbers that a spring's moment depends on: sin(delta - phi) (K + G / sqrt(s - 2 cos(delta - phi))).

    Attributes:
        K: stiffness times lever times anchor (N m).
        G: constant times the root of lever times anchor (N m^1/2).
        s: of lever and anchor, sum of squares by product: 2 or more.
        delta: the angle (rad).
    """

    K: float
    G: float
    s: float
    delta: float

    def moment(self, phi: Reals) -> Reals:
        """On the link (N m)."""
        turn = self.delta - phi
        return np.sin(turn) * (self.K + self.G / np.sqrt(self.s - 2 * np.cos(turn)))

    def realised(self, stiffness: float) -> Spring:
        """By a spring that can be bought, the shorter arm on the link.

        Args:
            stiffness: N/m, more than 0, as K is.
        """
        root = sqrt(self.K / stiffness)
        far, near = (root * (sqrt(self.s + 2) + sign * sqrt(self.s - 2)) / 2 for sign in (1, -1))
        return Spring(near, far, self.delta, stiffness, self.G / root)


@dataclass(frozen=True)
class ZeroFree:
    """A spring that begins to pull at no length holds a moment a cos(phi) + b sin(phi) everywhere.

    Attributes:
        product: its stiffness times lever times anchor (N m).
        angle: its delta (rad).
        left: the largest of what the moment has besides, which it cannot hold (N m).
    """

    product: float
    angle: float
    left: float


def zero_free_length(phi: Reals, moments: Reals) -> ZeroFree:
    """The spring that balances moments on a link at some of its angles, by least squares.

    Args:
        phi: angles [n] (rad), of at least two directions.
        moments: of all else that acts, counter-clockwise [n] (N m).
    """
    waves = np.stack([np.cos(phi), np.sin(phi)], -1)
    (a, b), *_ = np.linalg.lstsq(waves, moments, rcond=None)
    left = float(np.abs(moments - waves @ [a, b]).max())
    return ZeroFree(hypot(a, b), atan2(-a, b), left)
