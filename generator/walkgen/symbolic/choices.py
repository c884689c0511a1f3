"""Choices and conditions, decided while deriving wherever numbers decide them: constant geometry leaves no trace of them."""

import sympy

from walkgen.symbolic.function import Both, Either, Finite, Less, LessEqual, Same, Select
from walkgen.symbolic.tape import constant


def less(left: sympy.Expr | int, right: sympy.Expr | int) -> sympy.Basic:
    """left < right."""
    difference = _known(left, right)
    return Less(left, right) if difference is None else sympy.sympify(bool(difference < 0))


def at_most(left: sympy.Expr | int, right: sympy.Expr | int) -> sympy.Basic:
    """left <= right."""
    difference = _known(left, right)
    return LessEqual(left, right) if difference is None else sympy.sympify(bool(difference <= 0))


def same(left: sympy.Expr | int, right: sympy.Expr | int) -> sympy.Basic:
    """left == right."""
    difference = _known(left, right)
    return Same(left, right) if difference is None else sympy.sympify(bool(difference == 0))


def finite(number: sympy.Expr | int) -> sympy.Basic:
    """Neither infinite nor NaN."""
    return sympy.true if sympy.sympify(number).is_number else Finite(number)


def both(left: sympy.Basic, right: sympy.Basic) -> sympy.Basic:
    """Logical and."""
    if sympy.false in (left, right):
        return sympy.false
    if sympy.true in (left, right):
        return right if left is sympy.true else left
    return Both(left, right)


def either(left: sympy.Basic, right: sympy.Basic) -> sympy.Basic:
    """Logical or."""
    if sympy.true in (left, right):
        return sympy.true
    if sympy.false in (left, right):
        return right if left is sympy.false else left
    return Either(left, right)


def chosen(truth: sympy.Basic, then: sympy.Expr | int, otherwise: sympy.Expr | int) -> sympy.Expr:
    """One of two values."""
    if truth in (sympy.true, sympy.false):
        return sympy.sympify(then if truth is sympy.true else otherwise)
    return Select(truth, then, otherwise)


def indicator(truth: sympy.Basic) -> sympy.Expr:
    """1 or 0."""
    return chosen(truth, 1, 0)


def _known(left: sympy.Expr | int, right: sympy.Expr | int) -> sympy.Expr | None:
    """The difference of two numbers."""
    first, second = sympy.sympify(left), sympy.sympify(right)
    return constant(first) - constant(second) if first.is_number and second.is_number else None
