"""A planar linkage held by its drives: as many equations of its pairs as there are unknowns, whatever the order of placement."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from walkgen.model.linkage import Linkage, Point
from walkgen.model.walk import CONTEXT
from walkgen.spec.pair_equations import PairEquations, Planar, Row, Seen
from walkgen.spec.scalar import evaluate


class DrivenLoops:
    """A linkage at given drives.

    Args:
        linkage: bodies and pairs.
        values: the runtime parameters' values by name.
        drives: its q.
        real: what numbers are: `float`, or the 50 digits of `CONTEXT.mpf`.
    """

    def __init__(
        self, linkage: Linkage, values: Mapping[str, Any], drives: Sequence[Any], real: Callable[[Any], Any] = CONTEXT.mpf
    ) -> None:
        self.linkage, self.drives, self.real, self.values = linkage, [real(drive) for drive in drives], real, values
        self.size = 3 * (len(linkage.structure.names) - 1)
        self._drive_of = {pair: number for number, pair in enumerate(linkage.driven)}
        circular: Any = math if real is float else CONTEXT
        points = [[None if point is None else self.planar(point) for point in ends] for ends in linkage.points]
        angles = [self._number(angle) for angle in linkage.angles]
        first_bar = self.size + len(linkage.driven)
        self._pairs = PairEquations(linkage.structure, points, angles, real, circular.cos, circular.sin, first_bar)

    def _number(self, scalar: Any) -> Any:
        return self.real(evaluate(scalar, CONTEXT, self.values))

    def planar(self, point: Point) -> Planar:
        """A point of the spec in numbers."""
        return self._number(point[0]), self._number(point[1])

    @property
    def _bars(self) -> Sequence[Any]:
        return self.drives[len(self.linkage.driven) :]

    @property
    def reach(self) -> float:
        """The largest coordinate of any point and the largest drive that is a length."""
        points = [abs(float(entry)) for ends in self._pairs.points for point in ends if point for entry in point]
        turning = {number for pair, number in self._drive_of.items() if self.linkage.structure.pairs[pair].kind == "R"}
        lengths = [abs(float(drive)) for number, drive in enumerate(self.drives) if number not in turning]
        return max(*points, *lengths, 1e-3)

    def seen(self, x: Sequence[Any], body: int, point: Planar) -> Seen:
        """A point of a body."""
        return self._pairs.seen(x, body, point)

    def end(self, x: Sequence[Any], pair: int, place: int) -> Seen:
        """The point of a pair on one of its bodies, by the body's place among them."""
        return self._pairs.end(x, self._bars, pair, place)

    def angle(self, x: Sequence[Any], body: int) -> Any:
        """Of a body to the frame."""
        return self._pairs.angle(x, body)

    def guide(self, x: Sequence[Any], pair: int) -> Planar:
        """The direction of a slider's guide in the frame's axes."""
        return self._pairs.guide(x, pair)

    def equations(self, x: Sequence[Any]) -> Iterator[tuple[Any, Row]]:
        """As many as there are unknowns: what is 0 where all pairs hold, and its slopes by the unknowns, then by the drives."""
        for index, pair in enumerate(self.linkage.structure.pairs):
            yield from self._pairs.rows(x, self._bars, index)
            if index in self._drive_of:
                drive = self._drive_of[index]
                value, slopes = self.along(x, index) if pair.kind == "P" else self._pairs.turn(x, pair.bodies[0], pair.bodies[1])
                yield value - self.drives[drive], slopes | {self.size + drive: self.real(-1)}

    def along(self, x: Sequence[Any], slider: int) -> tuple[Any, Row]:
        """How far a slider is along its guide."""
        return self._pairs.along(x, self._bars, slider)[0]
