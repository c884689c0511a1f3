"""The hydraulic leg beside the theory's oracles: what walkgen generates, from the foot to the forces in every pin."""

import json
from pathlib import Path

import numpy as np
import pytest

from linkages.hydraulic import FUNCTIONS, plates, spec
from linkages.hydraulic_theory import MP, driven, reaching

ORACLES = json.loads((Path(__file__).parent / "hydraulic_oracles.json").read_text(encoding="utf-8"))
PLATES = {
    "hyd_knee+1": {},
    "hyd_knee-1": {"alpha": 0.2, "beta": -1.2, "side": -1},
    "hyd_alpha+0.2": {"alpha": 0.2},
}
SIDES = {"hyd_knee-1": {"knee": "right", "lift": "right"}}
KNEE = {"hyd_knee+1": 1, "hyd_knee-1": -1, "hyd_alpha+0.2": 1}
P, RATE, SECOND, LOAD = ([0.10, -0.60, 0], [-0.4, 0.05, 0], [0.3, -0.2, 0], [40, 600, 0])
I, E, STILL = np.array([0.02, -0.01]), np.array([-0.25, 0.10]), np.zeros(2)  # noqa: E741 - the chapter's name
HI, HP, WEIGHT = 0.35, 0.45, 9.80665
REL = 1e-11
OK, UNREACHABLE, SINGULAR = 0, 1, 3
PAIRS = ("i on frame", "i on thigh", "h on thigh", "h on shank", "lift on frame", "lift on thigh", "knee on thigh", "knee on shank")


@pytest.fixture(params=list(ORACLES))
def case(request, built):
    name = request.param
    return name, built(spec(**PLATES[name], **SIDES.get(name, {}), functions=FUNCTIONS)).numpy.legs["leg"], Oracle(ORACLES[name])


class Oracle:
    """Compares with the values that the oracle has; `hyd_alpha+0.2` has a few."""

    def __init__(self, values):
        self.values = values

    def check(self, **found):
        for name, value in found.items():
            if name in self.values:
                assert value == pytest.approx(self.values[name], rel=REL, abs=0), name


def reached(leg, name):
    """The lengths at P on the oracle's knee."""
    q, status = leg.inverse(P)
    assert leg.branch_names == ("h_left", "h_right")
    branch = (1 - KNEE[name]) // 2
    assert status[branch] == OK
    return q[branch]


def turned(frame, point):
    return frame[:2, :2] @ point + frame[:2, 3]


def test_lengths_and_joints(case):
    name, leg, oracle = case
    q = reached(leg, name)
    oracle.check(EG=q[0], JL=q[1])
    assert leg.foot_position(q) == pytest.approx(P, abs=1e-14)
    _, thigh, shank = leg.joint_frames(q)
    f, turn = (np.arctan2(frame[1, 0], frame[0, 0]) for frame in (thigh, shank))
    oracle.check(phi_IH=f, phi_PH=turn, Phi=np.angle(np.exp(1j * (turn - f))))
    own = plates(**PLATES[name])
    g, j, l, h = turned(thigh, own["G"]), turned(thigh, own["J"]), turned(shank, own["L"]), turned(thigh, [HI, 0])  # noqa: E741
    oracle.check(H=h, G=g, J=j, L=l, G6=turned(thigh, [0.16, 0.02]), G7=turned(shank, [0.25, -0.01]))
    oracle.check(phi1=np.arctan2(*(g - E)[::-1]), phi2=np.arctan2(*(l - j)[::-1]), HL=np.hypot(*(h - l)), d=np.hypot(*(P[:2] - I)))
    assert turned(shank, [HP, 0]) == pytest.approx(h, abs=1e-15)


def test_transmission_angles(case):
    name, leg, oracle = case
    psi, theta = leg.transmission_angles(reached(leg, name))
    oracle.check(Psi=psi, Theta=theta)
    exact = reaching(MP.mpc("0.10", "-0.60"), KNEE[name], **PLATES[name])
    assert [psi, theta] == pytest.approx([float(exact.psi), float(exact.theta)], rel=REL)


def test_rates(case):
    name, leg, oracle = case
    q = reached(leg, name)
    qd, status = leg.inverse_velocity(q, RATE)
    assert status == OK
    oracle.check(EGd=qd[0], JLd=qd[1])
    exact = reaching(MP.mpc("0.10", "-0.60"), KNEE[name], **PLATES[name])
    assert qd == pytest.approx([float(rate) for rate in exact.length_rates(MP.mpc("-0.4", "0.05"))], rel=REL)
    spatial = leg.foot_spatial_jacobian(q) @ qd
    assert spatial[:3] == pytest.approx(RATE, abs=1e-14)
    thigh, shank = directions(leg, q)
    oracle.check(qd=spatial[5], fd=(RATE + HP * spatial[5] * normal(shank)) @ normal(thigh) / HI)


def directions(leg, q):
    """Of thigh and shank."""
    return [frame[:, 0] for frame in leg.joint_frames(q)[1:, :3, :3]]


def normal(direction):
    return np.array([-direction[1], direction[0], 0])


