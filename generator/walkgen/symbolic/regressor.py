"""Efforts as a linear function of inertia: what every unit of mass, first moment and inertia asks of the joints."""

from collections.abc import Sequence
from dataclasses import replace

import sympy

from walkgen.symbolic.frames import Frame
from walkgen.symbolic.inertia import NO_TENSOR, Inertia
from walkgen.symbolic.newton_euler import Motion, NewtonEuler, accelerated
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.tape import IDENTITY, plus, times
from walkgen.symbolic.wrench import Wrench, along_route

PARAMETERS = ("m", "mx", "my", "mz", "xx", "yy", "zz", "xy", "xz", "yz")
"""Of one link: mass, first moment, tensor about the frame's origin."""


def unit_inertia(number: int) -> Inertia:
    """One of `PARAMETERS` is 1, the others 0."""
    if number == 0:
        return Inertia(sympy.S.One)
    if number <= 3:
        return Inertia(moment=IDENTITY[number - 1])
    xx, yy, zz, xy, xz, yz = (sympy.S.One if number - 4 == index else entry for index, entry in enumerate(NO_TENSOR))
    return Inertia(tensor=(xx, yy, zz, xy, xz, yz))


class Regressor:
    """Columns of the map from inertial parameters to joint efforts, gravity included, friction and rotors not."""

    def __init__(self, motion: NewtonEuler) -> None:
        self.motion, self.turning, self.tape = motion, motion.turning, motion.tape

    def column(self, index: int, number: int, frame: Frame) -> dict[int, sympy.Expr]:
        """Efforts by link for a unit of one parameter of a link, taken in a frame of it."""
        link = self.turning.links[index]
        name = f"{link.name}_{PARAMETERS[number]}"
        inertia = unit_inertia(number)
        wrench = accelerated(self._motion_of(index, frame), inertia, inertia.wheel, self.tape, name)
        force, moment = (times(frame.rotation, vector) for vector in (wrench.force, wrench.moment))
        own = Wrench(force, moment).named(self.tape, f"{name}_turned").seen_from(frame.origin).named(self.tape, f"{name}_own")
        grouped = Wrench(self.turning.out(index, own.force, f"{name}_force"), self.turning.out(index, own.moment, f"{name}_moment"))
        return along_route(self.turning, index, grouped, f"Y_{name}")[0]

    def _motion_of(self, index: int, frame: Frame) -> Motion:
        """Of the frame's origin, in its axes."""
        name = self.turning.links[index].name
        motion = self.motion.own_motion(index)
        swing = times(motion.field(self.tape, f"{name}_own"), frame.origin)
        there = replace(motion, origin=self.tape.vector(f"{name}_frame_at", plus(motion.origin, swing)))
        return there.entered(frame.rotation, self.tape, f"{name}_frame")

    def efforts(self, spread: Spread, index: int, number: int, frame: Frame) -> tuple[sympy.Expr, ...]:
        """A column as efforts on q."""
        found, places = self.column(index, number, frame), {link.coordinate: place for place, link in enumerate(self.turning.links)}
        return spread.borne([found.get(places[coordinate], sympy.S.Zero) for coordinate in range(len(places))])


def regressor_of(motion: NewtonEuler, spread: Spread, bodies: Sequence[int]) -> list[tuple[sympy.Expr, ...]]:
    """Rows by q, columns by body, one of the tree's links each, and `PARAMETERS`, in every link's own frame."""
    builder = Regressor(motion)
    columns = [builder.efforts(spread, index, number, motion.links[index].frame) for index in bodies for number in range(len(PARAMETERS))]
    return list(zip(*columns, strict=True))
