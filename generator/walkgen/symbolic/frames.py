"""Exact scalars and constant transforms of the model as sympy numbers, or expressions in the runtime parameters."""

from collections.abc import Mapping
from dataclasses import dataclass

import sympy

from walkgen.model.mechanism import Mechanism, Motion, Transform
from walkgen.spec.scalar import Apply, Exact, Name, Pi, Scalar
from walkgen.symbolic.tape import IDENTITY, ZERO_VECTOR, Columns, Vec, constant, constant_vector, plus, scaled, times

Parameters = Mapping[str, sympy.Symbol]
_FUNCTIONS = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "pow": lambda a, b: a**b,
    "sqrt": sympy.sqrt,
    "sin": sympy.sin,
    "cos": sympy.cos,
    "tan": sympy.tan,
    "atan2": sympy.atan2,
    "hypot": lambda a, b: sympy.sqrt(a**2 + b**2),
}


def parameter_symbols(mechanism: Mechanism) -> Parameters:
    """The elements of `param` by the parameters' names."""
    return {parameter.name: sympy.Symbol(f"param[{index}]") for index, parameter in enumerate(mechanism.parameters)}


def expression(scalar: Scalar, parameters: Parameters) -> sympy.Expr:
    """The scalar as a sympy expression, rationals exact."""
    if isinstance(scalar, Exact):
        return sympy.Rational(scalar.value.numerator, scalar.value.denominator)
    if isinstance(scalar, Pi):
        return sympy.pi
    if isinstance(scalar, Name):
        return parameters[scalar.name]
    assert isinstance(scalar, Apply)
    return _FUNCTIONS[scalar.function](*(expression(argument, parameters) for argument in scalar.arguments))


@dataclass(frozen=True)
class Frame:
    """A constant pose: rotation by columns and origin; entries are numbers, or expressions in runtime parameters."""

    rotation: Columns = IDENTITY
    origin: Vec = ZERO_VECTOR

    def __mul__(self, other: "Frame") -> "Frame":
        x, y, z = (constant_vector(times(self.rotation, column)) for column in other.rotation)
        return Frame((x, y, z), constant_vector(plus(self.origin, times(self.rotation, other.origin))))


def frame_of(transform: Transform, parameters: Parameters) -> Frame:
    """The product of the transform's elementary motions."""
    frame = Frame()
    for motion in transform:
        frame = frame * _motion(motion, parameters)
    return frame


def rotation_about(axis: int, angle: sympy.Expr) -> Frame:
    """Rotation about a coordinate axis."""
    cosine, sine = cosine_sine(angle)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    columns = [list(column) for column in IDENTITY]
    columns[first][first] = columns[second][second] = cosine
    columns[first][second], columns[second][first] = sine, -sine
    x, y, z = ((column[0], column[1], column[2]) for column in columns)
    return Frame((x, y, z))


def cosine_sine(angle: sympy.Expr) -> tuple[sympy.Expr, sympy.Expr]:
    """cos and sin, folded where the angle is a number."""
    cosine, sine = sympy.cos(angle), sympy.sin(angle)
    return (constant(cosine), constant(sine)) if angle.is_number else (cosine, sine)


def _motion(motion: Motion, parameters: Parameters) -> Frame:
    amount = expression(motion.amount, parameters)
    if motion.kind == "rotate":
        return rotation_about(motion.axis, amount)
    return Frame(IDENTITY, constant_vector(scaled(amount, IDENTITY[motion.axis])))
