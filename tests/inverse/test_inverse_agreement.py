"""C, NumPy and CasADi give one answer, and a batch gives what its rows give alone."""

import numpy as np
import pytest
from anatomy import turned
from legs import LEGS

OK, UNREACHABLE = 0, 1


def targets(anatomy, count=400):
    """Half reachable, half anywhere around."""
    generator = np.random.default_rng(53)
    q = generator.uniform(-np.pi, np.pi, (count // 2, 3))
    around = generator.uniform(-1.5, 1.5, (count // 2, 3)) * anatomy.reach + anatomy.points[0]
    return np.concatenate([anatomy.foot(q), around])


def slack(anatomy, rows):
    """What one rounding of the target may do to the rows: [n, 4]."""
    least = np.linalg.svd(anatomy.jacobian(rows), compute_uv=False)[..., -1]
    return 1e-12 + 1e-15 * anatomy.reach / np.maximum(least, 1e-9)


@pytest.mark.parametrize("name", LEGS)
def test_c_and_numpy(specimen, name):
    c, plain = specimen(name), specimen(name, "numpy")
    p = targets(c.anatomy)
    rows, status = c.generated.inverse(p)
    same_rows, same_status = plain.generated.inverse(p)
    assert np.array_equal(status, same_status)
    out = status == UNREACHABLE
    assert np.all((np.max(turned(rows, same_rows), axis=-1) <= slack(c.anatomy, rows))[~out])
    feet = np.linalg.norm(c.anatomy.foot(rows) - p[:, None], axis=-1), np.linalg.norm(c.anatomy.foot(same_rows) - p[:, None], axis=-1)
    assert np.max(np.abs(feet[0] - feet[1])) <= 1e-12


@pytest.mark.parametrize("name", ["general_mirrored", "mapped", "chapter", "equal_offset", "distant", "craig", "roll", "random_1"])
def test_casadi(specimen, name):
    """Where a row is reached, it is C's row."""
    leg = specimen(name)
    functions = {
        key: leg.robot.casadi(f"{name}_{key}") for key in ("inverse", "inverse_branch", "inverse_velocity", "inverse_acceleration")
    }
    generator = np.random.default_rng(59)
    for p in targets(leg.anatomy, 24):
        rows, status = leg.generated.inverse(p)
        found, states = (np.array(value) for value in functions["inverse"](p))
        reached = status == OK
        assert np.array_equal(states.ravel(), status)
        assert np.all((np.max(turned(found, rows), axis=-1) <= slack(leg.anatomy, rows))[reached])
        for branch in np.flatnonzero(reached):
            q, state = (np.array(value).ravel() for value in functions["inverse_branch"](p, int(branch)))
            assert state == OK
            assert np.max(turned(q, rows[branch])) <= slack(leg.anatomy, rows)[branch]
    for q in generator.uniform(-np.pi, np.pi, (20, 3)):
        rates, v = generator.normal(size=(2, 3))
        for key, inputs in (("inverse_velocity", (q, v)), ("inverse_acceleration", (q, rates, v))):
            expected, status = getattr(leg.generated, key)(*inputs)
            found, state = (np.array(value).ravel() for value in functions[key](*inputs))
            assert state == status
            assert np.linalg.norm(found - expected) <= 1e-10 * np.linalg.norm(expected)


@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize("name", ["general", "turned", "equal", "random_0"])
def test_a_batch_is_its_rows(specimen, name, backend):
    leg = specimen(name, backend).generated
    p = targets(specimen(name).anatomy, 60).reshape(4, 15, 3)
    rows, status = leg.inverse(p)
    assert rows.shape == (4, 15, 4, 3)
    assert status.shape == (4, 15, 4)
    branches = np.arange(4)[:, None]
    one, code = leg.inverse_branch(p, branches)
    qd, flags = leg.inverse_velocity(rows[..., 0, :], p)
    for index in np.ndindex(4, 15):
        alone, state = leg.inverse(p[index])
        assert np.array_equal(state, status[index])
        assert np.max(np.abs(alone - rows[index])) <= (0 if backend == "c" else 1e-12)
        single, flag = leg.inverse_branch(p[index], branches[index[0], 0])
        assert flag == code[index]
        assert np.max(np.abs(single - one[index])) <= (0 if backend == "c" else 1e-12)
        rate, flag = leg.inverse_velocity(rows[index][0], p[index])
        assert flag == flags[index]
        assert np.max(np.abs(rate - qd[index])) <= (0 if backend == "c" else 1e-12 * np.max(np.abs(rate)))
