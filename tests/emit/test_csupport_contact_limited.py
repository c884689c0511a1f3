"""Contact forces within limits on joint torques in C, beside their reference and Clarabel, with proofs where there are none."""

import clarabel
import numpy as np
import pytest
from contact_checks import imbalance, loads, outside
from contact_peers import CARRIED, REFUTED, UNDECIDED, clarabel_settings
from csupport_library import STRICT, compile_c
from limited_library import SOURCE, Limited
from scipy.sparse import csc_matrix

from contact_stances import grasp, random_stances
from walkgen.runtime.solves.contact import contact_limited

OK, BAD_INPUT, INFEASIBLE = 0, 2, 5


@pytest.fixture(scope="module")
def forces(tmp_path_factory):
    return Limited(tmp_path_factory.mktemp("limited"))


def with_torques(seed, rows, k, least=30.0, most=60.0):
    """Stances whose legs have three joints of random Jacobians, each limited from both sides."""
    generator = np.random.default_rng(seed)
    J = np.zeros((rows, 3 * k, k, 3))
    for foot in range(k):
        J[:, 3 * foot : 3 * foot + 3, foot] = generator.normal(0.0, 0.3, (rows, 3, 3))
    return random_stances(seed, rows, k), np.concatenate([J, -J], 1), np.repeat(generator.uniform(least, most, (rows, 1)), 6 * k, 1)


def torques(rows, f):
    return np.einsum("rtki,rki->rt", rows, f)


def proves(stances, rows, limits, found):
    """Whether certificate and multipliers exclude all forces of round cones, per row; to the rounding of their entries."""
    z = np.einsum("rij,ri->rj", grasp(stances.points), found.certificate).reshape(*stances.mu.shape, 3)
    z += np.einsum("rtki,rt->rki", rows, found.multipliers)
    N = (z * stances.normals).sum(-1)
    least = (N - stances.mu * np.linalg.norm(z - N[..., None] * stances.normals, axis=-1)).min(-1) * loads(stances)
    whole = (found.certificate * stances.wrench).sum(-1) - (found.multipliers * limits).sum(-1)
    return (np.abs(whole - 1.0) <= 1e-6) & (least >= -1e-7) & (found.multipliers >= 0.0).all(-1)


@pytest.mark.parametrize("facets", [0, 4])
@pytest.mark.parametrize("k", [4, 6])
def test_c_equals_its_reference(forces, k, facets):
    stances, rows, limits = with_torques(40 + k, 100, k)
    first, second = forces(stances, rows, limits, facets), contact_limited(*vars(stances).values(), facets, rows, limits)
    assert np.array_equal(first.status, second.status)
    assert {OK, INFEASIBLE} == set(first.status)
    good = first.status == OK
    used = (torques(rows, first.f) > limits * (1.0 - 1e-9)).any(-1) & good
    assert used.sum() >= 3
    assert (np.abs(first.f - second.f)[good].max((-1, -2)) / loads(stances)[good]).max() <= 1e-7
    assert imbalance(stances[good], first.f[good]).max() <= 1e-9
    assert outside(stances[good], first.f[good], facets).max() <= 1e-14
    assert (torques(rows, first.f) <= limits + 1e-9 * loads(stances)[:, None])[good].all()
    if facets == 0:
        assert proves(stances[~good], rows[~good], limits[~good], Part(first, ~good)).all()
        assert proves(stances[~good], rows[~good], limits[~good], Part(second, ~good)).all()
    assert (first.violation[~good] > 0.0).all()


class Part:
    """Some rows of what was found."""

    def __init__(self, found, rows):
        vars(self).update({name: value[rows] for name, value in found._asdict().items()})


