"""Derivatives by runtime parameters of what rests on a contact that is found by iteration: beside central differences."""

import numpy as np
import pytest
from rolling_robots import SPECS, called, direction
from scipy.integrate import quad

POLY = (SPECS / "anthropomorphic_leg_poly.toml").read_text(encoding="utf-8")
VALUES = np.array([0.05, 0.42, 0.42, 0.09, 0.12, 5.0, 0.0])
"""The ground's slope, thigh, shank, depth, front, c2, c3."""
HIP = np.array([[0.45, 0.78], [0.8, 0.1], [0.3, 0.2]])
POSTURES = {"toe": -1.9, "heel": -1.3, "beyond": -4.0, "flat": -np.pi / 2}
FUNCTIONS = (
    "foot_position",
    "sole_points",
    "joint_angles",
    "toe_motion",
    "heel_motion",
    "toe_rolling",
    "heel_rolling",
    "stance_position",
    "hip_position",
)
CALLS = {
    "toe_motion": (HIP, np.array([-1.25, -2.0, 1.0]), 0.3),
    "heel_motion": (HIP, np.array([-1.25, 2.0, 1.0]), 0.02),
    "stance_position": (HIP[0], -1.25, 0.18),
    "hip_position": (np.array([-1.2, -2.2, -1.9]), 0.1),
}


def moving_text(name, functions, rest):
    """The shipped leg with runtime parameters."""
    start, end = POLY.index("[sole_design.toe_off]"), POLY.index("[[platforms]]")
    text = (POLY[:start] + POLY[end:]).replace("bounds = [", "runtime = true, bounds = [").replace("anthropomorphic_leg_poly", name)
    text = text.replace("[parameters]\n", '[parameters]\nrise = { value = 0.05, runtime = true, unit = "rad" }\n')
    wanted = ", ".join(f'"{name}"' for name in functions)
    text = text.replace("width = 0.10", 'width = 0.10\nslope = "rise"')
    return f"{text}\n[generate]\nfunctions = [{wanted}]\n{rest}\n"


@pytest.fixture(scope="module")
def moving(built):
    return built(moving_text("moving", FUNCTIONS, "targets = ['c', 'numpy', 'casadi']\nderivatives = true"))


def differences(made, name, inputs, port):
    """Of one output by every parameter, in C."""
    size, step = len(VALUES), 1e-6
    sides = [[called(made, "c", name, *inputs, param=VALUES + side * row)[port] for side in (1, -1)] for row in step * np.eye(size)]
    return np.stack([(ahead.astype(float) - behind.astype(float)) / (2 * step) for ahead, behind in sides], axis=-1)


def inputs_of(made, name):
    """The hip where the heel touches at 0.03 of its curve."""
    if name != "heel_motion":
        return CALLS[name]
    hip, thigh, edge = CALLS[name]
    ankle = made.c.legs["leg"].heel_rolling(0.03, edge, param=VALUES)[3][0]
    return np.array([ankle - 0.42 * (direction(thigh[0]) + direction(-2.6)), *hip[1:]]), thigh, edge


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
@pytest.mark.parametrize("name", CALLS)
def test_what_rolls_by_the_parameters(moving, backend, name):
    inputs = inputs_of(moving, name)
    assert called(moving, "c", name, *inputs, param=VALUES)[-1] == 0
    found = called(moving, backend, f"{name}_d_param", *inputs, param=VALUES)
    for port, slopes in enumerate(found):
        wanted = differences(moving, name, inputs, port)
        assert slopes.shape == wanted.shape
        assert np.abs(slopes - wanted).max() < 1e-8 * (1.0 + np.abs(wanted).max())


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
@pytest.mark.parametrize("posture", POSTURES)
def test_the_foot_point_by_the_parameters(moving, backend, posture):
    """Where the foot lies flat the ground must not turn away from it: there the slope has no derivative."""
    q = moving.c.legs["leg"].joint_angles([-1.2, -2.2, POSTURES[posture]], param=VALUES)
    kept = slice(1 if posture == "flat" else 0, None)
    for name in ("foot_position", "sole_points"):
        (slopes,) = called(moving, backend, f"{name}_d_param", q, param=VALUES)
        wanted = differences(moving, name, (q,), 0)
        assert np.abs(slopes - wanted)[..., kept].max() < 1e-8 * (1.0 + np.abs(wanted[..., kept]).max())


OUTSIDE = np.array([0.4, 0.42, 0.42, 0.09, 0.12, 5.0, 100.0])
"""Sizes of the parameters' spread."""


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_any_parameters_give_a_status_and_never_nan_with_ok(moving, backend):
    """Negative lengths, hollow and crossed curves, no numbers at all: 1e4 in C."""
    random, rows = np.random.default_rng(8), 10_000 if backend == "c" else 100
    leg = (moving.c if backend == "c" else moving.numpy).legs["leg"]
    values = np.where(random.uniform(size=(rows, 1)) < 0.3, VALUES, random.normal(size=(rows, 7)) * OUTSIDE)
    odd = random.uniform(size=values.shape)
    values = np.where(odd < 0.01, random.choice([np.nan, np.inf, -np.inf, 0.0, 1e300, -1e-300], values.shape), values)
    hip = np.tile(HIP, (rows, 1, 1)) + 0.1 * random.normal(size=(rows, 3, 2))
    thigh = random.normal([-1.25, -2.0, 1.0], 0.2, (rows, 3))
    angles = random.normal([-1.2, -2.2, -1.7], 0.3, (rows, 3))
    calls = {
        "toe_motion": (hip, thigh, 0.3),
        "heel_motion": (hip, thigh, 0.02),
        "stance_position": (hip[:, 0], thigh[:, 0], 0.18),
        "hip_position": (angles, 0.1),
    }
    for name, given in calls.items():
        *found, status = getattr(leg, name)(*given, param=values)
        assert np.isin(status, range(6)).all(), name
        assert (status == 0).any(), name
        assert (status[~np.isfinite(values).all(axis=1)] != 0).mean() > 0.5, name
        for part in found:
            assert np.isfinite(part[status == 0]).all(), name


@pytest.mark.parametrize("c2", [0.5, 5.0, 20.0])
def test_arc_lengths_of_curves_that_parameters_shape(built, c2):
    """By adaptive quadrature, over the bounds of the parameters."""
    leg = built(moving_text("rolled", ("toe_rolling",), "targets = ['c', 'numpy']\nderivatives = false")).c.legs["leg"]
    for c3 in (-0.02 * c2 / 0.095, 0.0, 150.0):
        values = VALUES.copy()
        values[5:] = c2, c3
        at = np.linspace(0.0, 0.095, 12)
        arc = leg.toe_rolling(at, 0.3, param=values)[1]
        wanted = [quad(lambda x: np.hypot(2 * c2 * x + 3 * c3 * x**2, 1.0), 0.0, each, epsabs=1e-15)[0] for each in at]  # noqa: B023
        assert np.abs(arc[:, 0] - wanted).max() < 1e-12
