"""The closed-form inverse of short legs against the iterative general one, forward kinematics of its own, and Jacobians inverted."""

from itertools import product

import casadi as ca
import numpy as np
import pytest
import sympy
from symbolic_legs import (
    SEQUENCES,
    casadi_inverse,
    exact,
    function,
    number,
    numpy_inverse,
    oracle,
    random_numbers,
)

from oracles.screws import Screws
from walkgen.graph.lower import lower
from walkgen.runtime.solves.inverse_general import inverse_general

OK, UNREACHABLE, BAD_INPUT, SINGULAR, DUPLICATE = 0, 1, 2, 3, 6
REACHED = (OK, SINGULAR, DUPLICATE)
REGULAR = 1e-3
R = sympy.Rational
RIGHT = sympy.pi / 2


def seeded(kinds, twists):
    return np.random.default_rng([number(kinds), *map(ord, twists)])


def least_stretch(leg: Screws, q):
    """Smallest singular value of the Jacobian."""
    return np.linalg.svd(leg.jacobian(q), compute_uv=False)[..., -1]


def compared(folder, kinds, twists, count):
    """Rows of a random leg checked for truth and order; targets whose solutions are all regular, and how many of them have them all."""
    generator = seeded(kinds, twists)
    numbers = random_numbers(kinds, twists, generator)
    leg = oracle(kinds, numbers)
    p = leg.foot(leg.random(generator, count))
    rows, status = numpy_inverse(folder, kinds, numbers)(p)
    exact_rows = np.isin(status, REACHED)
    gap = np.linalg.norm(leg.foot(rows) - p[:, None], axis=-1)
    assert np.max(gap[exact_rows]) <= 1e-12 * (leg.reach + 2)
    expected, states = inverse_general(leg.numbers, p, number(kinds))
    wanted = states == OK
    regular = np.all(~wanted | (least_stretch(leg, expected) > REGULAR), axis=1) & np.any(wanted, axis=1)
    same = np.all(status == states, axis=1) & np.all(~wanted | (leg.apart(rows, expected) <= 1e-9), axis=1)
    return np.any(exact_rows, axis=1), regular, same


TWISTED = [(kinds, "".join(twists)) for kinds in SEQUENCES for twists in product("zpx", repeat=max(0, len(kinds) - 1))]


def at_night(*names):
    return [pytest.param(name, marks=pytest.mark.nightly) for name in names]


@pytest.mark.sampled(6)
@pytest.mark.parametrize(("kinds", "twists"), [case for case in TWISTED if case[1] not in ("zx", "px", "pz", "zz", "xp")])
def test_rows_are_those_of_the_iterative_inverse(tmp_path, kinds, twists):
    """The same solutions in the same order with the same statuses; no target that the leg reaches is called unreachable."""
    reached, regular, same = compared(tmp_path, kinds, twists, 200)
    assert np.all(reached)
    assert np.all(same[regular])


@pytest.mark.nightly
@pytest.mark.parametrize(("kinds", "twists"), TWISTED)
def test_rows_of_many_poses(tmp_path, kinds, twists):
    """A pose in a thousand may be that near a double root that one of the two is lost."""
    reached, regular, same = compared(tmp_path, kinds, twists, 1000)
    assert np.mean(reached) >= 0.999
    assert np.count_nonzero(same & regular) >= 0.999 * np.count_nonzero(regular)


@pytest.mark.parametrize("kinds", ["RRR", "PRP", *at_night("RRP", "RPR", "PRR", "RPP", "PPR")])
def test_nearly_parallel_axes_lose_nothing(tmp_path, kinds):
    """Twists as printed in manuals: 1.57 and 2.7e-6 off."""
    generator = np.random.default_rng(number(kinds))
    for place, (first, second) in enumerate([("1.57", "1.57"), ("1.57", "0.0000027"), ("0.0000027", "3.1416"), ("0.5", "0.0000027")]):
        rows = [(R(1, 3), R(1, 10), R(3, 10), R(first)), (R(-1, 2), R(1, 20), R(2, 5), R(second)), (R(1, 5), 0, R(1, 4), R(1, 2))]
        numbers = exact(kinds, rows, (R(1, 10), R(1, 20), R(-1, 10)))
        leg = oracle(kinds, numbers)
        q = leg.random(generator, 200)
        folder = tmp_path / str(place)
        folder.mkdir()
        values, status = numpy_inverse(folder, kinds, numbers)(leg.foot(q))
        found = np.min(np.where(np.isin(status, REACHED), leg.apart(values, q[:, None]), np.inf), axis=1)
        regular = least_stretch(leg, q) > 1e-2
        assert np.all(found[regular] <= 1e-8)


