"""Kernels that compute what a public function computes are that function: one text instead of two."""

from collections.abc import Hashable, Sequence
from dataclasses import replace

from walkgen.graph.program import Call, Composite, Program

Body = Program | Composite


def shared(bodies: Sequence[Body]) -> tuple[Body, ...]:
    """The same functions, their Composites calling public Programs wherever one has the same code and shapes.

    Args:
        bodies: all functions of a robot. Programs with a status are called by nobody: what they return differs from a kernel.
    """
    public = {_key(body): body for body in bodies if isinstance(body, Program) and body.signature.returned is None}
    return tuple(_calling(body, public) if isinstance(body, Composite) else body for body in bodies)


def _calling(composite: Composite, public: dict[Hashable, Program]) -> Composite:
    closed = composite.closed_form
    closed = _calling(closed, public) if isinstance(closed, Composite) else closed
    calls = tuple(_redirected(call, public) for call in composite.calls)
    callbacks = tuple(_calling(callback, public) for callback in composite.callbacks)
    return replace(composite, calls=calls, closed_form=closed, callbacks=callbacks)


def _redirected(call: Call, public: dict[Hashable, Program]) -> Call:
    return call if isinstance(call.callee, str) else replace(call, callee=public.get(_key(call.callee), call.callee))


def _key(program: Program) -> Hashable:
    """Everything but names."""
    signature = program.signature
    ports = tuple((port.shape, port.kind) for port in (*signature.inputs, *signature.outputs))
    nameless = tuple(op._replace(name="") for op in program.ops)
    return len(signature.inputs), ports, nameless, program.outputs
