"""Clusters of bodies of a planar linkage: their poses in one another's axes, on a tape, and how pairs put one on another."""

from collections.abc import Mapping
from dataclasses import dataclass

import sympy

from walkgen.model.linkage import Linkage, Point
from walkgen.spec.assur import Drive
from walkgen.symbolic.frames import Parameters, cosine_sine, expression
from walkgen.symbolic.planar import Planar, PlanarPose, conjugate, difference, square, stretched, sum_of, turned
from walkgen.symbolic.tape import Tape, constant

_ONE = sympy.S.One


@dataclass(frozen=True)
class Way:
    """Where one body lies in another's axes: `start` where the slider between them is at 0, moving along `step` per unit."""

    start: PlanarPose
    step: Planar

    def at(self, value: sympy.Expr) -> PlanarPose:
        """The pose at the slider's value."""
        return PlanarPose(sum_of(self.start.origin, stretched(value, self.step)), self.start.rotor)


class Clusters:
    """Every body's pose in its cluster, on a tape; at first every body is a cluster of its own.

    Args:
        linkage: points and pairs.
        tape: where it is written.
        bars: lengths of driven cylinders, by body.
        parameters: the runtime parameters.
        target: where the foot is pinned to the frame, for the inverse.
    """

    def __init__(
        self,
        linkage: Linkage,
        tape: Tape,
        bars: Mapping[int, sympy.Expr],
        parameters: Parameters,
        target: Planar | None = None,
        held: Planar | None = None,
    ) -> None:
        self.linkage, self.tape, self._parameters = linkage, tape, parameters
        self._bars, self.target, self._held = bars, target, held
        count = len(linkage.structure.names)
        self.cluster = list(range(count))
        self._pose = [PlanarPose() for _ in range(count)]

    def pose(self, body: int) -> PlanarPose:
        """Of a body in the frame, once it is placed."""
        assert self.cluster[body] == self.cluster[0]
        return self._pose[body]

    def seat(self, body: int) -> PlanarPose:
        """Of a body in its cluster."""
        return self._pose[body]

    def point(self, body: int, point: Planar) -> Planar:
        """A point of a body in the frame's axes."""
        return self.pose(body).point(point)

    def located(self, pair: int, body: int) -> Planar:
        """The point where a pair meets one of its bodies, in that body's axes."""
        if pair == len(self.linkage.points):
            assert self.target is not None
            return self.target if body == 0 else self._held or self.planar(self.linkage.foot[1])
        end = self.linkage.points[pair][self.linkage.structure.pairs[pair].bodies.index(body)]
        return (self._bars[body], sympy.S.Zero) if end is None else self.planar(end)

    @property
    def size(self) -> sympy.Expr:
        """What ways of a triad's sliders are measured in (m)."""
        return expression(self.linkage.size, self._parameters)

    def planar(self, point: Point) -> Planar:
        """A point of the spec."""
        x, y = (expression(entry, self._parameters) for entry in point)
        return (constant(x) if x.is_number else x, constant(y) if y.is_number else y)

    def joint(self, pair: int) -> Planar:
        """Where a pair is, in the frame's axes: a pin, or a slider's sliding point."""
        body = next(body for body in self.bodies(pair) if body not in self.linkage.structure.bars)
        return self.point(body, self.located(pair, body))

    def along(self, slider: int) -> Planar:
        """The direction of a slider's guide, in the frame's axes."""
        return turned(self.pose(self.linkage.structure.pairs[slider].bodies[1]).rotor, self._direction(slider))

    def within(self, pair: int, cluster: int) -> int:
        """The body of a cluster that a pair joins."""
        return next(body for body in self.bodies(pair) if self.cluster[body] == cluster)

    def guided(self, slider: int) -> Planar:
        """The direction of a slider's guide, in the axes of its cluster."""
        guide = self.linkage.structure.pairs[slider].bodies[1]
        return turned(self._pose[guide].rotor, self._direction(slider))

    def bodies(self, pair: int) -> tuple[int, ...]:
        """What a pair joins; the pin that holds the foot is the one after the last."""
        return (0, self.linkage.foot[0]) if pair == len(self.linkage.points) else self.linkage.structure.pairs[pair].bodies

    def _direction(self, pair: int) -> Planar:
        """Of a slider's guide, in its body's axes."""
        cosine, sine = cosine_sine(expression(self.linkage.angles[pair], self._parameters))
        return (cosine, sine)

    def end(self, pair: int, cluster: int) -> Planar:
        """Where the pair meets a cluster, in the cluster's axes."""
        body = self.within(pair, cluster)
        return self._pose[body].point(self.located(pair, body))

    def join(self, base: int, moved: int, pose: PlanarPose, name: str) -> None:
        """Put a cluster, whose pose in the base's axes is found, among the base's bodies; the frame's cluster takes the other in."""
        if self.cluster[0] == moved:
            base, moved, pose = moved, base, pose.inverse()
        pose = pose.named(self.tape, name)
        for body, cluster in enumerate(self.cluster):
            if cluster == moved:
                joined = pose * self._pose[body]
                self._pose[body] = joined.named(self.tape, self.linkage.structure.names[body])
                self.cluster[body] = base

    def drive(self, drive: Drive, value: sympy.Expr) -> None:
        """Join two clusters by a pair of a known value."""
        base, moved, name = self.cluster[drive.base], self.cluster[drive.moved], self.name(drive.pair)
        if self.kind(drive.pair) == "P":
            self.join(base, moved, self.way(drive.pair, base, moved).at(value), name)
            return
        turn = (self.tape.let(f"cos_{name}", sympy.cos(value)), self.tape.let(f"sin_{name}", sympy.sin(value)))
        rotor = turned(turned(self._pose[drive.base].rotor, turn), conjugate(self._pose[drive.moved].rotor))
        origin = difference(self.end(drive.pair, base), turned(rotor, self.end(drive.pair, moved)))
        self.join(base, moved, PlanarPose(origin, rotor), name)

    def way(self, pair: int, base: int, moved: int) -> Way:
        """A cluster in another's axes along the slider between them."""
        runner, guide = self.linkage.structure.pairs[pair].bodies
        along = self.guided(pair)
        if self.cluster[guide] == base:
            rotor = turned(self._pose[guide].rotor, conjugate(self._pose[runner].rotor))
        else:
            rotor = turned(self._pose[runner].rotor, conjugate(self._pose[guide].rotor))
            along = stretched(-_ONE, turned(rotor, along))
        origin = difference(self.end(pair, base), turned(rotor, self.end(pair, moved)))
        return Way(PlanarPose(origin, rotor), along)

    def pinned(self, start: Planar, end: Planar, own: tuple[Planar, Planar]) -> PlanarPose:
        """The pose of a body two of whose points lie at start and end."""
        span = difference(own[1], own[0])
        rotor = stretched(1 / square(span), turned(difference(end, start), conjugate(span)))
        return PlanarPose(difference(start, turned(rotor, own[0])), rotor)

    def name(self, pair: int) -> str:
        """Of a pair."""
        return "foot" if pair == len(self.linkage.points) else self.linkage.structure.pairs[pair].name

    def kind(self, pair: int) -> str:
        """Of a pair, R or P."""
        return "R" if pair == len(self.linkage.points) else self.linkage.structure.pairs[pair].kind
