"""From a spec to the cam of one of its balances."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from walkgen.design.apart import check_apart
from walkgen.design.balance import Balance, Residue
from walkgen.design.cam import Profile, profile, residual
from walkgen.design.cam_problem import CamProblem
from walkgen.design.multistart import Progress, solved
from walkgen.errors import Problem, SpecError
from walkgen.model.cam_potential import Cam, CamError, OnFrame, OnLink, Pull, Weight
from walkgen.model.cams import cam_problem, placed
from walkgen.model.walk import number
from walkgen.spec.schema import RobotSpec

_DIGITS = 9
"""Of the values that are written: what is told is what these give."""


@dataclass(frozen=True)
class CamDesigned:
    """A cam, and the moment of its joint without it and with it, cut through the profile's points (tangents by differences).

    Attributes:
        balance: of the spec.
        values: of every parameter that changes.
        before: moments without the cam.
        after: with the one that was found.
        cam: its potential.
        profile: its shape.
        given: the shape of the spec's own, where there is one and another was looked for.
    """

    module_prefix: ClassVar[str] = ""
    """Of the modules that report and draw it."""

    balance: Balance
    values: dict[str, float]
    before: tuple[Residue, ...]
    after: tuple[Residue, ...]
    cam: Cam
    profile: Profile
    given: Profile | None


def cam_designed(spec: RobotSpec, name: str, path: Path, starts: int, seed: int, progress: Progress) -> CamDesigned:
    """The cam of a balance whose device is one, searched for where parameters may vary.

    Raises:
        SpecError: it loses contact or is undercut, its spring would have to push, the joint is not level, or no cam within bounds suits.
    """
    progress("cam")
    balance = Balance(spec, name, path.parent)
    check_apart(balance)
    if not balance.names:
        return _made(balance, balance, {}, None)
    try:
        given = _cut(balance)[1]
    except CamError:
        given = None
    values = _found(balance, starts, seed, progress)
    return _made(balance, Balance(spec, name, path.parent, values), values, given)


def _found(balance: Balance, starts: int, seed: int, progress: Progress) -> dict[str, float]:
    try:
        wanted = CamProblem(balance)
    except CamError as error:
        raise SpecError(cam_problem(error, balance.name, balance.ranges[0].name)) from None
    found = solved(wanted.problem, starts, seed, progress)
    if not found.feasible:
        message = f"balance {balance.name}: no cam within the bounds of its parameters suits; the nearest one {wanted.unsuited(found.x)}"
        raise SpecError(Problem("WG227", message, "widen the bounds or most_pressure_deg, or narrow the range"))
    return {key: float(f"{value:.{_DIGITS}g}") for key, value in zip(balance.names, found.x, strict=True)}


def _made(spec: Balance, balance: Balance, values: dict[str, float], given: Profile | None) -> CamDesigned:
    (span,) = balance.ranges
    try:
        potential, found = _cut(balance)
    except CamError as error:
        raise SpecError(cam_problem(error, balance.name, span.name)) from None
    after = Residue(span, found.phi, residual(potential, found), np.zeros(len(found.phi)))
    return CamDesigned(spec, values, balance.bare, (after,), potential, found, given)


def _cut(balance: Balance) -> tuple[Cam, Profile]:
    table, (span,), (cam,) = balance.table.cam, balance.ranges, balance.leg.cams
    assert table is not None
    phi = np.linspace(span.low, span.high, table.points)
    potential = in_doubles(placed(balance.mechanism, balance.leg, cam).potential)
    sizes = (float(number(each, balance.mechanism)) for each in (cam.start, cam.roller, cam.spring.free_length))
    return potential, profile(potential, phi, *sizes)


def in_doubles(cam: Cam) -> Cam:
    """The same with doubles for numbers."""
    made: Cam = _in_doubles(cam)
    return made


def _in_doubles(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(map(_in_doubles, value))
    if isinstance(value, OnLink | OnFrame | Weight | Pull):
        return type(value)(*(_in_doubles(getattr(value, field.name)) for field in fields(value)))
    return float(value)
