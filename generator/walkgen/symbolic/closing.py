"""Functions that rest on unknowns, which are found first: what closes a linkage's triads, and where a curved sole touches the ground."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Argument, Port, Table
from walkgen.symbolic.closure import assembled_port, drive_count, driven_closure, point_parameters, unknowns_port
from walkgen.symbolic.closure_steps import unknown_slopes
from walkgen.symbolic.driven_steps import closed_by_steps, way_ports
from walkgen.symbolic.first_root import FirstRoot, whole
from walkgen.symbolic.function import Angle, Derivation, Function, LessEqual, Select, Solve, Step
from walkgen.symbolic.path import touch_port
from walkgen.symbolic.ports import DRIVE, signature
from walkgen.symbolic.sole_touch import SoleTouch
from walkgen.symbolic.starts import found_start
from walkgen.symbolic.tape import Tape, symbols_of

_SOURCE = "Newton's method on the closure of triads, continued from the start (walkgen_triads.h)"


def closed(mechanism: Mechanism, derivation: Derivation) -> Derivation:
    """The derivation, with the unknowns of legs found before the functions that use them; itself where there are none.

    Raises:
        UnsupportedMechanism: a triad assembles nowhere (WG189).
    """
    if not _rests_on_unknowns(mechanism, derivation):
        return derivation
    form = derivation if isinstance(derivation, Function) else derivation.closed_form
    iterated = None if form is None else _Iterated(mechanism).result(form, None)
    return _Closing(mechanism).result(derivation, iterated)


def _rests_on_unknowns(mechanism: Mechanism, derivation: Derivation) -> bool:
    if isinstance(derivation, Solve):
        callees = (step.callee for step in derivation.steps if isinstance(step.callee, Function))
        forms = (derivation.closed_form,) if derivation.closed_form else ()
        return any(_rests_on_unknowns(mechanism, part) for part in (*callees, *forms, *derivation.callbacks))
    return any(_extra(leg, derivation) for leg in mechanism.legs)


def _extra(leg: Limb, function: Function) -> tuple[Port, ...]:
    """What a function needs of the leg's closing."""
    if leg.curved_sole is not None:
        unknown: tuple[Port, ...] = (touch_port(leg),)
    elif leg.linkage is not None and leg.linkage.forward.triads:
        unknown = (unknowns_port(leg), assembled_port(leg))
    else:
        return ()
    free = _free(function)
    return tuple(port for port in unknown if not free.isdisjoint(symbols_of(port)))


def _free(function: Function) -> set[sympy.Basic]:
    """Symbols that the outputs rest on and nothing defines."""
    used = set().union(*(output.free_symbols for output in function.outputs))
    for symbol, definition in reversed(function.intermediates):
        if symbol in used:
            used |= definition.free_symbols
    return used - set(function.inputs)


@dataclass(frozen=True)
class _Joints:
    """Where a linkage's drives, or all joints of a leg with a curved sole, stand: in which argument, from which element on."""

    leg: Limb
    port: Port
    first: int


