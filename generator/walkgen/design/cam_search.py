"""From a spec to the cam of one of its balances."""

from dataclasses import dataclass
from math import cos, hypot, sin
from pathlib import Path

import numpy as np

from walkgen.design.apart import check_apart
from walkgen.design.balance import Balance, Residue
from walkgen.design.cam import Profile, profile, residual
from walkgen.design.chapter import zero_free_length
from walkgen.design.multistart import Progress
from walkgen.errors import Problem, SpecError
from walkgen.model.cam_potential import Cam, CamError, OnFrame, OnLink, Pull, Weight
from walkgen.spec.balance import CamSpec
from walkgen.spec.scalar import Scalar
from walkgen.spec.schema import RobotSpec

_CODES = {"contact": "WG222", "undercut": "WG223"}
_CURES = {"contact": "start elsewhere, or take a stiffer spring or another arm", "undercut": "take a smaller roller, or start further out"}
_LEFT = 1e-9
"""Of the largest moment: a link on a hinge leaves no more besides its two waves."""


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
        SpecError: it loses contact or is undercut, its spring would have to push, or the joint does not carry a link alone.
    """
    progress("cam")
    balance = Balance(spec, name, path.parent)
    check_apart(balance)
    table, (span,), (bare,) = balance.table.cam, balance.ranges, balance.bare
    assert table is not None
    cam, phi = _cam(balance, table, bare), np.linspace(span.low, span.high, table.points)
    try:
        found = profile(cam, phi, balance.number(table.start), balance.number(table.roller))
    except CamError as error:
        message = f"balance {name}: {error} at {span.name} = {error.angle:.4g} rad"
        raise SpecError(Problem(_CODES[error.kind], message, _CURES[error.kind])) from None
    _refuse_slack(balance, found, balance.number(table.free_length))
    left = residual(cam, found)
    after = Residue(span, phi, left, np.zeros(len(phi)))
    return CamDesigned(balance, {}, (bare,), (after,), cam, found)


def _cam(balance: Balance, table: CamSpec, bare: Residue) -> Cam:
    """With the weights of leg and load as the leg's own moment has them."""

    def number(scalar: Scalar | None) -> float:
        return 0.0 if scalar is None else balance.number(scalar)

    waves = zero_free_length(bare.values, bare.moments)
    if waves.left > _LEFT * balance.size:
        message = f"balance {balance.name}: {waves.left:.4g} N m of the moment of {bare.range.name} is not that of a link on a hinge"
        raise SpecError(Problem("WG224", message, "balance a joint that carries one link, or use springs"))
    stiffness = balance.number(table.stiffness)
    spring = Pull(stiffness, number(table.initial_tension) - stiffness * balance.number(table.free_length))
    gravity, masses = hypot(*map(balance.number, balance.mechanism.gravity)), table.masses
    a, b = -waves.product * sin(waves.angle), waves.product * cos(waves.angle)
    reach, roller, follower = balance.number(table.reach), number(masses.roller), number(masses.follower)
    if table.arm is not None:
        arm, own = balance.number(table.arm), follower + roller + number(masses.spring_at_follower)
        return OnLink(Weight(a - gravity * number(masses.spring_at_link) * arm, b), spring, gravity, arm, reach, own)
    ends = (number(masses.spring_at_follower), follower, roller)
    return OnFrame(Weight(a, b), spring, gravity, number(table.anchor), reach, ends, number(table.centre))


def _refuse_slack(balance: Balance, found: Profile, free: float) -> None:
    place = int(found.lengths.argmin())
    if found.lengths[place] < free:
        at = f"{balance.ranges[0].name} = {found.phi[place]:.4g} rad"
        message = f"balance {balance.name}: the spring of the cam is {found.lengths[place]:.4g} m long at {at}, shorter than {free:.4g} m"
        raise SpecError(Problem("WG218", message, "give it a shorter free length, or a longer way"))
