"""Mistakes in [gait] tables: each with its code, place and cure, all of them at once; and what is no mistake."""

from fractions import Fraction
from pathlib import Path

import pytest

from walkgen.errors import SpecError
from walkgen.model.assemble import assemble
from walkgen.spec.read import read

SPECS = Path(__file__).parents[2] / "specs"
SIDES = 'left = ["lf", "lm", "lr"]\nright = ["rf", "rm", "rr"]\n'
WAVE = f'kind = "wave"\nperiod = 2.0\nduty_factor = 0.75\n{SIDES}'
TRIPOD = f'kind = "tripod"\nperiod = 2.0\n{SIDES}'
PHASES = "phase = { lf = 0, rf = 0.5, lm = 0.75, rm = 0.25, lr = 0.5, rr = 0 }\n"
FREE = f'kind = "free"\nperiod = 1\nduty_factor = 0.8\n{PHASES}'
FOLLOW = f'kind = "follow_the_leader"\nperiod = 1\nduty_factor = 0.8\n{SIDES}'
EVENTS = """kind = "events"
events = [{ at = 0, leg = "lf", does = "lift" }, { at = "pace", leg = "lf", does = "place" }, { at = 1, leg = "rm", does = "lift" }]
"""
LATE = EVENTS.replace("at = 0,", "at = 3,").replace('"pace"', "4").replace("at = 1,", "at = 5,")
LEGS = ("lf", "rf", "lm", "rm", "lr", "rr")


def text(gait: str, legs=LEGS) -> str:
    head = """walkgen = 1
[robot]
name = "rob"
gravity = [0, 0, -9.8]
[parameters]
pace = 0.5
loose = { value = 1.0, runtime = true }
[leg_designs.l]
dh = "classic"
joints = [{ name = "a", type = "revolute", a = 0.1, alpha_deg = 90, d = 0.0 }]
[[platforms]]
name = "body"
"""
    return head + "".join(f'[[legs]]\nname = "{leg}"\ndesign = "l"\nplatform = "body"\n' for leg in legs) + gait


def refused(tmp_path, gait: str, legs=LEGS):
    (tmp_path / "spec.toml").write_text(text(gait, legs), encoding="utf-8")
    with pytest.raises(SpecError) as error:
        read(tmp_path / "spec.toml")
    return error.value.problems


def gaits(tmp_path, gait: str, legs=LEGS):
    (tmp_path / "spec.toml").write_text(text(gait, legs), encoding="utf-8")
    return {made.name: made for made in assemble(read(tmp_path / "spec.toml")).gaits}


