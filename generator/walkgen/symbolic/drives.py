"""What a joint's own parts take besides the bodies that it moves: friction and the motor's rotor."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.model.mechanism import Joint, Mechanism
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Indicator, Less
from walkgen.symbolic.tape import Tape

_ZERO = sympy.S.Zero


@dataclass(frozen=True)
class Drive:
    """Friction and rotor of a joint."""

    viscous: sympy.Expr
    coulomb: sympy.Expr
    rotor: sympy.Expr

    def effort(self, rate: sympy.Expr, acceleration: sympy.Expr) -> sympy.Expr:
        """What the joint's own parts take."""
        return self.rotor * acceleration + self.friction(rate)

    def friction(self, rate: sympy.Expr) -> sympy.Expr:
        """Against the motion; 0 at rest."""
        if rate == 0:
            return _ZERO
        return self.viscous * rate + (self.coulomb * sense(rate) if self.coulomb != 0 else _ZERO)


def sense(rate: sympy.Expr) -> sympy.Expr:
    """1, 0 or -1: its sign."""
    return Indicator(Less(0, rate)) - Indicator(Less(rate, 0))


def drives(joints: Sequence[tuple[str, Joint]], mechanism: Mechanism, tape: Tape) -> tuple[Drive, ...]:
    """One for every joint, with the name that its intermediates bear."""
    parameters = parameter_symbols(mechanism)
    found = []
    for name, joint in joints:
        words = ("viscous", "coulomb", "rotor")
        found.append(Drive(*(tape.let(f"{name}_{word}", expression(getattr(joint, word), parameters)) for word in words)))
    return tuple(found)


def effort_unit(joints: Sequence[Joint]) -> str:
    """Of a joint's effort."""
    return {frozenset({"revolute"}): "N m", frozenset({"prismatic"}): "N"}.get(frozenset(joint.kind for joint in joints), "N m or N")
