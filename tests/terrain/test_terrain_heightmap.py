"""Height maps from file to C and NumPy: parabolas met exactly, slopes that are continuous, scipy's bilinear surface, files refused."""

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from terrain.grounds import spec
from walkgen.errors import SpecError, UnsupportedMechanism
from walkgen.spec.read import read

BACKENDS = ("c", "numpy")
FUNCTIONS = ("height", "normal", "curvature", "project")
CORNER, SPACING = np.array([-0.5, 0.25]), 0.125


def patch(more: str = "", spacing: float = SPACING) -> str:
    """A patch of the file's heights from the corner on."""
    return f'surface = "heightmap"\nfile = "heights.txt"\nspacing = {spacing}\n{more}\n'


def domain(rows: int, columns: int) -> str:
    (x, y), reach = CORNER, SPACING * np.array([columns - 1, rows - 1])
    return f"domain = {{ x = [{x}, {x + reach[0]}], y = [{y}, {y + reach[1]}] }}"


def text(heights: np.ndarray) -> str:
    return "# a comment\n" + "\n".join(" ".join(map(repr, row.tolist())) for row in heights) + "\n\n"


def nodes(rows: int, columns: int) -> tuple[np.ndarray, np.ndarray]:
    return CORNER[0] + SPACING * np.arange(columns)[None, :], CORNER[1] + SPACING * np.arange(rows)[:, None]


def points(rows: int, columns: int, count: int = 300, seed: int = 3) -> np.ndarray:
    inside = np.random.default_rng(seed).uniform(0, 1, (count, 3))
    return np.concatenate([CORNER, [0]]) + inside * [SPACING * (columns - 1), SPACING * (rows - 1), 1]


def parabola(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, ...]:
    """A quadratic, its slopes and its second derivatives xx, xy, yy."""
    z = 0.3 - 0.2 * x + 0.4 * y + 0.7 * x**2 - 0.5 * x * y - 0.9 * y**2
    return z, -0.2 + 1.4 * x - 0.5 * y, 0.4 - 0.5 * x - 1.8 * y, 1.4 + 0 * x, -0.5 + 0 * x, -1.8 + 0 * x


@pytest.fixture(scope="module")
def quadratic(mapped):
    rows, columns = 5, 4
    return mapped(spec(patch(domain(rows, columns))), {"heights.txt": text(parabola(*nodes(rows, columns))[0])}), rows, columns


@pytest.mark.parametrize("backend", BACKENDS)
def test_bicubic_meets_a_parabola_exactly_up_to_the_edges(quadratic, backend: str) -> None:
    robot, rows, columns = quadratic
    ground, p = getattr(robot, backend).terrain, points(rows, columns, 80)
    p[:2, :2] = CORNER, CORNER + SPACING * np.array([columns - 1, rows - 1])
    z, fx, fy, fxx, fxy, fyy = parabola(p[:, 0], p[:, 1])
    np.testing.assert_allclose(ground.height(p), z, atol=1e-14)
    n = np.stack([-fx, -fy, np.ones(len(p))], -1) / np.sqrt(1 + fx**2 + fy**2)[:, None]
    np.testing.assert_allclose(ground.normal(p), n, atol=1e-13)
    second = np.stack([np.stack([fxx, fxy], -1), np.stack([fxy, fyy], -1)], -2)
    flat = ground.tangents(p)[..., :2]
    bent = flat @ second @ np.swapaxes(flat, -1, -2) / np.sqrt(1 + fx**2 + fy**2)[:, None, None]
    np.testing.assert_allclose(ground.curvature(p), bent, atol=1e-11)
    foot, status = ground.project(p)
    assert set(status.tolist()) <= {0, 1}
    assert (status == 0).mean() > 0.4
    away, normal = (p - foot)[status == 0], ground.normal(foot)[status == 0]
    np.testing.assert_allclose(np.cross(away, normal), 0, atol=1e-8)
    np.testing.assert_allclose(ground.height(foot), foot[:, 2], atol=1e-12)
    assert np.all(np.linalg.norm(p - foot, axis=-1) <= np.abs(p[:, 2] - z) + 1e-12)


def test_off_the_map_and_odd_points_are_on_no_patch(quadratic) -> None:
    robot, rows, columns = quadratic
    far = CORNER + SPACING * np.array([columns - 1, rows - 1])
    p = np.array(
        [[CORNER[0] - 1e-9, 0.3, 0], [far[0] + 1e-9, 0.3, 0], [0, far[1] + 1e-9, 0], [np.nan, 0.3, 0], [0, np.inf, 0], [1e300, 0, 0]]
    )
    for backend in BACKENDS:
        ground = getattr(robot, backend).terrain
        assert np.all(ground.patch(p) == -1)
        assert np.isnan(ground.height(p)).all()
        foot, status = ground.project(p)
        assert np.isnan(foot).all()
        assert status.tolist() == [1, 1, 1, 2, 2, 1]