CASES = (
    ("period = 1", "WG111", "", "kind"),
    ('kind = "wave"\nperiod = 1', "WG111", "", '"left"'),
    (f'kind = "wave"\nperiod = 1\n{SIDES}', "WG111", "", '"duty_factor"'),
    (f'kind = "wave"\nduty_factor = 0.75\n{SIDES}', "WG111", "", '"period"'),
    ('kind = "free"\nperiod = 1\nduty_factor = 0.8', "WG111", "", '"phase"'),
    (f"{FOLLOW}stride = 0.2", "WG111", "", '"pitch"'),
    (f"{FOLLOW}pitch = 0.2", "WG111", "", '"stride"'),
    (f"{WAVE}stance = {{ lf = [0,0,0], rf = [0,0,0], lm = [0,0,0], rm = [0,0,0], lr = [0,0,0], rr = [0,0,0] }}", "WG111", "", '"lift"'),
    (f'{WAVE}body = "waved"', "WG111", "", '"margin"'),
    (f"{WAVE}margin = 0.1", "WG124", "margin", 'body = "waved"'),
    (f"{WAVE}{PHASES}", "WG124", "phase", "does not belong"),
    (f"{FREE}{SIDES}", "WG124", "left", "does not belong"),
    (f"{WAVE}pitch = 1", "WG124", "pitch", "does not belong"),
    (
        f"{TRIPOD}duty_factor = {{ lf = 0.5, rf = 0.5, lm = 0.5, rm = 0.5, lr = 0.5, rr = 0.5 }}",
        "WG124",
        "duty_factor",
        'kind = "free"',
    ),
    (f"{TRIPOD}strid = 1", "WG110", "", 'did you mean "stride"?'),
    (f"{TRIPOD}stride = 1\nstride_mm = 3", "WG122", "stride_mm", "same quantity"),
    ('kind = "gallop"\nperiod = 1', "WG116", "kind", "wave"),
    (TRIPOD.replace('"lm"', '"ln"'), "WG140", "left[1]", "known legs: lf, rf, lm, rm, lr, rr"),
    (FREE.replace("lm =", "l_m ="), "WG140", "phase.l_m", 'did you mean "lm"?'),
    (FREE.replace("lm = 0.75, ", ""), "WG195", "phase", "lm is not in the gait"),
    (TRIPOD.replace('"lm"', '"lf"'), "WG195", "left", "lf is in the gait more than once"),
    (TRIPOD.replace('"lm", ', ""), "WG195", "left", "3 legs on each side, not 2 on the left"),
    (WAVE.replace('"lm", ', ""), "WG195", "left", "as many legs on each side"),
    (f'kind = "trot"\nperiod = 1\n{SIDES}', "WG195", "left", "2 legs on each side"),
    (f"{WAVE}lift = 0.1\nstance = {{ lf = [0, 0, 0] }}", "WG195", "stance", "rf, lm, rm, lr, rr are not in the gait"),
    (f'{WAVE}lift = 0.1\nstance = "trippod"', "WG140", "stance", 'no gait "trippod" with a stance of its own'),
    (f"{WAVE}lift = 0.1\nstance = {{ lf = [0, 0] }}", "WG112", "stance.lf", "[x, y, z]"),
    (WAVE.replace("0.75", "75"), "WG196", "duty_factor", "0.75 if per cent were meant"),
    (WAVE.replace("0.75", "1.0"), "WG196", "duty_factor", "not between 0 and 1"),
    (FREE.replace("0.8", "{ lf = 0.8, rf = 0.8, lm = 0, rm = 0.8, lr = 0.8, rr = 0.8 }"), "WG196", "duty_factor.lm", "of 0 is not"),
    (
        WAVE.replace("0.75", "0.4"),
        "WG197",
        "duty_factor",
        "from 0.2 to 0.3 of the period (t = 0.4 s) only lf, rm support and lm, lr, rf, rr are",
    ),
    (TRIPOD + "duty_factor = 0.45", "WG197", "duty_factor", "no leg supports and lf, lm, lr, rf, rm, rr are in transfer"),
    (f"{FREE.replace('0.8', '0.4')}", "WG197", "duty_factor", "static = false"),
    (f"{FOLLOW}stride = 0.5\npitch = 0.3", "WG198", "stride", "the foot before is still there"),
    (f"{FOLLOW}stride = 0\npitch = 0.3", "WG198", "stride", "more than 0"),
    (f'{TRIPOD}stride = "loose"', "WG199", "stride", 'runtime parameter "loose"'),
    (f'{TRIPOD}stride = "pce"', "WG141", "stride", 'did you mean "pace"?'),
    (TRIPOD.replace("2.0", "0"), "WG161", "period", "more than 0"),
    (f"{TRIPOD}lift = -0.1", "WG161", "lift", "not be negative"),
    (TRIPOD.replace("2.0", "1e-200") + "stride = 1e200", "WG113", "stride", "speed"),
    (TRIPOD.replace("2.0", "inf"), "WG113", "period", "finite"),
    ('kind = "events"', "WG111", "", '"events"'),
    ('kind = "events"\nevents = []', "WG112", "events", "too few"),
    (f"{EVENTS}period = 1", "WG124", "period", "does not belong"),
    (f"{EVENTS}{SIDES}", "WG124", "left", "it has events, lifted"),
    (f"{EVENTS}duty_factor = 0.8", "WG124", "duty_factor", "does not belong"),
    (f'{EVENTS}body = "waved"', "WG111", "", '"margin"'),
    (f"{EVENTS}margin = 0.1", "WG124", "margin", 'body = "waved"'),
    (f'{EVENTS}lift = 0.1\nstance = "nowhere"', "WG140", "stance", 'no gait "nowhere" with a stance'),
    (f'{WAVE}lifted = ["lf"]', "WG124", "lifted", "does not belong"),
    (EVENTS.replace('"rm"', '"rn"'), "WG140", "events[2].leg", "known legs: lf, rf, lm"),
    (f'{EVENTS}lifted = ["rx"]', "WG140", "lifted[0]", "known legs"),
    (EVENTS.replace('"place"', '"put"'), "WG116", "events[1].does", "lift, place"),
    (EVENTS.replace("at = 1,", ""), "WG111", "events[2]", '"at"'),
    (EVENTS.replace("at = 1,", "when = 1,"), "WG110", "events[2]", '"when"'),
    (EVENTS.replace("at = 1,", "at = 0.25,"), "WG194", "events[2]", "the lift of rm at 0.25 s stands after 0.5 s"),
    (f'{EVENTS}lifted = ["lf"]', "WG194", "events[0]", "the lift of lf at 0 s: lf is in transfer already"),
    (EVENTS.replace('"lift" }]', '"place" }]'), "WG194", "events[2]", "rm is placed already"),
    (EVENTS.replace('"pace"', "0"), "WG194", "events[1]", "lf would be lifted and placed at one instant"),
    (f'{EVENTS}lifted = ["rf", "lm", "rr"]', "WG197", "events[0]", "from 0 s to 0.5 s only rm, lr support and lf, rf, lm, rr are in"),
    (f'{EVENTS}lifted = ["rf", "lm", "lr", "rr"]', "WG197", "events[0]", "only rm supports"),
    (f'{LATE}lifted = ["rf", "lm", "lr", "rr"]', "WG197", "events[0]", "from 3 s to 4 s only rm supports"),
    (f'{LATE}lifted = ["lf", "rf", "lm", "rm"]', "WG194", "events[0]", "lf is in transfer already"),
    (f'{LATE[: LATE.index(", { at = 4")]}]\nlifted = ["rf", "lm", "lr", "rr"]', "WG197", "events[0]", "from 3 s on only rm supports"),
    (
        f'{EVENTS.replace("lift", "none").replace("place", "lift").replace("none", "place")}lifted = ["lf", "rm", "rr", "lr"]',
        "WG197",
        "lifted",
        "before 0 s only rf, lm support",
    ),
    (f"{WAVE}heel_off = 1", "WG161", "heel_off", "share of the support"),
    (f"{EVENTS}heel_off = 0.5", "WG124", "heel_off", "does not belong"),
    (EVENTS.replace('"pace"', '"loose"'), "WG199", "events[1].at", 'runtime parameter "loose"'),
)
HEADED = tuple((head, *case) for case in CASES for head in ("gait", "gait.quick"))


