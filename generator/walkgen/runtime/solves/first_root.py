"""The first root of a function from one end of an interval on, before it turns round: the reference of walkgen_first_root.h."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.signature import STATUSES

Reals = NDArray[np.float64]
Integers = NDArray[np.int32]
Truths = NDArray[np.bool_]
Callback = tuple[Any, ...]

_OK, _UNREACHABLE, _BAD_INPUT, _SINGULAR, _NO_CONVERGENCE = (
    STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR", "NO_CONVERGENCE")
)
_NOTHING, _TURNS = 1e-12, 120
_EPSILON = float(np.finfo(float).eps)


def first_root(z: ArrayLike, bounds: ArrayLike, callback: Callback) -> tuple[Reals, Integers]:
    """The first root from the lower bound on, before the function turns round: Newton's method inside a bracket.

    Args:
        z: what is given besides the unknown [..., k].
        bounds: of the unknown [..., 2].
        callback: the function of points [..., 1 + k], the unknown first, that gives its value, its slope by the unknown and the size of
            what it is a sum of [..., 3]; and what it takes after the point.

    Returns:
        The root [...], NaN unless the status [...] is OK. UNREACHABLE where the function leads away from 0 at the start, or is not 0 before
        the end; SINGULAR where it turns round before 0; NO_CONVERGENCE; BAD_INPUT where something is not finite or bounds are crossed.
    """
    function, *data = callback
    given = [np.asarray(item, float) for item in (z, bounds, *data)]
    shape = np.broadcast_shapes(*(item.shape[:-1] for item in given))
    known, ends, *rest = (np.broadcast_to(item, (*shape, item.shape[-1])).reshape(-1, item.shape[-1]) for item in given)
    with np.errstate(all="ignore"):
        found = _Search(function, known, rest).solved(ends[:, 0].copy(), ends[:, 1].copy())
    root = np.where(found.status == _OK, found.root, np.nan)
    return root.reshape(shape), found.status.reshape(shape)


class _Places(NamedTuple):
    """Values and slopes at places, whether they lie before the root, tend to 0, are nothing."""

    at: Reals
    value: Reals
    slope: Reals
    ahead: Truths
    falling: Truths
    close: Truths

    def where(self, truth: Truths, other: "_Places") -> "_Places":
        """Own entries where the truth holds."""
        return _Places(*(np.where(truth, mine, others) for mine, others in zip(self, other, strict=True)))


class _Found(NamedTuple):
    root: Reals
    status: Integers


class _Search:
    """All rows at once; each stays as it is once it is settled."""

    def __init__(self, function: Callable[..., Reals], z: Reals, data: list[Reals]) -> None:
        self._function, self._z, self._data = function, z, data
        self._sign = np.ones(len(z))

    def _at(self, places: Reals) -> _Places:
        found = np.asarray(self._function(np.concatenate([places[:, None], self._z], -1), *self._data))
        value, slope, size = np.broadcast_to(found, (len(places), 3)).T
        return _Places(places, value, slope, self._sign * value > 0.0, self._sign * slope < 0.0, np.abs(value) <= _NOTHING * size)

    def solved(self, low: Reals, high: Reals) -> _Found:
        """Roots and statuses."""
        start = self._at(low)
        width = high - low
        bad = ~((width > 0.0) & (width < np.inf) & np.isfinite(start.value) & np.isfinite(start.slope))
        self._sign = np.where(start.value > 0.0, 1.0, -1.0)
        falling = self._sign * start.slope < 0.0
        here = start._replace(ahead=np.ones(len(low), bool), falling=falling)
        status = np.where(bad, _BAD_INPUT, np.where(start.close, _OK, _UNREACHABLE)).astype(np.int32)
        open_ = ~bad & ~start.close & (falling | (start.slope == 0.0))
        status[open_] = _NO_CONVERGENCE
        return self._narrowed(here, high, open_, _Found(low.copy(), status))

    def _narrowed(self, here: _Places, high: Reals, going: Truths, found: _Found) -> _Found:
        low = here.at.copy()
        least = 4.0 * _EPSILON * (np.abs(low) + np.abs(high))
        before, behind, crossed = low.copy(), high.copy(), np.zeros(len(low), bool)
        root, status = found
        for turn in range(_TURNS):
            if not going.any():
                break
            step = here.value / here.slope
            newton = here.at - step
            there = going & (np.abs(step) <= least) & (here.falling | here.close) & (turn > 0)
            root[there], status[there] = np.clip(newton, low, high)[there], _OK
            shut = going & ~there & (behind - before <= least)
            root[shut] = here.at[shut]
            status[shut] = np.where(crossed | here.close, _OK, np.where(here.at > low, _SINGULAR, _UNREACHABLE))[shut]
            going = going & ~there & ~shut
            beyond = ~crossed & (behind == high) & (newton >= high)
            inside = (turn % 8 != 7) & (newton > before) & (newton < behind)
            place = np.where(beyond, high, np.where(inside, newton, 0.5 * (before + behind)))
            here = self._at(np.where(going, place, here.at)).where(going, here)
            on = going & here.ahead & here.falling
            ended = on & ~(place < high)
            root[ended], status[ended] = high[ended], np.where(here.close, _OK, _UNREACHABLE)[ended]
            going = going & ~ended
            back = going & ~on
            before, behind = np.where(on, place, before), np.where(back, place, behind)
            crossed = np.where(back, ~here.ahead, crossed)
        return _Found(root, status)
