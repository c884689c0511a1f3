"""The one measure of difference that the kinematic tests use."""

from typing import Any

import numpy as np


def difference(value: Any, reference: Any) -> float:
    """Greatest |value - reference| / max(1, |reference|); shapes must agree, NaN is infinitely far."""
    value, reference = np.asarray(value, dtype=float), np.asarray(reference, dtype=float)
    assert value.shape == reference.shape, f"shape {value.shape}, not {reference.shape}"
    found = np.max(np.abs(value - reference) / np.maximum(1.0, np.abs(reference)), initial=0.0)
    return float("inf") if np.isnan(found) else float(found)
