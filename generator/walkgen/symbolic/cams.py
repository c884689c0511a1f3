"""Cams in a leg's tree: the follower slides as its joint turns, by a series that goes straight on beyond the ends of the cam."""

from collections.abc import Sequence

import sympy

from walkgen.model.cam_way import Way, way_of
from walkgen.model.cams import placed
from walkgen.model.mechanism import Cam, Joint, Limb, Mechanism
from walkgen.spec.scalar import ZERO
from walkgen.symbolic.choices import less
from walkgen.symbolic.function import Select
from walkgen.symbolic.inertia import inertia_of
from walkgen.symbolic.planar_motion import Coordinate, PlanarMotion
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.tape import Tape
from walkgen.symbolic.tree import Attachment, Growth


def grow_cam(
    mechanism: Mechanism,
    leg: Limb,
    cam: Cam,
    growth: Growth,
    spread: Spread,
    series: Sequence[Attachment],
    drive: tuple[int, sympy.Symbol],
    prefix: str,
) -> int:
    """Add a cam's follower, and what its spring weighs on the link.

    Args:
        mechanism: the robot.
        leg: whose cam it is.
        cam: one that can be cut.
        growth: the tree.
        spread: of the robot's q.
        series: the mount, then the frames that move with the leg's joints.
        drive: index in q and symbol of the cam's joint.
        prefix: of names.

    Returns:
        the number of the roller's way among the tree's coordinates.
    """
    name, found, (index, q) = f"{prefix}{cam.name}", placed(mechanism, leg, cam), drive
    way = way_on(growth.tape, way_of(mechanism, leg, cam), q, name)
    motion = PlanarMotion(growth.tape, [q], [Coordinate(f"{name}_way", way)])
    (number,) = spread.driven([index], [way], motion)
    link = series[cam.joint + 1]
    slide = Joint(f"{cam.name}_follower", "prismatic", found.guide, 1, ZERO, (), body=found.follower)
    growth.joint(slide, series[cam.joint] if cam.on == "link" else link, number, f"{name}_follower")
    if found.hooked:
        growth.carry(link, inertia_of(found.hooked, growth.parameters, growth.tape, f"{name}_hooked"), f"{name}_hooked")
    return number


def way_on(tape: Tape, way: Way, q: sympy.Expr, name: str) -> sympy.Expr:
    """The roller's way by Clenshaw's recurrence, from the nearer end straight on where q is beyond it."""
    low, high, *coefficients = (sympy.Rational(entry.numerator, entry.denominator) for entry in (way.low, way.high, *way.coefficients))
    t = tape.let(f"{name}_place", (2 * q - low - high) / (high - low))
    below, above = less(t, -1), less(1, t)
    inside = tape.let(f"{name}_inside", Select(below, -1, Select(above, 1, t)))
    one, other = sympy.S.Zero, sympy.S.Zero
    for coefficient in coefficients[:0:-1]:
        one, other = tape.let(f"{name}_sum", coefficient + 2 * inside * one - other), one
    slopes = [sum(entry * k**2 * sign ** (k + 1) for k, entry in enumerate(coefficients)) for sign in (-1, 1)]
    steep = tape.let(f"{name}_end_slope", Select(below, slopes[0], Select(above, slopes[1], 0)))
    return tape.let(f"{name}_way", coefficients[0] + inside * one - other + steep * (t - inside))
