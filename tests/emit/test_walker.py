"""The walk: what gets a name, what is inlined, in which order, and that size does not matter."""

from c_bench import Builder

from walkgen.emit.c_printer import DOUBLE, CPrinter
from walkgen.emit.walker import Body, identifier, walk
from walkgen.graph.program import Code, Program
from walkgen.signature import Port

Q = Port("q", (3,), "rad")
PRINTER = CPrinter(DOUBLE, fma=True)


def walked(builder: Builder, *values: int) -> Body:
    return walk(builder.program("f", [Port("p", (len(values),))], values), PRINTER)


def lines(body: Body) -> list[str]:
    return [f"{statement.name} = {statement.text}" for statement in body.statements]


def test_single_use_is_inlined_with_the_fewest_brackets():
    b = Builder(Q)
    total = b.add(Code.MUL, b.add(Code.ADD, 0, 1), b.add(Code.SUB, b.add(Code.MUL, 1, 2), b.add(Code.SUB, 0, 2)))
    body = walked(b, total)
    assert lines(body) == []
    assert body.outputs[0].text == "(q[0] + q[1])*(q[1]*q[2] - (q[0] - q[2]))"


def test_brackets_keep_the_order_of_rounding():
    b = Builder(Q)
    right_sum = b.add(Code.ADD, 0, b.add(Code.ADD, 1, 2))
    right_product = b.add(Code.MUL, 0, b.add(Code.DIV, 1, 2))
    assert [text.text for text in walked(b, right_sum, right_product).outputs] == ["q[0] + (q[1] + q[2])", "q[0]*(q[1]/q[2])"]


def test_signs_never_meet():
    b = Builder(Q)
    twice = b.add(Code.NEG, b.add(Code.NEG, 0))
    less_negative = b.add(Code.SUB, 0, b.constant("-0.5"))
    fused = b.add(Code.FNMA, b.constant("-2"), 1, b.add(Code.NEG, 2))
    texts = [text.text for text in walked(b, twice, less_negative, fused).outputs]
    assert texts == ["-(-q[0])", "q[0] - -0.5", "WG_FMA(-(-2.0), q[1], -q[2])"]


def test_shared_and_named_values_become_statements_once():
    b = Builder(Q)
    shared = b.add(Code.MUL, 0, 1)
    named = b.add(Code.ADD, shared, 2, name="knee.x-2")
    body = walked(b, b.add(Code.ADD, shared, named))
    assert lines(body) == ["t1 = q[0]*q[1]", "knee_x_2 = t1 + q[2]"]
    assert body.outputs[0].text == "t1 + knee_x_2"


def test_names_are_unique_and_never_keywords_ports_or_libm():
    b = Builder(Q)
    names = ["x", "x", "q", "p", "sin", "int", "template", "9lives", "Ünï", "t1"]
    values = [b.add(Code.MUL, 0, b.add(Code.ADD, 1, 2), name=name) for name in names]
    found = [statement.name for statement in walked(b, *values).statements]
    assert found == ["x", "x_2", "q_2", "p_2", "sin_2", "int_2", "template_2", "v9lives", "n", "t1"]


def test_identifier_cannot_smuggle_anything():
    assert identifier('"; system("rm") //') == "system_rm"
    assert identifier("__a__b__") == "a_b"
    assert identifier("é") == ""


def test_sine_and_cosine_of_one_angle_stand_side_by_side():
    b = Builder(Q)
    sine = b.add(Code.SIN, 0)
    product = b.add(Code.MUL, sine, 1, name="product")
    cosine = b.add(Code.COS, 0)
    body = walked(b, b.add(Code.ADD, product, cosine))
    assert lines(body) == ["sin_q0 = WG_SIN(q[0])", "cos_q0 = WG_COS(q[0])", "product = sin_q0*q[1]"]


def test_unused_operations_are_dropped():
    b = Builder(Q)
    b.add(Code.SIN, 0, name="unused")
    body = walked(b, b.add(Code.ADD, 1, 2))
    assert lines(body) == []


def test_an_output_may_be_an_input_a_constant_or_repeated():
    b = Builder(Q)
    product = b.add(Code.MUL, 0, 1)
    body = walked(b, 0, b.constant("0"), product, product)
    assert [text.text for text in body.outputs] == ["q[0]", "0.0", "t1", "t1"]


