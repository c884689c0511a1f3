"""What a Composite does only for some rows, as C functions of their own: the other rows do not pay for its locals and calls."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from walkgen.emit.c_declaration import declared, function_name, parameters
from walkgen.emit.c_printer import Precision
from walkgen.graph.passes import ANGULAR
from walkgen.graph.program import Call, Composite, Guard, Program
from walkgen.graph.routines import ROUTINES
from walkgen.graph.usual import usual_truth
from walkgen.signature import Port


@dataclass(frozen=True)
class Rest:
    """Calls that one guard lets through, as a Composite without guards whose outputs are all that they share with `whole`.

    A status that the whole returns is given by value and returned. One that is `anew` does all that the whole does, from its arguments
    alone, and returns what it returns: called last, it leaves the whole nothing to keep over a call, and no registers to save.
    """

    whole: Composite
    body: Composite
    guard: Guard
    number: int
    anew: bool = False

    def name(self, precision: Precision) -> str:
        """`<function>_rest`, numbered from the second on."""
        return f"{function_name(self.whole.signature, precision)}_rest{f'_{self.number}' if self.number > 1 else ''}"

    def head(self, precision: Precision) -> str:
        """Its declaration, which keeps it out of the function that calls it."""
        signature = self.body.signature
        given = parameters(signature.inputs, (), precision) + [f"int32_t {port.name}" for port in self._given]
        written = parameters((), tuple(port for port in signature.outputs if port not in self.returned), precision)
        kind = "int32_t" if self.returned or self.counts else "void"
        return declared(f"WG_CALLED {kind} {self.name(precision)}", [*given, *written])

    def call(self, precision: Precision) -> str:
        """The statement that runs it."""
        result = "".join(f"{port.name} = " for port in self.returned)
        return f"{result}{self.called(precision)};"

    def called(self, precision: Precision) -> str:
        """The call alone."""
        scalars = {port.name for port in self.whole.locals if not port.shape}
        outputs = (port.name for port in self.body.signature.outputs if port not in self.returned)
        names = [port.name for port in (*self.body.signature.inputs, *self._given)]
        names += [f"&{name}" if name in scalars else name for name in outputs]
        return f"{self.name(precision)}({', '.join(names)})"

    @property
    def returned(self) -> tuple[Port, ...]:
        """The status, if it writes one that the whole returns."""
        returned = self.whole.signature.returned
        return (returned,) if returned and returned in self.body.signature.outputs else ()

    @property
    def counts(self) -> bool:
        """Whether it returns how many statuses are OK."""
        return self.anew and not self.returned

    @property
    def _given(self) -> tuple[Port, ...]:
        return () if self.anew else self.returned


def may_leave(composite: Composite) -> Program | None:
    """The Program with angles that is all the Composite does, unless a status is UNREACHABLE: the only one, or the first of those that the
    Program tells by one truth.
    """
    first, *others = in_order(composite)
    status = composite.signature.status
    if not (isinstance(first, Call) and isinstance(first.callee, Program) and first.repeat == 1 and first.guard is None and status):
        return None
    if len(others) != 1 or not isinstance(others[0], Rest) or others[0].guard != ("wg_any_unreachable", (status.name, status.size)):
        return None
    told = dict(zip(first.arguments[len(first.callee.signature.inputs) :], first.callee.signature.outputs, strict=True)).get(status.name)
    alike = not status.shape or usual_truth(first.callee) is not None
    turns = any(op.code in ANGULAR for op in first.callee.ops)
    return first.callee if told and told.name == "status" and alike and turns else None


def in_order(composite: Composite, *, leaves: bool = False) -> tuple[Call | Rest, ...]:
    """Its calls, those that stand under one guard together; where the first one leaves, they begin with it anew."""
    groups: list[list[Call]] = []
    for call in composite.calls:
        if groups and _joins(groups[-1], call):
            groups[-1].append(call)
        else:
            groups.append([call])
    if leaves:
        (first,), group = groups
        return (first, _anew(composite, first, group))
    return tuple(_steps(composite, groups))


def _steps(composite: Composite, groups: list[list[Call]]) -> Iterator[Call | Rest]:
    number = 0
    for group in groups:
        if _stays(composite, group):
            yield from group
        else:
            number += 1
            yield _rest(composite, group, number)


def _joins(group: list[Call], call: Call) -> bool:
    """Whether the guard lets the call through where it lets the group."""
    guard = group[0].guard
    return guard is not None and call.guard == guard and set(guard[1]).isdisjoint(name for each in group for name in _written(each))


def _written(call: Call) -> tuple[object, ...]:
    inputs = len(call.callee.signature.inputs) if isinstance(call.callee, Program) else ROUTINES[call.callee].inputs
    return call.arguments[inputs:]


def _stays(composite: Composite, group: list[Call]) -> bool:
    """What has no guard, or needs of the whole what no argument carries."""
    signature = composite.signature
    bound = signature.counts or signature.workspace or composite.callbacks
    return group[0].guard is None or bool(bound) or any(call.repeat > 1 for call in group)


def _rest(composite: Composite, group: list[Call], number: int) -> Rest:
    guard = group[0].guard
    assert guard is not None
    used = {name for call in group for name in call.arguments}
    elsewhere = _names(call for call in composite.calls if call not in group) | set(guard[1])
    own = tuple(port for port in composite.locals if port.name in used - elsewhere)
    shared = tuple(port for port in composite.locals if port.name in used & elsewhere)
    outputs = (*shared, *(port for port in composite.signature.outputs if port.name in used))
    inputs = tuple(port for port in composite.signature.inputs if port.name in used)
    signature = replace(composite.signature, inputs=inputs, outputs=outputs)
    calls = tuple(replace(call, guard=None) for call in group)
    return Rest(composite, replace(composite, signature=signature, locals=own, calls=calls), guard, number)


def _anew(composite: Composite, first: Call, group: list[Call]) -> Rest:
    """Every call, the first without a guard."""
    guard = group[0].guard
    assert guard is not None
    used = {name for call in composite.calls for name in call.arguments}
    own = tuple(port for port in composite.locals if port.name in used)
    inputs = tuple(port for port in composite.signature.inputs if port.name in used)
    calls = (first, *(replace(call, guard=None) for call in group))
    body = replace(composite, signature=replace(composite.signature, inputs=inputs), locals=own, calls=calls)
    return Rest(composite, body, guard, 1, anew=True)


def _names(calls: Iterable[Call]) -> set[object]:
    calls = tuple(calls)
    return {name for call in calls for name in (*call.arguments, *(call.guard[1] if call.guard else ()))}


def own_locals(composite: Composite, *, leaves: bool = False) -> tuple[Port, ...]:
    """Those that no rest keeps for itself."""
    if leaves:
        return tuple(port for port in composite.locals if port.name in composite.calls[0].arguments)
    kept = {port for step in in_order(composite) if isinstance(step, Rest) for port in step.body.locals}
    return tuple(port for port in composite.locals if port not in kept)
