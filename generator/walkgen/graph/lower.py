"""sympy's last line: Functions become Programs, every value numbered, operands ordered by their numbers."""

from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal
from functools import lru_cache
from typing import Any

import sympy

from walkgen.graph.number import Numbering
from walkgen.graph.passes import fused, pruned, scheduled
from walkgen.graph.program import Call, Code, Composite, Program
from walkgen.graph.routines import ROUTINES
from walkgen.symbolic import function as symbolic
from walkgen.symbolic.function import Derivation, Function, Solve

Shape = tuple[Any, ...]
_DIGITS = 40
_UNARY = {sympy.sin: Code.SIN, sympy.cos: Code.COS, sympy.tan: Code.TAN, sympy.Abs: Code.ABS}
_DIRECT: dict[type, Code] = {
    symbolic.Less: Code.LESS,
    symbolic.LessEqual: Code.LESS_EQUAL,
    symbolic.Same: Code.EQUAL,
    symbolic.Finite: Code.FINITE,
    symbolic.Both: Code.AND,
    symbolic.Either: Code.OR,
    symbolic.Opposite: Code.NOT,
    symbolic.Select: Code.SELECT,
    symbolic.Indicator: Code.INDICATOR,
    symbolic.Epsilon: Code.EPSILON,
    symbolic.Angle: Code.ATAN2,
    sympy.atan2: Code.ATAN2,
}


def lower(derivation: Derivation, fma: bool = True) -> Program | Composite:
    """A derivation as straight-line code; with `fma`, multiply-adds are fused (design: bits equal within a class).

    Args:
        derivation: a Function, or a Solve whose steps are lowered one by one.
        fma: fuse a*b + c into one rounding.
    """
    return _composite(derivation, fma) if isinstance(derivation, Solve) else program(derivation, fma)


@lru_cache(maxsize=64)
def program(function: Function, fma: bool) -> Program:
    """One Function as a Program; steps that many functions share are lowered once, and what equal legs have alike."""
    unnamed = replace(function.signature, robot="", owner="", name="", doc="", source="")
    return replace(_program(replace(function, signature=unnamed), fma), signature=function.signature)


@lru_cache(maxsize=512)
def _program(function: Function, fma: bool) -> Program:
    numbering = Numbering(function.signature)
    lowering = _Lowering(numbering, function)
    outputs = tuple(lowering.number(output) for output in function.outputs)
    plain = pruned(Program(function.signature, numbering.ops, outputs))
    return scheduled(fused(plain) if fma else plain)


def _composite(solve: Solve, fma: bool) -> Composite:
    calls, slopes = (
        tuple(
            Call(step.callee if isinstance(step.callee, str) else program(step.callee, fma), step.arguments, step.guard, step.repeat)
            for step in steps
        )
        for steps in (solve.steps, solve.slopes)
    )
    callbacks = tuple(_composite(callback, fma) for callback in solve.callbacks)
    routines = [name for call in calls for name in (call.callee, call.guard[0] if call.guard else None) if isinstance(name, str)]
    called_back = (header for callback in callbacks for header in callback.headers)
    headers = tuple(dict.fromkeys([*(ROUTINES[name].header for name in routines), *called_back]))
    closed_form = lower(solve.closed_form, fma) if solve.closed_form else None
    return Composite(solve.signature, solve.locals, calls, headers, closed_form, solve.tables, callbacks, slopes)


