"""What is a part of another Program, by the values of outputs of the same name."""

from dataclasses import replace

import pytest

from mechanisms.hand_programs import inputs, made
from walkgen.graph.parts import parts
from walkgen.graph.program import Code, Op
from walkgen.signature import Port

X, P, J, K = Port("x", (2,)), Port("p"), Port("J", (2,)), Port("K", (2,))
SINE, PRODUCT, SUM = Op(Code.SIN, (0,)), Op(Code.MUL, (2, 1)), Op(Code.ADD, (3, 0))


def program(outputs, *ops, results, given=(X,)):
    return made("toy", given, outputs, (*inputs(2), *ops), results)


PART = program((P,), SINE, PRODUCT, SUM, results=(4,))
WHOLE = program((P, J), Op(Code.COS, (1,)), SINE, Op(Code.MUL, (3, 1)), Op(Code.ADD, (4, 0)), results=(5, 2, 4))


def test_the_whole_is_found_whatever_the_order_of_its_operations():
    assert parts([PART, WHOLE], [PART, WHOLE]) == {PART: WHOLE}


def test_of_several_the_least_is_chosen():
    larger = program((P, J, K), SINE, PRODUCT, SUM, *[Op(Code.ADD, (4, 4 + n)) for n in range(5)], results=(4, 0, 1, 2, 9))
    assert parts([PART], [larger, WHOLE]) == {PART: WHOLE}
    assert parts([PART], [larger]) == {PART: larger}


OTHER_VALUE = program((P, J), SINE, PRODUCT, Op(Code.SUB, (3, 0)), results=(4, 2, 3))
OTHER_INPUTS = program((P, J), SINE, PRODUCT, SUM, results=(4, 2, 3), given=(Port("y", (2,)),))
OTHER_OWNER = replace(WHOLE, signature=replace(WHOLE.signature, owner="left"))
OTHER_NAME = replace(WHOLE, signature=replace(WHOLE.signature, outputs=(Port("r"), J)))
WITH_STATUS = program((P, J, Port("status", kind="integer")), SINE, PRODUCT, SUM, results=(4, 2, 3, 0))


@pytest.mark.parametrize("other", [OTHER_VALUE, OTHER_INPUTS, OTHER_OWNER, OTHER_NAME, WITH_STATUS])
def test_others_are_no_wholes(other):
    assert parts([PART], [PART, other]) == {}