def test_bicubic_slopes_are_continuous_and_heights_met(mapped) -> None:
    rows, columns = 7, 6
    heights = np.random.default_rng(1).normal(size=(rows, columns))
    robot = mapped(
        spec(patch(domain(rows, columns)), functions=FUNCTIONS),
        {"heights.txt": text(heights).replace(" ", ", ").replace("#, a, comment", "# c")},
    )
    ground = robot.c.terrain
    x, y = np.broadcast_arrays(*nodes(rows, columns))
    np.testing.assert_allclose(ground.height(np.stack([x, y, 0 * x], -1)), heights, atol=1e-13)
    p = points(rows, columns)
    for axis in (0, 1):
        edge = p.copy()
        edge[:, axis] = CORNER[axis] + SPACING * np.random.default_rng(axis).integers(1, (columns, rows)[axis] - 1, len(p))
        step = np.eye(3)[axis] * 1e-9
        np.testing.assert_allclose(ground.height(edge + step), ground.height(edge - step), atol=1e-6)
        np.testing.assert_allclose(ground.normal(edge + step), ground.normal(edge - step), atol=1e-5)
        jump = np.abs(ground.curvature(edge + step) - ground.curvature(edge - step)).max(axis=(1, 2))
        assert jump.max() > 1  # second derivatives do jump: the step between the two points is not too small to be seen
    np.testing.assert_allclose(robot.numpy.terrain.curvature(p), ground.curvature(p), rtol=1e-9, atol=1e-10)
    for values in zip(robot.numpy.terrain.project(p[:50]), ground.project(p[:50]), strict=True):
        np.testing.assert_allclose(*values, atol=1e-7)


def test_bilinear_is_scipys(mapped) -> None:
    rows, columns = 4, 5
    heights = np.random.default_rng(2).normal(size=(rows, columns)) / 10
    robot = mapped(
        spec(patch(f'interpolation = "bilinear"\n{domain(rows, columns)}'), functions=("height", "normal")), {"heights.txt": text(heights)}
    )
    x, y = nodes(rows, columns)
    theirs = RegularGridInterpolator((y[:, 0], x[0]), heights)
    p = points(rows, columns)
    for backend in BACKENDS:
        ground = getattr(robot, backend).terrain
        np.testing.assert_allclose(ground.height(p), theirs(p[:, 1::-1]), atol=1e-14)
        inner = np.floor((p[:, :2] - CORNER) / SPACING) * SPACING + CORNER + SPACING / 2
        slopes = [(theirs((p[:, 1], inner[:, 0] + 0.01)) - theirs((p[:, 1], inner[:, 0] - 0.01))) / 0.02]
        slopes.append((theirs((inner[:, 1] + 0.01, p[:, 0])) - theirs((inner[:, 1] - 0.01, p[:, 0]))) / 0.02)
        n = ground.normal(p)
        np.testing.assert_allclose(-n[:, :2] / n[:, 2:], np.stack(slopes, -1), atol=1e-12)


def test_without_a_domain_the_map_begins_at_the_origin_and_ends_with_its_points(mapped) -> None:
    robot = mapped(spec(patch(spacing=0.5), functions=("height",), casadi=True), {"heights.txt": "0;1;2\n10;11;12\n"})
    p = [[0, 0, 0], [1, 0.5, 0], [1.01, 0, 0], [0, 0.51, 0], [0.25, 0.25, 9]]
    assert np.array_equal(robot.c.terrain.height(p), [0, 12, np.nan, np.nan, 5.5], equal_nan=True)
    with pytest.raises(UnsupportedMechanism, match="has no CasADi form"):
        robot.c.casadi("terrain_height")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "No such file"),
        ("", "two rows and two columns"),
        ("1 2 3\n", "two rows and two columns"),
        ("1\n2\n", "two rows and two columns"),
        ("1 2\n3 4 5\n", "line 2 has 3 numbers, the first 2"),
        ("1 2\n3 nan\n", "is not a height"),
        ("1 2\n3 -inf\n", "is not a height"),
        ("1 2\n3 1e99\n", "is not a height"),
        ("1,,2\n3,4,5\n", "line 1 has an empty place"),
        ("1 2\n3 __import__('os')\n", "is not a number"),
        ("1 " * 300 + "\n" + ("1 " * 300 + "\n") * 200, "are more than"),
        ("1 2\n" * 300_000, "larger than 1 MiB"),
        (b"\xff\xfe1 2\n", "not UTF-8"),
    ],
)
def test_files_that_are_no_height_maps(tmp_path, content: str | bytes | None, message: str) -> None:
    if content is not None:
        (tmp_path / "heights.txt").write_bytes(content if isinstance(content, bytes) else content.encode())
    (tmp_path / "spec.toml").write_text(spec(patch()))
    with pytest.raises(SpecError) as refused:
        read(tmp_path / "spec.toml")
    (problem,) = refused.value.problems
    assert problem.code == "WG168"
    assert message in problem.message


def test_a_map_outside_the_folder_or_smaller_than_its_domain(tmp_path) -> None:
    folder = tmp_path / "inner"
    folder.mkdir()
    (tmp_path / "outside.txt").write_text("1 2\n3 4\n")
    (folder / "heights.txt").symlink_to(tmp_path / "outside.txt")
    (folder / "spec.toml").write_text(spec(patch()))
    with pytest.raises(SpecError, match="outside the spec's folder"):
        read(folder / "spec.toml")
    (folder / "heights.txt").unlink()
    (folder / "heights.txt").write_text("1 2\n3 4\n")
    (folder / "spec.toml").write_text(spec(patch("domain = { x = [0, 0.125], y = [0, 0.126] }")))
    with pytest.raises(SpecError, match="WG169"):
        read(folder / "spec.toml")
