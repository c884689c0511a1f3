"""Springs of one link beside the theory's oracles, and what the chapter prints of them beside what is so (errata 7.1 to 7.5)."""

import json
from pathlib import Path

import numpy as np
import pytest
from one_link import text_of

from walkgen.design.chapter import Reduced, Spring, zero_free_length

ORACLES = json.loads((Path(__file__).parent / "balancing_oracles.json").read_text(encoding="utf-8"))
WEIGHT, REL = 9.80665, 1e-11
F, H, K, PULL, FREE = np.array([0.12, 0.03]), np.array([-0.05, -0.28]), 9000.0, 40.0, 0.18
FIRST = {"H": (-0.05, -0.28), "F": (0.12, 0.03), "k": K, "free": FREE, "pull": PULL, "mass": 0.3}
SECOND = {"H": (0.06, -0.25), "F": (0.10, -0.05), "k": 7000.0, "free": 0.16, "pull": 30.0, "mass": 0.25}
BACKENDS = ["c", "numpy", "casadi"]


@pytest.fixture
def made(built):
    return built(text_of(FIRST, SECOND, targets=BACKENDS))


@pytest.mark.parametrize("backend", BACKENDS)
def test_one_spring(made, backend):
    oracle, phi = ORACLES["spring"], np.array([[0.3], [-0.7]])
    moments = made.call(backend, "leg", "spring_moment", phi)[:, 0, 0]
    assert moments == pytest.approx([oracle["M(0.3)"], oracle["M(-0.7)"]], rel=REL)
    assert made.call(backend, "leg", "spring_length", phi)[0, 0] == pytest.approx(oracle["len(0.3)"], rel=REL)
    since_free = K * FREE**2 / 2 - PULL * FREE  # the theory's energy is 0 at no length
    assert made.call(backend, "leg", "spring_energy", phi)[0, 0] == pytest.approx(oracle["U(0.3)"] + since_free, rel=REL)


def test_reduced_form():
    product, squares, turn = ORACLES["spring"]["reduced"]
    spring = Spring(np.hypot(*F), np.hypot(*H), np.arctan2(H[1], H[0]) - np.arctan2(F[1], F[0]), K, PULL - K * FREE)
    found = spring.reduced
    assert (found.K / K, found.s * found.K / K, found.delta) == pytest.approx((product, squares, turn), rel=REL)
    assert spring.moment(0.3) == pytest.approx(ORACLES["spring"]["M(0.3)"], rel=REL)
    phi = np.linspace(-3, 3, 50)
    assert found.moment(phi) == pytest.approx(spring.moment(phi), rel=1e-12, abs=1e-12)
    other = found.realised(4000.0)
    assert other.moment(phi) == pytest.approx(spring.moment(phi), rel=1e-12, abs=1e-10)
    assert other.reduced == Reduced(*map(pytest.approx, (found.K, found.G, found.s, found.delta)))


@pytest.mark.parametrize("backend", BACKENDS)
def test_unbalance(made, backend):
    for key, wanted in ORACLES["imbalance"].items():
        phi, load = map(float, key.split(","))
        found = made.call(backend, "leg", "unbalance_moment", np.array([[phi]]), np.array([load]))
        assert found[0, 0] == pytest.approx(wanted, rel=REL)


# ---- errata ----------------------------------------------------------------------------------------------------------------------------


