"""Where a curve meets a point or comes closest: analytic curves in C and by the reference, beside dense sampling."""

import numpy as np
import pytest
from general_library import build, call, source

from walkgen.runtime.solves.curve import ROOTS, curve_roots

OK, UNREACHABLE, BAD_INPUT = 0, 1, 2
TURN = (0.1 - np.pi, 0.1 + np.pi)
CURVES = {
    "ellipse": (TURN, "2 * C", "S", "-2 * S", "C"),
    "eight": (TURN, "S3", "S2", "3 * C3", "2 * C2"),
    "astroid": (TURN, "C * C * C", "S * S * S", "-3 * C * C * S", "3 * S * S * C"),
    "loops": (TURN, "C + 9 * C3 / 10", "S - 9 * S3 / 10", "-S - 27 * S3 / 10", "C - 27 * C3 / 10"),
    "arc": ((-1.5, 1.7), "t", "WG_SQRT@(1 - t * t)", "1", "-t / WG_SQRT@(1 - t * t)"),
}
HARNESS = """
static void NAME_at@(const REAL drive[1], REAL profile[6], const void *data) {
    const REAL t = drive[0], C = COS(t), S = SIN(t), C2 = COS(2 * t), S2 = SIN(2 * t), C3 = COS(3 * t), S3 = SIN(3 * t);
    (void)data, (void)C, (void)S, (void)C2, (void)S2, (void)C3, (void)S3;
    profile[0] = X; profile[1] = Y; profile[2] = 0; profile[3] = DX; profile[4] = DY; profile[5] = 0;
}
void NAME_rows@(int rows, int closed, const REAL *bounds, const REAL *aim, REAL *drives, int32_t *status);
void NAME_rows@(int rows, int closed, const REAL *bounds, const REAL *aim, REAL *drives, int32_t *status) {
    for (int i = 0; i < rows; ++i) wg_curve_roots@(bounds, aim + 3 * i, NAME_at@, NULL, closed, drives + 8 * i, status + 8 * i);
}
"""


def harness(name):
    words = dict(zip(("DX", "DY", "X", "Y"), (CURVES[name][index] for index in (3, 4, 1, 2)), strict=True))
    text = HARNESS
    for word, formula in words.items():
        text = text.replace(f" = {word};", f" = (REAL)({formula});")
    return text.replace("NAME", name).replace("WG_SQRT@", "SQRT")


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    text = source("".join(map(harness, CURVES)), "walkgen_curve.h")
    for function in ("COS", "SIN", "SQRT"):
        text = text.replace(f"{function}(", f"{function.lower()}(")
    return build(tmp_path_factory.mktemp("curve"), text, "-Wno-float-conversion", "-Wno-double-promotion", "-Wno-conversion")


def profile(name, drive):
    """The same formulas in NumPy."""
    t = np.asarray(drive)[..., 0]
    known = {"t": t, **{f"{word}{k if k > 1 else ''}": f(k * t) for k in (1, 2, 3) for word, f in (("C", np.cos), ("S", np.sin))}}
    formulas = (formula.replace("WG_SQRT@", "sqrt") for formula in CURVES[name][1:])
    with np.errstate(invalid="ignore", divide="ignore"):
        x, y, dx, dy = (eval(formula, {"sqrt": np.sqrt}, known) + 0 * t for formula in formulas)  # noqa: S307 - the formulas above
    return np.stack([x, y, 0 * t, dx, dy, 0 * t], -1)


def in_c(library, name, aim, dtype=np.float64):
    aim = np.ascontiguousarray(np.atleast_2d(aim), dtype)
    drives, status = np.zeros((len(aim), ROOTS), dtype), np.zeros((len(aim), ROOTS), np.int32)
    bounds = np.array(CURVES[name][0], dtype)
    call(library, f"{name}_rows", dtype, len(aim), int(name != "arc"), bounds, aim, drives, status)
    return drives, status


def reference(name, aim):
    return curve_roots(CURVES[name][0], aim, (lambda drive: profile(name, drive),), int(name != "arc"))


