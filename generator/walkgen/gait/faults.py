"""What makes a walk infeasible: each kind once for each joint, foot or body, at its worst instant, with how much."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

_WORDS = {
    "ground": "there is no ground under its foothold",
    "reach": "its foothold is out of reach by",
    "singular": "its leg is stretched or folded, where no joint moves the foot further",
    "limit": "goes beyond its limit by",
    "speed": "is faster than its maximum by",
    "margin": "the stability margin is short by",
    "through": "its foot goes through the ground, as deep as",
    "off": "its foot leaves its foothold by",
    "mass": "has no mass, or was built without com, so that nobody knows whether it stands",
    "carry": "friction cannot carry the load at its feet, which slip or lift off",
    "chains": "no best pose of the chains was found",
}


@dataclass(frozen=True)
class Fault:
    """A reason why the robot cannot walk so.

    Attributes:
        kind: ground, reach, singular, limit, speed, margin, through, off, chains, mass or carry.
        subject: joint, leg or platform.
        at: the worst instant (s).
        amount: by how much, in `unit`; NaN where the kind has no size.
        unit: m, rad, m/s or rad/s.
        share: of the walk's instants.
    """

    kind: str
    subject: str
    at: float
    amount: float
    unit: str
    share: float

    def __str__(self) -> str:
        size = "" if np.isnan(self.amount) else f" {self.amount:.4g} {self.unit}"
        return f"{self.subject}: {_WORDS[self.kind]}{size} at t = {self.at:.4g} s ({100 * self.share:.3g} % of the time)"


def worst(
    kind: str, subjects: Sequence[str], times: np.ndarray, excess: np.ndarray, unit: str | Sequence[str], slack: float
) -> Iterator[Fault]:
    """A fault for each subject whose excess [t,n] is above the slack; infinite where it has no size, NaN where there is no excess."""
    for number, subject in enumerate(subjects):
        column = np.nan_to_num(excess[:, number], nan=-np.inf, posinf=np.finfo(float).max)
        place = int(column.argmax())
        if column[place] > slack:
            amount = float(excess[place, number])
            size = amount if np.isfinite(amount) else float("nan")
            named = unit if isinstance(unit, str) else unit[number]
            yield Fault(kind, subject, float(times[place]), size, named, float((column > slack).mean()))
