"""The inverse of a leg whose linkage has a triad, under its drives or once the foot is held: all rows, each from an assembly of its own.

Where the held linkage has a triad, a row for every way in which it assembles at a start's foot: Newton's method follows it while the foot
goes straight to its place in the plane. Where the drives have one, they are at last put in: a row counts if the linkage that they assemble,
from the spec's start, has its foot on the target.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import sympy

from walkgen.model.classify import inverse_class
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature, Table
from walkgen.spec.branches import MODES
from walkgen.symbolic import held_steps
from walkgen.symbolic.branches import BAD_INPUT, INFEASIBLE, NO_CONVERGENCE, UNREACHABLE
from walkgen.symbolic.closing import called_back
from walkgen.symbolic.closure import point_parameters
from walkgen.symbolic.driven import kinematics_of
from walkgen.symbolic.driven_search import DrivenSearch, admissible_words
from walkgen.symbolic.forward import Route
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Either, Function, LessEqual, Same, Select, Solve, Step
from walkgen.symbolic.held_closure import UNKNOWNS, HeldStart, Signs, held_closure, held_port, held_start, sided
from walkgen.symbolic.limits import row_distances
from walkgen.symbolic.linkage_inverse import DISTANCE_DOC, Arrival, LinkageRows, dyad_rows
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.reach import iterated
from walkgen.symbolic.rows import TARGET, parameters_of, row_ports
from walkgen.symbolic.selection import NEAREST_BRANCH, ONE_BRANCH, by_index, nearest
from walkgen.symbolic.tape import Tape, dot, minus, symbols_of

_STATUS = Port("status", kind="integer")
_SOURCE = "dyads in closed form, triads by Newton's method from a start (walkgen_triads.h)"
_NEAR = sympy.Rational(1, 10**14)
"""Square of how far from the target, in sizes of the linkage, the foot of a row's assembly is: that of rounding is far below."""


@dataclass(frozen=True)
class Row:
    """One row: the plane's turn, signs of the dyads' sides, the triad's mode (None where there is no triad)."""

    number: int
    turn: int
    signs: Signs
    mode: int | None = None


def held_inverse(mechanism: Mechanism, leg: Limb) -> Iterator[Solve]:
    """`inverse` and what is chosen or measured of its rows."""
    assert leg.linkage is not None
    held = HeldInverse(mechanism, leg, leg.linkage)
    yield from (build() for build in (held.inverse, held.inverse_branch, held.inverse_near, held.inverse_admissible, held.inverse_distance))


