"""Code that occurs twice is written once: functions of equal legs call the first of them, and so do kernels that compute the same."""

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import replace

from walkgen.graph.program import Call, Code, Composite, Program

Body = Program | Composite

_SHORT = 24
"""Operations up to which a function without sines keeps its own text: a call would cost as much as it saves."""
_LONG = frozenset({Code.SIN, Code.COS, Code.TAN, Code.ATAN2})
"""What compilers write out in dozens of instructions."""


def shared(bodies: Sequence[Body]) -> tuple[Body, ...]:
    """The same functions, with the code of each Program once.

    A public Program that repeats an earlier one calls it; a Composite's kernels are public Programs wherever one has the same code
    and shapes, else the first kernel that has.

    Args:
        bodies: all functions of a robot. Programs with a status are called by nobody: what they return differs from a kernel.
    """
    first: dict[Hashable, Program] = {}
    for program in (body for body in bodies if isinstance(body, Program) and body.signature.returned is None):
        first.setdefault(nameless(program), program)
    for kernel in (call.callee for body in bodies if isinstance(body, Composite) for call in _every_call(body)):
        if isinstance(kernel, Program):
            first.setdefault(nameless(kernel), kernel)
    return tuple(_calling(body, first) if isinstance(body, Composite) else _like_first(body, first) for body in bodies)


def _every_call(composite: Composite) -> Iterator[Call]:
    yield from composite.all_calls
    if isinstance(composite.closed_form, Composite):
        yield from _every_call(composite.closed_form)


def _like_first(program: Program, first: dict[Hashable, Program]) -> Body:
    """The Program, or a call of the public one that it repeats."""
    signature = program.signature
    if signature.returned is not None or _is_short(program) or first[nameless(program)] == program:
        return program
    names = tuple(port.name for port in (*signature.inputs, *signature.outputs))
    return Composite(signature, (), (Call(first[nameless(program)], names),), ())


def _calling(composite: Composite, first: dict[Hashable, Program]) -> Composite:
    closed = composite.closed_form
    closed = _calling(closed, first) if isinstance(closed, Composite) else closed
    calls = tuple(_redirected(call, first) for call in composite.calls)
    callbacks = tuple(_calling(callback, first) for callback in composite.callbacks)
    return replace(composite, calls=calls, closed_form=closed, callbacks=callbacks)


def _redirected(call: Call, first: dict[Hashable, Program]) -> Call:
    return call if isinstance(call.callee, str) else replace(call, callee=first[nameless(call.callee)])


def repeated(bodies: Sequence[Body]) -> dict[Body, Body]:
    """The functions that do what an earlier one does, port by port, each with that one: its code serves for both.

    Args:
        bodies: all functions of a robot, as `shared` gives them.
    """
    public = {body for body in bodies if isinstance(body, Program)}
    first: dict[Hashable, Body] = {}
    found = {body: _called_alone(body, public) or first.setdefault(_ownerless(body), body) for body in bodies}
    return {body: earlier for body, earlier in found.items() if earlier is not body}


def _called_alone(body: Body, public: set[Program]) -> Program | None:
    """The public Program that a function does nothing but call, port by port; None of all others."""
    if not isinstance(body, Composite) or len(body.calls) != 1:
        return None
    call = body.calls[0]
    names = tuple(port.name for port in (*body.signature.inputs, *body.signature.outputs))
    alone = call.guard is None and call.repeat == 1 and call.arguments == names
    return call.callee if alone and isinstance(call.callee, Program) and call.callee in public else None


def _ownerless(body: Body) -> Hashable:
    """What is equal where one function may stand for the other; of short ones and of those that give their callbacks names, themselves."""
    signature = body.signature
    ports = (signature.inputs, signature.outputs, signature.workspace)
    if isinstance(body, Program):
        return body if _is_short(body) else (*ports, nameless(body))
    return body if body.callbacks else (*ports, body.locals, body.calls, body.tables)


def _is_short(program: Program) -> bool:
    return program.operation_count <= _SHORT and _LONG.isdisjoint(op.code for op in program.ops)


def nameless(program: Program) -> Hashable:
    """Everything of a Program but names: equal where code can be shared."""
    signature = program.signature
    ports = tuple((port.shape, port.kind) for port in (*signature.inputs, *signature.outputs))
    nameless = tuple(op[:-1] for op in program.ops)
    return len(signature.inputs), ports, nameless, program.outputs