def test_truth_values_are_told_from_numbers():
    b = Builder(Q)
    less = b.add(Code.LESS, 0, 1, name="below")
    body = walked(b, b.add(Code.SELECT, less, 0, 1))
    assert body.statements[0].truth
    assert body.outputs[0].text == "WG_SELECT(below, q[0], q[1])"


def test_after_says_when_an_output_can_be_written():
    b = Builder(Q)
    first = b.add(Code.MUL, 0, 1, name="first")
    second = b.add(Code.MUL, 1, 2, name="second")
    body = walked(b, first, 0, b.add(Code.ADD, second, first))
    assert [text.after for text in body.outputs] == [1, 0, 2]


def test_angles_that_wait_for_nothing_of_each_other_are_one_statement():
    b = Builder(Q)
    angle = b.add(Code.ADD, 0, 1)
    sine, cosine, other = b.add(Code.SIN, 0), b.add(Code.COS, 0, name="c"), b.add(Code.COS, angle)
    body = walked(b, b.add(Code.MUL, b.add(Code.ADD, sine, cosine), other))
    assert [statement.text for statement in body.statements] == ["WG_SINCOS_2(q[0], sin_q0, c, WG_PART(q[0] + q[1], q[1]), t1, t2)"]
    assert body.statements[0].then == ("WG_TURN(t1, t2, sin_q0, c)",)
    assert body.statements[0].names == ("sin_q0", "c", "t1", "t2")
    assert body.statements[0].idle == ("t1",)
    assert body.outputs[0].text == "(sin_q0 + c)*t2"


def test_sums_of_angles_stand_as_parts_too_each_turned_after_what_turns_it():
    b = Builder(Q)
    back = b.add(Code.SUB, 0, 1, name="back")
    onward = b.add(Code.ADD, 2, back, name="onward")
    last, middle, first = (b.add(Code.SIN, angle) for angle in (onward, back, 0))
    body = walked(b, b.add(Code.MUL, b.add(Code.MUL, last, middle), first))
    *_, together = body.statements
    assert together.text == "WG_SINCOS_3(WG_PART(onward, q[2]), t1, t2, WG_PART(back, -q[1]), t3, t4, q[0], sin_q0, cos_q0)"
    assert together.then == ("WG_TURN(t3, t4, sin_q0, cos_q0)", "WG_TURN(t1, t2, t3, t4)")


def test_what_an_angle_is_taken_from_is_no_part_of_it():
    b = Builder(Q)
    angle = b.add(Code.SUB, 0, 1)
    body = walked(b, b.add(Code.MUL, b.add(Code.SIN, 1), b.add(Code.SIN, angle)))
    assert (body.statements[0].text, body.statements[0].then) == ("WG_SINCOS_2(q[1], sin_q1, cos_q1, q[0] - q[1], t1, t2)", ())


def test_angles_whose_arguments_come_later_stay_apart():
    b = Builder(Q)
    first = b.add(Code.SIN, 0)
    second = b.add(Code.SIN, b.add(Code.ADD, 1, 2))
    body = walked(b, b.add(Code.MUL, first, second))
    assert [statement.text for statement in body.statements] == ["WG_SIN(q[0])", "WG_SIN(q[1] + q[2])"]


def test_arctangents_too():
    b = Builder(Q)
    one, two = b.add(Code.ATAN2, 0, 1, name="yaw"), b.add(Code.ATAN2, 1, 2)
    body = walked(b, b.add(Code.SUB, one, two))
    assert [statement.text for statement in body.statements] == ["WG_ATAN2_2(q[0], q[1], yaw, q[1], q[2], t1)"]


def long_program(count: int) -> Program:
    """A chain of single-use operations, as deep as it is long."""
    b = Builder(Q)
    value = 0
    for step in range(count):
        value = b.add((Code.ADD, Code.MUL, Code.SUB)[step % 3], value, 1 + step % 2)
    return b.program("long", [Port("p", (1,))], [value])


def test_depth_and_width_stay_readable_however_long_the_program():
    body = walk(long_program(10_000), PRINTER)
    assert len(body.statements) > 1000
    assert max(len(text) for text in lines(body)) <= 110
    assert max(statement.text.count("(") for statement in body.statements) <= 6
