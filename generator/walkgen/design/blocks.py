"""Problems that fall apart: variables that no residual and no constraint joins are looked for by themselves."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from walkgen.design.problem import Constraint, Objective, Problem, Reals, Values

_SAMPLES = 3
"""Random places at which slopes are looked at."""
Numbers = NDArray[np.int_]


def blocks_of(problem: Problem, seed: int) -> list[Problem]:
    """Smaller problems whose answers together are the whole one's; each holds the other variables at their start."""
    joined = np.zeros((len(problem.variables),) * 2, dtype=bool)
    generator = np.random.default_rng(seed)
    residuals, margins = [], []
    for _ in range(_SAMPLES):
        x = generator.uniform(problem.low, problem.high)
        residuals.append(problem.residuals(x).slopes != 0)
        margins.append(problem.margins(x).slopes != 0)
    used = [np.any(parts, axis=0) for parts in (residuals, margins)]
    for rows in used:
        joined |= rows.T @ rows
    groups = list(_components(joined))
    return [problem] if len(groups) == 1 else [_part(problem, group, *(rows[:, group].any(1) for rows in used)) for group in groups]


def _components(joined: NDArray[np.bool_]) -> Iterator[Numbers]:
    """Of a graph, by its matrix: numbers of the variables that hang together."""
    left = set(range(len(joined)))
    while left:
        found, frontier = set[int](), {min(left)}
        while frontier:
            found |= frontier
            frontier = {int(other) for one in frontier for other in np.flatnonzero(joined[one])} - found
        left -= found
        yield np.array(sorted(found))


def _part(problem: Problem, group: Numbers, residuals: NDArray[np.bool_], margins: NDArray[np.bool_]) -> Problem:
    def whole(x: Reals) -> Reals:
        full = problem.start
        full[group] = x
        return full

    def own_residuals(x: Reals) -> Values:
        found = problem.residuals(whole(x))
        return Values(found.values[residuals], found.slopes[residuals][:, group])

    def own_margins(x: Reals) -> Values:
        found = problem.margins(whole(x))
        return Values(found.values[margins], found.slopes[margins][:, group])

    variables = tuple(problem.variables[number] for number in group)
    return Problem(variables, (Objective("part", own_residuals),), (Constraint("part", own_margins),))
