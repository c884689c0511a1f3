"""From a spec to the cam of one of its balances."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from walkgen.design.apart import check_apart
from walkgen.design.balance import Balance, Residue
from walkgen.design.cam import Profile, profile, residual
from walkgen.design.multistart import Progress
from walkgen.errors import SpecError
from walkgen.model.cam_potential import Cam, CamError, OnFrame, OnLink, Pull, Weight
from walkgen.model.cams import cam_problem, placed
from walkgen.model.walk import number
from walkgen.spec.schema import RobotSpec


@dataclass(frozen=True)
class CamDesigned:
    """A cam, and the moment of its joint without it and with it, cut through the profile's points (tangents by differences)."""

    balance: Balance
    values: dict[str, float]
    before: tuple[Residue, ...]
    after: tuple[Residue, ...]
    cam: Cam
    profile: Profile


def cam_designed(spec: RobotSpec, name: str, path: Path, progress: Progress) -> CamDesigned:
    """The cam of a balance whose device is one.

    Raises:
        SpecError: it loses contact or is undercut, its spring would have to push, or the joint is not level.
    """
    progress("cam")
    balance = Balance(spec, name, path.parent)
    check_apart(balance)
    (span,), (bare,), (cam,) = balance.ranges, balance.bare, balance.leg.cams
    table = balance.table.cam
    assert table is not None
    phi = np.linspace(span.low, span.high, table.points)
    try:
        potential = in_doubles(placed(balance.mechanism, balance.leg, cam).potential)
        found = profile(
            potential, phi, *(float(number(each, balance.mechanism)) for each in (cam.start, cam.roller, cam.spring.free_length))
        )
    except CamError as error:
        raise SpecError(cam_problem(error, name, span.name)) from None
    after = Residue(span, phi, residual(potential, found), np.zeros(len(phi)))
    return CamDesigned(balance, {}, (bare,), (after,), potential, found)


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
