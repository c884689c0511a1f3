"""Inverse problems that solvers of all kinds are given: targets that forward kinematics made, seeds, and how an answer is judged."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chains import Array, Chain, read_chain

ROOT = Path(__file__).parents[1]
SPEC = Path(__file__).parent / "specs" / "inverse.toml"
SEED = 20240301
REACHED, CLOSE = 1e-9, 1e-3
"""m and rad: a foot this near counts as there; as there for those who stop early."""
_SAME = 1e-6
_NEAR = 0.1
"""rad; a tenth of it, in m, for slides: how far a near seed lies from the joint values that made the target, at most, in each joint."""


@dataclass(frozen=True)
class Problem:
    """Targets of one leg or arm.

    Attributes:
        name: For the results.
        title: For the table.
        robot: The spec's robot and leg names.
        q: Joint values that made the targets [rows,n].
        near: Seeds close to them [rows,n].
        random: Seeds anywhere [rows,n].
        posed: Whether a target is a whole pose [16], row-major, or the foot's position [3].
    """

    name: str
    title: str
    spec: Path
    leg: str
    chain: Chain
    q: Array
    near: Array
    random: Array
    posed: bool

    @cached_property
    def poses(self) -> Array:
        """Where the foot has to go [rows,4,4]."""
        return self.chain.foot(self.q)

    @cached_property
    def targets(self) -> Array:
        """What solvers are given [rows,3] or [rows,16]."""
        return self.poses.reshape(-1, 16) if self.posed else self.poses[:, :3, 3].copy()

    def seeds(self, kind: str) -> Array:
        """`near` or `random` [rows,n]."""
        return {"near": self.near, "random": self.random}[kind]

    def inputs(self, kind: str) -> Array:
        """Target and seed in one row [rows, 3 + n or 16 + n]: what compiled solvers read."""
        return np.hstack([self.targets, self.seeds(kind or "near")])

    def judge(self, answers: Array) -> "Verdict":
        """How good the answers [rows,slots,n] to the first targets are; NaN where a solver gives none."""
        given = np.isfinite(answers).all(axis=2)
        error = np.where(given, self._error(answers), np.nan)
        right = given & (np.nan_to_num(error, nan=np.inf) <= REACHED)
        best = np.min(np.where(right, error, np.inf), axis=1)
        close = given & (np.nan_to_num(error, nan=np.inf) <= CLOSE)
        mine = right & self._same(answers, self.q[: len(answers), None])
        distinct = right & ~_repeats(self._same, answers, right)
        return Verdict(
            reached=float(np.mean(right.any(axis=1))),
            close=float(np.mean(close.any(axis=1))),
            wrong=float(np.mean((given & ~close).any(axis=1))),
            found=float(np.mean(mine.any(axis=1))),
            branches=float(np.mean(distinct.sum(axis=1))),
            error=float(np.max(best[np.isfinite(best)], initial=0.0)),
        )

    def _error(self, answers: Array) -> Array:
        """Distance of the feet from their targets, and for poses of their rotations as well [rows,slots]."""
        rows, slots, joints = answers.shape
        feet = self.chain.foot(answers.reshape(-1, joints)).reshape(rows, slots, 4, 4)
        missing = feet - self.poses[:rows, None]
        shift = np.linalg.norm(missing[..., :3, 3], axis=-1)
        return np.maximum(shift, np.linalg.norm(missing[..., :3, :3], axis=(-2, -1)) / np.sqrt(2)) if self.posed else shift

    def _same(self, one: Array, other: Array) -> NDArray[np.bool_]:
        """Equal joint values, turns apart."""
        turning = np.array([kind == "R" for kind in self.chain.kinds])
        difference = one - other
        wrapped = np.where(turning, np.mod(difference + np.pi, 2 * np.pi) - np.pi, difference)
        return np.asarray((np.abs(wrapped) < _SAME).all(axis=-1))


def _repeats(same: Callable[[Array, Array], NDArray[np.bool_]], answers: Array, right: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which slots repeat an earlier one that is right [rows,slots]."""
    found = np.zeros(right.shape, bool)
    for slot in range(1, right.shape[1]):
        for earlier in range(slot):
            found[:, slot] |= right[:, earlier] & same(answers[:, slot], answers[:, earlier])
    return found


@dataclass(frozen=True)
class Verdict:
    """Of the answers that a solver calls solutions.

    Attributes:
        reached: Share of the targets with an answer within 1e-9.
        close: Share with an answer within 1e-3.
        wrong: Share with an answer further off.
        found: Share where the joint values that made the target are among the right answers.
        branches: Distinct right answers a target, the mean.
        error: The largest distance of a target from its best right answer (m, rad).
    """

    reached: float
    close: float
    wrong: float
    found: float
    branches: float
    error: float


def _problem(name: str, title: str, spec: Path, leg: str, rows: int, *, posed: bool = False) -> Problem:
    """Joint values over the full turn, slides over their limits; the same for every run of the same size."""
    chain, random = read_chain(spec, leg), np.random.default_rng(SEED)
    turning = np.array([kind == "R" for kind in chain.kinds])
    low, high = np.where(turning, ((-np.pi,), (np.pi,)), np.array(chain.limits).T)
    q, away = random.uniform(low, high, (rows, len(turning))), random.uniform(-1, 1, (rows, len(turning)))
    near = q + away * np.where(turning, _NEAR, _NEAR / 10)
    return Problem(name, title, spec, leg, chain, q, near, random.uniform(low, high, q.shape), posed)


def problems(rows: int) -> tuple[Problem, ...]:
    """The Fig. 7 leg, two legs of no special class, an arm."""
    return (
        _problem("fig7", "Fig. 7 leg, foot position", ROOT / "specs" / "mero_leg.toml", "leg", rows),
        _problem("skew", "Skew 3R leg, foot position", SPEC, "skew", rows),
        _problem("rrp", "Skew RRP leg, foot position", SPEC, "rrp", rows),
        _problem("arm", "6R arm (UR5), foot pose", SPEC, "arm", rows, posed=True),
    )
