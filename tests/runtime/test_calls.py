"""Functions are called as NumPy's own ufuncs are, compiled or not."""

import math
import warnings
from collections.abc import Callable

import numpy as np
import pytest
from tiny_robot import BACKENDS, COMPILED

from walkgen.runtime import Leg, Robot
from walkgen.runtime.calls import as_called
from walkgen.signature import Port, Signature

Robots = Callable[..., Robot]


@pytest.fixture(params=BACKENDS)
def leg(request: pytest.FixtureRequest, robots: Robots) -> Leg:
    return robots("plain", request.param).legs["left"]


def position(q: np.ndarray) -> np.ndarray:
    return np.stack([q[..., 0] + q[..., 1], q[..., 1] * q[..., 2], np.cos(q[..., 2])], axis=-1)


def test_one_row_from_a_list_of_integers(leg: Leg) -> None:
    found = leg.foot_position([1, 2, 3])
    assert found.dtype == np.float64
    np.testing.assert_allclose(found, [3.0, 6.0, np.cos(3.0)], rtol=1e-15)


@pytest.mark.parametrize("batch", [(), (1,), (0,), (7,), (4, 5), (2, 0, 3)])
def test_leading_dimensions_are_a_batch(leg: Leg, batch: tuple[int, ...]) -> None:
    q = np.random.default_rng(1).normal(size=(*batch, 3))
    found = leg.foot_position(q)
    assert found.shape == (*batch, 3)
    np.testing.assert_allclose(found, position(q), rtol=1e-15)


def test_three_dimensional_output(leg: Leg) -> None:
    q = np.random.default_rng(2).normal(size=(5, 3))
    expected = np.einsum("bi,bj->bij", q, q)[..., None] + np.array([0.0, 1.0])
    np.testing.assert_allclose(leg.foot_hessian(q), expected, rtol=1e-15)


def test_inputs_broadcast_against_each_other(leg: Leg) -> None:
    rng = np.random.default_rng(3)
    J, f, offset = rng.normal(size=(4, 1, 2, 3)), rng.normal(size=(6, 3)), rng.normal(size=(4, 6))
    found = leg.foot_torque(J, f, offset)
    np.testing.assert_allclose(found, np.einsum("xyij,yj->xyi", np.broadcast_to(J, (4, 6, 2, 3)), f) + offset[..., None], rtol=1e-14)


def test_scalar_function(leg: Leg) -> None:
    assert leg.potential_energy(2) == 2 * 9.80665
    assert leg.potential_energy(2).dtype == np.float64
    np.testing.assert_array_equal(leg.potential_energy(np.arange(4)), np.arange(4) * 9.80665)


