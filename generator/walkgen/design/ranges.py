"""Where a balance is judged: each relieved joint over each of its ranges, with and without load, on Gauss nodes and on a dense grid."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from walkgen.model.mechanism import Limb
from walkgen.model.values import Values
from walkgen.spec.balance import BalanceSpec, Ranges

Reals = NDArray[np.float64]
SUPPORT, TRANSFER = "support", "transfer"


@dataclass(frozen=True)
class Range:
    """One joint from `low` to `high` under a load (kg), the others at each of `rest` [k, joints] in turn."""

    phase: str
    joint: int
    name: str
    unit: str
    low: float
    high: float
    load: float
    rest: Reals

    def places(self, values: Reals) -> Reals:
        """Joint values [k, n, joints] for n values of the joint."""
        q = np.repeat(self.rest[:, None, :], len(values), axis=1)
        q[:, :, self.joint] = values
        return q

    def loaded(self, values: Reals) -> tuple[Reals, Reals]:
        """The same joint values in rows [k n, joints], and the load at each (kg)."""
        q = self.places(values)
        return q.reshape(-1, q.shape[-1]), np.full(q.shape[0] * q.shape[1], self.load)

    def gauss(self, nodes: int) -> tuple[Reals, Reals]:
        """Gauss-Legendre nodes of the range, and weights whose sum is 1."""
        x, weight = np.polynomial.legendre.leggauss(nodes)
        return (self.low + self.high) / 2 + (self.high - self.low) / 2 * x, weight / 2

    def dense(self, points: int) -> Reals:
        """Even steps, both ends among them."""
        return np.linspace(self.low, self.high, points)


def ranges_of(balance: BalanceSpec, leg: Limb, values: Values) -> tuple[Range, ...]:
    """Support first, joints in the leg's order.

    Args:
        balance: whose joints and numbers were checked.
        leg: the balance's.
        values: of the spec's parameters.
    """
    names = [joint.name for joint in leg.joints]
    held = np.zeros(len(names))
    for name, value in balance.others.items():
        held[names.index(name)] = values.number(value)
    load = values.number(balance.load)
    phases = ((SUPPORT, balance.supported, load), (TRANSFER, balance.transferred, 0.0))
    return tuple(found for phase, ranges, carried in phases for found in _phase(phase, ranges, carried, held, leg, values))


def _phase(phase: str, ranges: Ranges, load: float, held: Reals, leg: Limb, values: Values) -> Iterator[Range]:
    """Other relieved joints are at their least value, in the middle and at their largest value."""
    spans = {name: (values.number(low), values.number(high)) for name, (low, high) in ranges.items()}
    for number, joint in enumerate(leg.joints):
        if joint.name not in spans:
            continue
        others = [other for other in spans if other != joint.name]
        rest = []
        for choice in product(*(_three(*spans[other]) for other in others)):
            q = held.copy()
            for other, value in zip(others, choice, strict=True):
                q[[each.name for each in leg.joints].index(other)] = value
            rest.append(q)
        yield Range(phase, number, joint.name, joint.unit, *spans[joint.name], load, np.array(rest))


def _three(low: float, high: float) -> tuple[float, float, float]:
    return ((low + high) / 2, low, high)
