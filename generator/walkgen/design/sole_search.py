"""From a spec to a sole: the design with the least weighted objectives, and the front between the best of each."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from walkgen.design.multistart import Found, Progress, solved
from walkgen.design.problem import Reals
from walkgen.design.sole_problem import PEAKS, SoleProblem
from walkgen.design.sole_roll import Course, SoleRoll
from walkgen.errors import Problem, SpecError
from walkgen.spec.problems import did_you_mean, shown
from walkgen.spec.read import read
from walkgen.spec.schema import RobotSpec

DENSE = 201
"""Instants at which results are judged."""
_DIGITS = 9
_BEYOND = 1e-6


@dataclass(frozen=True)
class SolePoint:
    """A design: the parameters' values, and its roll at many instants."""

    x: Reals
    course: Course

    def peak(self, objective: str) -> float:
        """rad/s^2 or N m."""
        return self.course.peak(PEAKS[objective])


@dataclass(frozen=True)
class SoleDesigned:
    """A sole with the values that were found.

    Attributes:
        roll: of the spec.
        given: with the spec's own values.
        found: with those that weigh least.
        front: designs of which none is better in both objectives, the least acceleration first.
    """

    module_prefix: ClassVar[str] = "sole_"
    """Of the modules that report and draw it."""

    roll: SoleRoll
    given: SolePoint
    found: SolePoint
    front: tuple[SolePoint, ...]

    @property
    def values(self) -> dict[str, float]:
        """Of every parameter that changes."""
        return dict(zip(self.roll.names, map(float, self.found.x), strict=True))


def sole_designed(
    path: Path, name: str = "", starts: int | None = None, seed: int = 0, progress: Progress = lambda _: None
) -> SoleDesigned:
    """Search the sole of a spec's design.

    Args:
        path: of the spec.
        name: of the design; its only one where left out.
        starts: random starts, instead of the table's number.
        seed: of these.
        progress: is told what is being done.

    Raises:
        SpecError: the spec is not a robot, has no such design, or no values within the bounds keep its limits.
    """
    progress("read")
    spec = read(path)
    roll = SoleRoll(spec, _chosen(spec, name, path), path.parent)
    return _Search(roll, roll.table.starts if starts is None else starts, seed, progress).designed()


def _chosen(spec: RobotSpec, name: str, path: Path) -> str:
    known = spec.sole_design
    if not known:
        raise SpecError(Problem("WG237", f"{path} has no [sole_design.NAME]", "add one: leg, hip, velocity, duration, thigh_deg, load"))
    if name and name not in known:
        raise SpecError(Problem("WG237", f'there is no design of a sole "{shown(name)}"', did_you_mean(name, known, "known designs")))
    if not name and len(known) > 1:
        raise SpecError(Problem("WG237", f"{path} has several designs of soles", f"choose one: --sole {next(iter(known))}"))
    return name or next(iter(known))


class _Search:
    """Of one roll."""

    def __init__(self, roll: SoleRoll, starts: int, seed: int, progress: Progress) -> None:
        self._roll, self._problem = roll, SoleProblem(roll)
        self._starts, self._seed, self._progress = starts, seed, progress

    def designed(self) -> SoleDesigned:
        """The front first: its best point is a start for the weighted sum."""
        weights = {name: self._roll.weight(name, usual) for name, usual in zip(PEAKS, (1.0, 0.0), strict=True)}
        front = self._front()
        sizes = self._problem.sizes()
        start = min(front, key=lambda point: sum(weights[name] * (point.peak(name) / sizes[name]) ** 2 for name in PEAKS))
        found = self._point(self._best(weights, start=start.x, starts=0))
        return SoleDesigned(self._roll, self._point_at(self._problem.start()), found, _undominated([*front, found]))

    def _front(self) -> list[SolePoint]:
        """Ends by each objective alone, between them the least acceleration for a moment that is bounded in even steps."""
        calm = self._point(self._best({"acceleration": 1.0, "moment": 0.0}))
        light = self._point(self._best({"acceleration": 0.0, "moment": 1.0}))  # not from the calm one, which lies in a corner of the bounds
        points, near = [calm], calm.x
        most, least = calm.peak("moment"), light.peak("moment")
        for number in range(1, self._roll.table.front - 1):
            bound = most + (least - most) * number / (self._roll.table.front - 1)
            self._progress(f"front, moment at most {bound:.4g} N m")
            found = self._best({"acceleration": 1.0, "moment": 0.0}, {"moment": bound}, near, starts=1)
            near = found.x[: self._problem.count]
            points.append(self._point(found))
        bound = least * (1.0 + _BEYOND)
        points.append(self._point(self._best({"acceleration": 1.0, "moment": 0.0}, {"moment": bound}, light.x, starts=0)))
        return points

    def _best(
        self, weights: dict[str, float], most: dict[str, float] | None = None, start: Reals | None = None, starts: int | None = None
    ) -> Found:
        problem = self._problem.problem(weights, most, start)
        found = solved(problem, self._starts if starts is None else starts, self._seed, self._progress)
        if not found.feasible:
            x = found.x
            broken = max(problem.constraints, key=lambda each: -float(np.min(np.nan_to_num(each.margins(x).values, nan=-np.inf))))
            message = f"sole {self._roll.name}: no values within the bounds keep its limits; of the nearest ones {broken.name} is broken"
            raise SpecError(Problem("WG238", message, "widen the bounds of parameters or the limits, or let the roll take more time"))
        return found

    def _point(self, found: Found) -> SolePoint:
        """What is written and told, in as many digits as are written."""
        problem = self._problem.problem({"acceleration": 1.0, "moment": 1.0})
        count = self._problem.count
        x = np.clip(found.x[:count], problem.low[:count], problem.high[:count])
        return self._point_at(np.array([float(f"{value:.{_DIGITS}g}") for value in x]))

    def _point_at(self, x: Reals) -> SolePoint:
        return SolePoint(x, self._roll.at(x, DENSE))


def _undominated(points: list[SolePoint]) -> tuple[SolePoint, ...]:
    """In order of the acceleration."""
    ordered = sorted(points, key=lambda point: tuple(point.peak(name) for name in PEAKS))
    kept: list[SolePoint] = []
    for point in ordered:
        if not kept or point.peak("moment") < kept[-1].peak("moment") * (1.0 - _BEYOND):
            kept.append(point)
    return tuple(kept)
