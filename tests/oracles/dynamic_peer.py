"""Pinocchio models of legs and robots with their bodies, straight from the text of a spec: a peer for dynamics."""

import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pinocchio as pin

from oracles.walker import MIRROR, Reader, Walker, WalkerLimb, rotation, translation

Array = np.ndarray


class Bodies:
    """Masses, centres of mass and inertias of a spec's links and platforms, by the table they stand in."""

    def __init__(self, text: str, parameters: Mapping[str, float]) -> None:
        self.table = tomllib.loads(text)
        self.reader = Reader(self.table, parameters)
        self.walker = self.reader.walker()

    def gravity(self) -> Array:
        return np.array([self.reader.number(value) for value in self.table["robot"]["gravity"]])

    def platform(self, name: str) -> pin.Inertia:
        return self.inertia(next(platform for platform in self.table["platforms"] if platform["name"] == name))

    def links(self, limb: str) -> Iterator[pin.Inertia]:
        """Of a leg or of the chain to a platform, each in the frame after its row; reflected where the leg is a mirror image."""
        mirrored, design = self._design(limb)
        for row in design["joints"]:
            yield self.inertia(row.get("link", {}), mirrored=mirrored)

    def joints(self, limb: str) -> list[dict[str, Any]]:
        rows: list[dict[str, Any]] = self._design(limb)[1]["joints"]
        return rows

    def _design(self, limb: str) -> tuple[bool, dict[str, Any]]:
        for platform in self.table["platforms"]:
            if platform["name"] == limb and "chain" in platform:
                return False, self.table["chain_designs"][platform["chain"]]
        leg = next(leg for leg in self.table["legs"] if leg["name"] == limb)
        if "mirror_of" in leg:
            mirrored, design = self._design(leg["mirror_of"])
            return not mirrored, design
        return False, self.table["leg_designs"][leg["design"]]

    def inertia(self, table: dict[str, Any], *, mirrored: bool = False) -> pin.Inertia:
        S = MIRROR[:3, :3] if mirrored else np.eye(3)
        xx, yy, zz, xy, xz, yz = (self.reader.number(value) for value in table.get("inertia", [0.0] * 6))
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        com = np.array(self.reader.vector(table, "com"))
        return pin.Inertia(self.reader.number(table.get("mass", 0.0)), S @ com, S @ tensor @ S)


