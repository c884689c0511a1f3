"""Export to URDF: back through the import, and beside Pinocchio, which reads the same text; feet, Jacobians, bodies, joints' data."""

import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from defusedxml import ElementTree
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from mechanisms.random_specs import specs
from oracles import walker
from oracles.measure import difference
from walkgen.emit.urdf import urdf
from walkgen.errors import UnsupportedMechanism
from walkgen.model.assemble import assemble
from walkgen.model.mechanism import Body
from walkgen.model.walk import limb_frames, number, platform_poses
from walkgen.spec.read import read
from walkgen.spec.scalar import exact
from walkgen.spec.urdf import convert

ALL = sorted((Path(__file__).parents[2] / "specs").glob("*.toml"))
SHIPPED = [path for path in ALL if "pins" not in path.read_text(encoding="utf-8")]
ACCURACY = 1e-12


def mechanism_of(folder, text):
    path = folder / "spec.toml"
    path.write_text(text, encoding="utf-8")
    return assemble(read(path))


def names_of(mechanism):
    return [joint.source_name or f"{limb.name}_{joint.name}" for limb in mechanism.limbs for joint in limb.joints]


def brought_back(mechanism, folder):
    """The mechanism's URDF as a spec's text."""
    path = folder / "robot.urdf"
    path.write_text(urdf(mechanism).text, encoding="utf-8")
    return convert(path, tuple(leg.name for leg in mechanism.legs)).toml


def reordered(names, others, values):
    return np.array([values[names.index(name)] for name in others])


def assert_round_trip(text, folder, seed=0):
    """Spec -> URDF -> spec: both texts are walked by the oracle, not by walkgen."""
    mechanism = mechanism_of(folder, text)
    back_text = brought_back(mechanism, folder)
    back = mechanism_of(folder, back_text)
    names, back_names = names_of(mechanism), names_of(back)
    assert sorted(names) == sorted(back_names)
    before, after = walker.read(text), walker.read(back_text)
    for q in np.random.default_rng(seed).uniform(-np.pi, np.pi, (3, len(names))):
        back_q = reordered(names, back_names, q)
        assert difference(after.foot_positions(back_q), before.foot_positions(q)) <= ACCURACY
        jacobians = before.foot_jacobians(q)
        assert difference(after.foot_jacobians(back_q), jacobians[..., [names.index(name) for name in back_names]]) <= ACCURACY
    assert_same_drives(mechanism, back)


def assert_same_drives(mechanism, back):
    """Limits, speeds and efforts, in the user's q."""
    joints = dict(zip(names_of(mechanism), (joint for limb in mechanism.limbs for joint in limb.joints), strict=True))
    for name, joint in zip(names_of(back), (joint for limb in back.limbs for joint in limb.joints), strict=True):
        other = joints[name]
        assert joint.kind == other.kind
        for key in ("max_speed", "max_effort"):
            assert values(getattr(joint, key), back) == values(getattr(other, key), mechanism)
        assert values(joint.limits, back) == values(other.limits, mechanism)


def values(scalars, mechanism):
    if scalars is None:
        return None
    return [float(number(scalar, mechanism)) for scalar in (scalars if isinstance(scalars, tuple) else (scalars,))]


# ---- against Pinocchio -------------------------------------------------------------------------------------------------------


