"""Legs whose lengths are runtime parameters: the inverse for values far from the defaults, singular ones included."""

from functools import cache

import numpy as np
import pytest
from anatomy import Anatomy, turned
from legs import OBLIQUE, leg, mirrored, spec

from oracles.walker import read

OK, UNREACHABLE, BAD_INPUT, SINGULAR, DUPLICATE = 0, 1, 2, 3, 6
NAMES = ("shoulder", "thigh", "shank", "aside", "heel")
DEFAULTS = (0.08, 0.35, 0.4, 0.03, 0.02)
PARAMETERS = "\n".join(
    ["[parameters]", *(f"{name} = {{ value = {value}, unit = 'm', runtime = true }}" for name, value in zip(NAMES, DEFAULTS, strict=True))]
)
ROWS = [
    'a = "shoulder"\nalpha_deg = 90\nd = 0.1',
    'a = "thigh"\nalpha_deg = 0\nd = "aside"',
    'a = "shank"\nalpha_deg = 15\nd = 0.0',
]
DESIGNS = {
    "own": leg("own", ROWS, '0, "heel", 0', "classic", mount=OBLIQUE),
    "own_mirrored": mirrored("own_mirrored", "own"),
    "own_mapped": leg("own_mapped", ROWS, '0, "heel", 0', "classic", signs="signs = [-1, -1, 1]\nzeros_deg = [10, 20, -190]"),
}
TEXT = spec("tunable", DESIGNS, PARAMETERS)
VALUES = {
    "defaults": DEFAULTS,
    "longer": (0.3, 0.9, 0.7, -0.2, 0.4),
    "behind": (-0.2, 0.2, 0.5, 0.1, -0.1),
    "reversed": (0.1, -0.3, 0.4, 0.05, 0.0),
    "chapter": (0.0, 0.35, 0.4, 0.0, 0.0),
    "equal": (0.1, 0.3, 0.3, 0.0, 0.0),
    "distant": (1.5, 0.2, 0.3, 0.02, 0.1),
}


@pytest.fixture(scope="module")
def anatomy():
    @cache
    def of(name, values):
        return Anatomy(read(TEXT, **dict(zip(NAMES, VALUES[values], strict=True))).leg(name))

    return of


@pytest.fixture(params=["c", "numpy"])
def tunable(request, built):
    robot = built(TEXT)
    return (robot.c if request.param == "c" else robot.numpy).legs


@pytest.mark.sampled(20)
@pytest.mark.parametrize("values", VALUES)
@pytest.mark.parametrize("name", DESIGNS)
def test_poses_are_found_again(tunable, anatomy, name, values):
    body, param = anatomy(name, values), np.array(VALUES[values])
    q = np.random.default_rng(61).uniform(-np.pi, np.pi, (2000, 3))
    p = body.foot(q)
    rows, status = tunable[name].inverse(p, param=param)
    least = np.linalg.svd(body.jacobian(q), compute_uv=False)[:, -1]
    error = np.where(np.isin(status, (OK, DUPLICATE)), np.max(turned(rows, q[:, None]), axis=-1), np.inf)
    assert np.all(np.min(error, axis=1) <= 1e-13 + 1e-14 * body.reach / least)
    misses = np.linalg.norm(body.foot(rows) - p[:, None], axis=-1)
    assert np.all(misses[status == OK] <= 1e-12 * body.reach)
    rho, bend = body.sides(rows)
    assert np.all((rho * [1, 1, -1, -1] > -1e-9)[status == OK])
    assert np.all((bend * [1, -1, 1, -1] > -1e-9)[status == OK])
    for branch in range(4):
        one, code = tunable[name].inverse_branch(p, branch, param=param)
        assert np.array_equal(code, status[:, branch])
        assert np.max(turned(one, rows[:, branch])) <= 1e-12


@pytest.mark.parametrize("values", VALUES)
def test_rates(tunable, anatomy, values):
    body, param = anatomy("own", values), np.array(VALUES[values])
    q, v = np.random.default_rng(67).uniform(-2, 2, (2, 500, 3))
    qd, status = tunable["own"].inverse_velocity(q, v, param=param)
    back = np.einsum("nij,nj->ni", body.jacobian(q), qd)
    assert np.count_nonzero(status == OK) > 100
    assert np.all((np.linalg.norm(back - v, axis=1) <= 1e-10 * np.linalg.norm(v, axis=1))[status == OK])


