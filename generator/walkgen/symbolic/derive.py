"""derive: every function asked for, leg by leg, chain by chain, route by route, then the robot's own, the ground's and the gaits'."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial

from walkgen.model.classify import inverse_class
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.spec.branches import BRANCHED_JOINTS
from walkgen.spec.functions import TERRAIN_FUNCTIONS
from walkgen.symbolic.adapt import adapt_functions
from walkgen.symbolic.chain_reactions import chain_reactions
from walkgen.symbolic.closing import closed
from walkgen.symbolic.columns import path_function
from walkgen.symbolic.compliance import StanceCompliance, foot_compliance, sole_compliance
from walkgen.symbolic.contact import contact_functions
from walkgen.symbolic.curved_soles import curved_sole_functions
from walkgen.symbolic.driven_search import inverse_driven
from walkgen.symbolic.forward import CHAIN, FOOT, Entry, PathFunctions, Route, Sided
from walkgen.symbolic.function import Derivation
from walkgen.symbolic.gait import gait_functions
from walkgen.symbolic.inverse import inverse, inverse_branch
from walkgen.symbolic.leg_functions import DYNAMICS, SPRUNG, LegFunctions
from walkgen.symbolic.likeness import of_legs
from walkgen.symbolic.limits import inverse_admissible, inverse_distance, inverse_near, within_limits
from walkgen.symbolic.linkage_functions import LINKAGE, linkage_function
from walkgen.symbolic.linkage_rows import inverses
from walkgen.symbolic.rates import inverse_acceleration, inverse_velocity
from walkgen.symbolic.rates_together import inverse_velocity_acceleration
from walkgen.symbolic.reach import inverse_pose, inverse_pose_driven, inverse_reach
from walkgen.symbolic.robot import RobotFunctions
from walkgen.symbolic.robot_dynamics import ROBOT_DYNAMICS, FloatingFunctions
from walkgen.symbolic.settle import settle
from walkgen.symbolic.sides import sides
from walkgen.symbolic.soles import SoleFunctions
from walkgen.symbolic.stability import StabilityFunctions
from walkgen.symbolic.stance import stance_functions
from walkgen.symbolic.terrain import TerrainFunctions

LegBuilder = Callable[[Mechanism, Limb], Derivation]
PathBuilder = Callable[[Mechanism, Route], Derivation]
RatesBuilder = Callable[[Mechanism, Route, Sided | None], Derivation]

BRANCHED: dict[str, LegBuilder] = {
    "inverse": inverse,
    "inverse_branch": inverse_branch,
    "inverse_near": inverse_near,
    "inverse_admissible": inverse_admissible,
    "inverse_distance": inverse_distance,
}
"""Of legs of one to three joints, whose branches are known."""

FLAT: dict[str, LegBuilder] = {name: BRANCHED[name] for name in ("inverse", "inverse_branch", "inverse_near", "inverse_distance")}
"""Of legs with curved soles whose feet are put flat."""

ITERATED: dict[str, PathBuilder] = {"inverse_near": inverse_reach, "inverse_pose": inverse_pose}
"""Of longer legs and routes."""

RATES: dict[str, RatesBuilder] = {
    "inverse_velocity": inverse_velocity,
    "inverse_acceleration": inverse_acceleration,
    "inverse_velocity_acceleration": inverse_velocity_acceleration,
}
"""Of every leg and route, from its Jacobian."""

YIELDING: dict[str, Callable[[Mechanism, Limb], Derivation | None]] = {
    "foot_compliance": foot_compliance,
    "sole_compliance": sole_compliance,
}
"""Of legs whose links have sections, at a sole where they have one."""

Wanted = Callable[[str], bool]
Section = Callable[[], Iterator[Derivation]]


def derive(mechanism: Mechanism, names: tuple[str, ...] = ()) -> Iterator[Derivation]:
    """Derive the named functions, all when no names are given; a name serves every leg, chain or route that has it."""
    for section in sections(mechanism, names):
        yield from section()


def sections(mechanism: Mechanism, names: tuple[str, ...] = ()) -> tuple[Section, ...]:
    """The same in parts that have nothing to do with each other, in order."""
    return tuple(partial(_closed, mechanism, part, _wanted(names)) for part in _SECTIONS)


def _closed(mechanism: Mechanism, part: Callable[[Mechanism, Wanted], Iterable[Derivation]], wanted: Wanted) -> Iterator[Derivation]:
    return (closed(mechanism, derivation) for derivation in part(mechanism, wanted))


def _wanted(names: tuple[str, ...]) -> Wanted:
    return lambda name: not names or name in names


def _of_legs(mechanism: Mechanism, wanted: Wanted) -> Iterator[Derivation]:
    return of_legs(mechanism.legs, lambda leg: _of_leg(mechanism, leg, wanted))


def _of_leg(mechanism: Mechanism, leg: Limb, wanted: Wanted) -> Iterator[Derivation]:
    yield from _path(mechanism, Route(leg.name, (leg,)), FOOT, wanted)
    yield from _leg_inverse(mechanism, leg, wanted)
    yield from _loaded(mechanism, leg, wanted)


def _of_paths(mechanism: Mechanism, wanted: Wanted) -> Iterator[Derivation]:
    """Chains and routes."""
    for limb in mechanism.chains:
        yield from _path(mechanism, Route(limb.name, (limb,)), CHAIN, wanted)
    ways = routes(mechanism)
    sided = sides(mechanism, ways)
    for route in ways:
        yield from _path(mechanism, route, FOOT, wanted, sided.get(route))
        yield from _path_inverse(mechanism, route, wanted, sided.get(route))


def _of_robot(mechanism: Mechanism, wanted: Wanted) -> Iterator[Derivation]:
    """All limbs together."""
    yield from _built(RobotFunctions(mechanism).functions(), wanted)
    if all(leg.curved_sole is None for leg in mechanism.legs):
        yield from _built(adapt_functions(mechanism), wanted)


def _of_dynamics(mechanism: Mechanism, wanted: Wanted) -> Iterator[Derivation]:
    floating = FloatingFunctions(mechanism)
    yield from _dynamics(floating.function, ROBOT_DYNAMICS, wanted)
    if mechanism.terrain and wanted("settle"):
        surface = TerrainFunctions(mechanism, mechanism.terrain).surface()
        yield from _existing([settle(mechanism, RobotFunctions(mechanism).foot_positions(), floating.weight(), surface)])


def _of_contact(mechanism: Mechanism, wanted: Wanted) -> Iterator[Derivation]:
    return _built(contact_functions(mechanism) | stance_functions(mechanism), wanted)


def _of_compliance(mechanism: Mechanism, wanted: Wanted) -> Iterator[Derivation]:
    return _built(StanceCompliance(mechanism).functions() | chain_reactions(mechanism), wanted)


def _of_stability(mechanism: Mechanism, wanted: Wanted) -> Iterator[Derivation]:
    return _built(StabilityFunctions(mechanism, FloatingFunctions(mechanism).mass).functions(), wanted)


def _of_walks(mechanism: Mechanism, wanted: Wanted) -> Iterator[Derivation]:
    """Ground and gaits."""
    if mechanism.terrain:
        ground = TerrainFunctions(mechanism, mechanism.terrain)
        yield from (ground.function(name) for name in TERRAIN_FUNCTIONS if wanted(name))
    yield from (build() for name, build in gait_functions(mechanism) if wanted(name))


_SECTIONS = (_of_legs, _of_paths, _of_robot, _of_dynamics, _of_contact, _of_compliance, _of_stability, _of_walks)


def _built(builders: Mapping[str, Callable[[], Derivation]], wanted: Wanted) -> Iterator[Derivation]:
    return (build() for name, build in builders.items() if wanted(name))


def _loaded(mechanism: Mechanism, leg: Limb, wanted: Wanted) -> Iterator[Derivation]:
    """Dynamics, contacts, and compliance."""
    yield from _dynamics(LegFunctions(mechanism, leg).function, DYNAMICS | SPRUNG, wanted)
    yield from (build() for name, build in SoleFunctions(mechanism, leg).functions().items() if wanted(name))
    yield from (build() for name, build in curved_sole_functions(mechanism, leg).items() if wanted(name))
    if leg.linkage is not None:
        yield from (linkage_function(mechanism, leg, name) for name in LINKAGE if wanted(name))
    yield from _existing(build(mechanism, leg) for name, build in YIELDING.items() if wanted(name))


def _dynamics(build: Callable[[str], Derivation | None], names: Iterable[str], wanted: Wanted) -> Iterator[Derivation]:
    """Without what the mechanism cannot have."""
    return _existing(build(name) for name in names if wanted(name))


def _existing(derived: Iterable[Derivation | None]) -> Iterator[Derivation]:
    return (function for function in derived if function is not None)


def routes(mechanism: Mechanism) -> tuple[Route, ...]:
    """Chains and leg from the root platform to each foot that does not stand on it."""
    return tuple(
        Route(f"root_to_{leg.name}", (*mechanism.ancestors(leg.platform), leg))
        for leg in mechanism.legs
        if mechanism.ancestors(leg.platform)
    )


def _path(
    mechanism: Mechanism, route: Route, entries: dict[str, Entry], wanted: Wanted, sided: Sided | None = None
) -> Iterator[Derivation]:
    path = PathFunctions(mechanism, route, sided)
    yield from (path_function(mechanism, route, path, name, entry) for name, entry in entries.items() if wanted(name))


def _leg_inverse(mechanism: Mechanism, leg: Limb, wanted: Wanted) -> Iterator[Derivation]:
    """All branches where they are known."""
    if leg.curved_sole is not None:
        builders = FLAT if inverse_class(mechanism, leg).name else {}
        yield from (build(mechanism, leg) for name, build in builders.items() if wanted(name))
    elif leg.linkage is not None:
        yield from (function for function in inverses(mechanism, leg) if wanted(function.signature.name))
    elif inverse_class(mechanism, leg).name:
        yield from (build(mechanism, leg) for name, build in BRANCHED.items() if wanted(name))
    elif wanted("inverse_admissible"):
        yield inverse_admissible(mechanism, leg)
    yield from _path_inverse(mechanism, Route(leg.name, (leg,)), wanted)


def _path_inverse(mechanism: Mechanism, route: Route, wanted: Wanted, sided: Sided | None = None) -> Iterator[Derivation]:
    """What any path has; the iterated inverse where there are too many joints for branches."""
    if wanted("within_limits"):
        yield within_limits(mechanism, route)
    yield from (build(mechanism, route, sided) for name, build in RATES.items() if wanted(name))
    yield from (build(mechanism, route) for name, build in _iterated(mechanism, route).items() if wanted(name))


def _iterated(mechanism: Mechanism, route: Route) -> dict[str, PathBuilder]:
    """What is found by iteration where branches are not known; not where the point that is led moves along the foot."""
    if route.limbs[-1].curved_sole is not None:
        return {}
    if route.limbs[-1].linkage is None:
        return ITERATED if len(route.joints) > BRANCHED_JOINTS else {}
    leg = route.limbs[-1]
    branched = len(route.limbs) == 1 and inverse_class(mechanism, leg).name
    followed = leg.linkage is not None and leg.linkage.forward.triads
    posed: dict[str, PathBuilder] = {"inverse_pose": inverse_pose_driven} if len(route.joints) > BRANCHED_JOINTS and not followed else {}
    return posed if branched else {"inverse_near": inverse_driven, **posed}
