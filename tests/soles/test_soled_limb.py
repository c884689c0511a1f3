"""What every leg has, of legs with curved soles: compliance beside a frame of beams, rates of feet, statuses of what they cannot do."""

import numpy as np
import pytest
from rolling_robots import CURVES, LEG, called, leg_text, robot_of
from test_foot_point import PAIR, YAW

from oracles.beam_frame import frame

COMPLIANCES = ("foot_compliance", "sole_compliance", "sole_points", "foot_position", "joint_frames", "joint_angles", "foot_rotation")
RATES = (
    "inverse_velocity",
    "inverse_acceleration",
    "inverse_velocity_acceleration",
    "foot_jacobian",
    "foot_acceleration",
    "toe_motion",
    "toe_rolling",
    "joint_angles",
)
TUBE = "[sections.tube]\nE = 70e9\nG = 26e9\nA = 3e-4\nIy = 4e-8\nIz = 5e-8\nJ = 8e-8\n\n[leg_designs.leg]\ndh"
FOOT = "foot = { xyz = [0.0, 0.0, 0.0] }"


def elastic_text(text=LEG):
    """Two legs that yaw, all links tubes."""
    text = text.replace('[[leg_designs.leg.joints]]\nname = "hip"', YAW, 1).replace(
        "mount = { rpy_deg = [90, 0, 0] }", "mount = { xyz = [0.0, 0.1, 0.0] }"
    )
    text = text.replace("[leg_designs.leg]\ndh", TUBE).replace("link = {", 'link = { section = "tube",') + PAIR
    return text.replace('name = "anthropomorphic_leg"', 'name = "bendy"')


def built_text():
    wanted = ", ".join(f'"{name}"' for name in (*COMPLIANCES, *RATES, "stance_compliance", "contact_points"))
    return elastic_text() + f"\n[generate]\nfunctions = [{wanted}]\ntargets = ['c', 'numpy']\n"


def postures(leg):
    """Flat, on the toe, on the heel."""
    for foot in (-np.pi / 2, -2.0, -1.3):
        yield np.concatenate([[0.3], leg.joint_angles([-1.2, -2.2, foot])])


def held(text, leg, q):
    """The spec with a plain rigid foot that reaches to where the sole touches at q, in the foot's axes."""
    away = leg.foot_rotation(q).T @ (leg.foot_position(q) - leg.joint_frames(q)[-1, :3, 3])
    start = text.index("[leg_designs.leg.curved_sole]")
    plain = text[:start] + text[text.index("[[platforms]]") :]
    plain = plain.replace('{ section = "tube", mass = 1.2', "{ mass = 1.2")
    return plain.replace(FOOT, f"foot = {{ xyz = {np.round(away, 12).tolist()} }}")


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_compliance_is_that_of_beams_to_where_the_sole_touches(built, backend):
    made = built(built_text())
    robot = robot_of(made, backend)
    leg = robot.legs["leg"]
    for q in postures(leg):
        wanted = frame(held(elastic_text(), leg, q), np.concatenate([q, q])).compliance()
        C = leg.foot_compliance(q)
        assert np.abs(C - wanted[:3, :3]).max() < 1e-9 * np.abs(C).max()
        # a rigid sole moves as a body, so that all corners pushed alike yield in the mean as the foot does where it is their middle
        corners, line = leg.sole_compliance(q).reshape(4, 3, 4, 3), leg.sole_points(q)
        whole = robot.stance_compliance(np.concatenate([q, q]))
        assert np.abs(whole[:12, :12] - corners.reshape(12, 12)).max() == 0.0
        assert np.abs(whole[:12, 12:]).max() == 0.0
        if np.abs(line[0] - line[1]).max() == 0.0:
            assert np.abs(corners.mean(axis=(0, 2)) - C).max() < 1e-12 * np.abs(C).max()
        # a force on a corner works on the other corner as the other way round, and never draws energy
        assert np.abs(corners - corners.transpose(2, 3, 0, 1)).max() == 0.0
        assert np.linalg.eigvalsh(corners.reshape(12, 12))[0] > -1e-12 * np.abs(C).max()


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_rates_of_a_leg_with_a_yaw_joint(built, backend):
    """The least that move the foot's point at the contact as wanted."""
    leg = robot_of(built(built_text()), backend).legs["right"]
    random = np.random.default_rng(3)
    for q in postures(leg):
        v, a = random.normal(size=(2, 3))
        qd, status = leg.inverse_velocity(q, v)
        assert status == 0
        assert qd == pytest.approx(np.linalg.pinv(leg.foot_jacobian(q)) @ v, rel=1e-9)
        qdd, status = leg.inverse_acceleration(q, qd, a)
        assert status == 0
        assert leg.foot_acceleration(q, qd, qdd) == pytest.approx(a, rel=1e-9)
        *both, status = leg.inverse_velocity_acceleration(q, v, a)
        assert status == 0
        assert np.array(both) == pytest.approx(np.array([qd, qdd]), rel=1e-9)


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
def test_rates_of_a_leg_in_a_plane_are_singular(built, backend):
    """No joint moves its foot sideways; along the plane the damped rates come as near as those of any such leg."""
    made = built(leg_text(CURVES["ellipse"], RATES, "flatland"))
    q = made.c.legs["leg"].joint_angles([-1.2, -2.2, -2.0])
    (jacobian,), (qd, status) = called(made, backend, "foot_jacobian", q), called(made, backend, "inverse_velocity", q, [0.3, 0.0, -0.2])
    assert status == 3
    assert (jacobian @ qd)[[0, 2]] == pytest.approx([0.3, -0.2], abs=0.02)
