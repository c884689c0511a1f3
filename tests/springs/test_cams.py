"""Cams that balance a link: the theory's oracles, errata 7.9 to 7.15, energy and free bodies, what cannot be cut, files and command."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from defusedxml.ElementTree import fromstring
from scipy.integrate import solve_ivp
from typer.testing import CliRunner

from walkgen.cli import app
from walkgen.design.cam import profile, residual
from walkgen.design.cam_files import csv, svg
from walkgen.design.search import designed
from walkgen.errors import SpecError
from walkgen.model.cam_potential import CamError, OnFrame, OnLink, Pull, Weight
from walkgen.spec.read import read

SPECS = Path(__file__).parents[2] / "specs"
ORACLES = json.loads((Path(__file__).parent / "balancing_oracles.json").read_text(encoding="utf-8"))
G, R = 9.80665, 0.012
FIRST = OnLink(Weight(-G * 2.732), Pull(2500.0, -180.0), G, arm=0.12, reach=0.10, mass=1.3)
SECOND = OnFrame(Weight(-G * 2.72), Pull(1800.0, -134.0), G, anchor=0.30, reach=0.06, masses=(0.1, 0.8, 0.2), centre=0.02)
CASES = {"cam15": (FIRST, (-35, 55), 0.36, 1801), "cam16": (SECOND, (-35, 45), 0.14, 1601)}


def cut(name, points=None, radius=R):
    cam, span, start, usual = CASES[name]
    return cam, profile(cam, np.deg2rad(np.linspace(*span, points or usual)), start, radius)


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


# ---- what cannot be ---------------------------------------------------------------------------------------------------------------------


def test_an_undercut_is_refused_where_it_is_and_the_largest_roller_is_right():
    with pytest.raises(CamError) as caught:
        cut("cam15", radius=0.45)
    assert caught.value.kind == "undercut"
    largest = float(re.search(r"(\S+) m is the most", str(caught.value))[1])
    assert cut("cam15", radius=0.999 * largest)
    with pytest.raises(CamError):
        cut("cam15", radius=1.001 * largest)


def test_lost_contact_is_refused_where_it_is():
    """A weak spring: the follower's slope of the potential falls to nothing on the way."""
    weak = OnLink(Weight(-G * 2.732), Pull(60.0, -4.0), G, arm=0.12, reach=0.10, mass=0.2)
    with pytest.raises(CamError) as caught:
        profile(weak, np.deg2rad(np.linspace(-35, 55, 901)), 0.16, R)
    assert caught.value.kind == "contact"
    assert np.deg2rad(-35) <= caught.value.angle <= np.deg2rad(55)


def written(folder, text):
    path = folder / "spec.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("code", "old", "new", "says"),
    [
        ("WG222", "stiffness = 2500.0", "stiffness = 60.0", "pressed on the cam at hip = "),
        ("WG223", "roller = 0.012", "roller = 0.45", "at hip = "),
        ("WG218", "free_length = 0.10\ninitial_tension = 70.0", "free_length = 0.30\ninitial_tension = 570.0", "shorter than 0.3 m"),
    ],
)
def test_a_cam_that_cannot_be_is_refused_with_the_angle(tmp_path, code, old, new, says):
    text = (SPECS / "balanced_leg_cam1.toml").read_text(encoding="utf-8")
    assert old in text
    text = text.replace("follower = 1.0", "follower = 0.0") if code == "WG222" else text
    with pytest.raises(SpecError) as caught:
        designed(written(tmp_path, text.replace(old, new)))
    assert code in str(caught.value)
    assert says in str(caught.value)


