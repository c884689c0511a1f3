"""Cams that balance legs: which joint of which leg, how follower and spring lie there, and the total potential in numbers."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

from walkgen.errors import Place, Problem
from walkgen.model.cam_potential import CamError, OnFrame, OnLink, Pull, Weight
from walkgen.model.lumping import Lump, with_lumps
from walkgen.model.mechanism import Body, Cam, Joint, Limb, Mechanism, Transform
from walkgen.model.springs import Coil
from walkgen.model.transform import QUARTER_TURN, Y, Z, carried, inverse, rotation
from walkgen.model.values import Values
from walkgen.model.walk import CONTEXT, along, defaults, limb_frames
from walkgen.spec.balance import BalanceSpec
from walkgen.spec.scalar import ZERO, Exact, Pi, Scalar, div, evaluate, exact, mul, neg

_LEVEL, _SAME = CONTEXT.mpf(10) ** -9, CONTEXT.mpf(10) ** -15
_DIGITS = 40
_TWELFTHS = 12
Numbers = Mapping[str, Any]


def cams_of(leg: str, balances: Mapping[str, BalanceSpec], joints: Sequence[Joint], values: Values) -> tuple[Cam, ...]:
    """Those of the balances of a leg whose joints, in series or drives of its linkage, are these."""
    return tuple(_cams(leg, balances, joints, values))


def _cams(leg: str, balances: Mapping[str, BalanceSpec], joints: Sequence[Joint], values: Values) -> Iterator[Cam]:
    names = [joint.name for joint in joints]
    for name, balance in balances.items():
        table = balance.cam
        if balance.leg != leg or table is None:
            continue
        ((joint, span),) = balance.supported.items()
        low, high = (values.resolve(end) for end in span)
        held = tuple(values.resolve(balance.others.get(each)) for each in names)
        on: Literal["link", "frame"] = "link" if table.arm is not None else "frame"
        spring = Coil(name, *(values.resolve(entry) for entry in (table.stiffness, table.free_length, table.initial_tension)))
        weights = (table.masses.spring_at_link, table.masses.spring_at_follower, table.masses.follower, table.masses.roller)
        at_link, at_follower, follower, roller = (values.resolve(weight) for weight in weights)
        yield Cam(
            *(name, on, names.index(joint), (low, high), held, spring),
            load=values.resolve(balance.load),
            start=values.resolve(table.start),
            roller=values.resolve(table.roller),
            lever=values.resolve(table.arm if on == "link" else table.anchor),
            reach=values.resolve(table.reach),
            centre=values.resolve(table.centre) if on == "frame" else ZERO,
            masses=(at_link, at_follower, follower, roller),
        )


@dataclass(frozen=True)
class Placed:
    """A cam on its leg, whose platform is held as the spec's gravity has it.

    Attributes:
        potential: of link, load, follower and spring, in numbers, at the runtime parameters' defaults.
        guide: from the frame before the joint (cam on the link), or from the one that moves with it (cam on the frame), to one whose z is
            the way of the roller, from the hip.
        follower: what slides there, in a frame at the roller's centre; None where it weighs nothing.
        hooked: what the spring weighs on the link, in the frame that moves with the joint; None where it is nothing.
    """

    potential: OnLink | OnFrame
    guide: Transform
    follower: Body | None
    hooked: Body | None


def placed(mechanism: Mechanism, leg: Limb, cam: Cam) -> Placed:
    """A leg's cam.

    Raises:
        CamError: the joint is not level, or there is no gravity.
    """
    values, joint = defaults(mechanism), leg.joints[cam.joint]
    up, gravity = _up(mechanism, leg, cam, values)
    level = _angle(up - joint.sign * CONTEXT.pi / 2)
    to_link = inverse(joint.after) + rotation(Z, neg(joint.zero)) + rotation(Z, level)
    guide = joint.before + rotation(Z, _angle(up)) if cam.on == "link" else to_link
    at_link, at_follower, follower, roller = cam.masses
    ways = ((roller, ZERO), (at_follower, neg(cam.reach) if cam.on == "link" else cam.reach), (follower, cam.centre))
    hook: Lump = (at_link, carried(to_link, (cam.lever, ZERO, ZERO)))
    return Placed(
        potential_of(cam, weight_of(mechanism, leg, cam, values), gravity, lambda scalar: evaluate(scalar, CONTEXT, values)),
        guide + rotation(Y, QUARTER_TURN),
        with_lumps(None, [(mass, (ZERO, ZERO, way)) for mass, way in ways if mass != ZERO]),
        with_lumps(None, [hook] if cam.on == "link" and at_link != ZERO else []),
    )


_REFUSED = {
    "contact": ("WG222", "start elsewhere, or take a stiffer spring or another arm"),
    "undercut": ("WG223", "take a smaller roller, or start further out"),
    "slack": ("WG218", "give it a shorter free length, or a longer way"),
    "hinge": ("WG224", "balance a joint that turns about a level axis"),
}


def cam_problem(error: CamError, name: str, joint: str, place: Place | None = None) -> Problem:
    """Of a balance's cam at a joint, for users."""
    code, cure = _REFUSED[error.kind]
    at = "" if error.angle is None else f" at {joint} = {error.angle:.4g} rad"
    return Problem(code, f"balance {name}: {error}{at}", cure, place)


