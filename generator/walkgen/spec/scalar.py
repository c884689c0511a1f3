"""Exact numbers of a spec: a whitelisted arithmetic tree over decimals, pi and named parameters; never eval."""

import ast
import re
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any


@dataclass(frozen=True)
class Exact:
    """A rational number, as typed."""

    value: Fraction


@dataclass(frozen=True)
class Pi:
    """The circle constant, exact until printed."""


@dataclass(frozen=True)
class Name:
    """A named parameter."""

    name: str


@dataclass(frozen=True)
class Apply:
    """A whitelisted operation on earlier scalars."""

    function: str
    arguments: tuple["Scalar", ...]


Scalar = Exact | Pi | Name | Apply
Vector = tuple[Scalar, Scalar, Scalar]

FUNCTIONS = {"sqrt": 1, "sin": 1, "cos": 1, "tan": 1, "atan2": 2, "hypot": 2}
_BINARY: dict[type[ast.operator], str] = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.Div: "div", ast.Pow: "pow"}
_LONGEST = 1000
_DEEPEST = 50
_LARGEST_POWER = 64
_LARGEST_BITS = 1 << 15
CURVE_PARAMETER = "lambda"
"""What a curve's expressions run along; a keyword of Python, so its parser is given the letter instead."""
_LETTER = "\N{GREEK SMALL LETTER LAMDA}"


class ExpressionError(ValueError):
    """A text that is not whitelisted arithmetic; the message names what is not allowed."""


def exact(number: int | Decimal | Fraction) -> Exact:
    """The number itself, without rounding."""
    return Exact(Fraction(number))


ZERO = exact(0)
ONE = exact(1)


def is_zero(scalar: Scalar) -> bool:
    """Whether the scalar is the number 0 (a tree that merely evaluates to 0 is not)."""
    return scalar == ZERO


def add(left: Scalar, right: Scalar) -> Scalar:
    """Left + right, folded where both are rational."""
    if is_zero(left) or is_zero(right):
        return right if is_zero(left) else left
    return _fold("add", left, right)


def sub(left: Scalar, right: Scalar) -> Scalar:
    """Left - right, folded where both are rational."""
    return left if is_zero(right) else _fold("sub", left, right)


def total(scalars: Iterable[Scalar]) -> Scalar:
    """The sum of all, 0 of none."""
    found: Scalar = ZERO
    for scalar in scalars:
        found = add(found, scalar)
    return found


def mul(left: Scalar, right: Scalar) -> Scalar:
    """Left * right, folded where both are rational."""
    if ONE in (left, right):
        return right if left == ONE else left
    return ZERO if ZERO in (left, right) else _fold("mul", left, right)


def div(left: Scalar, right: Scalar) -> Scalar:
    """Left / right, folded where both are rational."""
    if right == ZERO:
        raise ExpressionError("division by zero")
    return _fold("div", left, right)


def neg(scalar: Scalar) -> Scalar:
    """-scalar; a double negation cancels."""
    if isinstance(scalar, Exact):
        return Exact(-scalar.value)
    if isinstance(scalar, Apply) and scalar.function == "neg":
        return scalar.arguments[0]
    return Apply("neg", (scalar,))


def power(base: Scalar, exponent: Scalar) -> Scalar:
    """Base ** exponent for a whole exponent up to 64 either way."""
    if not isinstance(exponent, Exact) or exponent.value.denominator != 1 or abs(exponent.value) > _LARGEST_POWER:
        raise ExpressionError(f"an exponent is a whole number up to {_LARGEST_POWER}")
    if isinstance(base, Exact):
        if base.value == 0 and exponent.value < 0:
            raise ExpressionError("division by zero")
        _bounded(_bits(base.value) * int(abs(exponent.value)))
        return Exact(base.value ** int(exponent.value))
    return Apply("pow", (base, exponent))


def _bits(value: Fraction) -> int:
    return max(value.numerator.bit_length(), value.denominator.bit_length())


def _bounded(bits: int) -> None:
    if bits > _LARGEST_BITS:
        raise ExpressionError("the arithmetic gives a number of thousands of digits")


def _fold(function: str, left: Scalar, right: Scalar) -> Scalar:
    if isinstance(left, Exact) and isinstance(right, Exact):
        _bounded(_bits(left.value) + _bits(right.value))
        return Exact(_ARITHMETIC[function](left.value, right.value))
    return Apply(function, (left, right))


_ARITHMETIC: dict[str, Callable[[Fraction, Fraction], Fraction]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
}
_OPERATORS: dict[str, Callable[..., Any]] = {**_ARITHMETIC, "neg": lambda a: -a, "pow": lambda a, b: a ** int(b)}
_BUILDERS: dict[str, Callable[..., Scalar]] = {"add": add, "sub": sub, "mul": mul, "div": div, "neg": neg, "pow": power}


