"""What the chapter prints of a curved sole's forces beside what is so: errata 8.9 to 8.17 of the theory, judged by Lagrange."""

import numpy as np
import pytest
from lagrange import residual
from rolling_robots import CENTRES, GRAVITY, INERTIAS, MASSES, SHANK, THIGH, across, direction, leg_text
from test_sole_oracles import ANKLE, EDGE, FLAT_HIP, HIP, LOAD, MU, ORACLES, REL, SWING

Q = np.array([-30.0, -500.0])
M12, M23 = 10, 11
"""Of the unknowns."""


@pytest.fixture
def leg(built):
    return built(leg_text()).c.legs["leg"]


@pytest.fixture
def flat(leg):
    return leg.flat_motion(FLAT_HIP, ANKLE, 1)[0]


@pytest.fixture
def rolling(leg):
    """Contact, angles, contact point and ankle of the oracle's state."""
    return leg.toe_motion(HIP, SWING, EDGE)[:4]


def turned(vector):
    """z x v."""
    return np.array([-vector[1], vector[0]])


def moment(lever, force):
    return lever[0] * force[1] - lever[1] * force[0]


class Inertia:
    """J phi'', W and the levers of the theory's rows, by this file's formulas."""

    def __init__(self, hip, angles):
        self.places, self.levers, self.loads, self.spins = [hip[0]], [], [], []
        acceleration = hip[2]
        for link, length in enumerate((THIGH, SHANK, 0.0)):
            angle, rate, spin = angles[:, link]
            lever = np.column_stack([direction(angle), across(angle)]) @ CENTRES[link]
            self.levers.append(lever)
            self.loads.append(MASSES[link] * (acceleration + spin * turned(lever) - rate**2 * lever + [0.0, GRAVITY]))
            self.spins.append(INERTIAS[link] * spin)
            reach = length * direction(angle)
            self.places.append(self.places[-1] + reach)
            acceleration = acceleration + spin * turned(reach) - rate**2 * reach

    def six(self, load=(0.0, 0.0), sign=1.0, of_load=1.0):
        """R01, R12 and R32 of (27), with Q and with the sign of R01's moment about the knee and that of the moment of Q."""
        hip, knee, ankle, _ = self.places
        down, along, one, load = hip - knee, ankle - knee, np.eye(2), np.asarray(load)
        matrix, right = np.zeros((6, 6)), np.zeros(6)
        matrix[:2, :2], matrix[:2, 2:4], right[:2] = one, -one, self.loads[0] - load
        matrix[2, :2] = sign * turned(down)
        right[2] = self.spins[0] + moment(self.levers[0] + down, self.loads[0]) - of_load * moment(down, load)
        matrix[3:5, 2:4], matrix[3:5, 4:], right[3:5] = one, one, self.loads[1]
        matrix[5, 4:] = turned(along)
        right[5] = self.spins[1] + moment(self.levers[1], self.loads[1])
        return np.linalg.solve(matrix, right).reshape(3, 2)


def test_centres_of_mass(rolling):
    """Of this file's formulas, beside the theory's."""
    rows, oracle = Inertia(HIP, rolling[1]), ORACLES["roll_cg"]
    for number, (place, lever, load) in enumerate(zip(rows.places, rows.levers, rows.loads, strict=False)):
        assert place + lever == pytest.approx(oracle[f"G{number + 1}"], rel=REL)
        assert load / MASSES[number] - [0.0, GRAVITY] == pytest.approx(oracle[f"G{number + 1}dd"], rel=REL)


@pytest.fixture(params=["flat", "rolling"])
def passive(request, leg):
    """The rows of a state, and what the generated code says of its forces without torques."""
    if request.param == "flat":
        hip, angles = FLAT_HIP, request.getfixturevalue("flat")
    else:
        hip, angles = HIP, request.getfixturevalue("rolling")[1]
    found = leg.stance_forces_passive(hip, angles, MU)
    worst, scale = residual(hip, angles, found)
    assert worst < 1e-12 * scale  # Lagrange takes the code's side below
    return Inertia(hip, angles), np.array(found[1:4])


def test_8_9_the_sign_of_the_hip_s_moment_about_the_knee(passive):
    rows, forces = passive
    assert rows.six() == pytest.approx(forces, rel=REL)
    assert np.abs(rows.six(sign=-1.0)[0] - forces[0]).max() > 10.0


def test_8_10_the_moment_of_the_load_about_the_knee(passive):
    """The chain of hinges passes on what its own inertia asks for, whatever loads the hip; without the load's moment it does not."""
    rows, forces = passive
    right, printed = rows.six(Q), rows.six(Q, of_load=0.0)
    assert right[1:] == pytest.approx(forces[1:], rel=1e-10)
    assert np.abs(printed[2] - forces[2]).max() > 100.0


def test_8_11_the_second_link_s_own_inertia_counts_about_the_knee(passive):
    """F_i2X, not F_12X, the force in the knee."""
    rows, (_, knee, ankle) = passive
    along, lever, load = rows.places[2] - rows.places[1], rows.levers[1], rows.loads[1]
    given = moment(along, ankle)
    assert given == pytest.approx(rows.spins[1] + moment(lever, load), rel=1e-10)
    assert abs(given - rows.spins[1] - moment(lever, [knee[0], load[1]])) > 1.0


