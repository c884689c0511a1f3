"""The first root on an interval: functions with known roots in C, in both precisions, and by the reference."""

import numpy as np
import pytest
from general_library import build, call, source

from walkgen.runtime.solves.first_root import first_root

OK, UNREACHABLE, BAD_INPUT, SINGULAR = 0, 1, 2, 3
FUNCTIONS = {
    "line": ("x - a", "1", "WG_ABS@(x) + WG_ABS@(a)"),
    "steep": ("x * x * x * x * x - a", "5 * x * x * x * x", "1"),
    "bowl": ("(x - 1) * (x - 1) - a", "2 * (x - 1)", "1 + WG_ABS@(a)"),
    "wave": ("cos(3 * x) - a", "-3 * sin(3 * x)", "1"),
    "fall": ("exp(-x) - a", "-exp(-x)", "1"),
}
"""Value, slope, size by the unknown x and the given a."""
HARNESS = """
static void NAME_at@(const REAL *point, REAL residual[3], const void *data) {
    const REAL x = point[0], a = point[1];
    (void)data;
    residual[0] = (REAL)(VALUE); residual[1] = (REAL)(SLOPE); residual[2] = (REAL)(SIZE);
}
void NAME_rows@(int rows, const REAL *a, const REAL *bounds, REAL *root, int32_t *status);
void NAME_rows@(int rows, const REAL *a, const REAL *bounds, REAL *root, int32_t *status) {
    for (int i = 0; i < rows; ++i) wg_first_root@(1, a + i, bounds + 2 * i, NAME_at@, NULL, root + i, status + i);
}
"""


def harness(name):
    text = HARNESS.replace("NAME", name)
    for word, formula in zip(("VALUE", "SLOPE", "SIZE"), FUNCTIONS[name], strict=True):
        text = text.replace(word, formula.replace("WG_ABS@", "fabs"))
    return text


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    text = source("".join(map(harness, FUNCTIONS)), "walkgen_first_root.h")
    return build(tmp_path_factory.mktemp("root"), text, "-Wno-float-conversion", "-Wno-double-promotion", "-Wno-conversion")


def in_c(library, name, a, bounds, dtype=np.float64):
    a, bounds = np.array(a, dtype, ndmin=1), np.array(bounds, dtype, ndmin=2)
    root, status = np.full(len(a), 7.0, dtype), np.full(len(a), -1, np.int32)
    call(library, f"{name}_rows", dtype, len(a), a, np.array(np.broadcast_to(bounds, (len(a), 2)), dtype), root, status)
    return root, status


def reference(name, a, bounds):
    def function(point):
        known = {"x": point[..., 0], "a": point[..., 1], "cos": np.cos, "sin": np.sin, "exp": np.exp}
        formulas = (formula.replace("WG_ABS@", "abs") for formula in FUNCTIONS[name])
        return np.stack([eval(formula, known) + 0 * known["x"] for formula in formulas], -1)  # noqa: S307 - the formulas above

    a = np.array(a, float, ndmin=1)
    return first_root(a[:, None], np.broadcast_to(np.array(bounds, float), (len(a), 2)), (function,))


CASES = [
    ("line", 0.25, (0, 1), OK, 0.25),
    ("line", 0.0, (0, 1), OK, 0.0),
    ("line", 1.0, (0, 1), OK, 1.0),
    ("line", -0.25, (0, 1), UNREACHABLE, None),
    ("line", 1.25, (0, 1), UNREACHABLE, None),
    ("steep", 0.5, (0, 2), OK, 0.5**0.2),
    ("bowl", 0.25, (0, 3), OK, 0.5),
    ("bowl", -0.25, (0, 3), SINGULAR, None),
    ("bowl", 4.0, (0, 3.5), UNREACHABLE, None),
    ("wave", 0.3, (0.2, 20), OK, np.arccos(0.3) / 3),
    ("wave", -1.5, (0, 20), SINGULAR, None),
    ("fall", 1e-3, (0, 20), OK, np.log(1e3)),
    ("fall", 1e-3, (0, 5), UNREACHABLE, None),
    ("line", np.nan, (0, 1), BAD_INPUT, None),
    ("line", np.inf, (0, 1), BAD_INPUT, None),
    ("line", 0.5, (1, 0), BAD_INPUT, None),
    ("line", 0.5, (0, np.inf), BAD_INPUT, None),
]


@pytest.mark.parametrize("dtype", [np.float64, np.float32, None])
@pytest.mark.parametrize(("name", "a", "bounds", "status", "root"), CASES)
def test_known_roots(library, name, a, bounds, status, root, dtype):
    found, states = reference(name, a, bounds) if dtype is None else in_c(library, name, a, bounds, dtype)
    assert states[0] == status
    if root is None:
        assert np.isnan(found[0])
    else:
        assert found[0] == pytest.approx(root, rel=1e-5 if dtype == np.float32 else 1e-12, abs=1e-12)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_c_and_the_reference_agree(library, name):
    random = np.random.default_rng(1)
    a, low = random.normal(size=3000), random.uniform(-2, 2, 3000)
    bounds = np.stack([low, low + random.uniform(-0.1, 4, 3000)], -1)
    found, status = in_c(library, name, a, bounds)
    mine, states = reference(name, a, bounds)
    assert (status == states).mean() > 0.999  # cos and exp of two libraries differ in the last digit
    both = (status == OK) & (states == OK)
    assert both.sum() > 50
    assert np.abs(found - mine)[both].max() < 1e-7
    assert set(np.unique(status)) <= {OK, UNREACHABLE, BAD_INPUT, SINGULAR}


def test_first_of_many_roots(library):
    """Of a wave from a place where it falls towards the level: the next crossing, not a later one."""
    random = np.random.default_rng(2)
    level = random.uniform(-0.95, 0.9, 500)
    start = random.uniform(0.05, 0.95, 500) * np.arccos(level) / 3
    found, status = in_c(library, "wave", level, np.stack([start, start + 30], -1))
    assert (status == OK).all()
    assert np.abs(np.cos(3 * found) - level).max() < 1e-12
    assert (np.abs(found - np.arccos(level) / 3) < 1e-9).mean() > 0.5
