"""Gives a function the calling conventions users see where a bare ufunc cannot: runtime parameters by name, and NumPy's fall-back."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkgen.runtime.counted import Counted
from walkgen.signature import Port, Signature

Function = Callable[..., Any]


@dataclass(frozen=True, eq=False, repr=False)
class WithDefaults:
    """A function some of whose last inputs may be left out, or given by name; the runtime parameters [np] only as `param=`.

    `defaults` has a value for every input that may be left out; `single` the same in float32 where the robot has a float library.
    """

    function: Function
    signature: Signature
    defaults: Mapping[str, np.ndarray]
    single: Mapping[str, np.ndarray]

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call with every input broadcast like any other; float32 inputs keep their precision by default.

        Raises:
            TypeError: too many inputs, one that has no default left out, or one given twice.
        """
        names = [port.name for port in self.signature.inputs]
        positional = names[:-1] if names[-1] == "param" else names
        if len(arguments) > len(positional):
            raise TypeError(
                f"{self.signature.full_name} takes at most {len(positional)} inputs{' and the keyword param' * ('param' in names)}"
            )
        given = dict(zip(positional, arguments, strict=False))
        twice = sorted(set(given) & set(named))
        if twice:
            raise TypeError(f"{self.signature.full_name} got {', '.join(twice)} twice")
        given |= {name: named.pop(name) for name in names if name in named}
        return self.function(*self._complete(names, given), **named)

    def _complete(self, names: list[str], given: dict[str, Any]) -> list[Any]:
        present = {name: value for name, value in given.items() if value is not None or name not in self.defaults}
        missing = [name for name in names if name not in present and name not in self.defaults]
        if missing:
            raise TypeError(f"{self.signature.full_name} misses {', '.join(missing)}")
        narrow = bool(self.single and present) and all(_is_single(value) for value in present.values())
        return [present[name] if name in present else (self.single if narrow else self.defaults)[name] for name in names]

    def __repr__(self) -> str:
        choices = ", ".join(f"{name}={list(value.shape)}" for name, value in self.defaults.items())
        return f"<function {self.signature.full_name!r} with {choices}>"


@dataclass(frozen=True, eq=False, repr=False)
class Truths:
    """A function whose only output is a truth: compiled code gives 0 or 1, users get a bool."""

    function: Function
    signature: Signature

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call, and compare with 0."""
        return self.function(*arguments, **named) != 0

    def __repr__(self) -> str:
        return f"<function {self.signature.full_name!r}: bool>"


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
        results = self.function(*narrow, *arguments[len(self.signature.inputs) :], *self._rooms(out))
        if out is None:
            return results
        single = len(self.signature.outputs) == 1
        places = out if isinstance(out, tuple) else (out,)
        filled = tuple(_filled(place, result) for place, result in zip(places, (results,) if single else results, strict=True))
        return filled[0] if single else filled

    def _rooms(self, out: Any) -> list[int]:
        """Counts that only outputs have, read off `out` as ufuncs do."""
        places = dict(zip(self.signature.outputs, out if isinstance(out, tuple) else (out,), strict=False))
        found = []
        for count in self.signature.capacities:
            port = next(port for port in places if count in port.shape)
            found.append(np.shape(places[port])[port.shape.index(count) - len(port.shape)])
        return found

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


def as_called(function: Function, signature: Signature, parameters: tuple[float, ...], float32: bool) -> Function:
    """The function as users call it: with defaults for the inputs that have them, with a bool for a truth, with counts; else unchanged.

    Args:
        function: the bare one, which takes every input by position.
        signature: its ports.
        parameters: the spec's values of the runtime parameters.
        float32: whether the robot has a float library.
    """
    if signature.counts:
        return Counted(function, signature, parameters)
    inputs = {port.name: parameters if port.name == "param" else port.default for port in signature.inputs}
    shapes = {port.name: port.sizes for port in signature.inputs}
    defaults = {name: np.array(value).reshape(shapes[name]) for name, value in inputs.items() if value}
    single = {name: value.astype(np.float32) for name, value in defaults.items()} if float32 else {}
    for value in (*defaults.values(), *single.values()):
        value.setflags(write=False)
    bare = Truths(function, signature) if signature.outputs[0].kind == "truth" else function
    return WithDefaults(bare, signature, defaults, single) if defaults else bare
