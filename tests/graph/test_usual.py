"""What a Program computes of usual inputs alone: the same there, told of elsewhere, and without the choices that are settled."""

import math
import random

import pytest

from mechanisms.hand_programs import constant, inputs, made
from walkgen.graph.interpret import interpret
from walkgen.graph.passes import pruned
from walkgen.graph.program import Code, Op
from walkgen.graph.usual import for_all, usual, usual_truth
from walkgen.signature import Port

OK, UNREACHABLE, SINGULAR = 0, 1, 3


class Numbers:
    """The interpreter's, in doubles."""

    mpf = float
    sin, cos, atan2, isfinite = (staticmethod(function) for function in (math.sin, math.cos, math.atan2, math.isfinite))


def program(*ops, outputs, statuses=1):
    ports = (Port("y"), Port("status", (statuses,), kind="integer"))
    return made("toy", (Port("x", (3,)),), ports, (*inputs(3), *ops), outputs)


ZERO, ONE, THREE = constant(0), constant(1), constant(3)  # 3, 4, 5
HEAD = (ZERO, ONE, THREE)
CLAMPED = (
    *HEAD,
    Op(Code.LESS, (0, 3)),  # 6: x0 < 0
    Op(Code.SELECT, (6, 3, 0)),  # 7: max(x0, 0)
    Op(Code.LESS, (7, 1)),  # 8: that < x1
    Op(Code.NOT, (6,)),  # 9
    Op(Code.AND, (9, 8)),  # 10: usual
    Op(Code.ATAN2, (7, 1)),  # 11
    Op(Code.OR, (6, 8)),  # 12
    Op(Code.SELECT, (12, 11, 2)),  # 13: settled by a part that holds
    Op(Code.SELECT, (8, 4, 5)),  # 14
    Op(Code.SELECT, (10, 3, 14)),  # 15: the status
)
NEST = (
    *HEAD,
    Op(Code.LESS, (0, 3)),  # 6
    Op(Code.SELECT, (6, 1, 2)),  # 7
    Op(Code.LESS, (7, 3)),  # 8: rests on 6
    Op(Code.SELECT, (8, 7, 0)),  # 9
    Op(Code.LESS, (9, 4)),  # 10: rests on 8 and 6
    Op(Code.OR, (8, 6)),  # 11
    Op(Code.NOT, (11,)),  # 12: neither
    Op(Code.AND, (12, 10)),  # 13: usual
    Op(Code.SIN, (9,)),  # 14
    Op(Code.SELECT, (13, 3, 5)),  # 15
)
PROGRAMS = {"clamped": program(*CLAMPED, outputs=(13, 15)), "one rests on another": program(*NEST, outputs=(14, 15))}


@pytest.mark.parametrize("name", PROGRAMS)
def test_usual_inputs_have_the_same_results_and_others_are_told_of(name):
    whole, found = PROGRAMS[name], usual(PROGRAMS[name])
    draw, told = random.Random(4), set()
    for _ in range(300):
        x = [draw.choice([-1.0, 0.0, 1.0, 0.25, -0.5, 2.0]) for _ in range(3)]
        expected, answer = (interpret(each, {"x": x}, Numbers()) for each in (whole, found))
        told.add(*expected["status"])
        if expected["status"] == [OK]:
            assert answer == expected
        else:
            assert answer["status"] == [UNREACHABLE]
    assert len(told) > 1


@pytest.mark.parametrize("name", PROGRAMS)
def test_choices_that_are_settled_are_gone(name):
    assert usual(PROGRAMS[name]).counts()["select"] == 1


def test_what_decides_comes_before_angles():
    codes = [op.code for op in usual(program(*CLAMPED, outputs=(13, 15))).ops]
    assert codes.index(Code.AND) < codes.index(Code.ATAN2)


def test_several_statuses_are_told_by_the_first():
    whole = program(*CLAMPED, Op(Code.SELECT, (10, 3, 5)), outputs=(13, 15, 16), statuses=2)
    assert interpret(usual(whole), {"x": [0.5, 1.0, 0.0]}, Numbers())["status"] == [OK, OK]
    assert interpret(usual(whole), {"x": [-0.5, 1.0, 0.0]}, Numbers())["status"][0] == UNREACHABLE


@pytest.mark.parametrize(
    ("ops", "outputs"),
    [
        ((*CLAMPED, Op(Code.SELECT, (8, 3, 5))), (13, 15, 16)),  # another truth
        ((*CLAMPED, Op(Code.SELECT, (10, 5, 3))), (13, 15, 16)),  # not OK where it holds
        ((*CLAMPED, Op(Code.MUL, (4, 4))), (13, 15, 16)),  # no choice
        ((*HEAD, Op(Code.ATAN2, (0, 1)), Op(Code.LESS, (6, 3)), *(Op(Code.SELECT, (7, 3, 4)),) * 2), (6, 8, 9)),  # waits for an angle
    ],
)
def test_no_truth_that_is_enough_leaves_the_program_as_it_is(ops, outputs):
    whole = program(*ops, outputs=outputs, statuses=2)
    assert usual_truth(whole) is None
    assert usual(whole) is whole


DOUBTED = (*CLAMPED[:-1], Op(Code.SELECT, (8, 3, 5)), Op(Code.SELECT, (10, 3, 15)))  # 15: OK for usual inputs too


def test_what_is_right_for_all_does_without_the_truth():
    whole = program(*DOUBTED, outputs=(13, 16))
    found = for_all(whole)
    assert found.counts()["select"] == pruned(whole).counts()["select"] - 1
    assert Code.AND not in [op.code for op in found.ops]
    for x in ([0.5, 1.0, 0.0], [-0.5, 1.0, 0.25], [0.5, 0.25, 2.0]):
        assert interpret(found, {"x": x}, Numbers()) == interpret(whole, {"x": x}, Numbers())


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_truth_that_alone_finds_inputs_ok_stays(name):
    assert for_all(PROGRAMS[name]) is PROGRAMS[name]
