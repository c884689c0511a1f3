"""Curved soles beside the theory's oracles."""

import json
from pathlib import Path

import numpy as np
import pytest
from rolling_robots import BACKENDS, CURVES, DEPTH, FRONT, GRAVITY, MASSES, SHANK, called, direction, leg_text

ORACLES = json.loads((Path(__file__).parent / "sole_oracles.json").read_text(encoding="utf-8"))
REL = 1e-11
HIP, SWING, EDGE = np.array([[0.42, 0.80], [0.9, -0.01], [0.0, 0.1]]), np.array([-1.15, 0.6, 18.0]), 0.30
FLAT_HIP, ANKLE = np.array([[0.30, 0.80], [0.9, -0.02], [0.5, 0.1]]), 0.18
FEW = {"ellipse": (), "polynomial": (("toe_rolling",), "poly")}
"""What is built of each toe: all, or little."""
LOAD, MU = (-30.0, -500.0), 0.6
ORDER = ("R01X", "R01Y", "R12X", "R12Y", "R32X", "R32Y", "N", "T", "mN", "M01", "M12", "M23", "d")


def unknowns(found):
    """In the theory's order."""
    torque, hip, knee, ankle, (tangential, normal), centre, _, _ = found
    return np.concatenate([hip, knee, ankle, [normal, tangential, centre * normal], torque, [centre]])


def wanted(name):
    return pytest.approx([ORACLES[name][key] for key in ORDER], rel=REL, abs=REL)


@pytest.fixture(params=BACKENDS)
def leg(request, built):
    made = built(leg_text())
    return lambda name, *inputs: called(made, request.param, name, *inputs)


@pytest.fixture
def rolling(leg):
    """The oracle's state."""
    return leg("toe_motion", HIP, SWING, EDGE)


@pytest.fixture
def flat(leg):
    return leg("flat_motion", FLAT_HIP, ANKLE, 1)


@pytest.mark.parametrize(("curve", "oracle", "contact"), [("ellipse", "sole_ellipse", 0.7), ("polynomial", "sole_poly", 0.06)])
def test_functions_of_the_contact_parameter(built, curve, oracle, contact):
    made, oracle = built(leg_text(CURVES[curve], *FEW[curve])), ORACLES[oracle]
    for backend in BACKENDS:
        angle, arc, point, ankle = called(made, backend, "toe_rolling", contact, EDGE)
        assert angle == pytest.approx([oracle[key] for key in ("phi3", "p1", "p2")], rel=REL)
        assert arc == pytest.approx([oracle[key] for key in ("s", "sp", "spp")], rel=REL)
        assert point == pytest.approx(oracle["P"], rel=REL)
        assert ankle == pytest.approx(np.array([oracle[key] for key in ("C", "C1", "C2")]), rel=REL)


def test_flat_position_and_back(leg):
    phi1, phi2 = -1.26966574163016, -2.31522603791699
    angles, status = leg("flat_position", (0.34, 0.80), ANKLE, 1)
    assert status == 0
    assert angles == pytest.approx([phi1, phi2, -np.pi / 2], rel=REL)
    back, ankle, status = leg("flat_ankle", (0.34, 0.80), angles[0], -1)
    assert status == 0
    assert (*back, ankle) == pytest.approx((phi1, phi2, -np.pi / 2, ANKLE), rel=REL)
    assert angles[:2] == pytest.approx(ORACLES["flat"]["phi1,phi2"], rel=REL)
    shank, where, edge = ORACLES["flat"]["phi2,S,XR"]
    assert (back[1], ankle) == pytest.approx((shank, where), rel=REL)
    assert leg("toe_rolling", 0.0, edge)[3][0] == pytest.approx([where, DEPTH], rel=REL)


def test_flat_motion(flat):
    found, status = flat
    oracle = ORACLES["flat_kin"]
    assert status == 0
    assert found[:, 0] == pytest.approx([oracle[key] for key in ("f1", "f1d", "f1dd")], rel=REL)
    assert found[:, 1] == pytest.approx([oracle[key] for key in ("f2", "f2d", "f2dd")], rel=REL)
    assert found[:, 2].tolist() == [-np.pi / 2, 0.0, 0.0]


