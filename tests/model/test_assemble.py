"""From specs to mechanisms: mirror images, signs and zeros, axes, level ends, trees of platforms, parameters."""

import math
from fractions import Fraction
from itertools import product as combinations

import numpy as np
import pytest
from float_walk import MIRROR, assembled, close, frames, number, pose, robot, rpy
from scipy.spatial.transform import Rotation

from walkgen.graph.interpret import interpret
from walkgen.pipeline import programs_of
from walkgen.spec.scalar import Exact, Name, names

ROWS = """  { name = "yaw", type = "revolute", a = 0.05, alpha_deg = 80, d = 0.12, theta_deg = 20,
    link = { mass = 1.2, com = [0.1, 0.2, 0.3], inertia = [0.02, 0.03, 0.04, 0.001, 0.002, 0.003], section = "tube" } },
  { name = "slide", type = "prismatic", a = 0.3, alpha_deg = -35, d = 0.1, theta_deg = 10 },
  { name = "knee", type = "revolute", a = 0.4, alpha_deg = 15, d = -0.02 },"""
FOOT = 'dh = "classic"\nfoot = { xyz = [0.01, 0.02, 0.03], rpy_deg = [10, 20, 30] }'
TUBE = "[sections.tube]\nE = 1e9\nG = 1e9\nA = 1e-4\nIy = 1e-8\nIz = 1e-8\nJ = 1e-8"
MOUNT = "mount = { xyz = [0.1, 0.2, 0.3], rpy_deg = [5, -15, 50] }\nsigns = [-1, 1, 1]\nzeros = [0.3, 0.05, -0.2]"
MIRRORED = '\n[[legs]]\nname = "image"\nmirror_of = "leg"\n[[legs]]\nname = "again"\nmirror_of = "image"'
Q = (0.7, -0.15, 1.9)


# ---- mirror ----------------------------------------------------------------------------------------------------------------------


@pytest.fixture
def legs(tmp_path):
    return {leg.name: leg for leg in assembled(tmp_path, robot(ROWS, FOOT, MOUNT + MIRRORED, TUBE)).legs}


def test_the_same_joint_values_give_the_mirrored_frames(legs):
    for original, image in zip(frames(legs["leg"], Q), frames(legs["image"], Q), strict=True):
        assert close(image, MIRROR @ original @ MIRROR)


def test_mirrored_frames_are_right_handed(legs):
    for frame in frames(legs["image"], Q):
        assert close(frame[:3, :3].T @ frame[:3, :3], np.eye(3))
        assert np.linalg.det(frame[:3, :3]) == pytest.approx(1)


def test_a_mirrored_mirror_image_is_the_leg(legs):
    assert close(frames(legs["again"], Q), frames(legs["leg"], Q))


def test_bodies_are_reflected(legs):
    """Centre of mass and inertia in the joint's frame, itself reflected: what S diag(1, -1, 1) makes of them."""
    S = MIRROR[:3, :3]
    original, image = (leg.joints[0].body for leg in (legs["leg"], legs["image"]))
    assert image.mass == original.mass
    assert close(vector(image.com), S @ vector(original.com))
    assert close(inertia(image), S @ inertia(original) @ S)
    assert np.linalg.eigvalsh(inertia(image)) == pytest.approx(np.linalg.eigvalsh(inertia(original)))
    assert legs["image"].joints[0].section == "tube"
    assert legs["image"].platform == legs["leg"].platform


def vector(scalars):
    return np.array([number(scalar, {}) for scalar in scalars])


def inertia(body):
    xx, yy, zz, xy, xz, yz = vector(body.inertia)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


# ---- rows, signs and zeros ---------------------------------------------------------------------------------------------------------


def turned(axis, angle):
    return pose(Rotation.from_rotvec(np.eye(3)[axis] * angle))


def shifted(*xyz):
    return pose(Rotation.identity(), xyz)


@pytest.mark.parametrize(("convention", "kind"), [*combinations(("classic", "craig"), ("revolute", "prismatic"))])
def test_dh_rows(tmp_path, convention, kind):
    row = f'{{ name = "only", type = "{kind}", a = 0.3, alpha_deg = 35, d = -0.2, theta_deg = 50 }}'
    (leg,) = assembled(tmp_path, robot(row, f'dh = "{convention}"')).legs
    q, theta, d = 0.4, math.radians(50), -0.2
    if kind == "revolute":
        theta += q
    else:
        d += q
    screw, twist = turned(2, theta) @ shifted(0, 0, d), turned(0, math.radians(35)) @ shifted(0.3, 0, 0)
    assert close(frames(leg, [q])[1], screw @ twist if convention == "classic" else twist @ screw)


@pytest.mark.parametrize(("design", "own", "expected"), [("", "", 1), ("signs = [-1]", "", -1), ("signs = [-1]", "signs = [1]", 1)])
def test_a_legs_own_signs_replace_the_designs(tmp_path, design, own, expected):
    row = '{ name = "only", type = "revolute", a = 0.3, alpha_deg = 0, d = 0 }'
    (leg,) = assembled(tmp_path, robot(row, f'dh = "classic"\n{design}\nzeros_deg = [30]', own)).legs
    angle = expected * 0.4 + math.radians(30)
    assert close(frames(leg, [0.4])[-1][:3, 3], [0.3 * math.cos(angle), 0.3 * math.sin(angle), 0])


