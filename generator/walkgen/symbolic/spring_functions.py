"""What the functions of a leg's springs compute, and what they leave unbalanced: one leg has one set of springs."""

from collections.abc import Iterator, Sequence

import sympy

from walkgen.symbolic.leg_dynamics import LegDynamics
from walkgen.symbolic.springs import Springs
from walkgen.symbolic.tape import scaled

Exprs = Sequence[sympy.Expr]


def _springs(leg: LegDynamics) -> Springs:
    (springs,) = leg.spread.springs
    return springs


def spring_length(leg: LegDynamics) -> Exprs:
    """Of every spring."""
    return tuple(stretch.length for stretch in _springs(leg).stretches)


def spring_tension(leg: LegDynamics) -> Exprs:
    """Of every spring."""
    return tuple(_springs(leg).tensions())


def spring_energy(leg: LegDynamics) -> Exprs:
    """Of every spring."""
    return tuple(_springs(leg).energies())


def spring_moment(leg: LegDynamics) -> Exprs:
    """What every spring does to every joint, row-major."""
    return tuple(-effort for row in _held(leg) for effort in row)


def unbalance_moment(leg: LegDynamics) -> Exprs:
    """On every joint, of all that acts at rest while the foot carries a load."""
    (load,) = leg.symbols["load"]
    return tuple(-effort for effort in leg.efforts(leg.still, leg.still, scaled(-load, leg.gravity)))


def _held(leg: LegDynamics) -> Iterator[Exprs]:
    """Efforts of the joints that hold against each spring alone."""
    springs, none = _springs(leg), [sympy.S.Zero] * len(leg.spread.values)
    for spring in range(len(springs.coils)):
        efforts = list(none)
        for number, effort in springs.efforts(spring):
            efforts[number] = effort
        yield leg.spread.borne(efforts)
