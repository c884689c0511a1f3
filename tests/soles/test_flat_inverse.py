"""The inverse of legs with curved soles: a foot that is put flat on its target, with a leg in its plane or one that yaws."""

import numpy as np
import pytest
from rolling_robots import LEG, called, robot_of
from test_foot_point import PAIR, YAW
from test_soled_limb import FOOT

from walkgen.selftest import run

INVERSES = (
    "inverse",
    "inverse_branch",
    "inverse_near",
    "inverse_distance",
    "foot_position",
    "link_angles",
    "joint_angles",
    "joint_frames",
    "sole_points",
)
SHIFTED = "foot = { xyz = [0.01, 0.02, 0.03], rpy_deg = [0, 0, 10] }"


def placed_text(slope="0.0"):
    """Two legs with shifted and turned foot frames, mounted off the platform's origin; the right one mirrored."""
    wanted = ", ".join(f'"{name}"' for name in INVERSES)
    text = LEG.replace(FOOT, SHIFTED).replace(
        "mount = { rpy_deg = [90, 0, 0] }", "mount = { xyz = [0.1, 0.1, -0.05], rpy_deg = [90, 0, 0] }"
    )
    text = text.replace("width = 0.10", f"width = 0.10\nslope = {slope}").replace('name = "anthropomorphic_leg"', 'name = "placed"')
    return f"{text}{PAIR}\n[generate]\nfunctions = [{wanted}]\ntargets = ['c', 'numpy', 'casadi']\n"


def flat_joints(leg, rows, seed):
    """q of hip, knee and ankle with a flat foot."""
    random = np.random.default_rng(seed)
    thigh, knee = random.uniform(-2.2, -0.9, rows), random.uniform(0.05, 1.8, rows) * random.choice([-1, 1], rows)
    return leg.joint_angles(np.stack([thigh, thigh + knee, np.full(rows, -np.pi / 2)], -1))


def flat_places(leg, rows, seed):
    """Joint values with a flat foot, and where that touches the ground."""
    q = flat_joints(leg, rows, seed)
    return q, leg.foot_position(q)


@pytest.mark.parametrize("slope", ["0.0", pytest.param("0.2", marks=pytest.mark.nightly)])
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_the_inverse_puts_the_foot_flat(built, backend, slope):
    """Every posture that forward kinematics makes is one of two; the other one reaches as well, and the sole lies flat in both."""
    robot = robot_of(built(placed_text(slope)), backend)
    for leg in robot.legs.values():
        assert (leg.inverse_class, leg.branch_names) == ("flat sole", ("knee_plus", "knee_minus"))
        q, p = flat_places(leg, 300, 5)
        found, status = leg.inverse(p)
        assert (status == 0).all()
        turned = np.angle(np.exp(1j * (found - q[:, None])))
        assert np.abs(turned).max(axis=2).min(axis=1).max() < 1e-9
        assert np.abs(found).max() <= np.pi
        assert np.abs(leg.foot_position(found) - p[:, None]).max() < 1e-13
        foot = leg.link_angles(found)[..., 2]
        assert np.abs(np.exp(1j * foot) + 1j).max() < 1e-14
        assert np.ptp(leg.sole_points(found) @ [np.sin(-float(slope)), 0.0, np.cos(float(slope))], axis=-1).max() < 1e-13
        for branch in (0, 1):
            one, state = leg.inverse_branch(p, branch)
            assert (state == 0).all()
            assert np.abs(one - found[:, branch]).max() < 1e-13
        near, state = leg.inverse_near(p, q)
        assert (state == 0).all()
        assert np.abs(np.angle(np.exp(1j * (near - q)))).max() < 1e-9


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
def test_statuses_of_the_inverse(built, backend):
    made = built(placed_text())
    leg = made.c.legs["leg"]
    _, p = flat_places(leg, 1, 6)
    hip = leg.joint_frames(np.zeros(3))[0, :3, 3]
    beside, far, bad = p[0] + [0.0, 0.01, 0.0], hip + 1.5 * (p[0] - hip), p[0] * [1.0, np.nan, 1.0]
    far[1] = p[0][1]
    for target, wanted in ((beside, 1), (far, 1), (bad, 2)):
        rows, states = called(made, backend, "inverse", target)
        assert (states == wanted).all()
        assert np.isnan(rows).any() == (wanted == 2)
    rows, _ = called(made, backend, "inverse", beside)
    assert np.abs(leg.foot_position(rows) - p[0]).max() < 1e-13  # the nearest point of the plane
    rows, _ = called(made, backend, "inverse", far)
    reach = np.linalg.norm(leg.joint_frames(rows[0])[2, :3, 3] - hip)
    assert reach == pytest.approx(0.84, abs=1e-12)  # stretched towards it
    level = np.array([hip[0] + 0.84, p[0][1], hip[2]])
    level[2] += leg.foot_position(rows[0])[2] - leg.joint_frames(rows[0])[2, 2, 3]
    rows, states = called(made, backend, "inverse", level)
    assert states[0] == 0
    assert states[1] in (0, 6)  # a straight knee is one posture, but for rounding
    _, state = called(made, backend, "inverse_branch", p[0], 2)
    assert state == 2


