"""Routes that differ in the side of a platform on which their legs stand: one text with the side as a factor serves both."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from itertools import chain

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.symbolic.forward import SIDE, Route, Sided
from walkgen.symbolic.frames import Frame, parameter_symbols
from walkgen.symbolic.path import Path, path_of, yaw_of
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.tape import Vec, symbols_of

_FACTOR = symbols_of(SIDE)[0]


def sides(mechanism: Mechanism, routes: Sequence[Route]) -> Mapping[Route, Sided]:
    """The routes that share their path with another one, each with it.

    Two do whose numbers are the same but for signs where the leg is mounted, behind a joint: multiplied by 1 or -1 they are what they
    are, bit for bit.
    """
    found: dict[Route, Sided] = {}
    for number, route in enumerate(routes):
        later = (other for other in routes[number + 1 :] if other not in found and _comparable(mechanism, route, other))
        if route not in found:
            found |= next(_shared(mechanism, route, later), {})
    return found


def _comparable(mechanism: Mechanism, route: Route, other: Route) -> bool:
    """Whether both are joints in series with constant dimensions, after the same chains."""
    series = all(limb.linkage is None and limb.curved_sole is None for limb in (route.limbs[-1], other.limbs[-1]))
    return series and not mechanism.parameters and route.limbs[:-1] == other.limbs[:-1]


def _shared(mechanism: Mechanism, route: Route, others: Iterable[Route]) -> Iterator[dict[Route, Sided]]:
    entrance = len(route.joints) - len(route.limbs[-1].joints)
    for other in others:
        if (path := _joined(_path(mechanism, route), _path(mechanism, other), entrance)) is not None:
            yield {route: Sided(path, Decimal(1)), other: Sided(path, Decimal(-1))}


def _path(mechanism: Mechanism, route: Route) -> Path:
    return path_of(route.limbs, symbols_of(joint_port("q", route.joints)), parameter_symbols(mechanism))


def _joined(one: Path, other: Path, entrance: int) -> Path | None:
    """One path with what the other has with the other sign at the entrance of the leg; None where more differs."""
    if not entrance or yaw_of(one.links[entrance].rotation) is not None or _moving(one) != _moving(other):
        return None
    entered = _sided(one.links[entrance], other.links[entrance])
    if entered is None or one.links[:entrance] != other.links[:entrance] or one.links[entrance + 1 :] != other.links[entrance + 1 :]:
        return None
    return replace(one, links=(*one.links[:entrance], entered, *one.links[entrance + 1 :]))


def _moving(path: Path) -> tuple[object, ...]:
    """Everything of a path but its links."""
    return path.mount, path.afters, tuple((joint.kind, joint.sign, joint.zero) for joint in path.joints)


def _sided(one: Frame, other: Frame) -> Frame | None:
    """The first, its numbers times the side where the other's are opposite; None where they differ otherwise."""
    numbers = [(*frame.origin, *chain.from_iterable(frame.rotation)) for frame in (one, other)]
    if any(a not in (b, -b) for a, b in zip(*numbers, strict=True)):
        return None
    found = [a if a == b else a * _FACTOR for a, b in zip(*numbers, strict=True)]
    origin, x, y, z = (_vector(found[start : start + 3]) for start in range(0, 12, 3))
    return Frame((x, y, z), origin)


def _vector(components: Sequence[sympy.Expr]) -> Vec:
    x, y, z = components
    return (x, y, z)
