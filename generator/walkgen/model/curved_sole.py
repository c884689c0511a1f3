"""A cylindrical sole that rolls: its section in the plane of the foot frame's x and y, SI and exact."""

from dataclasses import dataclass
from typing import Literal

from walkgen.model.values import Values
from walkgen.spec.curved_sole import CurvedSoleSpec
from walkgen.spec.directrix import Piece, pieces_of
from walkgen.spec.scalar import ZERO, Scalar

Directrix = tuple[Piece, ...]
"""Pieces end to end, whose x and y (m) are expressions in lambda; none where the foot does not roll on that side."""


@dataclass(frozen=True)
class CurvedSole:
    """Flat from `rear` to `front` along y at x = `depth` (m), then curves; generatrices are `width` long, points where it is None.

    `side` is -1 for the mirror image of a leg: y points backward there. The ground rises forward by `slope` (rad).
    """

    depth: Scalar
    rear: Scalar
    front: Scalar
    width: Scalar | None
    toe: Directrix
    heel: Directrix
    slope: Scalar = ZERO
    side: Literal[1, -1] = 1

    def curves(self) -> dict[str, Directrix]:
        """Those on which the foot can roll, by their names."""
        return {name: pieces for name, pieces in (("toe", self.toe), ("heel", self.heel)) if pieces}


def curved_sole_of(sole: CurvedSoleSpec | None, values: Values) -> CurvedSole | None:
    """Of a leg design, whose curves were checked."""
    if sole is None:
        return None
    rear, front = (values.resolve(edge) for edge in sole.si("flat"))
    toe, heel = (_resolved(pieces_of(sole, which, values.number), values) for which in ("toe", "heel"))
    slope = values.optional(sole.si("slope")) or ZERO
    return CurvedSole(values.resolve(sole.si("depth")), rear, front, values.optional(sole.si("width")), toe, heel, slope)


def _resolved(pieces: Directrix, values: Values) -> Directrix:
    return tuple(Piece(*(values.resolve(scalar) for scalar in (piece.x, piece.y, piece.start, piece.end))) for piece in pieces)
