"""Many rows from Python: the same numbers row by row, in lanes, at any stride, on any number of threads; without lanes but for rounding."""

import ctypes
from pathlib import Path

import numpy as np
import pytest

from walkgen import pipeline, toolchain
from walkgen.runtime import load

SPEC = Path(__file__).parents[1] / "specs" / "mero_leg.toml"
FUNCTIONS = ("foot_position", "foot_jacobian", "foot_velocity", "inverse", "inverse_branch", "within_limits")
ROWS = 5000


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """With wide vectors, which other tests' libraries are without."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(toolchain, "FLAGS", tuple(flag for flag in toolchain.FLAGS if flag != "-DWALKGEN_PLAIN"))
        yield pipeline.build(SPEC, tmp_path_factory.mktemp("rows"), pipeline.BuildOptions(functions=FUNCTIONS)).folder


@pytest.fixture(scope="module")
def leg(folder):
    return load(folder).legs["leg"]


def angles(rows=ROWS):
    """Some far beyond the range of lanes, some no numbers."""
    q = np.random.default_rng(1).uniform(-1.5, 1.5, (rows, 3))
    q[::97, 1] = 3e5
    q[::101, 2] = np.nan
    return q


def targets(leg, rows=ROWS):
    """Some out of reach, some at the hip."""
    p = leg.foot_position(angles(rows))
    p[::53] *= 9
    p[::59, :2] = 0
    return p


def same(one, other):
    return np.array_equal(one, other, equal_nan=True)


def test_rows_do_not_depend_on_their_number(leg):
    q, p = angles(), targets(leg)
    J, (found, status) = leg.foot_jacobian(q), leg.inverse(p)
    for rows in (1, 3, 4, 5, 31, 32, 33, 64):
        assert same(leg.foot_jacobian(q[:rows]), J[:rows])
        assert all(same(*pair) for pair in zip(leg.inverse(p[:rows]), (found[:rows], status[:rows]), strict=True))
    assert same(leg.foot_jacobian(q[7]), J[7])


def test_a_branch_is_that_of_its_row(leg):
    """Numbers that name none among them; whatever their stride."""
    p, branch = targets(leg), np.random.default_rng(2).choice([0, 1, 2, 3, 3, -1, 4, 2**31, -(2**40)], ROWS)
    q, status = leg.inverse_branch(p, branch)
    for row in range(0, ROWS, 7):
        assert all(same(one, many[row]) for one, many in zip(leg.inverse_branch(p[row], branch[row]), (q, status), strict=True))
    named = (branch >= 0) & (branch < 4)
    all_rows, statuses = leg.inverse(p[named])
    assert same(statuses[np.arange(named.sum()), branch[named]], status[named])
    np.testing.assert_allclose(all_rows[np.arange(named.sum()), branch[named]][status[named] == 0], q[named & (status == 0)], atol=1e-12)
    assert all(same(*pair) for pair in zip(leg.inverse_branch(p[::-3], branch[::-3]), (q[::-3], status[::-3]), strict=True))
    assert all(same(*pair) for pair in zip(leg.inverse_branch(p[:3], branch[:3]), (q[:3], status[:3]), strict=True))


def test_strides_do_not_matter(leg):
    q = angles()
    J = leg.foot_jacobian(q)
    assert same(leg.foot_jacobian(np.asfortranarray(q)), J)
    assert same(leg.foot_jacobian(q[::-3]), J[::-3])
    assert same(leg.foot_jacobian(np.repeat(q, 2, axis=1)[:, ::2]), J)
    out = np.zeros((ROWS, 3, 5))
    leg.foot_jacobian(q, out=out[:, :, 1:4])
    assert same(out[:, :, 1:4], J)
    assert not out[:, :, [0, 4]].any()
    p = targets(leg)
    found, status = leg.inverse(p)
    spread = np.full((ROWS, 4, 2), -7, np.int32)
    assert same(leg.inverse(p, out=(None, spread[..., 0]))[0], found)
    assert same(spread[..., 0], status)
    assert (spread[..., 1] == -7).all()


def test_threads_give_the_same_numbers(folder, leg):
    q, p, qd = angles(), targets(leg), np.array([0.1, -0.2, 0.3])
    alone = (leg.foot_jacobian(q), *leg.inverse(p), leg.foot_velocity(q, qd), leg.within_limits(q))
    for threads in (2, 3):
        shared = load(folder, threads=threads).legs["leg"]
        out = np.empty((ROWS, 3, 3))
        assert shared.foot_jacobian(q, out=out) is out
        found = (out, *shared.inverse(p), shared.foot_velocity(q, qd), shared.within_limits(q))
        assert all(same(*pair) for pair in zip(found, alone, strict=True))
        assert same(shared.foot_jacobian(q[:5]), alone[0][:5])
        assert same(shared.foot_velocity(q.reshape(50, 100, 3), qd).reshape(ROWS, 3), alone[3])


def test_threads_leave_complaints_to_the_function(folder):
    shared = load(folder, threads=2).legs["leg"]
    with pytest.raises(ValueError, match="core dimension"):
        shared.foot_jacobian(np.zeros((ROWS, 4)))
    with pytest.raises(TypeError):
        shared.foot_jacobian()


def test_without_wide_vectors_only_rounding_differs(folder, leg):
    """The level belongs to the loaded library: every test of this process gets it back."""
    robot = load(folder)
    library = ctypes.CDLL(robot.backend_reason.split(" ", 1)[1])
    level = library.mero_leg_level(-1)
    q, p = angles(), targets(leg)
    wide = leg.foot_jacobian(q), *leg.inverse(p)
    try:
        assert library.mero_leg_level(0) == 0
        plain = leg.foot_jacobian(q), *leg.inverse(p)
    finally:
        assert library.mero_leg_level(9) == level
    np.testing.assert_allclose(wide[0], plain[0], rtol=0, atol=4e-16)
    assert np.array_equal(wide[2], plain[2])
    reached = plain[2] == 0
    np.testing.assert_allclose(wide[1][reached], plain[1][reached], rtol=0, atol=1e-7)
