"""A spec's balance as a problem: residual moments on Gauss nodes, springs that only pull and fit, and what is left on a dense grid."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from walkgen.design.fitting import fitting
from walkgen.design.freed import freed, variables_of, varied, with_values
from walkgen.design.problem import Objective, Problem, Reals, Variable
from walkgen.design.problem import Values as Valued
from walkgen.design.ranges import SUPPORT, TRANSFER, Range, ranges_of
from walkgen.design.sampled import Sampled
from walkgen.design.statics import Numbers, Statics
from walkgen.errors import Problem as Wrong
from walkgen.errors import UnsupportedMechanism
from walkgen.model.assemble import assemble
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.values import Values
from walkgen.spec.scalar import Scalar
from walkgen.spec.schema import RobotSpec

DENSE = 2001
"""Points of each range on which results are judged."""


@dataclass(frozen=True)
class Residue:
    """What is left of a joint's moment over one of its ranges: of all that acts on it but its drive, positive where it drives q on.

    Attributes:
        range: where.
        values: of the joint [n] (rad or m).
        moments: at each, the worst over where the other relieved joints are [n] (N m or N).
        differences: at each, between the least and the largest of these [n].
    """

    range: Range
    values: Reals
    moments: Reals
    differences: Reals

    @property
    def apart(self) -> float:
        """The largest difference."""
        return float(self.differences.max())

    @property
    def largest(self) -> float:
        """Of its size."""
        return float(np.abs(self.moments).max())

    @property
    def rms(self) -> float:
        """Over the range."""
        return float(np.sqrt(np.trapezoid(self.moments**2, self.values) / (self.values[-1] - self.values[0])))

    @property
    def work(self) -> float:
        """What the drive gives and takes while it goes once through the range, both counted as spent (J)."""
        return float(np.trapezoid(np.abs(self.moments), self.values))


class Balance:
    """One [balance.NAME] of a spec.

    Args:
        spec: validated.
        name: of the balance.
        folder: the spec's.
        settings: parameters that have other values than the spec's, and are not varied.

    Raises:
        UnsupportedMechanism: the leg has triads.
    """

    def __init__(self, spec: RobotSpec, name: str, folder: Path, settings: Mapping[str, float] | None = None) -> None:
        self.table, self.name, self._folder = spec.balance[name], name, folder
        self.settings = dict(settings or {})
        self.spec = with_values(spec, self.settings)
        self.names = tuple(key for key in varied(spec, self.table.vary) if key not in self.settings)
        moving = freed(self.spec, self.names)
        self._values, self.mechanism = Values.of(moving.parameters), assemble(moving, folder)
        self.leg = _leg(self.mechanism, self.table.leg)
        self.ranges = ranges_of(self.table, self.leg, self._values)
        if self.leg.linkage is not None and self.leg.linkage.forward.triads:
            message = f"balance {name}: the leg {self.leg.name} has triads, and springs are searched for legs in closed form alone"
            raise UnsupportedMechanism(Wrong("WG150", message, "describe a leg of dyads, or choose its springs by hand"))

    @property
    def variables(self) -> tuple[Variable, ...]:
        """What may move, with the spec's values."""
        return variables_of(self.spec, self.names)

    @cached_property
    def _statics(self) -> Statics:
        return Statics(self.mechanism, self.leg, self.names)

    @cached_property
    def _without(self) -> Statics:
        """Without springs and cams, and without what they weigh."""
        designs = {key: design.model_copy(update={"springs": ()}) for key, design in self.spec.leg_designs.items()}
        mechanism = assemble(self.spec.model_copy(update={"leg_designs": designs, "balance": {}}), self._folder)
        return Statics(mechanism, _leg(mechanism, self.table.leg), ())

    @cached_property
    def bare(self) -> tuple[Residue, ...]:
        """What acts without springs."""
        return tuple(_residue(each, self._without, np.zeros(0)) for each in self.ranges)

    @cached_property
    def size(self) -> float:
        """The largest moment without springs."""
        return max(residue.largest for residue in self.bare) or 1.0

    def residues(self, x: Reals) -> tuple[Residue, ...]:
        """What is left for the variables' values, on a dense grid."""
        return tuple(_residue(each, self._statics, x) for each in self.ranges)

    def stretches(self, x: Reals) -> tuple[Reals, Reals]:
        """Least and largest length of every spring over all ranges (m), on a dense grid."""
        lengths = np.concatenate([self._statics.at(*each.loaded(each.dense(DENSE)), x).lengths for each in self.ranges])
        return lengths.min(0), lengths.max(0)

    def lengths_over(self, each: Range, x: Reals) -> tuple[Reals, Reals]:
        """Values of the range's joint [n], and lengths of every spring there [n, springs] (m), the other relieved joints in the middle."""
        values = each.dense(DENSE)
        return values, self._statics.at(*each.loaded(values), x).lengths[: len(values)]

    def number(self, scalar: Scalar) -> float:
        """A number of the balance's table."""
        return self._values.number(scalar)

    def free_lengths(self, x: Reals) -> Reals:
        """Of every spring (m)."""
        return Numbers(self.mechanism, [spring.free_length for spring in self.leg.springs], self.names).at(x)[0]

    def masses(self, x: Reals) -> dict[str, float]:
        """What every spring must weigh to store its energy at its largest tension, T^2 / (2 k) (kg), by the names of parameters."""
        assert self.table.energy_per_mass is not None
        springs, (_, longest) = self.leg.springs, self.stretches(x)
        scalars = [entry for spring in springs for entry in (spring.stiffness, spring.free_length, spring.tension)]
        rows = Numbers(self.mechanism, scalars, self.names).at(x)[0].reshape(-1, 3).T
        energies = (rows[2] + rows[0] * (longest - rows[1])) ** 2 / (2 * rows[0])
        per_mass = self.number(self.table.energy_per_mass)
        return {f"{spring.name}_mass": float(energy) / per_mass for spring, energy in zip(springs, energies, strict=True)}

    @property
    def problem(self) -> Problem:
        """To be solved."""
        sampled = Sampled(self._statics, self.ranges, self.table.nodes)
        phases = [phase for phase in (SUPPORT, TRANSFER) if any(each.phase == phase for each in self.ranges)]
        constraints = fitting(self.table, self.mechanism, self.leg, sampled, self.names, self._values)
        return Problem(self.variables, tuple(self._objective(phase, sampled) for phase in phases), tuple(constraints))

    def _objective(self, phase: str, sampled: Sampled) -> Objective:
        """The mean squares of its ranges' moments, in shares of the largest one without springs."""
        given = getattr(self.table.weights, phase)
        numbers = [number for number, each in enumerate(self.ranges) if each.phase == phase]

        def residuals(x: Reals) -> Valued:
            parts = [sampled.moments(number, x) for number in numbers]
            shares = [np.sqrt(part.weights) / self.size for part in parts]
            values = [share * part.values for share, part in zip(shares, parts, strict=True)]
            slopes = [share[:, None] * part.slopes for share, part in zip(shares, parts, strict=True)]
            return Valued(np.concatenate(values), np.concatenate(slopes))

        return Objective(phase, residuals, 1.0 if given is None else self._values.number(given))


def _residue(each: Range, statics: Statics, x: Reals) -> Residue:
    values = each.dense(DENSE)
    moments = statics.at(*each.loaded(values), x).moments[:, each.joint].reshape(len(each.rest), -1)
    worst = np.abs(moments).argmax(0)
    return Residue(each, values, moments[worst, np.arange(len(values))], np.ptp(moments, axis=0))


def _leg(mechanism: Mechanism, name: str) -> Limb:
    return next(leg for leg in mechanism.legs if leg.name == name)
