"""Both active pairs of a leg balanced: reactions and moments beside the theory's oracles, errata 7.6 to 7.8, the search."""

import json
from pathlib import Path

import numpy as np
import pytest
from two_links import SLACK, pantograph, text_of

from walkgen.design.balance import Balance
from walkgen.design.blocks import blocks_of
from walkgen.design.chapter import zero_free_length
from walkgen.design.search import Wanted, designed
from walkgen.errors import SpecError
from walkgen.spec.read import read

ORACLES = json.loads((Path(__file__).parent / "balancing_oracles.json").read_text(encoding="utf-8"))
SPEC = Path(__file__).parents[2] / "specs" / "balanced_leg_total.toml"
WEIGHT, REL, LOAD, STILL = 9.80665, 1e-11, 60.0, np.zeros(2)
M4, M6 = 3.0, 1.5
GENERAL = ORACLES["fig14_general"]
POINTS = {key: complex(*GENERAL[key]) for key in "CEDP"}
Q = np.array([-0.3, -1.9])
ALL = ("c", "numpy", "casadi")
ROWS = ("front on frame", "front on link3", "rear on frame", "rear on link5", "c on link3", "c on link4", "e on link5", "e on link6")


@pytest.fixture
def general(built):
    return built(text_of(**POINTS, G4=0.33 - 0.3j, G6=0.14 - 0.27j, targets=ALL))


@pytest.fixture
def parallel(built):
    return built(pantograph(targets=ALL))


def reactions(made, q=Q, backend="numpy"):
    """R34 and R56 under the load, as complex numbers."""
    push = np.array([0.0, LOAD * WEIGHT, 0.0])
    found = made.call(backend, "leg", "joint_reactions", *(np.array([row]) for row in (q, STILL, STILL, push)))[0]
    return tuple(complex(*found[ROWS.index(row)][:2]) for row in ("c on link4", "e on link6"))


def unbalance(made, q, backend="numpy"):
    return made.call(backend, "leg", "unbalance_moment", np.atleast_2d(q), np.full(len(np.atleast_2d(q)), LOAD))


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
@pytest.mark.parametrize("name", ["parallel", "general"])
def test_reactions(request, name, backend):
    made, oracle = request.getfixturevalue(name), ORACLES[{"parallel": "fig14_parallelogram", "general": "fig14_general"}[name]]
    assert reactions(made, backend=backend) == pytest.approx((complex(*oracle["R34"]), complex(*oracle["R56"])), rel=REL)


def freed(phi3, phi5, points):
    """R34 and R56 from six equations: links 4 and 6 in balance, each by itself, the load up at P; points as at Q, links turned about B."""
    C, E = abs(points["C"]) * np.exp(1j * phi3), abs(points["E"]) * np.exp(1j * phi5)
    CD, ED = abs(points["D"] - points["C"]), abs(points["D"] - points["E"])
    gap = E - C
    along = (CD**2 - ED**2 + abs(gap) ** 2) / (2 * abs(gap))
    side = np.sign(((points["E"] - points["C"]).conjugate() * (points["D"] - points["C"])).imag)
    D = C + gap / abs(gap) * (along + 1j * side * np.sqrt(CD**2 - along**2))
    turned4, turned6 = (D - C) / (points["D"] - points["C"]), (D - E) / (points["D"] - points["E"])
    P, G4, G6 = (
        C + (points["P"] - points["C"]) * turned4,
        C + (points["G4"] - points["C"]) * turned4,
        E + (points["G6"] - points["E"]) * turned6,
    )

    def moment(at):
        return [-at.imag, at.real]

    system, known = np.zeros((6, 6)), np.zeros(6)  # unknowns: R34, R56, and the force of 4 on 6 at D
    system[[0, 1], [0, 1]], system[[0, 1], [4, 5]], system[2] = 1, -1, [*moment(C), 0, 0, *np.negative(moment(D))]
    system[[3, 4], [2, 3]], system[[3, 4], [4, 5]], system[5] = 1, 1, [0, 0, *moment(E), *moment(D)]
    known[1], known[2] = WEIGHT * (M4 - LOAD), WEIGHT * (M4 * G4.real - LOAD * P.real)
    known[4], known[5] = WEIGHT * M6, WEIGHT * M6 * G6.real
    found = np.linalg.solve(system, known)
    return complex(*found[:2]), complex(*found[2:4])


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
@pytest.mark.parametrize("name", ["parallel", "general"])
def test_reactions_beside_free_bodies(request, name, backend):
    C, E = 0.4 * np.exp(-0.3j), 0.2 * np.exp(-1.9j)
    points = {**POINTS, "G4": 0.33 - 0.3j, "G6": 0.14 - 0.27j}
    if name == "parallel":
        points = {"C": C, "E": E, "D": C + E, "P": C + 2.5 * E, "G4": C + E, "G6": E + C / 2}
    made, random = request.getfixturevalue(name), np.random.default_rng(6)
    for q in Q + random.uniform(-0.25, 0.25, (8, 2)):
        assert reactions(made, q, backend) == pytest.approx(freed(*q, points), rel=1e-11)


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
def test_moments_of_the_active_pairs(parallel, backend):
    oracle = ORACLES["fig14_parallelogram"]
    assert unbalance(parallel, Q, backend)[0] == pytest.approx([oracle["M3"], oracle["M5"]], rel=REL)