@pytest.mark.parametrize("kinds", ["RRR", "RPP", "PPP", *at_night("RRP", "RPR", "PRR", "PPR", "PRP")])
def test_derivatives_are_the_inverse_jacobian(tmp_path, kinds):
    """dq/dp through CasADi, row by row; every entry finite where nothing is reached, too."""
    generator = np.random.default_rng(number(kinds))
    numbers = random_numbers(kinds, "px", generator)
    leg = oracle(kinds, numbers)
    inverse = casadi_inverse(tmp_path, kinds, numbers)
    target = ca.SX.sym("p", 3)
    slopes = ca.Function("slopes", [target], [*inverse(target), ca.jacobian(ca.vec(inverse(target)[0].T), target)])
    checked = 0
    for p in [*leg.foot(leg.random(generator, 25)), *generator.normal(size=(15, 3))]:
        rows, status, found = (np.array(item) for item in slopes(p))
        found = found.reshape(*rows.shape, 3)
        assert np.all(np.isfinite(found))
        for row, state, slope in zip(rows, status.ravel(), found, strict=True):
            if state == OK and least_stretch(leg, row) > 1e-2:
                assert np.allclose(slope @ leg.jacobian(row), np.eye(3), rtol=0, atol=1e-9)
                checked += 1
    assert checked >= 25


def test_a_leg_on_a_surface_follows_it(tmp_path):
    """Two joints: along the surface dq/dp is the Jacobian's pseudo-inverse, across it nothing."""
    generator = np.random.default_rng(2)
    numbers = random_numbers("RR", "x", generator)
    leg = oracle("RR", numbers)
    inverse = casadi_inverse(tmp_path, "RR", numbers)
    target = ca.SX.sym("p", 3)
    slopes = ca.Function("slopes", [target], [*inverse(target), ca.jacobian(ca.vec(inverse(target)[0].T), target)])
    for p in leg.foot(leg.random(generator, 20)):
        rows, status, found = (np.array(item) for item in slopes(p))
        assert status[0] == OK
        assert np.allclose(found.reshape(*rows.shape, 3)[0], np.linalg.pinv(leg.jacobian(rows[0])), rtol=0, atol=1e-8)


PITCHING = [(0, 0, R(2, 25), RIGHT), (0, R(1, 20), R(7, 20), 0), (0, 0, R(2, 5), 0)]
STRAIGHT = [(0, 0, 0, RIGHT), (0, 0, R(7, 20), 0), (0, 0, R(2, 5), 0)]
EQUAL = [(0, 0, R(1, 10), RIGHT), (0, 0, R(7, 20), 0), (0, 0, R(7, 20), 0)]
ORIGIN = (0, 0, 0)


def test_the_stretched_leg_is_a_double_root(tmp_path):
    numbers = exact("RRR", PITCHING, ORIGIN)
    leg = oracle("RRR", numbers)
    q = np.array([[0.3, 0.4, 0.0], [-1.0, 0.2, 0.0]])
    rows, status = numpy_inverse(tmp_path, "RRR", numbers)(leg.foot(q))
    for row, state, pose in zip(rows, status, q, strict=True):
        near = leg.apart(row, pose) <= 1e-6
        assert list(state[near & (state != UNREACHABLE)]) == [OK, DUPLICATE]


def test_a_hair_outside_the_reach_is_ok(tmp_path):
    inverse = numpy_inverse(tmp_path, "RRR", exact("RRR", STRAIGHT, ORIGIN))
    inside, outside = (inverse(np.array([0.45, 0.0, 0.6]) * (1 + gap))[1] for gap in (2e-13, 1e-10))
    assert OK in inside
    assert np.all(outside == UNREACHABLE)


