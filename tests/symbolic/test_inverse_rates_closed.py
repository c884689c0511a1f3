"""The straight-line damped rates of any Jacobian against 50-digit singular values: free, constant, and singular by construction."""

import math
import random

import pytest
import sympy
from textbook import CONTEXT

from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.signature import Port, Signature
from walkgen.symbolic.rates_closed import Damping, closed_rates
from walkgen.symbolic.tape import Tape, symbols_of

OK, UNREACHABLE, BAD_INPUT, SINGULAR = range(4)
EPSILON, LAMBDA = CONTEXT.mpf("0.05"), CONTEXT.mpf("0.1")
DAMPING = Damping(sympy.Rational("0.05"), sympy.Rational("0.1"))
JOINTS = (1, 2, 3, 4, 5, 7, 16)
ACCURACY = {"50 digits": (CONTEXT, 1e-30), "doubles": (math, 1e-11)}


def program(n, damping=DAMPING, given=None):
    """Rates as a Program of J (its free elements) and v; `given` are J's columns where they are known."""
    tape, J, v = Tape(), Port("J", (3, n)), Port("v", (3,))
    names = symbols_of(J)
    columns = given or tuple((names[k], names[n + k], names[2 * n + k]) for k in range(n))
    signature = Signature("test", "", "rates", (J, v), (Port("qd", (n,)), Port("status", kind="integer")))
    return lower(tape.function(signature, closed_rates(columns, symbols_of(v), damping, tape)))


@pytest.fixture(scope="module")
def programs():
    return {n: program(n) for n in JOINTS}


def run(compiled, J, v, context=CONTEXT):
    number = float if context is math else CONTEXT.mpf
    found = interpret(compiled, {"J": list(map(number, J)), "v": list(map(number, v))}, context)
    return CONTEXT.matrix(found["qd"]), found["status"][0]


def expected(J, v, epsilon=EPSILON, largest=LAMBDA):
    """J^+ v by the singular values, each s of J^+ counted as s + lambda^2 / s; and the status."""
    U, S, V = CONTEXT.svd_r(J)
    least = min(S)
    square = (1 - (least / epsilon) ** 2) * largest**2 if least < epsilon else CONTEXT.zero
    gains = CONTEXT.diag([s / (s**2 + square) if s > 0 else CONTEXT.zero for s in S])
    qd = V.T * gains * U.T * v
    missed = CONTEXT.norm(J * qd - v) > CONTEXT.mpf("1e-9") * CONTEXT.norm(v)
    return qd, SINGULAR if least < epsilon else UNREACHABLE if missed else OK, CONTEXT.sqrt(square)


