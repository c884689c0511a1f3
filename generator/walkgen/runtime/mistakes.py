"""What is wrong where a solve has no answer to give: which input, of which foot, and how to mend it."""

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from walkgen.signature import STATUSES

_UNIT = 1e-9
_SHORT = 1e-9
_TOO_ROUGH = 1e9
_RANKS = MappingProxyType({"points": 1, "normals": 1, "mu": 0, "weight": 0, "n_max": 0, "misfit": 1, "compliance": 2})
"""How many dimensions an input has for each foot; the others have no feet."""
_CURES = MappingProxyType(
    {
        "normals": "give a unit vector, away from the ground",
        "mu": "coefficients of friction are 0 or more, below 1e9",
        "weight": "weights are above 0",
        "n_max": "the largest normal force is 0 N or more, infinite for none",
        "compliance": "a compliance (m/N) is symmetric and positive definite: add the ground's, terrain.compliance(points)",
    }
)
_ENDLESS = frozenset({"mu", "n_max"})
"""What may be infinite, to some methods."""


def everywhere(name: str, status: Any) -> bool:
    """Whether every row, of one row or more, has the status of this name."""
    found = np.asarray(status)
    return bool(found.size and np.all(found == STATUSES.index(name)))


def bad_stance(given: Mapping[str, Any]) -> str:
    """The first thing that is wrong with the first row of a batch whose rows are all bad input.

    Args:
        given: inputs of `contact_forces` by name; leading dimensions are a batch.
    """
    feet = np.shape(given["points"])[-2]
    return next(_mistakes(given, feet), "the inputs do not fit each other: vertical takes three feet whose normals are along one line")


def _mistakes(given: Mapping[str, Any], feet: int) -> Iterator[str]:
    for name, value in given.items():
        if value is None:
            continue
        array = np.asarray(value, float)
        per_foot = name in _RANKS and array.ndim > _RANKS[name] and array.shape[array.ndim - _RANKS[name] - 1] == feet
        for foot, part in enumerate(_parts(array, name, feet)) if per_foot else [(None, _row(array, name))]:
            place = name if foot is None else f"{name} of foot {foot}"
            if np.isnan(part).any() or (name not in _ENDLESS and not np.isfinite(part).all()):
                yield f"{place} is {_shown(part)}; give finite numbers"
            elif name in _CURES and _is_wrong(name, part):
                yield f"{place} is {_shown(part)}; {_CURES[name]}"


def _row(array: np.ndarray, name: str) -> np.ndarray:
    """Of the first row: without the batch's dimensions."""
    rank = {"points": 2, "wrench": 1, "torque_rows": 3, "torque_limits": 1}.get(name, _RANKS.get(name, 1))
    while array.ndim > rank:
        array = array[0]
    return array


def _parts(array: np.ndarray, name: str, feet: int) -> np.ndarray:
    """Each foot's, of the first row."""
    parts: np.ndarray = array.reshape(-1, feet, *array.shape[array.ndim - _RANKS[name] :])[0]
    return parts


def _is_wrong(name: str, part: np.ndarray) -> bool:
    if name == "normals":
        return bool(abs(np.linalg.norm(part) - 1.0) > _UNIT)
    if name == "compliance":
        size = np.max(np.abs(part))
        return bool(np.max(np.abs(part - part.T)) > _UNIT * size or np.linalg.eigvalsh(part)[0] <= _SHORT * size)
    return bool(np.any(part < 0.0) or (name == "weight" and np.any(part == 0.0)) or (name == "mu" and np.any(part >= _TOO_ROUGH)))


def _shown(part: np.ndarray) -> str:
    return np.array2string(part, precision=6, threshold=9).replace("\n", "") if part.ndim else f"{part:g}"


def lost_loads(points: Any) -> str:
    """Which loads the feet of the first row cannot carry: they are fewer than three, or stand on a line or at one place.

    Args:
        points: where the feet stand [k,3] (m); leading dimensions are a batch.
    """
    stance = np.asarray(points, float).reshape(-1, *np.shape(points)[-2:])[0]
    middle = stance.mean(axis=0)
    _, sizes, axes = np.linalg.svd(stance - middle)
    where = f"through {_shown(middle)}"
    if sizes.size == 0 or sizes[0] <= _SHORT:
        return f"{len(stance)} feet at one place {_shown(middle)} carry no moment about any axis {where}; set feet apart, three or more"
    if sizes.size > 1 and sizes[1] > _SHORT * sizes[0]:
        return "normals leave the feet no hold against some load; grasp_map tells which"
    line = axes[0] if axes[0][np.argmax(np.abs(axes[0]))] > 0.0 else -axes[0]
    return f"{len(stance)} feet on a line carry no moment about it, along {_shown(line)} {where}; set down a foot beside it"


def bad_balance(given: Mapping[str, Any]) -> str:
    """The first thing that is wrong with an input of a function of static stability, as far as it shows in every row.

    Args:
        given: its inputs by name.
    """
    arrays = {name: np.asarray(value, float) for name, value in given.items() if value is not None}
    for name, array in arrays.items():
        if name != "mu" and not np.isfinite(array).all():
            return f"{name} has NaN or an infinite number"
        wrong, cure = _BALANCE.get(name, (lambda _: np.array(False), ""))
        if np.any(wrong(array)):
            return f"{name} is {np.array2string(array, threshold=12)}; {cure}"
    return "the inputs do not fit each other: direction along gravity, no gravity or mass anywhere, or a tilt that turn takes beyond pi"


def _is_no_direction(normals: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(normals, axis=-1)
    return np.asarray((np.abs(length - 1.0) > _UNIT) & (length > 0.0))


_BALANCE: Mapping[str, tuple[Callable[[np.ndarray], Any], str]] = MappingProxyType(
    {
        "mu": (lambda mu: ~(mu >= 0.0), "coefficients of friction are not negative"),
        "direction": (lambda way: ~way.any(axis=-1), "give a direction of travel that is not along gravity"),
        "normals": (_is_no_direction, "give unit vectors away from the ground, or zeros for up"),
        "mass": (lambda mass: mass < 0.0, "masses are not negative; 0 is the robot's own"),
        "tolerance": (lambda size: ~(size > 0.0), "give how far the polygon may be from the region, above 0 m"),
        "kappa": (lambda kappa: ~(kappa > 0.0), "tipping_acceleration gives it, above 0 1/s^2"),
        "tilt": (lambda tilt: np.abs(tilt) >= np.pi, "tilts from upright are below pi"),
        "turn": (lambda turn: turn < 0.0, "a fall turns on, by 0 and more, by more for a speed"),
        "time": (lambda time: time < 0.0, "times are not negative"),
        "length": (lambda length: length < 0.0, "lengths are not negative"),
    }
)
