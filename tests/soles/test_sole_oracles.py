"""Curved soles beside the theory's oracles, and what the chapter prints of them beside what is so (errata 8.1 to 8.18)."""

import json
from pathlib import Path

import numpy as np
import pytest
from rolling_robots import BACKENDS, CENTRES, CURVES, DEPTH, FRONT, GRAVITY, MASSES, SHANK, THIGH, called, direction, leg_text

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


def test_flat_motion(flat):
    found, status = flat
    oracle = ORACLES["flat_kin"]
    assert status == 0
    assert found[:, 0] == pytest.approx([oracle[key] for key in ("f1", "f1d", "f1dd")], rel=REL)
    assert found[:, 1] == pytest.approx([oracle[key] for key in ("f2", "f2d", "f2dd")], rel=REL)
    assert found[:, 2].tolist() == [-np.pi / 2, 0.0, 0.0]


def test_rolling_motion(rolling):
    contact, angles, point, ankle, margins, status = rolling
    oracle = ORACLES["roll"]
    assert status == 0
    assert contact == pytest.approx([oracle[key] for key in ("lam", "lamd", "lamdd")], rel=REL)
    assert angles[:, 1] == pytest.approx([oracle[key] for key in ("f2", "f2d", "f2dd")], rel=REL)
    assert angles[:, 2] == pytest.approx([oracle[key] for key in ("f3", "f3d", "f3dd")], rel=REL)
    assert point == pytest.approx(oracle["P"], rel=REL)
    assert ankle[0] == pytest.approx(oracle["C"], rel=REL)
    assert margins == pytest.approx([contact[0], np.radians(75) - contact[0]], rel=REL)


def test_rolling_forces(leg, rolling):
    _, angles, point, ankle, _, _ = rolling
    centre = point[0] - ankle[0, 0]
    assert unknowns(leg("stance_forces_load", HIP, angles, LOAD, centre, MU)) == wanted("roll_forces_load")
    assert unknowns(leg("stance_forces_rolling", HIP, angles, centre, MU)) == wanted("roll_forces_seed")


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


def test_friction_limit_is_one_solve(leg, flat):
    """Erratum 8.17: |T| <= mu N, and what the chapter iterates to is one linear solve."""
    torque, _, _, _, (tangential, normal), _, margins, _ = leg("stance_forces_sliding", FLAT_HIP, flat[0], 0.2, 1)
    assert torque == pytest.approx([2.6158644, 0.0, 0.0], abs=5e-8)
    assert tangential == pytest.approx(0.2 * normal, rel=REL)
    assert margins[1] == pytest.approx(0.0, abs=1e-12)
    back = leg("stance_forces_sliding", FLAT_HIP, flat[0], 0.2, -1)
    assert back[4][0] == pytest.approx(-0.2 * back[4][1], rel=REL)


def test_hip_and_ankle_lead_to_each_other(leg, rolling):
    contact, angles, point, ankle, _, _ = rolling
    phase, found, links, at, under, status = leg("stance_position", HIP[0], SWING[0], EDGE - FRONT)
    assert (int(phase), int(status)) == (1, 0)
    assert (found, *links, *at, *under) == pytest.approx((contact[0], *angles[0], *ankle[0], *point), rel=1e-12)
    hip, phase, found, at, under, status = leg("hip_position", links, EDGE - FRONT)
    assert (int(phase), int(status)) == (1, 0)
    assert (*hip, found, *at, *under) == pytest.approx((*HIP[0], contact[0], *ankle[0], *point), rel=1e-12)


# ---- errata


def ellipse(contact):
    """x3, y3 and their slopes, as the theory writes them."""
    c, s = np.cos(contact), np.sin(contact)
    return DEPTH - 0.06 * (1 - c), FRONT + 0.09 * s, -0.06 * s, 0.09 * c


def test_errata_of_the_flat_phase(leg):
    """8.1: (24) is right with x3 down; 8.2: S = X_A + AB cos phi1 +- root; 8.3: phi2 keeps its sign."""
    hip = np.array([0.34, 0.80])
    angles, ankle, _ = leg("flat_ankle", hip, -1.26966574163016, -1)
    knee = hip + THIGH * direction(angles[0])
    assert knee[1] + SHANK * np.sin(angles[1]) - DEPTH == pytest.approx(0.0, abs=1e-14)
    root = np.sqrt(SHANK**2 - (DEPTH - knee[1]) ** 2)
    assert ankle == pytest.approx(knee[0] - root, rel=REL)
    assert np.arccos(root / SHANK) != pytest.approx(angles[1], abs=0.1)


def test_errata_of_the_contact(leg):
    """8.4: x3'/y3' = -cot phi3, not -tan phi3; 8.5: phi3 turns by (n / sigma'^2) lambda'."""
    (phi3, slope, _), (_, speed, _), _, _ = leg("toe_rolling", 0.7, EDGE)
    _, _, dx, dy = ellipse(0.7)
    assert dx / dy == pytest.approx(-1 / np.tan(phi3), rel=REL)
    assert dx / dy == pytest.approx(-0.56153, abs=1e-5)
    assert -np.tan(phi3) == pytest.approx(-1.78086, abs=1e-5)
    near = [leg("toe_rolling", 0.7 + step, EDGE)[0][0] for step in (-1e-5, 1e-5)]
    assert slope == pytest.approx((near[1] - near[0]) / 2e-5, rel=1e-8)
    ddx, ddy = -0.06 * np.cos(0.7), -0.09 * np.sin(0.7)
    assert slope == pytest.approx((ddx * dy - dx * ddy) / speed**2, rel=REL)


