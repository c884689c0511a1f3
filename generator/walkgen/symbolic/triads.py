"""Places a triad: one strut by two unknown values of its pairs, the other two by what they join, which leaves a residual each.

The unknowns are the angle of a pin (rad) or what a slider's way in units of the linkage's size is `slid` of. Residuals are how far a
strut is from reaching from end to end, in the same unit, or the tangent of half the angle by which one of two sliders is out of line.
Their slopes by the unknowns are singular where the triad itself is, and nowhere else, since any motion of one end seen from the other that
the first strut allows is one of its pairs'.
"""

import sympy

from walkgen.model.sliding import slid
from walkgen.spec.assur import Drive, Strut, Triad
from walkgen.symbolic.clusters import Clusters
from walkgen.symbolic.planar import Planar, difference, inner, named, outer, square, stretched
from walkgen.symbolic.tape import constant

Pair = tuple[sympy.Expr, sympy.Expr]
Seats = tuple[tuple[int, int, int, int], ...]
"""Of every strut the bodies that its first pair joins, the first end's and the strut's, and those of its second, the strut's first."""
OF_STRUT = 7
"""Entries of a shape."""


def place_triad(clusters: Clusters, triad: Triad, unknowns: Pair) -> Pair:
    """Join the triad's clusters for values of its unknowns; the residuals of its second and third strut."""
    first, *others = triad.struts
    for pair, end, unknown in zip(first.pairs, triad.ends, unknowns, strict=True):
        clusters.drive(*_driven(clusters, pair, (end, first.body), unknown))
    second, third = (_place(clusters, triad, strut) for strut in others)
    return second, third


def seats(clusters: Clusters, triad: Triad) -> Seats:
    """Of a triad that is not placed."""
    first, second = (clusters.cluster[end] for end in triad.ends)
    found = []
    for strut in triad.struts:
        own, (start, end) = clusters.cluster[strut.body], strut.pairs
        found.append((clusters.within(start, first), clusters.within(start, own), clusters.within(end, own), clusters.within(end, second)))
    return tuple(found)


def shape(clusters: Clusters, triad: Triad, seated: Seats) -> tuple[Planar, ...]:
    """Of a placed triad, in its cluster's axes: the pose of either end; then of every strut where its pairs are on the first end, on itself
    twice and on the second end, its rotor, the second end's, and the direction of its slider, if it has one.
    """
    entries = [entry for end in triad.ends for entry in (clusters.seat(end).origin, clusters.seat(end).rotor)]
    for strut, seat in zip(triad.struts, seated, strict=True):
        places = zip((strut.pairs[0], *strut.pairs, strut.pairs[1]), seat, strict=True)
        entries += [clusters.seat(body).point(clusters.located(pair, body)) for pair, body in places]
        entries += [clusters.seat(body).rotor for body in seat[2:]]
        slider = next((pair for pair in strut.pairs if clusters.kind(pair) == "P"), None)
        entries.append((sympy.S.One, sympy.S.Zero) if slider is None else clusters.guided(slider))
    return tuple(entries)


def transmission(clusters: Clusters, triad: Triad) -> tuple[Planar, Planar]:
    """Of a placed triad, in its base's axes: along which its third strut pushes the second end, and how the point that it pushes would
    move if it was cut; they are square to each other at a dead point.
    """
    first, second, third = triad.struts
    point, push = _line(clusters, third)
    held = [_held(clusters, second, pair) for pair in first.pairs]
    rates = [_velocity(clusters, pair, point) for pair in first.pairs]
    return push, difference(stretched(held[1], rates[0]), stretched(held[0], rates[1]))


def _main(clusters: Clusters, triad: Triad) -> int:
    return clusters.cluster[triad.ends[0]]


def _driven(clusters: Clusters, pair: int, bodies: tuple[int, int], unknown: sympy.Expr) -> tuple[Drive, sympy.Expr]:
    """A pair of the first strut as a drive of an unknown value."""
    if clusters.kind(pair) == "P":
        runner, guide = clusters.linkage.structure.pairs[pair].bodies
        return Drive(pair, guide, runner), clusters.size * slid(unknown)
    base, moved = (clusters.within(pair, clusters.cluster[body]) for body in bodies)
    return Drive(pair, base, moved), unknown


