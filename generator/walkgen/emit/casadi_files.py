"""Writes the `.casadi` files: each function serialised, to be loaded by CasADi's C++, Python and MATLAB without walkgen."""

from pathlib import Path
from runpy import run_path
from typing import Any


def serialise(folder: Path, out: Path) -> tuple[Path, ...]:
    """Write `<full_name>.casadi` for every function of the generated `<robot>_casadi.py`.

    Args:
        folder: where the robot's files lie; holds exactly one `*_casadi.py`.
        out: where the `.casadi` files go; made if it is not there.

    Returns:
        The files written, in the order of the functions.
    """
    module = run_path(str(_only(folder)))
    out.mkdir(parents=True, exist_ok=True)
    return tuple(_save(module["function"](name), out) for name in module["FUNCTIONS"])


def _only(folder: Path) -> Path:
    found = sorted(folder.glob("*_casadi.py"))
    if len(found) != 1:
        raise FileNotFoundError(f"{folder} holds {len(found)} files *_casadi.py, not one")
    return found[0]


def _save(function: Any, out: Path) -> Path:
    path = out / f"{function.name()}.casadi"
    function.save(str(path))
    return path