class _Lowering:
    """Walks the small expressions of one Function; each symbol and subexpression is numbered once."""

    def __init__(self, numbering: Numbering, function: Function) -> None:
        self._numbering = numbering
        self._numbers: dict[sympy.Basic, int] = {symbol: index for index, symbol in enumerate(function.inputs)}
        for symbol, definition in _needed(function):
            self._numbers[symbol] = numbering.named(self.number(definition), symbol.name)

    def number(self, expression: sympy.Basic) -> int:
        """The op that computes the expression."""
        known = self._numbers.get(expression)
        if known is None:
            known = self._compute(expression)
            self._numbers[expression] = known
        return known

    def _compute(self, expression: sympy.Basic) -> int:
        if expression.is_number:
            return self._numbering.constant(_decimal(expression))
        if expression.is_Add:
            return self._sum(expression.args)
        if expression.is_Mul:
            return self._product(expression.args)
        if expression.is_Pow:
            return self._power(*expression.args)
        if expression.func is symbolic.Residue:
            return self._numbering.op(Code.SUB, *(self.number(expression.args[0]),) * 2)
        code = _UNARY.get(expression.func) or _DIRECT[expression.func]
        return self._numbering.op(code, *(self.number(argument) for argument in expression.args))

    def _sum(self, terms: Sequence[sympy.Expr]) -> int:
        ordered = [(term, _is_negated(term)) for term in sorted(terms, key=self._rank)]
        positive = [term for term, negated in ordered if not negated]
        negative = [-term for term, negated in ordered if negated]
        return self._combined(positive, negative, Code.ADD, Code.SUB)

    def _combined(self, first: Sequence[sympy.Expr], second: Sequence[sympy.Expr], join: Code, part: Code) -> int:
        """first... minus (or over) second...: left to right, or a negated sum where nothing is positive."""
        numbers = [self.number(term) for term in first]
        others = [self.number(term) for term in second]
        if not numbers:
            return self._numbering.op(Code.NEG, self._chain(join, others))
        total = self._chain(join, numbers)
        for other in others:
            total = self._numbering.op(part, total, other)
        return total

    def _chain(self, code: Code, numbers: Sequence[int]) -> int:
        total = numbers[0]
        for number in numbers[1:]:
            total = self._numbering.op(code, total, number)
        return total

    def _product(self, factors: Sequence[sympy.Expr]) -> int:
        ordered = sorted(factors, key=self._rank)
        sign = sum(factor.is_number and bool(factor.is_negative) for factor in ordered) % 2
        absolute = [abs(factor) if factor.is_number else factor for factor in ordered]
        above = [self.number(factor) for factor in absolute if factor != 1 and not _is_reciprocal(factor)]
        below = [self.number(1 / factor) for factor in absolute if _is_reciprocal(factor)]
        total = self._chain(Code.MUL, above) if above else self._numbering.constant(Decimal(1))
        if below:
            total = self._numbering.op(Code.DIV, total, self._chain(Code.MUL, below))
        return self._numbering.op(Code.NEG, total) if sign else total

    def _power(self, base: sympy.Expr, exponent: sympy.Expr) -> int:
        if exponent == sympy.Rational(1, 2):
            return self._numbering.op(Code.SQRT, self.number(base))
        if exponent.is_negative:
            return self._numbering.op(Code.DIV, self._numbering.constant(Decimal(1)), self.number(base**-exponent))
        if exponent.is_Integer:
            return self._chain(Code.MUL, [self.number(base)] * int(exponent))
        whole, half = divmod(exponent, 1)
        assert half == sympy.Rational(1, 2), exponent
        return self._numbering.op(Code.MUL, self.number(base**whole), self.number(sympy.sqrt(base)))

    def _rank(self, term: sympy.Expr) -> tuple[tuple[int, ...], Shape]:
        """Order of operands: by the numbers of the values they use, never by names or the algebra system's sort."""
        if term.is_Symbol:
            return (self.number(term),), ("", self.number(term))
        return tuple(sorted(self.number(symbol) for symbol in term.free_symbols)), self._shape(term)

    def _shape(self, expression: sympy.Basic) -> Shape:
        """The expression as nested tuples that compare alike whatever its symbols are called."""
        if expression.is_Symbol:
            return ("", self.number(expression))
        if not expression.args:
            return (_digits(expression),)
        arguments = [self._shape(argument) for argument in expression.args]
        commutes = expression.is_Add or expression.is_Mul
        return (expression.func.__name__, *(sorted(arguments) if commutes else arguments))


def _needed(function: Function) -> list[tuple[sympy.Symbol, sympy.Expr]]:
    """The intermediates that the outputs use, as written."""
    used = {symbol for output in function.outputs for symbol in output.free_symbols}
    kept: list[tuple[sympy.Symbol, sympy.Expr]] = []
    for symbol, definition in reversed(function.intermediates):
        if symbol in used:
            used |= definition.free_symbols
            kept.append((symbol, definition))
    return kept[::-1]


def _digits(number: sympy.Basic) -> str:
    """What has no arguments and is no symbol."""
    return str(int(number)) if number.is_Integer else str(number)


def _is_negated(term: sympy.Expr) -> bool:
    return not term.is_Symbol and bool(term.as_coeff_Mul()[0].is_negative)


def _is_reciprocal(factor: sympy.Expr) -> bool:
    return bool(factor.is_Pow and factor.exp.is_negative)


def _decimal(number: sympy.Expr) -> Decimal:
    if number.is_Integer:
        return Decimal(int(number))
    if number.is_infinite:
        return Decimal("-Infinity" if number.is_extended_negative else "Infinity")
    return Decimal(str(number.evalf(_DIGITS)))
