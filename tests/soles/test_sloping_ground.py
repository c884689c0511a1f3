"""A curved sole on a ground that rises forward by a runtime parameter: the same leg, seen from the ground, under a leaning gravity."""

import numpy as np
import pytest
from lagrange import energy_rate, input_power, residual
from rolling_robots import CURVES, LEG, called, random_states, robot_of
from test_foot_point import outline

FUNCTIONS = (
    *("foot_position", "foot_jacobian", "inverse_dynamics", "sole_points", "sole_normal", "link_angles", "joint_angles", "flat_motion"),
    *("toe_motion", "toe_rolling", "stance_forces_load", "stance_forces_passive", "hip_position"),
)
BACKENDS = ["c", "numpy", "casadi"]
SLOPES = (-0.3, 0.0, 0.25)


def text(slope='"rise"'):
    wanted = ", ".join(f'"{name}"' for name in FUNCTIONS)
    head = '[parameters]\nrise = { value = 0.1, unit = "rad", runtime = true }\n\n[leg_designs.leg]\ndh'
    return (
        LEG.replace('name = "anthropomorphic_leg"', 'name = "climber"')
        .replace("[leg_designs.leg]\ndh", head)
        .replace(CURVES["ellipse"], f"{CURVES['ellipse']}\nslope = {slope}")
        + f"\n[generate]\nfunctions = [{wanted}]\ntargets = ['c', 'numpy', 'casadi']\nderivatives = false\n"
    )


@pytest.fixture
def climber(built):
    return built(text())


def turned(slope, vector):
    """From the ground's axes X along, Y across, to the level ones."""
    c, s = np.cos(slope), np.sin(slope)
    return np.asarray(vector) @ [[c, s], [-s, c]]


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_the_foot_point_is_the_nearest_to_the_ground(climber, backend):
    leg = robot_of(climber, backend).legs["leg"]
    q = np.random.default_rng(3).uniform([-2.6, -1.5, -0.6], [-0.4, 0.0, 2.0], (200, 3))
    points = outline()
    for slope in SLOPES:
        place = leg.foot_position(q, param=[slope])
        links = leg.link_angles(q, param=[slope])
        assert np.abs(links - (leg.link_angles(q, param=[0.0]) - slope)).max() < 1e-14
        ankle = 0.42 * sum(np.stack([np.cos(angle + slope), np.sin(angle + slope)], -1) for angle in links[:, :2].T)
        c, s = np.cos(links[:, 2] + slope), np.sin(links[:, 2] + slope)
        world = ankle[:, None] + np.einsum("ijn,mj->nmi", np.array([[c, -s], [s, c]]), points)
        normal = turned(slope, [0.0, 1.0])
        height = (world @ normal).min(axis=1)
        assert np.abs(place[:, [0, 2]] @ normal - height).max() < 1e-7
        assert np.linalg.norm(world - place[:, None, [0, 2]], axis=2).min(axis=1).max() < 1e-4
        assert np.abs(leg.sole_normal(q, param=[slope]) - [normal[0], 0.0, normal[1]]).max() < 1e-14


@pytest.mark.parametrize("backend", BACKENDS)
def test_rolling_states_move_and_are_loaded_as_the_joints_say(climber, backend):
    """The hip that the ground sees moves back by the foot's Jacobian; torques of the stance are those of the whole dynamics."""
    leg = climber.c.legs["leg"]
    hip, thigh, edge, _, _ = random_states(climber, (0.0, np.radians(75)), 12, 21)
    for slope in SLOPES[::2]:
        _, angles, point, ankle, _, status = leg.toe_motion(hip, thigh, edge, param=[slope])
        for row in np.flatnonzero(status == 0)[: 12 if backend != "casadi" else 2]:
            q, qd, qdd = (leg.joint_angles(np.ascontiguousarray(angles[row, order]), param=[slope]) for order in range(3))
            zero = leg.joint_angles(np.zeros(3), param=[slope])
            qd, qdd = qd - zero, qdd - zero
            (place,), (slopes,) = (called(climber, backend, name, q, param=[slope]) for name in ("foot_position", "foot_jacobian"))
            assert place[[0, 2]] == pytest.approx(turned(slope, point[row] - hip[row, 0]), abs=1e-13)
            assert (slopes @ qd)[[0, 2]] == pytest.approx(turned(slope, -hip[row, 1]), abs=1e-12)
            held = hip[row].copy()
            held[1:] = 0.0
            lever = point[row, 0] - ankle[row, 0, 0]
            found = leg.stance_forces_load(held, angles[row], (-30.0, -500.0), lever, 0.6, param=[slope])
            x, z = turned(slope, found[4])
            (torque,) = called(climber, backend, "inverse_dynamics", q, qd, qdd, np.array([x, 0.0, z]), param=[slope])
            assert torque == pytest.approx(found[0], rel=1e-11, abs=1e-10)


def test_forces_obey_lagrange_under_a_leaning_gravity(climber):
    leg, random = climber.c.legs["leg"], np.random.default_rng(5)
    hip = random.uniform(-2, 2, (40, 3, 2))
    hip[:, 0] = random.uniform([0.1, 0.6], [0.5, 0.84], (40, 2))
    for slope in SLOPES[::2]:
        angles, status = leg.flat_motion(hip, 0.18, 1, param=[slope])
        load = random.uniform(-800, 100, (40, 2))
        for each, links, own in zip(hip[status == 0], angles[status == 0], load, strict=False):
            found = leg.stance_forces_load(each, links, own, 0.05, 0.6, param=[slope])
            worst, scale = residual(each, links, found, slope)
            assert worst < 1e-10 * scale
            assert input_power(each, links, found) == pytest.approx(energy_rate(each, links, slope), abs=1e-9 * scale)


def test_flat_on_the_slope(climber):
    leg = climber.c.legs["leg"]
    for slope in SLOPES:
        q = leg.joint_angles([-1.2, -2.2, -np.pi / 2], param=[slope])
        ankle = 0.42 * (turned(slope, [np.cos(-1.2), np.sin(-1.2)]) + turned(slope, [np.cos(-2.2), np.sin(-2.2)]))
        assert leg.foot_position(q, param=[slope])[[0, 2]] == pytest.approx(ankle + turned(slope, [0.0, -0.09]), abs=1e-14)
        corners = leg.sole_points(q, param=[slope])
        wanted = [ankle + turned(slope, [y, -0.09]) for y in (0.12, -0.06, -0.06, 0.12)]
        assert np.abs(corners[:, [0, 2]] - wanted).max() < 1e-14
        assert np.abs(np.abs(corners[:, 1]) - 0.05).max() < 1e-15