@pytest.mark.parametrize(
    ("head", "keys", "code", "place", "says"), HEADED, ids=[f"{head}-{code}-{n}" for n, (head, _, code, *_) in enumerate(HEADED)]
)
def test_each_mistake_has_its_code_its_place_and_its_cure(tmp_path, head, keys: str, code: str, place: str, says: str) -> None:
    problems = refused(tmp_path, f"[{head}]\n{keys}")
    problem = next(problem for problem in problems if problem.code == code and says in f"{problem.message} {problem.cure}")
    assert problem.message.startswith(f"{head}{'.' if place else ''}{place}")
    assert problem.place is not None
    assert problem.place.line > 36
    assert problem.cure


def test_all_mistakes_at_once(tmp_path) -> None:
    keys = TRIPOD.replace('"lm"', '"ln"').replace("2.0", "-1") + "duty_factor = 2\nstrid = 3\n"
    problems = refused(tmp_path, f'[gait.one]\n{keys}[gait.quick]\nkind = "trott"\n[gait.slow]\nkind = "trot"\n')
    assert {problem.code for problem in problems} >= {"WG110", "WG111", "WG116", "WG140", "WG161", "WG196"}


def test_a_kind_that_there_is_not_has_no_consequences(tmp_path) -> None:
    (problem,) = refused(tmp_path, "[gait]\nperiod = 1\n")
    assert (problem.code, problem.message) == ("WG111", 'gait: missing key "kind"')
    problems = refused(tmp_path, f"[gait]\n{TRIPOD.replace('tripod', 'tripos')}")
    assert [problem.code for problem in problems] == ["WG116"]
    assert problems[0].cure == 'did you mean "tripod"?'


def test_names_that_gaits_take(tmp_path) -> None:
    legs = ("gait", *LEGS[1:])
    (problem,) = refused(tmp_path, f"[gait]\n{TRIPOD.replace('lf', 'gait')}", legs)
    assert (problem.code, problem.place.line) == ("WG133", 14)
    (problem,) = refused(tmp_path, f"[gait.Quick]\n{TRIPOD}")
    assert (problem.code, problem.message) == (
        "WG130",
        'gait.Quick: "Quick" is not a name: a letter a-z, then at most 30 of a-z, 0-9 and _',
    )


def test_gaits_are_exact_and_in_the_order_of_the_feet(tmp_path) -> None:
    found = gaits(
        tmp_path,
        f'[gait.one]\n{WAVE.replace("0.75", chr(34) + "2/3" + chr(34))}stride_mm = 250\n[gait.two]\n{FREE}period = "3*pace"'.replace(
            "period = 1\n", ""
        ),
    )
    third = Fraction(1, 3)
    assert found["one"].phase == (0, Fraction(1, 2), 2 * third, third / 2, third, 5 * third / 2)
    assert found["one"].stride == Fraction(1, 4)
    assert (found["two"].period, found["two"].duty_factor) == (Fraction(3, 2), (Fraction(4, 5),) * 6)
    assert found["two"].phase == (0, Fraction(1, 2), Fraction(3, 4), Fraction(1, 4), Fraction(1, 2), 0)