def e(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def ends(phi):
    """The spring's ends on the frame and on the link."""
    c, s = np.cos(phi), np.sin(phi)
    return H, np.array([c * F[0] - s * F[1], s * F[0] + c * F[1]])


@pytest.mark.parametrize("phi", [-0.7, -0.1, 0.3, 1.2])
def test_erratum_7_1_sign_and_quadrant(made, phi):
    """(21) prints -F BF sin(phi - psi + alpha) with psi from frame to link: that is the moment with the wrong sign."""
    frame, link = ends(phi)
    pull = PULL + K * (np.hypot(*(frame - link)) - FREE)
    lever, alpha = np.hypot(*F), np.arctan2(F[1], F[0])
    to_link, to_frame = (np.arctan2(way[1], way[0]) for way in (link - frame, frame - link))
    found = made.call("numpy", "leg", "spring_moment", np.array([phi]))[0, 0]
    printed = -pull * lever * np.sin(phi - to_link + alpha)
    assert printed / found == pytest.approx(-1, rel=1e-12)
    assert -pull * lever * np.sin(phi - to_frame + alpha) == pytest.approx(found, rel=1e-12)
    step = 1e-6
    stored = [made.call("numpy", "leg", "spring_energy", np.array([phi + sign * step]))[0] for sign in (1, -1)]
    assert found == pytest.approx(-(stored[0] - stored[1]) / (2 * step), rel=1e-6)


def test_erratum_7_2_the_turning_link_has_the_weight(built):
    """With m3 and its centre of mass the moment without springs is gravity's; link 2 does not turn, so its weight has no moment."""
    slack = {**FIRST, "k": 1e-12, "pull": 0.0, "mass": 0.0}
    made, phi, load = built(text_of(slack)), 0.2, 60.0
    found = made.call("numpy", "leg", "unbalance_moment", np.array([phi]), np.array(load))[0]
    centre = 0.18 * np.cos(phi) - 0.01 * np.sin(phi)
    assert found == pytest.approx(WEIGHT * (load * 0.40 * np.cos(phi) - 4.0 * centre), rel=1e-11)


def test_erratum_7_3_one_spring_has_one_angle_for_both_of_its_ends():
    """phi_i is phi_3i, x_31 is x_3I: turning both ends of a spring by one angle, as alpha, changes nothing."""
    frame, phi = np.arctan2(H[1], H[0]), np.linspace(-1, 1, 9)
    for alpha in (0.0, 0.4, -2.0):
        turned = Spring(np.hypot(*F), np.hypot(*H), (frame + alpha) - (np.arctan2(F[1], F[0]) + alpha), K, PULL - K * FREE)
        assert turned.moment(phi)[0] == pytest.approx(Spring(*_plain(), K, PULL - K * FREE).moment(phi)[0], rel=1e-12)


def _plain():
    return np.hypot(*F), np.hypot(*H), np.arctan2(H[1], H[0]) - np.arctan2(F[1], F[0])


NODES = np.concatenate([np.deg2rad(np.linspace(-50, -10, 6)), np.deg2rad(np.linspace(30, 60, 6))])


def unbalance(unknowns, mass, nodes=NODES):
    """Twelve conditions of the chapter's twelve unknowns (eq. 21): per spring x, y on link and frame, initial tension, free length."""
    load = np.where(nodes < 0.3, 60.0, 0.0)
    found = WEIGHT * (load * 0.40 - 4.0 * 0.18) * np.cos(nodes)
    for x, y, X, Y, pull, free, k in np.reshape(unknowns, (2, 7)):
        fx, fy = np.cos(nodes) * x - np.sin(nodes) * y, np.sin(nodes) * x + np.cos(nodes) * y
        length = np.sqrt((X - fx) ** 2 + (Y - fy) ** 2)
        found = found + (pull + k * (length - free)) * (fx * Y - fy * X) / length - mass * WEIGHT * fx
    return found


START = np.array([0.12, 0.03, -0.05, -0.28, 40.0, 0.18, 9000.0, 0.10, -0.05, 0.06, -0.25, 30.0, 0.16, 7000.0])


@pytest.mark.parametrize("stiffness", [False, True])
@pytest.mark.parametrize("mass", [0.0, 0.3])
def test_erratum_7_4_eight_of_twelve_unknowns_are_independent(mass, stiffness):
    """Complex-step slopes, each by its unknown's size: the square system is singular everywhere, with stiffnesses as unknowns too."""
    columns = [number for number in range(14) if stiffness or number % 7 != 6]
    slopes = np.stack([unbalance(START + 1e-30j * np.eye(14)[number], mass).imag / 1e-30 * START[number] for number in columns], -1)
    assert slopes.shape == (12, 14 if stiffness else 12)
    singular = np.linalg.svd(slopes, compute_uv=False)
    assert (singular > 1e-12 * singular[0]).sum() == 8
    assert singular[8] < 1e-14 * singular[0]


def test_erratum_7_4_free_length_and_initial_tension_are_one_unknown(built):
    """Two springs of one stiffness with equal pull - k free are the same spring to the link."""
    longer = {**FIRST, "free": FREE + 0.02, "pull": PULL + K * 0.02}
    one, other = (
        built(text_of(spring)).call("numpy", "leg", "spring_moment", np.linspace(-1, 1, 7)[:, None]) for spring in (FIRST, longer)
    )
    assert one == pytest.approx(other, rel=1e-12)


# ---- springs without free length ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("aside", [0.0, 0.01])
def test_a_spring_without_free_length_balances_exactly(built, aside):
    slack = {**FIRST, "k": 1e-12, "pull": 0.0, "mass": 0.0}
    bare, phi = built(text_of(slack, aside=aside)), np.linspace(-3, 3, 1001)
    load = np.full(len(phi), 60.0)
    found = zero_free_length(phi, bare.call("numpy", "leg", "unbalance_moment", phi[:, None], load)[:, 0])
    assert found.left < 1e-10
    if aside == 0.0:
        assert found.product == pytest.approx(ORACLES["zfl"]["A"], rel=REL)
        assert found.angle == pytest.approx(-np.pi / 2, abs=1e-12)
        assert found.product / (0.12 * 0.25) == pytest.approx(ORACLES["zfl"]["k"], rel=REL)
    k = found.product / (0.12 * 0.25)
    own = {"H": tuple(map(float, 0.25 * e(found.angle))), "F": (0.12, 0.0), "k": float(k), "free": 0.1, "pull": float(0.1 * k), "mass": 0.0}
    exact = built(text_of(own, aside=aside))
    left = exact.call("numpy", "leg", "unbalance_moment", phi[:, None], load)[:, 0]
    assert np.abs(left).max() < 1e-12
    heights = exact.call("numpy", "leg", "foot_position", phi[:, None])[:, 2]
    total = exact.call("numpy", "leg", "potential_energy", phi[:, None]) - load * WEIGHT * heights
    assert np.ptp(total) < 1e-11