def test_errata_of_the_polar_form(leg, rolling):
    """8.6, 8.7 and 8.8: with CP and u by x3 and y3, u' as printed and the missing terms put back, the X row of accelerations holds."""
    (at, rate, second), angles, _, _, _, _ = rolling
    x, y, dx, dy = ellipse(at)
    ddx, ddy = -0.06 * np.cos(at), -0.09 * np.sin(at)
    cp, u = np.hypot(x, y), np.arctan2(y, x)
    du = (dy * x - dx * y) / cp**2
    dcp = (x * dx + y * dy) / cp
    ddu = (ddy * x - ddx * y) / cp**2 - 2 * du * dcp / cp
    ddcp = (dx**2 + dy**2 + x * ddx + y * ddy) / cp - dcp**2 / cp
    _, (_, speed, stretching), _, _ = leg("toe_rolling", at, EDGE)
    (f1, f2, f3), (v1, v2, v3), (a1, a2, a3) = angles
    terms = sum(0.42 * (np.sin(f) * a + np.cos(f) * v**2) for f, v, a in ((f1, v1, a1), (f2, v2, a2)))
    s, c, w = np.sin(f3 + u), np.cos(f3 + u), v3 + du * rate
    foot = cp * s * (a3 + ddu * rate**2 + du * second) + cp * c * w**2 + 2 * dcp * s * w * rate - ddcp * c * rate**2 - dcp * c * second
    assert terms + foot + stretching * rate**2 + speed * second - HIP[2, 0] == pytest.approx(0.0, abs=1e-11)
    without = foot - cp * s * du * second + dcp * c * second
    assert abs(terms + without + stretching * rate**2 + speed * second - HIP[2, 0]) > 0.1


def test_errata_of_the_forces(leg, flat):
    """8.9 to 8.12: the moments about the knee with the load in them; the chapter's signs give another force, and the load alone none."""
    angles = flat[0]
    _, hip, knee, ankle, _, _, _, _ = leg("stance_forces_passive", FLAT_HIP, angles, MU)
    at = FLAT_HIP[0] + THIGH * direction(angles[0, 0])
    down, along = FLAT_HIP[0] - at, SHANK * direction(angles[0, 1])
    turned, lever, load = inertia_terms(angles, 0, FLAT_HIP[2])
    moment = down[0] * hip[1] - down[1] * hip[0]
    assert moment == pytest.approx(turned + (lever + down)[0] * load[1] - (lever + down)[1] * load[0], rel=1e-10)
    assert hip - knee == pytest.approx(load, rel=1e-10)
    assert abs(-moment - turned - (lever + down)[0] * load[1] + (lever + down)[1] * load[0]) > 1.0
    second, own, weight = inertia_terms(angles, 1, FLAT_HIP[2] + knee_acceleration(angles))
    assert along[0] * ankle[1] - along[1] * ankle[0] == pytest.approx(second + own[0] * weight[1] - own[1] * weight[0], rel=1e-10)
    # whatever loads the hip, a chain of hinges passes on what its own inertia asks for: the load is an answer, no choice
    load_rows = np.zeros((3, 13))
    load_rows[0, 0] = load_rows[1, 1] = load_rows[2, 10] = 1.0
    load_rows[:2, 12] = hip
    assert leg("stance_forces", FLAT_HIP, angles, load_rows, MU)[0][0] == pytest.approx(0.0, abs=1e-9)


def knee_acceleration(angles):
    c, s = direction(angles[0, 0])
    return THIGH * (angles[2, 0] * np.array([-s, c]) - angles[1, 0] ** 2 * np.array([c, s]))


def inertia_terms(angles, link, base):
    """J phi'', where the centre is from the link's joint, and W."""
    inertia = (0.13, 0.07, 0.006)[link] * angles[2, link]
    c, s = direction(angles[0, link])
    lever = np.array([[c, -s], [s, c]]) @ CENTRES[link]
    moved = base + angles[2, link] * np.array([-lever[1], lever[0]]) - angles[1, link] ** 2 * lever
    return inertia, lever, MASSES[link] * (moved + np.array([0.0, GRAVITY]))


def test_centres_of_mass(rolling):
    """Erratum 8.16: the plus sign in Y_G2''; the levers above are those of the oracle."""
    angles, oracle = rolling[1], ORACLES["roll_cg"]
    base, at = HIP[2], HIP[0]
    for link, (length, carry) in enumerate(((THIGH, knee_acceleration(angles)), (SHANK, None))):
        _, lever, load = inertia_terms(angles, link, base)
        assert at + lever == pytest.approx(oracle[f"G{link + 1}"], rel=REL)
        assert load / MASSES[link] - [0.0, GRAVITY] == pytest.approx(oracle[f"G{link + 1}dd"], rel=1e-10)
        at = at + length * direction(angles[0, link])
        base = base + carry if carry is not None else base


def test_pressure_of_a_flat_foot(leg, flat):
    """8.13: the foot's three rows, with the ankle's moment; 8.15: the same hold for a rolling foot."""
    found = leg("stance_forces_load", FLAT_HIP, flat[0], LOAD, 0.03, MU)
    torque, _, _, ankle, ground, centre, margins, status = found
    load = MASSES[2] * np.array([0.0, GRAVITY])
    assert ground - ankle == pytest.approx(load, abs=1e-10)
    lever = CENTRES[2][[1, 0]] * [1, -1]
    assert centre * ground[1] + DEPTH * ground[0] + torque[2] == pytest.approx(lever[0] * load[1], rel=1e-9)
    assert margins[2] == pytest.approx(0.09)
    assert status == 0