def cases(n, count=40):
    """Jacobians whose least singular value lies from 1e-9 to 1, some at the border of damping, and velocities, half of them attainable."""
    generator = random.Random(n)
    for index in range(count):
        J = CONTEXT.matrix(3, n)
        for place in range(3 * n):
            J[place // n, place % n] = CONTEXT.mpf(generator.gauss(0, 1))
        U, S, V = CONTEXT.svd_r(J)
        S[min(3, n) - 1] = EPSILON * (1 + CONTEXT.mpf(index - 5) / 10**4) if index < 10 else CONTEXT.mpf(10) ** generator.uniform(-9, 0)
        J = U * CONTEXT.diag(S) * V
        v = CONTEXT.matrix([generator.gauss(0, 1) for _ in range(3)])
        yield J, J * CONTEXT.matrix([generator.gauss(0, 1) for _ in range(n)]) if index % 2 else v


@pytest.mark.sampled(6)
@pytest.mark.parametrize("digits", ACCURACY)
@pytest.mark.parametrize("n", JOINTS)
def test_any_jacobian(programs, n, digits):
    context, tolerance = ACCURACY[digits]
    statuses = set()
    for J, v in cases(n):
        rates, status, damping = expected(J, v)
        found, state = run(programs[n], J, v, context)
        greatest = CONTEXT.norm(v) / max(min(CONTEXT.svd_r(J, compute_uv=False)), damping)
        assert CONTEXT.norm(found - rates) <= tolerance * greatest
        assert CONTEXT.norm(found) * 2 * damping <= CONTEXT.norm(v) * (1 + tolerance)
        assert state == status or abs(damping) < 1e-12
        statuses.add(status)
    assert statuses == {OK, SINGULAR} | ({UNREACHABLE} if n < 3 else set())


def test_it_is_continuous_where_damping_begins(programs):
    """s_n = epsilon (1 -+ 1e-12): the rates differ by the root of that, the status changes."""
    for n in JOINTS:
        v = CONTEXT.matrix([1, 2, -1])
        found = []
        for side in (-1, 1):
            J = CONTEXT.matrix(3, n)
            for k in range(min(3, n)):
                J[k, k] = CONTEXT.mpf(1 + k)
            J[min(3, n) - 1, min(3, n) - 1] = EPSILON * (1 + side * CONTEXT.mpf("1e-12"))
            found.append(run(programs[n], J, v))
        assert CONTEXT.norm(found[0][0] - found[1][0]) <= 1e-8
        assert (found[0][1], found[1][1]) == (SINGULAR, UNREACHABLE if n < 3 else OK)


CONSTANT = {
    "orthogonal slides": (((1, 0, 0), (0, 1, 0), (0, 0, 1)), OK),
    "four slides": (((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0.6, 0.8)), OK),
    "skew slides": (((1, 0, 0), (0.6, 0.8, 0), (0, 0.6, 0.8)), OK),
    "slides in a plane": (((1, 0, 0), (0, 1, 0), (0.6, 0.8, 0)), SINGULAR),
    "slides in a tilted plane": (((1, 0, 0), (0, 0.6, 0.8), (0.6, 0.48, 0.64)), SINGULAR),
    "parallel slides": (((0, 1, 0), (0, 1, 0)), SINGULAR),
    "two slides": (((0, 1, 0), (0, 0.6, 0.8)), UNREACHABLE),
    "one slide": (((0, 0.6, 0.8),), UNREACHABLE),
    "no motion": (((0, 0, 0),), SINGULAR),
    "no motion of two": (((0, 0, 0), (0, 0, 0)), SINGULAR),
    "no motion of four": (((0, 0, 0),) * 4, SINGULAR),
}


@pytest.mark.parametrize("name", CONSTANT)
def test_a_constant_jacobian_is_decided_when_derived(name):
    columns, status = CONSTANT[name]
    exact = [[sympy.Rational(str(entry)) for entry in column] for column in columns]
    J = CONTEXT.matrix([[CONTEXT.mpf(str(column[row])) for column in columns] for row in range(3)])
    v = CONTEXT.matrix(["0.3", "-0.7", "0.2"])
    compiled = program(len(columns), given=tuple(map(tuple, exact)))
    found, state = run(compiled, J, v)
    rates, told, _ = expected(J, v)
    assert (state, told) == (status, status)
    assert CONTEXT.norm(found - rates) <= 1e-30
    assert compiled.counts()["atan2"] == 0


def test_a_planar_leg_is_singular_and_moves_as_well_as_it_can():
    """Three turning joints with parallel axes: the row of zeros is seen when derived."""
    names = symbols_of(Port("J", (3, 3)))
    compiled = program(3, given=tuple((names[k], names[3 + k], sympy.S.Zero) for k in range(3)))
    for J, _ in cases(3, 10):
        J[2, 0] = J[2, 1] = J[2, 2] = 0
        v = CONTEXT.matrix([1, 2, 3])
        rates, status, _ = expected(J, v)
        found, state = run(compiled, J, v)
        assert (state, status) == (SINGULAR, SINGULAR)
        assert CONTEXT.norm(found - rates) <= 1e-30


@pytest.mark.parametrize("n", JOINTS)
def test_equal_singular_values(programs, n):
    """The cubic's threefold and twofold roots, and the quadratic's."""
    for sizes in ((2, 2, 2), (2, 2, 1), (2, 1, 1)):
        J = CONTEXT.matrix(3, n)
        for k in range(min(3, n)):
            J[k, k] = CONTEXT.mpf(sizes[k])
        v = CONTEXT.matrix([1, 2, 3])
        for context, tolerance in ACCURACY.values():
            found, state = run(programs[n], J, v, context)
            rates, status, _ = expected(J, v)
            assert state == status
            assert CONTEXT.norm(found - rates) <= tolerance


@pytest.mark.parametrize("n", JOINTS)
@pytest.mark.parametrize(("epsilon", "largest"), [("0", "0"), ("0", "0.1"), ("0.05", "0")])
def test_without_damping(n, epsilon, largest):
    """J^+ v as long as J is regular; numbers, none of them NaN, where it is not."""
    compiled = program(n, Damping(sympy.Rational(epsilon), sympy.Rational(largest)))
    J, v = CONTEXT.matrix(3, n), CONTEXT.matrix([1, 2, 3])
    _, state = run(compiled, J, v, math)
    assert state == SINGULAR
    for k in range(n):
        J[k % 3, k] = CONTEXT.mpf(k + 1)
    found, state = run(compiled, J, v)
    rates, status, _ = expected(J, v, CONTEXT.mpf("1e-40"))
    assert state == status
    assert CONTEXT.norm(found - rates) <= 1e-30


@pytest.mark.parametrize("n", JOINTS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_bad_input_is_nan(programs, n, value):
    for place in range(3 * n + 3):
        numbers = [0.3 + 0.1 * index for index in range(3 * n + 3)]
        numbers[place] = value
        found = interpret(programs[n], {"J": numbers[: 3 * n], "v": numbers[3 * n :]})
        assert found["status"] == [BAD_INPUT]
        assert all(map(math.isnan, found["qd"]))


@pytest.mark.parametrize("n", [3, 4, 7])
def test_the_foot_moves_as_wanted_down_to_rounding(n):
    """In doubles, down to a thousandth as least singular value: J qd misses v by roundings of J qd, for accelerations build on qd."""
    compiled = program(n, Damping(sympy.Rational("1e-6"), sympy.Rational("1e-6")))
    for drawn, v in cases(n):
        U, S, V = CONTEXT.svd_r(drawn)
        J, v_rounded = rounded(U * CONTEXT.diag([S[0], S[1], max(S[2], CONTEXT.mpf("1e-3"))]) * V), rounded(v)
        found, state = run(compiled, J, v_rounded, math)
        assert state == OK
        assert CONTEXT.norm(J * found - v_rounded) <= 1e-15 * CONTEXT.norm(J) * CONTEXT.norm(found)


def rounded(matrix):
    """To doubles."""
    return CONTEXT.matrix([[float(entry) for entry in row] for row in matrix.tolist()])
