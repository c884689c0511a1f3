"""How legs, platforms and chains hang together, tolerant of what is broken, for every check that must follow a reference."""

from collections.abc import Iterator

from walkgen.spec.schema import LegDesign, LegSpec, RobotSpec

_CORNERS = 4


def originals(spec: RobotSpec, leg: LegSpec) -> Iterator[LegSpec]:
    """The leg, the leg that it mirrors, and so on; ends at an unknown name or before a leg met earlier."""
    legs = {entry.name: entry for entry in reversed(spec.legs)}
    met: set[str] = set()
    step: LegSpec | None = leg
    while step is not None and step.name not in met:
        yield step
        met.add(step.name)
        step = legs.get(step.mirror_of) if step.mirror_of is not None else None


def _source(spec: RobotSpec, leg: LegSpec) -> LegSpec:
    *_, last = originals(spec, leg)
    return last


def design_of(spec: RobotSpec, leg: LegSpec) -> LegDesign | None:
    """The leg's design, its own or that of the leg it mirrors."""
    return spec.leg_designs.get(_source(spec, leg).design or "")


def contacts_of(spec: RobotSpec) -> dict[str, int]:
    """On how many points each leg stands: the corners of its sole, both edges of a rolling one without a width, one."""
    return {leg.name: _contacts(_source(spec, leg), design_of(spec, leg)) for leg in spec.legs}


def _contacts(leg: LegSpec, design: LegDesign | None) -> int:
    rolling = None if design is None else design.curved_sole
    if rolling is not None:
        return _CORNERS if rolling.si("width") is not None else _CORNERS // 2
    return _CORNERS if leg.sole is not None or (design is not None and design.sole is not None) else 1


def platform_of(spec: RobotSpec, leg: LegSpec) -> str | None:
    """Name of the platform that the leg, or the leg it mirrors, is mounted on."""
    return _source(spec, leg).platform


def mirror_circle(spec: RobotSpec, leg: LegSpec) -> list[str]:
    """Names of the legs that mirror each other in a circle through this leg; empty if there is none, or if names are not unique."""
    if sum(other.name == leg.name for other in spec.legs) > 1:
        return []
    names = [entry.name for entry in originals(spec, leg)]
    return [*names, leg.name] if _source(spec, leg).mirror_of == leg.name else []


def platform_circle(spec: RobotSpec, name: str) -> list[str]:
    """Names of the platforms that are each other's parents in a circle through this one but not the root; empty if there is none."""
    parents = {entry.name: entry.parent for entry in reversed(spec.platforms)}
    names = [name]
    while (parent := parents.get(names[-1])) is not None and parent not in names:
        names.append(parent)
    return [*names, name] if parent == name and spec.platforms[0].name not in names else []
