"""Value numbering: equal operations get one number, constants fold at 50 digits, signs move outwards."""

from decimal import Context, Decimal

from walkgen.graph.program import Code, Op
from walkgen.signature import Signature

_CONTEXT = Context(prec=50)
_COMMUTATIVE = frozenset({Code.ADD, Code.MUL})
_FOLDED = {Code.ADD: _CONTEXT.add, Code.SUB: _CONTEXT.subtract, Code.MUL: _CONTEXT.multiply, Code.DIV: _CONTEXT.divide}
_ONE, _ZERO = Decimal(1), Decimal(0)


class Numbering:
    """Grows the ops of one Program; asking twice for the same value gives the same number."""

    def __init__(self, signature: Signature) -> None:
        self._ops: list[Op] = []
        self._known: dict[tuple[object, ...], int] = {}
        self._names: dict[int, str] = {}
        for port, declared in enumerate(signature.inputs):
            for element in range(declared.size):
                self._append(Op(Code.INPUT, element=(port, element)), (Code.INPUT, port, element))

    @property
    def ops(self) -> tuple[Op, ...]:
        """The ops so far, with their names."""
        return tuple(Op(op.code, op.arguments, op.element, op.value, self._names.get(number, "")) for number, op in enumerate(self._ops))

    def constant(self, value: Decimal) -> int:
        """The number of a constant; equal values share it."""
        value = _ZERO if value == 0 else value
        key = (Code.CONSTANT, value)
        known = self._known.get(key)
        return self._append(Op(Code.CONSTANT, value=value), key) if known is None else known

    def named(self, number: int, name: str) -> int:
        """Remember the derivation's first name of a computed value."""
        if self._ops[number].code not in (Code.INPUT, Code.CONSTANT):
            self._names.setdefault(number, name)
        return number

    def op(self, code: Code, *arguments: int) -> int:
        """The number of an operation on earlier numbers, simplified where that is exact."""
        simpler = self._signs(code, arguments)
        if simpler is None:
            simpler = self._identities(code, arguments)
        return self._share(code, arguments) if simpler is None else simpler

    def _share(self, code: Code, arguments: tuple[int, ...]) -> int:
        ordered = tuple(sorted(arguments)) if code in _COMMUTATIVE else arguments
        key = (code, ordered)
        known = self._known.get(key)
        return self._append(Op(code, ordered), key) if known is None else known

    def _append(self, op: Op, key: tuple[object, ...]) -> int:
        self._ops.append(op)
        return self._known.setdefault(key, len(self._ops) - 1)

    def _value(self, number: int) -> Decimal | None:
        op = self._ops[number]
        return op.value if op.code is Code.CONSTANT else None

    def _negated(self, number: int) -> int | None:
        """What the number is the negative of, if it is a negation."""
        op = self._ops[number]
        return op.arguments[0] if op.code is Code.NEG else None

    def _identities(self, code: Code, arguments: tuple[int, ...]) -> int | None:
        values = [self._value(number) for number in arguments]
        if code in _FOLDED and None not in values:
            left, right = (value or _ZERO for value in values)
            return self.constant(_FOLDED[code](left, right))
        if code is Code.NEG and values[0] is not None:
            return self.constant(values[0].copy_negate())
        return self._neutral(code, arguments, values)

    def _neutral(self, code: Code, arguments: tuple[int, ...], values: list[Decimal | None]) -> int | None:
        """What adding 0 or multiplying by 1 or 0 leaves."""
        if code is Code.ADD and _ZERO in values:
            return arguments[1 - values.index(_ZERO)]
        if code in (Code.SUB, Code.DIV) and values[1] == (_ZERO if code is Code.SUB else _ONE):
            return arguments[0]
        if code is Code.SUB and values[0] == _ZERO:
            return self.op(Code.NEG, arguments[1])
        if code is Code.MUL and _ONE in values:
            return arguments[1 - values.index(_ONE)]
        return self.constant(_ZERO) if code is Code.MUL and _ZERO in values else None

    def _signs(self, code: Code, arguments: tuple[int, ...]) -> int | None:
        """Negations move out of products and into sums, so that x and -x share their work."""
        inner = [self._negated(number) for number in arguments]
        if all(number is None for number in inner):
            return self._reversed(code, arguments)
        if code is Code.NEG or code is Code.COS:
            return inner[0] if code is Code.NEG else self.op(Code.COS, inner[0] or 0)
        if code is Code.SIN:
            return self.op(Code.NEG, self.op(Code.SIN, inner[0] or 0))
        if code in (Code.MUL, Code.DIV):
            bare = [number if negated is None else negated for number, negated in zip(arguments, inner, strict=True)]
            product = self.op(code, *bare)
            return product if None not in inner else self.op(Code.NEG, product)
        return self._sum_signs(code, arguments, inner)

    def _reversed(self, code: Code, arguments: tuple[int, ...]) -> int | None:
        """-(a - b) is b - a."""
        if code is Code.NEG and self._ops[arguments[0]].code is Code.SUB:
            first, second = self._ops[arguments[0]].arguments
            return self.op(Code.SUB, second, first)
        return None

    def _sum_signs(self, code: Code, arguments: tuple[int, ...], inner: list[int | None]) -> int | None:
        if code not in (Code.ADD, Code.SUB):
            return None
        (left, right), (left_inner, right_inner) = arguments, inner
        if right_inner is not None:
            return self.op(Code.SUB if code is Code.ADD else Code.ADD, left, right_inner)
        if left_inner is None:
            return None
        if code is Code.ADD:
            return self.op(Code.SUB, right, left_inner)
        return self.op(Code.NEG, self.op(Code.ADD, left_inner, right))