def test_a_legs_own_zeros_replace_the_designs(tmp_path):
    row = '{ name = "only", type = "prismatic", a = 0, alpha_deg = 0, d = 0.5 }'
    (leg,) = assembled(tmp_path, robot(row, 'dh = "classic"\nzeros = [0.1]\nsigns = [-1]', "zeros = [0.25]")).legs
    assert close(frames(leg, [0.2])[-1][:3, 3], [0, 0, 0.5 + 0.25 - 0.2])


# ---- origins and axes --------------------------------------------------------------------------------------------------------------

COORDINATES = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
AXES = [*COORDINATES, [0.6, 0, 0.8], [1, -2, 2], [-0.3, 0.4, 0], [0, -3, -4], [1, 1, 1]]


@pytest.mark.parametrize(("axis", "kind"), [*combinations(AXES, ("revolute", "prismatic"))])
def test_axes(tmp_path, axis, kind):
    """URDF's joint: origin, then the motion about or along the axis; the frame stays aligned with the origin's at q = 0."""
    row = f'{{ name = "only", type = "{kind}", xyz = [0.1, -0.2, 0.3], rpy_deg = [20, -40, 70], axis = {axis} }}'
    (leg,) = assembled(tmp_path, robot(row, "foot = { xyz = [0.5, 0.6, 0.7] }", "signs = [-1]\nzeros = [0.25]")).legs
    unit, amount = np.array(axis) / np.linalg.norm(axis), 0.25 - 0.9
    motion = pose(Rotation.from_rotvec(amount * unit)) if kind == "revolute" else shifted(*(amount * unit))
    expected = rpy([0.1, -0.2, 0.3], np.radians([20, -40, 70])) @ motion
    found = frames(leg, [0.9])
    assert close(found[1], expected)
    assert close(found[2], expected @ shifted(0.5, 0.6, 0.7))


@pytest.mark.parametrize("axis", COORDINATES)
def test_coordinate_axes_stay_exact(tmp_path, axis):
    """Quarter turns are multiples of pi, not decimals."""
    row = f'{{ name = "only", type = "revolute", xyz = [0, 0, 0], axis = {axis} }}'
    (leg,) = assembled(tmp_path, robot(row, "")).legs
    turns = [motion.amount for motion in leg.joints[0].before]
    assert len(turns) <= 1
    assert all(number(turn, {}) in (math.pi / 2, -math.pi / 2) for turn in turns)


@pytest.mark.parametrize(
    ("axis", "expected"),
    [
        ('[0, "sin(0)", 1]', [0, 0, 1]),
        ('["pi - pi", 0, "-sqrt(2)"]', [0, 0, -1]),
        ('["cos(pi/2)", "-cos(0)", 0]', [0, -1, 0]),
        ('["sqrt(2)", "sin(pi)", "sqrt(2)"]', [math.sqrt(0.5), 0, math.sqrt(0.5)]),
    ],
)
def test_axes_by_arithmetic(tmp_path, axis, expected):
    """What comes to 0 is 0, also where sympy or 50 digits would leave a rest of it."""
    row = f'{{ name = "only", type = "prismatic", xyz = [0, 0, 0], axis = {axis} }}'
    text = robot(row, "")
    (leg,) = assembled(tmp_path, text).legs
    assert close(frames(leg, [0.5])[1], shifted(*(0.5 * np.array(expected))))
    (program,) = [body for body in programs_of(tmp_path / "spec.toml") if body.signature.name == "foot_jacobian"]
    assert close(interpret(program, {"q": [0.5]})["J"], expected)


# ---- platforms and chains --------------------------------------------------------------------------------------------------------

CHAINS = """
[chain_designs.waist]
dh = "classic"
zeros = [0.2, -0.4, 0.03]
signs = [1, -1, 1]
joints = [
  { name = "yaw", type = "revolute", a = 0.10, alpha_deg = 90, d = 0.05 },
  { name = "pitch", type = "revolute", a = 0.2, alpha_deg = 70, d = 0.0, theta_deg = 90 },
  { name = "slide", type = "prismatic", a = 0.1, alpha_deg = 25, d = 0.25, theta_deg = -30 },
]
[chain_designs.neck]
joints = [{ name = "nod", type = "revolute", xyz = [0.1, 0, 0], axis = [0, 1, 0] }]
"""


def platform(name, parent, chain="waist", end='end = "level"\nend_xyz = [-0.3, 0.1, 0.2]'):
    return f"""[[platforms]]
name = "{name}"
parent = "{parent}"
chain = "{chain}"
root = {{ xyz = [-0.2, 0.1, 0.0], rpy_deg = [10, 20, 180] }}
{end}
"""