class HeldInverse:
    """The rows of one leg, and what is chosen among them."""

    def __init__(self, mechanism: Mechanism, leg: Limb, linkage: Linkage) -> None:
        self._mechanism, self._leg, self._linkage = mechanism, leg, linkage
        self._parameters, self._given = parameter_symbols(mechanism), parameters_of(mechanism)
        self._found = inverse_class(mechanism, leg)
        self._slots = len(self._found.branch_names)

    # ---- functions

    def inverse(self) -> Solve:
        """All rows."""
        doc = (
            "All joint values that reach p, a row a branch; unreachable rows hold the closest configuration of the dyad that cannot "
            "close, or the dead point that the triad comes to, or the first row again; INFEASIBLE ones reach p in another assembly than "
            "the drives come to from the spec's start and sides."
        )
        words = signature(
            self._mechanism, self._leg.name, "inverse", [TARGET], row_ports(self._leg, self._found, "q", "status"), doc, _SOURCE
        )
        return self._solve(words, self._steps("q", "status"), ())

    def inverse_branch(self) -> Solve:
        """One row by its number."""
        port = Port("branch", kind="integer")
        return self._one("inverse_branch", port, by_index, ONE_BRANCH)

    def inverse_near(self) -> Solve:
        """The row nearest to a seed."""
        port = joint_port("q_seed", self._leg.joints)
        found = self._one("inverse_near", port, nearest, NEAREST_BRANCH)
        if self._start is None:
            return found
        route = Route(self._leg.name, (self._leg,))
        searched, triads = DrivenSearch(self._mechanism, route), self._linkage.forward.triads
        return replace(
            found,
            locals=(*found.locals, *searched.ports),
            steps=(*found.steps, searched.bounds, searched.nearer),
            closed_form=found.closed_form if triads else iterated(self._mechanism, route, TARGET, found.signature),
            callbacks=(*found.callbacks, searched.motion),
        )

    def inverse_admissible(self) -> Solve:
        """The row within the limits, or what a search within them finds."""
        searched = DrivenSearch(self._mechanism, Route(self._leg.name, (self._leg,)))
        steps = (*self._steps("rows", "row_states"), *searched.within("rows", "row_states", self._slots))
        ports = (*row_ports(self._leg, self._found, "rows", "row_states"), *searched.ports)
        found = self._solve(admissible_words(self._mechanism, self._leg), steps, ports)
        return replace(found, closed_form=None, callbacks=(*found.callbacks, searched.motion))

    def inverse_distance(self) -> Solve:
        """Of all rows."""
        output = Port("distance", (self._slots,), "m")
        words = signature(self._mechanism, self._leg.name, "inverse_distance", [TARGET], [output], DISTANCE_DOC, "as inverse")
        if self._linkage.forward.triads:
            last = Step(self._distances(output), (*(self._foot_port(row).name for row in self._rows), "p", *self._given, "distance"))
        else:
            last = Step(row_distances(self._mechanism, self._leg, output), ("rows", "p", *self._given, "distance"))
        return self._solve(words, (*self._steps("rows", "row_states"), last), row_ports(self._leg, self._found, "rows", "row_states"))

    def _one(self, name: str, port: Port, choose: Callable[[Mechanism, Limb, int], Function], doc: str) -> Solve:
        outputs = [joint_port("q", self._leg.joints), _STATUS]
        words = signature(self._mechanism, self._leg.name, name, [TARGET, port], outputs, doc, _SOURCE)
        last = Step(choose(self._mechanism, self._leg, self._slots), ("rows", "row_states", port.name, "q", "status"))
        return self._solve(words, (*self._steps("rows", "row_states"), last), row_ports(self._leg, self._found, "rows", "row_states"))

    def _solve(self, words: Signature, steps: tuple[Step, ...], rows: tuple[Port, ...]) -> Solve:
        found = (*rows, *self._locals)
        if self._start is None:
            return Solve(words, found, steps, Solve(words, found, steps))
        form = Solve(words, (*found, *self._iterated_ports), tuple(part for step in steps for part in self._iterated(step)))
        closure = called_back(held_closure(self._mechanism, self._leg), "held_closure")
        return Solve(words, found, steps, form, self._tables, (closure,))

    # ---- rows

    @cached_property
    def _start(self) -> HeldStart | None:
        return held_start(self._mechanism, self._leg) if self._linkage.inverse.triads else None

    @cached_property
    def _rows(self) -> tuple[Row, ...]:
        """In their order."""
        modes: Sequence[int | None] = range(MODES) if self._start else (None,)
        turns, sides = range(2 if self._leg.serial else 1), product((1, -1), repeat=len(sided(self._linkage)))
        return tuple(Row(number, *choice) for number, choice in enumerate(product(turns, sides, modes)))

    @cached_property
    def _followed(self) -> tuple[Row, ...]:
        """Those that have an assembly to start from."""
        start = self._start
        return tuple(row for row in self._rows if start and row.mode is not None and row.mode < len(start.modes[row.signs]))

    @property
    def _tables(self) -> tuple[Table, ...]:
        assert self._start is not None
        return tuple(Table(self._table(row), self._start.point(row.signs, row.mode or 0)) for row in self._followed if not row.turn)

    def _table(self, row: Row) -> str:
        """The same for both turns."""
        return f"{self._mechanism.name}_{self._leg.name}_held_{row.number % (self._slots // (2 if self._leg.serial else 1))}"

    # ---- steps

    @property
    def _locals(self) -> tuple[Port, ...]:
        found: list[Port] = []
        if self._start:
            found += [port for row in self._followed for port in (*self._arrival_ports(row), self._aim_port(row))]
        if self._linkage.forward.triads:
            found += [self._states_port, *(port for row in self._rows for port in (self._q_port(row), self._foot_port(row)))]
        return tuple(dict.fromkeys(found))

    def _aim_port(self, row: Row) -> Port:
        """One for every plane and choice of sides."""
        shape = held_port(self._mechanism, self._leg).shape
        return Port(f"aim_{row.number // MODES}", shape)

    def _arrival_ports(self, row: Row) -> tuple[Port, Port, Port]:
        """Where the foot gets to, the unknowns there, the status."""
        shape = held_port(self._mechanism, self._leg).shape
        number = row.number
        return Port(f"reached_{number}", shape), Port(f"u_{number}", UNKNOWNS.shape), Port(f"state_{number}", kind="integer")

    def _q_port(self, row: Row) -> Port:
        return Port(f"q_{row.number}", (len(self._leg.joints),))

    def _foot_port(self, row: Row) -> Port:
        return Port(f"foot_{row.number}", (3,), "m")

    @property
    def _states_port(self) -> Port:
        return Port("found_states", (self._slots,), kind="integer")

    def _steps(self, rows: str, states: str) -> tuple[Step, ...]:
        """Rows, then whether their drives assemble what they stand for."""
        checked = bool(self._linkage.forward.triads)
        placed = self._states_port.name if checked else states
        steps = [*(self._following(rows, placed) if self._start else self._placing(rows, placed))]
        return (*steps, *(self._checking(rows, placed, states) if checked else ()))

    def _placing(self, rows: str, states: str) -> Iterator[Step]:
        """By dyads alone."""
        kernel = dyad_rows(self._mechanism, self._leg, "inverse_rows", row_ports(self._leg, self._found, "rows", "states"))
        yield Step(kernel, ("p", *self._given, rows, states))

    def _following(self, rows: str, states: str) -> Iterator[Step]:
        """By the triad's ways, then dyads."""
        aims = tuple(dict.fromkeys(self._aim_port(row) for row in self._followed))
        yield Step(self._aims(aims), ("p", *self._given, *(port.name for port in aims)))
        closure = f"{self._mechanism.name}_{self._leg.name}_held_closure"
        for row in self._followed:
            aim = self._aim_port(row)
            arrival = (port.name for port in self._arrival_ports(row))
            yield Step("wg_approach", (aim.size, UNKNOWNS.size, aim.name, self._table(row), closure, *arrival))
        arrivals = (port.name for row in self._followed for port in self._arrival_ports(row))
        yield Step(self._arrived(), ("p", *arrivals, *self._given, rows, states))

    # ---- the same for targets without routines

    @property
    def _iterated_ports(self) -> tuple[Port, ...]:
        return tuple(port for row in self._followed for port in held_steps.ports(self._mechanism, self._leg, row.number))

    def _iterated(self, step: Step) -> tuple[Step, ...]:
        """Instead of the routine so many steps of Newton's method."""
        if step.callee != "wg_approach":
            return (step,)
        assert self._start is not None
        arrival = step.arguments[5:]
        row = next(row for row in self._followed if self._arrival_ports(row)[0].name == arrival[0])
        point = self._start.point(row.signs, row.mode or 0)
        return held_steps.followed(self._mechanism, self._leg, row.number, point, (self._aim_port(row).name, *map(str, arrival)))

    def _aims(self, ports: Sequence[Port]) -> Function:
        """What the held linkage is continued to: the target in each plane, the parameters, the sides."""
        tape = Tape()
        planes = self._linkage_rows(tape).planes
        own = [self._parameters[name] for name in point_parameters(self._mechanism, self._leg)]
        firsts = {self._aim_port(row): row for row in reversed(self._followed)}
        entries = [entry for port in ports for entry in (*planes[firsts[port].turn].target, *own, *firsts[port].signs)]
        return tape.function(signature(self._mechanism, self._leg.name, "held_aims", [TARGET], ports, "", ""), entries)

    def _linkage_rows(self, tape: Tape) -> LinkageRows:
        return LinkageRows(self._leg, self._linkage, symbols_of(TARGET), self._parameters, tape)

    def _arrived(self) -> Function:
        """q and status of every row; those that nothing leads to hold the first of the others."""
        tape, inputs = Tape(), [port for row in self._followed for port in self._arrival_ports(row)]
        rows, found = self._linkage_rows(tape), dict[int, tuple[list[sympy.Expr], sympy.Expr]]()
        for row in self._followed:
            reached, unknowns, state = (symbols_of(port) for port in self._arrival_ports(row))
            found[row.number] = rows.row(row.turn, row.signs, Arrival((reached[0], reached[1]), unknowns, state[0]))
        values, state = found[self._followed[0].number]
        rest = values, Select(Same(state, BAD_INPUT), BAD_INPUT, UNREACHABLE)
        every = [found.get(row.number, rest) for row in self._rows]
        outputs = row_ports(self._leg, self._found, "rows", "states")
        words = signature(self._mechanism, self._leg.name, "held_rows", [TARGET, *inputs], outputs, "", "")
        return tape.function(words, [*(value for q, _ in every for value in q), *(status for _, status in every)])

    def _checking(self, rows: str, placed: str, states: str) -> Iterator[Step]:
        """The foot of every row's drives, and what that says."""
        every = row_ports(self._leg, self._found, "rows", "states")[0]
        singled = [self._q_port(row) for row in self._rows]
        words = Signature(self._mechanism.name, self._leg.name, "held_apart", (every,), tuple(singled))
        yield Step(Tape().function(words, symbols_of(every)), (rows, *(port.name for port in singled)))
        for row in self._rows:
            yield Step(self._foot, (self._q_port(row).name, *self._given, self._foot_port(row).name))
        feet = tuple(self._foot_port(row).name for row in self._rows)
        yield Step(self._compared, (placed, *feet, "p", *self._given, states))

    @cached_property
    def _foot(self) -> Function:
        """Of drives, by the spec's start."""
        tape, port = Tape(), joint_port("q", self._leg.joints)
        foot = kinematics_of((self._leg,), symbols_of(port), self._parameters, tape).position
        return tape.function(signature(self._mechanism, self._leg.name, "held_foot", [port], [Port("foot", (3,), "m")], "", ""), foot)

    def _distances(self, output: Port) -> Function:
        """How far every row's foot is from the target."""
        tape, (x, y, z) = Tape(), symbols_of(TARGET)
        feet = [self._foot_port(row) for row in self._rows]
        gaps = [minus((foot[0], foot[1], foot[2]), (x, y, z)) for foot in map(symbols_of, feet)]
        words = signature(self._mechanism, self._leg.name, "held_distances", [*feet, TARGET], [output], "", "")
        return tape.function(words, [sympy.sqrt(dot(gap, gap)) for gap in gaps])

    @cached_property
    def _compared(self) -> Function:
        """INFEASIBLE where the foot is not at the target that its row reaches."""
        tape, target = Tape(), symbols_of(TARGET)
        feet = [self._foot_port(row) for row in self._rows]
        near = _NEAR * expression(self._linkage.size, self._parameters) ** 2
        states = []
        for state, foot in zip(symbols_of(self._states_port), map(symbols_of, feet), strict=True):
            gap = minus((foot[0], foot[1], foot[2]), (target[0], target[1], target[2]))
            there = LessEqual(tape.let("missed", dot(gap, gap)), near)
            open_ = Either(Same(state, UNREACHABLE), Either(Same(state, BAD_INPUT), Same(state, NO_CONVERGENCE)))
            states.append(Select(Either(there, open_), state, INFEASIBLE))
        outputs = [Port("states", (self._slots,), kind="integer")]
        words = signature(self._mechanism, self._leg.name, "held_compared", [self._states_port, *feet, TARGET], outputs, "", "")
        return tape.function(words, states)
