"""MuJoCo models of legs and robots with their bodies, straight from the text of a spec: a second peer for dynamics."""

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco
import numpy as np
import pinocchio as pin

from oracles.dynamic_peer import Bodies
from oracles.walker import MIRROR, Walker, WalkerJoint, WalkerLimb, rotation, translation

Array = np.ndarray
DRAFT = {"explicitinertial": True, "mass": 1.0, "ipos": [0.1, 0.2, 0.3], "fullinertia": [1.0, 1.1, 1.2, 0.1, 0.2, 0.3]}
"""What MuJoCo compiles every body with: it refuses bodies that weigh nothing and inertias that no real body has, but computes with them.
The centre and axes stand askew so that no shortcut for aligned bodies is compiled in; the spec's numbers replace these afterwards."""


class MujocoPeer:
    """One leg on a platform that is held (its own joints), or the whole robot on a free joint (the robot's joints)."""

    def __init__(self, text: str, leg: str = "", **parameters: float) -> None:
        self.bodies = Bodies(text, parameters)
        self.walker: Walker = self.bodies.walker
        self.spec = mujoco.MjSpec()
        self.spec.option.gravity = self.bodies.gravity()
        self.inertias: dict[str, tuple[pin.Inertia, Array]] = {}
        if leg:
            self._limb(self.walker.leg(leg), self.spec.worldbody, leg)
            joints = _joint_names(self.walker.leg(leg))
        else:
            self._platform(self.walker.platforms[0], self.spec.worldbody, np.eye(4)).add_freejoint()
            joints = [name for limb in (*self.walker.chains.values(), *self.walker.legs) for name in _joint_names(limb)]
        self.feet = (leg,) if leg else tuple(limb.name for limb in self.walker.legs)
        self.model = self.spec.compile()
        self._weigh()
        self.data = mujoco.MjData(self.model)
        self.places = np.array([self.model.joint(name).qposadr[0] for name in joints], dtype=int)
        dofs = [int(self.model.joint(name).dofadr[0]) for name in joints]
        self.columns = dofs if leg else [*range(6), *dofs]

    def _platform(self, name: str, parent: mujoco.MjsBody, place: Array) -> mujoco.MjsBody:
        """Its body, fast to the parent, with every limb on it and all that the limb bears."""
        body = self._body(f"{name} itself", parent, place, self.bodies.platform(name), np.eye(4))
        for child, chain in self.walker.chains.items():
            if chain.platform == name:
                self._platform(child, *self._limb(chain, body, child))
        for leg in self.walker.legs:
            if leg.platform == name:
                self._limb(leg, body, leg.name)
        return body

    def _limb(self, limb: WalkerLimb, parent: mujoco.MjsBody, name: str) -> tuple[mujoco.MjsBody, Array]:
        """Add joints, bodies and the tip as a site; the last body and the tip's place on it."""
        flip = MIRROR if limb.mirrored else np.eye(4)
        place = flip @ limb.mount @ flip
        for joint_name, joint, inertia in zip(_joint_names(limb), limb.joints, self.bodies.links(name), strict=True):
            after = flip @ joint.after @ flip
            parent = self._body(joint_name, parent, place @ flip @ joint.before @ _zero(joint) @ flip, inertia, after)
            kind = mujoco.mjtJoint.mjJNT_HINGE if joint.revolute else mujoco.mjtJoint.mjJNT_SLIDE
            parent.add_joint(name=joint_name, type=kind, axis=_direction(joint, mirrored=limb.mirrored))
            place = after
        place = place @ flip @ limb.tip @ flip
        parent.add_site(name=name, pos=place[:3, 3])
        return parent, place

    def _body(self, name: str, parent: mujoco.MjsBody, place: Array, inertia: pin.Inertia, frame: Array) -> mujoco.MjsBody:
        """A body at `place` [4,4] on its parent, whose inertia is told in `frame` [4,4] on itself."""
        self.inertias[name] = (inertia, frame)
        return parent.add_body(name=name, pos=place[:3, 3], quat=_quaternion(place[:3, :3]), **DRAFT)

    def _weigh(self) -> None:
        """Replace the draft's inertial numbers by the spec's, principal axes and all."""
        for name, (inertia, frame) in self.inertias.items():
            body = self.model.body(name)
            moments, axes = np.linalg.eigh(inertia.inertia)
            axes[:, 2] *= np.sign(np.linalg.det(axes))
            body.mass[0], body.inertia[:] = inertia.mass, moments
            body.ipos[:] = frame[:3, :3] @ inertia.lever + frame[:3, 3]
            body.iquat[:] = _quaternion(frame[:3, :3] @ axes)

    # ---- a leg, and what a robot shares with it: MuJoCo's configuration, rates and accelerations in MuJoCo's order

    def inverse(self, position: Array, rates: Array, accelerations: Array, forces: Array) -> Array:
        """Generalised forces [nv] of `mj_inverse`, less what the ground's forces [feet,3] on the feet do, in world axes."""
        self.data.qpos, self.data.qvel, self.data.qacc = position, rates, accelerations
        with _singular_is_fine():
            mujoco.mj_inverse(self.model, self.data)
        tau = np.array(self.data.qfrc_inverse)
        for foot, force in zip(self.feet, forces, strict=True):
            J = np.zeros((3, self.model.nv))
            mujoco.mj_jacSite(self.model, self.data, J, None, self.model.site(foot).id)
            tau -= J.T @ force
        return tau

    def mass_matrix(self, position: Array) -> Array:
        """[nv,nv]"""
        self._move(position, np.zeros(self.model.nv))
        columns = np.zeros((self.model.nv, self.model.nv))
        for column, unit in zip(columns, np.eye(self.model.nv), strict=True):
            mujoco.mj_mulM(self.model, self.data, column, unit)  # mj_fullM takes other arguments from version 4 on
        return columns.T

    def bias(self, position: Array, rates: Array) -> Array:
        """[nv]: Coriolis, centrifugal and gravity."""
        self._move(position, rates)
        return np.array(self.data.qfrc_bias)

    def _move(self, position: Array, rates: Array) -> None:
        self.data.qpos, self.data.qvel = position, rates
        with _singular_is_fine():
            mujoco.mj_fwdPosition(self.model, self.data)
        mujoco.mj_fwdVelocity(self.model, self.data)

    # ---- the robot: v is the base's six components in its own axes, then the spec's joints

    def robot(self, pose: Array, q: Array, v: Array, a: Array, forces: Array) -> dict[str, Array]:
        """Mass matrix, inverse dynamics with the ground's forces on the feet, of the floating robot in walkgen's coordinates.

        MuJoCo's free joint moves by the origin's velocity R v in world axes and by the spin in body axes; so the origin
        accelerates by R (dv/dt + spin x v), and a force or a row of the mass matrix turns back by R^T.
        """
        turn = np.eye(len(v))
        turn[:3, :3] = pose[:3, :3]
        carried = np.array(a)
        carried[:3] += np.cross(v[3:6], v[:3])
        position = np.zeros(self.model.nq)
        position[:3], position[3:7], position[self.places] = pose[:3, 3], _quaternion(pose[:3, :3]), q
        M = self.mass_matrix(position)[np.ix_(self.columns, self.columns)]
        tau = self.inverse(position, self._scattered(turn @ v), self._scattered(turn @ carried), forces)
        return {"floating_mass_matrix": turn.T @ M @ turn, "floating_inverse_dynamics": turn.T @ tau[self.columns]}

    def _scattered(self, values: Array) -> Array:
        full = np.zeros(self.model.nv)
        full[self.columns] = values
        return full


@contextmanager
def _singular_is_fine() -> Iterator[None]:
    """Keep MuJoCo from logging into a file that links without mass make M singular: M is factored on the way, the factors go unused."""
    heard: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(heard.append)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
    assert all("singular" in message for message in heard), heard


def _joint_names(limb: WalkerLimb) -> list[str]:
    return [f"{limb.name} {index}" for index in range(len(limb.joints))]


def _zero(joint: WalkerJoint) -> Array:
    return rotation(joint.axis, joint.zero) if joint.revolute else translation(np.asarray(joint.axis) * joint.zero)


def _direction(joint: WalkerJoint, *, mirrored: bool) -> Array:
    """The unit axis of growing q: a reflection turns a sliding axis as an arrow, a turning one as a spin."""
    axis = joint.sign * np.asarray(joint.axis, dtype=float) / np.linalg.norm(joint.axis)
    if not mirrored:
        return axis
    return -MIRROR[:3, :3] @ axis if joint.revolute else MIRROR[:3, :3] @ axis


def _quaternion(R: Array) -> Array:
    """[4], scalar first."""
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(R).reshape(9))
    return quaternion
