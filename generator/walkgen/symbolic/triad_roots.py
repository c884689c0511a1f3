"""All ways in which a triad closes, at most six: roots of a trigonometric polynomial in the angle by which its ends are turned.

Seen from the first end, the second moves by x + r p, with r of length 1. Every strut asks for one thing: that two pins be as far apart as
it is long, that a pin be on the guide of one end or the other, or, of two sliders, a certain r. Where r is known, the difference of two of
these conditions and one more are linear in x; what is left of the third is the polynomial, of at most three harmonics (the sextic of
planar platforms: Peisach 1985; Gosselin, Sefrioui, Richard 1992), which Fourier's sums and the eigenvalues of a companion matrix solve.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.symbolic.triads import OF_STRUT

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]
Evaluate = Callable[[Reals], Complex]
"""The entries of a triad's shape as complex numbers [entries, n], for angles or ways in sizes of its first strut's pairs [2, n]."""
_SAMPLES, _HARMONICS = 32, 6
_ON_CIRCLE, _NOTHING = 1e-3, 1e-13
_SOMEWHERE = np.array([[0.3], [0.4]])


def roots(kinds: Sequence[str], evaluate: Evaluate) -> Reals:
    """Angles or ways in sizes of the first strut's pairs [2, n] in every way in which the triad closes, to be polished.

    Args:
        kinds: of every strut's pairs, `RR`, `RP`, `PR` or `PP`, the first pair that of the first end.
        evaluate: see there.
    """
    seen = _seen(evaluate(_SOMEWHERE))[:, 0]
    struts = [(kind, seen[2 + OF_STRUT * place : 2 + OF_STRUT * (place + 1)]) for place, kind in enumerate(kinds)]
    square = next((numbers for kind, numbers in struts if kind == "PP"), None)
    if square is None:
        turns, moves = _any_turn([_condition(kind, numbers) for kind, numbers in struts])
    else:
        turn = square[4:5] / square[5:6]
        moves = _known_turn([_condition(kind, numbers)(turn) for kind, numbers in struts if kind != "PP"])
        turns = np.broadcast_to(turn, moves.shape)
    fine = np.isfinite(moves)
    return _driven(kinds[0], evaluate, turns[fine], moves[fine] + turns[fine] * seen[0]) if fine.any() else np.zeros((2, 0))


def _seen(numbers: Complex) -> Complex:
    """From the first end: the second's pose, then the struts, whose last three entries are directions."""
    at, turn = numbers[0], numbers[1]
    rotors = np.isin((np.arange(len(numbers)) - 4) % OF_STRUT, (4, 5, 6))
    rotors[:4] = (False, True, False, True)
    seen: Complex = np.where(rotors[:, None], numbers, numbers - at)[2:] * turn.conj()
    return seen


@dataclass(frozen=True)
class _Asked:
    """round |x|^2 + <along, x> + rest = 0, for many turns; `round` is 1 or 0, <a, b> the real part of a* b."""

    round: int
    along: Complex
    rest: Reals

    def less(self, other: "_Asked") -> "_Asked":
        """The difference, which is linear."""
        return _Asked(0, self.along - other.along, self.rest - other.rest) if self.round else self


def _condition(kind: str, numbers: Complex) -> Callable[[Complex], _Asked]:
    """What a strut asks for at turns r of the second end."""
    a, own_a, own_b, b = numbers[:4]
    normal, length = 1j * numbers[6], np.abs((own_b - own_a) / numbers[4])  # a bar that does not reach is stretched, its rotor as well

    def bar(r: Complex) -> _Asked:
        gap = r * b - a
        return _Asked(1, 2 * gap, np.abs(gap) ** 2 - length**2)

    def pin_on_second(r: Complex) -> _Asked:
        return _Asked(0, -r * normal, _inner(r * normal, a) - _inner(normal, own_a))

    def pin_on_first(r: Complex) -> _Asked:
        return _Asked(0, normal + 0 * r, _inner(normal, r * b - own_b))

    return {"RR": bar, "RP": pin_on_second, "PR": pin_on_first}[kind]


