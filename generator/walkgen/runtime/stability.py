"""Static stability as users call it: results by name, and an error that says which input is wrong where no result is left."""

from collections import namedtuple
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from walkgen.runtime.calls import Function
from walkgen.runtime.mistakes import bad_balance, everywhere
from walkgen.signature import Signature

NAMES = (
    *("stability_margins", "stability_margins_d_com", "feasible_region", "disturbance_margin"),
    *("tipping_time", "tipping_tilt", "tipping_speed_limit"),
)


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
        if everywhere("BAD_INPUT", result.status):
            inputs = [port.name for port in self.signature.inputs if port.name != "param"]
            given = dict(zip(inputs, arguments, strict=False)) | {name: named[name] for name in inputs if name in named}
            raise ValueError(f"{self.signature.full_name}: {bad_balance(given)}")
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
