"""From the tables of a planar linkage to its structure, and which point of which link every pair joins."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from walkgen.spec.assur import Pair, Structure
from walkgen.spec.linkage import FRAME
from walkgen.spec.pantograph import Complex, pantograph
from walkgen.spec.scalar import ZERO, Exact
from walkgen.spec.schema import LegDesign
from walkgen.spec.table import Pair as Coordinates
from walkgen.spec.table import Path

End = Coordinates | None
"""A point of a body; None is the far end of a bar, at (q, 0)."""


@dataclass(frozen=True)
class Joined:
    """A pair with the point of each of its bodies."""

    pair: Pair
    points: tuple[End, ...]


def link_names(design: LegDesign) -> tuple[str, ...]:
    """The frame, then the other links as the spec has them."""
    return (FRAME, *(name for name in design.links if name != FRAME))


def structure_of(design: LegDesign) -> Structure:
    """Bodies and pairs; every reference is trusted."""
    links = link_names(design)
    driven = [cylinder.name for cylinder in design.cylinders if cylinder.driven]
    joined = joined_pairs(design)
    pairs = tuple(each.pair for each in joined)
    found = None if design.joints_after else pantograph(pairs, _exact_places(joined), *_exact_foot(design))
    return Structure((*links, *driven), pairs, frozenset(range(len(links), len(links) + len(driven))), found)


def _exact_places(joined: tuple[Joined, ...]) -> dict[tuple[int, int], Complex]:
    """Those that hold no parameter and no root."""
    found = {}
    for index, each in enumerate(joined):
        for body, point in zip(each.pair.bodies, each.points, strict=True):
            if point is not None and isinstance(point[0], Exact) and isinstance(point[1], Exact):
                found[index, body] = (point[0].value, point[1].value)
    return found


def _exact_foot(design: LegDesign) -> tuple[int, Complex]:
    """Its link and place; no link where the place is not exact."""
    body, (x, y) = located(design, design.placed)
    return (body, (x.value, y.value)) if isinstance(x, Exact) and isinstance(y, Exact) else (-1, (Fraction(0), Fraction(0)))


def joined_pairs(design: LegDesign) -> tuple[Joined, ...]:
    """Pins, ends of driven cylinders, sliders."""
    return (*_pins(design), *_cylinders(design), *_sliders(design))


def pin_name(joins: tuple[str, ...], name: str | None) -> str:
    """Its own, else that of the last point that it joins."""
    return name or joins[-1].rpartition(".")[2].lower()


def located(design: LegDesign, text: str) -> tuple[int, Coordinates]:
    """A link by its number, and the point that the text names."""
    link, _, point = text.partition(".")
    return link_names(design).index(link), design.links[link].points[point]


def table_of(design: LegDesign, pair: int) -> Path:
    """Where a pair of `joined_pairs` stands in the design: a cylinder has two."""
    driven = [index for index, cylinder in enumerate(design.cylinders) if cylinder.driven]
    tables: list[Path] = [("pins", index) for index in range(len(design.pins))]
    tables += [("cylinders", index) for index in driven for _ in range(2)]
    tables += [("sliders", index) for index in range(len(design.sliders))]
    return tables[pair]


def _pins(design: LegDesign) -> Iterator[Joined]:
    for pin in design.pins:
        ends = [located(design, text) for text in pin.joins]
        pair = Pair("R", pin_name(pin.joins, pin.name), tuple(body for body, _ in ends), pin.driven)
        yield Joined(pair, tuple(point for _, point in ends))


def _cylinders(design: LegDesign) -> Iterator[Joined]:
    bar = len(link_names(design))
    for cylinder in design.cylinders:
        if cylinder.driven:
            for text, far in zip(cylinder.between, ((ZERO, ZERO), None), strict=True):
                body, point = located(design, text)
                yield Joined(Pair("R", cylinder.name, (body, bar)), (point, far))
            bar += 1


def _sliders(design: LegDesign) -> Iterator[Joined]:
    for slider in design.sliders:
        body, point = located(design, slider.link)
        guide = link_names(design).index(slider.guide.link)
        yield Joined(Pair("P", slider.name, (body, guide), slider.driven), (point, slider.guide.point))
