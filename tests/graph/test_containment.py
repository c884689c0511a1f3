"""What a Program with more outputs computes as well, by the same names, is contained in it."""

from mechanisms.hand_programs import inputs, made
from walkgen.graph.containment import contained
from walkgen.graph.program import Code, Op
from walkgen.signature import Port

X = Port("x", (3,))


def test_contained_in_a_program_with_more_outputs():
    ops = (*inputs(3), Op(Code.SIN, (0,)), Op(Code.MUL, (3, 1)), Op(Code.MUL, (3, 2)))
    y, z, w = (Port(name, (1,)) for name in "yzw")
    small = made("small", (X,), (y,), ops, (4,))
    other = made("other", (X,), (y,), ops, (5,))
    both = made("both", (X,), (z, y), ops, (5, 4))
    more = made("more", (X,), (y, z, w), ops, (4, 5, 3))
    assert contained(small, (small, other, more, both)) is both
    assert contained(small, (other, more)) is more
    assert contained(both, (small, other, both)) is None
    assert contained(other, (both, more)) is None


def test_the_order_of_operations_does_not_matter():
    y, z = (Port(name, (1,)) for name in "yz")
    small = made("small", (X,), (y,), (*inputs(3), Op(Code.SIN, (1,))), (3,))
    both = made("both", (X,), (y, z), (*inputs(3), Op(Code.COS, (0,)), Op(Code.SIN, (1,))), (4, 3))
    assert contained(small, (both,)) is both