@pytest.mark.parametrize(
    "view",
    [
        lambda a: a[::2],
        lambda a: a[:, ::-1],
        np.asfortranarray,
        lambda a: a[::-3],
        lambda a: np.broadcast_to(a[0], (5, 3)),
        lambda a: a.astype(">f8"),
        lambda a: np.frombuffer(b"x" + a.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(a.shape),
        lambda a: np.stack([a, -a], axis=-1)[..., 1],
    ],
    ids=["rows", "reversed", "fortran", "backwards", "broadcast", "swapped", "misaligned", "interleaved"],
)
def test_any_memory_layout(leg: Leg, view: Callable[[np.ndarray], np.ndarray]) -> None:
    q = view(np.random.default_rng(4).normal(size=(8, 3)))
    np.testing.assert_allclose(leg.foot_position(q), position(q.astype(float)), rtol=1e-15)
    p, J = leg.foot_position_jacobian(q)
    np.testing.assert_array_equal(p, 2 * q)
    np.testing.assert_array_equal(J, np.eye(3) * q.astype(float)[..., None, :])


def test_matrix_input_in_fortran_order(leg: Leg) -> None:
    J = np.asfortranarray(np.arange(6.0).reshape(2, 3))
    np.testing.assert_array_equal(leg.foot_torque(J, [1, 10, 100], 0.5), [210.5, 543.5])
    np.testing.assert_array_equal(leg.foot_torque(J[:, ::-1], [1, 10, 100], 0), [12.0, 345.0])


def test_out_is_filled(leg: Leg) -> None:
    q = np.random.default_rng(5).normal(size=(4, 3))
    out = np.full((3, 4), np.nan).T  # not contiguous
    assert leg.foot_position(q, out=out) is out
    np.testing.assert_allclose(out, position(q), rtol=1e-15)
    J = np.empty((4, 3, 3))
    p, same = leg.foot_position_jacobian(q, out=(None, J))
    assert same is J
    np.testing.assert_array_equal(p, 2 * q)


def test_out_may_be_the_input(robots: Robots) -> None:
    q = np.random.default_rng(6).normal(size=(50, 3))
    expected = position(q)
    robots().legs["left"].foot_position(q, out=q)
    np.testing.assert_allclose(q, expected, rtol=1e-15)


@pytest.mark.parametrize("wrong", [[1.0, 2.0], np.zeros((5, 4)), 1.0, []])
def test_wrong_core_dimension(leg: Leg, wrong: object) -> None:
    with pytest.raises(ValueError, match="dimension"):
        leg.foot_position(wrong)


def test_wrong_number_of_inputs(leg: Leg) -> None:
    with pytest.raises(TypeError):
        leg.foot_position([1, 2, 3], [1, 2, 3])
    with pytest.raises(TypeError):
        leg.foot_torque([1, 2, 3])


def test_status_and_integer_input(leg: Leg) -> None:
    q, status = leg.inverse_branch([1.0, 4.0, 9.0], 2)
    np.testing.assert_array_equal(q, [3, 4, 5])
    assert (status, np.asarray(status).dtype) == (0, np.int32)
    q, status = leg.inverse_branch([[1.0, 4.0, 9.0], [-1.0, 4.0, 9.0]], np.array([[1], [-7]]))
    assert q.shape == (2, 2, 3)
    np.testing.assert_array_equal(status, [[0, 1], [2, 2]])


@pytest.mark.parametrize("kind", [np.int8, np.int16, np.int32, np.int64, np.uint8, ">i4", ">i8"])
def test_branch_of_any_integer_type(leg: Leg, kind: str) -> None:
    q, status = leg.inverse_branch([1.0, 4.0, 9.0], np.arange(3, dtype=kind))
    np.testing.assert_array_equal(q[:, 0], [1, 2, 3])
    np.testing.assert_array_equal(status, 0)


def test_branch_is_no_fraction(leg: Leg) -> None:
    with pytest.raises(TypeError):
        leg.inverse_branch([1.0, 4.0, 9.0], 0.5)


def test_branch_far_out_of_range(leg: Leg) -> None:
    _, status = leg.inverse_branch([1.0, 4.0, 9.0], [2**31, 2**40, -(2**40)])
    np.testing.assert_array_equal(status, 2)


def test_status_of_every_slot(leg: Leg) -> None:
    q, status = leg.inverse([[1.0, 2.0, 3.0]] * 5)
    assert q.shape == (5, 2, 3)
    np.testing.assert_array_equal(status, [[0, 1]] * 5)


def test_choices_do_not_warn(leg: Leg) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        q, status = leg.inverse_branch([[-1.0, 4.0, 9.0], [np.nan, np.inf, -np.inf]], 0)
        leg.foot_position([np.inf, 1e308, np.inf])
        leg.foot_position_jacobian([1e308, 1e-320, 1.0])
    assert status[0] == 1
    assert np.isnan(q[0, 0])


@pytest.mark.parametrize("backend", BACKENDS)
def test_functions_of_the_robot(robots: Robots, backend: str) -> None:
    robot = robots("plain", backend)
    assert robot.foot_positions([1, 2, 3]).shape == (1, 3)
    np.testing.assert_array_equal(robot.platform_poses(), np.eye(4)[None])


@pytest.mark.parametrize("backend", COMPILED)
def test_compiled_functions_are_ufuncs(robots: Robots, backend: str) -> None:
    robot = robots("plain", backend)
    function = robot.legs["left"].foot_torque
    assert isinstance(function, np.ufunc)
    assert function.signature == "(2,3),(3),()->(2)"
    assert function.__name__ == "tiny_left_foot_torque"
    assert "J [2,3], f [3] N, offset N m -> tau [2] N m" in function.__doc__
    assert robot.functions["tiny_left_foot_torque"] is function


@pytest.mark.parametrize("backend", COMPILED)
def test_float32_takes_the_float_loop(robots: Robots, backend: str) -> None:
    leg = robots("single", backend).legs["left"]
    q = np.random.default_rng(7).normal(size=(9, 3)).astype(np.float32)
    found = leg.foot_position(q[::-2])
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, position(q[::-2]), rtol=3e-7)
    assert leg.foot_position(q.astype(float)).dtype == np.float64
    assert leg.foot_position([1, 2, 3]).dtype == np.float64
    roots, status = leg.inverse_branch(np.array([1, 4, 9], np.float32)[::-1], 1)
    np.testing.assert_array_equal(roots, np.array([4, 3, 2], np.float32))
    assert (roots.dtype, status.dtype) == (np.float32, np.int32)
    tau = leg.foot_torque(np.asfortranarray(np.ones((2, 3), np.float32)), q[:1, ::-1], np.float32(1))
    np.testing.assert_allclose(tau, q[0].sum() + np.ones((1, 2)), rtol=1e-6)
    assert tau.dtype == np.float32


@pytest.mark.parametrize("backend", BACKENDS)
def test_float32_is_computed_in_double_without_the_float_loop(robots: Robots, backend: str) -> None:
    found = robots("plain", backend).legs["left"].foot_position(np.array([1, 2, 3], np.float32))
    np.testing.assert_allclose(found, [3.0, 6.0, np.cos(3.0)], rtol=1e-15)


def _sum(*inputs):
    return sum(map(np.asarray, inputs))


OPTIONAL = Signature(
    "tiny", "", "add", (Port("a"), Port("b", default=(2.0,)), Port("c", default=(math.nan,)), Port("param", (1,))), (Port("y"),)
)


def test_inputs_with_defaults_may_be_left_out_or_named() -> None:
    add = as_called(_sum, OPTIONAL, (100.0,), float32=False)
    assert np.isnan(add(1)).all()
    np.testing.assert_array_equal(add(1, c=4), [107.0])
    np.testing.assert_array_equal(add(1, 5, 3, param=[0.0]), [9.0])
    np.testing.assert_array_equal(add(1, c=4, b=0, param=[[1], [2]]), [[6.0], [7.0]])


@pytest.mark.parametrize(
    ("arguments", "named", "message"),
    [((1, 2, 3, 4), {}, "at most 3"), ((), {"b": 2}, "misses a"), ((1, 2), {"b": 2}, "b twice"), ((1,), {"d": 2}, "unexpected keyword")],
)
def test_inputs_that_do_not_fit(arguments, named, message) -> None:
    with pytest.raises(TypeError, match=message):
        as_called(_sum, OPTIONAL, (100.0,), float32=False)(*arguments, **named)


def test_a_truth_is_a_bool() -> None:
    positive = as_called(
        lambda x: np.int32(x > 0), Signature("tiny", "", "positive", (Port("x"),), (Port("yes", kind="truth"),)), (), float32=False
    )
    assert positive(1.0) is np.True_
    assert positive(-1.0) is np.False_