def test_a_stance_of_another_gait(tmp_path) -> None:
    table = "".join(f"{leg} = [{place}, 0.5, -0.3]\n" for place, leg in enumerate(LEGS))
    text = f'[gait.slow]\n{WAVE}lift = 0.1\nstance = "quick"\n[gait.quick]\n{TRIPOD}lift = 0.1\n[gait.quick.stance]\n{table}'
    found = gaits(tmp_path, text)
    assert found["slow"].stance == found["quick"].stance == tuple((place, Fraction(1, 2), Fraction(-3, 10)) for place in range(6))
    problems = refused(tmp_path, text.replace('"quick"', '"quik"'))
    assert [(problem.code, problem.cure) for problem in problems] == [("WG140", 'did you mean "quick"?')]
    (problem,) = refused(tmp_path, text.replace('"quick"', '"slow"'))  # not in a circle
    assert problem.code == "WG140"


def test_the_usual_duty_factors(tmp_path) -> None:
    four = ("lf", "rf", "lh", "rh")
    sides = 'period = 1\nleft = ["lf", "lh"]\nright = ["rf", "rh"]\n'
    found = gaits(tmp_path, "".join(f'[gait.{kind}]\nkind = "{kind}"\n{sides}' for kind in ("crawl", "trot", "overlapping")), four)
    assert [found[kind].duty_factor[0] for kind in ("crawl", "trot", "overlapping")] == [Fraction(3, 4), Fraction(1, 2), Fraction(3, 4)]
    assert [found[kind].static for kind in ("crawl", "trot", "overlapping")] == [True, False, True]
    assert found["crawl"].phase == (0, Fraction(1, 2), Fraction(3, 4), Fraction(1, 4))
    (only,) = gaits(tmp_path, f"[gait]\n{TRIPOD}static = false").values()
    assert (only.name, only.static) == ("", False)


def test_events_are_exact_and_know_who_is_lifted(tmp_path) -> None:
    (only,) = gaits(tmp_path, f'[gait]\n{EVENTS}lift_mm = 50\nlifted = ["rr"]').values()
    assert only.kind == "events"
    assert only.events == ((0, 0, "lift"), (Fraction(1, 2), 0, "place"), (1, 3, "lift"))
    assert (only.lifted, only.lift, only.static) == ((False, False, False, False, False, True), Fraction(1, 20), True)
    assert only.own(0) == (0, Fraction(1, 2))
    assert (only.stride, only.stance, only.body, only.margin) == (0, None, "level", None)
    both = gaits(tmp_path, f'[gait.first]\n{EVENTS}static = false\nlifted = ["rr", "lr", "lm", "rf"]\n[gait.then]\n{TRIPOD}')
    assert [made.kind for made in both.values()] == ["events", "tripod"]
    twice = EVENTS.replace("at = 1,", 'at = "pace",')  # one is placed as another one lifts
    assert gaits(tmp_path, f'[gait]\n{twice}lifted = ["lm", "lr"]')[""].events[2].at == Fraction(1, 2)


@pytest.mark.parametrize(("width", "static"), [("width = 0.14", True), ("", False)])
def test_a_sole_is_enough_for_a_static_gait(tmp_path, width, static) -> None:
    """The shipped biped's are; on edges without a width, two of them, it would fall to a side."""
    biped = (SPECS / "anthropomorphic_biped.toml").read_text(encoding="utf-8").replace("width = 0.14", width)
    (tmp_path / "spec.toml").write_text(biped, encoding="utf-8")
    if static:
        assert assemble(read(tmp_path / "spec.toml")).gaits[0].static
        return
    with pytest.raises(SpecError, match=r"WG197.*only left supports"):
        read(tmp_path / "spec.toml")


def test_a_flat_sole_is_enough_in_a_list_of_events(tmp_path) -> None:
    gait = """[gait]
kind = "events"
events = [{ at = 0, leg = "lf", does = "lift" }, { at = 1, leg = "lf", does = "place" }]
"""
    with pytest.raises(SpecError, match="only rf supports"):
        gaits(tmp_path, gait, ("lf", "rf"))
    soled = text(gait, ("lf", "rf")).replace('dh = "classic"\n', 'dh = "classic"\nsole = { length = 0.2, width = 0.1 }\n')
    (tmp_path / "spec.toml").write_text(soled, encoding="utf-8")
    assert assemble(read(tmp_path / "spec.toml")).gaits[0].static
