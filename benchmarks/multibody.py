"""The robots of benchmarks/dynamics.py as trees of bodies, read from their URDF by Pinocchio: what the peers are given."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
import pinocchio

from leg import Array
from trimmed import SPECS
from walkgen.emit.urdf import urdf
from walkgen.model.assemble import assemble
from walkgen.spec.read import read

Text = str | int
"""A number as a user writes it: a decimal, or a whole 0, 1 or -1, which every algebra simplifies away."""
Triple = tuple[Text, Text, Text]


@dataclass(frozen=True)
class Body:
    """A body with its joint: parent (-1: the base), fixed placement in the parent's axes, axis of turning, mass, inertia."""

    parent: int
    rotation: tuple[Triple, Triple, Triple]
    place: Triple
    axis: int
    mass: Text
    centre: Triple
    inertia: tuple[Triple, Triple, Triple]
    """About the centre of mass."""

    @property
    def moment(self) -> Triple:
        """Mass times centre."""
        return _texts(float(self.mass) * numbers(self.centre))

    @property
    def about_origin(self) -> tuple[Triple, Triple, Triple]:
        """Inertia about the joint."""
        c = numbers(self.centre)
        rows = numbers(self.inertia) + float(self.mass) * (c @ c * np.eye(3) - np.outer(c, c))
        return _rows(rows)


@dataclass(frozen=True)
class Foot:
    """A point of a body."""

    body: int
    place: Triple


@dataclass(frozen=True)
class Robot:
    """A tree in the order of walkgen's q; gravity (m/s^2) in the world's axes, which a held base has as its own."""

    name: str
    free: bool
    base: Body
    bodies: tuple[Body, ...]
    feet: tuple[Foot, ...]
    gravity: Triple

    @cached_property
    def depth_first(self) -> tuple[int, ...]:
        """Bodies in an order that Pinocchio takes: what a joint bears follows it at once."""
        return tuple(self._borne(-1))

    def _borne(self, index: int) -> Iterator[int]:
        for child, body in enumerate(self.bodies):
            if body.parent == index:
                yield child
                yield from self._borne(child)

    @cached_property
    def model(self) -> Any:
        """It as a Pinocchio model, joints depth first."""
        model = pinocchio.Model()
        model.gravity.linear = numbers(self.gravity)
        root = model.addJoint(0, pinocchio.JointModelFreeFlyer(), pinocchio.SE3.Identity(), "base") if self.free else 0
        model.appendBodyToJoint(root, _inertia(self.base), pinocchio.SE3.Identity())
        joints = {-1: root}
        for index in self.depth_first:
            body = self.bodies[index]
            turn = (pinocchio.JointModelRX, pinocchio.JointModelRY, pinocchio.JointModelRZ)[body.axis]()
            placement = pinocchio.SE3(numbers(body.rotation), numbers(body.place))
            joints[index] = model.addJoint(joints[body.parent], turn, placement, str(index))
            model.appendBodyToJoint(joints[index], _inertia(body), pinocchio.SE3.Identity())
        return model

    @cached_property
    def data(self) -> Any:
        return self.model.createData()


def _inertia(body: Body) -> Any:
    return pinocchio.Inertia(float(body.mass), numbers(body.centre), numbers(body.inertia))


def numbers(texts: Sequence[Any]) -> Array:
    return np.array(texts, dtype=float)


def _text(value: float) -> Text:
    """Noise of a rounded pi/2 removed, as a careful user does."""
    near = round(float(value), 15)
    return int(near) if near in {-1.0, 0.0, 1.0} else repr(near)


def _texts(values: Array) -> Triple:
    x, y, z = map(_text, values)
    return (x, y, z)


def _rows(matrix: Array) -> tuple[Triple, Triple, Triple]:
    x, y, z = map(_texts, matrix)
    return (x, y, z)


@cache
def robot(spec: str, free: bool) -> Robot:
    """The spec's robot through its URDF as Pinocchio reads it, joints in the order of q."""
    mechanism = assemble(read(SPECS / f"{spec}.toml"))
    found = pinocchio.buildModelFromXML(urdf(mechanism).text)
    order = [found.getJointId(f"{limb.name}_{joint.name}") for limb in mechanism.limbs for joint in limb.joints]
    places = {0: -1} | {joint: index for index, joint in enumerate(order)}
    bodies = tuple(_body(found, joint, places[found.parents[joint]]) for joint in order)
    gravity = _texts(np.array([0.0, 0.0, -9.80665]))
    return Robot(spec, free, _body(found, 0, -1), bodies, tuple(_feet(found, mechanism, places)), gravity)


def _body(model: Any, joint: int, parent: int) -> Body:
    inertia, placement = model.inertias[joint], model.jointPlacements[joint]
    axis = "XYZ".index(model.joints[joint].shortname()[-1]) if joint else 0
    place, turn = _texts(placement.translation), _rows(placement.rotation)
    return Body(parent, turn, place, axis, _text(inertia.mass), _texts(inertia.lever), _rows(inertia.inertia))


def _feet(model: Any, mechanism: Any, places: Mapping[int, int]) -> Iterator[Foot]:
    for leg in mechanism.legs:
        frame = model.frames[model.getFrameId(leg.name)]
        if not np.allclose(frame.placement.rotation, np.eye(3)):
            raise ValueError(f"{leg.name}: the foot's axes are not its link's")
        yield Foot(places[frame.parentJoint], _texts(frame.placement.translation))


def leg_robot() -> Robot:
    """The leg of specs/mero_leg.toml, its platform held."""
    return robot("mero_leg", free=False)


def mero_robot() -> Robot:
    """specs/mero.toml on a floating base."""
    return robot("mero", free=True)
