"""Batches of functions that take long enough to be called by their address: rows go through one loop for all of a kind (walkgen_each.h)."""

from walkgen.emit.artifact import Body, RobotCode
from walkgen.emit.c_declaration import INDENT, declared, function_name
from walkgen.emit.c_lanes import laned
from walkgen.emit.c_printer import Precision
from walkgen.graph.program import Composite
from walkgen.signature import Port

HEADER = "walkgen_each.h"
_KINDS = frozenset({(1, 1, False), (1, 2, False), (2, 1, False), (3, 1, False), (4, 1, False), (2, 1, True), (3, 1, True), (3, 2, True)})
"""Inputs, outputs and whether there is a status, of the loops that there are."""
_LONG = 60
"""Operations from which on a call by address is not noticed; shorter functions become part of their loops."""


def header(code: RobotCode) -> tuple[str, ...]:
    """The header, for a robot that has such batches."""
    lanes = {each.body for each in laned(code)}
    return (HEADER,) if any(body not in lanes and body not in code.repeated and _has_loop(body) for body in code.functions) else ()


def each_lines(body: Body, precision: Precision) -> tuple[str, ...]:
    """The body of the batch; none where a loop of its own is better."""
    if not _has_loop(body):
        return ()
    signature = body.signature
    arrays = [f"{port.name}, {0 if port.name == 'param' else port.size}" for port in (*signature.inputs, *_arrays(body))]
    told = [signature.returned.name] if signature.returned else []
    loop = _name((len(signature.inputs), len(_arrays(body)), bool(told)), precision)
    call = declared(loop, ["rows", f"&{function_name(signature, precision)}", *arrays, *told]).replace("\n", f"\n{INDENT}")
    return (f"{INDENT}{'return ' if told else ''}{call};",)


def _name(kind: tuple[int, int, bool], precision: Precision) -> str:
    inputs, outputs, told = kind
    name = f"wg_each_{inputs}_{outputs}{'_told' if told else ''}_batch"
    return f"{name}_{precision.tag}" if precision.tag else name


def _arrays(body: Body) -> tuple[Port, ...]:
    return tuple(port for port in body.signature.outputs if port is not body.signature.returned)


def _has_loop(body: Body) -> bool:
    """Of arrays of numbers alone, of sizes that are known, with at most a status that is returned."""
    signature = body.signature
    ports = (*signature.inputs, *_arrays(body))
    plain = all(port.kind == "real" and port.shape and 0 not in port.shape for port in ports) and not signature.counts
    kind = (len(signature.inputs), len(_arrays(body)), signature.returned is not None)
    states = signature.returned is signature.status
    return plain and states and not signature.workspace and kind in _KINDS and _is_long(body)


def _is_long(body: Body) -> bool:
    return isinstance(body, Composite) or body.operation_count >= _LONG
