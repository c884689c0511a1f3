"""Explicit patches and planes in C, NumPy and CasADi: the theory's numbers, sympy's derivatives at random, order of patches, odd inputs."""

import numpy as np
import pytest
import sympy
from mpmath import mp, mpf
from sympy.utilities.lambdify import lambdify

from terrain.grounds import explicit, slopes, spec, weingarten

BACKENDS = ("c", "numpy")
HUMP = "0.1*sin(2*x) + 0.05*x*y"
EXPRESSIONS = (
    HUMP,
    "0.2*cos(x - 2*y)*sqrt(1 + x**2)/(2 + y**2)",
    "0.1*hypot(x + 3, y) - 0.05*atan2(y + 3, x + 4) + tan(0.2*x*y)",
    "-(0.1 - x)**3/(4 + y)**-2/50 + 2*pi/40 - sin(cos(x))*y",
    "((0.3))",
)


def points(count: int, seed: int = 5, size: float = 1.5) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-size, size, (count, 3))


@pytest.mark.parametrize("backend", BACKENDS)
def test_terrain_oracle_of_the_theory(built, backend: str) -> None:
    ground = getattr(built(spec(explicit(HUMP))), backend).terrain
    p = [0.3, -0.4, 7.0]
    assert abs(ground.height(p) - 0.05046424733950354) <= 1e-16
    np.testing.assert_allclose(ground.normal(p), [-0.14354855443479975, -0.014842979389548688, 0.9895319593032459], atol=2e-16, rtol=0)


def strips() -> str:
    """Every expression over a strip of x of its own."""
    patches = (explicit(text, f"domain = {{ x = [{left}, {left + 1}] }}") for left, text in zip(range(-2, 3), EXPRESSIONS, strict=True))
    return spec(*patches, functions=("height", "normal", "tangents", "curvature"))


def sympys(p: np.ndarray) -> np.ndarray:
    """Height, slopes and second derivatives (xx, xy, yy) of the strips, by sympy with 30 digits."""
    x, y = sympy.symbols("x y")
    functions = [sympy.sympify(text, locals={"hypot": lambda a, b: sympy.sqrt(a**2 + b**2)}) for text in EXPRESSIONS]
    orders = ((), (x,), (y,), (x, x), (x, y), (y, y))
    derivatives = [[lambdify((x, y), sympy.diff(f, *order) if order else f, "mpmath") for order in orders] for f in functions]
    with mp.workdps(30):
        return np.array([[float(d(mpf(a), mpf(b))) for d in derivatives[int(np.floor(a)) + 2]] for a, b, _ in p])


def test_explicit_patches_have_sympys_derivatives(built) -> None:
    robot = built(strips())
    p = points(120, size=1.0) * [2.5, 1.5, 1] + [0.5, 0, 0]
    rows = sympys(p)
    first, second = rows[:, 1:3], rows[:, 3:][:, [[0, 1], [1, 2]]]
    for backend in BACKENDS:
        ground = getattr(robot, backend).terrain
        np.testing.assert_allclose(ground.height(p), rows[:, 0], atol=1e-14)
        n = np.stack([-first[:, 0], -first[:, 1], np.ones(len(p))], -1) / np.sqrt(1 + (first**2).sum(-1))[:, None]
        np.testing.assert_allclose(ground.normal(p), n, atol=1e-14)
        gauss, mean = weingarten(first, second)
        curvature = ground.curvature(p)
        np.testing.assert_allclose(np.linalg.det(curvature), gauss, atol=1e-12)
        np.testing.assert_allclose(np.trace(curvature, axis1=-2, axis2=-1) / 2, mean, atol=1e-12)
        # II(t, t) = t_h' D^2 f t_h / w for the horizontal part of a tangent: the whole tensor in its basis, not only its invariants
        flat = ground.tangents(p)[..., :2]
        w = np.sqrt(1 + (first**2).sum(-1))[:, None, None]
        np.testing.assert_allclose(curvature, flat @ second @ np.swapaxes(flat, -1, -2) / w, atol=1e-13)


def test_explicit_patches_against_central_differences(built) -> None:
    ground = built(strips()).c.terrain
    p = points(200) * [0.3, 1, 1] + [-0.5, 0, 0]
    first, second = slopes(lambda at: ground.height(np.concatenate([at, np.zeros((len(at), 1))], -1)), p[:, :2])
    n = np.stack([-first[:, 0], -first[:, 1], np.ones(len(p))], -1)
    np.testing.assert_allclose(ground.normal(p), n / np.linalg.norm(n, axis=-1, keepdims=True), atol=1e-10)
    gauss, mean = weingarten(first, second)
    curvature = ground.curvature(p)
    np.testing.assert_allclose(np.linalg.det(curvature), gauss, atol=1e-5)
    np.testing.assert_allclose(np.trace(curvature, axis1=-2, axis2=-1) / 2, mean, atol=1e-5)


@pytest.mark.parametrize("gravity", [(3.0, -2.0, -8.0), (0, 0, 0)])
def test_tangents_are_an_orthonormal_right_handed_basis_and_up_turns_the_normal(built, gravity: tuple[float, ...]) -> None:
    ground = built(spec(explicit(HUMP), gravity=gravity, functions=("normal", "tangents", "curvature"))).c.terrain
    p = points(100)
    n, t = ground.normal(p), ground.tangents(p)
    frame = np.concatenate([t, n[:, None]], 1)
    np.testing.assert_allclose(frame @ np.swapaxes(frame, -1, -2), np.broadcast_to(np.eye(3), frame.shape), atol=4e-16)
    np.testing.assert_allclose(np.linalg.det(frame), 1)
    assert np.all(n @ -np.array(gravity) >= 0)
    upright = built(spec(explicit(HUMP))).c.terrain
    sign = np.sign((n * upright.normal(p)).sum(-1))
    np.testing.assert_allclose(np.linalg.det(ground.curvature(p)), np.linalg.det(upright.curvature(p)), atol=1e-15)
    traces = [np.trace(which.curvature(p), axis1=-2, axis2=-1) for which in (ground, upright)]
    np.testing.assert_allclose(traces[0], sign * traces[1], atol=1e-15)