# ---- errata ----------------------------------------------------------------------------------------------------------------------------


def printed(sign, C, E, D, P, G4, G6):
    """R34 by the chapter's U, V and W; `sign` is that of m6 in V, which it prints as -1."""
    U = WEIGHT * (M4 * (G4 - D).real - LOAD * (P - D).real)
    V = WEIGHT * (M6 * (G6 - D).real - (M4 + sign * M6 - LOAD) * (E - D).real)
    W = D.imag * (C - E).real - C.imag * (D - E).real - E.imag * (C - D).real
    x = (U * (D - E).real - V * (C - D).real) / W
    return complex(x, (V * (D - C).imag - U * (E - D).imag) / W), U, V, W


def test_erratum_7_6_the_weight_of_link_6_adds_to_that_of_link_4(general):
    points = {**POINTS, "G4": 0.33 - 0.3j, "G6": 0.14 - 0.27j}
    right, *terms = printed(1, **points)
    assert terms == pytest.approx([GENERAL[key] for key in "UVW"], rel=REL)
    found, other = reactions(general)
    assert right == pytest.approx(found, rel=1e-12)
    assert complex(-right.real, (M4 + M6 - LOAD) * WEIGHT - right.imag) == pytest.approx(other, rel=1e-12)
    assert abs(printed(-1, **points)[0] - found) > 0.04 * abs(found)


S9 = {"name": "s9", "link": 5, "H": (0.05, -0.25), "F": (0.12, 0.03), "k": 4000.0, "free": 0.1, "pull": 20.0}
S10 = {"name": "s10", "link": 5, "H": (-0.08, -0.2), "F": (0.07, -0.02), "k": 3000.0, "free": 0.08, "pull": 15.0}


def test_erratum_7_7_springs_9_and_10_end_at_their_own_points(built):
    """Spring 9 is Q N with arm B N, 10 is M L with arm B L; psi from link to frame. With lengths exchanged it is wrong."""
    made = built(pantograph(springs=(S9, S10)))
    found = made.call("numpy", "leg", "spring_moment", Q[None])[0]
    phi5, arms, pulls, turns = Q[1], [], [], []
    for spring in (S9, S10):
        F, H = complex(*spring["F"]) * np.exp(1j * phi5), complex(*spring["H"])
        pulls.append(spring["pull"] + spring["k"] * (abs(H - F) - spring["free"]))
        arms.append(abs(F))
        turns.append(np.angle(H - F) - phi5 - np.angle(complex(*spring["F"])))
    wanted = [pull * arm * np.sin(turn) for pull, arm, turn in zip(pulls, arms, turns, strict=True)]
    assert found[:, 1] == pytest.approx(wanted, rel=1e-11)
    assert found[:, 0] == pytest.approx([0, 0], abs=1e-12)
    exchanged = [pull * arm * np.sin(turn) for pull, arm, turn in zip(pulls[::-1], arms, turns, strict=True)]
    assert (np.abs(np.subtract(exchanged, wanted)) > 0.1 * np.abs(wanted)).all()


def test_erratum_7_8_link_2_does_not_weigh_on_the_drives(built, parallel):
    """What Fig. 14 calls m2 is of the frame, which does not turn: any mass of it changes nothing."""
    heavy = built(pantograph(m2=7.0))
    assert unbalance(heavy, Q) == pytest.approx(unbalance(parallel, Q), rel=1e-12)


# ---- why a parallelogram ----------------------------------------------------------------------------------------------------------------