BAD = {
    "no table": ("WG221", '"cam_on_link"', '"two_springs"', "remove the table cam"),
    "other cam's length": ("WG221", "arm = 0.12 ", "arm = 0.12\nanchor = 0.3 ", "remove anchor"),
    "missing": ("WG111", "arm = 0.12 ", "# ", "write arm"),
    "transfer": (
        "WG221",
        "support_deg = { hip = [-35, 55] }",
        "support_deg = { hip = [-35, 0] }\ntransfer_deg = { hip = [0, 5] }",
        "one load",
    ),
    "no range": ("WG211", "support_deg = { hip = [-35, 55] }\n", "", "one joint"),
    "roller": ("WG161", "roller = 0.012", "roller = 0.0", "more than 0"),
    "mass": ("WG161", "follower = 1.0", "follower = -1.0", "not be negative"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_is_said_where_it_is(tmp_path, name):
    code, old, new, says = BAD[name]
    text = (SPECS / "balanced_leg_cam1.toml").read_text(encoding="utf-8")
    assert old in text
    with pytest.raises(SpecError) as caught:
        read(written(tmp_path, text.replace(old, new, 1)))
    assert any(problem.code == code and says in str(problem) for problem in caught.value.problems), caught.value


def test_a_drive_that_moves_a_linkage_is_refused(tmp_path):
    text = (SPECS / "balanced_leg_total.toml").read_text(encoding="utf-8")
    text = text.replace("D = [0.40, 0.0]", "D = [0.42, 0.0]").replace('"total"', '"cam_on_link"')
    text = text.replace(
        "support_deg = { front = [-40, 20], rear = [-140, -90] }", "support_deg = { front = [-40, 20] }\nheld_deg = { rear = -110 }"
    )
    cam = "[balance.stance.cam]\nstart = 0.36\nroller = 0.01\narm = 0.1\nreach = 0.1\nstiffness = 2500.0\nfree_length = 0.1\n"
    with pytest.raises(SpecError, match="WG224"):
        designed(written(tmp_path, text.replace("[[platforms]]", f"{cam}\n[[platforms]]")))


# ---- files ------------------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["balanced_leg_cam1", "balanced_leg_cam2"])
def test_shipped_specs_are_the_theorys_examples(name):
    found = designed(SPECS / f"{name}.toml")
    own, start = CASES[{"balanced_leg_cam1": "cam15", "balanced_leg_cam2": "cam16"}[name]][::2]
    assert found.profile.r == pytest.approx(profile(own, found.profile.phi, start, R).r, rel=1e-12)
    assert found.after[0].largest < 1e-4
    assert found.before[0].largest == pytest.approx(G * 2.72, rel=1e-6)


def test_csv_gives_the_profile_back():
    _, found = cut("cam15", 91)
    head, *rows = csv(found).splitlines()
    table = np.array([[float(entry) for entry in row.split(",")] for row in rows])
    column = dict(zip(head.split(","), table.T, strict=True))
    assert np.deg2rad(column["angle_deg"]) == pytest.approx(found.phi, rel=1e-11, abs=1e-13)
    assert column["edge_x_mm"] / 1e3 == pytest.approx(found.contact[:, 0], rel=1e-11)
    assert column["force_n"] == pytest.approx(found.force, rel=1e-11)


def test_svg_holds_the_edge():
    _, found = cut("cam16", 91)
    space = "{http://www.w3.org/2000/svg}"
    paths = {path.get("id"): path.get("d") for path in fromstring(svg(found)).iter(f"{space}path")}
    edge = np.array([point.split() for point in paths["edge"][1:].split("L")], dtype=float)
    assert edge / 1e3 == pytest.approx(found.contact, abs=1e-8)


def test_dxf_holds_the_edge_and_is_always_the_same():
    ezdxf = pytest.importorskip("ezdxf")
    from io import StringIO

    from walkgen.design.cam_dxf import dxf

    _, found = cut("cam16", 91)
    text = dxf(found)
    assert text == dxf(found)
    (edge,) = ezdxf.read(StringIO(text)).modelspace().query("LWPOLYLINE[layer=='EDGE']")
    assert np.array([point[:2] for point in edge]) / 1e3 == pytest.approx(found.contact, abs=1e-12)


def test_the_command_writes_cams(tmp_path):
    spec = SPECS / "balanced_leg_cam2.toml"
    out, page = tmp_path / "cam.csv", tmp_path / "cam.html"
    answer = CliRunner().invoke(app, ["design", str(spec), "--cam", str(out), "--plot", str(page)])
    assert answer.exit_code == 0, answer.output
    assert "pressure angle at most 45.02 degrees" in answer.output
    assert len(out.read_text(encoding="utf-8").splitlines()) == 1802
    assert "<svg" in page.read_text(encoding="utf-8")
    refused = CliRunner().invoke(app, ["design", str(spec), "--cam", str(tmp_path / "cam.step")])
    assert refused.exit_code == 2


def test_springs_have_no_cam(tmp_path):
    spec, out = SPECS / "balanced_leg_two_springs.toml", tmp_path / "cam.csv"
    answer = CliRunner().invoke(app, ["design", str(spec), "--starts", "1", "--cam", str(out)])
    assert answer.exit_code == 2
    assert not out.exists()
