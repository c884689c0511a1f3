"""Points of mass made part of rigid bodies, exactly."""

from collections.abc import Sequence

from walkgen.model.mechanism import Body
from walkgen.spec.scalar import ZERO, Scalar, Vector, add, div, mul, neg, sub, total

Lump = tuple[Scalar, Vector]
"""Mass (kg) at a point of the body's frame (m)."""
_NOTHING = Body(ZERO, (ZERO, ZERO, ZERO), (ZERO,) * 6)
_PRODUCTS = ((0, 1), (0, 2), (1, 2))


def with_lumps(body: Body | None, lumps: Sequence[Lump]) -> Body | None:
    """The body with points of mass fixed to it; None where there is nothing at all."""
    if not lumps:
        return body
    own = body or _NOTHING
    parts = [(own.mass, own.com), *lumps]
    mass = total(part for part, _ in parts)
    x, y, z = (div(total(mul(part, at[axis]) for part, at in parts), mass) for axis in range(3))
    offsets = [(part, (sub(at[0], x), sub(at[1], y), sub(at[2], z))) for part, at in parts]
    added = [_added(part, offset) for part, offset in offsets]
    xx, yy, zz, xy, xz, yz = (total((entry, *(each[place] for each in added))) for place, entry in enumerate(own.inertia))
    return Body(mass, (x, y, z), (xx, yy, zz, xy, xz, yz))


def _added(mass: Scalar, offset: Vector) -> tuple[Scalar, ...]:
    """What a point adds to xx, yy, zz, xy, xz, yz: m (|d|^2 1 - d d')."""
    squares = [mul(entry, entry) for entry in offset]
    diagonal = (mul(mass, add(squares[(axis + 1) % 3], squares[(axis + 2) % 3])) for axis in range(3))
    return (*diagonal, *(neg(mul(mass, mul(offset[row], offset[column]))) for row, column in _PRODUCTS))
