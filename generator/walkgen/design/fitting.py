"""What springs must not do while they are looked for: push, be drawn too far, stick out of the room that there is for them."""

from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal

import numpy as np

from walkgen.design.problem import Constraint, Reals, Values
from walkgen.design.sampled import Sampled
from walkgen.design.statics import Numbers
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.values import Values as SpecValues
from walkgen.spec.balance import BalanceSpec
from walkgen.spec.scalar import Scalar, exact, mul, sub
from walkgen.spec.springs import MOUNT

STRETCH = (exact(Decimal("1.02")), exact(Decimal("1.9")))
"""Least and largest length of a spring, in free lengths, where the spec is silent."""
_SIZE = 0.1
"""Margins are shares of this length (m)."""


def fitting(
    balance: BalanceSpec, mechanism: Mechanism, leg: Limb, sampled: Sampled, names: Sequence[str], values: SpecValues
) -> Iterator[Constraint]:
    """The constraints of a balance whose variables are `names`."""
    low, high = balance.stretch or STRETCH
    frees = [spring.free_length for spring in leg.springs]
    limits = [Numbers(mechanism, [mul(values.resolve(factor), free) for free in frees], names) for factor in (low, high)]

    def lengths(x: Reals) -> Values:
        (least, least_slopes), (most, most_slopes) = (limit.at(x) for limit in limits)
        lengths, slopes = sampled.lengths(x)
        parts = _flat(lengths - least, slopes - least_slopes), _flat(most - lengths, most_slopes - slopes)
        return Values(np.concatenate([part.values for part in parts]), np.concatenate([part.slopes for part in parts]))

    yield Constraint("length", lengths)
    if balance.boxes:
        room = Numbers(mechanism, list(_sides(balance, leg, values)), names)
        yield Constraint("boxes", lambda x: _flat(*room.at(x)))


def limits_of(balance: BalanceSpec, free_lengths: Reals, number: Callable[[Scalar], float]) -> tuple[Reals, Reals]:
    """Least and largest length of springs with these free lengths [springs] (m)."""
    low, high = (number(factor) for factor in balance.stretch or STRETCH)
    return low * free_lengths, high * free_lengths


def _flat(lengths: Reals, slopes: Reals) -> Values:
    return Values(lengths.ravel() / _SIZE, slopes.reshape(lengths.size, -1) / _SIZE)


def _sides(balance: BalanceSpec, leg: Limb, values: SpecValues) -> Iterator[Scalar]:
    """Of every end on a link with a box, how far it is from each side of it (m)."""
    serial = (MOUNT, *(joint.name for joint in (*leg.serial, *leg.distal)))
    planar = leg.linkage.structure.names if leg.linkage else ()
    for spring in leg.springs:
        for end in spring.ends:
            corners = balance.boxes.get((planar if end.planar else serial)[end.link])
            for axis in range(2 if end.planar else 3) if corners else ():
                assert corners is not None
                low, high = sorted((values.resolve(corner[axis]) for corner in corners), key=values.number)
                yield sub(end.at[axis], low)
                yield sub(high, end.at[axis])
