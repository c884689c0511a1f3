"""Short forms of linkages: each stands for its long form, and its foot is where circles drawn by hand meet."""

import numpy as np
import pytest

from linkages.theory import angle, circles, direction
from walkgen.errors import SpecError
from walkgen.graph.interpret import interpret
from walkgen.pipeline import programs_of
from walkgen.spec.read import read

HEAD = """
walkgen = 1
robot = { name = "bars", gravity = [0, -9.81, 0] }
generate = { functions = ["foot_position"] }
platforms = [{ name = "body" }]
legs = [{ name = "one", design = "leg", platform = "body" }]
[leg_designs.leg]
"""
FOUR = "ground = 0.2, crank = 0.05, coupler = 0.25, rocker = 0.22"
ARMS = "second_coupler = 0.3, second_rocker = 0.28"
FOUR_POINTS = """
frame = {{ points = {{ A = [0, 0], D = [0.2, 0]{frame} }} }}
crank = {{ points = {{ A = [0, 0], B = [0.05, 0]{crank} }} }}
coupler = {{ points = {{ B = [0, 0], C = [0.25, 0]{coupler} }} }}
rocker = {{ points = {{ D = [0, 0], C = [0.22, 0]{rocker} }} }}
"""
SECOND_POINTS = """
second_coupler = { points = { E = [0, 0], F = [0.3, 0], P = [0.35, 0.02] } }
second_rocker = { points = { G = [0, 0], F = [0.28, 0] } }
"""
FOUR_PINS = """
pins = [
    { name = "crank", joins = ["frame.A", "crank.A"], driven = true },
    { joins = ["crank.B", "coupler.B"] }, { joins = ["frame.D", "rocker.D"] }, { joins = ["coupler.C", "rocker.C"] },
"""
E, G = np.array([0.1, 0.06]), np.array([0.13, 0.05])
"""Where the second loop hangs on its two links."""


def four(**added):
    points = dict.fromkeys(("frame", "crank", "coupler", "rocker"), "") | added
    return FOUR_PINS, "[leg_designs.leg.links]" + FOUR_POINTS.format(**points)


def six(first, second):
    pins, links = four(**{first: ", E = [0.1, 0.06]", second: ", G = [0.13, 0.05]"})
    hung = f'{{ joins = ["{first}.E", "second_coupler.E"] }}, {{ joins = ["{second}.G", "second_rocker.G"] }},'
    return 'foot = "second_coupler.P"' + pins + hung + '{ joins = ["second_coupler.F", "second_rocker.F"] }]\n' + links + SECOND_POINTS


def six_form(kind, inversion, first, second):
    points = f"on_{first} = [0.1, 0.06], on_{second.replace('frame', 'ground')} = [0.13, 0.05]"
    return f'{kind} = {{ inversion = "{inversion}", {FOUR}, {points}, {ARMS}, foot = [0.35, 0.02] }}'


