"""Springs that weigh what they must to store their energy: searched with masses, weighed, searched on, until both agree."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from walkgen.design.balance import Balance
from walkgen.design.multistart import Found, Progress, solved
from walkgen.errors import Problem as Wrong
from walkgen.errors import SpecError

_SETTLED = 1e-7
"""Relative change of masses that is none."""
_ROUNDS = 30


def weighed(
    made: Callable[[Mapping[str, float]], Balance], settings: Mapping[str, float], starts: int, seed: int, progress: Progress
) -> tuple[Found, Balance]:
    """The best springs of a balance, whose masses are those that their energy asks for where the spec says how much a kilogram stores.

    Args:
        made: the balance with values of parameters that are not varied.
        settings: such values, of a catalogue's choice.
        starts: random starts; later rounds begin where the earlier one ended.
        seed: of the starts.
        progress: is told after every start.

    Raises:
        SpecError: masses and springs do not come to agree.
    """
    balance = made(settings)
    found = solved(balance.problem, starts, seed, progress)
    if balance.table.energy_per_mass is None:
        return found, balance
    masses: dict[str, float] = {}
    for number in range(_ROUNDS):
        before, masses = masses, balance.masses(found.x)
        if all(abs(mass - before.get(name, 0.0)) <= _SETTLED * mass for name, mass in masses.items()):
            return found, balance
        progress(f"masses, round {number + 1}")
        balance = made({**settings, **masses})
        problem = balance.problem
        variables = tuple(replace(variable, start=float(value)) for variable, value in zip(problem.variables, found.x, strict=True))
        found = solved(replace(problem, variables=variables), 0, seed)
    message = f"balance {balance.name}: the springs' masses do not settle: each change of them asks for other springs"
    raise SpecError(Wrong("WG226", message, "raise energy_per_mass, or give the masses themselves"))
