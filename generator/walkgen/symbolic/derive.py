"""derive: every function asked for, leg by leg, chain by chain, route by route, then the robot's own."""

from collections.abc import Callable, Iterator

from walkgen.model.classify import inverse_class
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.symbolic.forward import CHAIN, FOOT, Entry, PathFunctions, Route
from walkgen.symbolic.function import Derivation, Solve
from walkgen.symbolic.inverse import inverse, inverse_branch
from walkgen.symbolic.rates import inverse_acceleration, inverse_velocity
from walkgen.symbolic.robot import RobotFunctions

INVERSE: dict[str, Callable[[Mechanism, Limb], Solve]] = {
    "inverse": inverse,
    "inverse_branch": inverse_branch,
}
RATES: dict[str, Callable[[Mechanism, Route], Solve]] = {
    "inverse_velocity": inverse_velocity,
    "inverse_acceleration": inverse_acceleration,
}


def derive(mechanism: Mechanism, names: tuple[str, ...] = ()) -> Iterator[Derivation]:
    """Derive the named functions, all when no names are given; a name serves every leg, chain or route that has it."""
    for leg in mechanism.legs:
        yield from _path(mechanism, Route(leg.name, (leg,)), FOOT, names)
        yield from _inverse(mechanism, leg, names)
    for limb in mechanism.chains:
        yield from _path(mechanism, Route(limb.name, (limb,)), CHAIN, names)
    for route in routes(mechanism):
        yield from _path(mechanism, route, FOOT, names)
    robot = RobotFunctions(mechanism)
    for name in ("platform_poses", "foot_positions", "foot_jacobians"):
        if _wanted(name, names):
            yield getattr(robot, name)()


def routes(mechanism: Mechanism) -> tuple[Route, ...]:
    """Chains and leg from the root platform to each foot that does not stand on it."""
    return tuple(
        Route(f"root_to_{leg.name}", (*mechanism.ancestors(leg.platform), leg))
        for leg in mechanism.legs
        if mechanism.ancestors(leg.platform)
    )


def _path(mechanism: Mechanism, route: Route, entries: dict[str, Entry], names: tuple[str, ...]) -> Iterator[Derivation]:
    path = PathFunctions(mechanism, route)
    for name, entry in entries.items():
        if _wanted(name, names):
            yield path.function(name, entry)


def _inverse(mechanism: Mechanism, leg: Limb, names: tuple[str, ...]) -> Iterator[Derivation]:
    if inverse_class(mechanism, leg).name:
        for name, build in INVERSE.items():
            if _wanted(name, names):
                yield build(mechanism, leg)
        for name, rates in RATES.items():
            if _wanted(name, names):
                yield rates(mechanism, Route(leg.name, (leg,)))


def _wanted(name: str, names: tuple[str, ...]) -> bool:
    return not names or name in names
