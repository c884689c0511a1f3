"""Calls of many rows: their results lie in huge pages, and threads may share them, each with rows of its own: the same numbers."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from walkgen.runtime.room import LARGE, room
from walkgen.signature import Signature

_FEWEST = 1024
"""Rows that are worth a thread."""


@dataclass(frozen=True, eq=False, repr=False)
class ManyRows:
    """A compiled function that makes room for large results, and uses several threads where a call's first dimension has rows enough."""

    function: np.ufunc
    signature: Signature
    threads: int

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call; a call with keywords other than `out`, or with few rows, is left to the function."""
        if set(named) - {"out"} or len(arguments) != len(self.signature.inputs):
            return self.function(*arguments, **named)
        arrays = [np.asarray(argument) for argument in arguments]
        lead = self._lead(arrays)
        rows = int(np.prod(lead))
        count = min(self.threads, rows // _FEWEST, lead[0] if lead else 0)
        if count > 1 or (count == 1 and "out" not in named and rows * self._widest >= LARGE):
            return self._shared(arrays, lead, count, named.get("out"))
        return self.function(*arguments, **named)

    @cached_property
    def _widest(self) -> int:
        """Bytes of a row of the largest result, at most."""
        return 8 * max(port.size for port in self.signature.outputs)

    def _lead(self, arrays: Sequence[np.ndarray]) -> tuple[int, ...]:
        """The common leading shape; () where the shapes are wrong, of which the function itself complains."""
        ranks = [len(port.shape) for port in self.signature.inputs]
        shapes = [array.shape[: array.ndim - rank] for array, rank in zip(arrays, ranks, strict=True)]
        try:
            return np.broadcast_shapes(*shapes)
        except ValueError:
            return ()

    def _shared(self, arrays: Sequence[np.ndarray], lead: tuple[int, ...], count: int, out: Any) -> Any:
        bounds = [lead[0] * part // count for part in range(count + 1)]
        parts = [slice(start, end) for start, end in pairwise(bounds)]
        single = len(self.signature.outputs) == 1
        given = out if isinstance(out, tuple) else (out,) * len(self.signature.outputs)
        first = self.function(*self._rows(arrays, lead, slice(0, 1)))
        kinds = (first,) if single else first
        places = [
            room((*lead, *port.sizes), kind.dtype) if place is None else place
            for port, kind, place in zip(self.signature.outputs, kinds, given, strict=True)
        ]

        def compute(part: slice) -> None:
            self.function(*self._rows(arrays, lead, part), out=tuple(place[part] for place in places))

        tuple(_pool(self.threads).map(compute, parts) if count > 1 else map(compute, parts))
        return places[0] if single else tuple(places)

    def _rows(self, arrays: Sequence[np.ndarray], lead: tuple[int, ...], part: slice) -> list[np.ndarray]:
        """Those rows of the arrays that have the first dimension; the others serve all."""
        ranks = [len(lead) + len(port.shape) for port in self.signature.inputs]
        return [
            array[part] if array.ndim == rank and array.shape[0] == lead[0] else array for array, rank in zip(arrays, ranks, strict=True)
        ]

    def __repr__(self) -> str:
        return f"<{self.function!r} with {self.threads} threads>" if self.threads > 1 else repr(self.function)


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="walkgen")