def test_level_ground_has_the_worlds_axes_as_tangents(built) -> None:
    ground = built(spec(explicit("0.3"))).c.terrain
    assert np.array_equal(ground.tangents([1, 2, 3]), np.eye(3)[:2])
    assert np.array_equal(ground.curvature([1, 2, 3]), np.zeros((2, 2)))


def test_the_first_patch_whose_domain_holds_the_point_counts(built) -> None:
    patches = (
        explicit("1", "domain = { x = [0, 1], y = [0, 1] }\nmu = 0.5\nkn = 1e5"),
        explicit("2", "domain = { x = [0.5, 2], y = [0, 1] }\nkt = 2e5"),
        'surface = "plane"\npoint = [0, 0, 3]\nnormal = [0, 0, -4]\ndomain = { x = [3, 4] }',
    )
    robot = built(spec(*patches))
    p = np.array(
        [[0.6, 0.5, 0], [1.0, 1.0, 0], [1.1, 0.5, 0], [2.5, 0.5, 0], [3.5, 99, 0], [0.5, -0.1, 0], [np.nan, 0.5, 0], [3.5, np.inf, 0]]
    )
    expected = np.array([0, 0, 1, -1, 2, -1, -1, -1])
    for backend in BACKENDS:
        ground = getattr(robot, backend).terrain
        assert np.array_equal(ground.patch(p), expected)
        assert np.array_equal(ground.height(p), np.where(expected < 0, np.nan, expected + 1), equal_nan=True)
        mu, kn, kt = ground.ground(p)
        assert np.array_equal(mu, np.where(expected == 0, 0.5, np.nan), equal_nan=True)
        assert np.array_equal(kn, np.select([expected < 0, expected == 0], [np.nan, 1e5], np.inf), equal_nan=True)
        assert np.array_equal(kt, np.select([expected < 0, expected == 1], [np.nan, 2e5], np.inf), equal_nan=True)
        for name in ("normal", "tangents", "curvature"):
            values = getattr(ground, name)(p).reshape(len(p), -1)
            assert np.array_equal(np.isnan(values).all(-1), expected < 0)
            assert np.array_equal(np.isnan(values).any(-1), expected < 0)


def test_planes_are_what_their_point_and_normal_say(built) -> None:
    rng = np.random.default_rng(8)
    point, normal = rng.normal(size=3), rng.normal(size=3)
    inclined = f'surface = "plane"\npoint = {point.tolist()}\nnormal = {normal.tolist()}\ndomain = {{ x = [-2, 2] }}'
    wall = 'surface = "plane"\npoint = [3, 0, 0]\nnormal = [2, 0, 0]'
    ground = built(spec(inclined, wall, functions=("height", "normal"))).c.terrain
    p = points(50)
    on = np.concatenate([p[:, :2], ground.height(p)[:, None]], -1)
    np.testing.assert_allclose((on - point) @ normal, 0, atol=1e-13)
    unit = normal / np.linalg.norm(normal)
    np.testing.assert_allclose(ground.normal(p), np.broadcast_to(unit * np.sign(unit[2]), p.shape), atol=1e-15)
    assert np.isnan(ground.height([3, 2, 3]))
    assert np.array_equal(ground.normal([3, 2, 3]), [1, 0, 0])


def test_runtime_parameters_in_surfaces_domains_and_properties(built) -> None:
    parameters = "amp = { value = 0.1, runtime = true }\nedge = { value = 1.0, runtime = true }\nfixed = 2"
    keys = 'domain = { x = ["-edge", "edge"], y = [-1, 1] }\nmu = "2*amp"\nkn = "fixed*1e5"'
    robot = built(spec(explicit("fixed*amp*x**2/2", keys), parameters=parameters, functions=("height", "ground", "patch")))
    for backend in BACKENDS:
        ground = getattr(robot, backend).terrain
        assert ground.height([0.5, 0, 0]) == pytest.approx(0.025)
        assert ground.height([0.5, 0, 0], param=[0.4, 1]) == pytest.approx(0.1)
        assert ground.patch([0.5, 0, 0], param=[0.4, 0.3]) == -1
        assert ground.ground([0, 0, 0], param=[0.4, 1]) == pytest.approx((0.8, 2e5, np.inf))


def test_casadi_gives_the_same_and_its_derivative(built) -> None:
    robot = built(spec(explicit(HUMP, "domain = { x = [-1, 1], y = [-1, 1] }"), functions=("height", "normal", "curvature"), casadi=True)).c
    p = points(20)
    for name in ("height", "normal", "curvature"):
        function = robot.casadi(f"terrain_{name}")
        ours = getattr(robot.terrain, name)(p)
        theirs = np.array([np.array(function(row)).reshape(ours.shape[1:]) for row in p])
        np.testing.assert_allclose(theirs, ours, atol=1e-15)


def test_a_robot_without_ground_says_so(built) -> None:
    robot = built(spec(functions=("foot_position",))).c
    with pytest.raises(AttributeError, match=r"describes no ground"):
        _ = robot.terrain
    assert not hasattr(robot, "terrain")
