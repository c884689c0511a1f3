"""The tables of springs between two links of a leg, or between a link and the leg's mount."""

from typing import Annotated, Any

from pydantic import Discriminator, StrictStr, Tag

from walkgen.spec.linkage import EndMasses
from walkgen.spec.table import Number, Table, Triple

MOUNT = "mount"
"""The link of a spring's end that does not move: the leg's first frame on its platform."""


class SpringPlace(Table):
    """A point of a link that a joint in series moves."""

    link: StrictStr
    """Name of the joint that moves it; "mount" is the leg's first frame on its platform."""
    xyz: Triple | None = None
    """In the frame after the joint's row (m)."""
    xyz_mm: Triple | None = None
    """The same in mm."""


def _end_kind(value: Any) -> str:
    return "spring:point" if isinstance(value, str) else "spring:place"


SpringEnd = Annotated[
    Annotated[StrictStr, Tag("spring:point")] | Annotated[SpringPlace, Tag("spring:place")],
    Discriminator(_end_kind),
]
TAGS = frozenset({"spring:point", "spring:place"})
"""Parts of pydantic's error places that are no keys."""


class SpringSpec(Table):
    """A tension spring: it pulls its ends together with initial_tension + stiffness * (length - free_length)."""

    name: StrictStr
    between: tuple[SpringEnd, SpringEnd]
    """A point of a linkage's link, as link.point, or { link = "thigh", xyz = [0.1, 0.0, 0.0] } of a joint's."""
    stiffness: Number
    """N/m"""
    free_length: Number | None = None
    """Where it begins to stretch (m)."""
    free_length_mm: Number | None = None
    """The same in mm."""
    initial_tension: Number | None = None
    """What stretches it at all: the coils' own tension (N); 0 where left out."""
    masses: EndMasses = EndMasses()
    """Its mass, lumped at its ends."""