class Peer:
    """Pinocchio's model of the exported text at one pose."""

    def __init__(self, mechanism, q):
        self.model = pin.buildModelFromXML(urdf(mechanism).text, pin.JointModelFreeFlyer())
        self.data = self.model.createData()
        pose = pin.neutral(self.model)
        for name, value in zip(names_of(mechanism), q, strict=True):
            joint = self.model.joints[self.model.getJointId(name)]
            pose[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        pin.computeJointJacobians(self.model, self.data, pose)
        pin.updateFramePlacements(self.model, self.data)

    def position(self, link):
        return self.data.oMf[self.model.getFrameId(link)].translation

    def jacobian(self, link, names):
        J = pin.getFrameJacobian(self.model, self.data, self.model.getFrameId(link), pin.LOCAL_WORLD_ALIGNED)[:3]
        return J[:, [self.model.joints[self.model.getJointId(name)].idx_v for name in names]]

    def body(self, joint):
        return self.data.oMi[joint].act(self.model.inertias[joint])


def inertia(body, frame, mechanism):
    xx, yy, zz, xy, xz, yz = values(body.inertia, mechanism)
    own = pin.Inertia(
        values(body.mass, mechanism)[0], np.array(values(body.com, mechanism)), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    )
    return pin.SE3(np.array(frame.tolist(), dtype=float)).act(own)


def bodies_by_joint(mechanism, q):
    """What hangs rigidly on each joint, by its name, in the first platform's frame; "" is the first platform itself."""
    poses = platform_poses(mechanism, list(q))
    found = {"": [(mechanism.platforms[0].body, poses[0])]}
    for limb in mechanism.limbs:
        start = mechanism.offset(limb)
        frames = limb_frames(mechanism, limb, list(q[start : start + len(limb.joints)]), base=poses[limb.platform])
        names = names_of(mechanism)[start : start + len(limb.joints)]
        found |= {name: [(joint.body, frame)] for name, joint, frame in zip(names, limb.joints, frames[1:-1], strict=True)}
        if limb.child is not None:
            found[names[-1]].append((mechanism.platforms[limb.child].body, poses[limb.child]))
    return {name: [inertia(body, frame, mechanism) for body, frame in bodies if body] for name, bodies in found.items()}


def assert_pinocchio_agrees(text, mechanism, seed=0):
    names, robot = names_of(mechanism), walker.read(text)
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, len(names))
    peer = Peer(mechanism, q)
    for index, leg in enumerate(mechanism.legs):
        assert difference(peer.position(leg.name), robot.foot_positions(q)[index]) <= ACCURACY
        assert difference(peer.jacobian(leg.name, names), robot.foot_jacobians(q)[index]) <= ACCURACY
    for name, bodies in bodies_by_joint(mechanism, q).items():
        found = peer.body(peer.model.getJointId(name) if name else 1)
        assert difference(found.mass, sum(body.mass for body in bodies)) <= ACCURACY
        if bodies:
            expected = sum(bodies[1:], bodies[0])
            assert difference(found.lever, expected.lever) <= ACCURACY
            assert difference(found.inertia, expected.inertia) <= ACCURACY


def with_bodies(mechanism, seed):
    """The mechanism with a random body on every joint and platform."""
    draw = np.random.default_rng(seed)

    def body():
        numbers = [exact(int(value)) for value in draw.integers(-9, 10, 6)]
        return Body(exact(int(draw.integers(1, 9))), tuple(numbers[:3]), (exact(60), exact(70), exact(80), *numbers[3:]))

    def limbs(group):
        return tuple(replace(limb, joints=tuple(replace(joint, body=body()) for joint in limb.joints)) for limb in group)

    platforms = tuple(replace(platform, body=body()) for platform in mechanism.platforms)
    return replace(mechanism, platforms=platforms, chains=limbs(mechanism.chains), legs=limbs(mechanism.legs))


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_specs(path, tmp_path):
    text = path.read_text(encoding="utf-8")
    assert_round_trip(text, tmp_path)
    assert_pinocchio_agrees(text, mechanism_of(tmp_path, text))


UNSHRUNK = settings(derandomize=True, deadline=None, phases=[Phase.generate])


def assert_random_robot(text, seed, folder):
    assert_round_trip(text, folder, seed)
    assert_pinocchio_agrees(text, with_bodies(mechanism_of(folder, text), seed), seed)


@settings(UNSHRUNK, max_examples=25)
@given(specs(), st.integers(0, 2**32 - 1))
def test_random_robots(tmp_path_factory, text, seed):
    assert_random_robot(text, seed, tmp_path_factory.mktemp("robot"))


@pytest.mark.nightly
@settings(UNSHRUNK, max_examples=400)
@given(specs(), st.integers(0, 2**32 - 1))
def test_many_random_robots(tmp_path_factory, text, seed):
    assert_random_robot(text, seed, tmp_path_factory.mktemp("robot"))


# ---- what the text says ------------------------------------------------------------------------------------------------------

HOPPER = """
walkgen = 1
robot = { name = "hop", gravity = [0, 0, -9.80665], description = "one -- two < three" }
platforms = [{ name = "body" }]
legs = [{ name = "leg", design = "d", platform = "body", SOURCES }]

[parameters]
shank = { value = 0.4, unit = "m", runtime = true }

[leg_designs.d]
dh = "classic"
signs = [-1, 1]
zeros_deg = [90, 0]
joints = [
  { name = "hip",   type = "revolute",  a = "shank", alpha_deg = 90, d = 0.12, max_effort = 7.5 },
  { name = "slide", type = "prismatic", a = 0.35, alpha_deg = 0,  d = 0.00, limits = [-0.1, 0.2] },
]
"""