def test_a_foot_on_an_axis_leaves_its_joint_free(tmp_path):
    numbers = exact("RRR", STRAIGHT, ORIGIN)
    rows, status = numpy_inverse(tmp_path, "RRR", numbers)(np.array([0.0, 0.0, 0.5]))
    leg, singular = oracle("RRR", numbers), status == SINGULAR
    assert np.count_nonzero(singular) == 2
    assert np.all(rows[singular][:, 0] == 0.0)
    assert np.allclose(leg.foot(rows[singular]), [0.0, 0.0, 0.5], rtol=0, atol=1e-13)


def test_a_folded_leg_turns_in_vain(tmp_path):
    """Thigh as long as shank, foot on the hip: q2 is free, and 0."""
    rows, status = numpy_inverse(tmp_path, "RRR", exact("RRR", EQUAL, ORIGIN))(np.array([0.06, 0.08, 0.0]))
    place = int(np.argmin(np.abs(rows[:, 0] - np.arctan2(0.08, 0.06))))
    assert status[place] == SINGULAR
    assert rows[place, 1] == 0.0
    assert np.count_nonzero(status == OK) == 2


@pytest.mark.parametrize(
    ("kinds", "rows", "free"),
    [
        ("RRR", [(0, 0, R(3, 10), 0), (0, 0, R(1, 4), 0), (0, 0, R(1, 5), 0)], 1),  # all parallel
        ("RRR", [(0, 0, 0, RIGHT), (0, 0, 0, R(1, 2)), (0, 0, R(1, 5), 0)], 1),  # all through one point
        ("RRR", [(0, R(1, 10), 0, 0), (0, 0, R(1, 4), RIGHT), (0, 0, R(1, 5), 0)], 1),  # two are one
        ("RPP", [(0, 0, R(1, 10), RIGHT), (0, 0, 0, 0), (0, 0, R(1, 5), 0)], 1),  # slides in parallel
        ("PRR", [(0, 0, 0, RIGHT), (0, 0, R(1, 4), 0), (0, 0, R(1, 5), 0)], 1),  # in a plane
        ("PPP", [(0, 0, 0, RIGHT), (0, 0, 0, -RIGHT), (0, 0, 0, 0)], 1),  # in a plane
        ("PRP", [(0, 0, R(1, 10), 0), (0, 0, R(1, 5), 0), (0, 0, 0, 0)], 1),  # all in one direction
    ],
)
def test_a_joint_too_many_is_free_everywhere(tmp_path, kinds, rows, free):
    numbers = exact(kinds, rows, ORIGIN)
    leg = oracle(kinds, numbers)
    p = leg.foot(leg.random(np.random.default_rng(3), 200))
    values, status = numpy_inverse(tmp_path, kinds, numbers)(p)
    assert np.all(np.isin(status, (SINGULAR, DUPLICATE, UNREACHABLE)))
    assert np.all(np.count_nonzero(status == SINGULAR, axis=1) >= free)
    gap = np.linalg.norm(leg.foot(values) - p[:, None], axis=-1)
    assert np.max(gap[status != UNREACHABLE]) <= 1e-12


SPECIAL = [0.0, -0.0, 5e-324, 1e-160, 0.4, -1.0, 1e20, -1e160, 1.7e308, np.nan, np.inf, -np.inf]


@pytest.mark.parametrize("kinds", SEQUENCES)
def test_every_target_has_an_answer(tmp_path, kinds):
    p = np.array(list(product(SPECIAL, SPECIAL[::2], SPECIAL)))
    with np.errstate(all="ignore"):
        rows, status = numpy_inverse(tmp_path, kinds, random_numbers(kinds, "pz"[: len(kinds) - 1], np.random.default_rng(4)))(p)
    bad = ~np.all(np.isfinite(p), axis=1)
    assert np.all(status[bad] == BAD_INPUT)
    assert np.all(np.isnan(rows[bad]))
    assert np.all(np.isfinite(rows[~bad]))
    assert not np.any(status[~bad] == BAD_INPUT)
    turning = np.array([kind == "R" for kind in kinds])
    assert np.all((rows[~bad][..., turning] > -np.pi) & (rows[~bad][..., turning] <= np.pi))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("kinds", ["RRR", "RPP", "PR", *at_night("RRP", "RPR", "PRR", "RR")])