def apply(function: str, *arguments: Scalar) -> Scalar:
    """The operation by its name, folded where it can be."""
    builder = _BUILDERS.get(function)
    return builder(*arguments) if builder else Apply(function, arguments)


def degrees(scalar: Scalar) -> Scalar:
    """An angle in degrees as exact radians."""
    return mul(div(scalar, exact(180)), Pi())


def parse(text: str) -> Scalar:
    """Read whitelisted arithmetic: numbers, names, `pi`, + - * / **, brackets, sqrt sin cos tan atan2 hypot.

    Raises:
        ExpressionError: anything else, with the offending part named.
    """
    if len(text) > _LONGEST:
        raise ExpressionError(f"an expression is at most {_LONGEST} characters long")
    plain = re.sub(rf"\b{CURVE_PARAMETER}\b", _LETTER, text.strip())
    try:
        with warnings.catch_warnings(action="ignore"):
            tree = ast.parse(plain, mode="eval")
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        raise ExpressionError(f"not an arithmetic expression: {text!r}") from error
    return _scalar(tree.body, plain, 0)


def _scalar(node: ast.expr, text: str, depth: int) -> Scalar:
    if depth > _DEEPEST:
        raise ExpressionError(f"brackets nest deeper than {_DEEPEST}")
    if isinstance(node, ast.Constant):
        return _number(node, text)
    if isinstance(node, ast.Name):
        return Pi() if node.id == "pi" else Name(CURVE_PARAMETER if node.id == _LETTER else node.id)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        inner = _scalar(node.operand, text, depth + 1)
        return neg(inner) if isinstance(node.op, ast.USub) else inner
    if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        return apply(_BINARY[type(node.op)], _scalar(node.left, text, depth + 1), _scalar(node.right, text, depth + 1))
    if isinstance(node, ast.Call):
        return _call(node, text, depth)
    allowed = f"numbers, parameter names, pi, + - * / **, {', '.join(FUNCTIONS)}"
    raise ExpressionError(f"{ast.get_source_segment(text, node)!r} is not arithmetic; allowed: {allowed}")


def _number(node: ast.Constant, text: str) -> Scalar:
    source = ast.get_source_segment(text, node) or ""
    if isinstance(node.value, bool) or not isinstance(node.value, (int, float)):
        raise ExpressionError(f"{source!r} is not a number")
    number = Decimal(source.replace("_", "")) if source[:2].lower() not in {"0x", "0o", "0b"} else Decimal(int(node.value))
    if abs(number.adjusted()) > 308:
        raise ExpressionError(f"{source!r} is too large or too small for a double")
    return exact(number)


def _call(node: ast.Call, text: str, depth: int) -> Scalar:
    name = node.func.id if isinstance(node.func, ast.Name) else ""
    if FUNCTIONS.get(name) != len(node.args) or node.keywords:
        allowed = ", ".join(f"{function}({', '.join('xy'[:count])})" for function, count in FUNCTIONS.items())
        raise ExpressionError(f"{ast.get_source_segment(text, node)!r} is not allowed; functions are {allowed}")
    return apply(name, *(_scalar(argument, text, depth + 1) for argument in node.args))


def names(scalar: Scalar) -> frozenset[str]:
    """Every parameter name the scalar uses."""
    if isinstance(scalar, Name):
        return frozenset({scalar.name})
    if isinstance(scalar, Apply):
        return frozenset().union(*(names(argument) for argument in scalar.arguments))
    return frozenset()


def substitute(scalar: Scalar, values: Mapping[str, Scalar]) -> Scalar:
    """Replace the names found in `values`, folding what becomes rational."""
    if isinstance(scalar, Name):
        return values.get(scalar.name, scalar)
    if isinstance(scalar, Apply):
        return apply(scalar.function, *(substitute(argument, values) for argument in scalar.arguments))
    return scalar


def evaluate(scalar: Scalar, context: Any, values: Mapping[str, Any]) -> Any:
    """The value in an mpmath context (or the `math` functions of any object with the same names).

    Args:
        scalar: the tree.
        context: has `mpf`, `pi`, `sqrt`, `sin`, `cos`, `tan`, `atan2`, `hypot` (such as `mpmath.mp`).
        values: what each remaining name stands for.
    """
    if isinstance(scalar, Exact):
        return context.mpf(scalar.value.numerator) / context.mpf(scalar.value.denominator)
    if isinstance(scalar, Pi):
        return +context.pi
    if isinstance(scalar, Name):
        return values[scalar.name]
    arguments = [evaluate(argument, context, values) for argument in scalar.arguments]
    if scalar.function in _OPERATORS:
        return _OPERATORS[scalar.function](*arguments)
    return getattr(context, scalar.function)(*arguments)