def test_8_12_the_load_of_a_chain_of_hinges_is_an_answer(leg, flat, passive):
    """Only Q + R01 exists; any other load takes torques."""
    rows, forces = passive
    for load in (0.0 * Q, Q, -2.0 * Q):
        assert rows.six(load)[0] + load == pytest.approx(forces[0], rel=1e-10)
    own = leg.stance_forces_passive(FLAT_HIP, flat, MU)
    same, other = (leg.stance_forces_load(FLAT_HIP, flat, load, float(own[5]), MU) for load in (own[1], LOAD))
    assert np.abs(same[0]).max() < 1e-11
    assert np.abs(other[0]).max() > 10.0


@pytest.mark.parametrize("state", ["flat", "rolling"])
def test_8_13_and_8_15_the_foot_has_three_rows(leg, flat, rolling, state):
    """T - R32X, N - R32Y - m3 g and the moment with M23; (30) of a rolling foot holds. Without the ankle's moment the one row does not."""
    hip, angles = (FLAT_HIP, flat) if state == "flat" else (HIP, rolling[1])
    centre = 0.03 if state == "flat" else rolling[2][0] - rolling[3][0, 0]
    torque, _, _, ankle, ground, at, _, _ = leg.stance_forces_load(hip, angles, LOAD, centre, MU)
    rows = Inertia(hip, angles)
    assert ground - ankle == pytest.approx(rows.loads[2], rel=1e-9, abs=1e-10)
    height = rows.places[2][1]
    given = at * ground[1] + height * ground[0]
    wanted = rows.spins[2] + moment(rows.levers[2], rows.loads[2])
    assert given + torque[2] == pytest.approx(wanted, rel=1e-9)
    assert abs(given - wanted) > 10.0


def test_8_14_a_foot_that_rolls_needs_its_ankle_s_torque(leg, rolling):
    """M01 = M12 = 0 and the pressure at the contact leave M23 open; with M23 = 0 as well the pressure is elsewhere."""
    _, angles, point, ankle = rolling
    centre = point[0] - ankle[0, 0]
    found = leg.stance_forces_rolling(HIP, angles, centre, MU)
    assert found[0] == pytest.approx([0.0, 0.0, ORACLES["roll_forces_seed"]["M23"]], rel=REL, abs=REL)
    assert abs(leg.stance_forces_passive(HIP, angles, MU)[5] - centre) > 0.1


def test_8_16_the_knee_carries_the_shank_s_centre_up(leg, rolling):
    """The plus sign in Y_G2''."""
    _, angles, point, ankle = rolling
    (f1, f2, _), (v1, v2, _), (a1, a2, _) = angles
    _, _, knee, lower, *_ = leg.stance_forces_rolling(HIP, angles, point[0] - ankle[0, 0], MU)
    found = (knee + lower)[1] / MASSES[1] - GRAVITY
    thigh = THIGH * (np.cos(f1) * a1 - np.sin(f1) * v1**2)
    x, y = CENTRES[1]
    own = a2 * (np.cos(f2) * x - np.sin(f2) * y) - v2**2 * (np.sin(f2) * x + np.cos(f2) * y)
    assert found == pytest.approx(HIP[2, 1] + thigh + own, rel=1e-10)
    assert found == pytest.approx(ORACLES["roll_cg"]["G2dd"][1], rel=REL)
    assert abs(found - (HIP[2, 1] - thigh + own)) > 0.1


def test_8_17_friction_bounds_the_size_of_the_tangential_force(leg, flat):
    """R32X < mu N passes a foot that slips backward, and T > mu N never sees it."""
    found = leg.stance_forces_load(FLAT_HIP, flat, (300.0, -300.0), 0.0, MU)
    tangential, normal = found[4]
    assert tangential < 0.0 < normal
    assert (found[3][0] < MU * normal, tangential > MU * normal) == (True, False)
    assert found[6][1] == pytest.approx(MU * normal - abs(tangential), rel=REL)
    assert found[6][1] < 0.0


def test_8_17_the_limit_of_friction_is_one_solve(leg, flat):
    """What the chapter iterates to: T by the last N, M01 and N by that T, 19 times."""
    mu = 0.2
    torque, _, _, _, (tangential, normal), _, margins, _ = leg.stance_forces_sliding(FLAT_HIP, flat, mu, 1)
    rows = np.zeros((3, 13))
    rows[0, 7] = rows[1, M12] = rows[2, M23] = 1.0
    rows[0, 12] = mu * leg.stance_forces_passive(FLAT_HIP, flat, MU)[4][1]
    away = []
    for _ in range(20):
        found = leg.stance_forces(FLAT_HIP, flat, rows, MU)
        away.append(abs(found[0][0] - torque[0]))
        rows[0, 12] = mu * found[4][1]
    assert away[0] > 0.5
    assert away[18] > 1e-12 > away[19]
    assert torque == pytest.approx([2.6158644, 0.0, 0.0], abs=5e-8)
    assert tangential == pytest.approx(mu * normal, rel=REL)
    assert margins[1] == pytest.approx(0.0, abs=1e-12)
    back = leg.stance_forces_sliding(FLAT_HIP, flat, mu, -1)[4]
    assert back[0] == pytest.approx(-mu * back[1], rel=REL)
