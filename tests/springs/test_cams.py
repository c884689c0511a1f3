"""Cams that balance a link: the theory's oracles, errata 7.9 to 7.15, energy and free bodies."""

import json
from pathlib import Path

import numpy as np
import pytest
from cut_cams import CASES, G, R, cut
from scipy.integrate import solve_ivp
from two_springs import written

from walkgen.design.cam import profile, residual
from walkgen.design.search import designed
from walkgen.model.cam_potential import OnLink, Pull, Weight

SPECS = Path(__file__).parents[2] / "specs"
ORACLES = json.loads((Path(__file__).parent / "balancing_oracles.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", CASES)
def test_profiles(name):
    oracle = ORACLES[name]
    _, found = cut(name)
    assert found.level == pytest.approx(oracle["V0"], rel=1e-12)
    rows = next(rows for key, rows in oracle.items() if key.startswith("rows"))
    for angle, r, slope, x, y, edge_x, edge_y, *_ in rows:
        place = int(np.abs(found.phi - np.deg2rad(angle)).argmin())
        assert found.phi[place] == pytest.approx(np.deg2rad(angle), abs=1e-12)
        assert (found.r[place], found.slopes[place]) == pytest.approx((r, slope), rel=1e-11)
        assert [*found.pitch[place], *found.contact[place]] == pytest.approx([x, y, edge_x, edge_y], rel=1e-11, abs=1e-14)


@pytest.mark.parametrize("name", CASES)
def test_the_total_potential_is_constant(name):
    _, found = cut(name)
    values = energy(name, found.phi, found.r)
    assert np.ptp(values) < 1e-12 * abs(found.level)
    assert values[0] == pytest.approx(found.level, rel=1e-12)


def energy(name, phi, r):
    """Written out from the note (7.6, 7.7)."""
    if name == "cam15":
        length = np.sqrt(0.12**2 + (r - 0.10) ** 2 - 2 * 0.12 * (r - 0.10) * np.sin(phi))
        return G * 2.732 * np.sin(phi) + 1.3 * G * r - 180 * length + 1250 * length**2
    a = r + 0.06
    length = np.sqrt(a**2 + 0.09 - 0.6 * a * np.sin(phi))
    moment = 2.72 + 0.1 * a + 0.8 * (r + 0.02) + 0.2 * r
    return G * moment * np.sin(phi) - 134 * length + 900 * length**2


def left(name, phi, r, slopes):
    """Of an independent free body: force of the cam on the roller from the follower's balance, moment on the link, slopes of the cut."""
    if name == "cam15":
        F, H, D = 0.12 * np.exp(1j * phi), 1j * (r - 0.10), 1j * r
        pull = (2500 * np.abs(H - F) - 180) * (H - F) / np.abs(H - F)  # on the link, the opposite on the follower
        tangent = slopes * 1j - 1j * D  # of the cam under the roller, while the link turns and the roller slides on X = 0
        normal = 1j * tangent / np.abs(tangent)
        normal = normal * np.sign(normal.imag)
        push = (1.3 * G + pull.imag) / normal.imag
        return (np.conj(F) * pull).imag - (np.conj(D) * push * normal).imag - G * 2.732 * np.cos(phi)
    e = np.exp(1j * phi)
    F, H, D = (r + 0.06) * e, 0.30j, r * e
    pull = (1800 * np.abs(H - F) - 134) * (H - F) / np.abs(H - F)  # on the follower
    tangent = (slopes + 1j * r) * e
    normal = -1j * tangent / np.abs(tangent)
    weight = -1j * G * 1.1
    along = (np.conj(e) * (pull + weight)).real
    push = -along / (np.conj(e) * normal).real
    moment = (np.conj(F) * pull).imag + (np.conj(D) * push * normal).imag - G * 2.72 * np.cos(phi)
    return moment - G * np.cos(phi) * (0.1 * (r + 0.06) + 0.8 * (r + 0.02) + 0.2 * r)


@pytest.mark.parametrize("name", CASES)
def test_free_bodies_of_the_numerical_profile_fall_fourfold(name):
    """With tangents by differences of the cut points what is left falls with the square of their distance."""
    sizes = []
    for points in (201, 401, 801, 1601):
        cam, found = cut(name, points)
        slopes = np.gradient(found.r, found.phi, edge_order=2)
        moments = left(name, found.phi, found.r, slopes)
        assert moments == pytest.approx(residual(cam, found), abs=1e-9)
        sizes.append(np.abs(moments).max())
    ratios = np.divide(sizes[:-1], sizes[1:])
    assert ratios == pytest.approx([4, 4, 4], abs=0.15)
    assert sizes[-1] < 1e-4
    assert np.abs(left(name, found.phi, found.r, found.slopes)).max() < 1e-10


def test_forces_and_pressure_angles_of_the_examples():
    _, found = cut("cam15")
    assert np.rad2deg(np.abs(found.pressure)).max() == pytest.approx(10.8, abs=0.05)
    assert (found.force.min(), found.force.max()) == pytest.approx((517, 667), abs=0.5)
    _, found = cut("cam16")
    assert np.rad2deg(np.abs(found.pressure)).max() == pytest.approx(45, abs=0.05)


@pytest.mark.parametrize("name", CASES)
def test_curvature_beside_differences(name):
    _, found = cut(name)
    first = np.gradient(found.pitch, found.phi, axis=0)
    second = np.gradient(first, found.phi, axis=0)
    bend = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / np.linalg.norm(first, axis=1) ** 3
    assert np.abs(found.curvature)[5:-5] == pytest.approx(bend[5:-5], rel=1e-4)


# ---- errata -----------------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CASES)
def test_errata_7_9_and_7_12_the_edge_is_the_rollers_envelope(name):
    """In the axes of what bears the cam: the edge is R from the roller's centres everywhere, and nowhere nearer to any of them."""
    _, found = cut(name)
    distances = np.linalg.norm(found.contact[::20, None] - found.pitch[None], axis=-1)
    assert distances.min(1) == pytest.approx(np.full(len(distances), R), abs=1e-7)
    assert np.linalg.norm(found.contact - found.pitch, axis=1) == pytest.approx(np.full(len(found.phi), R), rel=1e-12)
    run = np.gradient(found.contact, found.phi, axis=0)
    to_centre = found.pitch - found.contact
    assert np.abs((run * to_centre).sum(1))[2:-2].max() < 1e-6 * np.linalg.norm(run, axis=1).max() * R * 10


@pytest.mark.parametrize("name", CASES)
def test_errata_7_10_and_7_11_the_level_set_solves_the_differential_equation(name):
    """(22) and (23) as corrected, integrated, give the same cam; (22) counts a mass that hangs at C, so a carried load is negative."""
    _, found = cut(name)
    phi, r = found.phi, found.r

    def slope(angle, way):
        step = 1e-6
        along = (energy(name, angle + step, way[0]) - energy(name, angle - step, way[0])) / (2 * step)
        out = (energy(name, angle, way[0] + step) - energy(name, angle, way[0] - step)) / (2 * step)
        return [-along / out]

    answer = solve_ivp(slope, (phi[0], phi[-1]), [r[0]], method="DOP853", rtol=1e-12, atol=1e-14, t_eval=phi[::100])
    assert answer.y[0] == pytest.approx(r[::100], abs=1e-8)


def test_erratum_7_10_sign_of_the_load(tmp_path):
    """A foot that carries 5 kg is balanced as S less 5 BC; hanging there it would be S more."""
    text = (SPECS / "balanced_leg_cam1.toml").read_text(encoding="utf-8").replace("load = 0.0  ", "load = 5.0  ")
    found = designed(written(tmp_path, text))
    carried = OnLink(Weight(-G * (2.732 - 5 * 0.40)), Pull(2500.0, -180.0), G, 0.12, 0.10, 1.3)
    assert found.profile.r == pytest.approx(profile(carried, found.profile.phi, 0.36, R).r, rel=1e-12)


def test_erratum_7_10_the_follower_bears_the_springs_end_at_h():
    """R93 with the spring's mass at H balances the follower; with that at F, as printed, another force and a moment would be left."""
    at_link, at_follower = 0.1, 0.5
    cam = OnLink(Weight(-G * (2.72 + at_link * 0.12)), Pull(2500.0, -180.0), G, 0.12, 0.10, 1.2 + at_follower)
    found = profile(cam, np.deg2rad(np.linspace(-35, 55, 91)), 0.36, R)
    phi, Y, slopes = found.phi, found.r, found.slopes
    F, H, D = 0.12 * np.exp(1j * phi), 1j * (Y - 0.10), 1j * Y
    pull = (2500 * np.abs(H - F) - 180) * (H - F) / np.abs(H - F)
    normal = (1j * Y - slopes) / np.hypot(Y, slopes)
    for mass, low, high in ((at_follower, 0.0, 1e-10), (at_link, 0.1, 5.0)):
        push = ((1.2 + mass) * G + pull.imag) / normal.imag
        left = (np.conj(F) * pull).imag - (np.conj(D) * push * normal).imag - G * (2.72 + at_link * 0.12) * np.cos(phi)
        assert low <= np.abs(left).max() <= high


def test_errata_7_13_to_7_15_the_printed_forces_leave_a_moment():
    """(23) without sin phi at the weights and with BD cos(phi - alpha), R29 over cos(phi - alpha), leaves tens of N m; corrected, none."""
    _, found = cut("cam16")
    phi, r, slopes = found.phi, found.r, found.slopes
    far = r + 0.06
    length = np.sqrt(far**2 + 0.09 - 0.6 * far * np.sin(phi))
    pull, alpha = 1800 * length - 134, np.arctan2(slopes, r)
    psi = np.angle(0.30j - far * np.exp(1j * phi))
    weights = G * (2.72 + 0.1 * far + 0.8 * (r + 0.02) + 0.2 * r) * np.cos(phi)
    right = (G * 1.1 * np.sin(phi) - pull * np.cos(phi - psi)) / np.cos(alpha)
    assert right == pytest.approx(found.force, rel=1e-12)
    assert np.abs(pull * 0.30 * far * np.cos(phi) / length - right * r * np.sin(alpha) - weights).max() < 1e-11
    wrong = (G * 1.1 - pull * np.cos(phi - psi)) / np.cos(phi - alpha)
    assert np.abs(pull * 0.30 * far * np.cos(phi) / length - wrong * r * np.cos(phi - alpha) - weights).max() > 50
    short = G * (2.72 + 0.8 * (r + 0.02)) * np.cos(phi)  # without the weights of roller and spring that (23) leaves out
    assert np.abs(pull * 0.30 * far * np.cos(phi) / length - right * r * np.sin(alpha) - short).max() > 1
