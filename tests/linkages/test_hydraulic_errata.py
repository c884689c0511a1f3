"""Errata 6.1 to 6.16 of the chapter's hydraulic leg: the printed formula fails, the corrected one is what walkgen computes."""

import numpy as np
import pytest

from linkages.hydraulic import FUNCTIONS, plates, spec

I, E = 0.02 - 0.01j, -0.25 + 0.10j  # noqa: E741 - the chapter's name
HI, HP, WEIGHT = 0.35, 0.45, 9.80665
M5, M6, M7, M8, M9 = 1.2, 5.0, 4.0, 1.0, 1.8
FOOT, RATE, LOAD = 0.10 - 0.60j, -0.4 + 0.05j, 40 + 600j
OTHER = {"alpha": 0.2, "beta": -1.2, "side": -1}
STILL = np.zeros(2)


def flat(z):
    return [z.real, z.imag, 0]


def cross(a, b):
    return (np.conj(a) * b).imag


def wrapped(angle):
    return np.angle(np.exp(1j * angle))


def e(angle):
    return np.exp(1j * angle)


class Leg:
    """walkgen's leg at a foot: joints as complex numbers from its frames, rates and forces from its functions."""

    def __init__(self, leg, foot=FOOT, right=False, **plate):
        self.leg, own = leg, plates(**plate)
        self.lengths = leg.inverse(flat(foot))[0][int(right)]
        _, thigh, shank = leg.joint_frames(self.lengths)
        at = lambda frame, point: complex(*(frame[:2, :2] @ point + frame[:2, 3]))  # noqa: E731 - a formula
        self.H, self.G, self.J, self.G6 = (at(thigh, point) for point in ([HI, 0], own["G"], own["J"], [0.16, 0.02]))
        self.P, self.L, self.G7 = (at(shank, point) for point in ([0, 0], own["L"], [0.25, -0.01]))
        self.f, self.q = np.angle(self.H - I), np.angle(self.H - self.P)
        self.u1, self.u2 = (self.G - E) / self.lengths[0], (self.L - self.J) / self.lengths[1]
        self.rates = leg.inverse_velocity(self.lengths, flat(RATE))[0]
        self.fd2, self.fd1 = leg.driving_forces(self.lengths, STILL, STILL, flat(LOAD))
        given = leg.joint_reactions(self.lengths, STILL, STILL, flat(LOAD))
        self.r67, self.r69 = complex(*given[3, :2]), -complex(*given[6, :2]) + 1j * M9 * WEIGHT

    def turns(self):
        """fd and qd, by what walkgen says of the shank."""
        qd = (self.leg.foot_spatial_jacobian(self.lengths) @ self.rates)[5]
        of_h = RATE + 1j * qd * HP * e(self.q)
        return (np.conj(1j * e(self.f)) * of_h).real / HI, qd


@pytest.fixture
def leg(built):
    return Leg(built(spec(functions=FUNCTIONS)).numpy.legs["leg"])


@pytest.fixture
def other(built):
    """The mirrored plates, both dyads on their right side."""
    robot = built(spec(**OTHER, knee="right", lift="right", functions=FUNCTIONS)).numpy
    return Leg(robot.legs["leg"], right=True, **OTHER)


def solutions(u, v, w, sign):
    """Angles with u cos + v sin + w = 0."""
    root = sign * np.sqrt(u**2 + v**2 - w**2)
    return np.arctan2(-v * w - u * root, -u * w + v * root)


def knees(leg, sign_f, sign_q, from_h=False):
    """f and q by the quadratics of the theory's 6.2; `from_h` measures from H to P as printed, not from I."""
    span = leg.P - I
    printed = leg.P - leg.H if from_h else span
    q = solutions(2 * HP * printed.real, 2 * HP * printed.imag, HP**2 + abs(span) ** 2 - HI**2, sign_q)
    shift = I - leg.H if from_h else -span
    f = solutions(2 * HI * shift.real, 2 * HI * shift.imag, HI**2 + abs(span) ** 2 - HP**2, sign_f)
    return f, q


def gap(leg, f, q):
    """How far the two links' ends are apart."""
    return abs(I + HI * e(f) - leg.P - HP * e(q))


def test_1_and_2_differences_are_from_the_hip_to_the_foot(leg):
    f, q = knees(leg, 1, -1)
    assert gap(leg, f, q) < 1e-15
    assert [f, q] == pytest.approx([leg.f, leg.q], abs=1e-14)
    with np.errstate(invalid="ignore"):
        printed = knees(leg, 1, -1, from_h=True)
    assert not gap(leg, f, printed[1]) < 0.01
    assert not gap(leg, printed[0], q) < 0.01


