"""What linkages, springs and cams of a good spec do within the limits of the joints, told before any code is written: refusals, notices."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from walkgen.errors import Place, Problem, SpecError
from walkgen.graph.coverage import Coverage, Failure, coverage, titled
from walkgen.model.cam_potential import CamError
from walkgen.model.cam_way import way_of
from walkgen.model.cams import cam_problem
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.runtime.solves.triads import close_triads
from walkgen.spec.document import open_document
from walkgen.spec.positions import Positions
from walkgen.spec.schema import RobotSpec
from walkgen.symbolic.rolling_leg import hindrance
from walkgen.symbolic.slack import Slack, slack


def examined(path: Path, spec: RobotSpec, mechanism: Mechanism) -> tuple[Problem, ...]:
    """Notices of every leg design with a linkage: in which part of its drives' limits it does not assemble.

    Raises:
        SpecError: WG189 a linkage assembles nowhere within them, so that its code would give nothing but NaN; WG191 it has other freedoms
            than the count says wherever it does; WG203 a spring goes slack within the limits of the leg's joints; WG218, WG222 to WG224 a
            cam cannot be; WG234 a curved sole is under a leg whose last axes are not parallel and level.
    """
    legs = {leg.name: leg for leg in mechanism.legs}
    users = {leg.design: legs[leg.name] for leg in spec.legs if leg.design is not None}
    if not any(leg.linkage or leg.springs or leg.cams or leg.curved_sole for leg in mechanism.legs):
        return ()
    positions = Positions(open_document(path))
    problems: list[Problem] = []
    notices: list[Problem] = []
    for design, leg in users.items():
        if leg.linkage is not None:
            place, found = positions.place(("leg_designs", design)), coverage_of(mechanism, leg, leg.linkage)
            problems += _refused(f"leg_designs.{design}", place, found, leg.linkage)
            notices += _partial(f"leg_designs.{design}", place, found, leg, leg.linkage)
        if leg.curved_sole is not None and (reason := hindrance(mechanism, leg)):
            place = positions.place(("leg_designs", design, "curved_sole"))
            cure = "let hip, knee and ankle turn about parallel level axes, and the foot frame's z lie along them"
            problems.append(Problem("WG234", f"leg_designs.{design}.curved_sole: {reason}", cure, place))
        for short in slack(mechanism, leg):
            place = positions.place(("leg_designs", design, "springs", short.spring))
            problems.append(_slack(f"leg_designs.{design}", place, short, leg))
    for own in (legs[leg.name] for leg in spec.legs if leg.mirror_of is None):
        problems += _uncut(mechanism, own, positions)
    if problems:
        raise SpecError(*problems)
    return tuple(notices)


def coverage_of(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> Coverage:
    """How much of its drives' limits a leg's linkage assembles in, and its freedoms there."""
    return coverage(mechanism, leg, linkage, close_triads)


def percent(count: int, points: int) -> str:
    """Rounded, but neither all nor nothing unless it is."""
    share = 100 * count / points
    rounded = round(share) if count in (0, points) else min(max(round(share), 1), 99)
    return f"{rounded} %"


def drives_text(drives: Sequence[Joint], values: Sequence[float]) -> str:
    """Where drives are, for people."""
    return ", ".join(f"{drive.name} {value:.4g} {drive.unit}" for drive, value in zip(drives, values, strict=True))


def _refused(design: str, place: Place, found: Coverage, linkage: Linkage) -> Iterator[Problem]:
    count = linkage.structure.mobility
    if found.startless:
        message = f"the triad {', '.join(found.startless)} has no assembly at the start, nor where it was looked for around"
        yield Problem("WG189", f"{design}: {message}", "mend the lengths that it joins, or give start other drives", place)
    elif found.assembled == 0 and found.bounded:
        worst = found.failing[0]
        where = "its drives' limits" if found.limited else "what its drives can do"
        points = f"0 % of {where}, at none of {found.points} points"
        message = f"the linkage assembles in {points}; at {worst.count} of them the {titled(linkage, worst.group)} cannot close"
        yield Problem("WG189", f"{design}: {message}", "mend the lengths that it joins, or the limits", place)
    if found.mobility is not None and found.mobility.freedoms != count:
        message = f"the linkage has {count} degrees of freedom by count, {found.mobility.freedoms} by the rank of its pairs' equations"
        pairs = f"{', '.join(found.mobility.pairs)} say one thing twice wherever it closes"
        yield Problem("WG191", f"{design}: {message}: {pairs}", "change lengths that keep these pairs at a dead point", place)


def _uncut(mechanism: Mechanism, leg: Limb, positions: Positions) -> Iterator[Problem]:
    """What is wrong with a leg's cam."""
    for cam in leg.cams:
        try:
            way_of(mechanism, leg, cam)
        except CamError as error:
            yield cam_problem(error, cam.name, leg.joints[cam.joint].name, positions.place(("balance", cam.name, "cam")))


def _slack(design: str, place: Place, found: Slack, leg: Limb) -> Problem:
    message = f"{design}.springs[{found.spring}]: the spring {leg.springs[found.spring].name} would have to push: it is"
    message += f" {found.length:.4g} m long at {drives_text(leg.joints, found.q)}, less than its free length of {found.free:.4g} m"
    return Problem("WG203", message, "give it a shorter free length, move its ends, or narrow the joints' limits", place)


def _partial(design: str, place: Place, found: Coverage, leg: Limb, linkage: Linkage) -> Iterator[Problem]:
    """One line."""
    if found.limited and 0 < found.assembled < found.points:
        share, drives = percent(found.assembled, found.points), leg.drives
        parts = (
            f"{titled(linkage, each.group)} cannot close in {percent(each.count, found.points)} ({_where(each, drives)})"
            for each in found.failing
        )
        message = f"notice: {design}: the linkage assembles in {share} of its drives' limits; {'; '.join(parts)}"
        yield Problem("WG192", message, place=Place(place.file, place.line, place.column))


def _where(failure: Failure, drives: Sequence[Joint]) -> str:
    """Between which values of the drives."""
    spans = zip(drives, failure.low, failure.high, strict=True)
    return ", ".join(f"{drive.name} {low:.4g} to {high:.4g} {drive.unit}" for drive, low, high in spans)
