"""A sole's design, as a table for people."""

from collections.abc import Iterator

import numpy as np

from walkgen.design.sole_problem import PEAKS, UNITS
from walkgen.design.sole_search import SoleDesigned, SolePoint

_PEAKS = (
    ("foot acceleration", "foot_acceleration", "rad/s^2"),
    ("foot rate", "foot_rate", "rad/s"),
    ("hip moment", "hip_moment", "N m"),
    ("knee moment", "knee_moment", "N m"),
    ("ankle moment", "ankle_moment", "N m"),
)


def sole_report(found: SoleDesigned) -> str:
    """Values of the parameters, largest values before and after, the front."""
    return "\n".join(["found:", *_values(found), "largest, over the roll:", *_peaks(found), "front:", *_front(found)])


def _values(found: SoleDesigned) -> Iterator[str]:
    for name, value in found.values.items():
        unit = found.roll.spec.parameters[name].unit
        yield f"  {name} = {value:.9g}{'' if unit == '1' else ' ' + unit}"


def _peaks(found: SoleDesigned) -> Iterator[str]:
    yield f"  {'':22}{'as in the spec':>20}{'found':>16}"
    for words, quantity, unit in _PEAKS:
        yield f"  {words:22}" + "".join(f"{point.course.peak(quantity):>16.5g}" for point in (found.given, found.found)) + f" {unit}"
    ends = [np.rad2deg(point.course.of("foot_angle").values[-1]) for point in (found.given, found.found)]
    yield f"  {'foot angle at the end':22}" + "".join(f"{end:>16.5g}" for end in ends) + " degrees"


def _front(found: SoleDesigned) -> Iterator[str]:
    yield "  " + "".join(f"{f'{name} ({UNITS[name]})':>24}" for name in PEAKS) + "  " + ", ".join(found.roll.names)
    yield from (_row(point) for point in found.front)


def _row(point: SolePoint) -> str:
    return "  " + "".join(f"{point.peak(name):>24.5g}" for name in PEAKS) + "  " + ", ".join(f"{value:.5g}" for value in point.x)