SIX = {
    "watt I": ("watt", "I", "coupler", "rocker"),
    "watt I at the crank": ("watt", "I", "crank", "coupler"),
    "watt II": ("watt", "II", "rocker", "frame"),
    "watt II at the crank": ("watt", "II", "crank", "frame"),
    "stephenson I": ("stephenson", "I", "crank", "rocker"),
    "stephenson III": ("stephenson", "III", "coupler", "frame"),
}
STEPHENSON_2 = (
    f"""
stephenson = {{ inversion = "II", {FOUR}, on_crank = [0.03, 0.04], on_coupler = [0.1, 0.06], {ARMS}, foot = [0.35, 0.02] }}
""",
    """
foot = "coupler.P"
pins = [
    { name = "crank", joins = ["frame.A", "crank.A"], driven = true },
    { joins = ["frame.D", "rocker.D"] }, { joins = ["coupler.C", "rocker.C"] },
    { joins = ["crank.B", "second_coupler.B"] }, { joins = ["second_coupler.F", "coupler.F"] },
    { joins = ["crank.E", "second_rocker.E"] }, { joins = ["second_rocker.G", "coupler.G"] },
]
[leg_designs.leg.links]
frame = { points = { A = [0, 0], D = [0.2, 0] } }
crank = { points = { A = [0, 0], B = [0.05, 0], E = [0.03, 0.04] } }
coupler = { points = { F = [0, 0], C = [0.25, 0], G = [0.1, 0.06], P = [0.35, 0.02] } }
rocker = { points = { D = [0, 0], C = [0.22, 0] } }
second_coupler = { points = { B = [0, 0], F = [0.3, 0] } }
second_rocker = { points = { E = [0, 0], G = [0.28, 0] } }
""",
)
STEPHENSON_2_AT_THE_ROCKER = (
    f"""
stephenson = {{ inversion = "II", {FOUR}, on_coupler = [0.1, 0.06], on_rocker = [0.13, 0.05], {ARMS}, foot = [0.35, 0.02] }}
""",
    """
foot = "coupler.P"
pins = [
    { name = "crank", joins = ["frame.A", "crank.A"], driven = true },
    { joins = ["crank.B", "coupler.B"] }, { joins = ["frame.D", "rocker.D"] },
    { joins = ["coupler.C", "second_coupler.C"] }, { joins = ["second_coupler.F", "rocker.F"] },
    { joins = ["coupler.E", "second_rocker.E"] }, { joins = ["second_rocker.G", "rocker.G"] },
]
[leg_designs.leg.links]
frame = { points = { A = [0, 0], D = [0.2, 0] } }
crank = { points = { A = [0, 0], B = [0.05, 0] } }
coupler = { points = { B = [0, 0], C = [0.25, 0], E = [0.1, 0.06], P = [0.35, 0.02] } }
rocker = { points = { D = [0, 0], F = [0.22, 0], G = [0.13, 0.05] } }
second_coupler = { points = { C = [0, 0], F = [0.3, 0] } }
second_rocker = { points = { E = [0, 0], G = [0.28, 0] } }
""",
)
PAIRS = {
    "four_bar": (
        f"four_bar = {{ {FOUR}, foot = [0.125, 0.03] }}",
        'foot = "coupler.P"' + four()[0] + "]\n" + four(coupler=", P = [0.125, 0.03]")[1],
    ),
    "parallelogram": (
        "parallelogram = { ground = 0.2, crank = 0.1, foot = [0.3, -0.4], drive = { limits_deg = [20, 160], max_effort = 30 } }",
        """
foot = "coupler.P"
pins = [
    { name = "crank", joins = ["frame.A", "crank.A"], driven = true, limits_deg = [20, 160], max_effort = 30 },
    { joins = ["crank.B", "coupler.B"] }, { joins = ["frame.D", "rocker.D"] }, { joins = ["coupler.C", "rocker.C"] },
]
[leg_designs.leg.links]
frame = { points = { A = [0, 0], D = [0.2, 0] } }
crank = { points = { A = [0, 0], B = [0.1, 0] } }
coupler = { points = { B = [0, 0], C = [0.2, 0], P = [0.3, -0.4] } }
rocker = { points = { D = [0, 0], C = [0.1, 0] } }
""",
    ),
    "five_bar": (
        """
five_bar = { ground = 0.1, cranks = [0.12, 0.13], couplers = [0.2, 0.21], drives = [{ name = "left" }, { limits = [0, 1] }] }
assembly = { c = "right" }
[leg_designs.leg.links.coupler]
mass = 0.05
""",
        """
foot = "coupler.C"
assembly = { c = "right" }
pins = [
    { name = "left", joins = ["frame.A", "crank.A"], driven = true },
    { name = "second_crank", joins = ["frame.E", "second_crank.E"], driven = true, limits = [0, 1] },
    { joins = ["crank.B", "coupler.B"] }, { joins = ["second_crank.D", "second_coupler.D"] },
    { joins = ["coupler.C", "second_coupler.C"] },
]
[leg_designs.leg.links]
frame = { points = { A = [0, 0], E = [0.1, 0] } }
crank = { points = { A = [0, 0], B = [0.12, 0] } }
coupler = { points = { B = [0, 0], C = [0.2, 0] }, mass = 0.05 }
second_crank = { points = { E = [0, 0], D = [0.13, 0] } }
second_coupler = { points = { D = [0, 0], C = [0.21, 0] } }
""",
    ),
    **{name: (six_form(*form), six(*form[2:])) for name, form in SIX.items()},
    "stephenson II": (STEPHENSON_2[0], STEPHENSON_2[1]),
    "stephenson II at the rocker": (STEPHENSON_2_AT_THE_ROCKER[0], STEPHENSON_2_AT_THE_ROCKER[1]),
}


