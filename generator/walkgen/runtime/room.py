"""Memory for large results in huge pages: an allocator's has small ones at both ends, for each of which the kernel is asked."""

import math
import mmap
from typing import Any

import numpy as np

_HUGE = 2**21
"""Bytes of a huge page."""
LARGE = 4 * _HUGE
"""Bytes of an array from which on pages of it are worth asking for."""


def room(shape: tuple[int, ...], dtype: np.dtype[Any]) -> np.ndarray:
    """An array to write to, as `np.empty` gives it: where Linux has huge pages, a large one lies in nothing else."""
    size = math.prod(shape) * dtype.itemsize
    if size < LARGE or not hasattr(mmap, "MADV_HUGEPAGE"):
        return np.empty(shape, dtype)
    memory = mmap.mmap(-1, -(-size // _HUGE) * _HUGE, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    memory.madvise(mmap.MADV_HUGEPAGE)
    return np.frombuffer(memory, dtype, math.prod(shape)).reshape(shape)
