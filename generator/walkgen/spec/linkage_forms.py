"""Common linkages in a few lengths, and the links and pins that each stands for.

A four-bar's corners are A, B, C, D: the crank turns about A, the coupler goes from B to C, the rocker turns about D. A five-bar's are A to
E, driven at A and E, its couplers meet in C. A six-bar is a four-bar with two more links that join E on one of its links to G on another
at F. Every bar begins at the origin of its own axes and lies along their x; the frame has A in its origin and the ground along x.
A Stephenson II has a loop of five instead, A B F C D or A B C F D, in which the second coupler stands between crank and coupler, or coupler
and rocker; the second rocker joins E on the one of these two to G on the other.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

from pydantic import StrictStr

from walkgen.spec.linkage import FRAME, ActuatorSpec, PinFriction, PinSpec, PlanarLinkSpec
from walkgen.spec.scalar import ZERO, Scalar
from walkgen.spec.table import Number, Pair, Table

FOOT = "P"
"""Name of the point that a short form calls the foot."""
SIX_BAR_POINTS = ("on_crank", "on_coupler", "on_rocker", "on_ground")
"""Keys of the points that the second loop of a six-bar hangs on; E is the first that is given, G the second."""


class DriveSpec(ActuatorSpec):
    """The motor of a crank; its q is the crank's angle to the frame's x axis."""

    ANGLES: ClassVar[frozenset[str]] = frozenset({"limits"})

    name: StrictStr | None = None
    """The crank's where left out."""
    friction: PinFriction | None = None
    limits_deg: Pair | None = None


class LinkageForm(Table):
    """What all short forms have."""

    foot: Pair | None = None
    """The foot point in the axes of its link (m); the design's own `foot` where left out."""
    foot_link: StrictStr | None = None
    """Link of the foot; the coupler where left out, of a six-bar the second coupler."""
    friction: PinFriction | None = None
    """Of every pin that is not driven."""


class FourBar(LinkageForm):
    """Ground, crank, coupler, rocker; the crank is driven."""

    ground: Number
    """From the crank's pin A to the rocker's D (m)."""
    crank: Number
    """From A to B (m)."""
    coupler: Number
    """From B to C (m)."""
    rocker: Number
    """From D to C (m)."""
    drive: DriveSpec = DriveSpec()


class Parallelogram(LinkageForm):
    """A four-bar with equal opposite sides: the coupler does not turn. The crank is driven."""

    ground: Number
    """Also the coupler's length (m)."""
    crank: Number
    """Also the rocker's length (m)."""
    drive: DriveSpec = DriveSpec()


class FiveBar(LinkageForm):
    """Two driven cranks whose couplers meet in a pin; the foot is that pin where none is given."""

    ground: Number
    """Between the motors (m), 0 where they share an axis."""
    cranks: Pair
    """Lengths of first and second crank (m)."""
    couplers: Pair
    """Lengths from first and second crank to the common pin (m)."""
    drives: tuple[DriveSpec, DriveSpec] = (DriveSpec(), DriveSpec())


class SixBar(FourBar):
    """A four-bar and two more links between two points of its links."""

    on_crank: Pair | None = None
    """Point of the crank that the second loop hangs on (m)."""
    on_coupler: Pair | None = None
    """The same of the coupler."""
    on_rocker: Pair | None = None
    """The same of the rocker."""
    on_ground: Pair | None = None
    """The same of the frame."""
    second_coupler: Number
    """From the first of these points to the pin F (m); of a Stephenson II from the crank's B or the coupler's C to F."""
    second_rocker: Number
    """From the second of these points to the pin F (m); of a Stephenson II from the first to the second."""


class Watt(SixBar):
    """Six-bar whose two links of three pins are neighbours."""

    inversion: Literal["I", "II"]
    """I: the frame has two pins (points on crank and coupler, or coupler and rocker); II: three (on crank or rocker, and on the ground)."""


class Stephenson(SixBar):
    """Six-bar whose two links of three pins face each other."""

    inversion: Literal["I", "II", "III"]
    """I: points on crank and rocker; III: on coupler and ground; II, a triad: on crank and coupler, or coupler and rocker."""


POINTS_OF: Mapping[tuple[str, str], tuple[tuple[str, str], ...]] = {
    ("watt", "I"): (("on_coupler", "on_rocker"), ("on_crank", "on_coupler")),
    ("watt", "II"): (("on_rocker", "on_ground"), ("on_crank", "on_ground")),
    ("stephenson", "I"): (("on_crank", "on_rocker"),),
    ("stephenson", "II"): (("on_crank", "on_coupler"), ("on_coupler", "on_rocker")),
    ("stephenson", "III"): (("on_coupler", "on_ground"),),
}
"""Which pairs of points make which six-bar, by form and inversion."""


@dataclass(frozen=True)
class LinkageTables:
    """Links and pins of the long form, and its foot where the short form has one."""

    links: Mapping[str, PlanarLinkSpec]
    pins: tuple[PinSpec, ...]
    foot: str | None


def tables_of(form: LinkageForm) -> LinkageTables:
    """The links and pins that a well-formed short form stands for."""
    tables = _tables(form)
    pins = tuple(pin if pin.driven else pin.model_copy(update={"friction": form.friction}) for pin in tables.pins)
    return replace(tables, pins=pins)