def tree(tmp_path, *platforms):
    row = '{ name = "only", type = "revolute", a = 0.3, alpha_deg = 0, d = 0 }'
    legs = '\n[[legs]]\nname = "last"\ndesign = "design"\nplatform = "d"'
    return assembled(tmp_path, robot(row, legs=legs, head=CHAINS, platforms="".join(platforms)))


SERIES = (platform("b", "body"), platform("c", "b", "neck", "end = { xyz = [0, 0, 0.1], rpy_deg = [0, 0, 45] }"), platform("d", "c"))
STAR = (platform("d", "body"), platform("b", "body"), platform("c", "body", "neck"))


def test_level_end(tmp_path):
    """At q = 0, zeros counted in, the child is parallel to the parent, shifted along the parent's axes."""
    (chain, *_) = tree(tmp_path, *STAR).chains
    *_, last, end = frames(chain, [0, 0, 0])
    assert close(end[:3, :3], np.eye(3))
    assert close(end[:3, 3] - last[:3, 3], [-0.3, 0.1, 0.2])
    *_, last, moved = frames(chain, [0.5, -0.3, 0.1])
    assert not close(moved[:3, :3], np.eye(3), 0.1)
    assert close(np.linalg.inv(last) @ moved, np.linalg.inv(frames(chain, [0, 0, 0])[-2]) @ end)


def test_series(tmp_path):
    mechanism = tree(tmp_path, *SERIES)
    assert [platform.chain for platform in mechanism.platforms] == [None, 0, 1, 2]
    assert [(chain.name, chain.platform, chain.child) for chain in mechanism.chains] == [("b", 0, 1), ("c", 1, 2), ("d", 2, 3)]
    assert [chain.name for chain in mechanism.ancestors(3)] == ["b", "c", "d"]
    assert mechanism.ancestors(0) == ()
    assert [mechanism.offset(limb) for limb in mechanism.limbs] == [0, 3, 4, 7, 8]
    assert [(leg.name, leg.platform) for leg in mechanism.legs] == [("leg", 0), ("last", 3)]


def test_star(tmp_path):
    mechanism = tree(tmp_path, *STAR)
    assert [[chain.name for chain in mechanism.ancestors(index)] for index in range(4)] == [[], ["d"], ["b"], ["c"]]
    assert [(leg.name, leg.platform) for leg in mechanism.legs] == [("leg", 0), ("last", 1)]


def test_a_posed_end_is_as_it_says(tmp_path):
    chain = tree(tmp_path, *SERIES).chains[1]
    *_, last, end = frames(chain, [0.4])
    assert close(end, last @ rpy([0, 0, 0.1], [0, 0, math.pi / 4]))


# ---- parameters --------------------------------------------------------------------------------------------------------------------

PARAMETERS = """[parameters]
thigh = 0.35
twice = "2*thigh"
more = "twice + third"
third = "1/3"
shank = { value = "thigh + 0.05", unit = "m", runtime = true, bounds = ["thigh/2", 0.6] }
half = "shank/2"
"""
NAMED = """  { name = "a", type = "revolute", a = "more", alpha_deg = 90, d = "half", limits_deg = ["-45*thigh/0.35", 60] },
  { name = "b", type = "revolute", a = "shank", alpha = "atan2(1, 1)", d = 0 },"""


def test_parameters(tmp_path):
    """Constants are put in exactly, in whatever order they stand; runtime parameters stay names."""
    mechanism = assembled(tmp_path, robot(NAMED, head=PARAMETERS))
    (leg,) = mechanism.legs
    amounts = {(joint.name, motion.kind, motion.axis): motion.amount for joint in leg.joints for motion in joint.after}
    assert amounts["a", "translate", 0] == Exact(Fraction(7, 10) + Fraction(1, 3))
    assert amounts["b", "translate", 0] == Name("shank")
    assert names(amounts["a", "translate", 2]) == {"shank"}
    assert [(entry.name, entry.unit, entry.default) for entry in mechanism.parameters] == [("shank", "m", Exact(Fraction(2, 5)))]
    assert mechanism.parameters[0].bounds == (Exact(Fraction(7, 40)), Exact(Fraction(3, 5)))
    assert number(leg.joints[0].limits[0], {}) == pytest.approx(-math.pi / 4)
    p = frames(leg, [0, 0], {"shank": 0.5})[-1][:3, 3]
    assert close(p, [7 / 10 + 1 / 3 + 0.5, 0, 0.25])


def test_damping_is_the_specs_or_a_hundredth_of_the_reach(tmp_path):
    row = '{{ name = "{}", type = "revolute", a = {}, alpha = 0, d = {} }},'
    rows = row.format("a", 0.35, -0.12) + row.format("b", 0.4, 0)
    default = assembled(tmp_path, robot(rows)).legs[0].damping
    given = assembled(tmp_path, robot(rows, 'dh = "classic"\ndamping = { epsilon = 0.03, lambda_max = 0.07 }')).legs[0].damping
    assert default == (Exact(Fraction(87, 10000)),) * 2
    assert given == (Exact(Fraction(3, 100)), Exact(Fraction(7, 100)))
