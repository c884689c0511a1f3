"""Computes the polynomials of walkgen_trig_kernel.h: minimax by Remez' exchange, coefficients rounded, the later ones fitted anew."""

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import mpmath
from mpmath import mpf

mpmath.mp.dps = 60
_SAMPLES = 60


@dataclass(frozen=True)
class Family:
    """`target`(r) is fitted by a polynomial in r^2 for 0 < r <= `limit`; `weight`(r) turns its error into the function's."""

    name: str
    limit: float
    target: Callable[[mpf], mpf]
    weight: Callable[[mpf], mpf]


def families(limit: float, bound: float) -> tuple[Family, ...]:
    """sin r = r + r^3 S, cos r = 1 + r^2 C for |r| <= `limit`; atan r = r - r^3 A for |r| <= `bound`; S, C, A in r^2.

    All cosines lie between two powers of two: there the error itself is weighed.
    """
    return (
        Family("sine", limit, lambda r: (mpmath.sin(r) - r) / r**3, lambda r: r**3 / mpmath.sin(r)),
        Family("cosine", limit, lambda r: (mpmath.cos(r) - 1) / r**2, lambda r: r**2),
        Family("arctangent", bound, lambda r: (r - mpmath.atan(r)) / r**3, lambda r: r**3 / mpmath.atan(r)),
    )


def error(family: Family, coefficients: Sequence[mpf], r: mpf) -> mpf:
    """Error of the function at r, its sum taken exactly."""
    return family.weight(r) * (mpmath.polyval(list(reversed(coefficients)), r**2) - family.target(r))


def extrema(family: Family, coefficients: Sequence[mpf], count: int) -> list[mpf]:
    """The `count` places of alternating sign where the error is largest, ascending."""
    grid = [family.limit * mpmath.sin(mpmath.pi * mpf(i) / (2 * count * _SAMPLES)) for i in range(1, count * _SAMPLES + 1)]
    errors = [error(family, coefficients, r) for r in grid]
    peaks: list[tuple[mpf, mpf]] = []
    for r, value in zip(grid, errors, strict=True):
        if peaks and mpmath.sign(peaks[-1][1]) == mpmath.sign(value):
            peaks[-1] = max(peaks[-1], (r, value), key=lambda peak: abs(peak[1]))
        else:
            peaks.append((r, value))
    while len(peaks) > count:
        peaks.pop(0 if abs(peaks[0][1]) < abs(peaks[-1][1]) else -1)
    return [r for r, _ in peaks]


def minimax(family: Family, fixed: Sequence[mpf], free: int) -> list[mpf]:
    """`fixed` followed by the `free` coefficients with the least largest error."""
    points = [family.limit * mpmath.sin(mpmath.pi * mpf(i) / (2 * free + 2)) for i in range(1, free + 2)]
    coefficients = list(fixed)
    for _ in range(8):
        rows = mpmath.matrix(free + 1, free + 1)
        rest = mpmath.matrix(free + 1, 1)
        for i, r in enumerate(points):
            for k in range(free):
                rows[i, k] = family.weight(r) * r ** (2 * (len(fixed) + k))
            rows[i, free] = mpf(-1) ** i
            rest[i] = -error(family, fixed or [mpf(0)], r)
        coefficients = [*fixed, *mpmath.lu_solve(rows, rest)[:free]]
        found = extrema(family, coefficients, free + 1)
        if len(found) <= free:
            break
        points = found
    return coefficients


def rounded(value: mpf, bits: int) -> mpf:
    """The nearest number of so many bits."""
    with mpmath.workprec(bits):
        return +value


def fit(family: Family, count: int, bits: int) -> list[mpf]:
    """`count` coefficients of `bits` bits, lowest first."""
    fixed: list[mpf] = []
    for _ in range(count):
        fixed.append(rounded(minimax(family, fixed, count - len(fixed))[len(fixed)], bits))
    return fixed


def worst(family: Family, coefficients: Sequence[mpf]) -> mpf:
    """The largest error over the range."""
    return max(abs(error(family, coefficients, family.limit * mpf(i) / 1000)) for i in range(1, 1001))


def parts(value: mpf, *bits: int) -> list[mpf]:
    """The number as a sum of numbers of so many bits, all of them positive: cut off, only the last one rounded."""
    found: list[mpf] = []
    for count in bits[:-1]:
        rest = value - mpmath.fsum(found)
        unit = mpf(2) ** (mpmath.floor(mpmath.log(rest, 2)) + 1 - count)
        found.append(mpmath.floor(rest / unit) * unit)
    return [*found, rounded(value - mpmath.fsum(found), bits[-1])]


@dataclass(frozen=True)
class Table:
    """One list of their numbers."""

    name: str
    bits: int
    numbers: tuple[mpf, ...]
    error: mpf | None = None

    @property
    def texts(self) -> tuple[str, ...]:
        """The numbers without their signs, in digits that bring them back."""
        return tuple(mpmath.nstr(abs(number), 17 if self.bits == 53 else 9) for number in self.numbers)


_FITS = ((53, (0.7854, 0.5), (6, 6, 12)), (24, (0.7866, 0.5), (3, 3, 5)))
_PARTS = (
    ("pi/2", 53, mpmath.pi / 2, (36, 36, 53)),
    ("pi/4", 53, mpmath.pi / 4, (50, 53)),
    ("pi/2", 24, mpmath.pi / 2, (24, 24, 24)),
    ("pi/2", 24, mpmath.pi / 2, (11, 11, 11, 24)),
    ("pi/4", 24, mpmath.pi / 4, (21, 24)),
)


def tables() -> Iterator[Table]:
    """All of them, double's first. Ranges a little wider than needed: n is off by one where x 2/pi is rounded to it."""
    for bits, ranges, counts in _FITS:
        for family, count in zip(families(*ranges), counts, strict=True):
            coefficients = fit(family, count, bits)
            yield Table(family.name, bits, tuple(coefficients), worst(family, coefficients))
    for name, bits, value, lengths in _PARTS:
        yield Table(name, bits, tuple(parts(value, *lengths)))


def main() -> None:
    """Print every table with the error of its function."""
    for table in tables():
        error_text = f", error 2^{mpmath.nstr(mpmath.log(table.error, 2), 4)}" if table.error else ""
        sys.stdout.write(f"{table.name} in {table.bits} bits{error_text}: {' '.join(table.texts)}\n")


if __name__ == "__main__":
    main()