def _tables(form: LinkageForm) -> LinkageTables:
    if isinstance(form, FiveBar):
        return _five_bar(form)
    if isinstance(form, Parallelogram):
        four = FourBar(ground=form.ground, crank=form.crank, coupler=form.ground, rocker=form.crank, drive=form.drive)
        return _finished(form, "coupler", *_four_bar(four))
    assert isinstance(form, FourBar)
    if isinstance(form, Stephenson) and form.inversion == "II":
        return _finished(form, "coupler", *_loop_of_five(form))
    points, pins = _four_bar(form)
    if isinstance(form, SixBar):
        return _finished(form, "second_coupler", *_second_loop(form, points, pins))
    return _finished(form, "coupler", points, pins)


_Points = dict[str, dict[str, Pair]]
_Pins = tuple[PinSpec, ...]


def _four_bar(form: FourBar) -> tuple[_Points, _Pins]:
    points = {
        FRAME: {"A": _ORIGIN, "D": _along(form.ground)},
        "crank": {"A": _ORIGIN, "B": _along(form.crank)},
        "coupler": {"B": _ORIGIN, "C": _along(form.coupler)},
        "rocker": {"D": _ORIGIN, "C": _along(form.rocker)},
    }
    pins = (_driven("frame.A", "crank.A", form.drive), _pin("crank.B", "coupler.B"), _pin("frame.D", "rocker.D"))
    return points, (*pins, _pin("coupler.C", "rocker.C"))


def _second_loop(form: SixBar, points: _Points, pins: _Pins) -> tuple[_Points, _Pins]:
    (first, e), (second, g) = hung_points(form)
    owners = [FRAME if key == "on_ground" else key.removeprefix("on_") for key in (first, second)]
    points[owners[0]]["E"], points[owners[1]]["G"] = e, g
    points["second_coupler"] = {"E": _ORIGIN, "F": _along(form.second_coupler)}
    points["second_rocker"] = {"G": _ORIGIN, "F": _along(form.second_rocker)}
    hung = (_pin(f"{owners[0]}.E", "second_coupler.E"), _pin(f"{owners[1]}.G", "second_rocker.G"))
    return points, (*pins, *hung, _pin("second_coupler.F", "second_rocker.F"))


def _loop_of_five(form: Stephenson) -> tuple[_Points, _Pins]:
    """Of a Stephenson II: the second coupler is F's link between the two ternary ones."""
    points, pins = _four_bar(form)
    (first, e), (second, g) = hung_points(form)
    owner, other = first.removeprefix("on_"), second.removeprefix("on_")
    opened = "B" if owner == "crank" else "C"
    points[owner]["E"], points[other]["G"] = e, g
    points[other]["F"] = points[other].pop(opened)
    points["second_coupler"] = {opened: _ORIGIN, "F": _along(form.second_coupler)}
    points["second_rocker"] = {"E": _ORIGIN, "G": _along(form.second_rocker)}
    kept = tuple(pin for pin in pins if pin.joins != (f"{owner}.{opened}", f"{other}.{opened}"))
    hung = (_pin(f"{owner}.{opened}", f"second_coupler.{opened}"), _pin("second_coupler.F", f"{other}.F"))
    return points, (*kept, *hung, _pin(f"{owner}.E", "second_rocker.E"), _pin("second_rocker.G", f"{other}.G"))


def hung_points(form: SixBar) -> tuple[tuple[str, Pair], ...]:
    """The points that the second loop hangs on, with their keys."""
    given = ((key, getattr(form, key)) for key in SIX_BAR_POINTS)
    return tuple((key, point) for key, point in given if point is not None)


def _five_bar(form: FiveBar) -> LinkageTables:
    points = {
        FRAME: {"A": _ORIGIN, "E": _along(form.ground)},
        "crank": {"A": _ORIGIN, "B": _along(form.cranks[0])},
        "coupler": {"B": _ORIGIN, "C": _along(form.couplers[0])},
        "second_crank": {"E": _ORIGIN, "D": _along(form.cranks[1])},
        "second_coupler": {"D": _ORIGIN, "C": _along(form.couplers[1])},
    }
    driven = (_driven("frame.A", "crank.A", form.drives[0]), _driven("frame.E", "second_crank.E", form.drives[1]))
    hung = (_pin("crank.B", "coupler.B"), _pin("second_crank.D", "second_coupler.D"), _pin("coupler.C", "second_coupler.C"))
    found = _finished(form, "coupler", points, (*driven, *hung))
    return found if found.foot else LinkageTables(found.links, found.pins, "coupler.C")


def _finished(form: LinkageForm, foot_link: str, points: _Points, pins: _Pins) -> LinkageTables:
    """With the foot among the points."""
    foot = None
    if form.foot is not None:
        owner = form.foot_link or foot_link
        points.get(owner, {})[FOOT] = form.foot
        foot = f"{owner}.{FOOT}"
    return LinkageTables({name: PlanarLinkSpec(points=own) for name, own in points.items()}, pins, foot)


def _along(length: Scalar) -> Pair:
    return (length, ZERO)


_ORIGIN: Pair = (ZERO, ZERO)


def _pin(*joins: str) -> PinSpec:
    return PinSpec(joins=joins)


def _driven(base: str, moved: str, drive: DriveSpec) -> PinSpec:
    given = {key: getattr(drive, key) for key in DriveSpec.model_fields}
    given["name"] = drive.name or moved.partition(".")[0]
    return PinSpec(joins=(base, moved), driven=True, **given)