def by_clarabel(stance, rows, limits):
    k, size = stance.mu.shape[1], loads(stance)[0]
    blocks, cones = [grasp(stance.points)[0], rows[0].reshape(-1, 3 * k)], [clarabel.ZeroConeT(6), clarabel.NonnegativeConeT(rows.shape[1])]
    for foot in range(k):
        n = stance.normals[0, foot]
        block = np.zeros((3, 3 * k))
        block[:, 3 * foot : 3 * foot + 3] = -np.vstack([stance.mu[0, foot] * n, np.linalg.svd(n[None])[2][1:]])
        blocks.append(block)
        cones.append(clarabel.SecondOrderConeT(3))
    right = np.concatenate([-stance.wrench[0], limits[0], np.zeros(3 * k)]) / size
    settings, P = clarabel_settings(), csc_matrix(2.0 * np.eye(3 * k))
    found = clarabel.DefaultSolver(P, np.zeros(3 * k), csc_matrix(np.vstack(blocks)), right, cones, settings).solve()
    return {"Solved": CARRIED, "PrimalInfeasible": REFUTED}.get(str(found.status), UNDECIDED), np.array(found.x).reshape(k, 3) * size


def test_verdicts_and_forces_are_clarabels(forces):
    stances, rows, limits = with_torques(60, 150, 5)
    found = forces(stances, rows, limits)
    for row in range(150):
        one = slice(row, row + 1)
        verdict, f = by_clarabel(stances[one], rows[one], limits[one])
        assert verdict == UNDECIDED or {CARRIED: OK, REFUTED: INFEASIBLE}[verdict] == found.status[row], row
        if verdict == CARRIED:
            assert np.abs(f - found.f[row]).max() <= 2e-5 * loads(stances[one])[0]


def test_limits_that_bind_nothing(forces):
    stances, rows, _ = with_torques(61, 40, 4)
    free, none = forces(stances, rows, np.full((40, 24), np.inf)), forces(stances, rows[:, :0], np.zeros((40, 0)))
    assert np.array_equal(free.status, none.status)
    assert np.array_equal(free.f, none.f, equal_nan=True)
    assert (free.multipliers == 0.0).all()


def test_no_load_within_limits_that_ask_for_squeezing(forces):
    """Two feet face each other; f of the first is to be at least 5 N: they squeeze, or have no friction to hold and may not."""
    stances = random_stances(0, 1, 3)[:1]
    points, normals = np.array([[[-0.2, 0.0, 0.0], [0.2, 0.0, 0.0]]]), np.array([[[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]])
    pair = stances.changed(points=points, normals=normals, mu=np.full((1, 2), 0.5), wrench=np.zeros((1, 6)), weight=np.ones((1, 2)))
    pair = pair.changed(n_max=np.full((1, 2), np.inf))
    rows, limits = np.array([[[[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]]]), np.array([[-5.0]])
    found = forces(pair, rows, limits)
    assert found.status[0] == OK
    assert np.allclose(found.f, [[[5.0, 0.0, 0.0], [-5.0, 0.0, 0.0]]], atol=1e-8)
    away = pair.changed(normals=-normals)
    assert forces(away, rows, limits).status[0] == INFEASIBLE
    assert contact_limited(*vars(away).values(), 0, rows, limits).status[0] == INFEASIBLE


def test_bad_limits(forces):
    stances, rows, limits = with_torques(62, 1, 4)
    for value in (np.nan, np.inf):
        broken = rows.copy()
        broken[0, 3, 1, 1] = value
        for dtype in (np.float64, np.float32):
            found = forces(stances, broken, limits, dtype=dtype)
            assert found.status[0] == BAD_INPUT
            assert all(np.isnan(part).all() for part in (found.f, found.certificate, found.multipliers))
    for value in (np.nan, -np.inf):
        assert forces(stances, rows, np.full_like(limits, value)).status[0] == BAD_INPUT
    assert forces(stances, np.repeat(rows, 5, 1), np.repeat(limits, 5, 1)).status[0] == BAD_INPUT


def test_float(forces):
    stances, rows, limits = with_torques(63, 200, 4)
    exact, found = forces(stances, rows, limits), forces(stances, rows, limits, dtype=np.float32)
    good = (exact.status == OK) & (found.status == OK)
    assert good.sum() >= 0.9 * (exact.status == OK).sum()
    assert np.median(np.abs(exact.f - found.f)[good].max((-1, -2)) / loads(stances)[good]) <= 1e-4


@pytest.mark.parametrize(("standard", "compiler"), [("-std=c++11", "g++"), ("-std=c99", "gcc")])
def test_strict_flags(tmp_path, standard, compiler):
    assert compile_c(tmp_path, SOURCE, "strict.o", standard, "-O0", "-c", *STRICT, compiler=compiler).exists()
