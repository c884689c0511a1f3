"""The search for springs: exact slopes, catalogue and boxes, the spec that comes out, what cannot be searched."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from two_springs import SPEC, TEXT, bounded, ranged, single, written
from typer.testing import CliRunner

from walkgen.cli import app
from walkgen.design.balance import Balance
from walkgen.design.masses import weighed
from walkgen.design.multistart import solved
from walkgen.design.problem import Constraint, Objective, Problem, Values, Variable
from walkgen.design.rewrite import rewritten
from walkgen.design.search import Wanted, designed
from walkgen.errors import SpecError, UnsupportedMechanism
from walkgen.spec.read import read


def test_exact_slopes(tmp_path):
    boxed = TEXT.replace("stretch = ", "boxes = { mount = [[-0.3, -0.3, -0.1], [0.3, 0.1, 0.1]] }\nstretch = ")
    problem = Balance(read(written(tmp_path, ranged(boxed, "[-50, -10]", "[30, 60]"))), "stance", tmp_path).problem
    generator, step = np.random.default_rng(3), 1e-6
    x = generator.uniform(problem.low, problem.high)
    for functions in (problem.residuals, problem.margins):
        found = functions(x)
        for number, unit in enumerate(np.eye(len(x))):
            slope = (functions(x + step * unit).values - functions(x - step * unit).values) / (2 * step)
            assert found.slopes[:, number] == pytest.approx(slope, abs=1e-6 * max(1.0, np.abs(slope).max()))


def test_springs_stay_in_their_boxes(tmp_path):
    box = "boxes = { mount = [[-0.3, -0.25, -0.1], [0.3, 0.0, 0.1]], hip = [[0.0, -0.01, -0.1], [0.15, 0.01, 0.1]] }\nstretch = "
    found = designed(written(tmp_path, TEXT.replace("stretch = ", box)), Wanted(starts=1))
    for spring in ("front", "rear"):
        lever, anchor, angle = (found.values[f"{spring}_{key}"] for key in ("lever", "anchor", "angle"))
        assert lever <= 0.15 + 1e-9
        assert abs(anchor * np.cos(angle)) <= 0.3 + 1e-9
        assert -0.25 - 1e-9 <= anchor * np.sin(angle) <= 1e-9


def test_a_catalogues_best_springs(tmp_path):
    """Every row is tried; stiffness and mass of the best one are written, and the soft one is not it."""
    text = single(TEXT).replace("[leg_designs.link]\n", "front_stiffness = 9000.0\nfront_mass = 0.3\n\n[leg_designs.link]\n", 1)
    text = text.replace("stiffness = 9000.0\nfree", 'stiffness = "front_stiffness"\nfree').replace(
        "at_second = 0.3", 'at_second = "front_mass"'
    )
    rows = "catalogue = [{ stiffness = 2000.0, mass = 0.1 }, { stiffness = 8000.0, mass = 0.4 }]\nstretch = "
    path = written(tmp_path, text.replace("stretch = ", rows, 1))
    found = designed(path, Wanted(starts=1))
    assert (found.values["front_stiffness"], found.values["front_mass"]) == (8000.0, 0.4)
    assert "front_stiffness = 8000.0" in rewritten(path, found.values)


# ---- the problem alone ------------------------------------------------------------------------------------------------------------


def test_the_least_of_many_valleys_within_bounds_and_constraints():
    """sin(5 x) + x^2 / 10 as a residual has many minima; x >= 0.5 y cuts the best one off."""

    def residuals(x):
        slopes = np.array([[5 * np.cos(5 * x[0]) + 0.2 * x[0], 0], [0, 1]])
        return Values(np.array([2 + np.sin(5 * x[0]) + 0.1 * x[0] ** 2, x[1] - 1]), slopes)

    def margins(x):
        return Values(np.array([x[0] - 0.5 * x[1]]), np.array([[1.0, -0.5]]))

    variables = (Variable("x", -3, 3, 2.5), Variable("y", 0, 2, 0))
    free = solved(Problem(variables, (Objective("all", residuals),)), 20)
    bound = solved(Problem(variables, (Objective("all", residuals),), (Constraint("right", margins),)), 20)
    x = np.linspace(-3, 3, 200001)
    least = x[np.argmin(2 + np.sin(5 * x) + 0.1 * x**2)]
    assert free.x == pytest.approx([least, 1], abs=1e-4)
    right = x[x >= 0.5]
    assert bound.x == pytest.approx([right[np.argmin(2 + np.sin(5 * right) + 0.1 * right**2)], 1], abs=1e-4)
    assert bound.feasible
    assert free.better(bound)


# ---- the command ----------------------------------------------------------------------------------------------------------------------


def test_the_command_writes_a_spec_that_builds(tmp_path, built):
    out, page = tmp_path / "balanced.toml", tmp_path / "left.html"
    call = ["design", str(SPEC), "--balance", "stance", "--starts", "1", "-o", str(out)]
    answer = CliRunner().invoke(app, [*call, "--plot", str(page)])
    assert answer.exit_code == 0, answer.output
    rms = float(re.search(r"support hip rms +\S+ N m +\S+ N m +(\S+) N m", answer.output)[1])
    assert "energy of a stride" in answer.output
    assert "plotly" in page.read_text(encoding="utf-8")
    text = out.read_text(encoding="utf-8")
    assert text.count("# ... what stretches it at all") == 1
    names = '[generate]\nfunctions = ["unbalance_moment"]\n'
    phi = np.deg2rad(np.linspace(-50, 40, 2001))
    made = built(text.replace("[parameters]", f"{names}[parameters]", 1))
    left = made.call("c", "leg", "unbalance_moment", phi[:, None], np.full(2001, 60.0))
    assert np.sqrt(np.trapezoid(left[:, 0] ** 2, phi) / np.ptp(phi)) == pytest.approx(rms, rel=1e-4)


def test_parameters_are_rewritten_wherever_they_stand(tmp_path):
    """Bare, in a line, in a table of their own, in text."""
    text = '[parameters]\na = 1 # one\nb = { unit = "m", value = 0.5, bounds = [0, 1] }\n\'c\' = "2*pi"\n'
    text += "[parameters.d]\nvalue = 3e-2\n[x]\na = 1\n"
    found = rewritten(written(tmp_path, text), {"a": 1.5, "b": 0.25, "c": -1e-9, "d": 4.0})
    wanted = text.replace("a = 1 #", "a = 1.5 #").replace("value = 0.5", "value = 0.25").replace('"2*pi"', "-1e-09").replace("3e-2", "4.0")
    assert found == wanted


BAD = {
    "leg": ("WG210", 'leg = "leg"', 'leg = "lge"', 'did you mean "leg"?'),
    "joint": ("WG210", "{ hip = [-50, 40] }", "{ hop = [-50, 40] }", 'did you mean "hip"?'),
    "unit": ("WG123", "support_deg", "support_mm", "turns"),
    "no range": ("WG211", "support_deg = { hip = [-50, 40] }\n", "", "one joint"),
    "one joint in total": ("WG211", '"two_springs"', '"total"', "two joints or more"),
    "two units for one joint": ("WG122", "support_deg", "support = { hip = [-0.5, 0.4] }\nsupport_deg", "gives the same quantity already"),
    "overlap": ("WG213", "stretch =", "transfer_deg = { hip = [20, 60] }\nstretch =", "overlap from 0.3491 to 0.6981"),
    "crossed": ("WG160", "stretch = [1.02, 1.9]", "stretch = [1.9, 1.02]", "crossed"),
    "crossed range": ("WG160", "[-50, 40] }", "[40, -50] }", "crossed"),
    "unknown parameter": ("WG141", "stretch =", 'vary = ["front_level"]\nstretch =', "front_lever"),
    "no bounds": ("WG214", "stretch =", 'vary = ["front_free"]\nstretch =', "bounds"),
    "catalogue": ("WG214", "stretch =", "catalogue = [{ stiff = 1.0 }]\nstretch =", "front_stiff"),
    "box": ("WG201", "stretch =", "boxes = { hop = [[0, 0, 0], [1, 1, 1]] }\nstretch =", "hip"),
    "load": ("WG161", "load = 60.0", "load = -1.0", "load"),
    "device": ("WG116", '"two_springs"', '"two_spring"', "two_springs"),
    "nodes": ("WG112", "stretch =", "nodes = 1\nstretch =", "nodes"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_is_said_where_it_is(tmp_path, name):
    code, old, new, says = BAD[name]
    text = re.sub(r"(front_free = .*), bounds = .*\}", r"\1 }", TEXT) if name == "no bounds" else TEXT
    assert old in text
    with pytest.raises(SpecError) as caught:
        read(written(tmp_path, text.replace(old, new, 1)))
    found = [problem for problem in caught.value.problems if problem.code == code]
    assert any(says in str(problem) for problem in found), caught.value
    assert all(problem.place.line > 1 for problem in found)


def test_no_springs_that_pull_are_refused_with_the_angle(tmp_path):
    text = bounded(TEXT, free=(0.28, 0.30), anchor=(0.10, 0.12), lever=(0.04, 0.05)).replace("limits_deg = [-50, 40]\n", "")
    text = re.sub(r"(_(free) = \{ value = )0.16", r"\g<1>0.29", re.sub(r"(_anchor = \{ value = )0.30", r"\g<1>0.11", text))
    path = written(tmp_path, re.sub(r"(_lever = \{ value = )0.12", r"\g<1>0.045", text))
    with pytest.raises(SpecError, match=r"WG218.*(front|rear) is .* m long at hip = \S+ rad, shorter than"):
        designed(path, Wanted(starts=1))


@pytest.mark.parametrize(
    ("call", "code"),
    [(["--balance", "stanse"], "WG215"), (["--plot", "left.svg"], "WG219"), (["--starts", "0"], "WG219")],
)
def test_the_command_refuses(call, code):
    answer = CliRunner().invoke(app, ["design", str(SPEC), *call])
    assert answer.exit_code == 2
    assert code in answer.output + answer.stderr


def test_a_spec_without_balance_is_refused():
    with pytest.raises(SpecError, match="WG215"):
        designed(SPEC.parent / "mero_leg.toml")


def test_ranges_in_radians_and_of_joints_of_both_kinds(tmp_path):
    """Radians, degrees and mm beside each other, each for joints of its own."""
    slide = '[[leg_designs.link.joints]]\nname = "slide"\ntype = "prismatic"\nxyz = [0, 0, 0]\naxis = [1, 0, 0]\nlimits = [0.0, 0.1]\n'
    text = TEXT.replace("[[leg_designs.link.springs]]", f"{slide}\n[[leg_designs.link.springs]]", 1).replace('"two_springs"', '"total"')
    own = "support = { hip = [-0.5, 0.4] }\nsupport_mm = { slide = [20, 60] }"
    found = read(written(tmp_path, text.replace("support_deg = { hip = [-50, 40] }", own))).balance["stance"].supported
    assert {name: [float(entry.value) for entry in span] for name, span in found.items()} == {"hip": [-0.5, 0.4], "slide": [0.02, 0.06]}


def test_a_leg_with_triads_is_not_searched(tmp_path):
    text = """
