"""Cams from specs: what cannot be cut and is refused with the angle, files and command."""

import re
from pathlib import Path

import numpy as np
import pytest
from cammed import text_of
from cut_cams import CASES, G, R, cut
from defusedxml.ElementTree import fromstring
from two_springs import written
from typer.testing import CliRunner

from walkgen.cli import app
from walkgen.design.cam import profile
from walkgen.design.cam_files import csv, svg
from walkgen.design.search import designed
from walkgen.errors import SpecError
from walkgen.model.cam_potential import CamError, OnLink, Pull, Weight
from walkgen.pipeline import generate
from walkgen.spec.read import read

SPECS = Path(__file__).parents[2] / "specs"


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


PULL = "free_length = 0.08\ninitial_tension = 20.0"
REFUSED = {
    "contact": ("WG222", f"stiffness = 2000.0\n{PULL}", "stiffness = 5.0\nfree_length = 0.08", "at hip = "),
    "undercut": ("WG223", "roller = 0.012", "roller = 0.9", "at hip = "),
    "slack": ("WG218", PULL, "free_length = 0.40\ninitial_tension = 660.0", "at hip = "),
    "tilted": ("WG224", "mount = { xyz = [0.1, 0.2, -0.1] }", "mount = { rpy_deg = [20, 0, 0] }", "not level"),
    "no gravity": ("WG224", "gravity = [0.0, 0.0, -9.80665]", "gravity = [0.0, 0.0, 0.0]", "no gravity"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_cam_that_cannot_be_is_refused_before_code_is_written(tmp_path, name):
    """As `walkgen design` refuses it; with its place."""
    code, old, new, says = REFUSED[name]
    text = text_of("link").replace("follower = 0.9", "follower = 0.0") if name == "contact" else text_of("link")
    assert old in text
    path = written(tmp_path, text.replace(old, new))
    for refused in (lambda: generate(path), lambda: designed(path)):
        with pytest.raises(SpecError, match=f"(?s){code}.*{says}") as caught:
            refused()
    with pytest.raises(SpecError) as caught:
        generate(path)
    (problem,) = caught.value.problems
    assert problem.place.source.startswith("[balance.hold.cam]")


OTHER = """[balance.again]
device = "cam_on_link"
leg = "leg"
load = 0.0
support = { knee = [-0.5, 0.0] }
cam = { start = 0.3, arm = 0.1, reach = 0.1, roller = 0.01, stiffness = 1000, free_length = 0.05 }
[[platforms]]"""
SPRING = """[[leg_designs.arm.springs]]
name = "s"
between = [{ link = "mount", xyz = [0, 0, 0.1] }, { link = "hip", xyz = [0.1, 0, 0] }]
stiffness = 100.0
free_length = 0.01
[balance.hold]"""
UNSUITED = {
    "two cams": ("[[platforms]]", OTHER, "the balance hold already"),
    "springs beside it": ("[balance.hold]", SPRING, "remove the springs"),
    "sliding joint": ('name = "hip"\ntype = "revolute"', 'name = "hip"\ntype = "prismatic"', "balance one of yaw, knee"),
    "mirrored leg": ('leg = "leg"', 'leg = "other"', "name the leg that it mirrors"),
}


@pytest.mark.parametrize("name", UNSUITED)
def test_legs_that_no_cam_suits(tmp_path, name):
    old, new, says = UNSUITED[name]
    text = text_of("link") + '[[legs]]\nname = "other"\nmirror_of = "leg"\n'
    with pytest.raises(SpecError) as caught:
        read(written(tmp_path, text.replace(old, new, 1)))
    assert any(problem.code == "WG224" and says in str(problem) and problem.place.line > 1 for problem in caught.value.problems), (
        caught.value
    )


def test_show_lists_the_cam(tmp_path):
    answer = CliRunner().invoke(app, ["show", str(written(tmp_path, text_of("frame"))), "--stage", "mechanism"])
    assert "cam hold  on the frame, balances hip" in answer.output


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
