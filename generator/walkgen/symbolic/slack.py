"""Where a leg's springs are shorter than their free lengths, on a grid over the limits of its joints."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import defaults, number
from walkgen.symbolic.arrays import compiled
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.linked_tree import spread_leg
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.tape import Tape, symbols_of

_MOST_POINTS = 4096
_LEAST = 3
Reals = NDArray[np.float64]


@dataclass(frozen=True)
class Slack:
    """A spring's least length over the grid (m), below its free length, with the joints' values there."""

    spring: int
    length: float
    free: float
    q: tuple[float, ...]


def slack(mechanism: Mechanism, leg: Limb) -> Iterator[Slack]:
    """Of every spring that goes slack within the limits, where it is shortest; runtime parameters at their defaults.

    Legs whose joints have no limits, or whose linkage has triads, are not looked at.
    """
    triads = leg.linkage is not None and leg.linkage.forward.triads
    if not leg.springs or triads or any(joint.limits is None for joint in leg.joints):
        return
    q = _grid(mechanism, leg)
    lengths = _lengths(mechanism, leg, q)
    for place, (spring, row) in enumerate(zip(leg.springs, lengths, strict=True)):
        free = float(number(spring.free_length, mechanism))
        least = int(np.argmin(np.where(np.isnan(row), np.inf, row)))
        if row[least] < free:
            yield Slack(place, float(row[least]), free, tuple(float(value) for value in q[:, least]))


def _grid(mechanism: Mechanism, leg: Limb) -> Reals:
    """Joint values [n, points]."""
    limits = [[float(number(limit, mechanism)) for limit in joint.limits or ()] for joint in leg.joints]
    nodes = max(_LEAST, int(_MOST_POINTS ** (1 / len(limits))))
    axes = np.meshgrid(*(np.linspace(low, high, nodes) for low, high in limits), indexing="ij")
    return np.array([axis.ravel() for axis in axes])


def _lengths(mechanism: Mechanism, leg: Limb, q: Reals) -> list[Reals]:
    """Of every spring at every point; NaN where a linkage does not assemble."""
    tape, symbols, parameters = Tape(), symbols_of(joint_port("q", leg.joints)), parameter_symbols(mechanism)
    (springs,) = spread_leg(mechanism, leg, symbols, tape)[1].springs
    lengths, values = [stretch.length for stretch in springs.stretches[: len(leg.springs)]], defaults(mechanism)
    function = compiled(tape, (*symbols, *parameters.values()), lengths)
    with np.errstate(all="ignore"):
        found = function(*q, *(float(values[name]) for name in parameters))
    return [np.broadcast_to(np.asarray(row, dtype=float), q.shape[1:]) for row in found]