def _up(mechanism: Mechanism, leg: Limb, cam: Cam, values: Numbers) -> tuple[Any, Any]:
    """The angle of the direction against gravity about the joint's z, before its motion, and gravity's size."""
    pull = CONTEXT.matrix([evaluate(component, CONTEXT, values) for component in mechanism.gravity])
    size = CONTEXT.norm(pull)
    if size == 0:
        raise CamError("hinge", "there is no gravity to balance")
    frames = limb_frames(mechanism, leg, _posture(cam, CONTEXT.zero, values), values)
    axes = along(frames[cam.joint], leg.joints[cam.joint].before, values)[:3, :3]
    x, y, z = -(axes.T * pull) / size
    if abs(z) > _LEVEL:
        raise CamError("hinge", f"the axis of {leg.joints[cam.joint].name} is not level")
    return CONTEXT.atan2(y, x), size


def gravity_of(mechanism: Mechanism, leg: Limb, cam: Cam, values: Numbers) -> Any:
    """Its size where it pulls across the joint of a leg's cam (m/s^2).

    Raises:
        CamError: the joint is not level, or there is no gravity.
    """
    return _up(mechanism, leg, cam, values)[1]


def _angle(angle: Any) -> Scalar:
    """As exact as in a spec: multiples of 15 degrees are what they are."""
    twelfths = CONTEXT.nint(_TWELFTHS * angle / CONTEXT.pi)
    if abs(angle - twelfths * CONTEXT.pi / _TWELFTHS) < _SAME:
        return mul(div(exact(int(twelfths)), exact(_TWELFTHS)), Pi())
    return Exact(Fraction(CONTEXT.nstr(angle, _DIGITS)))


def _posture(cam: Cam, angle: Any, values: Numbers) -> list[Any]:
    q = [evaluate(value, CONTEXT, values) for value in cam.held]
    q[cam.joint] = angle
    return q


def potential_of(cam: Cam, weight: Weight, gravity: Any, number: Callable[[Scalar], Any]) -> OnLink | OnFrame:
    """The total potential of a cam.

    Args:
        cam: of a leg.
        weight: of all that its joint moves, without what the cam's spring weighs on the link.
        gravity: its size (m/s^2).
        number: gives numbers of a kind.
    """
    at_link, at_follower, follower, roller = (number(mass) for mass in cam.masses)
    stiffness, lever, reach = number(cam.spring.stiffness), number(cam.lever), number(cam.reach)
    spring = Pull(stiffness, number(cam.spring.tension) - stiffness * number(cam.spring.free_length))
    if cam.on == "link":
        own = Weight(weight.a - gravity * at_link * lever, weight.b)
        return OnLink(own, spring, gravity, lever, reach, at_follower + follower + roller)
    return OnFrame(weight, spring, gravity, lever, reach, (at_follower, follower, roller), number(cam.centre))


def weight_of(mechanism: Mechanism, leg: Limb, cam: Cam, values: Numbers) -> Weight:
    """Of all that the joint of a leg's cam moves, load included, for the runtime parameters' values: b cos(phi) - a sin(phi) and a constant
    are its potential.
    """
    pull = [evaluate(component, CONTEXT, values) for component in mechanism.gravity]
    load = evaluate(cam.load, CONTEXT, values)

    def energy(angle: Any) -> Any:
        *frames, foot = limb_frames(mechanism, leg, _posture(cam, angle, values), values)
        moments = [load * foot[:3, 3]]
        for joint, frame in zip(leg.joints[cam.joint :], frames[cam.joint + 1 :], strict=True):
            if joint.body:
                mass, *com = (evaluate(entry, CONTEXT, values) for entry in (joint.body.mass, *joint.body.com))
                moments.append(-mass * (frame * CONTEXT.matrix([*com, 1]))[:3])
        return sum(component * sum(moment[axis] for moment in moments) for axis, component in enumerate(pull))

    ahead, above, behind = (energy(quarters * CONTEXT.pi / 2) for quarters in range(3))
    return Weight((ahead + behind) / 2 - above, (ahead - behind) / 2)
