"""Batches keep to their rows: nothing after the last row is read or written, at any number of rows."""

import ctypes
import mmap
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from test_csupport_trig_together import needs_avx2
from test_lanes_built import AVX2, PRECISIONS, WARNINGS, batched, bits, compiled, inputs, made, results  # noqa: F401

from walkgen.emit.c_declaration import function_name
from walkgen.emit.c_lanes import laned
from walkgen.emit.c_printer import DOUBLE

ROWS = (1, 4, 5, 15, 16, 17, 31, 32, 33, 48, 63, 64, 65, 96)
_NO_ACCESS = 0


class Fenced:
    """Arrays whose last byte is a page's last, the page after being out of bounds."""

    def __init__(self):
        self.kept = []
        self.protect = ctypes.CDLL(None).mprotect
        self.protect.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int]

    def array(self, shape, kind):
        size = int(np.prod(shape)) * np.dtype(kind).itemsize
        pages = -(-size // mmap.PAGESIZE) * mmap.PAGESIZE
        room = mmap.mmap(-1, pages + mmap.PAGESIZE)
        whole = np.frombuffer(room, np.int8)
        assert self.protect(whole.ctypes.data + pages, mmap.PAGESIZE, _NO_ACCESS) == 0
        self.kept.append(room)
        return whole[pages - size : pages].view(kind).reshape(shape)

    def copy(self, array):
        fenced = self.array(array.shape, array.dtype)
        fenced[...] = array
        return fenced


def check_fenced(path, names):
    """In a process of its own, which a step over the fence ends: the bits of a batch whose arrays lie elsewhere."""
    library = ctypes.CDLL(path)
    for name, signature, real in names:
        for rows in ROWS:
            given = inputs(signature, real, rows, rows)
            free, fence = results(signature, real, rows + 64), Fenced()
            inside = [fence.array((rows, port.size), array.dtype) for port, array in zip(signature.outputs, free, strict=True)]
            batched(library, name, signature, given, free)
            batched(library, name, signature, [fence.copy(array) for array in given], inside)
            for one, other in zip(free, inside, strict=True):
                assert bits(one[:rows]) == bits(other), (name, rows)
                assert not one[rows:].any(), (name, rows)


@needs_avx2
@pytest.mark.skipif(sys.platform != "linux", reason="pages are fenced off as Linux does it")
@PRECISIONS
def test_nothing_beyond_the_last_row_is_touched(made, precision):  # noqa: F811
    code, folder = made("mero_leg")
    real = np.float64 if precision is DOUBLE else np.float32
    source = f"{'_'.join(part for part in ('mero_leg', precision.tag) if part)}.c"
    compiled(folder, source, f"fenced_{source}.so", *AVX2, "-shared", "-fPIC", *WARNINGS)
    names = [(function_name(each.signature, precision), each.signature, real) for each in laned(code)]
    child = (
        "import pickle, sys; sys.path[:0] = pickle.load(sys.stdin.buffer); "
        "from test_batch_bounds import check_fenced; check_fenced(*pickle.load(sys.stdin.buffer))"
    )
    told = pickle.dumps([str(Path(__file__).parent), *sys.path]) + pickle.dumps((str(folder / f"fenced_{source}.so"), names))
    answer = subprocess.run([sys.executable, "-c", child], input=told, capture_output=True, check=False)
    assert answer.returncode == 0, answer.stderr.decode()[-2000:]
