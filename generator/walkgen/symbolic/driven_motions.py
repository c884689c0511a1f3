"""Random motions of a leg with a linkage, to 50 digits: joints and drives move freely, the links as they must."""

import random
from collections.abc import Mapping, Sequence
from typing import Any

import sympy

from walkgen.model.drive_ranges import drive_ranges
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT
from walkgen.symbolic.minimal import Motions, Values
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.tape import symbols_of
from walkgen.symbolic.tape_values import lines_behind, value

_TRIES = 500
_GRAIN = 1000


class NoPostureError(Exception):
    """No drives were found for which the linkage assembles, or what closes its triads is not known."""


def driven_motions(mechanism: Mechanism, leg: Limb, linkage: Linkage, spread: Spread) -> Motions:
    """Of the links of the leg's tree.

    Raises:
        NoPostureError: the linkage has triads; or, when called, none of many values of the drives has a posture.
    """
    if linkage.forward.triads:
        raise NoPostureError
    symbols = symbols_of(joint_port("q", leg.joints))
    turns: list[tuple[Any, Any]] = [(-2, 2) for _ in leg.serial]
    ranges = turns + drive_ranges(mechanism, leg, linkage)
    lines = lines_behind(spread.tape, [*spread.values, *(slope for row in spread.slopes for slope in row.values())])

    def motions(known: Values, generator: random.Random) -> list[tuple[Any, Any]]:
        for _ in range(_TRIES):
            q = [low + (high - low) * generator.randrange(1, _GRAIN) / _GRAIN for low, high in ranges]
            rates = [CONTEXT.mpf(generator.randrange(-2 * _GRAIN, 2 * _GRAIN)) / _GRAIN for _ in ranges]
            found = _evaluated(lines, {**known, **dict(zip(symbols, q, strict=True))})
            if found is not None:
                return [(value(at, found), _rate(row, rates, found)) for at, row in zip(spread.values, spread.slopes, strict=True)]
        raise NoPostureError

    return motions


def _rate(row: Mapping[int, sympy.Expr], rates: Sequence[Any], known: Values) -> Any:
    return sum(value(slope, known) * rates[index] for index, slope in row.items())


def _evaluated(lines: Sequence[tuple[sympy.Symbol, sympy.Expr]], known: dict[sympy.Symbol, Any]) -> Values | None:
    """Every line's value; None where one is not real: a dyad cannot close."""
    for symbol, definition in lines:
        if symbol not in known:
            known[symbol] = value(definition, known)
            if isinstance(known[symbol], CONTEXT.mpc):
                return None
    return known
