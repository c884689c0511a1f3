"""Rules of curved soles: a leg with an ankle, curves given in one way, which leave the flat part along it and bulge to the ground."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from walkgen.spec.curved_sole import CURVES, FORMS, CurvedSoleSpec, DirectrixSpec
from walkgen.spec.directrix import AHEAD, Jet, Piece, jet, pieces_of
from walkgen.spec.evaluate import Numbers
from walkgen.spec.problems import Finding
from walkgen.spec.scalar import Scalar, names, substitute
from walkgen.spec.schema import LegDesign, RobotSpec
from walkgen.spec.table import Path, entries
from walkgen.spec.tree import design_of

_SAMPLES = 64
_CLOSE = 1e-9
"""What counts as nothing beside the size of the sole, or of an angle."""
_STRAIGHT = 1e-9
_MOST_TURN = math.pi
_STEEPEST = math.radians(80.0)
_ROLLING = 3


def check_soles(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Every curved sole, and the flat ones that would be in its way."""
    for name, design in spec.leg_designs.items():
        if design.curved_sole is not None:
            path: Path = ("leg_designs", name)
            yield from _leg(path, design)
            yield from _sole((*path, "curved_sole"), design.curved_sole, spec, numbers)
    for index, leg in enumerate(spec.legs):
        own = design_of(spec, leg)
        if leg.sole is not None and own is not None and own.curved_sole is not None:
            yield Finding("WG124", ("legs", index, "sole"), "the leg's design has a curved sole", "leave the leg's own sole out")


def _leg(path: Path, design: LegDesign) -> Iterator[Finding]:
    last = [joint.type for joint in design.joints[-_ROLLING:]]
    if design.planar or last != ["revolute"] * _ROLLING:
        message = "a curved sole needs a hip, a knee and an ankle: three revolute joints with parallel axes at the end of the leg"
        yield Finding("WG230", (*path, "curved_sole"), message, "let the leg's joints end so, or give it a flat sole")
    if design.sole is not None:
        yield Finding("WG124", (*path, "sole"), "the design has a flat sole and a curved one", "keep one of them")


