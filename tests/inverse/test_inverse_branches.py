"""All solutions, in their slots: round trips from random poses, none left out, on legs described in every way."""

import numpy as np
import pytest
from anatomy import turned
from legs import LEGS

OK, UNREACHABLE, BAD_INPUT, DUPLICATE = 0, 1, 2, 6
RHO, KNEE = np.array([1, 1, -1, -1]), np.array([1, -1, 1, -1])
POSES = 5000


def poses(count: int, seed: int = 3):
    return np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 3))


@pytest.mark.parametrize("name", LEGS)
def test_anatomy_is_the_walkers(anatomies, name):
    """The oracle of this folder, against matrices and complex steps."""
    anatomy = anatomies[name]
    for q in poses(5):
        assert np.allclose(anatomy.foot(q), anatomy.limb.position(q), rtol=0, atol=1e-14)
        assert np.allclose(anatomy.jacobian(q), anatomy.limb.jacobian(q), rtol=0, atol=1e-14)


def test_legs_are_of_the_class(specimen):
    for name in LEGS:
        assert specimen(name).generated.branch_names == (
            "rho_plus_knee_plus",
            "rho_plus_knee_minus",
            "rho_minus_knee_plus",
            "rho_minus_knee_minus",
        )


def test_poses_are_found_again(leg):
    """The pose itself is among the rows: in a slot of status OK, or in one that repeats it."""
    q = poses(POSES)
    p = leg.anatomy.foot(q)
    rows, status = leg.generated.inverse(p)
    sigma = np.linalg.svd(leg.anatomy.jacobian(q), compute_uv=False)[:, -1]
    error = np.max(turned(rows, q[:, None]), axis=-1)
    error[(status != OK) & (status != DUPLICATE)] = np.inf
    assert np.all(np.min(error, axis=-1) <= 1e-13 + 1e-14 * leg.anatomy.reach / sigma)


def test_rows_reach_the_target(leg):
    p = leg.anatomy.foot(poses(POSES))
    rows, status = leg.generated.inverse(p)
    misses = np.linalg.norm(leg.anatomy.foot(rows) - p[:, None], axis=-1)
    assert np.all(misses[status == OK] <= 1e-12 * leg.anatomy.reach)
    assert np.all((rows > -np.pi) & (rows <= np.pi))
    assert np.all(np.isin(status, (OK, UNREACHABLE)))


def test_slots_are_ordered_by_the_signs(leg):
    """rho +, +, -, -; knee +, -, +, -: on the sides where foot and shank are seen to lie, whatever the user's signs."""
    rows, status = leg.generated.inverse(leg.anatomy.foot(poses(POSES)))
    rho, bend = leg.anatomy.sides(rows)
    size = leg.anatomy.reach * 1e-9
    assert np.all((rho * RHO > -size)[status == OK])
    assert np.all((bend * KNEE > -(size**2))[status == OK])
    assert np.mean((np.abs(rho) > size)[status == OK]) > 0.99


def newton(anatomy, p, starts):
    """Levenberg's iteration from many starts: the roots, one a row."""
    q, damping = starts.copy(), np.full(len(starts), 1e-2)
    error = p - anatomy.foot(q)
    for _ in range(80):
        J = anatomy.jacobian(q)
        normal = np.einsum("nij,nik->njk", J, J) + damping[:, None, None] * np.eye(3)
        trial = q + np.linalg.solve(normal, np.einsum("nij,ni->nj", J, error)[..., None])[..., 0]
        remaining = p - anatomy.foot(trial)
        better = np.linalg.norm(remaining, axis=1) <= np.linalg.norm(error, axis=1)
        q, error = np.where(better[:, None], trial, q), np.where(better[:, None], remaining, error)
        damping = np.clip(np.where(better, damping / 10, damping * 4), 1e-15, 1e3)
    return q[np.linalg.norm(error, axis=1) <= 1e-11 * anatomy.reach]


def distinct(roots):
    found = []
    for root in roots:
        if all(np.max(turned(root, other)) > 1e-3 for other in found):
            found.append(root)
    return found


@pytest.mark.sampled(7)
def test_count_is_that_of_a_multistart(leg):
    generator = np.random.default_rng(17)
    for p in leg.anatomy.foot(poses(4, seed=23)):
        _, status = leg.generated.inverse(p)
        roots = newton(leg.anatomy, p, generator.uniform(-np.pi, np.pi, (150, 3)))
        assert np.count_nonzero(status == OK) == len(distinct(roots))


@pytest.mark.parametrize("name", ["general", "random_2"])
def test_no_reachable_pose_is_refused(specimen, name):
    """Feet behind the hip axis included, which the closed form written the obvious way refuses."""
    leg = specimen(name)
    assert all(abs(length) > 1e-3 for length in leg.anatomy.lengths)
    q = poses(200_000, seed=41)
    rho, _ = leg.anatomy.sides(q)
    assert np.count_nonzero(rho < 0) > 10_000
    _, status = leg.generated.inverse(leg.anatomy.foot(q))
    assert np.all(np.any(status == OK, axis=-1))


@pytest.mark.parametrize("name", ["general", "craig"])
def test_mirrored_legs_have_the_same_branches(specimen, name):
    leg, image = specimen(name), specimen(f"{name}_mirrored")
    p = leg.anatomy.foot(poses(500))
    rows, status = leg.generated.inverse(p)
    mirrored_rows, mirrored_status = image.generated.inverse(p * [1, -1, 1])
    assert np.array_equal(status, mirrored_status)
    assert np.max(turned(rows, mirrored_rows)) <= 1e-9


def test_signs_and_zeros_only_rename_the_joints(specimen):
    """`mapped` is `general` at another place: the same mechanism, with the user's angles turned and shifted."""
    leg, mapped = specimen("general"), specimen("mapped")
    back = np.linalg.inv(leg.anatomy.limb.mount)
    p = leg.anatomy.foot(poses(500))
    rows, status = leg.generated.inverse(p)
    mapped_rows, mapped_status = mapped.generated.inverse(p @ back[:3, :3].T + back[:3, 3])
    assert np.array_equal(status, mapped_status)
    assert np.max(turned(mapped_rows * [-1, 1, -1] + np.radians([30, -100, 200]), rows)) <= 1e-9


@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize("name", LEGS)
def test_one_branch_is_its_row(specimen, name, backend):
    leg = specimen(name, backend)
    inside = leg.anatomy.foot(poses(150))
    around = np.random.default_rng(8).uniform(-2, 2, (150, 3)) * leg.anatomy.reach + leg.anatomy.points[0]
    p = np.concatenate([inside, around])
    rows, status = leg.generated.inverse(p)
    for branch in range(4):
        q, code = leg.generated.inverse_branch(p, branch)
        assert np.array_equal(code, status[:, branch])
        assert np.max(turned(q, rows[:, branch])) <= 1e-12
        assert np.all((q > -np.pi) & (q <= np.pi))


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_unknown_branches_are_bad_input(specimen, backend):
    leg = specimen("general", backend)
    near, far = leg.anatomy.foot([0.1, 0.2, 0.3]), np.full(3, 5.0)
    for p in (near, far):
        for branch in (-1, 4, 7, 2**31 - 1, -(2**31)):
            q, status = leg.generated.inverse_branch(p, branch)
            assert status == BAD_INPUT
            assert np.all(np.isnan(q))
