"""Random motions of a leg with a linkage or a cam, to 50 digits: joints and drives move freely, the links as they must."""

import random
from collections.abc import Mapping, Sequence
from typing import Any

import sympy

from walkgen.model.drive_ranges import drive_ranges
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT
from walkgen.symbolic.minimal import Motions, Values
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.tape import symbols_of
from walkgen.symbolic.tape_closure import TapeClosure, evaluated
from walkgen.symbolic.tape_values import lines_behind, value

_TRIES, _GRAIN = 500, 1000


class NoPostureError(Exception):
    """No drives were found for which the linkage assembles."""


def driven_motions(mechanism: Mechanism, leg: Limb, spread: Spread) -> Motions:
    """Of the links of the leg's tree; triads are closed in any way that Newton's method comes to from the start.

    Raises:
        NoPostureError: when called: none of many values of the drives has a posture.
    """
    linkage = leg.linkage
    closing = TapeClosure(mechanism, leg, spread.tape) if linkage and linkage.forward.triads else None
    symbols = symbols_of(joint_port("q", leg.joints))
    turns: list[tuple[Any, Any]] = [(-2, 2) for _ in leg.serial]
    ranges = turns + (drive_ranges(mechanism, leg, linkage) if linkage else []) + [(-2, 2) for _ in leg.distal]
    lines = lines_behind(spread.tape, [*spread.values, *(slope for row in spread.slopes for slope in row.values())])

    def motions(known: Values, generator: random.Random) -> list[tuple[Any, Any]]:
        for _ in range(_TRIES):
            q = [low + (high - low) * generator.randrange(1, _GRAIN) / _GRAIN for low, high in ranges]
            rates = [CONTEXT.mpf(generator.randrange(-2 * _GRAIN, 2 * _GRAIN)) / _GRAIN for _ in ranges]
            given = {**known, **dict(zip(symbols, q, strict=True))}
            closed = closing.closed(given) if closing else given
            found = evaluated(lines, closed) if closed else None
            if found is not None:
                return [(value(at, found), _rate(row, rates, found)) for at, row in zip(spread.values, spread.slopes, strict=True)]
        raise NoPostureError

    return motions


def _rate(row: Mapping[int, sympy.Expr], rates: Sequence[Any], known: Values) -> Any:
    return sum(value(slope, known) * rates[index] for index, slope in row.items())
