"""Makes real NumPy generalised ufuncs of compiled loops through NumPy's C interface, without any Python or NumPy header."""

import ctypes
from functools import cache
from typing import Any

import numpy as np
from numpy import ufunc

from walkgen.errors import Problem, ToolchainError
from walkgen.signature import Port, Signature

_MAKE = 31
"""Index of PyUFunc_FromFuncAndDataAndSignature in NumPy's table, part of its stable binary interface; entry 0 is the ufunc type."""
_NO_IDENTITY = -1
_REAL: dict[str, np.dtype[Any]] = {"": np.dtype(np.float64), "_f32": np.dtype(np.float32)}


Loops = tuple[int, int]
"""Addresses of a function's loops in double and in float; 0 where there is none."""


def find_loops(signature: Signature, library: ctypes.CDLL, float32: bool) -> Loops | None:
    """The library's loops of this function; None where it lacks one."""
    suffixes = ("", "_f32") if float32 else ("",)
    found = [_address(library, _loop_name(signature, suffix)) for suffix in suffixes]
    return None if 0 in found else (found[0], found[1] if float32 else 0)


def make_ufunc(signature: Signature, library: ctypes.CDLL, addresses: Loops) -> ufunc:
    """A generalised ufunc over these loops of the function.

    Single precision comes first, so that float32 input takes it; everything else is cast to double.

    Raises:
        ToolchainError: WG408 when NumPy's C interface is not the one expected.
    """
    suffixes = ("_f32", "") if addresses[1] else ("",)
    loops = [address for address in reversed(addresses) if address]
    ports = signature.inputs + signature.outputs
    codes = bytes(_code(port, index >= len(signature.inputs), suffix) for suffix in suffixes for index, port in enumerate(ports))
    functions = (ctypes.c_void_p * len(loops))(*loops)
    data = (ctypes.c_void_p * len(loops))()
    types = ctypes.create_string_buffer(codes, len(codes))
    name, doc, core = (text.encode() for text in (signature.full_name, _document(signature), core_signature(signature)))
    made: ufunc = _maker()(
        functions, data, types, len(loops), len(signature.inputs), len(signature.outputs), _NO_IDENTITY, name, doc, 0, core
    )
    _keep_for_ever((library, functions, data, types, name, doc, core))
    return made


def core_signature(signature: Signature) -> str:
    """NumPy's signature of the function with frozen dimensions, such as `(3),()->(3,3),()`."""
    inputs, outputs = (",".join(_core(port) for port in ports) for ports in (signature.inputs, signature.outputs))
    return f"{inputs}->{outputs}"


def _core(port: Port) -> str:
    return f"({','.join(map(str, port.shape))})"


def _loop_name(signature: Signature, suffix: str) -> str:
    return f"{signature.robot}{suffix}{signature.full_name.removeprefix(signature.robot)}_loop"


def _address(library: ctypes.CDLL, name: str) -> int:
    try:
        return ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0
    except AttributeError:
        return 0


def _code(port: Port, output: bool, suffix: str) -> int:
    """NumPy's type number of an argument of the loop; integers come in as int64, so that any NumPy integer is taken."""
    integer: np.dtype[Any] = np.dtype(np.int32 if output else np.int64)
    return (_REAL[suffix] if port.kind == "real" else integer).num


def _document(signature: Signature) -> str:
    inputs, outputs = (", ".join(map(_described, ports)) for ports in (signature.inputs, signature.outputs))
    parts = (signature.doc, f"{inputs} -> {outputs}", signature.source)
    return "\n\n".join(part for part in parts if part)


def _described(port: Port) -> str:
    shape = f" [{','.join(map(str, port.shape))}]" if port.shape else ""
    return f"{port.name}{shape}{'' if port.unit == '1' else f' {port.unit}'}"


@cache
def _maker() -> Any:
    table = _table()
    if table[0] != id(ufunc):
        raise ToolchainError(Problem("WG408", f"NumPy {np.__version__} keeps its ufunc interface elsewhere", "WALKGEN_BACKEND=numpy works"))
    integers = (ctypes.c_int,) * 4
    pointer, text = ctypes.c_void_p, ctypes.c_char_p
    return ctypes.PYFUNCTYPE(ctypes.py_object, pointer, pointer, pointer, *integers, text, text, ctypes.c_int, text)(table[_MAKE])


def _table() -> Any:
    """NumPy's table of ufunc entry points, out of the capsule it keeps for extension modules."""
    try:
        core = np._core if hasattr(np, "_core") else np.core
        capsule = core._multiarray_umath._UFUNC_API
        name = ctypes.PYFUNCTYPE(ctypes.c_char_p, ctypes.py_object)(("PyCapsule_GetName", ctypes.pythonapi))(capsule)
        get = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(("PyCapsule_GetPointer", ctypes.pythonapi))
        return ctypes.cast(get(capsule, name), ctypes.POINTER(ctypes.c_void_p))
    except AttributeError as error:
        problem = Problem("WG408", f"this Python or NumPy {np.__version__} has no ufunc interface: {error}", "WALKGEN_BACKEND=numpy works")
        raise ToolchainError(problem) from error


def _keep_for_ever(kept: tuple[object, ...]) -> None:
    """NumPy borrows these as long as the ufunc lives, and a ufunc may live as long as the process: one reference is never given back."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(kept))
