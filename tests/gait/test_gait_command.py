"""`walkgen gait` as a user meets it: files, exit codes, every problem at once, and a page that moves."""

import csv
import re
import shutil
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from walkgen.cli import app
from walkgen.walking import walked
from walkgen.walking_request import Wanted

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
_SLOW_PICTURES = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--window-size=300,300")


def run(*arguments):
    return CliRunner().invoke(app, ["gait", *(str(argument) for argument in arguments)])


def test_a_feasible_walk_as_a_table(duo, tmp_path):
    result = run(duo, "--gait", "waved", "--terrain", "flat", "--cycles", "1", "-o", tmp_path / "walk.csv")
    assert result.exit_code == 0, result.output
    assert "duo: 5 s" in result.output
    with (tmp_path / "walk.csv").open(encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    values = np.array(rows, dtype=float)
    assert len(rows) == 501
    column = dict(zip(names, values.T, strict=True))
    assert {
        "t (s)",
        "base_z (m)",
        "q_front_left_yaw (rad)",
        "qd_aft_pitch (rad/s)",
        "static_margin (m)",
        "power_friction (W)",
    } <= column.keys()
    assert column["static_margin (m)"].min() >= 0.04
    down = column["rear_left_stance (1)"] == 1
    assert np.abs(column["rear_left_foot_z (m)"][down]).max() < 1e-8


def test_the_course_goes_where_it_is_told(duo, tmp_path):
    result = run(
        duo, "--gait", "waved", "--terrain", "flat", "--cycles", "1", "--rate", "10", "--heading", "90", "-o", tmp_path / "walk.csv"
    )
    assert result.exit_code == 0, result.output
    with (tmp_path / "walk.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    way = [float(rows[-1][f"base_{axis} (m)"]) - float(rows[0][f"base_{axis} (m)"]) for axis in "xyz"]
    np.testing.assert_allclose(way, [0.0, 0.12, 0.0], atol=1e-8)


def test_a_list_of_events_is_walked_once(duo, tmp_path):
    result = run(duo, "--gait", "steps", "--terrain", "flat", "--body", "waved", "--margin", "0.04", "-o", tmp_path / "walk.csv")
    assert result.exit_code == 0, result.output
    assert "duo: 6 s, 9 footholds" in result.output


def test_friction_is_the_grounds_or_as_told(duo):
    arguments = (duo, "--gait", "waved", "--terrain", "slope:12", "--cycles", "1", "--rate", "20")
    assert run(*arguments).exit_code == 0
    result = run(*arguments, "--mu", "0.2")
    assert result.exit_code == 1
    assert "friction cannot carry the load" in result.output


def test_an_infeasible_walk_is_written_and_says_why(duo, tmp_path):
    result = run(duo, "--gait", "crawl", "--terrain", "slope:12", "--cycles", "1", "-o", tmp_path / "walk.csv")
    assert result.exit_code == 1
    assert "the stability margin is short by" in result.output
    assert (tmp_path / "walk.csv").exists()


@pytest.mark.parametrize(
    ("arguments", "codes"),
    [
        (("--gait", "crawler"), {"WG611": 'did you mean "crawl"?'}),
        (("--gait", "when"), {"WG612": "stance ="}),
        (("--gait", "trot", "--body", "waved"), {"WG614": "in transfer together"}),
        (("--gait", "far"), {"WG616": "rear_right: the rear end of its stroke, "}),
        (("--gait", "hanging"), {"WG621": "front_left: in transfer at the end"}),
        (("--heading", "nan", "--mu", "-1", "--give", "-0.1"), {"WG622": "--mu -1"}),
        (("--terrain", "slope:steep"), {"WG613": "slope:15"}),
        (("--terrain", "slope:89"), {"WG613": "up to 80"}),
        (("--terrain", "__import__('os')"), {"WG613": "is not allowed"}),
        (("--terrain", "x + w"), {"WG613": '"w" is not known'}),
        (("--terrain", "map:nowhere.txt:0.1"), {"WG613": "No such file"}),
        (("--terrain", "map:heights.txt"), {"WG613": "map:FILE:SPACING"}),
        (("--terrain", "map:heights.txt:-0.1"), {"WG613": "is no height map"}),
        (("--terrain", "map:heights.txt:0.1:0"), {"WG613": "the place of the first number"}),
        (("--terrain", "1/(x-x)"), {"WG617": "there is no ground"}),
        (("--terrain", "sqrt(-1-x*x)"), {"WG617": "rear_left"}),
        (("--gait", "nothing", "--terrain", "z", "--cycles", "0"), {"WG611": "known gaits", "WG613": '"z"', "WG615": "0 cycles"}),
        (("-o", "walk.pdf"), {"WG618": ".html or .csv"}),
    ],
)
def test_what_a_user_can_mend(duo, arguments, codes):
    result = run(duo, *arguments)
    assert result.exit_code == 2
    for code, words in codes.items():
        assert code in result.stderr
        assert words in result.stderr


def test_a_height_map_with_holes(duo, tmp_path):
    (tmp_path / "holes.csv").write_text("0, 0, 0\n0, , 0\n0, 0, 0\n", encoding="utf-8")
    result = run(duo, "--terrain", f"map:{tmp_path / 'holes.csv'}:0.5")
    assert result.exit_code == 2
    assert "WG613" in result.stderr
    assert "line 2 has an empty place" in result.stderr


def test_a_walk_over_a_height_map(duo, tmp_path):
    """Of a plane that rises by 0.1 along x: bicubic maps meet it exactly. One that ends under the robot has no ground there."""
    x = -2.0 + 0.25 * np.arange(17)
    (tmp_path / "ramp.txt").write_text("\n".join([" ".join(f"{0.1 * at:.6f}" for at in x)] * 9), encoding="utf-8")
    walk = walked(duo, Wanted(gait="waved", terrain=f"map:{tmp_path / 'ramp.txt'}:0.25", cycles=1, rate=20.0)).walk
    assert walk.feasible
    place = walk.holds.point
    np.testing.assert_allclose(place[:, 2], 0.1 * place[:, 0], atol=1e-12)
    np.testing.assert_allclose(walk.base_pose[:, 2, 0], np.sin(np.arctan(0.1)), atol=1e-12)
    result = run(duo, "--gait", "waved", "--terrain", f"map:{tmp_path / 'ramp.txt'}:0.25:0:-1")
    assert result.exit_code == 2
    assert "WG617" in result.stderr
    assert "rear_left: there is no ground at x = -0.6" in result.stderr


def test_a_spec_without_a_gait(tmp_path):
    spec = tmp_path / "hop.toml"
    legs = 'platforms = [{ name = "b" }]\nlegs = [{ name = "l", design = "d", platform = "b" }]\n'
    design = '[leg_designs.d]\ndh = "classic"\njoints = [{ name = "a", type = "revolute", a = 0.1, alpha_deg = 0, d = 0 }]\n'
    spec.write_text(f'walkgen = 1\nrobot = {{ name = "hop", gravity = [0, 0, -9.8] }}\n{legs}{design}', encoding="utf-8")
    result = run(spec)
    assert result.exit_code == 2
    assert "WG610" in result.stderr


def test_a_body_that_balances_no_mass(duo, monkeypatch):
    from walkgen import walking

    monkeypatch.setattr(walking, "_robot", lambda *_: SimpleNamespace(terrain=None))
    result = run(duo, "--gait", "waved")
    assert result.exit_code == 2
    assert "WG620" in result.stderr


def test_a_missing_library_says_what_to_install(duo, tmp_path, monkeypatch):
    from walkgen import walking

    def absent(_):
        raise ModuleNotFoundError("no", name="plotly")

    monkeypatch.setattr(walking, "import_module", absent)
    result = run(duo, "--gait", "waved", "--cycles", "1", "-o", tmp_path / "walk.html")
    assert result.exit_code == 2
    assert "WG619" in result.stderr
    assert "walkgen[gait]" in result.stderr


def test_a_still_picture(duo, tmp_path):
    pytest.importorskip("matplotlib", reason="the picture needs walkgen[gait]")
    result = run(duo, "--gait", "waved", "--terrain", "flat", "--cycles", "1", "--png", tmp_path / "walk.png")
    assert result.exit_code == 0, result.output
    content = (tmp_path / "walk.png").read_bytes()
    assert content.startswith(b"\x89PNG")
    assert len(content) > 20_000


@pytest.fixture(scope="module")
def page(duo, tmp_path_factory):
    pytest.importorskip("plotly", reason="the page needs walkgen[gait]")
    path = tmp_path_factory.mktemp("page") / "walk.html"
    result = run(duo, "--gait", "swinging", "--terrain", "flat", "--cycles", "1", "--rate", "3", "-o", path)
    assert result.exit_code == 0, result.output
    return path


def test_the_page_needs_nothing_from_elsewhere(page):
    text = page.read_text(encoding="utf-8")
    assert not re.findall(r"<(?:script|link)[^>]*(?:src|href)=\"?https?:", text)
    assert "Feasible." in text


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_the_page_moves_without_an_error(page):
    command = [CHROMIUM, "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", *_SLOW_PICTURES, "--enable-logging=stderr"]
    shown = subprocess.run(
        [*command, "--virtual-time-budget=1000", "--dump-dom", page.as_uri()], capture_output=True, text=True, timeout=500, check=True
    )
    spoken = [line for line in shown.stderr.splitlines() if "CONSOLE" in line and "willReadFrequently" not in line]
    assert not spoken
    instant = re.search(r'<html[^>]*data-instant="([^"]*)"', shown.stdout)
    assert instant, "no frame was shown"
    assert float(instant[1]) > 0.0
