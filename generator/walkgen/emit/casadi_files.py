"""Writes the `.casadi` files: each function serialised, to be loaded by CasADi's C++, Python and MATLAB without walkgen."""

from collections.abc import Sequence
from pathlib import Path
from runpy import run_path
from typing import Any


def built_functions(folder: Path) -> tuple[Any, ...]:
    """Every function of the generated `<robot>_casadi.py`, in its order.

    Args:
        folder: where the robot's files lie; holds exactly one `*_casadi.py`.
    """
    module = run_path(str(_only(folder)))
    return tuple(module["function"](name) for name in module["FUNCTIONS"])


def serialise(functions: Sequence[Any], out: Path) -> tuple[Path, ...]:
    """Write `<full_name>.casadi` for every function.

    Args:
        functions: of CasADi, as `built_functions` gives them.
        out: where the `.casadi` files go; made if it is not there.

    Returns:
        The files written, in the order of the functions.
    """
    out.mkdir(parents=True, exist_ok=True)
    return tuple(_save(function, out) for function in functions)


def _only(folder: Path) -> Path:
    found = sorted(folder.glob("*_casadi.py"))
    if len(found) != 1:
        raise FileNotFoundError(f"{folder} holds {len(found)} files *_casadi.py, not one")
    return found[0]


def _save(function: Any, out: Path) -> Path:
    path = out / f"{function.name()}.casadi"
    function.save(str(path))
    return path
