"""Joints as screws at q = 0, the data that support routines work on: an axis and a point a joint, then where the tip is."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

import sympy

from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.forward import Route, flat
from walkgen.symbolic.frames import Frame, Parameters, expression, frame_of, parameter_symbols, rotation_about
from walkgen.symbolic.function import Step
from walkgen.symbolic.ports import parameter_ports, signature
from walkgen.symbolic.tape import Tape, Vec, constant_vector, scaled

_Z = 2
_WORDS = "Joints as screws at q = 0: axis and a point on it, base to tip, then the foot."
_SOURCE = "product of exponentials (Brockett 1984)"


@dataclass(frozen=True)
class Screw:
    """A joint at q = 0: its unit axis, positive for growing q, and a point on it (m), in the path's base frame."""

    axis: Vec
    point: Vec

    @property
    def numbers(self) -> tuple[sympy.Expr, ...]:
        """The six of them."""
        return (*self.axis, *self.point)


@dataclass(frozen=True)
class Screws:
    """A path's joints and its tip's frame at q = 0."""

    joints: tuple[Screw, ...]
    tip: Frame


def screws(limbs: Sequence[Limb], parameters: Parameters, tape: Tape, base: Frame | None = None) -> Screws:
    """The joints of limbs, one behind the other; constants fold, runtime parameters stay."""
    frame = base or Frame()
    found: list[Screw] = []
    for limb in limbs:
        frame = _named(frame * frame_of(limb.mount, parameters), "mount", tape)
        for joint in limb.joints:
            frame = frame * frame_of(joint.before, parameters)
            found.append(Screw(constant_vector(scaled(sympy.Integer(joint.sign), frame.rotation[_Z])), frame.origin))
            frame = _named(frame * _at_rest(joint, parameters) * frame_of(joint.after, parameters), joint.name, tape)
        frame = frame * frame_of(limb.tip, parameters)
    return Screws(tuple(found), frame)


def sequence_of(joints: Sequence[Joint]) -> int:
    """The joints' kinds as one number: a leading binary 1, then a digit a joint, base to tip: 0 turns, 1 slides (RRR is 8)."""
    return int("1" + "".join("1" if joint.kind == "prismatic" else "0" for joint in joints), 2)


def geometry_port(joints: Sequence[Joint], *, posed: bool = False) -> Port:
    """[6n + 3], or [6n + 12] with the tip's rotation."""
    return Port("geometry", (6 * len(joints) + (12 if posed else 3),), "m and 1")


def geometry_step(mechanism: Mechanism, route: Route, *, posed: bool = False) -> Step:
    """Fills the local `geometry` with the path's screws."""
    tape = Tape()
    path = screws(route.limbs, parameter_symbols(mechanism), tape)
    tip = (*path.tip.origin, *(flat(path.tip.rotation) if posed else ()))
    port = geometry_port(route.joints, posed=posed)
    words = signature(mechanism, route.owner, "screws_and_pose" if posed else "screws", [], [port], _WORDS, _SOURCE)
    function = tape.function(words, [*chain.from_iterable(screw.numbers for screw in path.joints), *tip])
    return Step(function, (*(one.name for one in parameter_ports(mechanism)), port.name))


def limits_port(joints: Sequence[Joint]) -> Port:
    """[n, 2], infinite where a joint has none."""
    return Port("limits", (len(joints), 2), "rad or m")


def limits_step(mechanism: Mechanism, owner: str, joints: Sequence[Joint]) -> Step:
    """Fills the local `limits`."""
    port = limits_port(joints)
    words = signature(mechanism, owner, "limits", [], [port], "Joint limits: least and greatest, infinite where there is none.", "")
    bounds = list(chain.from_iterable(limits_of(joint, parameter_symbols(mechanism)) for joint in joints))
    return Step(Tape().function(words, bounds), (*(one.name for one in parameter_ports(mechanism)), port.name))


def limits_of(joint: Joint, parameters: Parameters) -> Iterator[sympy.Expr]:
    """Least and greatest q."""
    if joint.limits is None:
        yield from (-sympy.oo, sympy.oo)
    else:
        yield from (expression(limit, parameters) for limit in joint.limits)


def _at_rest(joint: Joint, parameters: Parameters) -> Frame:
    """The joint's own motion at q = 0."""
    zero = expression(joint.zero, parameters)
    if joint.kind == "revolute":
        return rotation_about(_Z, zero)
    return Frame(origin=constant_vector((sympy.S.Zero, sympy.S.Zero, zero)))


def _named(frame: Frame, name: str, tape: Tape) -> Frame:
    """Keep expressions in runtime parameters small."""
    x, y, z = (tape.vector(f"{name}_{axis}", column) for axis, column in zip("xyz", frame.rotation, strict=True))
    return Frame((x, y, z), tape.vector(f"{name}_origin", frame.origin))
