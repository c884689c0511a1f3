"""Rows side by side: a result is right or NaN wherever an angle is NaN, shown by running Programs with such angles."""

import math

import pytest

from mechanisms.hand_programs import constant, inputs, made
from walkgen.graph.interpret import interpret
from walkgen.graph.lanes import telling
from walkgen.graph.program import Code, Op
from walkgen.signature import Port


class Lost:
    """The interpreter's numbers, with one function that knows nothing."""

    mpf = float
    sin = staticmethod(math.sin)
    isfinite = staticmethod(math.isfinite)

    def cos(self, _):
        return math.nan

    def atan2(self, _, __):
        return math.nan


def program(*ops, outputs, kinds=("real",)):
    ports = tuple(Port(f"y{place}", (), kind=kind) for place, kind in enumerate(kinds))
    return made("toy", (Port("x", (3,)),), ports, (*inputs(3), *ops), outputs)


ANGLE = Op(Code.ATAN2, (0, 1))  # 3
WRAPPED = (ANGLE, constant(-3), Op(Code.LESS_EQUAL, (3, 4)), constant(3), Op(Code.SELECT, (5, 6, 3)))
TURNED = (ANGLE, constant(3), Op(Code.LESS, (4, 3)), Op(Code.INDICATOR, (5,)), Op(Code.FNMA, (4, 6, 3)))


@pytest.mark.parametrize(
    ("ops", "outputs"), [((ANGLE,), (3,)), (WRAPPED, (7,)), (TURNED, (7,)), ((Op(Code.COS, (2,)), Op(Code.MUL, (3, 0))), (4,))]
)
def test_what_becomes_nan_is_found_out(ops, outputs):
    found = program(*ops, outputs=outputs)
    assert telling(found) == (0,)
    assert all(math.isnan(value) for values in interpret(found, {"x": [1.0, 2.0, 0.5]}, Lost()).values() for value in values)


def test_what_does_not_wait_for_the_angle_is_right():
    found = program(ANGLE, Op(Code.LESS, (0, 1)), constant(0), Op(Code.SELECT, (4, 5, 3)), outputs=(6,))
    assert telling(found) == (0,)
    assert interpret(found, {"x": [1.0, 2.0, 0.5]}, Lost())["y0"] == [0]


@pytest.mark.parametrize(
    ("ops", "outputs", "kinds"),
    [
        ((ANGLE, Op(Code.LESS, (3, 0)), Op(Code.SELECT, (4, 0, 1))), (5,), ("real",)),
        ((ANGLE, constant(-3), Op(Code.LESS_EQUAL, (3, 4)), constant(3), Op(Code.SELECT, (5, 3, 6))), (7,), ("real",)),
        ((ANGLE, Op(Code.MIN, (3, 0))), (4,), ("real",)),
        ((ANGLE, Op(Code.LESS, (0, 3)), Op(Code.INDICATOR, (4,))), (5,), ("real",)),
        ((ANGLE, Op(Code.FINITE, (3,)), Op(Code.INDICATOR, (4,))), (5,), ("integer",)),
        ((Op(Code.TAN, (0,)),), (3,), ("real",)),
    ],
)
def test_what_could_be_wrong_is_refused(ops, outputs, kinds):
    assert telling(program(*ops, outputs=outputs, kinds=kinds)) is None


CHOSEN = (ANGLE, Op(Code.LESS, (0, 1)), constant(0), Op(Code.SELECT, (4, 5, 3)), Op(Code.LESS, (1, 0)), Op(Code.SELECT, (7, 5, 3)))


@pytest.mark.parametrize(
    ("ops", "outputs", "kinds", "expected"),
    [
        ((ANGLE, Op(Code.COS, (2,)), Op(Code.MUL, (3, 4))), (3, 4, 5), ("real",) * 3, (2,)),  # one hears of both
        ((ANGLE, Op(Code.COS, (2,)), Op(Code.NEG, (0,))), (3, 5, 4, 3), ("real",) * 4, (0, 2)),  # one for each, none for what has none
        ((Op(Code.SIN, (0,)), Op(Code.COS, (0,))), (3, 4), ("real",) * 2, (0,)),  # one angle
        ((ANGLE, Op(Code.COS, (3,))), (3, 4), ("real",) * 2, (1,)),  # a sine's angle is another thing than what it comes from
        ((ANGLE, Op(Code.MIN, (3, 0))), (3, 4), ("real",) * 2, (0,)),  # wrong, but told of
        ((ANGLE, Op(Code.FINITE, (3,)), Op(Code.INDICATOR, (4,))), (3, 5), ("real", "integer"), (0,)),
        (CHOSEN, (6, 8, 6), ("real",) * 3, (0, 1)),  # each tells of itself alone
        (CHOSEN, (6, 8, 3), ("real",) * 3, (2,)),
        ((Op(Code.ADD, (0, 1)),), (3,), ("real",), ()),
    ],
)
def test_few_results_tell(ops, outputs, kinds, expected):
    assert telling(program(*ops, outputs=outputs, kinds=kinds)) == expected
