"""A good spec becomes exact numbers under SI names, and the shipped specs and templates are good."""

import math
from fractions import Fraction
from pathlib import Path

import pytest
from bad_specs import EXAMPLE

from walkgen.errors import WalkgenError
from walkgen.spec.evaluate import Numbers
from walkgen.spec.read import read
from walkgen.spec.scalar import ZERO, Apply, Exact, Name, Pi, exact, mul
from walkgen.spec.schema import RobotSpec
from walkgen.spec.templates import KINDS, template

SPECS = sorted((Path(__file__).parents[2] / "specs").glob("*.toml"))
DATA = Path(__file__).parent / "data"
QUARTER = mul(exact(Fraction(1, 2)), Pi())


def reread(folder: Path, text: str) -> RobotSpec:
    spec = folder / "robot.toml"
    spec.write_text(text, encoding="utf-8")
    return read(spec)


def test_the_example_keeps_its_numbers_exact() -> None:
    spec = read(DATA / "example_spec.toml")
    assert spec.robot.si("gravity") == (ZERO, ZERO, Exact(Fraction(-980665, 100000)))
    assert spec.leg_designs["mero_leg"].joints[1].si("a") == Name("thigh")
    assert spec.leg_designs["mero_leg"].joints[0].si("alpha") == QUARTER
    assert spec.parameters["thigh"].value == exact(Fraction(35, 100))
    assert (spec.parameters["shank"].runtime, spec.parameters["shank"].unit) == (True, "m")
    assert spec.platforms[1].end == "level"
    assert spec.legs[1].mirror_of == "front_left"
    assert spec.generate.functions == "all"


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_shipped_specs_are_valid(path: Path) -> None:
    assert read(path).robot.name == path.stem


@pytest.mark.parametrize("kind", KINDS)
def test_templates_are_valid_and_name_the_schema(kind: str, tmp_path: Path) -> None:
    text = template(kind)
    assert text.startswith("#:schema ./walkgen-spec-1.json\n")
    assert reread(tmp_path, text).legs


def test_an_unknown_template_names_the_nearest() -> None:
    with pytest.raises(WalkgenError, match=r'WG170.*\n.*did you mean "hexapod"'):
        template("hexpod")


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("alpha = 1.5707963267948966", QUARTER),
        ("alpha = 1.5707963267948976", QUARTER),
        ("alpha = 1.5707963267948986", Exact(Fraction("1.5707963267948986"))),
        ("alpha = 1.5708", Exact(Fraction("1.5708"))),
        ("alpha = -6.283185307179586", mul(exact(-2), Pi())),
        ("alpha = 1e-16", ZERO),
        ("alpha_deg = 90", QUARTER),
        ("alpha_deg = 0.1", mul(exact(Fraction(1, 1800)), Pi())),
        ('alpha = "pi/2"', Apply("div", (Pi(), exact(2)))),
    ],
)
def test_angles_next_to_a_twelfth_of_pi_are_exact(typed: str, expected: object, tmp_path: Path) -> None:
    spec = reread(tmp_path, EXAMPLE.replace("alpha_deg = 90", typed, 1))
    assert spec.leg_designs["mero_leg"].joints[0].si("alpha") == expected


def test_lengths_are_not_snapped_and_millimetres_are_metres(tmp_path: Path) -> None:
    text = EXAMPLE.replace("a = 0.0\nalpha_deg = 90\nd = 0.0", "a_mm = 350.5\nalpha_deg = 90\nd = 1.5707963267948966", 1)
    joint = reread(tmp_path, text).leg_designs["mero_leg"].joints[0]
    assert joint.si("a") == Exact(Fraction(3505, 10000))
    assert joint.si("d") == Exact(Fraction("1.5707963267948966"))


def test_limits_are_angles_only_where_the_joint_turns(tmp_path: Path) -> None:
    text = EXAMPLE.replace("limits_deg = [-60, 60]", "limits = [-1.5707963267948966, 1.5707963267948966]", 1)
    turning = reread(tmp_path, text)
    sliding = reread(tmp_path, text.replace('"revolute"', '"prismatic"', 1).replace("max_speed_deg", "max_speed", 1))
    assert turning.leg_designs["mero_leg"].joints[0].si("limits")[1] == QUARTER
    assert sliding.leg_designs["mero_leg"].joints[0].si("limits")[1] == Exact(Fraction("1.5707963267948966"))


def test_what_was_not_given_is_none() -> None:
    spec = read(DATA / "example_spec.toml")
    assert spec.legs[0].si("zeros") is None
    assert spec.leg_designs["mero_leg"].joints[1].si("theta") is None


def test_numbers_are_evaluated_at_the_parameters() -> None:
    numbers = Numbers({"thigh": exact(Fraction(1, 4))}, {"thigh": 0.25, "shank": 0.5}, {"thigh": 1, "shank": 1})
    product = mul(Name("thigh"), Name("shank"))
    assert numbers.number(product) == 0.125
    assert numbers.number(Name("unknown")) is None
    assert numbers.number(Apply("hypot", (exact(3), exact(4)))) == math.hypot(3, 4)


def test_names_may_be_keys_of_the_language(tmp_path: Path) -> None:
    names = ("domain", "value", "limits", "alpha", "name", "end", "parameters")
    rows = "\n".join(f"{name} = {index + 100}" for index, name in enumerate(names))
    spec = reread(tmp_path, EXAMPLE.replace("[parameters]", f"[parameters]\n{rows}", 1).replace('a = "shank"', 'a = "domain/alpha"', 1))
    assert list(spec.parameters)[: len(names)] == list(names)
