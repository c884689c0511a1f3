"""Cams whose measures are searched for: smaller pressure angles and forces within bounds, what cannot be, and the spec that comes out."""

import re

import numpy as np
import pytest
from cammed import text_of
from two_springs import written
from typer.testing import CliRunner

from symbolic.dynamic_legs import SPECS, leg_programs, value
from walkgen.cli import app
from walkgen.design.balance import Balance
from walkgen.design.cam_problem import CamProblem
from walkgen.design.search import Wanted, designed
from walkgen.errors import SpecError
from walkgen.spec.read import read

VARIED = {"start": (0.14, 0.08, 0.35), "anchor": (0.30, 0.10, 0.40), "reach": (0.06, 0.0, 0.20), "stiffness": (1800.0, 300.0, 6000.0)}


def varied(text, more=""):
    """The shipped cam on the frame with measures that may vary."""
    table = "".join(f"own_{key} = {{ value = {value}, bounds = [{low}, {high}] }}\n" for key, (value, low, high) in VARIED.items())
    for key in VARIED:
        text, count = re.subn(rf"^{key} = [\d.]+", f'{key} = "own_{key}"', text, flags=re.MULTILINE)
        assert count == 1
    return text.replace("[leg_designs.link]\n", f"[parameters]\n{table}\n[leg_designs.link]\n", 1).replace(
        "points = ", f"{more}\npoints = "
    )


TEXT = (
    (SPECS / "balanced_leg_cam2.toml").read_text(encoding="utf-8").replace("initial_tension = 82.0", "initial_tension = 82.0\npoints = 401")
)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return designed(written(tmp_path_factory.mktemp("varied"), varied(TEXT, "most_pressure_deg = 30")), Wanted(starts=2))


def test_a_steep_cam_becomes_a_flat_one(found):
    """45 degrees of pressure angle and 560 to 660 N become less than the most that is allowed and less force, still in balance."""
    assert np.rad2deg(np.abs(found.given.pressure).max()) == pytest.approx(45, abs=0.05)
    assert np.rad2deg(np.abs(found.profile.pressure).max()) < 30
    assert np.square(found.profile.force).mean() < np.square(found.given.force).mean()
    assert found.after[0].largest < 1e-4 * found.before[0].largest  # cut through 401 points
    for key, (_, low, high) in VARIED.items():
        assert low <= found.values[f"own_{key}"] <= high
    assert found.profile.lengths.min() >= 0.12


def test_exact_enough_slopes(tmp_path):
    problem = CamProblem(Balance(read(written(tmp_path, varied(TEXT, "most_pressure_deg = 50"))), "transfer", tmp_path)).problem
    x, span = problem.start, problem.high - problem.low
    for functions in (problem.residuals, problem.margins):
        slopes = functions(x).slopes
        for number, unit in enumerate(np.eye(len(x))):
            step = 1e-4 * span[number]
            wanted = (functions(x + step * unit).values - functions(x - step * unit).values) / (2 * step)
            assert slopes[:, number] == pytest.approx(wanted, abs=1e-4 * max(np.abs(wanted).max(), 1e-3 / span[number]))


def test_measures_of_the_leg_may_vary_too(tmp_path):
    """A lighter load needs another cam at each of its values: the weight is that of the variables."""
    text = text_of("link").replace("mass = 3.0, com = [0.2,", 'mass = 3.0, com = ["own_com",')
    text = text.replace("[leg_designs.arm]\n", "[parameters]\nown_com = { value = 0.2, bounds = [0.1, 0.3] }\n[leg_designs.arm]\n", 1)
    path = written(tmp_path, text)
    found = designed(path, Wanted(starts=1))
    (tmp_path / "again").mkdir()
    again = designed(written(tmp_path / "again", re.sub(r"own_com = .*", f"own_com = {found.values['own_com']!r}", text)))
    assert again.profile.r == pytest.approx(found.profile.r, rel=1e-12)


def test_the_command_writes_a_spec_whose_leg_is_balanced(tmp_path):
    path, out = written(tmp_path, varied(TEXT, "most_pressure_deg = 40")), tmp_path / "out.toml"
    answer = CliRunner().invoke(app, ["design", str(path), "--starts", "1", "-o", str(out)])
    assert answer.exit_code == 0, answer.output
    assert "cam of the spec:" in answer.output
    assert float(re.findall(r"pressure angle at most (\S+) degrees", answer.output)[1]) < 40
    program = leg_programs(out, names=("unbalance_moment",))["unbalance_moment"]
    left = [value(program, np.array([phi]), 0.0)[0] for phi in np.deg2rad(np.linspace(-35, 45, 17))]
    assert np.abs(left).max() < 1e-11


def test_what_no_cam_within_the_bounds_can_do_is_said_with_the_angle(tmp_path):
    text = varied(TEXT, "most_pressure_deg = 1").replace("[0.1, 0.4]", "[0.29, 0.31]")
    with pytest.raises(SpecError, match=r"WG227.*transfer.*(is too steep|fails).* at hip = \S+ rad"):
        designed(written(tmp_path, text), Wanted(starts=1))