class DynamicPeer:
    """One leg on a platform that is held (its own joints), or the whole robot on a free flyer (the robot's joints)."""

    def __init__(self, text: str, leg: str = "", **parameters: float) -> None:
        self.bodies = Bodies(text, parameters)
        self.walker: Walker = self.bodies.walker
        self.model = pin.Model()
        self.model.gravity.linear = self.bodies.gravity()
        self.order: list[int] = []
        self.feet: list[int] = []
        if leg:
            self._limb(self.walker.leg(leg), 0, np.eye(4), leg)
        else:
            self._robot()
        self.data = self.model.createData()

    def _robot(self) -> None:
        base = self.model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
        slots: dict[str, list[int]] = {}
        tips: dict[str, int] = {}
        self._platform(self.walker.platforms[0], base, np.eye(4), slots, tips)
        legs = [leg.name for leg in self.walker.legs]
        self.order = [slot for name in (*self.walker.chains, *legs) for slot in slots[name]]
        self.feet = [tips[name] for name in legs]

    def _platform(self, name: str, joint: int, place: Array, slots: dict[str, list[int]], tips: dict[str, int]) -> None:
        """Its body, then every limb on it with all that the limb bears: Pinocchio wants subtrees in one piece."""
        self.model.appendBodyToJoint(joint, self.bodies.platform(name), pin.SE3(place))
        limbs = [(child, chain) for child, chain in self.walker.chains.items() if chain.platform == name]
        limbs += [(leg.name, leg) for leg in self.walker.legs if leg.platform == name]
        for limb_name, limb in limbs:
            before = len(self.order)
            end, tip = self._limb(limb, joint, place, limb_name)
            slots[limb_name], tips[limb_name] = self.order[before:], self.feet[-1]
            if limb_name in self.walker.chains:
                self._platform(limb_name, end, tip, slots, tips)

    def _limb(self, limb: WalkerLimb, parent: int, place: Array, name: str) -> tuple[int, Array]:
        """Add joints and bodies; the last joint and the tip's place on it."""
        flip = MIRROR if limb.mirrored else np.eye(4)
        place = place @ limb.mount if not limb.mirrored else place @ flip @ limb.mount @ flip
        for index, (joint, body) in enumerate(zip(limb.joints, self.bodies.links(name), strict=True)):
            axis = np.asarray(joint.axis, dtype=float)
            zero = rotation(axis, joint.zero) if joint.revolute else translation(axis * joint.zero)
            direction = joint.sign * flip[:3, :3] @ axis / np.linalg.norm(axis)
            if joint.revolute and limb.mirrored:
                direction = -direction
            kind = pin.JointModelRevoluteUnaligned if joint.revolute else pin.JointModelPrismaticUnaligned
            placement = pin.SE3(place @ flip @ joint.before @ zero @ flip)
            parent = self.model.addJoint(parent, kind(direction), placement, f"{name}_{index}")
            self.order.append(self.model.joints[parent].idx_v)
            place = flip @ joint.after @ flip
            self.model.appendBodyToJoint(parent, body, pin.SE3(place))
        place = place @ flip @ limb.tip @ flip
        self.feet.append(self.model.addFrame(pin.Frame(f"{name}_tip", parent, 0, pin.SE3(place), pin.FrameType.OP_FRAME)))
        return parent, place

    # ---- a leg

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        return np.array(pin.rnea(self.model, self.data, q, qd, qdd))

    def mass_matrix(self, q: Array) -> Array:
        M = np.triu(pin.crba(self.model, self.data, q))
        return M + np.triu(M, 1).T

    def gravity(self, q: Array) -> Array:
        return np.array(pin.computeGeneralizedGravity(self.model, self.data, q))

    def energies(self, q: Array, qd: Array) -> tuple[float, float]:
        return pin.computeKineticEnergy(self.model, self.data, q, qd), pin.computePotentialEnergy(self.model, self.data, q)

    def foot_jacobian(self, q: Array) -> Array:
        J = pin.computeFrameJacobian(self.model, self.data, q, self.feet[-1], pin.LOCAL_WORLD_ALIGNED)
        return np.reshape(J, (6, -1))[:3]

    # ---- the robot: v is the base's six components, then the spec's joints

    @property
    def columns(self) -> list[int]:
        """Pinocchio's places of v in walkgen's order."""
        return [*range(6), *self.order]

    def configuration(self, pose: Array, q: Array) -> Array:
        full = np.zeros(self.model.nq)
        full[:3] = pose[:3, 3]
        full[3:7] = pin.Quaternion(pose[:3, :3]).coeffs()
        full[np.array(self.order, dtype=int) + 1] = q
        return full

    def rates(self, v: Array) -> Array:
        full = np.zeros(self.model.nv)
        full[self.columns] = v
        return full

    def robot(self, pose: Array, q: Array, v: Array, a: Array, forces: Array) -> dict[str, Array]:
        """Every floating function's value."""
        model, data, columns = self.model, self.data, self.columns
        full, rates, accelerations = self.configuration(pose, q), self.rates(v), self.rates(a)
        tau = np.array(pin.rnea(model, data, full, rates, accelerations))
        for frame, force in zip(self.feet, forces, strict=True):
            J = np.reshape(pin.computeFrameJacobian(model, data, full, frame, pin.LOCAL_WORLD_ALIGNED), (6, -1))[:3]
            tau -= J.T @ force
        A = np.array(pin.computeCentroidalMap(model, data, full))
        rate = pin.computeCentroidalMomentumTimeVariation(model, data, full, rates, accelerations)
        com = np.array(pin.centerOfMass(model, data, full, rates, accelerations))
        pin.ccrba(model, data, full, rates)
        push = pin.computeTotalMass(model) * model.gravity.linear - rate.linear
        return {
            "com": com,
            "com_jacobian": np.array(pin.jacobianCenterOfMass(model, data, full))[:, columns],
            "centroidal_momentum_matrix": A[:, columns],
            "centroidal_inertia": np.array(data.Ig.inertia),
            "momentum": A @ rates,
            "momentum_rate": np.array(rate.vector),
            "demanded_wrench": np.concatenate([push, np.cross(com, push) - rate.angular]),
            "floating_mass_matrix": self.mass_matrix(full)[np.ix_(columns, columns)],
            "floating_inverse_dynamics": tau[columns],
        }
