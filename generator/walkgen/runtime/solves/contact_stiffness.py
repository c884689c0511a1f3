"""How a load spreads over feet on elastic legs; the reference of walkgen_contact_stiffness.h (theory 4.3).

All of a stance's unknowns, forces and the platform's motion, stand in one linear system a Newton step.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.runtime.solves.contact_carried import carried_lack
from walkgen.runtime.solves.contact_elastic import Stand, read_stand
from walkgen.runtime.solves.rows import Integers, Reals

OK, BAD_INPUT, SINGULAR, NO_CONVERGENCE, INFEASIBLE = 0, 2, 3, 4, 5
STICK, SLIDE, FREE = range(3)
_STEPS = 40
_FAIR, _CLOSE = 1e-9, 1e-12
_SPRING = 1e-2
Answer = tuple[Reals, Integers, Integers, Reals, Reals]
_Row = tuple[Reals, int, Integers, Reals, float]


def contact_stiffness(
    points: ArrayLike,
    normals: ArrayLike,
    mu: ArrayLike,
    wrench: ArrayLike,
    compliance: ArrayLike,
    misfit: ArrayLike,
) -> Answer:
    """Forces of the ground on feet that may lift off and slide.

    Args:
        points: of 1 to 16 feet [..., k, 3] m.
        normals: [..., k, 3], unit, out of the ground.
        mu: [..., k], may be infinite.
        wrench: [..., 6] load on the robot: force, moment about the frame's origin.
        compliance: [..., k, 3, k, 3] m/N, positive.
        misfit: [..., k, 3] m, how far unloaded feet are off.

    Returns:
        f [..., k, 3], status [...], state [..., k] (0 stick, 1 slide, 2 free), displacement [..., 6] of the first platform (of the
        frame's origin, rotation), violation [...] (N). Without an answer f is NaN.
    """
    inputs = [np.asarray(value, dtype=float) for value in (points, normals, mu, wrench, compliance, misfit)]
    ranks, k = (2, 2, 1, 1, 4, 2), inputs[0].shape[-2]
    lead = np.broadcast_shapes(*(value.shape[: value.ndim - rank] for value, rank in zip(inputs, ranks, strict=True)))
    given = [np.broadcast_to(value, lead + value.shape[value.ndim - rank :]) for value, rank in zip(inputs, ranks, strict=True)]
    f, displacement, violation = np.full((*lead, k, 3), np.nan), np.full((*lead, 6), np.nan), np.full(lead, np.nan)
    status, state = np.full(lead, BAD_INPUT, np.int32), np.full((*lead, k), FREE, np.int32)
    for row in np.ndindex(lead):
        f[row], status[row], state[row], displacement[row], violation[row] = _one(k, *(value[row] for value in given))
    return f, status[()], state, displacement, violation[()]


def contact_stiffness_blocks(
    points: ArrayLike,
    normals: ArrayLike,
    mu: ArrayLike,
    wrench: ArrayLike,
    compliance: ArrayLike,
    misfit: ArrayLike,
) -> Answer:
    """The same for the compliances [..., k, 3, 3] of legs that share no link."""
    blocks = np.asarray(compliance, dtype=float)
    k = blocks.shape[-3]
    whole = np.zeros((*blocks.shape[:-3], k, 3, k, 3))
    for foot in range(k):
        whole[..., foot, :, foot, :] = blocks[..., foot, :, :]
    return contact_stiffness(points, normals, mu, wrench, whole, misfit)


def _one(k: int, points: Reals, normals: Reals, mu: Reals, wrench: Reals, compliance: Reals, misfit: Reals) -> _Row:
    """One stance."""
    stand = read_stand(points, normals, mu, wrench, compliance.reshape(3 * k, 3 * k), misfit)
    if stand is None:
        return _none(k, BAD_INPUT, np.nan)
    if np.linalg.matrix_rank(stand.grasp, tol=1e-5) < 6:
        return _none(k, SINGULAR, np.nan)
    bonded = _solve(stand, np.full(k, STICK, np.int32), _at_rest(stand), 0.0)
    assert bonded is not None
    found, lack = _search(stand, bonded)
    if found is None:
        return _none(k, INFEASIBLE if lack else NO_CONVERGENCE, lack * stand.force)
    f = found.f - found.off
    worst = max(np.sqrt(found.merit), float(np.max(np.abs(stand.grasp @ f.ravel() + stand.w))))
    assert worst <= _FAIR
    return stand.force * f, OK, found.state, stand.motion(found.delta), worst * stand.force


def _none(k: int, status: int, violation: float) -> _Row:
    return np.full((k, 3), np.nan), status, np.full(k, FREE, np.int32), np.full(6, np.nan), violation


@dataclass(frozen=True)
class _Trial:
    """A stand that may not hold yet: forces [k, 3], motion [6], states [k], what forces lack [k, 3]; `pushing` is along the slide."""

    f: Reals
    delta: Reals
    state: Integers
    off: Reals
    pushing: Reals
    merit: float
    rho: Reals


def _at_rest(stand: Stand) -> _Trial:
    k = len(stand.n)
    blank = np.zeros((k, 3))
    return _Trial(blank, np.zeros(6), np.full(k, STICK, np.int32), blank, blank, np.inf, np.ones(k))


def _search(stand: Stand, bonded: tuple[Reals, Reals]) -> tuple[_Trial | None, float]:
    """Newton's method from feet that stick, then with springs that hold the platform and are softened."""
    diagonal = np.diag(stand.C).reshape(-1, 3).sum(axis=1)
    for factor in (1.0, 0.1, 10.0):
        trial, found = _newton(stand, _judged(stand, *bonded, 3.0 * factor / diagonal, 0.0), 0.0)
        if found:
            return trial, 0.0
        if factor == 1.0 and (lack := carried_lack(stand)) > 0.0:
            return None, lack
    for factor in (1.0, 0.1, 10.0):
        trial = _judged(stand, *bonded, 3.0 * factor / diagonal, 1.0)
        for hold in 0.25 ** np.arange(9):
            trial, _ = _newton(stand, _judged(stand, trial.f, trial.delta, trial.rho, hold), hold)
        trial, found = _newton(stand, _judged(stand, trial.f, trial.delta, trial.rho, 0.0), 0.0)
        if found:
            return trial, 0.0
    return None, 0.0


def _judged(stand: Stand, f: Reals, delta: Reals, rho: Reals, hold: float) -> _Trial:
    """States read off forces less rho times displacements (Alart and Curnier 1991), and what is missing."""
    n = stand.n
    pull = f - rho[:, None] * stand.displaced(f, delta)
    pressing = np.sum(n * pull, axis=1)
    across = pull - pressing[:, None] * n
    size, most = np.linalg.norm(across, axis=1), np.where(pressing > 0.0, stand.mu, 0.0) * np.maximum(pressing, 0.0)
    state = np.where(pressing > 0.0, np.where(size <= most, STICK, SLIDE), FREE).astype(np.int32)
    cut = np.where(state == SLIDE, most / np.where(size > 0.0, size, 1.0), 1.0)
    into = np.where((state == FREE)[:, None], 0.0, pressing[:, None] * n + cut[:, None] * across)
    lacking = stand.grasp @ f.ravel() + stand.w - hold * delta
    merit = float(np.sum((f - into) ** 2) + lacking @ lacking)
    return _Trial(f, delta, state, f - into, across, merit, rho)


def _newton(stand: Stand, trial: _Trial, hold: float) -> tuple[_Trial, bool]:
    """Newton's steps, halved where they do not help, two of three such taken whole."""
    for turn in range(_STEPS):
        if trial.merit <= _CLOSE**2:
            return trial, True
        step = _solve(stand, trial.state, trial, hold)
        if step is None:
            return trial, False
        ways = [_between(stand, trial, step, 0.5**cut, hold) for cut in range(6)]
        helping = [way for cut, way in enumerate(ways) if way.merit < (1.0 - 2e-3 * 0.5**cut) * trial.merit]
        trial = helping[0] if helping else ways[0 if turn % 3 else -1]
    return trial, False


def _between(stand: Stand, trial: _Trial, step: tuple[Reals, Reals], share: float, hold: float) -> _Trial:
    f, delta = trial.f + share * (step[0] - trial.f), trial.delta + share * (step[1] - trial.delta)
    return _judged(stand, f, delta, trial.rho, hold)


def _solve(stand: Stand, state: Integers, trial: _Trial, hold: float) -> tuple[Reals, Reals] | None:
    """Forces and motion that all feet's linear conditions P f + Q u = 0 and the balance make; springs where they leave a motion free."""
    k = len(stand.n)
    P, Q = np.zeros((3 * k, 3 * k)), np.zeros((3 * k, 3 * k))
    for foot in range(k):
        part = slice(3 * foot, 3 * foot + 3)
        P[part, part], Q[part, part] = _condition(stand, state[foot], trial, foot)
    rows = P + Q @ stand.C
    right = np.concatenate([-Q @ stand.e.ravel(), -stand.w])
    for more in (0.0, _SPRING):
        system = np.block([[rows, Q @ stand.grasp.T], [stand.grasp, -(hold + more) * np.eye(6)]])
        if np.linalg.cond(system) < 1e12:
            found = np.linalg.solve(system, right)
            return found[: 3 * k].reshape(k, 3), found[3 * k :]
    return None


def _condition(stand: Stand, state: int, trial: _Trial, foot: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """P and Q of a foot: no force, no displacement, or none along the normal and friction against what is pushed across it."""
    if state != SLIDE:
        return np.eye(3) * (state == FREE), np.eye(3) * (state == STICK)
    n, mu, size = stand.n[foot], stand.mu[foot], float(np.linalg.norm(trial.pushing[foot]))
    t, flat = trial.pushing[foot] / size, np.eye(3) - np.outer(n, n)
    across = flat - np.outer(t, t)
    share = min(mu * max(float(n @ trial.f[foot]), 0.0) / size, 1.0)
    return flat - share * across - mu * np.outer(t, n), np.outer(n, n) + share * trial.rho[foot] * across
