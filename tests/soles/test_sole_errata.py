"""What the chapter prints of curved soles beside what is so: errata of kinematics in the theory, judged by differences."""

import numpy as np
import pytest
from rolling_robots import DEPTH, FRONT, SHANK, THIGH, direction, leg_text
from test_sole_oracles import EDGE, HIP, ORACLES, REL, SWING


@pytest.fixture
def leg(built):
    return built(leg_text()).c.legs["leg"]


@pytest.fixture
def rolling(leg):
    """Contact, angles, contact point and ankle of the oracle's state."""
    return leg.toe_motion(HIP, SWING, EDGE)[:4]


def test_8_1_the_ankle_of_a_flat_foot_is_as_high_as_the_sole_is_deep(leg):
    """(24), second row, is right: x3 points down. Were it up, the loop would not close."""
    hip = np.array([0.34, 0.80])
    angles, _, _ = leg.flat_ankle(hip, -1.26966574163016, -1)
    ankle = hip[1] + THIGH * np.sin(angles[0]) + SHANK * np.sin(angles[1])
    assert ankle - DEPTH == pytest.approx(0.0, abs=1e-14)
    assert abs(ankle + DEPTH) > 0.1


def test_8_2_where_the_flat_foot_is(leg):
    """S = X_A + AB cos(phi1) +- root, X_R = S + y3R; the chapter leaves the thigh out."""
    hip, (_, where, edge) = np.array([0.34, 0.80]), ORACLES["flat"]["phi2,S,XR"]
    angles, ankle, _ = leg.flat_ankle(hip, -1.26966574163016, -1)
    knee = hip + THIGH * direction(angles[0])
    root = np.sqrt(SHANK**2 - (DEPTH - knee[1]) ** 2)
    assert ankle == pytest.approx(where, rel=REL)
    assert knee[0] - root == pytest.approx(where, rel=REL)
    assert knee[0] - root + FRONT == pytest.approx(edge, rel=REL)
    for printed in (root, -root):
        assert abs(printed - where) > 0.05
        assert abs(hip[0] + printed + FRONT - edge) > 0.05


def test_8_3_the_shank_s_angle_keeps_its_sign(leg):
    hip = np.array([0.34, 0.80])
    angles, _, _ = leg.flat_ankle(hip, -1.26966574163016, -1)
    rise = (DEPTH - hip[1] - THIGH * np.sin(angles[0])) / SHANK
    root = np.sqrt(1 - rise**2)
    assert np.arctan2(rise, -root) == pytest.approx(angles[1], rel=REL)
    assert abs(np.arccos(root) - angles[1]) > 0.1


def ellipse(contact):
    """x3, y3 and their first two derivatives, as the theory writes them."""
    c, s = np.cos(contact), np.sin(contact)
    return np.array([DEPTH - 0.06 * (1 - c), FRONT + 0.09 * s]), np.array([-0.06 * s, 0.09 * c]), np.array([-0.06 * c, -0.09 * s])


def test_8_4_the_tangent_is_level(leg):
    """x3'/y3' = -cot(phi3), not -tan(phi3)."""
    phi3 = leg.toe_rolling(0.7, EDGE)[0][0]
    _, (dx, dy), _ = ellipse(0.7)
    assert dx / dy == pytest.approx(-1 / np.tan(phi3), rel=REL)
    assert dx * np.sin(phi3) + dy * np.cos(phi3) == pytest.approx(0.0, abs=1e-15)
    assert (dx / dy, -np.tan(phi3)) == pytest.approx((-0.56153, -1.78086), abs=1e-5)


def difference(value, at, step=1e-4):
    """The slope of a function by central differences of fourth order."""
    near, far = (value(at + times * step) - value(at - times * step) for times in (1, 2))
    return (8 * near - far) / (12 * step)


def test_8_5_how_fast_the_foot_turns(leg):
    """phi3' = n / sigma'^2; what follows from the printed (25) is another rate, with either of its two denominators."""
    (phi3, slope, _), (_, speed, _), _, _ = leg.toe_rolling(0.7, EDGE)
    _, (dx, dy), (ddx, ddy) = ellipse(0.7)
    n = ddx * dy - dx * ddy
    by_differences = difference(lambda at: leg.toe_rolling(at, EDGE)[0][0], 0.7)
    assert slope == pytest.approx(by_differences, rel=1e-9)
    assert slope == pytest.approx(n / speed**2, rel=REL)
    for denominator in (dx, dy):
        assert abs(-n * np.cos(phi3) ** 2 / denominator**2 - by_differences) > 0.1


