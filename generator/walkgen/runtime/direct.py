"""Calls of one row past NumPy's ufunc machinery: compiles direct.c where Python's headers are, and wraps functions in it."""

import importlib.util
import os
import sys
import sysconfig
from functools import cache
from importlib.machinery import ExtensionFileLoader
from pathlib import Path
from typing import Any

import numpy as np

from walkgen.errors import Problem, ToolchainError
from walkgen.runtime.calls import Function, Truths, WithDefaults
from walkgen.runtime.ufuncs import Loops
from walkgen.signature import Port, Signature
from walkgen.toolchain import build_module, user_cache

_SOURCE = Path(__file__).with_name("direct.c")
_MODULE = "walkgen_direct"
_MOST_PORTS, _HIGHEST_RANK = 32, 6
"""What direct.c has room for."""


def direct(function: Function, signature: Signature, loops: Loops, large: Function) -> Function:
    """The function with a way of its own for calls of one row; itself where there is none, as without Python's headers.

    Args:
        function: as users call it; every other call is left to it.
        signature: its ports.
        loops: addresses of its compiled loop in double and in float.
        large: the same for calls of many rows.
    """
    layer = _layer()
    if isinstance(layer, str) or not _fits(signature):
        return function
    names = [port.name for port in signature.inputs]
    bare = function.function if isinstance(function, WithDefaults) else function
    if signature.outputs[0].kind == "truth" and not isinstance(bare, Truths):
        return function
    given = (function.defaults, function.single) if isinstance(function, WithDefaults) else ({}, {})
    defaults = tuple(tuple(values.get(name) for name in names) for values in given)
    required = next((place for place in range(len(names), 0, -1) if defaults[0][place - 1] is None), 0)
    inputs, outputs = (tuple(map(_described, ports)) for ports in (signature.inputs, signature.outputs))
    made: Function = layer(function, large, inputs, outputs, loops, defaults, required, len(names) - ("param" in names))
    return made


def _described(port: Port) -> tuple[str | int, ...]:
    return (port.kind, *port.sizes)


def _fits(signature: Signature) -> bool:
    ports = (*signature.inputs, *signature.outputs)
    shapes = [port.shape for port in ports]
    return not signature.counts and len(ports) <= _MOST_PORTS and max(map(len, shapes)) <= _HIGHEST_RANK


def insist() -> None:
    """Make sure that there are direct calls.

    Raises:
        ToolchainError: WG413 why there are none.
    """
    layer = _layer()
    if isinstance(layer, str):
        raise ToolchainError(Problem("WG413", f"no direct calls: {layer}", "WALKGEN_BACKEND=ufunc, or unset it: NumPy's ufuncs serve"))


@cache
def _layer() -> Any:
    """The extension's type, or why there is none: found in the user's cache or compiled into it."""
    tag = f"{sysconfig.get_config_var('SOABI')}-numpy-{np.__version__}"
    headers = (Path(sysconfig.get_path("include")), Path(np.get_include()))
    missing = [path for path in (headers[0] / "Python.h", headers[1] / "numpy" / "arrayobject.h") if not path.exists()]
    if missing or sys.platform == "win32":
        return f"{missing[0]} is missing" if missing else "not on Windows"
    try:
        path = build_module(_SOURCE, _MODULE, tag, headers, user_cache("direct-calls"))
        return _loaded(path)
    except ToolchainError as error:
        return error.problems[0].message.splitlines()[0]
    except (OSError, ImportError) as error:
        return f"{type(error).__name__}: {error}"


def _loaded(path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(_MODULE, path, loader=ExtensionFileLoader(_MODULE, os.fspath(path)))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Direct