def _place(clusters: Clusters, triad: Triad, strut: Strut) -> sympy.Expr:
    """Put a strut between the ends, which are placed; its residual."""
    kinds = [clusters.kind(pair) for pair in strut.pairs]
    if kinds == ["R", "R"]:
        return _bar(clusters, triad, strut)
    return _guided(clusters, triad, strut) if "R" in kinds else _square(clusters, triad, strut)


def _name(clusters: Clusters, strut: Strut) -> str:
    return clusters.linkage.structure.names[strut.body]


def _bar(clusters: Clusters, triad: Triad, strut: Strut) -> sympy.Expr:
    """Two pins: as far apart as the strut is long."""
    name, main, own = _name(clusters, strut), _main(clusters, triad), clusters.cluster[strut.body]
    start, end = (clusters.end(pair, main) for pair in strut.pairs)
    ends = clusters.end(strut.pairs[0], own), clusters.end(strut.pairs[1], own)
    span = named(clusters.tape, f"{name}_span", difference(end, start))
    square_of_length = clusters.tape.let(f"{name}_length2", square(difference(ends[1], ends[0])))
    clusters.join(main, own, clusters.pinned(start, end, ends), name)
    length = constant(sympy.sqrt(square_of_length)) if square_of_length.is_number else sympy.sqrt(square_of_length)
    return clusters.tape.let(f"{name}_residual", (square(span) - square_of_length) / (2 * clusters.size * length))


def _guided(clusters: Clusters, triad: Triad, strut: Strut) -> sympy.Expr:
    """A pin and a slider: the pin as far off the guide as the strut says."""
    name, main, own = _name(clusters, strut), _main(clusters, triad), clusters.cluster[strut.body]
    pin, slider = sorted(strut.pairs, key=lambda pair: clusters.kind(pair) == "P")
    way = clusters.way(slider, main, own)
    gap = named(clusters.tape, f"{name}_gap", difference(clusters.end(pin, main), way.start.point(clusters.end(pin, own))))
    residual = clusters.tape.let(f"{name}_residual", outer(way.step, gap) / clusters.size)
    clusters.join(main, own, way.at(clusters.tape.let(f"{name}_way", inner(way.step, gap))), name)
    return residual


def _square(clusters: Clusters, triad: Triad, strut: Strut) -> sympy.Expr:
    """Two sliders: both put it at the same angle."""
    name, main, own = _name(clusters, strut), _main(clusters, triad), clusters.cluster[strut.body]
    ways = [clusters.way(pair, main, own) for pair in strut.pairs]
    gap = named(clusters.tape, f"{name}_gap", difference(ways[1].start.origin, ways[0].start.origin))
    value = clusters.tape.let(f"{name}_way", outer(gap, ways[1].step) / outer(ways[0].step, ways[1].step))
    one, other = (way.start.rotor for way in ways)
    residual = clusters.tape.let(f"{name}_residual", outer(one, other) / (1 + inner(one, other)))  # of half the angle
    clusters.join(main, own, ways[0].at(value), name)
    return residual


def _line(clusters: Clusters, strut: Strut) -> tuple[Planar, Planar]:
    """Where and along which a strut, that has a pin, pushes its ends."""
    main = clusters.cluster[strut.body]
    pin, other = sorted(strut.pairs, key=lambda pair: clusters.kind(pair) == "P")
    point = clusters.end(strut.pairs[1] if clusters.kind(other) == "R" else pin, main)
    if clusters.kind(other) == "R":
        return point, difference(point, clusters.end(strut.pairs[0], main))
    x, y = clusters.guided(other)
    return point, (-y, x)


def _held(clusters: Clusters, strut: Strut, pair: int) -> sympy.Expr:
    """The rate, by a pair of the first strut, of what another strut holds."""
    if all(clusters.kind(one) == "P" for one in strut.pairs):
        return sympy.S.One if clusters.kind(pair) == "R" else sympy.S.Zero
    point, push = _line(clusters, strut)
    return clusters.tape.let(f"{_name(clusters, strut)}_held", inner(push, _velocity(clusters, pair, point)))


def _velocity(clusters: Clusters, pair: int, point: Planar) -> Planar:
    """Of a point of the second end seen from the first, by a pair of the first strut."""
    main = clusters.cluster[clusters.bodies(pair)[0]]
    if clusters.kind(pair) == "P":
        return clusters.guided(pair)
    x, y = difference(point, clusters.end(pair, main))
    return (-y, x)
