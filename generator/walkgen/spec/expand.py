"""Leg designs that name a common linkage, with its links and pins written out: what comes after reading knows the long form alone."""

from typing import Any

from walkgen.spec.joint_tables import LinkageEnd
from walkgen.spec.linkage import PlanarLinkSpec
from walkgen.spec.linkage_forms import LinkageTables, tables_of
from walkgen.spec.schema import FORMS, LegDesign, RobotSpec


def expanded(design: LegDesign) -> LegDesign:
    """The design in the long form: the short form's links and pins first, what the design adds to them after."""
    for form in design.forms.values():
        tables = tables_of(form)
        written = {
            "links": _links(design, tables),
            "pins": (*tables.pins, *design.pins),
            **_ends(design, tables),
            **dict.fromkeys(FORMS),
        }
        return design.model_copy(update=written)
    return design


def expanded_spec(spec: RobotSpec) -> RobotSpec:
    """Every design in the long form."""
    return spec.model_copy(update={"leg_designs": {name: expanded(design) for name, design in spec.leg_designs.items()}})


def _ends(design: LegDesign, tables: LinkageTables) -> dict[str, Any]:
    """The short form's foot is the design's, or where its joints after the linkage begin."""
    if not design.joints_after:
        return {"foot": design.foot or tables.foot}
    end = design.linkage_end or LinkageEnd()
    return {"linkage_end": end.model_copy(update={"point": end.point or tables.foot})}


def _links(design: LegDesign, tables: LinkageTables) -> dict[str, PlanarLinkSpec]:
    """Masses and further points of the short form's links, further links."""
    links = dict(tables.links)
    for name, added in design.links.items():
        own = tables.links.get(name)
        links[name] = added if own is None else added.model_copy(update={"points": {**own.points, **added.points}})
    return links