YAWED = (
    YAW.replace("alpha_deg = 90\nd = 0.0", "alpha_deg = 90\nd = 0.07")
    .replace("a = 0.0", "a = 0.05")
    .replace("d = 0.07", "d = 0.07\ntheta_deg = 20")
)


def yawing_text(mount="rpy_deg = [0, 0, 30]"):
    """Legs that yaw before the hip, off their axes in every way; the right one mirrored."""
    wanted = ", ".join(f'"{name}"' for name in (*INVERSES, "contact_line"))
    text = LEG.replace('[[leg_designs.leg.joints]]\nname = "hip"', YAWED, 1).replace(FOOT, SHIFTED)
    text = text.replace("mount = { rpy_deg = [90, 0, 0] }", f"mount = {{ xyz = [0.1, 0.1, -0.05], {mount} }}")
    return text.replace('name = "anthropomorphic_leg"', 'name = "yawing"') + (
        f"{PAIR}\n[generate]\nfunctions = [{wanted}]\ntargets = ['c', 'numpy', 'casadi']\n"
    )


def yawed_places(leg, rows, seed):
    """Joint values with a flat foot and any yaw, and where that touches the ground."""
    q = np.concatenate([np.random.default_rng(seed + 1).uniform(-3, 3, (rows, 1)), flat_joints(leg, rows, seed)], axis=1)
    return q, leg.foot_position(q)


