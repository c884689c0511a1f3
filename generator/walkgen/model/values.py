"""Numbers of a spec made final: constant parameters put in, runtime parameters left as names."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from mpmath.ctx_mp import MPContext

from walkgen.spec.scalar import ZERO, Exact, Scalar, Vector, evaluate, names, substitute
from walkgen.spec.schema import ParameterSpec

_CONTEXT = MPContext()
_CONTEXT.dps = 50


@dataclass(frozen=True)
class Values:
    """`constants` replace names for good; `defaults` are what the runtime parameters stand for when a number is needed."""

    constants: Mapping[str, Scalar]
    defaults: Mapping[str, Any]

    @classmethod
    def of(cls, parameters: Mapping[str, ParameterSpec]) -> "Values":
        """Resolve parameters that refer to each other (cycles were refused by the spec)."""
        constants: dict[str, Scalar] = {}
        pending = {name: entry.value for name, entry in parameters.items() if not entry.runtime}
        while pending:
            ready = {name: value for name, value in pending.items() if not names(value) & pending.keys()}
            constants |= {name: substitute(value, constants) for name, value in ready.items()}
            pending = {name: value for name, value in pending.items() if name not in ready}
        defaults: dict[str, Any] = {}
        for name, entry in parameters.items():
            if entry.runtime:
                defaults[name] = evaluate(substitute(entry.value, constants), _CONTEXT, defaults)
        return cls(constants, defaults)

    def resolve(self, scalar: Scalar | None) -> Scalar:
        """The scalar with constant parameters put in; 0 where the spec left it out."""
        return ZERO if scalar is None else substitute(scalar, self.constants)

    def vector(self, scalars: Sequence[Scalar] | None) -> Vector:
        """Three resolved scalars; zeros where the spec left them out."""
        x, y, z = (self.resolve(scalar) for scalar in scalars or (ZERO, ZERO, ZERO))
        return (x, y, z)

    def point(self, scalars: tuple[Scalar, Scalar]) -> tuple[Scalar, Scalar]:
        """Two resolved scalars."""
        return (self.resolve(scalars[0]), self.resolve(scalars[1]))

    def pair(self, scalars: Sequence[Scalar] | None) -> tuple[Scalar, Scalar] | None:
        """Two resolved scalars, or None."""
        if scalars is None:
            return None
        low, high = (self.resolve(scalar) for scalar in scalars)
        return (low, high)

    def optional(self, scalar: Scalar | None) -> Scalar | None:
        """A resolved scalar, or None."""
        return None if scalar is None else self.resolve(scalar)

    def fraction(self, scalar: Scalar) -> Fraction:
        """The value of a number without runtime parameters: exact where it is rational, else to 50 digits."""
        resolved = self.resolve(scalar)
        return resolved.value if isinstance(resolved, Exact) else Fraction(_CONTEXT.nstr(evaluate(resolved, _CONTEXT, {}), _CONTEXT.dps))

    def number(self, scalar: Scalar) -> float:
        """The value at the default parameters, for choices that need a size and not an exact number."""
        return float(evaluate(self.resolve(scalar), _CONTEXT, self.defaults))
