"""What is on a tape, for NumPy's arrays: for the generator's own use, where many points are wanted at once."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import sympy

from walkgen.symbolic.tape import Tape
from walkgen.symbolic.tape_values import lines_behind

_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "Angle": np.arctan2,
    "Select": np.where,
    "Less": np.less,
    "LessEqual": np.less_equal,
    "Same": np.equal,
    "Finite": np.isfinite,
    "Both": np.logical_and,
    "Either": np.logical_or,
    "Opposite": np.logical_not,
}
"""What NumPy calls functions that are not sympy's own."""


def compiled(tape: Tape, inputs: Sequence[sympy.Symbol], outputs: Sequence[sympy.Expr]) -> Callable[..., list[Any]]:
    """The outputs by NumPy, for numbers or arrays of the inputs."""
    behind = lines_behind(tape, [sympy.sympify(output) for output in outputs])
    plain = {symbol: sympy.Symbol(f"v{number}") for number, symbol in enumerate((*inputs, *(symbol for symbol, _ in behind)))}
    lines = [(plain[symbol], definition.xreplace(plain)) for symbol, definition in behind]
    given, wanted = [plain[symbol] for symbol in inputs], [sympy.sympify(output).xreplace(plain) for output in outputs]
    found: Callable[..., list[Any]] = sympy.lambdify(given, wanted, [_FUNCTIONS, "numpy"], cse=lambda expressions: (lines, expressions))
    return found
