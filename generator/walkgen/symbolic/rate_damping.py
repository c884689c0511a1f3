"""Where the damping of a leg's rates begins and how strong it gets: the spec's, or by how far a unit of its rates moves the foot."""

from collections.abc import Iterator
from decimal import Decimal
from functools import cache
from itertools import product
from statistics import median
from typing import Any

import sympy

from walkgen.model.drive_ranges import drive_ranges
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.model.walk import CONTEXT, defaults, number
from walkgen.symbolic.driven import DrivenKinematics
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.tape import Tape, symbols_of
from walkgen.symbolic.tape_closure import TapeClosure, evaluated
from walkgen.symbolic.tape_values import lines_behind, value

Damping = tuple[Decimal, Decimal]
_PER_SIZE, _DIGITS = Decimal("0.01"), 20
_SHARES = tuple(CONTEXT.mpf(ninths) / 9 for ninths in (2, 4, 7))
"""Of the drives' ranges: where a few postures stand for all."""
_STILL = 1e-6
"""Of the linkage's size per unit of a drive: less does not move the foot."""


@cache
def rate_damping(mechanism: Mechanism, leg: Limb) -> Damping:
    """Epsilon and lambda_max (m per rad or m of a rate), parameters at their defaults.

    Where the spec gives none, of a leg with a linkage both are a hundredth of how far a unit of its drives' rates moves the foot: the
    linkage's size, 1 m at most, and of every drive no more than what it does in the median of some postures.
    """
    if leg.damping is not None:
        epsilon, largest = (Decimal(CONTEXT.nstr(number(entry, mechanism), _DIGITS)) for entry in leg.damping)
        return epsilon, largest
    assert leg.linkage is not None, leg.name
    size = min(float(number(leg.linkage.size, mechanism)), 1.0)
    least = min((length for length in _typical_slopes(mechanism, leg, leg.linkage) if length > _STILL * size), default=size)
    default = Decimal(f"{min(size, least):.2g}") * _PER_SIZE
    return default, default


def _typical_slopes(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> list[float]:
    """Of every drive, the median length of the foot's slope."""
    found = list(_slopes(mechanism, leg, linkage))
    return [median(column) for column in zip(*found, strict=True)]


def _slopes(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> Iterator[list[float]]:
    """Lengths of the foot's slopes by the drives, wherever the linkage assembles of a few postures."""
    tape, symbols = Tape(), symbols_of(joint_port("q", leg.joints))
    first, parameters = len(leg.serial), parameter_symbols(mechanism)
    columns = DrivenKinematics((leg,), linkage, symbols, parameters, tape).jacobian[first : first + linkage.drive_count]
    entries = [entry for column in columns for entry in column]
    lines, closing = lines_behind(tape, entries), TapeClosure(mechanism, leg, tape) if linkage.forward.triads else None
    for q in _postures(mechanism, leg, linkage):
        given = {**_parameters(mechanism), **dict(zip(symbols, q, strict=True))}
        closed = closing.closed(given) if closing else given
        known = evaluated(lines, closed) if closed else None
        if known is not None:
            yield [float(CONTEXT.norm([value(entry, known) for entry in column])) for column in columns]


def _parameters(mechanism: Mechanism) -> dict[sympy.Symbol, Any]:
    values = defaults(mechanism)
    return {symbol: values[name] for name, symbol in parameter_symbols(mechanism).items()}


def _postures(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> Iterator[tuple[Any, ...]]:
    """Drives all over their ranges; other joints, of which the lengths hardly tell, in the middle of theirs."""
    before, after = ([_middle(joint, mechanism) for joint in joints] for joints in (leg.serial, leg.distal))
    for shares in product(_SHARES, repeat=linkage.drive_count):
        ranges = zip(drive_ranges(mechanism, leg, linkage), shares, strict=True)
        yield (*before, *(low + share * (high - low) for (low, high), share in ranges), *after)


def _middle(joint: Joint, mechanism: Mechanism) -> Any:
    return sum(number(limit, mechanism) for limit in joint.limits) / 2 if joint.limits else CONTEXT.zero