def test_second_rates(case):
    name, leg, oracle = case
    q = reached(leg, name)
    qd, _ = leg.inverse_velocity(q, RATE)
    qdd, status = leg.inverse_acceleration(q, qd, SECOND)
    assert status == OK
    exact = reaching(MP.mpc("0.10", "-0.60"), KNEE[name], **PLATES[name])
    wanted = exact.second_length_rates(MP.mpc("-0.4", "0.05"), MP.mpc("0.3", "-0.2"))
    assert qdd == pytest.approx([float(rate) for rate in wanted], rel=REL)
    assert leg.foot_acceleration(q, qd, qdd) == pytest.approx(SECOND, abs=1e-13)
    *both, status = leg.inverse_velocity_acceleration(q, RATE, SECOND)
    assert status == OK
    assert np.array(both) == pytest.approx(np.array([qd, qdd]), rel=REL)
    rate, second = (leg.foot_spatial_jacobian(q) @ qd)[5], (leg.foot_spatial_jacobian(q) @ qdd + leg.foot_bias_acceleration(q, qd))[5]
    thigh, shank = directions(leg, q)
    of_h = SECOND + HP * (second * normal(shank) - rate**2 * shank)
    oracle.check(qdd=second, fdd=of_h @ normal(thigh) / HI)


def test_forces_and_reactions(case):
    name, leg, oracle = case
    q = reached(leg, name)
    fd2, fd1 = leg.driving_forces(q, STILL, STILL, LOAD)
    oracle.check(Fd1=fd1, Fd2=fd2)
    given = dict(zip(PAIRS, leg.joint_reactions(q, STILL, STILL, LOAD), strict=True))
    assert "Rows: " + ", ".join(PAIRS) in leg.joint_reactions.signature.doc
    oracle.check(R69=-given["knee on thigh"][:2] + [0, 1.8 * WEIGHT], R67=given["h on shank"][:2], R06=given["i on thigh"][:2])
    exact = reaching(MP.mpc("0.10", "-0.60"), KNEE[name], **PLATES[name]).forces(MP.mpc(40, 600))
    for pair, vector in (("h on shank", exact.r67), ("i on thigh", exact.r06), ("knee on shank", exact.fd1 * exact.pose.u2)):
        assert given[pair] == pytest.approx([float(vector.real), float(vector.imag), 0], rel=REL, abs=1e-11)
    _, thigh, shank = leg.joint_frames(q)
    own = plates(**PLATES[name])
    g, j, l = turned(thigh, own["G"]), turned(thigh, own["J"]), turned(shank, own["L"])  # noqa: E741
    oracle.check(D1=cross(turned(thigh, [HI, 0]) - l, (l - j) / q[1]), D2=cross(I - g, (g - E) / q[0]))


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def test_powers(case):
    name, leg, oracle = case
    q = reached(leg, name)
    qd, _ = leg.inverse_velocity(q, RATE)
    slow = 1e-8  # inertia goes with the square of the rates
    powers, total, positive = (value / slow for value in leg.power(q, slow * qd, STILL, LOAD))
    oracle.check(P2=powers[0], P1=powers[1])
    fd2, fd1 = leg.driving_forces(q, STILL, STILL, LOAD)
    assert total == pytest.approx(fd1 * qd[1] + fd2 * qd[0], rel=REL)
    if "power" in oracle.values:
        scale = np.abs(powers).max() / abs(oracle.values["power"])  # the sum of two that nearly cancel
        assert total == pytest.approx(oracle.values["power"], rel=REL * max(scale, 1))
    assert positive == pytest.approx(np.maximum(powers, 0).sum(), rel=1e-12)


@pytest.mark.parametrize("exponent", range(2, 12))
@pytest.mark.parametrize("end", ["stretched", "folded"])
def test_towards_the_dead_point(built, end, exponent):
    """Both cylinders near where their dyads are flat: finite, and as far from 40 digits as their conditions say."""
    leg = built(spec(functions=FUNCTIONS)).numpy.legs["leg"]
    q = near_dead(end, 10.0**-exponent)
    exact = driven(q)
    assert leg.assembly_status(q) == OK
    psi, theta = leg.transmission_angles(q)
    condition = max(abs(1 / MP.sin(angle)) for angle in (exact.psi, exact.theta)) ** 2
    tolerance = 1e-15 * float(condition)
    assert np.sin([psi, theta]) == pytest.approx([float(MP.sin(exact.psi)), float(MP.sin(exact.theta))], rel=4 * tolerance)
    assert leg.foot_position(q)[:2] == pytest.approx([float(exact.P.real), float(exact.P.imag)], rel=4 * tolerance)
    forces, wanted = leg.driving_forces(q, STILL, STILL, LOAD), exact.forces(MP.mpc(40, 600))
    assert forces == pytest.approx([float(wanted.fd2), float(wanted.fd1)], rel=20 * tolerance)


def near_dead(end, way):
    """Lengths a small way inside the flat dyads' own."""
    own = plates()
    side = 1 if end == "stretched" else -1
    arm, span = np.hypot(own["L"][0] - HP, own["L"][1]), np.hypot(own["J"][0] - HI, own["J"][1])
    lift, knee = np.hypot(*(E - I)) + side * np.hypot(*own["G"]), span + side * arm
    return np.array([lift - side * way, knee - side * way])


@pytest.mark.parametrize("end", ["stretched", "folded"])
def test_at_the_dead_point_and_beyond(built, end):
    leg = built(spec(functions=FUNCTIONS)).numpy.legs["leg"]
    assert leg.assembly_status(near_dead(end, 0.0)) in {SINGULAR, UNREACHABLE}
    assert leg.assembly_status(near_dead(end, 1e-14)) == SINGULAR
    beyond = near_dead(end, -1e-6)
    assert leg.assembly_status(beyond) == UNREACHABLE
    assert np.isnan(leg.foot_position(beyond)).any()
