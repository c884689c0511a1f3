"""Outputs that are numbers or nothing: a status, and NaN wherever it is not OK."""

from collections.abc import Sequence

import sympy

from walkgen.symbolic.branches import BAD_INPUT, OK
from walkgen.symbolic.first_root import nothing
from walkgen.symbolic.function import Finite, LessEqual, Select
from walkgen.symbolic.tape import Tape

Case = tuple[sympy.Basic, sympy.Expr]
"""A condition, and the status where it holds."""


def settled(
    tape: Tape, inputs: Sequence[sympy.Expr], cases: Sequence[Case], outputs: Sequence[sympy.Expr], kept: sympy.Expr = OK
) -> list[sympy.Expr]:
    """The outputs, then their status: BAD_INPUT where an input is not finite, else that of the first case that holds, else OK.

    Outputs that are not finite without a reason make BAD_INPUT as well: the inputs are too large for them. Where the status is neither OK
    nor `kept`, outputs are NaN.
    """
    taken = tape.let("given", sympy.Add(*inputs))
    given = Finite(taken)
    named = [tape.let("output", output) for output in outputs]
    status: sympy.Expr = Select(Finite(tape.let("taken", sympy.Add(*named))), OK, BAD_INPUT)
    for truth, reason in reversed(cases):
        status = Select(truth, reason, status)
    status = tape.let("status", Select(given, status, BAD_INPUT))
    holds = LessEqual(abs(status - kept) * status, 0)
    poison = tape.let("poison", Select(holds, 0, nothing(taken)))
    return [*(output + poison for output in named), status]
