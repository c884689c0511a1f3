"""Mistakes in [[terrain]] tables: each with its code, place and cure, all of them at once."""

import pytest

from walkgen.errors import SpecError
from walkgen.spec.read import read

HEAD = """walkgen = 1
[robot]
name = "rob"
gravity = [0, 0, -9.8]
[parameters]
amplitude = 0.1
{parameters}
[leg_designs.l]
dh = "classic"
joints = [{ name = "a", type = "revolute", a = 0.1, alpha_deg = 90, d = 0.0 }]
[[platforms]]
name = "body"
[[legs]]
name = "{leg}"
design = "l"
platform = "body"
[[terrain]]
name = "ground"
{keys}
"""
EXPLICIT = 'surface = "explicit"\nheight = "{}"'
CASES = (
    (EXPLICIT.format("amplitud*x"), "WG141", "height", 'did you mean "amplitude"?'),
    (EXPLICIT.format("x + z"), "WG141", "height", "x, y"),
    (EXPLICIT.format("exp(x)"), "WG114", "height", "arithmetic"),
    (EXPLICIT.format("__import__('os')"), "WG114", "height", "arithmetic"),
    (EXPLICIT.format("x.real"), "WG114", "height", "arithmetic"),
    (EXPLICIT.format("x/0"), "WG114", "height", "division by zero"),
    (EXPLICIT.format("x/(amplitude - 0.1)"), "WG164", "height", "no value anywhere"),
    (EXPLICIT.format("sqrt(-1 - x**2)"), "WG164", "height", "no value anywhere"),
    (EXPLICIT.format("sqrt(x - 5)") + "\ndomain = { x = [0, 4] }", "WG164", "height", "no value anywhere"),
    ('surface = "explicit"', "WG111", "", "height"),
    ('surface = "implicit"', "WG111", "", '"f"'),
    ('surface = "implicit"\nf = "x + u"', "WG141", "f", '"u"'),
    ('surface = "parametric"\nx = "u"\ny = "v"\ndomain = { u = [0, 1], v = [0, 1] }', "WG111", "", '"z"'),
    ('surface = "parametric"\nx = "u"\ny = "v"\nz = "x"\ndomain = { u = [0, 1], v = [0, 1] }', "WG141", "z", '"x"'),
    ('surface = "parametric"\nx = "u"\ny = "v"\nz = 0\ndomain = { u = [0, 1] }', "WG111", "domain", '"v"'),
    ('surface = "plane"\npoint = [0, 0, 0]', "WG111", "", "normal"),
    ('surface = "plane"\nnormal = [0, 0, 1]', "WG111", "", "point"),
    ('surface = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 0]', "WG166", "normal", "no direction"),
    ('surface = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\nheight = 1', "WG124", "height", "does not belong"),
    ('surface = "heightmap"\nspacing = 0.1', "WG111", "", "file"),
    ('surface = "heightmap"\nfile = "nowhere.txt"', "WG111", "", "spacing"),
    ('surface = "heightmap"\nfile = "../up.txt"\nspacing = 0.1', "WG134", "file", "leaves the spec's folder"),
    (EXPLICIT.format("x") + '\ninterpolation = "bicubic"', "WG124", "interpolation", "does not belong"),
    (EXPLICIT.format("x") + '\ninterpolation = "cubic"', "WG116", "interpolation", "bicubic"),
    (EXPLICIT.format("x") + "\ndomain = { u = [0, 1] }", "WG124", "domain.u", "does not belong"),
    (EXPLICIT.format("x") + "\ndomain = { x = [2, 1] }", "WG160", "domain.x", "crossed"),
    (EXPLICIT.format("x") + "\ndomain = { x = [1, 1] }", "WG160", "domain.x", "empty"),
    (EXPLICIT.format("x") + "\ndomain = { x = [1, inf] }", "WG113", "domain.x", "finite"),
    (EXPLICIT.format("x") + "\nmu = -0.1", "WG161", "mu", "negative"),
    (EXPLICIT.format("x") + "\nkn = 0", "WG161", "kn", "more than 0"),
    (EXPLICIT.format("x") + "\nkt = -1", "WG161", "kt", "more than 0"),
    (EXPLICIT.format("x") + "\nmu = nan", "WG113", "mu", "finite"),
    (EXPLICIT.format("x") + '\nmu = "x"', "WG141", "mu", '"x"'),
    (EXPLICIT.format("x") + "\nheigth = 1", "WG110", "", 'did you mean "height"?'),
    ('surface = "spline"', "WG116", "surface", "one of"),
)


def refused(tmp_path, keys: str, leg: str = "leg", parameters: str = ""):
    text = HEAD.replace("{keys}", keys).replace("{leg}", leg).replace("{parameters}", parameters)
    (tmp_path / "spec.toml").write_text(text, encoding="utf-8")
    with pytest.raises(SpecError) as error:
        read(tmp_path / "spec.toml")
    return error.value.problems


@pytest.mark.parametrize(("keys", "code", "place", "says"), CASES, ids=[f"{case[1]}-{index}" for index, case in enumerate(CASES)])
def test_each_mistake_has_its_code_its_place_and_its_cure(tmp_path, keys: str, code: str, place: str, says: str) -> None:
    problem = next(problem for problem in refused(tmp_path, keys) if problem.code == code)
    assert problem.message.startswith(f"terrain[0]{'.' if place else ''}{place}")
    assert says in f"{problem.message} {problem.cure}"
    assert problem.place is not None
    assert problem.place.line > 16
    assert problem.cure


def test_all_mistakes_at_once(tmp_path) -> None:
    keys = EXPLICIT.format("q*x") + "\nmu = -1\nkn = 0\nkt = 0\ndomain = { x = [1, 1], y = [3, 2] }\n[[terrain]]\n"
    problems = refused(tmp_path, keys + 'name = "ground"\nsurface = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 0]')
    assert sorted(problem.code for problem in problems) == ["WG132", "WG141", "WG160", "WG160", "WG161", "WG161", "WG161", "WG166"]


def test_names_that_the_ground_takes(tmp_path) -> None:
    (problem,) = refused(tmp_path, EXPLICIT.format("x"), leg="terrain")
    assert problem.code == "WG133"
    (problem,) = refused(tmp_path, EXPLICIT.format("x"), parameters="x = 3")
    assert (problem.code, problem.message) == ("WG135", 'parameters.x: "x" is a coordinate in the expressions of the terrain')