@pytest.mark.parametrize("values", VALUES)
def test_unreachable_rows_are_closest(tunable, anatomy, values):
    body, param = anatomy("own", values), np.array(VALUES[values])
    p = body.point(np.array([3.0, 2.0, 0.01]) * body.reach, np.array([0.0, -2.0, 4.0]) * body.reach)
    rows, status = tunable["own"].inverse(p, param=param)
    assert np.all(status == UNREACHABLE)
    best = np.min(np.linalg.norm(body.foot(rows) - p[:, None], axis=-1), axis=1)
    others = np.linalg.norm(body.foot(np.random.default_rng(71).uniform(-np.pi, np.pi, (100_000, 1, 3))) - p, axis=-1)
    assert np.all(best <= np.min(others, axis=0))
    assert np.all(np.min(others, axis=0) - best <= 0.05 * body.reach)


@pytest.mark.parametrize("name", DESIGNS)
def test_singular_poses_of_the_values(tunable, anatomy, name):
    """An offset that vanishes, and bones that become equal, only at run time."""
    chapter = anatomy(name, "chapter")
    rows, status = tunable[name].inverse(chapter.point(0.0, np.array([-0.4, 0.2])), param=np.array(VALUES["chapter"]))
    assert np.array_equal(status, [[SINGULAR, SINGULAR, DUPLICATE, DUPLICATE]] * 2)
    assert np.all(rows[..., 0] == 0)
    equal = anatomy(name, "equal")
    rows, status = tunable[name].inverse(equal.point(0.1, 0.0), param=np.array(VALUES["equal"]))
    assert np.array_equal(status[:2], [SINGULAR, DUPLICATE])
    assert np.all(rows[:2, 1] == 0)


def test_parameters_broadcast(tunable):
    p = np.array([0.4, 0.1, 0.2])
    many = np.array([VALUES["defaults"], VALUES["longer"], VALUES["behind"]])
    rows, status = tunable["own"].inverse(p, param=many)
    for values, row, code in zip(many, rows, status, strict=True):
        alone, state = tunable["own"].inverse(p, param=values)
        assert np.array_equal(code, state)
        assert np.max(turned(row, alone)) <= 1e-12


@pytest.mark.parametrize("place", range(len(NAMES)))
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_values_that_are_not_finite_are_bad_input(tunable, place, value):
    param = np.where(np.arange(len(NAMES)) == place, value, DEFAULTS)
    p = np.array([[0.4, 0.1, 0.2], [9.0, 0.0, 0.0]])
    with np.errstate(all="ignore"):
        rows, status = tunable["own"].inverse(p, param=param)
        one, code = tunable["own"].inverse_branch(p, 1, param=param)
        rates, flag = tunable["own"].inverse_velocity(p, p, param=param)
    for found, state in ((rows, status), (one, code), (rates, flag)):
        assert np.all(state == BAD_INPUT)
        assert np.all(np.isnan(found))


@pytest.mark.parametrize("bone", ["thigh", "shank"])
@pytest.mark.parametrize("name", DESIGNS)
def test_a_leg_without_a_bone_is_never_wrongly_well(tunable, name, bone):
    """Its knee has no angle (but for the rounding that a bone of length 0 leaves): no number where a row is OK is missing or wrong."""
    values = {**dict(zip(NAMES, DEFAULTS, strict=True)), "heel": 0.0, bone: 0.0}
    body = Anatomy(read(TEXT, **values).leg(name))
    p = np.concatenate(
        [body.point(np.hypot(0.08 + 0.75 - values["thigh"], 0.03), 0.0)[None], body.foot(np.linspace(-3, 3, 30).reshape(10, 3))]
    )
    with np.errstate(all="ignore"):
        rows, status = tunable[name].inverse(p, param=np.array(list(values.values())))
    well = (status != BAD_INPUT) & (status != UNREACHABLE)
    assert np.all(np.linalg.norm(body.foot(rows) - p[:, None], axis=-1)[well] <= 1e-12)
    assert np.all(np.isnan(rows[status == BAD_INPUT]))