class _Closing:
    """Grows the steps of one function."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism = mechanism
        self._locals: list[Port] = []
        self._tables: list[Table] = []
        self._callbacks: list[Solve] = []
        self._slopes: list[Step] = []
        self._found: set[tuple[str, Argument]] = set()

    def result(self, derivation: Derivation, form: Solve | None) -> Solve:
        """The function with its closings, and what stands in for it where there are no routines."""
        own = derivation if isinstance(derivation, Solve) else Solve(derivation.signature, (), (whole(derivation),))
        steps = tuple(step for each in own.steps for step in self._steps(each))
        found, tables = tuple(dict.fromkeys((*own.locals, *self._locals))), tuple(dict.fromkeys((*own.tables, *self._tables)))
        slopes = tuple(self._slopes) if isinstance(derivation, Function) else ()
        called = (callback for each in own.callbacks if isinstance(callback := closed(self._mechanism, each), Solve))
        return Solve(own.signature, found, steps, form, tables, tuple(dict.fromkeys((*called, *self._callbacks))), slopes)

    def _steps(self, step: Step) -> Iterator[Step]:
        """The step, after what closes the legs that it rests on."""
        if isinstance(step.callee, str):
            yield step
            return
        function, extras = step.callee, list[Port]()
        for leg in self._mechanism.legs:
            needed = _extra(leg, function)
            extras += needed
            if needed:
                joints = _joints(self._mechanism, leg, function)
                found = leg.name, step.arguments[function.signature.inputs.index(joints.port)]
                yield from self._closing(joints, step) if found not in self._found else ()
                self._found.add(found)
        count = len(function.signature.inputs)
        names = (*step.arguments[:count], *(port.name for port in extras), *step.arguments[count:])
        yield replace(step, callee=_with_inputs(function, extras), arguments=names)

    def _closing(self, joints: _Joints, step: Step) -> Iterator[Step]:
        """From the drives, and the parameters that matter, to the unknowns."""
        leg = joints.leg
        if leg.curved_sole is not None:
            yield from self._touching(joints, step)
            return
        gathered = _gathered(self._mechanism, joints)
        point = gathered.signature.outputs[0]
        assert isinstance(step.callee, Function)
        given = dict(zip((port.name for port in step.callee.signature.inputs), step.arguments, strict=False))
        self._locals += [point, *self._rest(leg)]
        yield Step(gathered, (*(given[port.name] for port in gathered.signature.inputs), point.name))
        yield from self._found_by(leg, point)
        if self._mechanism.parameters:
            slopes = unknown_slopes(self._mechanism, leg)
            self._slopes.append(Step(slopes, (point.name, unknowns_port(leg).name, slopes.signature.outputs[0].name)))

    def _touching(self, joints: _Joints, step: Step) -> Iterator[Step]:
        """From all joints to where the sole touches the ground."""
        assert isinstance(step.callee, Function)
        touch = SoleTouch(self._mechanism, joints.leg)
        upright = touch.upright(joints.port, joints.first)
        given = dict(zip((port.name for port in step.callee.signature.inputs), step.arguments, strict=False))
        self._locals += [touch.up, touch_port(joints.leg)]
        yield Step(upright, (*(given[port.name] for port in upright.signature.inputs), touch.up.name))
        for root in touch.roots():
            yield whole(touch.given(root))
            yield from self._rooted(root)
        yield whole(touch.place())
        if self._mechanism.parameters:
            slopes = touch.slopes(joints.port, joints.first)
            names = [given.get(port.name, port.name) for port in slopes.signature.inputs]
            self._slopes.append(Step(slopes, (*names, slopes.signature.outputs[0].name)))

    def _rooted(self, root: FirstRoot) -> tuple[Step, ...]:
        self._locals += root.locals
        self._callbacks.append(root.callback)
        return root.steps()

    def _rest(self, leg: Limb) -> tuple[Port, ...]:
        return (unknowns_port(leg), assembled_port(leg))

    def _found_by(self, leg: Limb, point: Port) -> Iterator[Step]:
        callback, table = _callback(self._mechanism, leg), _table(self._mechanism, leg)
        self._callbacks.append(callback)
        self._tables.append(table)
        unknowns, assembled = unknowns_port(leg), assembled_port(leg)
        arguments = (point.size, unknowns.size, point.name, table.name, callback.signature.full_name, unknowns.name, assembled.name)
        yield Step("wg_close_triads", arguments)


class _Iterated(_Closing):
    """The same by so many steps, for targets without routines."""

    def _rooted(self, root: FirstRoot) -> tuple[Step, ...]:
        self._locals += root.repeated_locals
        return root.repeated()

    def _rest(self, leg: Limb) -> tuple[Port, ...]:
        return (*way_ports(self._mechanism, leg), *super()._rest(leg))

    def _found_by(self, leg: Limb, point: Port) -> Iterator[Step]:
        yield from closed_by_steps(self._mechanism, leg, point.name)


def _with_inputs(function: Function, extras: Sequence[Port]) -> Function:
    """A function that takes what closes legs as well."""
    words = replace(function.signature, inputs=(*function.signature.inputs, *extras))
    return replace(function, signature=words, inputs=(*function.inputs, *(symbol for port in extras for symbol in symbols_of(port))))


def _joints(mechanism: Mechanism, leg: Limb, function: Function) -> _Joints:
    """Of the robot's q where the function takes all of it, else at the end of the path's, or the one drive of a curve."""
    port = next(port for port in function.signature.inputs if port.name in ("q", DRIVE.name))
    count = drive_count(leg) + leg.beyond if leg.linkage is not None else len(leg.joints)
    of_robot = not function.signature.owner
    first = mechanism.offset(leg) + len(leg.joints) - count if of_robot else port.size - count
    return _Joints(leg, port, first)


def _gathered(mechanism: Mechanism, joints: _Joints) -> Function:
    """The drives, turned to within half a turn of the start, and the parameters that matter."""
    leg, tape = joints.leg, Tape()
    start, used = found_start(mechanism, leg), point_parameters(mechanism, leg)
    drives = symbols_of(joints.port)[joints.first : joints.first + drive_count(leg)]
    turned = [
        _near(value, sympy.Rational(str(at)), tape) if joint.kind == "revolute" else value
        for value, at, joint in zip(drives, start.drives, leg.drives, strict=True)
    ]
    own = f"drives_in_{joints.port.name}_{joints.port.size}"
    port = Port(f"{leg.name}_drives", (len(turned) + len(used),), "rad, m or as declared")
    words = signature(mechanism, leg.name, own, [joints.port], [port], "", _SOURCE)
    return tape.function(words, [*turned, *used.values()])


def _near(value: sympy.Expr, centre: sympy.Expr, tape: Tape) -> sympy.Expr:
    """The angle without whole turns; as it is where it has none, so that nothing is rounded."""
    away = tape.let("away", value - centre)
    half_turn = sympy.pi.evalf(50)
    inside = LessEqual(tape.let("away2", away**2), half_turn**2)
    return tape.let("drive", Select(inside, value, centre + Angle(sympy.sin(away), sympy.cos(away))))


def called_back(function: Function, name: str) -> Solve:
    """A function as routines call it."""
    return Solve(replace(function.signature, name=name), (), (whole(function),))


def _callback(mechanism: Mechanism, leg: Limb) -> Solve:
    """The closure of a point, for the routine."""
    return called_back(driven_closure(mechanism, leg), "closure")


def _table(mechanism: Mechanism, leg: Limb) -> Table:
    start = found_start(mechanism, leg)
    return Table(f"{mechanism.name}_{leg.name}_start", (*start.drives, *start.parameters, *start.unknowns))
