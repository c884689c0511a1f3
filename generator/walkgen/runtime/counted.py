"""Calls functions some of whose sizes each call chooses, such as the number of feet in contact: one number serves all of them."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkgen.signature import COUNTS, Port, Signature


@dataclass(frozen=True, eq=False, repr=False)
class Counted:
    """A function with counts: inputs may be left out where they have defaults, and lack the counts' dimensions where one value serves all.

    `function` takes every input by position, dense in its counts; `parameters` are the runtime parameters' defaults. Counts that only
    outputs have are given by name: room for so many is made.
    """

    function: Callable[..., Any]
    signature: Signature
    parameters: tuple[float, ...]

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call with every input by position or name.

        Raises:
            TypeError: an input without a default left out, given twice, or unknown.
            ValueError: a count that is 0 or more than C has room for, or an array that does not have it.
        """
        ports = self.signature.inputs
        rooms = {count: _checked(self.signature, count, named.pop(count)) for count in self.signature.capacities}
        given = self._given(ports, arguments, named)
        counts = {count: self._count(count, given) for count in self.signature.counts if count not in rooms}
        inputs = [_widened(port, given[port.name], counts) for port in ports]
        if rooms:
            named["out"] = tuple(self._room(port, inputs, rooms) for port in self.signature.outputs)
        return self.function(*inputs, **named)

    def _given(self, ports: tuple[Port, ...], arguments: tuple[Any, ...], named: dict[str, Any]) -> dict[str, Any]:
        positional = [port.name for port in ports if port.name != "param"]
        if len(arguments) > len(positional):
            raise TypeError(f"{self.signature.full_name} takes at most {len(positional)} inputs by position")
        given = dict(zip(positional, arguments, strict=False))
        twice = sorted(set(given) & set(named))
        if twice:
            raise TypeError(f"{self.signature.full_name} got {', '.join(twice)} twice")
        given |= {port.name: named.pop(port.name) for port in ports if port.name in named}
        own = {name: value for name, value in given.items() if value is not None}
        complete = self._defaults(ports, _precision(own.values())) | own
        missing = [port.name for port in ports if port.name not in complete]
        if missing:
            raise TypeError(f"{self.signature.full_name} misses {', '.join(missing)}")
        return complete

    def _defaults(self, ports: tuple[Port, ...], real: type[np.floating[Any]]) -> dict[str, Any]:
        found = {port.name: _default(port, real) for port in ports if port.default}
        return found | ({"param": np.array(self.parameters, real)} if self.parameters else {})

    def _count(self, count: str, given: Mapping[str, Any]) -> int:
        """The first input that has the count tells it."""
        port = next(port for port in self.signature.inputs if count in port.shape)
        shape = np.shape(given[port.name])
        if len(shape) < len(port.shape):
            wanted = f"[{', '.join(map(str, port.shape))}]"
            raise ValueError(f"{self.signature.full_name}: {port.name} has shape {list(shape)}; it tells {count} by its own, {wanted}")
        return _checked(self.signature, count, int(shape[len(shape) - len(port.shape) + port.shape.index(count)]))

    def _room(self, port: Port, inputs: list[Any], rooms: Mapping[str, int]) -> Any:
        """An array for an output with such a count; none for others, whose size is known."""
        if not any(size in rooms for size in port.shape):
            return None
        lead = np.broadcast_shapes(*(_lead(given, value) for given, value in zip(self.signature.inputs, inputs, strict=True)))
        return np.empty((*lead, *port.sized(rooms).sizes))

    def __repr__(self) -> str:
        return f"<function {self.signature.full_name!r} of any {' and '.join(self.signature.counts)}>"


def _checked(signature: Signature, count: str, size: int) -> int:
    if not 1 <= size <= COUNTS[count]:
        raise ValueError(f"{signature.full_name}: {count} is {size}; 1 to {COUNTS[count]} are possible")
    return size


def _lead(port: Port, value: Any) -> tuple[int, ...]:
    array = np.asarray(value)
    return array.shape[: max(array.ndim - len(port.shape), 0)]


def _default(port: Port, real: type[np.floating[Any]]) -> Any:
    """One value for all where a count is among the sizes, else the whole array."""
    values = np.array(port.default, real if port.kind == "real" else np.int64)
    return values[0] if any(isinstance(size, str) for size in port.shape) else values.reshape(port.sizes)


def _precision(values: Iterable[Any]) -> type[np.floating[Any]]:
    """Single where all reals are: defaults then keep it."""
    kinds = [np.asarray(value).dtype for value in values]
    return np.float32 if kinds and all(kind == np.float32 or kind.kind in "iub" for kind in kinds) else np.float64


def _widened(port: Port, value: Any, counts: Mapping[str, int]) -> Any:
    """The value with the port's own dimensions at its end; those that are counts are filled up from one value."""
    if not any(isinstance(size, str) for size in port.shape):
        return value
    core, array = port.sized(counts).sizes, np.asarray(value)
    lead = array.shape[: max(array.ndim - len(core), 0)]
    try:
        return np.broadcast_to(array, (*lead, *core))
    except ValueError:
        raise ValueError(
            f"{port.name} has shape {list(array.shape)}; its last dimensions must be {list(core)}, or one value for all"
        ) from None
