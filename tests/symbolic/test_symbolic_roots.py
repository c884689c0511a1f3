"""Roots without branches against numpy's companion matrices: quartics on the circle, quadratics, double roots, vanishing coefficients."""

from math import cos, sin

import numpy as np
import pytest
import sympy

from mechanisms.hand_programs import run, toy
from walkgen.emit.numpy_printer import numpy_artifact
from walkgen.graph.differentiate import derivative
from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.signature import Port, Signature
from walkgen.symbolic.roots import angle, circle_and_conic, circle_and_line, half_angle, quadratic
from walkgen.symbolic.tape import Tape, symbols_of

SLACK = -1e-9


def program(name, given, rows):
    """A lowered function of port x [given] with an output row for each row of expressions that `rows(tape, symbols)` makes."""
    tape, port = Tape(), Port("x", (given,))
    found = rows(tape, symbols_of(port))
    signature = Signature("toy", "leg", name, (port,), (Port("y", (len(found), len(found[0]))),), "", "")
    return lower(tape.function(signature, [item for row in found for item in row]), fma=False)


def printed(folder, lowered):
    return run(numpy_artifact(toy(lowered)), folder)[f"leg_{lowered.signature.name}"]


def conic_rows(A=None):
    def rows(tape, x):
        return [(*pair, margin) for pair, margin in circle_and_conic(x[3] if A is None else A, *x[:3], tape)]

    return rows


@pytest.fixture(scope="module")
def conic(tmp_path_factory):
    """x = (B, C, D) for A = 1, or (B, C, D, A) with A at run time."""
    folder = tmp_path_factory.mktemp("conic")
    fixed, free = program("fixed", 3, conic_rows(sympy.S.One)), program("free", 4, conic_rows())
    return {"fixed": printed(folder, fixed), "free": printed(folder, free)}


def expected(A, B, C, D):
    """Angles of the real points, by the quartic in the half-angle tangent, turned so that its leading coefficient does not vanish."""
    turn = 0.7
    a, b = cos(turn), sin(turn)
    B, C, mixed, cc, ss = B * a + C * b, C * a - B * b, A * a * b, A * a * a, A * b * b
    # c = (1 - t^2) / (1 + t^2), s = 2 t / (1 + t^2) of cc c^2 - 2 mixed c s + ss s^2 + 2 B c + 2 C s + D
    one, c, s = np.poly1d([1, 0, 1]), np.poly1d([-1, 0, 1]), np.poly1d([2, 0])
    t = (cc * c * c - 2 * mixed * c * s + ss * s * s + 2 * one * (B * c + C * s) + D * one * one).roots
    return turn + 2 * np.arctan(t.real[np.abs(t.imag) < 1e-9 * (1 + np.abs(t.real))])


def conics(generator, count):
    """Coefficients (1, B, C, D) with a point at a random angle, of every size, symmetric ones among them."""
    size = 10.0 ** generator.uniform(-2, 3, (count, 1)) * np.array([1.0, 1.0])
    B, C = (size * generator.normal(size=(count, 2)) * (generator.random((count, 2)) > 0.15)).T
    phi = generator.uniform(-np.pi, np.pi, count)
    return np.stack([np.ones(count), B, C, -(np.cos(phi) ** 2 + 2 * B * np.cos(phi) + 2 * C * np.sin(phi))], axis=-1), phi


@pytest.mark.parametrize("form", ["fixed", "free"])
def test_every_real_point_is_found(conic, form):
    coefficients, _ = conics(np.random.default_rng(1), 3000)
    found = conic[form](coefficients[:, 1:] if form == "fixed" else coefficients[:, [1, 2, 3, 0]])
    clear = 0
    for (A, B, C, D), points in zip(coefficients, found, strict=True):
        angles = expected(*map(float, (A, B, C, D)))
        slopes = np.abs(C * np.cos(angles) - np.sin(angles) * (A * np.cos(angles) + B)) / (A + abs(B) + abs(C))
        if len(angles) == 0 or np.min(slopes) < 1e-3:  # a double root, or nearly
            continue
        clear += 1
        real = points[points[:, 2] > SLACK]
        assert len(real) == len(angles)
        gaps = np.abs(real[:, 0] + 1j * real[:, 1] - np.exp(1j * angles[:, None]))
        assert np.max(np.min(gaps, axis=1)) <= 1e-9
        assert np.allclose(np.hypot(real[:, 0], real[:, 1]), 1.0, rtol=0, atol=1e-15)
    assert clear > 2500


def test_points_are_as_exact_as_the_coefficients(conic):
    coefficients, _ = conics(np.random.default_rng(2), 5000)
    points = conic["fixed"](coefficients[:, 1:])
    (_, B, C, D), c, s = coefficients.T[:, :, None], points[..., 0], points[..., 1]
    value, slope = c**2 + 2 * B * c + 2 * C * s + D, 2 * (C * c - s * (c + B))
    size = 1 + np.abs(B) + np.abs(C) + np.abs(D)
    clear = (points[..., 2] > SLACK) & (np.abs(slope) > 1e-2 * size)
    assert np.count_nonzero(clear) > 5000
    assert np.max((np.abs(value) / size)[clear]) <= 4e-16 * 4