MOUNTS = ["rpy_deg = [0, 0, 30]", pytest.param("rpy_deg = [180, 0, 30]", marks=pytest.mark.nightly)]


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_a_leg_that_yaws_puts_its_foot_flat_as_well(built, backend, mount):
    """Four postures: ahead of the yaw axis and behind it, with both knees; forward kinematics makes one, all others reach."""
    robot = robot_of(built(yawing_text(mount)), backend)
    for leg in robot.legs.values():
        assert leg.inverse_class == "flat sole"
        assert leg.branch_names == ("ahead_knee_plus", "ahead_knee_minus", "behind_knee_plus", "behind_knee_minus")
        q, p = yawed_places(leg, 300, 5)
        found, status = leg.inverse(p)
        assert np.isin(status, (0, 1)).all()
        turned = np.angle(np.exp(1j * (found - q[:, None])))
        assert np.abs(turned).max(axis=2).min(axis=1).max() < 1e-9
        reached = status == 0
        assert reached.any(axis=1).all()
        assert reached[:, 2:].mean() > 0.3
        assert np.abs(found).max() <= np.pi
        places = leg.foot_position(found)
        assert np.abs(places - p[:, None])[reached].max() < 1e-13
        assert np.abs(np.exp(1j * leg.link_angles(found)[..., 2]) + 1j).max() < 1e-14
        assert np.ptp(leg.sole_points(found)[..., 2], axis=-1).max() < 1e-13
        missed = np.linalg.norm(places - p[:, None], axis=-1)
        assert np.abs(leg.inverse_distance(p) - missed).max() < 1e-12
        for branch in range(4):
            one, state = leg.inverse_branch(p, branch)
            assert (state == status[:, branch]).all()
            assert np.abs(one - found[:, branch]).max() < 1e-13
        near, state = leg.inverse_near(p, q)
        assert (state == 0).all()
        assert np.abs(np.angle(np.exp(1j * (near - q)))).max() < 1e-9


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
def test_statuses_of_the_inverse_of_a_leg_that_yaws(built, backend):
    made = built(yawing_text())
    leg = made.c.legs["leg"]
    q, p = yawed_places(leg, 20, 8)
    for row in range(3):
        rows, states = called(made, backend, "inverse", p[row])
        assert np.abs(np.angle(np.exp(1j * (rows - q[row])))).max(axis=1).min() < 1e-9
        assert (states[:2] == 0).all() or (states[2:] == 0).all()
    axis = leg.joint_frames(np.zeros(4))[0, :3, 3]
    above = np.array([axis[0], axis[1], p[0][2]])  # nearer to the axis than the plane ever is
    rows, states = called(made, backend, "inverse", above)
    assert (states == 1).all()
    (missed,) = called(made, backend, "inverse_distance", above)
    assert missed == pytest.approx(np.linalg.norm(leg.foot_position(rows) - above, axis=1), abs=1e-12)
    rows, states = called(made, backend, "inverse", p[0] * [1.0, np.nan, 1.0])
    assert (states == 2).all()
    assert np.isnan(rows).any(axis=1).all()
    assert np.isnan(called(made, backend, "inverse_distance", p[0] * [1.0, np.inf, 1.0])[0]).all()


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_distances_of_the_flat_foot(built, backend):
    """Those of the rows of the inverse, wherever the target is."""
    leg = robot_of(built(placed_text()), backend).legs["leg"]
    p = np.random.default_rng(4).uniform(-1.2, 1.2, (300, 3))
    rows, _ = leg.inverse(p)
    missed = np.linalg.norm(leg.foot_position(rows) - p[:, None], axis=-1)
    assert np.abs(leg.inverse_distance(p) - missed).max() < 1e-12


@pytest.mark.parametrize("text", [placed_text, yawing_text])
def test_any_target_gives_a_status_and_never_nan_with_ok(built, text):
    """1e5 in a row: ordinary ones, those on axes and planes, of all sizes, no numbers."""
    leg, random, rows = built(text()).c.legs["leg"], np.random.default_rng(3), 100_000
    p = random.uniform(-1, 1, (rows, 3))
    p[::5] *= 10.0 ** random.integers(-200, 200, (len(p[::5]), 1))
    p[1::5, random.integers(0, 3)] = 0.1  # where the mount is
    p[2::5] = flat_place(leg, len(p[2::5]), 4)
    odd = random.uniform(size=p.shape) < 0.02
    p = np.where(odd, random.choice([np.nan, np.inf, -np.inf, 0.0, 1e300], p.shape), p)
    bad = ~np.isfinite(p).all(axis=1)
    seed = random.uniform(-3, 3, (rows, len(leg.joints)))
    for name, given in (
        ("inverse", (p,)),
        ("inverse_near", (p, seed)),
        ("inverse_branch", (p, random.integers(0, 2, rows).astype(np.int32))),
    ):
        q, status = getattr(leg, name)(*given)
        assert np.isin(status, (0, 1, 2, 3, 6)).all()
        assert np.isfinite(q[(status != 2)]).all()
        assert (status.T == 2)[..., bad].all()
        assert (status.T == 0)[..., 2::5].any()
        ordinary = (status == 0) & (np.abs(p).max(axis=1) < 2.0)[(...,) + (None,) * (status.ndim - 1)]
        away = leg.foot_position(q) - (p[:, None] if status.ndim == 2 else p)
        assert np.abs(away[ordinary]).max() < 1e-12
    distance = leg.inverse_distance(p)
    assert np.isnan(distance[bad]).all()
    assert (distance[~bad] >= 0.0).all()


def flat_place(leg, rows, seed):
    return (flat_places if len(leg.joints) == 3 else yawed_places)(leg, rows, seed)[1]


@pytest.mark.nightly
@pytest.mark.parametrize("text", [placed_text, yawing_text])
def test_self_test_of_inverses(built, capfd, text):
    assert run(built(text()).folder) == 0
    assert ", 0 failed" in capfd.readouterr().out
