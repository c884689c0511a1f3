"""A leg of joints, a linkage and joints again as Pinocchio sees it: the linkage's links free in its plane, moved as loops closed by
numbers have it.
"""

import re
import tomllib

import numpy as np
import pinocchio as pin

from linkages.closure import assembled
from linkages.newton_euler import FIRST, Motion
from oracles.walker import Reader, translation

AFTER = """
linkage_end = {{ point = "{end}", xyz = [0.01, -0.02, 0.03], rpy_deg = [{turn}] }}
foot = {{ xyz = [0.01, 0.02, -0.15], rpy_deg = [10, 20, 30] }}
joints_after = [{rows}]
"""
ROWS = {
    "R": 'type = "revolute", a = 0.05, alpha_deg = 60, d = 0.01, link = { mass = 0.7, com = [0.02, 0.01, -0.03], '
    "inertia = [0.002, 0.003, 0.0025, 0.0001, 0.0002, -0.0001] }, friction = { viscous = 0.1, coulomb = 0.2 }",
    "P": 'type = "prismatic", a = 0.02, alpha_deg = -30, d = 0.1, link = { mass = 0.4, com = [0.0, 0.01, -0.02], '
    "inertia = [0.001, 0.002, 0.0015, 0, 0, 0] }, rotor = { inertia = 0.3 }",
}


def with_joints(text, before, after, turn="20, 70, 0"):
    """The text of a spec with a linkage, whose design is called `one`, with joints of these kinds before and after the linkage."""

    def rows(kinds, name):
        return ", ".join(f'{{ name = "{name}_{number}", {ROWS[kind]} }}' for number, kind in enumerate(kinds))

    foot = re.search(r'^foot = "(.*)"$', text, re.MULTILINE)
    own = AFTER.format(end=foot[1], turn=turn, rows=rows(after, "after"))
    plane = f'dh = "classic"\njoints = [{rows(before, "before")}]\nplane = {{ xyz = [0.1, 0.02, 0.0], rpy_deg = [80, 10, 0] }}'
    mounted = text.replace('platform = "body" }]', 'platform = "body", mount = { xyz = [0.3, 0.2, 0.1], rpy_deg = [5, 0, 30] } }]')
    return mounted.replace(foot[0], plane + own)