def test_3_signs_are_opposite_and_a_cosine_loses_one(leg):
    assert gap(leg, *knees(leg, 1, 1)) > 0.5
    assert gap(leg, *knees(leg, -1, -1)) > 0.5
    f, q = (np.arccos(np.cos(angle)) for angle in (leg.f, leg.q))
    assert gap(leg, f, q) > 0.1


def test_4_rate_of_the_thigh(leg):
    size = HI * HP * np.sin(leg.f - leg.q)
    along = (np.conj(RATE) * e(leg.q)).real
    printed, found = HI / size * along, leg.turns()[0]
    assert found == pytest.approx(-HP / size * along, rel=1e-12)
    assert printed / found == pytest.approx(-HI / HP, rel=1e-12)


def test_5_rate_of_the_shank(leg):
    size = HI * HP * np.sin(leg.f - leg.q)
    printed, found = HI / size * (np.conj(RATE) * e(leg.f)).real, leg.turns()[1]
    assert printed / found == pytest.approx(-1, rel=1e-12)


def thrust_of_the_knee(leg):
    """(14)."""
    span, weights = leg.H - leg.P, M8 * (leg.H - leg.L).real + M7 * (leg.H - leg.G7).real
    angle = np.angle(leg.L - leg.J)
    arm = (leg.H - leg.L).real * np.sin(angle) - (leg.H - leg.L).imag * np.cos(angle)
    return (LOAD.real * span.imag - LOAD.imag * span.real + WEIGHT * weights) / arm, arm


def test_6_equation_14_is_right(leg, other):
    for one in (leg, other):
        assert thrust_of_the_knee(one)[0] == pytest.approx(one.fd1, rel=1e-12)


def thrust_of_the_lift(leg, arm=None, sign=-1, twice=0.0):
    """(15) with every printed fault as an option: the arm of (14), +R69X, and m9 once more in R67."""
    own = (I - leg.G).real * leg.u1.imag - (I - leg.G).imag * leg.u1.real
    r69 = leg.fd1 * leg.u2 + 1j * M9 * WEIGHT
    r67 = -LOAD - leg.fd1 * leg.u2 + 1j * (M7 + M8 + twice) * WEIGHT
    weights = M5 * WEIGHT * (I - leg.G).real + M6 * WEIGHT * (I - leg.G6).real
    to_j = (I - leg.J).real * r69.imag + sign * (I - leg.J).imag * r69.real
    return (weights + to_j + cross(I - leg.H, r67)) / (arm or own)


def test_7_to_9_thrust_of_the_lift(leg, other):
    for one in (leg, other):
        assert thrust_of_the_lift(one) == pytest.approx(one.fd2, rel=1e-11)
        faults = {"arm": thrust_of_the_knee(one)[1], "sign": 1, "twice": M9}
        for name, value in faults.items():
            assert abs(thrust_of_the_lift(one, **{name: value}) / one.fd2 - 1) > 1e-3, name
        assert one.r69 == pytest.approx(one.fd1 * one.u2 + 1j * M9 * WEIGHT, rel=1e-12)
        assert one.r67 == pytest.approx(-LOAD - one.fd1 * one.u2 + 1j * (M7 + M8) * WEIGHT, rel=1e-12)


def test_10_direction_of_a_thrust(other):
    span = other.L - other.J
    printed = np.arctan(span.imag / span.real)
    assert e(printed) == pytest.approx(-other.u2, rel=1e-12)
    assert e(np.arctan2(span.imag, span.real)) == pytest.approx(other.u2, rel=1e-12)


def test_11_power_pairs_every_thrust_with_its_own_cylinder(leg):
    lift, knee = leg.rates
    slow = 1e-8
    total = leg.leg.power(leg.lengths, slow * leg.rates, STILL, flat(LOAD))[1] / slow
    assert total == pytest.approx(leg.fd1 * knee + leg.fd2 * lift, rel=1e-10)
    demanded = potential_rate(leg) - (np.conj(LOAD) * RATE).real
    assert total == pytest.approx(demanded, rel=1e-10)
    assert abs(leg.fd1 * lift + leg.fd2 * knee - demanded) > 10


def potential_rate(leg):
    """Of all weights, by the heights of what carries them."""
    fd, qd = leg.turns()
    thigh = M6 * (leg.G6 - I) + M5 * (leg.G - I) + M9 * (leg.J - I)
    shank = M7 * (leg.G7 - leg.P) + M8 * (leg.L - leg.P)
    return WEIGHT * (fd * thigh.real + qd * shank.real + (M7 + M8) * RATE.imag)