@pytest.mark.parametrize("free", ["points", "all"])
def test_runtime_parameters(tmp_path, kinds, free):
    """Points, or all of the geometry, given at run time: lengths that are 0 there, too."""
    generator = np.random.default_rng(number(kinds))
    known = [place < 6 * len(kinds) and place % 6 < 3 and free == "points" for place in range(6 * len(kinds) + 3)]
    folders = iter(tmp_path / str(index) for index in range(9))
    for twists, lengths in product(("px", "xp"), (1.0, 0.0)):
        numbers = random_numbers(kinds, twists[: len(kinds) - 1], generator)
        numbers[9:12] = [a + lengths * (b - a) for a, b in zip(numbers[3:6], numbers[9:12], strict=True)]  # the first two joints meet
        leg = oracle(kinds, numbers)
        values = [float(item) for item, fixed in zip(numbers, known, strict=True) if not fixed]
        symbols = (sympy.Symbol(f"param[{index}]") for index in range(len(values)))
        mixed = [item if fixed else next(symbols) for item, fixed in zip(numbers, known, strict=True)]
        folder = next(folders)
        folder.mkdir()
        q = leg.random(generator, 200)
        p = leg.foot(q)
        rows, status = numpy_inverse(folder, kinds, mixed, len(values))(p, np.array(values))
        reached = np.isin(status, REACHED)
        assert np.max(np.linalg.norm(leg.foot(rows) - p[:, None], axis=-1)[reached]) <= 1e-11
        found = np.min(np.where(reached, leg.apart(rows, q[:, None]), np.inf), axis=1)
        assert np.all(found[least_stretch(leg, q) > REGULAR] <= 1e-8)


def test_a_parameter_that_is_not_a_number_is_bad_input(tmp_path):
    numbers = exact("RR", [(0, 0, sympy.Symbol("param[0]"), RIGHT), (0, 0, R(1, 5), 0)], ORIGIN)
    inverse = numpy_inverse(tmp_path, "RR", numbers, 1)
    assert np.all(inverse(np.array([0.3, 0.0, 0.1]), np.array([0.2]))[1] != BAD_INPUT)
    rows, status = inverse(np.array([0.3, 0.0, 0.1]), np.array([np.nan]))
    assert np.all(status == BAD_INPUT)
    assert np.all(np.isnan(rows))


@pytest.mark.parametrize("exponent", [-8, 8])
def test_size_does_not_matter(tmp_path, exponent):
    numbers = random_numbers("RRR", "xx", np.random.default_rng(5))
    leg = oracle("RRR", numbers)
    p = leg.foot(leg.random(np.random.default_rng(6), 100))
    far = [item * (1 if place % 6 < 3 and place < 18 else sympy.Integer(2) ** exponent) for place, item in enumerate(numbers)]
    solved = []
    for name, given, targets in (("near", numbers, p), ("far", far, np.ldexp(p, exponent))):
        (tmp_path / name).mkdir()
        solved.append(numpy_inverse(tmp_path / name, "RRR", given)(targets))
    assert np.array_equal(solved[0][1], solved[1][1])
    assert np.allclose(leg.apart(solved[0][0], solved[1][0]), 0, atol=1e-9)


@pytest.mark.parametrize(
    ("kinds", "rows", "most"),
    [
        ("RRR", [(R(1, 3), R(1, 10), R(3, 10), R(1, 2)), (1, R(1, 20), R(2, 5), R(-3, 4)), (R(1, 5), R(1, 8), R(1, 4), 0)], 2100),
        ("RRR", PITCHING, 1600),
        ("RRR", STRAIGHT, 1200),
        ("RRP", [(0, R(2, 5), R(13, 40), 0), (0, 0, R(11, 40), sympy.pi), (0, 0, 0, 0)], 500),
        ("PPP", [(0, 0, 0, RIGHT), (RIGHT, 0, 0, RIGHT), (0, 0, 0, 0)], 60),
    ],
)
def test_it_stays_short(kinds, rows, most):
    """Operations; constant geometry folds, special legs are shorter."""
    assert lower(function(kinds, exact(kinds, rows, ORIGIN))).operation_count <= most
