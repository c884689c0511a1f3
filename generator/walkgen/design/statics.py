"""One leg at rest as functions of joints, load and the parameters that may vary: what is left on the joints, springs' lengths, slopes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import defaults
from walkgen.spec.scalar import Scalar
from walkgen.symbolic.arrays import compiled
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.leg_dynamics import LegDynamics
from walkgen.symbolic.linked_tree import spread_leg
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.spring_functions import unbalance_moment
from walkgen.symbolic.tangents import tangents
from walkgen.symbolic.tape import Tape, symbols_of

Reals = NDArray[np.float64]


@dataclass(frozen=True)
class Rest:
    """At n places: moments left on the joints [n, joints], lengths of the springs [n, springs], slopes of both by the variables."""

    moments: Reals
    lengths: Reals
    moments_slopes: Reals
    lengths_slopes: Reals


class Statics:
    """Of one leg whose foot carries a load (kg) against gravity.

    Args:
        mechanism: whose runtime parameters include the variables.
        leg: one of its legs, without triads.
        variables: names of runtime parameters.
    """

    def __init__(self, mechanism: Mechanism, leg: Limb, variables: Sequence[str]) -> None:
        tape, q = Tape(), symbols_of(joint_port("q", leg.joints))
        dynamics = LegDynamics(mechanism, leg, *spread_leg(mechanism, leg, q, tape), tape)
        springs = dynamics.spread.springs
        outputs = list(unbalance_moment(dynamics))
        outputs += [stretch.length for each in springs for stretch in each.stretches]
        symbols, values = parameter_symbols(mechanism), defaults(mechanism)
        named = [(name, symbols[name]) for name in variables]
        slopes = [entry for row in tangents(tape, outputs, named) for entry in row] if named else []
        self._sizes = len(leg.joints), len(outputs) - len(leg.joints), len(named)
        self._parameters = {name: float(values[name]) for name in symbols}
        self._variables = tuple(variables)
        self._function = compiled(tape, (*q, *dynamics.symbols["load"], *symbols.values()), outputs + slopes)

    def at(self, q: Reals, load: Reals, x: Reals) -> Rest:
        """At joint values [n, joints] with loads [n] (kg), for the variables' values."""
        joints, springs, variables = self._sizes
        given = self._parameters | dict(zip(self._variables, map(float, x), strict=True))
        with np.errstate(all="ignore"):
            found = self._function(*q.T, load, *given.values())
        rows = np.empty((len(load), len(found)))
        for place, row in enumerate(found):
            rows[:, place] = row
        values, slopes = rows[:, : joints + springs], rows[:, joints + springs :].reshape(len(load), joints + springs, variables)
        return Rest(values[:, :joints], values[:, joints:], slopes[:, :joints], slopes[:, joints:])


class Numbers:
    """Scalars of the mechanism, with their slopes by the variables."""

    def __init__(self, mechanism: Mechanism, scalars: Sequence[Scalar], variables: Sequence[str]) -> None:
        symbols, values = parameter_symbols(mechanism), defaults(mechanism)
        entries = [expression(scalar, symbols) for scalar in scalars]
        slopes = [entry.diff(symbols[name]) for entry in entries for name in variables]
        self._parameters, self._variables = {name: float(values[name]) for name in symbols}, tuple(variables)
        self._count = len(entries)
        self._function = compiled(Tape(), tuple(symbols.values()), entries + slopes)

    def at(self, x: Reals) -> tuple[Reals, Reals]:
        """Values [m] and slopes [m, n]."""
        given = self._parameters | dict(zip(self._variables, map(float, x), strict=True))
        found = np.array([float(entry) for entry in self._function(*given.values())])
        return found[: self._count], found[self._count :].reshape(self._count, len(self._variables))