def written(folder, design):
    path = folder / "robot.toml"
    path.write_text(HEAD + design, encoding="utf-8")
    return path


def foot(folder, design, *q):
    (program,) = (program for program in programs_of(written(folder, design)) if program.signature.name == "foot_position")
    return np.array(interpret(program, {"q": list(q)})["p"][:2])


@pytest.mark.parametrize("name", PAIRS)
def test_a_short_form_is_its_long_form(tmp_path, name):
    short, whole = (read(written(tmp_path, design)) for design in PAIRS[name])
    assert short == whole


def loop(q):
    """A, B, C, D of the four-bar, assembled on the left."""
    b, d = 0.05 * direction(q), np.array([0.2, 0.0])
    return np.zeros(2), b, circles(b, 0.25, d, 0.22, 1), d


def at(start, end, point):
    """A point in the axes of the bar from start to end."""
    x, y = direction(angle(end - start))
    return start + np.array([x * point[0] - y * point[1], y * point[0] + x * point[1]])


@pytest.mark.parametrize("q", [-2.0, 0.4, 1.7])
def test_four_bar_foot(tmp_path, q):
    _, b, c, _ = loop(q)
    assert foot(tmp_path, PAIRS["four_bar"][0], q) == pytest.approx(at(b, c, (0.125, 0.03)), abs=1e-15)


def test_the_coupler_of_a_parallelogram_does_not_turn(tmp_path):
    for q, design in ((1.1, PAIRS["parallelogram"][0]), (-0.7, MIRRORED)):
        assert foot(tmp_path, design, q) == pytest.approx(0.1 * direction(q) + [0.3, -0.4], abs=1e-15)


MIRRORED = """
assembly = { c = "right" }
parallelogram = { ground = 0.2, crank = 0.1, foot = [0.3, -0.4], drive = { limits_deg = [-160, -20] } }
"""


def test_five_bar_foot(tmp_path):
    knees = 0.12 * direction(2.4), np.array([0.1, 0.0]) + 0.13 * direction(0.5)
    wanted = circles(knees[0], 0.2, knees[1], 0.21, -1)
    assert foot(tmp_path, PAIRS["five_bar"][0], 2.4, 0.5) == pytest.approx(wanted, abs=1e-15)


@pytest.mark.parametrize("name", SIX)
def test_six_bar_foot(tmp_path, name):
    a, b, c, d = loop(1.3)
    bars = {"crank": (a, b), "coupler": (b, c), "rocker": (d, c), "frame": (a, d)}
    e, g = (at(*bars[link], point) for link, point in zip(SIX[name][2:], (E, G), strict=True))
    f = circles(e, 0.3, g, 0.28, 1)
    assert foot(tmp_path, PAIRS[name][0], 1.3) == pytest.approx(at(e, f, (0.35, 0.02)), abs=1e-14)


