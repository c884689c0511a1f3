"""The closed forms of the inverse rates against 50-digit linear algebra: regular, damped, and at the border between."""

import math
import random
from pathlib import Path

import pytest
from textbook import CONTEXT

from walkgen import pipeline
from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower

SPEC = Path(__file__).parents[2] / "specs" / "mero_leg.toml"
EPSILON, LAMBDA = CONTEXT.mpf("0.02"), CONTEXT.mpf("0.05")
HEIGHT, THIGH, SHANK = CONTEXT.mpf("0.12"), CONTEXT.mpf("0.35"), CONTEXT.mpf("0.40")
OK, UNREACHABLE, BAD_INPUT, SINGULAR = range(4)
TOGETHER = "inverse_velocity_acceleration"
ACCURACY = {"50 digits": (CONTEXT, 1e-30), "doubles": (math, 1e-11)}


def jacobian(q):
    """dp/dq of p = (r cos q1, r sin q1, z), r and z of a two-bar linkage, typed by hand."""
    cos, sin = CONTEXT.cos, CONTEXT.sin
    r = THIGH * cos(q[1]) + SHANK * cos(q[1] + q[2])
    z = THIGH * sin(q[1]) + SHANK * sin(q[1] + q[2])
    far, low = SHANK * cos(q[1] + q[2]), SHANK * sin(q[1] + q[2])
    return CONTEXT.matrix(
        [
            [-r * sin(q[0]), -z * cos(q[0]), -low * cos(q[0])],
            [r * cos(q[0]), -z * sin(q[0]), -low * sin(q[0])],
            [0, r, far],
        ]
    )


def rates(J, v):
    """qd and status by the singular values: damped with lambda^2 = (1 - (s/eps)^2) lambda_max^2 where s < eps."""
    smallest = min(CONTEXT.svd_r(J, compute_uv=False))
    if smallest >= EPSILON:
        return CONTEXT.lu_solve(J, v), OK
    loading = (1 - (smallest / EPSILON) ** 2) * LAMBDA**2
    return J.T * CONTEXT.lu_solve(J * J.T + loading * CONTEXT.eye(3), v), SINGULAR


def bias(q, qd):
    """Jdot qd by central differences along qd."""
    step = CONTEXT.mpf(10) ** -16
    ahead, behind = (jacobian([a + side * step * b for a, b in zip(q, qd, strict=True)]) for side in (1, -1))
    return (ahead - behind) / (2 * step) * CONTEXT.matrix(qd)


def furthest(found, expected):
    """Greatest error, relative to values above 1."""
    return max(abs(a - b) / max(1, abs(b)) for a, b in zip(found, expected, strict=True))


def poses():
    """Random ones, and ones that near the stretched, the folded and the upright leg; then some around s = eps."""
    generator = random.Random(5)
    for _ in range(12):
        yield [CONTEXT.mpf(generator.uniform(-3, 3)) for _ in range(3)]
    for exponent in range(1, 7):
        near = CONTEXT.mpf(10) ** -exponent
        yield [CONTEXT.mpf("0.4"), CONTEXT.mpf("-0.7"), near]
        yield [CONTEXT.mpf("0.4"), CONTEXT.mpf("0.2"), CONTEXT.pi - near]
        yield [CONTEXT.mpf("-1.1"), CONTEXT.acos(0) - CONTEXT.mpf("0.3"), upright(CONTEXT.mpf("0.3")) + near]
    for bend in range(8, 20):
        yield [CONTEXT.mpf("0.4"), CONTEXT.mpf("-0.7"), CONTEXT.mpf(bend) / 100]


def upright(tilt):
    """The knee angle that puts the foot above the hip (r = 0)."""
    return CONTEXT.asin(THIGH * CONTEXT.sin(tilt) / SHANK) + tilt


@pytest.fixture(scope="module")
def closed():
    found = {derivation.signature.name: derivation for derivation in pipeline.functions_of(SPEC)}
    return {name: lower(found[name].closed_form) for name in ("inverse_velocity", "inverse_acceleration", TOGETHER)} | {
        "regular": lower(found[TOGETHER].steps[0].callee)
    }


@pytest.mark.parametrize("digits", ACCURACY)
def test_velocity(closed, digits):
    context, tolerance = ACCURACY[digits]
    statuses = set()
    for q in poses():
        for v in ([1, 0, 0], [0.2, -0.5, 0.7]):
            found = interpret(closed["inverse_velocity"], {"q": q, "v": v}, context)
            expected, status = rates(jacobian(q), CONTEXT.matrix(v))
            assert found["status"] == [status]
            assert furthest(found["qd"], expected) <= tolerance
            statuses.add(status)
    assert statuses == {OK, SINGULAR}


@pytest.mark.parametrize("digits", ACCURACY)
def test_acceleration(closed, digits):
    context, tolerance = ACCURACY[digits]
    qd, a = [CONTEXT.mpf("0.3"), CONTEXT.mpf("-0.8"), CONTEXT.mpf("0.5")], [0.3, 2.0, -1.0]
    for q in poses():
        found = interpret(closed["inverse_acceleration"], {"q": q, "qd": qd, "a": a}, context)
        expected, status = rates(jacobian(q), CONTEXT.matrix(a) - bias(q, qd))
        assert found["status"] == [status]
        assert furthest(found["qdd"], expected) <= tolerance


@pytest.mark.parametrize("digits", ACCURACY)
def test_both_at_once(closed, digits):
    """The closed form anywhere; the regular poses' own code where it is sure, which it is at no damped one, and at most regular ones."""
    context, tolerance = ACCURACY[digits]
    v, a, sure, regular = [0.2, -0.5, 0.7], [0.3, 2.0, -1.0], 0, 0
    for q in poses():
        qd, status = rates(jacobian(q), CONTEXT.matrix(v))
        qdd, _ = rates(jacobian(q), CONTEXT.matrix(a) - bias(q, qd))
        for name in (TOGETHER, "regular"):
            found = interpret(closed[name], {"q": q, "v": v, "a": a}, context)
            if name == "regular" and found["status"] == [UNREACHABLE]:
                continue
            assert found["status"] == [status]
            assert furthest(found["qd"], qd) <= tolerance
            assert furthest(found["qdd"], qdd) <= 10 * tolerance
            sure += name == "regular"
        regular += status == OK
    assert sure >= 0.7 * regular


def test_damped_rates_are_bounded(closed):
    """|qd| <= |v| / (2 lambda), at the singular pose itself too."""
    for bend in (0.0, 1e-9, 1e-3):
        for v in ([1, 0, 0], [0, 0, 1], [-1, 2, 0.5]):
            found = interpret(closed["inverse_velocity"], {"q": [0.4, -0.7, bend], "v": v})
            assert found["status"] == [SINGULAR]
            assert math.hypot(*found["qd"]) <= math.hypot(*v) / (2 * 0.05) * 1.02


@pytest.mark.parametrize("element", range(6))
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_bad_input(closed, element, value):
    given = [0.1, 0.2, 0.3, 1.0, 0.0, 0.0]
    given[element] = value
    assert interpret(closed["inverse_velocity"], {"q": given[:3], "v": given[3:]})["status"] == [BAD_INPUT]