def distances(name, drives, aim):
    return np.linalg.norm(profile(name, drives[..., None])[..., :3] - aim[..., None, :], axis=-1)


def on_curve(name, count, seed=0):
    low, high = CURVES[name][0] if name != "arc" else (-1.0, 1.0)
    drives = np.random.default_rng(seed).uniform(low, high, count)
    return drives, profile(name, drives[:, None])[:, :3]


@pytest.mark.parametrize("name", CURVES)
def test_points_of_the_curve_are_met(library, name):
    drives, aim = on_curve(name, 2000)
    found, status = in_c(library, name, aim)
    assert (status[:, 0] == OK).all()
    assert distances(name, found, aim)[status == OK].max() <= 1e-11
    away = np.where(status == OK, np.abs(found - drives[:, None]), np.inf)
    away = np.minimum(away, np.abs(away - 2 * np.pi))
    speed = np.linalg.norm(profile(name, drives[:, None])[:, 3:], axis=-1)
    assert (away.min(-1) * np.minimum(speed, 1))[speed > 1e-2].max() <= 1e-10
    assert all(np.all(np.diff(row[states == OK]) > 0) for row, states in zip(found, status, strict=True))
    assert np.array_equal(np.where(status == OK, 0, found - found[:, :1]), np.zeros_like(found))


def test_crossings_have_all_their_drives(library):
    found, status = in_c(library, "eight", [[0, 0, 0]])
    assert np.sort(np.abs(found[status == OK])) == pytest.approx([0, np.pi], abs=1e-12)
    found, status = in_c(library, "eight", profile("eight", [-np.pi / 12])[:3])  # there sin 3t = -cos 3t: pi/2 - t has the same place
    assert found[status == OK] == pytest.approx([-np.pi / 12, 7 * np.pi / 12], abs=1e-12)


@pytest.mark.parametrize("name", CURVES)
def test_closest_points(library, name):
    """None of 200 001 values of the drive is nearer."""
    aim = np.c_[np.random.default_rng(1).uniform(-2.5, 2.5, (100, 2)), np.full(100, 0.1)]
    found, status = in_c(library, name, aim)
    assert (status == UNREACHABLE).all()
    assert np.array_equal(found, np.broadcast_to(found[:, :1], found.shape))
    low, high = CURVES[name][0] if name != "arc" else (-1.0, 1.0)
    curve = profile(name, np.linspace(low, high, 200001)[:, None])[:, :3]
    least = [np.sqrt(np.min(np.sum((curve - point) ** 2, -1))) for point in aim]
    assert (distances(name, found[:, :1], aim)[:, 0] - least).max() <= (2e-8 if name == "arc" else 1e-14)  # a root's rounding at its end


@pytest.mark.parametrize("name", CURVES)
def test_the_reference_agrees(library, name):
    aim = np.r_[on_curve(name, 3, 2)[1], np.c_[np.random.default_rng(3).uniform(-2, 2, (3, 2)), np.zeros(3)]]
    (found, status), (own, states) = in_c(library, name, aim), reference(name, aim)
    assert np.array_equal(status, states)
    assert np.abs(distances(name, found, aim) - distances(name, own, aim)).max() <= 1e-11


def test_what_is_no_number(library):
    nowhere = np.array([[np.nan, 0, 0], [np.inf, 0, 0]])
    for drives, status in (in_c(library, "ellipse", nowhere), reference("ellipse", nowhere)):
        assert (status == BAD_INPUT).all()
        assert np.isnan(drives).all()
    drives, status = curve_roots(TURN, [0, 0, 0], (lambda drive: np.full((len(drive), 6), np.nan),), 1)
    assert np.isnan(drives).all()
    assert (status == UNREACHABLE).all()


def test_single_precision(library):
    _, aim = on_curve("ellipse", 200)
    found, status = in_c(library, "ellipse", aim, np.float32)
    assert (status[:, 0] == OK).all()
    assert distances("ellipse", found.astype(float), aim)[status == OK].max() <= 1e-4
