"""What every table of a spec has in common: exact numbers, one quantity under keys of several units, and its SI value."""

from collections.abc import Callable, Iterator
from decimal import Decimal
from fractions import Fraction
from typing import Annotated, Any, ClassVar, Literal, cast

from pydantic import BaseModel, ConfigDict, PlainValidator, WithJsonSchema
from pydantic_core import PydanticCustomError

from walkgen.spec.scalar import Apply, Exact, ExpressionError, Name, Pi, Scalar, degrees, div, exact, mul, parse

Path = tuple[str | int, ...]
"""Where in the document a value stands: keys and indices from the top."""

_LARGEST_BITS = 1024
_LARGEST_EXPONENT = 308
_PI = Fraction(Decimal("3.1415926535897932384626433832795028841971693993751"))
_SNAP = Fraction(1, 10**15)


def _scalar(value: Any) -> Scalar:
    """A TOML number, or a text of whitelisted arithmetic, kept exact; what is exact already stays."""
    if is_scalar(value):
        return cast(Scalar, value)
    if isinstance(value, str):
        return _parsed(value)
    number = Decimal(repr(value)) if isinstance(value, float) else value
    if isinstance(number, bool) or not isinstance(number, int | Decimal):
        raise PydanticCustomError("WG112", "a number is expected, or arithmetic in quotes")
    if not _fits_double(number):
        raise PydanticCustomError("WG113", "not a finite number that a double can hold")
    return exact(number)


def _parsed(text: str) -> Scalar:
    try:
        return parse(text)
    except ExpressionError as error:
        # the text travels in the context: pydantic would take braces in a message for its own
        raise PydanticCustomError("WG114", "{reason}", {"reason": str(error)}) from error


def _fits_double(number: int | Decimal) -> bool:
    if isinstance(number, int):
        return number.bit_length() < _LARGEST_BITS
    return number.is_finite() and (number.is_zero() or abs(number.adjusted()) < _LARGEST_EXPONENT)


Number = Annotated[Scalar, PlainValidator(_scalar), WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]})]
Pair = tuple[Number, Number]
Triple = tuple[Number, Number, Number]
Six = tuple[Number, Number, Number, Number, Number, Number]


def _millimetres(scalar: Scalar) -> Scalar:
    return div(scalar, exact(1000))


def _unchanged(scalar: Scalar) -> Scalar:
    return scalar


def snapped(scalar: Scalar) -> Scalar:
    """An angle (rad) typed as a number within 1e-15 of a multiple of pi/12 as that exact multiple, else unchanged."""
    if not isinstance(scalar, Exact):
        return scalar
    twelfths = round(scalar.value * 12 / _PI)
    near = abs(scalar.value - twelfths * _PI / 12) <= _SNAP
    return mul(exact(Fraction(twelfths, 12)), Pi()) if near else scalar


class Table(BaseModel):
    """A table of the spec; its fields are the keys as typed."""

    # Only the outermost table's validator is ever used: the inner ones would be built for nothing, half a second in all.
    model_config = ConfigDict(defer_build=True, frozen=True, extra="forbid", use_attribute_docstrings=True)

    def si(self, key: str) -> Any:
        """The quantity in SI units: a Scalar, a tuple of them, or None where neither `key`, `key_deg` nor `key_mm` was given.

        Degrees become exact radians; radians next to a multiple of pi/12 become that multiple.
        """
        plain = snapped if self.is_angle(key) else _unchanged
        units: tuple[tuple[str, Callable[[Scalar], Scalar]], ...] = (("", plain), ("_deg", degrees), ("_mm", _millimetres))
        for suffix, convert in units:
            value = getattr(self, key + suffix, None)
            if value is not None:
                return tuple(convert(entry) for entry in value) if isinstance(value, tuple) else convert(value)
        return None

    def is_angle(self, key: str) -> bool:
        """Whether the quantity is an angle in radians (`_deg` may be appended to its key)."""
        return key in self.ANGLES

    ANGLES: ClassVar[frozenset[str]] = frozenset()


def entries(value: Any, path: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Every table, list, text and number below (and with) `value`, with its place; exact numbers are not taken apart."""
    yield path, value
    if isinstance(value, Table):
        children: Iterator[tuple[str | int, Any]] = iter(value)
    elif isinstance(value, dict):
        children = iter(value.items())
    elif isinstance(value, tuple):
        children = iter(enumerate(value))
    else:
        return
    for key, child in children:
        if child is not None:
            yield from entries(child, (*path, key))


def is_scalar(value: Any) -> bool:
    """Whether the value is an exact number or a tree of them."""
    return isinstance(value, Exact | Pi | Name | Apply)


Sign = Literal[1, -1]