def test_moments_of_a_parallelogram_depend_on_their_own_angles(parallel):
    phi5 = np.array([-1.2, -1.6, -1.9, -2.3])
    front = unbalance(parallel, np.stack([np.full(4, -0.3), phi5], -1))[:, 0]
    assert front == pytest.approx(np.full(4, 210.794638074382), rel=1e-11)


def test_moments_of_a_general_leg_do_not(general):
    front = unbalance(general, np.array([[-0.3, -1.9], [-0.3, -2.1]]))[:, 0]
    assert abs(front[1] - front[0]) > 1.0


def test_two_springs_without_free_length_hold_a_parallelogram_exactly(built, parallel):
    generator = np.random.default_rng(4)
    q = np.stack([generator.uniform(-0.8, 0.4, 200), generator.uniform(-2.4, -1.3, 200)], -1)
    moments, springs = unbalance(parallel, q), []
    for place, link in enumerate((3, 5)):
        found = zero_free_length(q[:, place], moments[:, place])
        assert found.left < 1e-10
        anchor = 0.25 * np.exp(1j * found.angle)
        own = {"H": (float(anchor.real), float(anchor.imag)), "F": (0.12, 0.0), "k": float(found.product / 0.03), "free": 0.0, "pull": 0.0}
        springs.append({"name": f"s{link}", "link": link, **own})
    made = built(pantograph(springs=springs))
    assert np.abs(unbalance(made, q)).max() < 1e-12 * np.abs(moments).max()
    heights = made.call("numpy", "leg", "foot_position", q)[:, 1]
    total = made.call("numpy", "leg", "potential_energy", q) - LOAD * WEIGHT * heights
    assert np.ptp(total) < 1e-12 * np.abs(total).max()


# ---- the search -------------------------------------------------------------------------------------------------------------------------


def test_the_shipped_spec_falls_into_two_problems():
    blocks = blocks_of(Balance(read(SPEC), "stance", SPEC.parent).problem, 0)
    assert [{variable.name.partition("_")[0] for variable in block.variables} for block in blocks] == [{"s7", "s8"}, {"s9", "s10"}]


@pytest.mark.nightly
def test_the_shipped_spec_is_balanced():
    found = designed(SPEC)
    for before, after in zip(found.before, found.after, strict=True):
        assert after.rms < before.rms / 1000


def test_a_leg_that_is_no_parallelogram_is_refused_with_the_angle(tmp_path):
    text = SPEC.read_text(encoding="utf-8").replace("D = [0.40, 0.0]", "D = [0.41, 0.0]")
    path = tmp_path / "spec.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SpecError, match=r"WG217.*at front = \S+ rad the moment of front changes by \S+ N m.*no parallelogram"):
        designed(path, Wanted(starts=1))


def test_a_range_where_the_leg_does_not_assemble_is_refused_with_the_angle(tmp_path):
    text = SPEC.read_text(encoding="utf-8").replace("D = [0.20, 0.0], P", "D = [0.03, 0.0], P")
    path = tmp_path / "spec.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SpecError, match=r"WG225.*does not assemble at front = \S+ rad"):
        designed(path, Wanted(starts=1))


def test_lengths_of_links_may_vary_even_to_where_nothing_assembles(tmp_path):
    """As large or small as the bounds of CD allow, most of them no leg at all; the one that assembles is found."""
    text = SPEC.read_text(encoding="utf-8").replace('"total"', '"two_springs"').replace("D = [0.20, 0.0], P", 'D = ["cd", 0.0], P')
    text = text.replace("[parameters] ", "[parameters]\ncd = { value = 0.2, bounds = [0.02, 0.22] } ")
    text = text.replace(
        "support_deg = { front = [-40, 20], rear = [-140, -90] }", "support_deg = { front = [-40, 20] }\nheld_deg = { rear = -110 }"
    )
    path, more = tmp_path / "spec.toml", 'leg = "leg"\nstretch = [0.01, 100]\nvary = ["cd", "s7_lever", "s7_angle"]'
    path.write_text(text.replace('leg = "leg"', more), encoding="utf-8")
    found = designed(path, Wanted(starts=4))
    assert found.after[0].rms < found.given[0].rms


def test_the_slack_spring_of_these_tests_pulls_nothing(parallel):
    assert SLACK["k"] < 1e-11
    assert np.abs(parallel.call("numpy", "leg", "spring_moment", Q[None])).max() < 1e-12
