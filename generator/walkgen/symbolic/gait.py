"""The functions of a gait at a time: states, phases, the next event and the feet, each one support routine with the gait's numbers."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from functools import partial
from itertools import accumulate

from walkgen.model.gait import Gait, Schedule
from walkgen.model.mechanism import Mechanism
from walkgen.signature import Argument, Port, Table
from walkgen.spec.checks_gait import gait_owner
from walkgen.symbolic.function import Solve, Step
from walkgen.symbolic.ports import signature

_DIGITS = Context(prec=40)
_TIME = Port("t", (), "s")
_SOURCE = "theory 3.1: u = F(t/T - phi), support while u < beta"
_LISTED = "theory 3.1: an event sequence that is no cycle"
_SMOOTH = (
    "Position, velocity and acceleration are continuous; a foot meets the ground at its speed and rises by the gait's lift over the higher "
    "of its two footholds, half way."
)


@dataclass(frozen=True)
class GaitFunctions:
    """Functions of one gait; feet stand in the order of the legs."""

    mechanism: Mechanism
    gait: Gait | Schedule

    def functions(self) -> dict[str, Callable[[], Solve]]:
        """Those that the gait has numbers for."""
        found: dict[str, Callable[[], Solve]] = {"states": self.states, "leg_phase": self.leg_phase, "next_event": self.next_event}
        if self.gait.lift is not None:
            found["foot_transfers"] = self.foot_transfers
            if isinstance(self.gait, Gait) and self.gait.stance is not None:
                found["foot_targets"] = partial(self.foot_targets, self.gait)
        return found

    def states(self) -> Solve:
        """[k]."""
        doc = "Of each leg: 0 supports, 1 in transfer, -1 where t is not finite. At an event's time the state after it."
        return self._solve("states", [_TIME], [Port("state", (self._legs,), kind="integer")], doc)

    def leg_phase(self) -> Solve:
        """u [k]."""
        doc = "How far each leg is since it was placed, in periods: [0, 1); NaN where t is not finite."
        if isinstance(self.gait, Schedule):
            doc = "The share of its support or transfer that each leg has behind it: [0, 1); NaN where that has no start or no end."
        return self._solve("leg_phase", [_TIME], [Port("u", (self._legs,))], doc)

    def next_event(self) -> Solve:
        """Time and change [k]."""
        doc = "The first time after t at which legs are lifted or placed, and which: 1 lifted, -1 placed, 0 neither; NaN for no time."
        return self._solve("next_event", [_TIME], [Port("t_next", (), "s"), Port("change", (self._legs,), kind="integer")], doc)

    def foot_transfers(self) -> Solve:
        """p, v, a [k,3]."""
        doc = (
            "Feet on any ground, in a frame at rest with z up: those in support stand at `start`, those in transfer are on their way from "
            f"there to `end`. {_SMOOTH}"
        )
        return self._solve("foot_transfers", [_TIME, self._feet("start"), self._feet("end")], self._motion, doc)

    def foot_targets(self, gait: Gait) -> Solve:
        """p, v, a [k,3]."""
        doc = (
            "Feet in the first platform's frame, which moves over level ground with a constant twist in its own axes: velocity along x and "
            "y, turning about z; where it is left out the gait's stride in a period along x. Feet in support stand still on the ground "
            f"and pass their stance half way. {_SMOOTH}"
        )
        pace = float(gait.stride / gait.period)
        twist = Port("twist", (3,), "m/s, m/s, rad/s", default=(pace, 0.0, 0.0))
        return self._solve("foot_targets", [_TIME, twist], self._motion, doc)

    @property
    def _legs(self) -> int:
        return len(self.mechanism.legs)

    def _feet(self, name: str, per: str = "") -> Port:
        return Port(name, (self._legs, 3), f"m{per}")

    @property
    def _motion(self) -> list[Port]:
        return [self._feet("p"), self._feet("v", "/s"), self._feet("a", "/s^2")]

    def _solve(self, name: str, inputs: Sequence[Port], outputs: Sequence[Port], doc: str) -> Solve:
        """A function that is the routine of its name."""
        owner = gait_owner(self.gait.name)
        listed = isinstance(self.gait, Schedule)
        words = signature(self.mechanism, owner, name, inputs, outputs, doc, _LISTED if listed else _SOURCE)
        tables, numbers = self._numbers(owner, name)
        ports = (port.name for port in (*inputs, *outputs))
        routine = (_LIST_ROUTINES if listed else _ROUTINES)[name]
        return Solve(words, (), (Step(routine, (*numbers, *ports)),), tables=tables)

    def _numbers(self, owner: str, name: str) -> tuple[tuple[Table, ...], tuple[Argument, ...]]:
        """Constant tables, and what stands before the inputs in the routine's arguments."""
        gait, prefix = self.gait, f"{self.mechanism.name}_{owner}"
        tables = _event_tables(gait, prefix, name) if isinstance(gait, Schedule) else _cycle_tables(gait, prefix)
        numbers: list[Argument] = [*(table.name for table in tables), self._legs]
        if isinstance(gait, Gait):
            numbers.append(_decimal(gait.period))
        if name.startswith("foot") and gait.lift is not None:
            numbers.append(_decimal(gait.lift))
        if name == "foot_targets" and isinstance(gait, Gait) and gait.stance is not None:
            tables.append(Table(f"{prefix}_stance", _decimals(entry for point in gait.stance for entry in point), 3))
            numbers.append(tables[-1].name)
        return tuple(tables), tuple(numbers)


def _cycle_tables(gait: Gait, prefix: str) -> list[Table]:
    return [Table(f"{prefix}_duty", _decimals(gait.duty_factor)), Table(f"{prefix}_phase", _decimals(gait.phase))]


def _event_tables(gait: Schedule, prefix: str, name: str) -> list[Table]:
    """When legs change, leg after leg; where each leg's times begin; and but for phases which are in transfer before them."""
    own = [gait.own(leg) for leg in range(len(gait.lifted))]
    first = accumulate(map(len, own), initial=0)
    tables = [
        Table(f"{prefix}_times", _decimals(at for times in own for at in times)),
        Table(f"{prefix}_first", tuple(map(Decimal, first))),
        Table(f"{prefix}_lifted", tuple(map(Decimal, gait.lifted))),
    ]
    return tables[:2] if name == "leg_phase" else tables


_ROUTINES = {
    "states": "wg_gait_states",
    "leg_phase": "wg_gait_phase",
    "next_event": "wg_gait_next_event",
    "foot_transfers": "wg_gait_transfers",
    "foot_targets": "wg_gait_targets",
}
_LIST_ROUTINES = {
    "states": "wg_schedule_states",
    "leg_phase": "wg_schedule_phase",
    "next_event": "wg_schedule_next_event",
    "foot_transfers": "wg_schedule_transfers",
}
"""Of a list of events."""


def gait_functions(mechanism: Mechanism) -> Iterator[tuple[str, Callable[[], Solve]]]:
    """Names and builders of the functions of all gaits."""
    for gait in mechanism.gaits:
        yield from GaitFunctions(mechanism, gait).functions().items()


def _decimals(numbers: Sequence[Fraction] | Iterator[Fraction]) -> tuple[Decimal, ...]:
    return tuple(map(_decimal, numbers))


def _decimal(number: Fraction) -> Decimal:
    """To more digits than any target has; a zero has no sign."""
    return _DIGITS.divide(Decimal(number.numerator), Decimal(number.denominator))