class Chained:
    """One leg of a spec whose parameters have their values, at joint values q for which its linkage assembles.

    Coordinates y are the joints before, x, y and angle of every link but the frame, the joints after; the link that these hang on comes
    last of the links, since Pinocchio wants subtrees in one piece.
    """

    def __init__(self, text, sides):
        self.text, self.sides, self.table = text, sides, tomllib.loads(text)
        self.design = next(iter(self.table["leg_designs"].values()))
        self.reader = Reader(self.table, {})
        self.values = np.array([self.reader.parameter(name) for name in self.table.get("parameters", {})])
        link, _, point = self.design["linkage_end"]["point"].partition(".")
        self.told = [name for name in self.design["links"] if name != "frame"]
        self.links = [*(name for name in self.told if name != link), link]
        self.places = np.concatenate([3 * self.told.index(name) + np.arange(3) for name in self.links])
        before, after = ([self._joint(row) for row in self.design.get(key, ())] for key in ("joints", "joints_after"))
        self.count, self.after = (len(before), len(after)), after
        self.model = pin.Model()
        self.model.gravity.linear = np.array(self.table["robot"]["gravity"], float)
        joint, place = self._series(0, self.reader.pose(self.table["legs"][0].get("mount")), before, self.design.get("joints", ()))
        plane = place @ self.reader.pose(self.design.get("plane"))
        self.model.appendBodyToJoint(joint, self._plate("frame"), pin.SE3(plane))
        joints = {name: self._link(joint, plane, name) for name in self.links}
        end = translation([*self._point(link, point), 0]) @ self.reader.pose(self.design["linkage_end"])
        joint, place = self._series(joints[link], end, after, self.design["joints_after"])
        self.tip = self.reader.pose(self.design.get("foot"))
        self.foot = self.model.addFrame(pin.Frame("foot", joint, 0, pin.SE3(place @ self.tip), pin.FrameType.OP_FRAME))
        self.data = self.model.createData()

    def _joint(self, row):
        return self.reader.joint(self.design.get("dh"), row, 1, 0.0)

    def _point(self, link, point):
        return [self.reader.number(entry) for entry in self.design["links"][link]["points"][point]]

    def _series(self, parent, place, joints, rows):
        """Joints with their bodies; the last one, and the place behind it."""
        for joint, row in zip(joints, rows, strict=True):
            kind = pin.JointModelRevoluteUnaligned if joint.revolute else pin.JointModelPrismaticUnaligned
            parent = self.model.addJoint(parent, kind(np.asarray(joint.axis, float)), pin.SE3(place @ joint.before), row["name"])
            place = joint.after
            self.model.appendBodyToJoint(parent, self._body(row["link"]), pin.SE3(place))
        return parent, place

    @staticmethod
    def _body(own):
        xx, yy, zz, xy, xz, yz = own["inertia"]
        return pin.Inertia(own["mass"], np.array(own["com"]), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))

    def _link(self, parent, plane, name):
        """A flat plate that slides and turns in the plane, with what cylinders lump on it."""
        for kind, own in ((pin.JointModelPX(), "x"), (pin.JointModelPY(), "y"), (pin.JointModelRZ(), "angle")):
            parent, plane = self.model.addJoint(parent, kind, pin.SE3(plane), f"{name}_{own}"), np.eye(4)
        self.model.appendBodyToJoint(parent, self._plate(name), pin.SE3.Identity())
        return parent

    def _plate(self, name):
        """What a link weighs with the masses at cylinders' ends: half its moment of inertia about any axis in the plane."""
        table = self.design["links"][name]
        parts = [(table.get("mass", 0.0), np.array(table.get("com", (0.0, 0.0))))]
        for cylinder in self.design.get("cylinders", ()):
            for text, key in zip(cylinder["between"], ("at_first", "at_second"), strict=True):
                if text.partition(".")[0] == name:
                    parts.append((cylinder["masses"][key], np.array(self._point(*text.split(".")))))
        mass = sum(own for own, _ in parts)
        if mass == 0:
            return pin.Inertia.Zero()
        com = sum(own * place for own, place in parts) / mass
        moment = table.get("inertia", 0.0) + sum(own * np.sum((place - com) ** 2) for own, place in parts)
        return pin.Inertia(mass, np.array([*com, 0]), np.diag([moment / 2, moment / 2, moment]))

    def closed(self, drives, random):
        """Poses of the links [n, 3 links] for drives [n, drives]; NaN where none of some starts leads to one."""
        parameters = np.tile(self.values, (len(drives), 1))
        return assembled(self.text, self.sides, parameters, drives, random, np.full(len(drives), 2))

    def at(self, q, x, rates=0.0, accelerations=0.0):
        """y, its rates and accelerations while q moves so, and dy/dq; `x` are the links' poses at q."""
        before, after = self.count
        rates, accelerations = np.broadcast_to(rates, q.shape), np.broadcast_to(accelerations, q.shape)
        driven = slice(before, len(q) - after)
        motion = Motion(self.text, self.values, q[driven], x, rates[driven], accelerations[driven])
        y, yd, ydd = (
            np.concatenate([own[:before], planar[self.places], own[len(q) - after :]])
            for own, planar in zip((q, rates, accelerations), (motion.x[2], motion.rate(motion.x), motion.second(motion.x)), strict=True)
        )
        S = np.zeros((len(y), len(q)))
        S[:before, :before], S[len(y) - after :, len(q) - after :] = np.eye(before), np.eye(after)
        for index, unit in enumerate(np.eye(len(q))[driven, driven], before):
            each = Motion(self.text, self.values, q[driven], x, unit)
            S[before : len(y) - after, index] = (FIRST @ each.x / each.step)[self.places]
        return y, yd, ydd, S

    def efforts(self, q, x, rates=0.0, accelerations=0.0, force=(0.0, 0.0, 0.0)):
        """On y, and on q: without friction, rotors apart."""
        y, yd, ydd, S = self.at(q, x, rates, accelerations)
        tau = pin.rnea(self.model, self.data, y, yd, ydd) - self.jacobian(y)[:3].T @ force
        return tau, S.T @ tau

    def jacobian(self, y):
        return np.reshape(pin.computeFrameJacobian(self.model, self.data, y, self.foot, pin.LOCAL_WORLD_ALIGNED), (6, -1))

    def slopes(self, q, x):
        """The foot's Jacobian by q [6, n]."""
        y, _, _, S = self.at(q, x)
        return self.jacobian(y) @ S

    def acceleration(self, y, yd, ydd):
        """Of the foot, linear then angular [6]."""
        pin.forwardKinematics(self.model, self.data, y, yd, ydd)
        pin.updateFramePlacements(self.model, self.data)
        return pin.getFrameClassicalAcceleration(self.model, self.data, self.foot, pin.LOCAL_WORLD_ALIGNED).vector

    def potential(self, y):
        return pin.computePotentialEnergy(self.model, self.data, y)

    def pose(self, y):
        pin.framesForwardKinematics(self.model, self.data, y)
        return np.array(self.data.oMf[self.foot].homogeneous)

    def frames_after(self, y):
        """Those that move with the joints after the linkage [k, 4, 4]."""
        self.pose(y)
        names = [row["name"] for row in self.design["joints_after"]]
        frames = [np.array(self.data.oMi[self.model.getJointId(name)].homogeneous) for name in names]
        return np.array([frame @ joint.after for frame, joint in zip(frames, self.after, strict=True)])

    def mass_matrix(self, y, S):
        M = np.triu(pin.crba(self.model, self.data, y))
        return S.T @ (M + np.triu(M, 1).T) @ S + np.diag(self.motors)

    @property
    def motors(self):
        """Rotors' inertias by q."""
        return self._of_joints(lambda row: row.get("rotor", {}).get("inertia", 0.0))

    @property
    def frictions(self):
        """Viscous and dry, by q."""
        return tuple(self._of_joints(lambda row, key=key: row.get("friction", {}).get(key, 0.0)) for key in ("viscous", "coulomb"))

    def _of_joints(self, number):
        """By q, 0 of drives."""
        drives = sum(pair.get("driven", False) for key in ("pins", "sliders", "cylinders") for pair in self.design.get(key, ()))
        before, after = ([number(row) for row in self.design.get(key, ())] for key in ("joints", "joints_after"))
        return np.array([*before, *[0.0] * drives, *after])

    def parameters(self):
        """Ten of every link, in its own axes: those of the joints before, of the linkage, of the joints after."""
        bodies = [self._body(row["link"]) for row in self.design.get("joints", ())]
        if bodies:  # the last one bears the linkage's frame
            bodies[-1] += pin.SE3(self.reader.pose(self.design["plane"])).act(self._plate("frame"))
        bodies += [self._plate(name) for name in self.told]
        bodies += [self._body(row["link"]) for row in self.design["joints_after"]]
        found = []
        for body in bodies:
            m, mx, my, mz, xx, xy, yy, xz, yz, zz = body.toDynamicParameters()
            found += [m, mx, my, mz, xx, yy, zz, xy, xz, yz]
        return np.array(found)

    def pair_ends(self, x):
        """Of every row of joint_reactions (pins, cylinders' ends, sliders) the link, and the pair's point from its origin."""
        pins = [(text.partition(".")[0], text) for pin in self.design.get("pins", ()) for text in pin["joins"]]
        ends = [(text.partition(".")[0], text) for cylinder in self.design.get("cylinders", ()) for text in cylinder["between"]]
        runners = [(slider["link"].partition(".")[0], slider["guide"]["link"], slider["link"]) for slider in self.design.get("sliders", ())]
        sliders = [(link, text) for *links, text in runners for link in links]
        places = {"frame": (np.zeros(2), np.eye(2))}
        for number, name in enumerate(self.told):
            c, s = np.cos(x[3 * number + 2]), np.sin(x[3 * number + 2])
            places[name] = x[3 * number : 3 * number + 2], np.array([[c, -s], [s, c]])
        for link, text in (*pins, *ends, *sliders):
            bearer, _, point = text.partition(".")
            origin, turn = places[bearer]
            yield link, origin + turn @ self._point(bearer, point) - places[link][0]
