"""From the validated spec to the Mechanism: designs mounted, parameters resolved, mirrored legs reflected."""

from dataclasses import replace
from pathlib import Path

from walkgen.model.cams import cams_of
from walkgen.model.gaits import gaits
from walkgen.model.ground import ground
from walkgen.model.limbs import body_of, chain_limb, leg_limb, mirrored_limb
from walkgen.model.linkage_limb import linkage_limb
from walkgen.model.lumping import Lump, with_lumps
from walkgen.model.mechanism import Limb, Mechanism, Parameter, Platform, Section
from walkgen.model.springs import lumps
from walkgen.model.transform import carried
from walkgen.model.values import Values
from walkgen.spec.scalar import ZERO, Scalar, exact
from walkgen.spec.schema import LegSpec, PlatformSpec, RobotSpec

_LIMIT_WEIGHT, _NORMAL_WEIGHT, _CLEARANCE_WEIGHT = 1, 4, 20
"""Those of the theory's example."""


def assemble(spec: RobotSpec, folder: Path = Path()) -> Mechanism:
    """The robot that the spec describes.

    Args:
        spec: validated; its names, shapes and references are trusted here.
        folder: the spec's, where its height maps are.
    """
    values = Values.of(spec.parameters)
    names = [platform.name for platform in spec.platforms]
    children = [platform for platform in spec.platforms if platform.parent]
    legs = _legs(spec, names, values)
    return Mechanism(
        name=spec.robot.name,
        description=spec.robot.description,
        gravity=values.vector(spec.robot.si("gravity")),
        platforms=tuple(_platform(platform, children, _hung(legs, index), values) for index, platform in enumerate(spec.platforms)),
        chains=tuple(_chain(spec, platform, names, values) for platform in children),
        legs=legs,
        parameters=_parameters(spec, values),
        sections=_sections(spec, values),
        adapt_weights=_adapt_weights(spec, values),
        terrain=ground(spec, folder, values),
        gaits=gaits(spec, values),
    )


def _platform(platform: PlatformSpec, children: list[PlatformSpec], hung: tuple[Lump, ...], values: Values) -> Platform:
    body = body_of(platform.mass, platform.si("com"), platform.inertia, values) if platform.mass is not None else None
    return Platform(platform.name, children.index(platform) if platform.parent else None, with_lumps(body, hung))


def _hung(legs: tuple[Limb, ...], platform: int) -> tuple[Lump, ...]:
    """What springs weigh at the mounts of a platform's legs."""
    return tuple(
        (mass, carried(leg.mount, at)) for leg in legs if leg.platform == platform for mass, at in lumps(leg.springs, 0, planar=False)
    )


def _chain(spec: RobotSpec, platform: PlatformSpec, names: list[str], values: Values) -> Limb:
    design = spec.chain_designs[platform.chain or ""]
    return chain_limb(platform, design, names.index(platform.parent or ""), names.index(platform.name), values)


def _legs(spec: RobotSpec, platforms: list[str], values: Values) -> tuple[Limb, ...]:
    entries = {leg.name: leg for leg in spec.legs}
    return tuple(_leg(leg, entries, spec, platforms, values) for leg in spec.legs)


def _leg(leg: LegSpec, entries: dict[str, LegSpec], spec: RobotSpec, platforms: list[str], values: Values) -> Limb:
    if leg.mirror_of:
        original = _leg(entries[leg.mirror_of], entries, spec, platforms, values)
        return mirrored_limb(original, leg.name, leg.source_names)
    design, platform = spec.leg_designs[leg.design or ""], platforms.index(leg.platform or "")
    limb = (linkage_limb if design.planar else leg_limb)(leg, design, platform, values)
    return replace(limb, cams=cams_of(leg.name, spec.balance, limb.joints, values))


def _parameters(spec: RobotSpec, values: Values) -> tuple[Parameter, ...]:
    return tuple(
        Parameter(name, values.resolve(entry.value), entry.unit or "1", values.pair(entry.bounds))
        for name, entry in spec.parameters.items()
        if entry.runtime
    )


def _sections(spec: RobotSpec, values: Values) -> tuple[Section, ...]:
    return tuple(
        Section(name, *(values.resolve(getattr(section, key)) for key in ("E", "G", "A", "Iy", "Iz", "J")))
        for name, section in spec.sections.items()
    )


def _adapt_weights(spec: RobotSpec, values: Values) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Without a clearance no height is asked for."""
    given, clearance = spec.adapt, spec.adapt.si("clearance")
    weights = (
        (given.limit_weight, _LIMIT_WEIGHT),
        (given.normal_weight, _NORMAL_WEIGHT),
        (given.clearance_weight, _CLEARANCE_WEIGHT if clearance is not None else 0),
    )
    limit, normal, height = (exact(default) if weight is None else values.resolve(weight) for weight, default in weights)
    return limit, normal, height, ZERO if clearance is None else values.resolve(clearance)
