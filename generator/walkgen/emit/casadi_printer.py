"""Prints a robot's functions as CasADi SX expressions, in one file that needs casadi alone."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from keyword import kwlist

from walkgen.emit.artifact import Artifact, Body, RobotCode
from walkgen.emit.layout import lay_out
from walkgen.emit.python_text import OPERATORS, banner, listing, literal, printable, short_name, summary, title
from walkgen.emit.walker import Form, Text, walk
from walkgen.graph.program import Call, Code, Composite, Op, Program
from walkgen.graph.usual import for_all
from walkgen.signature import Port

_FORMS: Mapping[Code, Form] = {
    **OPERATORS,
    Code.SQRT: Form("ca.sqrt({0})"),
    Code.SIN: Form("ca.sin({0})"),
    Code.COS: Form("ca.cos({0})"),
    Code.TAN: Form("ca.tan({0})"),
    Code.ATAN2: Form("ca.atan2({0}, {1})"),
    Code.ABS: Form("ca.fabs({0})"),
    Code.MIN: Form("_least({0}, {1})"),
    Code.MAX: Form("_greatest({0}, {1})"),
    Code.FINITE: Form("_finite({0})"),
    Code.AND: Form("ca.logic_and({0}, {1})"),
    Code.OR: Form("ca.logic_or({0}, {1})"),
    Code.NOT: Form("ca.logic_not({0})"),
    Code.SELECT: Form("ca.if_else({0}, {1}, {2})"),
    Code.INDICATOR: Form("ca.if_else({0}, 1.0, 0.0)"),
    Code.EPSILON: Form("2.220446049250313e-16"),
}
_HELPERS = frozenset({"ca", "float", "_least", "_greatest", "_finite", "_column", "_rows"})


@dataclass(frozen=True)
class CasadiFunction:
    """One function, ready to be laid out; `lines` are its body, indented."""

    name: str
    doc: tuple[str, ...]
    lines: tuple[str, ...]


@dataclass(frozen=True)
class Absent:
    """A function without a CasADi form, and why."""

    name: str
    reason: str


class CasadiPrinter:
    """How CasADi's SX writes a Program's operations; truth values are 0 and 1."""

    @property
    def forms(self) -> Mapping[Code, Form]:
        """How each operation is written."""
        return _FORMS

    def together(self, angles: int) -> Mapping[Code, str]:
        """Nothing."""
        del angles
        return {}

    @property
    def sums(self) -> tuple[str, str]:
        """As they are: no angles come together."""
        return "{0}", ""

    @property
    def reserved(self) -> frozenset[str]:
        """What a local must not be called."""
        return _HELPERS.union(kwlist)

    def constant(self, value: Decimal) -> Text:
        """The nearest double."""
        return literal(value)

    def element(self, port: Port, index: int) -> Text:
        """`q[0]`, `T[0, 1]`; a scalar is its port."""
        if not port.shape:
            return Text(port.name)
        _, columns = _matrix(port)
        row, column = divmod(index, columns)
        return Text(f"{port.name}[{row}]" if columns == 1 else f"{port.name}[{row}, {column}]")


def casadi_artifact(code: RobotCode) -> Artifact:
    """`<robot>_casadi.py`: a builder a function; what needs an iterative routine and has no closed form is listed with the reason."""
    robot = code.mechanism.name
    forms = [(body, closed_form(body)) for body in code.functions]
    public = code.public
    return lay_out(
        "casadi.py.jinja",
        f"{robot}_casadi.py",
        banner=banner(code),
        robot=robot,
        title=title(code, "CasADi"),
        kernels=[_function(kernel, kernel, public, "_") for kernel in _kernels(form for _, form in forms) if kernel not in public],
        functions=[_function(body, form, public) for body, form in forms if form],
        absent=[Absent(short_name(body.signature), _reason(body)) for body, form in forms if not form],
    )


def closed_form(body: Body) -> Body | None:
    """What CasADi prints: a Program, or a Composite of Programs; None where there is only an iterative routine."""
    if isinstance(body, Composite) and body.calls_routines:
        return body.closed_form
    return body


def _kernels(forms: Iterable[Body | None]) -> tuple[Program, ...]:
    """The Programs inside Composites, each once, in order of first use."""
    calls = (call for form in forms if isinstance(form, Composite) for call in form.calls)
    found: dict[str, Program] = {}
    for program in (call.callee for call in calls if isinstance(call.callee, Program)):
        if found.setdefault(program.signature.full_name, program) != program:
            raise AssertionError(f"two kernels are called {program.signature.full_name}")
    return tuple(found.values())


def residues_kept(program: Program) -> Program:
    """The Program with x - x, which is NaN unless x is finite, written as a choice: SX would make it 0."""
    ops: list[Op] = []
    position: list[int] = []
    for op in program.ops:
        arguments = tuple(position[number] for number in op.arguments)
        if op.code is Code.SUB and arguments[0] == arguments[1]:
            ops += [Op(Code.FINITE, arguments[:1]), Op(Code.CONSTANT), Op(Code.CONSTANT, value=Decimal("NaN"))]
            ops.append(Op(Code.SELECT, tuple(range(len(ops) - 3, len(ops))), name=op.name))
        else:
            ops.append(op._replace(arguments=arguments))
        position.append(len(ops) - 1)
    return replace(program, ops=tuple(ops), outputs=tuple(position[number] for number in program.outputs))


def _reason(body: Body) -> str:
    calls: tuple[Call, ...] = body.calls if isinstance(body, Composite) else ()
    routines = sorted({call.callee for call in calls if isinstance(call.callee, str)})
    return printable(f"it needs the iterative {' and '.join(routines)}" if routines else "it has no closed form")


def _function(body: Body, form: Body, public: Collection[Program], prefix: str = "") -> CasadiFunction:
    signature = body.signature
    symbols = tuple(_symbol(port, "MX" if _repeats(form) else "SX") for port in form.signature.inputs)
    lines = _composite_lines(form, public) if isinstance(form, Composite) else _program_lines(form)
    inputs, results = (", ".join(port.name for port in ports) for ports in (form.signature.inputs, form.signature.outputs))
    given, named = (_names(ports) for ports in (signature.inputs, signature.outputs))
    closing = listing("return ca.Function(", (f'"{signature.full_name}"', f"[{inputs}]", f"[{results}]", given, named), ")")
    return CasadiFunction(prefix + short_name(signature), summary(body), (*symbols, *lines, *closing))


def _program_lines(program: Program) -> Iterator[str]:
    text = walk(residues_kept(for_all(program)), CasadiPrinter())
    yield from (f"    {statement.name} = {statement.text}" for statement in text.statements)
    outputs = iter(output.text for output in text.outputs)
    for port in program.signature.outputs:
        yield from _output(port, [next(outputs) for _ in range(port.size)])


def _repeats(form: Body) -> bool:
    """Whether a kernel is called many times: MX keeps the calls, SX would write each of them out."""
    return isinstance(form, Composite) and any(call.repeat > 1 for call in form.calls)


def _composite_lines(composite: Composite, public: Collection[Program]) -> Iterator[str]:
    """The kernels' calls."""
    for call in composite.calls:
        assert isinstance(call.callee, Program), composite.signature.full_name
        count = len(call.callee.signature.inputs)
        arguments = [str(argument) for argument in call.arguments]
        name = short_name(call.callee.signature)
        function = f'_built("{name}")' if call.callee in public else f"_{name}()"
        step = f"[{', '.join(arguments[count:])}] = {function}.call([{', '.join(arguments[:count])}])"
        if call.repeat > 1:
            yield f"    for _ in range({call.repeat}):"
        yield f"    {'    ' * (call.repeat > 1)}{step}"


def _names(ports: tuple[Port, ...]) -> str:
    return "[" + ", ".join(f'"{port.name}"' for port in ports) + "]"


def _symbol(port: Port, kind: str) -> str:
    rows, columns = _matrix(port)
    return f'    {port.name} = ca.{kind}.sym("{port.name}", {rows}, {columns})'


def _output(port: Port, elements: list[str]) -> tuple[str, ...]:
    rows, columns = _matrix(port)
    if columns == 1:
        return listing(f"{port.name} = _column([", elements, "])")
    return listing(f"{port.name} = _rows({rows}, {columns}, [", elements, "])")


def _matrix(port: Port) -> tuple[int, int]:
    """CasADi's shape: [n] is a column, [first, rest] for more than two dimensions."""
    rows = port.sizes[0] if port.shape else 1
    return rows, port.size // rows