CLOSED = f"four_bar = {{ {FOUR}, foot = [0, 0] }}"
ADDED = "[leg_designs.leg.links.coupler]\npoints = {{ {} = [0, 0] }}"
BAD = {
    "a misspelt key": ("four_bar = { grond = 0.2, crank = 0.05, coupler = 0.25, rocker = 0.22 }", "WG110", 'did you mean "ground"'),
    "a length of nothing": ("four_bar = { ground = 0.2, crank = 0, coupler = 0.25, rocker = 0.22, foot = [0, 0] }", "WG161", "crank"),
    "a missing length": ("four_bar = { ground = 0.2, crank = 0.05, coupler = 0.25, foot = [0, 0] }", "WG111", "rocker"),
    "three numbers": (f"four_bar = {{ {FOUR}, foot = [0, 0, 1] }}", "WG112", "foot = [x, y]"),
    "one crank": ("five_bar = { ground = 0.2, cranks = [0.1], couplers = [0.2, 0.2] }", "WG112", "[first, second]"),
    "an unknown parameter": (CLOSED.replace("0.2,", "'g',", 1), "WG141", "four_bar.ground"),
    "no foot": (f"four_bar = {{ {FOUR} }}", "WG111", "four_bar"),
    "two feet": (f'foot = "coupler.C"\nfour_bar = {{ {FOUR}, foot = [0, 0] }}', "WG190", "twice"),
    "no such link": (f'four_bar = {{ {FOUR}, foot = [0, 0], foot_link = "couplr" }}', "WG180", "coupler"),
    "a link without foot": ('five_bar = { ground = 0, cranks = [1, 1], couplers = [1, 1], foot_link = "crank" }', "WG190", "no foot"),
    "two forms": (f"{CLOSED}\nparallelogram = {{ ground = 1, crank = 1 }}", "WG190", "twice"),
    "bars that do not close": (f"four_bar = {{ {FOUR.replace('0.2,', '0.9,')}, foot = [0, 0] }}", "WG190", "ground = 0.9"),
    "a point that is there": (f"{CLOSED}\n{ADDED.format('C')}", "WG190", "coupler.C"),
    "a folding parallelogram": (PAIRS["parallelogram"][0].replace("[20,", "[-20,"), "WG190", "folds"),
    "a crossed parallelogram": (MIRRORED.replace('"right"', '"left"'), "WG190", 'c = "right"'),
    "points of another six-bar": (six_form("watt", "I", "coupler", "frame"), "WG190", "stephenson with inversion III"),
    "a second drive": (f"{CLOSED}\npins = [{{ joins = ['frame.D', 'rocker.C'], driven = true }}]", "WG183", "pins[0]"),
    "no name": (CLOSED.replace("foot", "drive = { name = 'a b' }, foot"), "WG130", "drive.name"),
    "no name of a pin": (f"{CLOSED}\npins = [{{ name = 'while', joins = ['frame.D', 'rocker.C'] }}]", "WG131", "pins[0].name"),
    "points of no stephenson II": (six_form("stephenson", "II", "crank", "rocker"), "WG190", "stephenson with inversion I"),
    "a start without triads": (f"{CLOSED}\nstart = {{ drives = [0] }}", "WG187", "sides"),
    "no such dyad": (f'{CLOSED}\nassembly = {{ d = "left" }}', "WG187", "assembly"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_a_bad_short_form_teaches(tmp_path, name):
    design, code, said = BAD[name]
    with pytest.raises(SpecError) as error:
        read(written(tmp_path, design))
    found = [problem for problem in error.value.problems if problem.code == code]
    assert found, error.value
    assert said in str(found[0])
    assert found[0].place.line > HEAD.count("\n")


def test_own_pins_are_told_where_they_stand(tmp_path):
    design = f"{CLOSED}\n[[leg_designs.leg.pins]]\njoins = ['frame.D', 'rockr.D']"
    with pytest.raises(SpecError, match=r"pins\[0\].joins") as error:
        read(written(tmp_path, design))
    assert error.value.problems[0].place.line == HEAD.count("\n") + 3
