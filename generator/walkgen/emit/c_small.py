"""What functions leave to one another where room counts more than time (WALKGEN_SMALL)."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from walkgen.emit.artifact import Body, RobotCode
from walkgen.emit.c_declaration import INDENT, CFunction, function_name, port_type, wrapped
from walkgen.emit.c_printer import Precision
from walkgen.graph.parts import parts
from walkgen.graph.program import Composite, Program
from walkgen.signature import Port, Signature

_POSE, _AT_REST = ("q", "param"), ("qd", "qdd", "f")
"""Inputs of efforts; the latter are zero at rest, where efforts are a constant of the pose and what is linear in qdd."""
_SCALES = {"": "0x1p100", "f32": "0x1p60"}
"""Accelerations beside which efforts at rest are less than a rounding, by the precision's tag; powers of 2, which products keep exact."""


@dataclass(frozen=True)
class Small:
    """The ways round of one robot: of a Program its whole, of all branches of an inverse one after the other, of masses efforts."""

    code: RobotCode
    kernels: frozenset[Program]
    precision: Precision

    def answered(self, body: Body, function: CFunction) -> CFunction:
        """The function with its way round, if it has one."""
        return function if body in self.code.repeated else replace(function, small=tuple(self._lines(body)))

    def _lines(self, body: Body) -> Iterator[str]:
        signature = body.signature
        if isinstance(body, Program) and body in self._wholes:
            yield from self._part(signature, self._wholes[body].signature)
        elif signature.name == "inverse" and (branch := self._sibling(body, "inverse_branch")) and _shares_nothing(body, branch):
            yield from self._branch_after_branch(signature, branch.signature)
        elif signature.name == "mass_matrix" and (efforts := self._sibling(body, "inverse_dynamics")):
            yield from self._column_after_column(signature, efforts.signature)

    @cached_property
    def _wholes(self) -> dict[Program, Program]:
        own = [program for program in self.code.public if program not in self.code.repeated]
        return parts((*own, *self.kernels), own)

    def _sibling(self, body: Body, name: str) -> Body | None:
        wanted = replace(body.signature, name=name).full_name
        return next((each for each in self.code.functions if each.signature.full_name == wanted), None)

    def _part(self, part: Signature, whole: Signature) -> Iterator[str]:
        for port in whole.outputs:
            if port not in part.outputs:
                yield f"{INDENT}{port_type(port, self.precision)} {port.name}{f'[{port.size}]' if port.shape else ''};"
        outputs = [port.name if port.shape or port in part.outputs else f"&{port.name}" for port in whole.outputs]
        yield from self._call(whole, [*(port.name for port in whole.inputs), *outputs])

    def _branch_after_branch(self, inverse: Signature, branch: Signature) -> Iterator[str]:
        q, status = inverse.outputs
        (one,) = (port for port in branch.outputs if port.name == q.name)
        inputs = ", ".join(port.name for port in branch.inputs)
        yield f"{INDENT}int32_t ok = 0;"
        yield f"{INDENT}for (int32_t branch = 0; branch < {status.size}; ++branch) {{"
        yield f"{INDENT * 2}{status.name}[branch] = {function_name(branch, self.precision)}({inputs}, {q.name} + branch * {one.size});"
        yield f"{INDENT * 2}ok += {status.name}[branch] == WALKGEN_OK;"
        yield f"{INDENT}}}"
        yield f"{INDENT}return ok;"

    def _column_after_column(self, masses: Signature, efforts: Signature) -> Iterator[str]:
        """Efforts at rest, then those of one acceleration after the other, so large that all else is lost beside it."""
        (M,), (tau,), real = masses.outputs, efforts.outputs, self.precision.real
        scale, none = f"WG_C({_SCALES[self.precision.tag]})", max(port.size for port in efforts.inputs if port.name in _AT_REST)
        at_rest, one = (_moved(efforts.inputs, qdd) for qdd in ("zero", f"zero + {none}"))
        yield f"{INDENT}{real} zero[{none + tau.size}] = {{0}}, rest[{tau.size}];"
        yield from self._call(efforts, [*at_rest, "rest"])
        yield f"{INDENT}for (int column = 0; column < {tau.size}; ++column) {{"
        yield f"{INDENT * 2}zero[{none} + column] = {scale};"
        yield from (INDENT + line for line in self._call(efforts, [*one, f"{M.name} + {tau.size} * column"]))
        yield f"{INDENT * 2}zero[{none} + column] = WG_C(0.0);"
        yield f"{INDENT * 2}for (int row = 0; row <= column; ++row) {{"
        here, mirrored = (f"{M.name}[{tau.size} * {first} + {second}]" for first, second in (("column", "row"), ("row", "column")))
        yield f"{INDENT * 3}{mirrored} = {here} = ({here} - rest[row]) / {scale};"
        yield f"{INDENT * 2}}}"
        yield f"{INDENT}}}"

    def _call(self, signature: Signature, arguments: list[str]) -> list[str]:
        call = f"{function_name(signature, self.precision)}({', '.join(arguments)});"
        return wrapped(call)


def _moved(inputs: tuple[Port, ...], qdd: str) -> list[str]:
    """Arguments of efforts at rest but for `qdd`."""
    assert {port.name for port in inputs} <= {*_POSE, *_AT_REST}
    return [qdd if port.name == "qdd" else port.name if port.name in _POSE else "zero" for port in inputs]


def _shares_nothing(inverse: Body, branch: Body) -> bool:
    """Whether one branch comes from a Program of its own, not from a choice among all."""
    if not isinstance(inverse, Composite) or not isinstance(branch, Composite):
        return False
    first, other = inverse.calls[0].callee, branch.calls[0].callee
    return isinstance(first, Program) and isinstance(other, Program) and first not in [call.callee for call in branch.calls]
