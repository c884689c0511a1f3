"""Pinocchio models of a walker's legs: a peer for Jacobians and their rates."""

import numpy as np
import pinocchio as pin

from oracles.walker import MIRROR, WalkerLimb, rotation, translation

Array = np.ndarray


class PinocchioLeg:
    """One leg as a Pinocchio model, fixed to its platform."""

    def __init__(self, leg: WalkerLimb) -> None:
        self.model = pin.Model()
        flip = MIRROR if leg.mirrored else np.eye(4)
        parent, place = 0, leg.mount
        for index, joint in enumerate(leg.joints):
            axis = np.asarray(joint.axis, dtype=float)
            zero = rotation(axis, joint.zero) if joint.revolute else translation(axis * joint.zero)
            placement = flip @ place @ joint.before @ zero @ flip
            direction = joint.sign * flip[:3, :3] @ axis / np.linalg.norm(axis)
            if joint.revolute and leg.mirrored:
                direction = -direction
            model = pin.JointModelRevoluteUnaligned(direction) if joint.revolute else pin.JointModelPrismaticUnaligned(direction)
            parent = self.model.addJoint(parent, model, pin.SE3(placement), f"joint{index}")
            place = joint.after
        self.foot = self.model.addFrame(pin.Frame("foot", parent, 0, pin.SE3(flip @ place @ leg.tip @ flip), pin.FrameType.OP_FRAME))
        self.data = self.model.createData()

    def pose(self, q: Array) -> Array:
        pin.framesForwardKinematics(self.model, self.data, q)
        return np.array(self.data.oMf[self.foot].homogeneous)

    def spatial_jacobian(self, q: Array) -> Array:
        """[6,n]: linear, angular, at the foot, platform axes."""
        return np.reshape(pin.computeFrameJacobian(self.model, self.data, q, self.foot, pin.LOCAL_WORLD_ALIGNED), (6, -1))

    def bias_acceleration(self, q: Array, qd: Array) -> Array:
        """dJ/dt qd [6]."""
        pin.forwardKinematics(self.model, self.data, q, qd, np.zeros_like(qd))
        return np.array(pin.getFrameClassicalAcceleration(self.model, self.data, self.foot, pin.LOCAL_WORLD_ALIGNED).vector)
