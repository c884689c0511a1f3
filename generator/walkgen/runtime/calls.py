"""Gives a function the calling conventions users see where a bare ufunc cannot: runtime parameters by name, and NumPy's fall-back."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkgen.signature import Port, Signature

Function = Callable[..., Any]


@dataclass(frozen=True, eq=False, repr=False)
class WithParameters:
    """A function whose last input, the runtime parameters [np], is the keyword `param`, the spec's values by default."""

    function: Function
    signature: Signature
    default: np.ndarray
    single: np.ndarray | None

    def __call__(self, *arguments: Any, param: Any = None, **named: Any) -> Any:
        """Call with `param` [..., np] broadcast like any other input; float32 inputs keep their precision by default."""
        if len(arguments) >= len(self.signature.inputs):
            raise TypeError(f"{self.signature.full_name} takes {len(self.signature.inputs) - 1} inputs and the keyword param")
        values = (self._default(arguments) if param is None else param,)
        return self.function(*arguments, *values, **named)

    def _default(self, arguments: tuple[Any, ...]) -> np.ndarray:
        if self.single is not None and arguments and all(_is_single(argument) for argument in arguments):
            return self.single
        return self.default

    def __repr__(self) -> str:
        return f"<function {self.signature.full_name!r} with param= [{len(self.default)}]>"


def _is_single(argument: Any) -> bool:
    kind = getattr(argument, "dtype", None)
    return kind is not None and (kind == np.float32 or kind.kind in "iub")


@dataclass(frozen=True, eq=False, repr=False)
class Vectorised:
    """A function of `<robot>_numpy.py`, which broadcasts by itself, with the ufuncs' `out=`; float64 and int32 come out."""

    function: Function
    signature: Signature

    def __call__(self, *arguments: Any, out: Any = None) -> Any:
        """Call; every output is an array of the common leading dimensions and its own shape, copied into `out` where given.

        Raises:
            TypeError: a wrong number of inputs.
            ValueError: an input whose last dimensions are not its port's.
        """
        narrow = (_narrowed(value, port) for value, port in zip(arguments, self.signature.inputs, strict=False))
        results = self.function(*narrow, *arguments[len(self.signature.inputs) :])
        if out is None:
            return results
        single = len(self.signature.outputs) == 1
        places = out if isinstance(out, tuple) else (out,)
        filled = tuple(_filled(place, result) for place, result in zip(places, (results,) if single else results, strict=True))
        return filled[0] if single else filled

    def __repr__(self) -> str:
        return f"<function {self.signature.full_name!r} in NumPy>"


def _narrowed(value: Any, port: Port) -> Any:
    """An integer that int32 cannot hold becomes -1, which is never valid, as in the compiled loops; all else is left to the function."""
    if port.kind != "integer":
        return value
    array = np.asarray(value)
    return np.where((array < 0) | (array > np.iinfo(np.int32).max), -1, array) if array.dtype.kind in "iu" else array


def _filled(place: Any, result: Any) -> Any:
    if place is None:
        return result
    np.copyto(place, result, casting="same_kind")
    return place


def with_parameters(function: Function, signature: Signature, defaults: tuple[float, ...], float32: bool) -> Function:
    """The function as users call it: unchanged where it takes no runtime parameters."""
    if not defaults or not signature.inputs or signature.inputs[-1].name != "param":
        return function
    values = np.array(defaults)
    values.setflags(write=False)
    single = values.astype(np.float32) if float32 else None
    return WithParameters(function, signature, values, single)