def _sole(path: Path, sole: CurvedSoleSpec, spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    missing = [key for key in ("depth", "flat") if sole.si(key) is None]
    for key in missing:
        yield Finding("WG111", (*path, key), f'missing key "{key}"', "write depth = 0.09 and flat = [-0.06, 0.12] (m)")
    if sole.toe is None and sole.heel is None:
        yield Finding(
            "WG111", (*path, "toe"), "the sole has no curve", "describe its toe, its heel or both: toe = { ellipse = [0.09, 0.06] }"
        )
    rear, front = (numbers.number(edge) for edge in sole.si("flat") or (None, None))
    if rear is not None and front is not None and rear >= front:
        key = "flat" if sole.flat is not None else "flat_mm"
        yield Finding("WG160", (*path, key), f"the flat part is empty: {float(rear):g} to {float(front):g} m", "give the rear edge first")
    yield from _slope(path, sole, numbers)
    for which in CURVES:
        given = getattr(sole, which)
        if given is not None:
            broken = list(_given((*path, which), given, spec))
            yield from broken
            if not broken and not missing:
                yield from _curve((*path, which), which, sole, numbers)


def _slope(path: Path, sole: CurvedSoleSpec, numbers: Numbers) -> Iterator[Finding]:
    slope = numbers.number(sole.si("slope"))
    if slope is not None and not abs(float(slope)) <= _STEEPEST:
        key = "slope" if sole.slope is not None else "slope_deg"
        message = f"a ground that rises by {math.degrees(float(slope)):.4g} degrees"
        yield Finding("WG239", (*path, key), message, f"up to {math.degrees(_STEEPEST):g} degrees either way")


def _given(path: Path, curve: DirectrixSpec, spec: RobotSpec) -> Iterator[Finding]:
    """One way, with all that belongs to it."""
    forms = [form for form in FORMS if getattr(curve, form) is not None or (form == "x" and curve.y is not None)]
    if len(forms) != 1:
        cure = "write x and y in lambda with end, or polynomial with end, or ellipse, or points"
        message = f"the curve is given by {' and '.join(forms)}" if forms else "the curve is not given"
        at, tried = (*path, forms[-1]) if forms else path, tuple((*path, form) for form in (*FORMS, "y"))
        yield Finding("WG124" if forms else "WG111", at, message, cure, because=tried)
        return
    form = forms[0]
    needed = {"x": ("x", "y", "end"), "polynomial": ("end",)}.get(form, ())
    for key in needed:
        if curve.si(key) is None:
            yield Finding("WG111", (*path, key), f'missing key "{key}" of a curve given by {form}', f"write {key} = ...")
    unwanted = [
        key
        for key, owners in (("start", ("x",)), ("end", FORMS[:3]), ("end_deg", ("x", "ellipse")))
        if getattr(curve, key) is not None and form not in owners
    ]
    for key in unwanted:
        yield Finding("WG124", (*path, key), f"{key} does not belong to a curve given by {form}", f"leave {key} out")
    runtime = {name for name, entry in spec.parameters.items() if entry.runtime}
    if form == "points" and any(names(scalar) & runtime for _, scalar in entries(curve.points) if isinstance(scalar, Scalar)):
        yield Finding("WG235", (*path, "points"), "the points follow a runtime parameter", "give numbers, or another form of the curve")


def _curve(path: Path, which: str, sole: CurvedSoleSpec, numbers: Numbers) -> Iterator[Finding]:
    """Its course at the parameters' values; nothing where these are unknown."""
    used = {name for _, scalar in entries(sole) if isinstance(scalar, Scalar) for name in names(scalar)}
    if not used - {"lambda"} <= numbers.values.keys():
        return
    try:
        pieces = [_with_constants(piece, numbers) for piece in pieces_of(sole, which, lambda scalar: float(numbers.number(scalar) or 0.0))]
    except ValueError as error:
        yield Finding("WG231", (*path, "points"), str(error), "give points apart, the first apart from the edge of the flat part")
        return
    start, end = (numbers.number(scalar) for scalar in (pieces[0].start, pieces[-1].end))
    if start is None or end is None or not start < end:
        yield Finding("WG160", (*path, "end"), "the curve is empty: it ends where it begins, or before", "give an end beyond its start")
        return
    try:
        yield from _course(path, which, [_sampled(piece, numbers) for piece in pieces], sole, numbers)
    except (ArithmeticError, ValueError) as error:
        yield Finding("WG164", path, f"no value on the curve: {error}", "mend the expressions, the range of lambda, or the parameters used")


def _with_constants(piece: Piece, numbers: Numbers) -> Piece:
    return replace(piece, **{key: substitute(getattr(piece, key), numbers.constants) for key in ("x", "y", "start", "end")})


def _sampled(piece: Piece, numbers: Numbers) -> list[tuple[float, Jet]]:
    start, end = (float(numbers.number(scalar) or 0.0) for scalar in (piece.start, piece.end))
    places = [start + (end - start) * count / _SAMPLES for count in range(_SAMPLES + 1)]
    return [(at, jet(piece, at, dict(numbers.values))) for at in places]


def _course(path: Path, which: str, parts: list[list[tuple[float, Jet]]], sole: CurvedSoleSpec, numbers: Numbers) -> Iterator[Finding]:
    """Regular, tangent to the flat part, convex: the first of these that it is not."""
    samples = [sample for part in parts for sample in part]
    fastest = max(jet.speed for _, jet in samples)
    ahead = AHEAD[which]
    slow = next((at for at, jet in samples if not jet.speed > _CLOSE * fastest), None)
    if slow is not None:
        message = f"the curve is not regular: its point does not move at lambda = {slow:.6g}"
        yield Finding("WG231", path, message, "take another parameter, or another range")
        return
    yield from _tangent(path, samples[0][1], ahead, sole, numbers)
    turning = [(at, -ahead * jet.turning / jet.speed**2) for at, jet in samples]
    most = max(abs(bend) for _, bend in turning)
    hollow = next((at for at, bend in turning[1:] if not bend > _STRAIGHT * most), None)
    if hollow is not None:
        message = f"the sole is not convex: it does not bulge towards the ground at lambda = {hollow:.6g}"
        yield Finding("WG233", path, message, "end the curve before, or change its coefficients or points")
    elif (turned := _turned(samples)) >= _MOST_TURN:
        message = f"the curve turns by {math.degrees(turned):.4g} degrees; the foot rolls over less than half a turn"
        yield Finding("WG233", path, message, "end the curve before")


def _turned(samples: list[tuple[float, Jet]]) -> float:
    """The angle between the curve's directions at its ends, summed on the way."""
    directions = [math.atan2(jet.y[1], jet.x[1]) for _, jet in samples]
    return abs(sum(math.remainder(b - a, math.tau) for a, b in pairwise(directions)))


def _tangent(path: Path, first: Jet, ahead: int, sole: CurvedSoleSpec, numbers: Numbers) -> Iterator[Finding]:
    """At the edge of the flat part and along it."""
    edge = sole.si("flat")[1 if ahead > 0 else 0]
    depth, side = (float(numbers.number(scalar) or 0.0) for scalar in (sole.si("depth"), edge))
    size = max(abs(depth), abs(side), _CLOSE)
    if math.hypot(first.x[0] - depth, first.y[0] - side) > _CLOSE * size:
        message = (
            f"the curve begins at x = {first.x[0]:.6g}, y = {first.y[0]:.6g} m, the flat part ends at x = {depth:.6g}, y = {side:.6g} m"
        )
        yield Finding("WG232", path, message, "let it begin at the edge of the flat part, or set start")
    elif abs(first.x[1]) > _CLOSE * first.speed or ahead * first.y[1] < 0.0:
        angle = math.degrees(math.atan2(-first.x[1], ahead * first.y[1]))
        message = f"the curve leaves the flat part at {angle:.4g} degrees: the foot would rock on an edge"
        yield Finding("WG232", path, message, "let x have no slope and y grow away from the flat part at the start")
