"""Static stability as users call it: results by name, and an error that says which input is wrong where no result is left."""

from collections import namedtuple
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

from walkgen.runtime.calls import Function
from walkgen.signature import STATUSES, Signature

NAMES = (
    *("stability_margins", "stability_margins_d_com", "feasible_region", "disturbance_margin"),
    *("tipping_time", "tipping_tilt", "tipping_speed_limit"),
)
_UNIT = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class Named:
    """A generated function with a status, whose results have the names of its outputs."""

    function: Function
    signature: Signature

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call by position or name; leading dimensions are a batch.

        Returns:
            A tuple with the outputs' names; rows of a batch that are bad input have NaN and their status.

        Raises:
            TypeError: an input without a default left out, given twice, or unknown.
            ValueError: shapes that do not fit; or bad input in every row, and which.
        """
        found = self.function(*arguments, **named)
        result = _result(self.signature.name, tuple(port.name for port in self.signature.outputs))(*found)
        status = np.asarray(result.status)
        if status.size and np.all(status == STATUSES.index("BAD_INPUT")):
            inputs = [port.name for port in self.signature.inputs if port.name != "param"]
            given = dict(zip(inputs, arguments, strict=False)) | {name: named[name] for name in inputs if name in named}
            raise ValueError(f"{self.signature.full_name}: {_mistake(given)}")
        return result

    def __repr__(self) -> str:
        return repr(self.function)


@cache
def _result(name: str, outputs: tuple[str, ...]) -> Any:
    """Its names are the manifest's; making such a type takes longer than a call."""
    return namedtuple(name, outputs)


def named(robot: str, functions: Mapping[str, Function], signatures: Mapping[str, Signature]) -> dict[str, Function]:
    """Those of a robot's functions that are of static stability."""
    full = (f"{robot}_{name}" for name in NAMES)
    return {name: Named(functions[name], signatures[name]) for name in full if name in functions}


def _mistake(given: Mapping[str, Any]) -> str:
    """What is wrong with the first input that is, as far as it shows in every row."""
    arrays = {name: np.asarray(value, float) for name, value in given.items() if value is not None}
    for name, array in arrays.items():
        if name != "mu" and not np.isfinite(array).all():
            return f"{name} has NaN or an infinite number"
        wrong, cure = _RULES.get(name, (lambda _: np.array(False), ""))
        if np.any(wrong(array)):
            return f"{name} is {np.array2string(array, threshold=12)}; {cure}"
    return "the inputs do not fit each other: direction along gravity, no gravity or mass anywhere, or a tilt that turn takes beyond pi"


def _no_normal(normals: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(normals, axis=-1)
    return np.asarray((np.abs(length - 1.0) > _UNIT) & (length > 0.0))


_RULES: Mapping[str, tuple[Callable[[np.ndarray], Any], str]] = MappingProxyType(
    {
        "mu": (lambda mu: ~(mu >= 0.0), "coefficients of friction are not negative"),
        "direction": (lambda way: ~way.any(axis=-1), "give a direction of travel that is not along gravity"),
        "normals": (_no_normal, "give unit vectors away from the ground, or zeros for up"),
        "mass": (lambda mass: mass < 0.0, "masses are not negative; 0 is the robot's own"),
        "tolerance": (lambda size: ~(size > 0.0), "give how far the polygon may be from the region, above 0 m"),
        "kappa": (lambda kappa: ~(kappa > 0.0), "tipping_acceleration gives it, above 0 1/s^2"),
        "tilt": (lambda tilt: np.abs(tilt) >= np.pi, "tilts from upright are below pi"),
        "turn": (lambda turn: turn < 0.0, "a fall turns on, by 0 and more, by more for a speed"),
        "time": (lambda time: time < 0.0, "times are not negative"),
        "length": (lambda length: length < 0.0, "lengths are not negative"),
    }
)
