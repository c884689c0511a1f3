"""What has to hold of a leg before anything is looked for that balances it."""

from collections.abc import Iterator

import numpy as np

from walkgen.design.balance import Balance, Residue
from walkgen.errors import Problem, SpecError

_EQUAL = 1e-9
"""Of the largest moment: two that differ by less are one."""


def check_apart(balance: Balance) -> None:
    """The leg assembles over all ranges, and the moment of every relieved joint, without springs, depends on its own value alone.

    Raises:
        SpecError: it does not, with the joint's value where it cannot be assembled, or where its moment differs most.
    """
    problems = [problem for residue in balance.bare for problem in _problems(balance, residue)]
    if problems:
        raise SpecError(*problems)


def _problems(balance: Balance, residue: Residue) -> Iterator[Problem]:
    gaps = np.flatnonzero(~np.isfinite(residue.differences))
    if len(gaps):
        message = f"balance {balance.name}: the leg's linkage does not assemble at {_at(residue, int(gaps[0]))}"
        yield Problem("WG225", message, "narrow the range, or hold the other joints elsewhere")
    elif residue.apart > _EQUAL * balance.size:
        name, place = residue.range.name, int(residue.differences.argmax())
        message = f"balance {balance.name}: at {_at(residue, place)} the moment of {name} changes by {residue.apart:.4g} N m with the other"
        message += " joints: two of its links are no parallelogram"
        yield Problem("WG217", message, "make opposite links equally long, or balance one joint with the others held")


def _at(residue: Residue, place: int) -> str:
    return f"{residue.range.name} = {residue.values[place]:.4g} {residue.range.unit}"