class Polar:
    """CP and u of the contact point in the foot, by differences and by the theory's formulas."""

    def __init__(self, at):
        (x, y), (dx, dy), (ddx, ddy) = ellipse(at)
        self.cp, self.u = np.hypot(x, y), np.arctan2(y, x)
        self.du = (dy * x - dx * y) / self.cp**2
        self.dcp = (x * dx + y * dy) / self.cp
        self.ddu = (ddy * x - ddx * y) / self.cp**2 - 2 * self.du * self.dcp / self.cp
        self.ddcp = (dx**2 + dy**2 + x * ddx + y * ddy) / self.cp - self.dcp**2 / self.cp


def test_8_6_how_fast_the_contact_leaves_the_ankle(leg, rolling):
    """By x3 and y3: with the point's coordinates on the shank, link 2, the printed slope is another one."""
    (at, *_), angles, point, ankle = rolling
    by_differences = difference(lambda there: np.hypot(*ellipse(there)[0]), at)
    far = difference(lambda there: np.linalg.norm(np.subtract(*_lever(leg, there))), at)
    assert Polar(at).dcp == pytest.approx(by_differences, rel=1e-9)
    assert far == pytest.approx(by_differences, rel=1e-9)
    c, s = direction(angles[0, 1])
    x2, y2 = np.array([[c, s], [-s, c]]) @ (point - ankle[0])
    _, (dx, dy), _ = ellipse(at)
    assert abs((x2 * dx + y2 * dy) / Polar(at).cp - by_differences) > 0.01


def _lever(leg, at):
    _, _, point, ankle = leg.toe_rolling(at, EDGE)
    return point, ankle[0]


def test_8_7_the_polar_angle_s_second_derivative():
    """u'' is right as printed."""
    at = 0.7
    assert Polar(at).du == pytest.approx(difference(lambda there: Polar(there).u, at), rel=1e-9)
    assert Polar(at).ddu == pytest.approx(difference(lambda there: Polar(there).du, at), rel=1e-9)


def along_x(rolling, leg, foot):
    """The X row of the loop's accelerations with the foot's part of it."""
    (at, rate, second), ((f1, f2, _), (v1, v2, _), (a1, a2, _)), _, _ = rolling
    _, (_, speed, stretching), _, _ = leg.toe_rolling(at, EDGE)
    terms = THIGH * (np.sin(f1) * a1 + np.cos(f1) * v1**2) + SHANK * (np.sin(f2) * a2 + np.cos(f2) * v2**2)
    return terms + foot + stretching * rate**2 + speed * second - HIP[2, 0]


def test_8_7_and_8_8_the_foot_in_the_x_row_of_accelerations(leg, rolling):
    """The row with all its terms is 0; with u lambda'' for u' lambda'', with CP'' times a rate, or without what has lambda'', it is not."""
    (at, rate, second), angles, _, _ = rolling
    polar, (f3, v3, a3) = Polar(at), angles[:, 2]
    s, c, w = np.sin(f3 + polar.u), np.cos(f3 + polar.u), v3 + polar.du * rate
    spin, swing = a3 + polar.ddu * rate**2 + polar.du * second, 2 * polar.dcp * s * w * rate
    stretch = polar.ddcp * c * rate**2 + polar.dcp * c * second
    right = polar.cp * s * spin + polar.cp * c * w**2 + swing - stretch
    assert along_x(rolling, leg, right) == pytest.approx(0.0, abs=1e-11)
    no_bar = right + polar.cp * s * (polar.u - polar.du) * second
    scrambled = right + polar.ddcp * c * (rate**2 - w)
    lost = right - polar.cp * s * polar.du * second + polar.dcp * c * second
    for printed in (no_bar, scrambled, lost):
        assert abs(along_x(rolling, leg, printed)) > 0.1


def test_8_18_the_calm_of_a_roll_is_d2phi3_dt2(leg):
    """Not the angular velocity: the third row of the foot's motion is the second derivative of its angle, by differences."""

    def moved(time):
        hip, thigh = HIP.copy(), SWING.copy()
        hip[0] += time * HIP[1] + time**2 / 2 * HIP[2]
        hip[1] += time * HIP[2]
        thigh[0] += time * SWING[1] + time**2 / 2 * SWING[2]
        thigh[1] += time * SWING[2]
        return leg.toe_motion(hip, thigh, EDGE)[1][:, 2]

    by_differences = difference(lambda time: moved(time)[1], 0.0)
    assert moved(0.0)[2] == pytest.approx(by_differences, rel=1e-8)
    assert abs(moved(0.0)[1] - by_differences) > 10.0
