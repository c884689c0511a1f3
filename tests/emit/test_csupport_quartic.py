"""Real roots in C and NumPy against products of known factors and mpmath: random, clustered, double and near-degenerate."""

import mpmath
import numpy as np
import pytest
from general_library import QUARTIC, build, call, source

from walkgen.runtime.solves.quartic import quartic_roots


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return build(tmp_path_factory.mktemp("quartic"), source(QUARTIC, "walkgen_quartic.h"))


@pytest.fixture(params=["c", "numpy"])
def solve(request, library):
    def compiled(polynomials):
        c = np.array(polynomials, float)
        roots, count = np.full((len(c), 4), np.nan), np.zeros(len(c), np.int32)
        call(library, "quartic_rows", np.float64, len(c), c, roots, count)
        return roots, count

    return compiled if request.param == "c" else quartic_roots


def product(roots):
    """Polynomials with these roots, lowest coefficient first, [n, 5]."""
    polynomials = np.array([np.poly(row)[::-1] for row in roots])
    return np.pad(polynomials, ((0, 0), (0, 5 - polynomials.shape[1])))


def sensitivity(polynomials, roots):
    """How far roots move when every coefficient is rounded."""
    powers = roots[..., None] ** np.arange(5)
    slope = np.abs(np.sum(polynomials[:, None, 1:] * np.arange(1, 5) * powers[..., :4], axis=-1))
    return np.sum(np.abs(polynomials[:, None] * powers), axis=-1) / slope * 2.0**-52


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
def test_random_roots(solve, degree):
    rng = np.random.default_rng(degree)
    expected = np.sort(rng.normal(size=(3000, degree)) * 10.0 ** rng.uniform(-3, 3, (3000, degree)), axis=1)
    polynomials = product(expected) * 10.0 ** rng.uniform(-250, 250, (3000, 1))
    roots, count = solve(polynomials)
    apart = np.all(np.diff(expected, axis=1) > 1e-4 * np.abs(expected[:, 1:]), axis=1)
    assert np.all(count[apart] == degree)
    gap = np.abs(roots[apart][:, :degree] - expected[apart])
    assert np.all(gap <= 8 * sensitivity(polynomials[apart], expected[apart]))


def test_complex_pairs_are_no_roots(solve):
    rng = np.random.default_rng(7)
    real = np.sort(rng.normal(size=(2000, 2)), axis=1)
    pairs = rng.normal(size=(2000, 2))
    squares = [[1.0, -2 * b[0], b[0] ** 2 + b[1] ** 2 + 1e-3] for b in pairs]
    polynomials = np.array([np.polymul(np.poly(a), square)[::-1] for a, square in zip(real, squares, strict=True)])
    roots, count = solve(polynomials)
    assert np.all(count == 2)
    assert np.all(np.abs(roots[:, :2] - real) <= 8 * sensitivity(polynomials, real))


def test_double_roots_count_twice(solve):
    rng = np.random.default_rng(8)
    twice = rng.normal(size=(2000, 1))
    others = rng.normal(size=(2000, 2))
    expected = np.sort(np.concatenate([twice, twice, others], axis=1), axis=1)
    apart = np.min(np.abs(others - twice), axis=1) > 0.05
    roots, count = solve(product(expected)[apart])
    assert np.all(count == 4)
    assert np.max(np.abs(roots - expected[apart]) / (1 + np.abs(expected[apart]))) <= 1e-5


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6])
def test_near_pairs_stay_apart(solve, gap):
    """Pairs at rational places, whose coefficients are exact."""
    middle = np.arange(-8, 9)[:, None] / 4.0
    half = np.ldexp(1.0, int(np.log2(gap)))
    polynomials = np.concatenate([middle**2 - half**2, -2 * middle, np.ones_like(middle), np.zeros((17, 2))], axis=1)
    roots, count = solve(polynomials)
    assert np.all(count == 2)
    assert np.all(np.abs(roots[:, 1] - roots[:, 0] - 2 * half) <= 1e-15 * (1 + middle[:, 0] ** 2) / half)


def test_clusters_agree_with_mpmath(solve):
    rng = np.random.default_rng(9)
    for _ in range(60):
        cluster = rng.normal() + rng.choice([1e-1, 1e-2]) * rng.normal(size=4)
        polynomial = product([cluster])
        with mpmath.workdps(60):
            exact = mpmath.polyroots([mpmath.mpf(x) for x in polynomial[0, ::-1]], maxsteps=500, extraprec=400)
            real = np.array(sorted(float(x.real) for x in exact if abs(x.imag) < mpmath.mpf(10) ** -40))
        roots, count = solve(polynomial)
        for root in roots[0, : count[0]]:
            assert float(abs(np.polyval(polynomial[0, ::-1], root))) <= 1e-14 * np.sum(np.abs(polynomial[0]) * np.abs(root) ** np.arange(5))
        for root in real[np.squeeze(sensitivity(polynomial, real[None]), 0) < 1e-6]:
            assert np.min(np.abs(roots[0, : count[0]] - root)) <= 1e-5


SPECIAL = [
    ([0, 0, 0, 0, 0], []),
    ([3, 0, 0, 0, 0], []),
    ([0, 1, 0, 0, 0], [0]),
    ([0, 0, 1, 0, 0], [0, 0]),
    ([1, -2, 1, 0, 0], [1, 1]),
    ([-1, 0, 0, 0, 1], [-1, 1]),
    ([1, 0, 0, 0, 1], []),
    ([4, 0, -5, 0, 1], [-2, -1, 1, 2]),
    ([-2, 1, 1e-200, 0, 0], [-1e200, 2]),
    ([-3e300, 1e300, 0, 0, 0], [3]),
    ([6e-310, -5e-310, 1e-310, 0, 0], [2, 3]),
]


@pytest.mark.parametrize(("polynomial", "expected"), SPECIAL)
def test_special_polynomials(solve, polynomial, expected):
    roots, count = solve([polynomial])
    assert count[0] == len(expected)
    assert np.allclose(roots[0, : count[0]], expected, rtol=1e-13, atol=1e-150)


def test_float_is_as_good_as_its_rounding(library):
    rng = np.random.default_rng(10)
    expected = np.sort(rng.uniform(-3, 3, size=(3000, 4)), axis=1)
    expected = expected[np.min(np.diff(expected, axis=1), axis=1) > 0.2]
    c = product(expected).astype(np.float32)
    roots, count = np.full((len(c), 4), np.nan, np.float32), np.zeros(len(c), np.int32)
    call(library, "quartic_rows", np.float32, len(c), c, roots, count)
    assert np.all(count == 4)
    assert np.all(np.abs(roots - expected) <= 8 * sensitivity(c.astype(float), expected) * 2.0**29)