def test_virtual_power_vanishes(leg, other):
    for one in (leg, other):
        work = one.fd2 * one.rates[0] + one.fd1 * one.rates[1] + (np.conj(LOAD) * RATE).real - potential_rate(one)
        assert abs(work) < 1e-9
    box = np.random.default_rng(6).uniform([-0.2, -0.7], [0.3, -0.45], (100, 2))
    for x, y in box:
        one = Leg(leg.leg, complex(x, y))
        work = one.fd2 * one.rates[0] + one.fd1 * one.rates[1] + (np.conj(LOAD) * RATE).real - potential_rate(one)
        assert abs(work) < 1e-9 * max(1, abs(one.fd1 * one.rates[1]) / 1000)


def works(leg, right):
    """Signed and positive work of a closed path of the foot, trapezia."""
    turn = np.linspace(0, 2 * np.pi, 256, endpoint=False)
    foot, rate = 0.3 - 0.6j + 0.05 * np.exp(1j * turn), 0.05j * np.exp(1j * turn)
    found, status = leg.inverse(np.stack([foot.real, foot.imag, 0 * turn], -1))
    q = found[:, right]
    assert (status[:, right] == 0).all()
    qd = leg.inverse_velocity(q, np.stack([rate.real, rate.imag, 0 * turn], -1))[0]
    slow = 1e-7
    _, total, positive = leg.power(q, slow * qd, 0 * q, np.broadcast_to(flat(LOAD), (len(q), 3)))
    return (value.mean() * 2 * np.pi / slow for value in (total, positive))


def test_12_signed_work_does_not_depend_on_the_design(leg, other):
    (signed, spent), (as_signed, more) = works(leg.leg, 0), works(other.leg, 1)
    assert abs(signed) < 1e-12 * spent
    assert abs(as_signed) < 1e-12 * more
    assert abs(more / spent - 1) > 0.01


def test_13_transmission_angle_of_the_lift(leg, other):
    for one, beta in ((leg, 1.2), (other, -1.2)):
        psi = one.leg.transmission_angles(one.lengths)[0]
        phi = np.angle(one.u1)
        assert psi == pytest.approx(wrapped(one.f + beta - phi), abs=1e-12)
        assert psi == pytest.approx(np.angle((I - one.G) / (E - one.G)), abs=1e-12)
        assert abs(wrapped(one.f - beta - phi - psi)) > 0.5


def test_14_transmission_angle_of_the_knee(built, leg):
    one = Leg(built(spec(alpha=0.2, functions=FUNCTIONS)).numpy.legs["leg"], alpha=0.2)
    for alpha, each in ((-0.2, leg), (0.2, one)):
        theta = each.leg.transmission_angles(each.lengths)[1]
        arm = abs(HP - 0.5 * e(alpha))
        eta = np.arccos((arm**2 + HP**2 - 0.5**2) / (2 * arm * HP))
        back = np.angle(each.J - each.L)
        assert theta == pytest.approx(wrapped(each.q - np.sign(alpha) * eta - back), abs=1e-12)
        printed = wrapped(each.q + eta - back)
        assert (abs(printed - theta) > 1) == (alpha > 0)


def test_15_angle_of_the_knee(leg):
    between = abs(np.angle((I - leg.H) / (leg.P - leg.H)))
    assert abs(wrapped(leg.q - leg.f)) == pytest.approx(between, abs=1e-14)
    assert abs(wrapped(leg.q + np.pi - leg.f)) == pytest.approx(np.pi - between, abs=1e-14)
    assert abs(between - np.pi / 2) > 0.05


def test_16_lengths_leave_two_points_and_two_triangles(built, leg):
    near, far = (complex(*plates(side=side)["J"]) for side in (1, -1))
    assert abs(near) == pytest.approx(abs(far), rel=1e-14)
    assert abs(near - HI) == pytest.approx(abs(far - HI), rel=1e-14)
    mirrored = built(spec(side=-1, functions=("inverse",))).numpy.legs["leg"]
    assert abs(mirrored.inverse(flat(FOOT))[0][0, 1] - leg.lengths[1]) > 0.01
    hg, beta = 0.34, 0.15  # HG < HI: two IG
    roots = np.roots([1, -2 * HI * np.cos(beta), HI**2 - hg**2])
    assert (roots > 0).all()
    assert [abs(root * e(beta) - HI) for root in roots] == pytest.approx([hg, hg], rel=1e-12)