def elements(folder, text):
    root = ElementTree.fromstring(urdf(mechanism_of(folder, text)).text)
    return {joint.get("name"): joint for joint in root.findall("joint")}, [link.get("name") for link in root.findall("link")]


def test_names_are_the_limbs_and_the_joints(tmp_path):
    joints, links = elements(tmp_path, HOPPER.replace("SOURCES", ""))
    assert list(joints) == ["leg_hip", "leg_slide", "leg_fixed"]
    assert links == ["body", "leg_hip_link", "leg_slide_link", "leg"]


def test_source_names_come_first(tmp_path):
    joints, _ = elements(tmp_path, HOPPER.replace("SOURCES", 'source_names = ["L&R <hip>", "S"]'))
    assert list(joints) == ["L&R <hip>", "S", "leg_fixed"]


def test_a_leg_called_like_its_platform_gets_its_own_link(tmp_path):
    text = HOPPER.replace("SOURCES", "").replace('name = "leg"', 'name = "body"')
    joints, links = elements(tmp_path, text)
    assert links == ["body", "body_hip_link", "body_slide_link", "body_2"]
    assert "body_2_fixed" in joints


def test_signs_and_zeros_are_in_the_axis_and_the_origin(tmp_path):
    joints, _ = elements(tmp_path, HOPPER.replace("SOURCES", ""))
    assert joints["leg_hip"].find("axis").get("xyz") == "0.0 0.0 -1.0"
    assert joints["leg_hip"].find("origin").attrib == {"xyz": "0.0 0.0 0.0", "rpy": "0.0 0.0 1.5707963267948966"}
    assert joints["leg_slide"].find("axis").get("xyz") == "0.0 0.0 1.0"
    assert joints["leg_slide"].find("origin").attrib == {"xyz": "0.75 0.0 0.12", "rpy": "1.5707963267948966 0.0 0.0"}


def test_limits_are_those_that_the_spec_gives(tmp_path):
    joints, _ = elements(tmp_path, HOPPER.replace("SOURCES", ""))
    assert joints["leg_hip"].get("type") == "continuous"
    assert joints["leg_hip"].find("limit").attrib == {"effort": "7.5", "velocity": "0.0"}
    assert joints["leg_slide"].find("limit").attrib == {"lower": "-0.1", "upper": "0.2", "effort": "0.0", "velocity": "0.0"}
    unlimited, _ = elements(tmp_path, HOPPER.replace("SOURCES", "").replace(", limits = [-0.1, 0.2]", "").replace(", max_effort = 7.5", ""))
    assert unlimited["leg_hip"].find("limit") is None
    assert unlimited["leg_slide"].find("limit").attrib == {"effort": "0.0", "velocity": "0.0"}


def test_the_comment_says_what_urdf_cannot(tmp_path):
    text = urdf(mechanism_of(tmp_path, HOPPER.replace("SOURCES", ""))).text
    assert "Runtime parameters stand at their defaults: shank = 0.4 m." in text
    assert "[0.0, 0.0, -9.80665] m/s^2" in text
    assert "<!-- one - - two < three -->" in text


def test_published_frames_come_back_as_they_were(tmp_path):
    """An imported robot's link frames are its publishers': every origin and axis of Solo12 stands in the export as in the spec."""
    text = SHIPPED[[path.stem for path in SHIPPED].index("solo12")].read_text(encoding="utf-8")
    joints, _ = elements(tmp_path, text)
    designs = tomllib.loads(text)["leg_designs"]
    for leg in tomllib.loads(text)["legs"]:
        for name, row in zip(leg["source_names"], designs[leg["design"]]["joints"], strict=True):
            assert [float(x) for x in joints[name].find("axis").get("xyz").split()] == row["axis"]
            if row is not designs[leg["design"]]["joints"][0]:
                assert [float(x) for x in joints[name].find("origin").get("xyz").split()] == row["xyz"]


def test_no_number_is_a_negative_zero_or_longer_than_a_double(tmp_path):
    text = urdf(mechanism_of(tmp_path, SHIPPED[0].read_text(encoding="utf-8"))).text
    numbers = re.findall(r"-?\d+\.\d+(?:e-?\d+)?", text.partition("<robot")[2])
    assert numbers
    assert all(repr(float(found)) == found and found != "-0.0" for found in numbers)


def test_a_closed_linkage_is_refused():
    path = next(path for path in ALL if path.stem == "odex")
    with pytest.raises(UnsupportedMechanism, match="WG188") as error:
        urdf(assemble(read(path)))
    assert "front" in str(error.value)
