"""Where Eigen's headers are: the C++ peers' code needs them, and CasADi's wheel carries them."""

from pathlib import Path

import casadi

from peers.source import CORES, core

HEADERS = Path(casadi.__file__).parent / "include" / "eigen3"

SHAPES = {"p": (3, 1), "q": (3, 1), "J": (3, 3), "H": (27, 1), "signs": (2, 1)}


def shape(function: str, port: str) -> tuple[int, int]:
    """Rows and columns of a port as the C++ peers declare it; J is given transposed, so that it lies row-major."""
    return (12, 1) if (function, port) == ("inverse", "q") else SHAPES[port]


def _cast(function: str, port: str, constant: bool) -> str:
    rows, columns = shape(function, port)
    kind = f"{'const ' if constant else ''}Eigen::Matrix<double, {rows}, {columns}>"
    return f"*reinterpret_cast<{kind} *>({port})"


def call(name: str, callee: str, address_of: str) -> str:
    """The core that calls a generated template on the caller's memory, without a copy."""
    given, outputs = CORES[name]
    inputs = [given] + (["signs"] if name == "inverse_branch" else [])
    arguments = [_cast(name, port, constant=True) for port in inputs]
    arguments += [address_of + _cast(name, port, constant=False) for port in outputs]
    return core(name, f"    {callee}<double>({', '.join(arguments)});")