def test_rolling_motion(leg, rolling):
    contact, angles, point, ankle, margins, status = rolling
    oracle = ORACLES["roll"]
    assert status == 0
    assert contact == pytest.approx([oracle[key] for key in ("lam", "lamd", "lamdd")], rel=REL)
    assert angles[:, 1] == pytest.approx([oracle[key] for key in ("f2", "f2d", "f2dd")], rel=REL)
    assert angles[:, 2] == pytest.approx([oracle[key] for key in ("f3", "f3d", "f3dd")], rel=REL)
    assert point == pytest.approx(oracle["P"], rel=REL)
    assert ankle[0] == pytest.approx(oracle["C"], rel=REL)
    slope = leg("toe_rolling", contact[0], EDGE)[3][1]
    assert SHANK * (direction(angles[0, 1]) @ slope) == pytest.approx(oracle["detM"], rel=REL)
    assert margins == pytest.approx([contact[0], np.radians(75) - contact[0]], rel=REL)


def test_rolling_forces(leg, rolling):
    _, angles, point, ankle, _, _ = rolling
    centre = point[0] - ankle[0, 0]
    assert unknowns(leg("stance_forces_load", HIP, angles, LOAD, centre, MU)) == wanted("roll_forces_load")
    assert unknowns(leg("stance_forces_rolling", HIP, angles, centre, MU)) == wanted("roll_forces_seed")


def test_centres_of_mass_accelerate(leg, rolling):
    """What the forces on each link say of its centre of mass."""
    _, angles, point, ankle, _, _ = rolling
    _, hip, knee, lower, ground, *_ = leg("stance_forces_rolling", HIP, angles, point[0] - ankle[0, 0], MU)
    for number, force in enumerate((hip - knee, knee + lower, ground - lower)):
        found = force / MASSES[number] - [0.0, GRAVITY]
        assert found == pytest.approx(ORACLES["roll_cg"][f"G{number + 1}dd"], rel=REL)


def test_flat_forces(leg, flat):
    angles, _ = flat
    assert unknowns(leg("stance_forces_passive", FLAT_HIP, angles, MU)) == wanted("flat_passive")
    assert unknowns(leg("stance_forces_pressure", FLAT_HIP, angles, 0.03, MU)) == wanted("flat_cop_d=.03")
    assert unknowns(leg("stance_forces_load", FLAT_HIP, angles, LOAD, 0.03, MU)) == wanted("flat_load_d=.03")


def test_closing_rows_give_what_the_modes_give(leg, flat):
    angles, _ = flat
    torque = np.zeros((3, 13))
    torque[(0, 1, 2), (9, 10, 11)] = 1.0
    assert unknowns(leg("stance_forces", FLAT_HIP, angles, torque, MU)) == wanted("flat_passive")
    pressed = np.zeros((3, 13))
    pressed[0, 0] = pressed[1, 1] = pressed[2, 8] = 1.0
    pressed[:2, 12], pressed[2, 6] = LOAD, -0.03
    assert unknowns(leg("stance_forces", FLAT_HIP, angles, pressed, MU)) == wanted("flat_load_d=.03")
    found = leg("stance_forces_ankle", FLAT_HIP, angles, LOAD, MU)
    assert found[0][2] == pytest.approx(0.0, abs=1e-10)
    free = leg("stance_forces_load", FLAT_HIP, angles, LOAD, found[5], MU)
    assert unknowns(found) == pytest.approx(unknowns(free), rel=1e-10, abs=1e-10)


def test_hip_and_ankle_lead_to_each_other(leg, rolling):
    contact, angles, point, ankle, _, _ = rolling
    phase, found, links, at, under, status = leg("stance_position", HIP[0], SWING[0], EDGE - FRONT)
    assert (int(phase), int(status)) == (1, 0)
    assert (found, *links, *at, *under) == pytest.approx((contact[0], *angles[0], *ankle[0], *point), rel=1e-12)
    hip, phase, found, at, under, status = leg("hip_position", links, EDGE - FRONT)
    assert (int(phase), int(status)) == (1, 0)
    assert (*hip, found, *at, *under) == pytest.approx((*HIP[0], contact[0], *ankle[0], *point), rel=1e-12)