def _inner(a: Complex, b: Complex) -> Reals:
    return np.real(np.conj(a) * b)


def _outer(a: Complex, b: Complex) -> Reals:
    return np.imag(np.conj(a) * b)


def _linear(conditions: Sequence[Callable[[Complex], _Asked]], r: Complex) -> tuple[Complex, Reals, _Asked]:
    """Numerator and denominator of the x that meets two conditions, and the third, that of a bar if there is one."""
    first, second, last = sorted((condition(r) for condition in conditions), key=lambda asked: asked.round)
    one, two = first.less(last), second.less(last)
    return -1j * (two.rest * one.along - one.rest * two.along), _outer(one.along, two.along), last


def _any_turn(conditions: Sequence[Callable[[Complex], _Asked]]) -> tuple[Complex, Complex]:
    """Turns and moves that meet all three conditions."""
    above, below, last = _linear(conditions, np.exp(2j * np.pi * np.arange(_SAMPLES) / _SAMPLES))
    left = last.round * np.abs(above) ** 2 + below * (_inner(last.along, above) + below * last.rest)
    waves = np.fft.fft(left) / _SAMPLES
    falling = waves[np.arange(_HARMONICS, -_HARMONICS - 1, -1)]
    found = np.roots(np.where(np.abs(falling) > _NOTHING * np.abs(falling).max(), falling, 0))
    turns = found[np.abs(np.abs(found) - 1) < _ON_CIRCLE]
    turns = turns / np.abs(turns)
    above, below, _ = _linear(conditions, turns)
    return turns, above / np.where(below == 0, np.nan, below)


def _known_turn(asked: Sequence[_Asked]) -> Complex:
    """Moves that meet two conditions at one turn."""
    line, last = sorted(asked, key=lambda one: one.round)
    line = line.less(last)
    if not last.round:
        return -1j * (last.rest * line.along - line.rest * last.along) / _outer(line.along, last.along)
    foot = -line.rest * line.along / np.abs(line.along) ** 2
    step = 1j * line.along / np.abs(line.along)
    half = _inner(step, 2 * foot + last.along) / 2
    root = np.sqrt(half**2 - np.abs(foot) ** 2 - _inner(last.along, foot) - last.rest)
    return np.concatenate([foot + step * (-half + sign * root) for sign in (1, -1)])


def _driven(kinds: str, evaluate: Evaluate, turns: Complex, at: Complex) -> Reals:
    """Angles or ways that put the second end at turns from where it is somewhere, its origin at `at`."""

    def end(first: ArrayLike, second: ArrayLike) -> Complex:
        return _seen(evaluate(_SOMEWHERE + np.broadcast_arrays(first, second, turns.real)[:2]))[:2]

    turn = np.angle(turns)
    still = end(0.0, 0.0)
    senses = [np.sign(np.angle(end(*step)[1] / still[1])) for step in ((1.0, 0.0), (0.0, 1.0))]
    if kinds == "RR":
        ahead, behind = end(0.0, senses[1] * turn)[0], end(np.pi, senses[1] * turn - senses[0] * senses[1] * np.pi)[0]
        own = np.angle((2 * at - ahead - behind) / (ahead - behind))
        found = [senses[0] * own, senses[1] * (turn - own)]
    elif kinds == "PP":
        one, two = (end(*step)[0] - still[0] for step in ((1.0, 0.0), (0.0, 1.0)))
        found = [_outer(two, at - still[0]) / _outer(two, one), _outer(one, at - still[0]) / _outer(one, two)]
    else:
        turning = kinds.index("R")
        rotated = [senses[turning] * turn if place == turning else 0 * turn for place in range(2)]
        start, further = end(*rotated)[0], end(*(rotated[place] + (place != turning) for place in range(2)))[0]
        found = [rotated[place] if place == turning else np.real((at - start) / (further - start)) for place in range(2)]
    moved: Reals = _SOMEWHERE + np.array(found)
    return moved