def test_a_double_point_is_found_twice(conic):
    """(c - 1/2)^2 = 0 with s either way; c = 1 where (c - 1)(c + 3) = 0; and all four points one."""
    for B, C, D, angles in ((-0.5, 0, 0.25, [np.pi / 3, -np.pi / 3]), (1, 0, -3, [0.0]), (-1, 0, 1, [0.0])):
        points = conic["fixed"](np.array([B, C, D]))
        near = np.abs(points[:, 0] + 1j * points[:, 1] - np.exp(1j * np.array(angles))[:, None]) < 1e-4
        assert np.all(np.count_nonzero(near & (points[:, 2] > SLACK), axis=1) >= 2)


def test_what_is_not_real_says_so(conic):
    points = conic["fixed"](np.array([[0.1, 0.2, 3.0], [-0.3, 0.1, 1.5]]))
    assert np.all(points[..., 2] < SLACK)
    assert np.all(np.isfinite(points))


@pytest.mark.parametrize("A", [0.0, 1e-300, 1e-12, -1e-9])
def test_without_a_square_it_is_a_line(conic, tmp_path, A):
    line = printed(tmp_path, program("line", 3, lambda tape, x: [(*pair, margin) for pair, margin in circle_and_line(*x, tape)]))
    B, C, D = 0.3, -0.8, 0.5
    points, ends = conic["free"](np.array([B, C, D, A])), line(np.array([2 * B, 2 * C, -D]))
    real = points[points[:, 2] > 0]
    assert np.allclose(real, ends, rtol=0, atol=1e-8)
    assert np.allclose(2 * B * ends[:, 0] + 2 * C * ends[:, 1], -D, rtol=0, atol=1e-15)
    assert np.all(line(np.array([0.3, 0.4, 0.6]))[:, 2] < 0)


def test_derivatives_are_those_of_the_equation():
    """d phi / dD = -1 / (dF / d phi), by forward differentiation of the code."""
    generator, checked = np.random.default_rng(3), 0
    slopes = derivative(program("fixed", 3, conic_rows(sympy.S.One)), "x")
    (coefficients, _) = conics(generator, 40)
    found = [np.array(row) for row in _interpreted(slopes, coefficients[:, 1:])]
    points = [np.array(row) for row in _interpreted(program("fixed", 3, conic_rows(sympy.S.One)), coefficients[:, 1:])]
    for (_, B, C, _), point, change in zip(coefficients, points, found, strict=True):
        for (c, s, margin), by in zip(point.reshape(4, 3), change.reshape(4, 3, 3), strict=True):
            slope = 2 * (C * c - s * (c + B))
            if margin > 1e-3 and abs(slope) > 1e-2 * (1 + abs(B) + abs(C)):
                turning = by[1] * c - by[0] * s
                assert np.allclose(turning, -np.array([2 * c, 2 * s, 1.0]) / slope, rtol=1e-9, atol=1e-12)
                checked += 1
    assert checked > 40


def _interpreted(lowered, rows):
    return [next(iter(interpret(lowered, {"x": list(map(float, row))}).values())) for row in rows]


def test_quadratic(tmp_path):
    solve = printed(tmp_path, program("quadratic", 3, lambda tape, x: quadratic(*x, tape)))
    generator = np.random.default_rng(4)
    roots = generator.normal(size=(500, 2)) * 10.0 ** generator.uniform(-4, 4, (500, 2))
    a = generator.normal(size=500)
    found = solve(np.stack([a, -a * roots.sum(axis=1), a * roots.prod(axis=1)], axis=-1))
    assert np.allclose(np.sort(found[..., 0]), np.sort(roots), rtol=1e-9, atol=0)
    assert np.all(found[..., 1] > 0)
    linear = solve(np.array([0.0, 2.0, -3.0]))
    assert np.isclose(linear[:, 0], 1.5, rtol=1e-15).any()
    complex_pair = solve(np.array([1.0, -4.0, 9.0]))
    assert np.all(complex_pair[:, 1] < -0.1)
    assert np.array_equal(complex_pair[:, 0], [2.0, 2.0])
    assert np.all(np.isfinite(solve(np.zeros(3))))


def test_known_numbers_fold():
    tape = Tape()
    points = circle_and_conic(sympy.S.Zero, sympy.Rational(1, 2), sympy.S.Zero, -sympy.Rational(1, 2), tape)
    assert [pair for pair, _ in points] == [(sympy.Rational(1, 2), side) for side in (pair[1] for pair, _ in points)]
    assert abs(points[0][0][1] ** 2 - sympy.Rational(3, 4)) < 1e-40
    assert half_angle((sympy.S.Zero, -sympy.S.One), tape)[1] < 0
    assert angle((-sympy.S.One, sympy.S.Zero), tape, "half_turn") == sympy.pi.evalf(50)
