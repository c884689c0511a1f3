"""Loads spread over elastic legs in C: the theory's stands, lifting and sliding judged apart, its NumPy reference's answers, any input."""

from dataclasses import replace

import numpy as np
import pytest
from stiffness_library import Spreading, Stance, by_numpy, random_stance

from mechanisms.elastic_robots import stand
from oracles.beam_frame import frame, spread
from oracles.standing import FREE, SLIDE, STICK, all_stands, broken
from oracles.stands import O13_DELTA, O13_F, O13_Q, O13_WRENCH, O14_F, O14_Q, O14_WRENCH
from oracles.walker import read
from walkgen.runtime.solves.contact_stiffness import contact_stiffness_blocks

OK, _, BAD_INPUT, SINGULAR, NO_CONVERGENCE, INFEASIBLE = range(6)
LOAD = 600.0
UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def spreading(tmp_path_factory):
    return Spreading(tmp_path_factory.mktemp("stiffness"))


def chapter_stance(q, wrench, mu=np.inf) -> Stance:
    """Compliances from the frame of beams, the first platform held; its feet are not pressed together by their cones."""
    model, points = frame(stand(), q), read(stand()).foot_positions(q)
    K = model.stiffness().astype(float)[6:, 6:]
    A = np.vstack([model.at(body, point)[:3] for body, point in zip(model.feet, points, strict=True)])[:, 6:]
    C = A @ np.linalg.solve(K, A.T)
    C = np.array([[C[r, c] if r // 3 == c // 3 else 0.0 for c in range(12)] for r in range(12)])
    return Stance(points, np.tile(UP, (4, 1)), np.full(4, mu), wrench, 0.5 * (C + C.T), np.zeros((4, 3)))


@pytest.mark.parametrize("whole", [True, False])
def test_o13_and_o14(spreading, whole):
    """With all feet bonded across their normals, to 1e-11 of the load; level walking has tangential forces."""
    f, status, state, displacement, violation = spreading(chapter_stance(O13_Q, O13_WRENCH), chapter_stance(O14_Q, O14_WRENCH), whole=whole)
    np.testing.assert_allclose(f[0], O13_F, rtol=0, atol=1e-11 * 588.6)
    np.testing.assert_allclose(displacement[0], O13_DELTA, rtol=1e-11)
    np.testing.assert_allclose(f[1], O14_F, rtol=0, atol=1e-6)
    assert (status == OK).all()
    assert (state == STICK).all()
    assert (violation <= 1e-11 * 588.6).all()


def judged(stance, answer, row=0, accuracy=1e-10):
    """What every OK means."""
    f, status, state, displacement, violation = (part[row] for part in answer)
    assert status == OK
    assert broken(stance, f, state, displacement) <= accuracy
    assert 0.0 <= violation <= 1e-9 * LOAD


@pytest.mark.parametrize("k", [3, 4, 6, 9, 16])
@pytest.mark.parametrize("coupled", [False, True])
def test_random_stances_fulfil_all_conditions(spreading, k, coupled):
    """Whatever is OK; stances with feet of all states are among them. A load is called INFEASIBLE only where no forces carry it."""
    rng = np.random.default_rng([k, coupled])
    stances = [random_stance(rng, k, coupled=coupled, misfit=rng.choice([0.0, 2e-4])) for _ in range(60)]
    answer = spreading(*stances)
    fine = np.flatnonzero(answer[1] == OK)
    assert set(answer[1].tolist()) <= {OK, INFEASIBLE, NO_CONVERGENCE}
    assert len(fine) >= (6 if k == 3 else 15)
    for row in fine:
        judged(stances[row], answer, row)
    kinds = answer[2][fine]
    assert all((kinds == kind).any() for kind in ((STICK, SLIDE) if k == 3 else (STICK, SLIDE, FREE)))  # two feet carry nothing
    assert np.isnan(answer[0][answer[1] != OK]).all()
    assert (answer[4][answer[1] == INFEASIBLE] > 0.0).all()
    assert np.mean(answer[1] == NO_CONVERGENCE) <= 0.15


@pytest.mark.parametrize("k", [3, 5])
@pytest.mark.parametrize("coupled", [False, True])
def test_c_is_numpy(spreading, k, coupled):
    rng = np.random.default_rng([k, coupled, 1])
    stances = [random_stance(rng, k, coupled=coupled, misfit=2e-4 * (row % 2)) for row in range(6)]
    columns = [np.array(column) for column in zip(*(stance.given for stance in stances), strict=True)]
    ours, reference = spreading(*stances), by_numpy(*columns)
    np.testing.assert_array_equal(ours[1], reference[1])
    np.testing.assert_array_equal(ours[2], reference[2])
    np.testing.assert_allclose(ours[0], reference[0], rtol=0, atol=1e-9 * LOAD)
    np.testing.assert_allclose(ours[3], reference[3], rtol=0, atol=1e-12)
    if not coupled:
        columns[4] = np.array([stance.blocks for stance in stances])
        blocks, again = spreading(*stances, whole=False), contact_stiffness_blocks(*columns)
        np.testing.assert_array_equal(blocks[1], reference[1])
        np.testing.assert_array_equal(again[0], reference[0])
        np.testing.assert_allclose(blocks[0], ours[0], rtol=0, atol=1e-9 * LOAD)


def sweep(spreading, seed, rows):
    """Where C has no answer, trying all states finds none; how often its answer is found that way."""
    rng = np.random.default_rng(seed)
    stances = [random_stance(rng, 3 + row % 2, misfit=rng.choice([0.0, 2e-4])) for row in range(rows)]
    seen = {True: 0, False: 0}
    for stance in stances:
        f, status, state, _, _ = (part[0] for part in spreading(stance))
        if status == OK and (state == STICK).all():
            continue
        stands = all_stands(stance, tries=3)
        if status == OK:
            seen[any(np.max(np.abs(f - other)) <= 1e-3 for other in stands)] += 1
        else:
            assert not stands
    return seen


@pytest.mark.nightly
@pytest.mark.filterwarnings("ignore:The iteration is not making good progress")
def test_all_states_of_few_feet_tried_often(spreading):
    assert sweep(spreading, 6, 150)[True] >= 8


def test_order_frame_and_size_do_not_matter(spreading):
    """Feet permuted, world turned and shifted, loads scaled: so are the forces; loads by powers of 2 to the last bit."""
    rng, tried = np.random.default_rng(11), 0
    while tried < 12:
        stance = random_stance(rng, 5)
        base = spreading(stance)
        if base[1][0] != OK:
            continue
        tried += 1
        order, R = rng.permutation(5), np.linalg.qr(rng.normal(size=(3, 3)))[0]
        R *= np.sign(np.linalg.det(R))
        permuted, moved, scaled = (
            spreading(stance.permuted(order)),
            spreading(stance.moved(R, rng.normal(size=3))),
            spreading(stance.loaded(64.0)),
        )
        np.testing.assert_allclose(permuted[0][0], base[0][0][order], rtol=0, atol=1e-9 * LOAD)
        np.testing.assert_array_equal(permuted[2][0], base[2][0][order])
        np.testing.assert_allclose(moved[0][0], base[0][0] @ R.T, rtol=0, atol=1e-9 * LOAD)
        np.testing.assert_array_equal(scaled[0], 64.0 * base[0])
        np.testing.assert_allclose(moved[3][0, 3:], R @ base[3][0, 3:], rtol=0, atol=1e-12)


def square(mu=0.6, wrench=(0.0, 0.0, -600.0, 0.0, 0.0, 0.0)) -> Stance:
    points = np.array([[0.3, 0.2, 0.0], [0.3, -0.2, 0.0], [-0.3, 0.2, 0.0], [-0.3, -0.2, 0.0]])
    C = 1e-5 * np.kron(np.eye(4), np.diag([3.0, 2.0, 1.0]))
    return Stance(points, np.tile(UP, (4, 1)), np.full(4, mu), np.array(wrench), C, np.zeros((4, 3)))


def test_known_stands(spreading):
    """Load over a corner's diagonal leaves the far foot free; pushed beyond friction, nothing holds; a foot that is too short is free."""
    tilted = spreading(square(wrench=(0.0, 0.0, -600.0, -30.0 * 0.0 + 90.0, -150.0 * 0.9, 0.0)))
    judged(square(wrench=(0.0, 0.0, -600.0, 90.0, -135.0, 0.0)), tilted)
    assert FREE in tilted[2][0]
    assert spreading(square(wrench=(361.0, 0.0, -600.0, 0.0, 0.0, 0.0)))[1][0] == INFEASIBLE
    assert spreading(square(mu=np.inf, wrench=(361.0, 0.0, -600.0, 0.0, 0.0, 0.0)))[1][0] == OK
    assert spreading(square(wrench=(0.0, 0.0, 600.0, 0.0, 0.0, 0.0)))[1][0] == INFEASIBLE
    short = replace(square(), misfit=np.array([[0.0, 0.0, 0.1], *3 * [[0.0, 0.0, 0.0]]]))
    answer = spreading(short)
    judged(short, answer)
    assert answer[2][0, 0] == FREE
    still = spreading(replace(square(), wrench=np.zeros(6)))
    assert still[1][0] == OK
    assert (still[0] == 0.0).all()


def test_feet_on_a_line_and_too_few(spreading):
    line = replace(square(), points=np.outer([1.0, 2.0, 3.0, 5.0], [0.1, 0.2, 0.0]))
    two = Stance(*(part[:2] for part in square().given[:3]), square().wrench, square().compliance[:6, :6], np.zeros((2, 3)))
    one = Stance(*(part[:1] for part in square().given[:3]), square().wrench, square().compliance[:3, :3], np.zeros((1, 3)))
    for stance in (line, two, one):
        answer = spreading(stance)
        assert answer[1][0] == SINGULAR
        assert np.isnan(answer[0]).all()
        assert by_numpy(*stance.given)[1] == SINGULAR


def bad_stances():
    good = square()
    skewed, negative, flat = good.compliance.copy(), good.compliance.copy(), good.compliance.copy()
    skewed[0, 1], negative[4, 4], flat[2, 2] = 1e-6, -1e-6, 0.0
    apart = good.compliance.copy()
    apart[0, 5] = 1e-6
    yield from (replace(good, compliance=C) for C in (skewed, negative, flat, apart, 0.0 * flat))
    yield replace(good, mu=np.array([0.5, -0.1, 0.5, 0.5]))
    yield from (replace(good, normals=factor * good.normals) for factor in (1.001, 0.0))
    for name in ("points", "normals", "mu", "wrench", "compliance", "misfit"):
        for number in (np.nan, np.inf)[: 1 if name == "mu" else 2]:
            values = getattr(good, name).copy()
            values.flat[0] = number
            yield replace(good, **{name: values})


def test_bad_inputs(spreading):
    for stance in bad_stances():
        answer, reference = spreading(stance), by_numpy(*stance.given)
        assert answer[1][0] == reference[1] == BAD_INPUT
        assert np.isnan(answer[0]).all()
        assert np.isnan(answer[3]).all()


SPECIAL = (0.0, -0.0, 5e-324, 1e-200, 1e-40, 1e-9, 0.3, -0.5, 1.0, 1e9, 1e40, 1e160, -1e160, 1.7e308, np.inf, -np.inf, np.nan)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("whole", [True, False])
def test_any_input_has_an_answer(spreading, dtype, whole):
    """Numbers with OK, NaN with every other status."""
    rng, stances = np.random.default_rng(4), []
    for row in range(240):
        parts = [part.copy() for part in (random_stance(rng, 4) if row % 2 else square()).given]
        for place in rng.integers(6, size=1 + row % 2):
            parts[place].flat[rng.integers(parts[place].size)] = rng.choice(SPECIAL)
        stances.append(Stance(*parts))
    with np.errstate(over="ignore"):
        f, status, _, displacement, violation = spreading(*stances, dtype=dtype, whole=whole)
    fine = status == OK
    assert 0 < fine.sum() < len(fine)
    assert np.isfinite(f[fine]).all()
    assert np.isfinite(displacement[fine]).all()
    assert np.isfinite(violation[fine]).all()
    assert np.isnan(f[~fine]).all()
    assert set(status.tolist()) <= {OK, BAD_INPUT, SINGULAR, NO_CONVERGENCE, INFEASIBLE}


def test_single_precision(spreading):
    rng = np.random.default_rng(8)
    stances = [random_stance(rng, 6, misfit=2e-4) for _ in range(60)]
    exact, single = spreading(*stances, whole=False), spreading(*stances, whole=False, dtype=np.float32)
    both = (exact[1] == OK) & (single[1] == OK)
    assert both.sum() >= 0.8 * (exact[1] == OK).sum()
    same = both & (exact[2] == single[2]).all(axis=1)
    assert same.sum() >= 0.9 * both.sum()
    assert np.max(np.abs(exact[0] - single[0])[same]) <= 2e-3 * LOAD


def test_ground_springs(spreading):
    """In series with the legs, against the frame of beams' springs."""
    rng = np.random.default_rng(2)
    normals = rng.normal(size=(4, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    springs = [2e5 * np.outer(n, n) + 1.5e5 * (np.eye(3) - np.outer(n, n)) for n in normals]
    stance = chapter_stance(O13_Q, O13_WRENCH)
    C = np.zeros((12, 12))
    for i in range(4):
        C[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = stance.blocks[i] + np.linalg.inv(springs[i])
    forces, _ = frame(stand(), O13_Q).forces({"base": O13_WRENCH}, springs)
    np.testing.assert_allclose(spread(stance.points, C, O13_WRENCH)[0], forces, rtol=0, atol=1e-9)
    np.testing.assert_allclose(spreading(replace(stance, compliance=C))[0][0], forces, rtol=0, atol=1e-9)
