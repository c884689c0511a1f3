"""A walk as a table: comma-separated values, one row an instant, columns named with their units."""

import csv
import io
from collections.abc import Iterator, Sequence

import numpy as np

from walkgen.gait.walk import Walk

_DIGITS = "%.9g"


def table(walk: Walk, units: Sequence[str] = ()) -> str:
    """Time, base, feet with their states, joints with their rates and accelerations, centre of mass, margin and power.

    Args:
        walk: simulated.
        units: of the joints, rad or m; rad where left out.
    """
    columns = list(_columns(walk, units or ("rad",) * len(walk.joints)))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(name for name, _ in columns)
    rows = np.column_stack([values for _, values in columns])
    writer.writerows([_DIGITS % value for value in row] for row in rows.tolist())
    return text.getvalue()


def _columns(walk: Walk, units: Sequence[str]) -> Iterator[tuple[str, np.ndarray]]:
    yield "t (s)", walk.times
    yield from _vectors("base", walk.base_pose[:, :3, 3])
    for row in range(3):
        for column in range(3):
            yield f"base_r{row + 1}{column + 1} (1)", walk.base_pose[:, row, column]
    for foot, leg in enumerate(walk.legs):
        yield f"{leg}_stance (1)", walk.stance[:, foot].astype(float)
        yield from _vectors(f"{leg}_foot", walk.feet[:, foot])
        yield f"{leg}_status (1)", walk.statuses[:, foot].astype(float)
    for kind, values, suffix in (("q", walk.q, ""), ("qd", walk.qd, "/s"), ("qdd", walk.qdd, "/s^2")):
        for number, (joint, unit) in enumerate(zip(walk.joints, units, strict=True)):
            yield f"{kind}_{joint} ({unit}{suffix})", values[:, number]
    yield from _vectors("com", walk.com)
    yield "static_margin (m)", walk.margins.static
    yield "dynamic_margin (m)", walk.margins.dynamic
    yield "longitudinal_margin_ahead (m)", walk.margins.longitudinal[:, 0]
    yield "longitudinal_margin_back (m)", walk.margins.longitudinal[:, 1]
    yield "energy_height (m)", walk.margins.height
    if walk.power is not None:
        parts = {"weight": walk.power.weight, "inertia": walk.power.inertia, "friction": walk.power.friction}
        yield from ((f"power_{name} (W)", part.sum(axis=1)) for name, part in parts.items())


def _vectors(name: str, values: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    yield from ((f"{name}_{axis} (m)", values[:, number]) for number, axis in enumerate("xyz"))
