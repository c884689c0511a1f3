"""Unknowns of a triad's sliders: near 0 the way in sizes of the linkage, far out its third root, so that few steps lead far.

A way that runs off as 1 / (z - z0) is gone in steps of the unknown: 80 sizes are 10 of it, a thousand sizes 25.
"""

from typing import Any

import numpy as np

_FAR = 4
"""From here on in sizes the cube counts more than the unknown itself."""
_SCALE = 2 * _FAR / np.sqrt(3)


def slid(unknown: Any) -> Any:
    """The way in sizes for an unknown: u + u^3 / 16. Numbers of any kind, arrays, expressions."""
    return unknown + unknown**3 / _FAR**2


def unslid(way: Any) -> Any:
    """The unknown for a way, float or array: Cardano's only real root."""
    return _SCALE * np.sinh(np.arcsinh(3 * way / _SCALE) / 3)