walkgen = 1
robot = { name = "triad", gravity = [0, -9.81, 0] }
parameters = { k = { value = 100.0, bounds = [50.0, 200.0] } }
platforms = [{ name = "body" }]
legs = [{ name = "one", design = "leg", platform = "body" }]
balance = { held = { device = "two_springs", leg = "one", load = 1.0, support = { one = [0.5, 0.6] } } }
[leg_designs.leg]
foot = "plate.A"
links = { frame = { points = { A = [0, 0], B = [1, 0], C = [0.5, 1] } }, plate = { points = { A = [0, 0], B = [0.2, 0], C = [0.1, 0.2] } } }
springs = [{ name = "s", between = ["frame.A", "plate.B"], stiffness = "k", free_length = 0.1 }]
cylinders = [
    { name = "one", between = ["frame.A", "plate.A"], driven = true },
    { name = "two", between = ["frame.B", "plate.B"], driven = true },
    { name = "three", between = ["frame.C", "plate.C"], driven = true },
]
"""
    with pytest.raises(UnsupportedMechanism, match=r"WG150.*triads"):
        designed(written(tmp_path, text))


def test_too_many_choices_are_refused(tmp_path):
    text = TEXT.replace("[leg_designs.link]\n", "front_k = 1.0\nrear_k = 1.0\n[leg_designs.link]\n", 1)
    rows = ", ".join(f"{{ k = {number}.0 }}" for number in range(20))
    with pytest.raises(SpecError, match=r"WG216.*400 choices"):
        designed(written(tmp_path, text.replace("stretch =", f"catalogue = [{rows}]\nstretch =", 1)))


MASSES = 'front_mass = 0.0\nrear_mass = { value = 0.0, unit = "kg" }\n\n[leg_designs.link]\n'


def weighed_text(text, per_mass):
    """A mass for each spring, half of it on the link; J/kg."""
    text = text.replace("[leg_designs.link]\n", MASSES, 1).replace("stretch =", f"energy_per_mass = {per_mass}\nstretch =")
    for spring in ("front", "rear"):
        text = text.replace(
            "masses = { at_second = 0.3 }", f'masses = {{ at_first = "{spring}_mass/2", at_second = "{spring}_mass/2" }}', 1
        )
    return text


def test_springs_weigh_what_their_energy_asks_for(tmp_path):
    """Masses and springs agree: those that were found store T^2 / (2 k) at their longest, and are the best ones at these masses."""
    path = written(tmp_path, weighed_text(TEXT, 60.0))
    found = designed(path, Wanted(starts=2))
    for spring, longest, free in zip(("front", "rear"), found.lengths[1], found.lengths[2], strict=True):
        pull = found.values[f"{spring}_tension"] + 9000 * (longest - free)
        assert found.values[f"{spring}_mass"] == pytest.approx(pull**2 / (2 * 9000 * 60.0), rel=1e-5)
        assert found.values[f"{spring}_mass"] > 0.5
    (after,) = found.after
    assert after.rms < 0.8
    (tmp_path / "again").mkdir()
    text = re.sub(r"energy_per_mass = .*\n", "", rewritten(path, found.values))
    (again,) = designed(written(tmp_path / "again", text), Wanted(starts=2)).after
    assert again.rms == pytest.approx(after.rms, rel=1e-3)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("front_mass = 0.0\n", "", "front_mass"),
        ("energy_per_mass = 60", "energy_per_mass = -60", "energy_per_mass"),
        ("stretch =", 'vary = ["rear_mass"]\nstretch =', "rear_mass"),
    ],
)
def test_masses_that_cannot_be_found(tmp_path, old, new, says):
    text = weighed_text(TEXT, 60.0)
    assert old in text
    with pytest.raises(SpecError, match=f"(?s)WG(214|161).*{says}"):
        read(written(tmp_path, text.replace(old, new, 1)))


def test_masses_that_never_settle_are_refused():
    """Springs that ask for other masses every time."""
    variables = (Variable("x", 0.0, 1.0, 0.5),)
    problem = Problem(variables, (Objective("all", lambda x: Values(x - 0.3, np.eye(1))),))
    turn = iter(range(100))
    swinging = SimpleNamespace(
        name="swing", table=SimpleNamespace(energy_per_mass=1.0), problem=problem, masses=lambda _: {"s_mass": 1.0 + next(turn) % 2}
    )
    with pytest.raises(SpecError, match=r"WG226.*swing.*do not settle"):
        weighed(lambda _: swinging, {}, 1, 0, lambda _: None)
