"""The inverse of a leg whose linkage has one drive: its foot moves on a curve, which the joint before the linkage carries along."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import sympy

from walkgen.model.classify import inverse_class
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.branches import SINGULAR
from walkgen.symbolic.curve import AIM, BOUNDS, Curve
from walkgen.symbolic.curve_scan import CurveScan
from walkgen.symbolic.curve_steps import CurveSteps
from walkgen.symbolic.driven_search import DrivenSearch, admissible_words
from walkgen.symbolic.forward import Route
from walkgen.symbolic.function import Both, Function, Same, Select, Solve, Step
from walkgen.symbolic.ports import DRIVE, joint_port, joint_unit, signature
from walkgen.symbolic.rows import TARGET, parameters_of
from walkgen.symbolic.selection import NEAREST_BRANCH, ONE_BRANCH, by_index, nearest
from walkgen.symbolic.tape import Tape, dot, minus, symbols_of

Exprs = Sequence[sympy.Expr]
_STATUS = Port("status", kind="integer")
_PROFILE = Port("profile", (6,))
_SOURCE = "the least distances of a coupler curve from a point"


def curve_inverse(mechanism: Mechanism, leg: Limb) -> Iterator[Solve]:
    """`inverse`, `inverse_branch`, `inverse_near`, `inverse_admissible` and `inverse_distance`."""
    assert leg.linkage is not None
    curve = CurveInverse(mechanism, leg, leg.linkage)
    yield from (curve.inverse(), curve.inverse_branch(), curve.inverse_near(), curve.inverse_admissible(), curve.inverse_distance())


class CurveInverse(Curve):
    """The rows of one leg, and what is chosen among them."""

    def __init__(self, mechanism: Mechanism, leg: Limb, linkage: Linkage) -> None:
        super().__init__(mechanism, leg, linkage)
        self._slots = len(inverse_class(mechanism, leg).branch_names)

    # ---- functions

    def inverse(self) -> Solve:
        """All rows."""
        doc = (
            "All joint values that reach p, a row a value of the drive, in order of the drive; rows beyond the last are UNREACHABLE and "
            "hold the first again, or the joint values of all that come closest."
        )
        words = signature(self.mechanism, self.leg.name, "inverse", [TARGET], self._results("q", "status"), doc, _SOURCE)
        return self._solve(words, (), self._steps("q", "status"), (self._curve,))

    def inverse_branch(self) -> Solve:
        """One row by its number."""
        port = Port("branch", kind="integer")
        return self._one("inverse_branch", port, by_index, ONE_BRANCH)

    def inverse_near(self) -> Solve:
        """The row nearest to a seed."""
        port = joint_port("q_seed", self.leg.joints)
        found = self._one("inverse_near", port, nearest, NEAREST_BRANCH)
        return (
            found
            if self.linkage.forward.triads
            else replace(found, closed_form=CurveSteps(self.mechanism, self.leg, self.linkage).near(found.signature))
        )

    def inverse_admissible(self) -> Solve:
        """The row within the limits, or what a search within them finds."""
        searched = DrivenSearch(self.mechanism, Route(self.leg.name, (self.leg,)))
        steps = (*self._steps("rows", "row_states"), *searched.within("rows", "row_states", self._slots))
        ports = (*self._locals, *self._results("rows", "row_states"), *searched.ports)
        return Solve(admissible_words(self.mechanism, self.leg), ports, steps, callbacks=(self._curve, searched.motion))

    def inverse_distance(self) -> Solve:
        """Of every row from the target."""
        output = Port("distance", (self._slots,), "m")
        doc = "Distance from p of the foot at every branch of inverse: 0 but for rounding where it reaches, NaN for a bad input."
        words = signature(self.mechanism, self.leg.name, "inverse_distance", [TARGET], [output], doc, "as inverse")
        last = Step(self._distances(output), (*self._named_feet, "p", *parameters_of(self.mechanism), "distance"))
        return self._solve(words, self._results("rows", "row_states"), (*self._steps("rows", "row_states"), last), (self._curve,))

    def _one(self, name: str, port: Port, choose: Callable[[Mechanism, Limb, int], Function], doc: str) -> Solve:
        outputs = [joint_port("q", self.leg.joints), _STATUS]
        words = signature(self.mechanism, self.leg.name, name, [TARGET, port], outputs, doc, _SOURCE)
        last = Step(choose(self.mechanism, self.leg, self._slots), ("rows", "row_states", port.name, "q", "status"))
        return self._solve(words, self._results("rows", "row_states"), (*self._steps("rows", "row_states"), last), (self._curve,))

    def _solve(self, words: Signature, ports: tuple[Port, ...], steps: tuple[Step, ...], callbacks: tuple[Solve, ...]) -> Solve:
        """By the routine; without triads, by steps for targets that have none."""
        own = (*self._locals, *ports)
        found = Solve(words, own, steps, callbacks=callbacks)
        if self.linkage.forward.triads:
            return found
        scan = CurveScan(self.mechanism, self.leg, self.linkage)
        first, _, *others = steps
        return replace(found, closed_form=Solve(words, (*own, *scan.locals), (first, *scan.steps(self._slots), *others)))

    # ---- steps

    def _results(self, rows: str, states: str) -> tuple[Port, Port]:
        return (
            Port(rows, (self._slots, len(self.leg.joints)), joint_unit(self.leg.joints)),
            Port(states, (self._slots,), kind="integer"),
        )

    @property
    def _locals(self) -> tuple[Port, ...]:
        found = (AIM, BOUNDS, Port("drives", (self._slots,)), Port("states", (self._slots,), kind="integer"))
        return (*found, *self._singled, *self._feet)

    @cached_property
    def _singled(self) -> tuple[Port, ...]:
        """The drive of every row."""
        return tuple(Port(f"drive_{number}", (1,)) for number in range(1, self._slots + 1))

    @cached_property
    def _feet(self) -> tuple[Port, ...]:
        """The foot of every row, in the linkage's plane."""
        return tuple(Port(f"foot_{number}", (2,), "m") for number in range(1, self._slots + 1))

    def _steps(self, rows: str, states: str) -> tuple[Step, ...]:
        given = parameters_of(self.mechanism)
        turning = int(self.leg.joints[-1].kind == "revolute")
        return (
            Step(self.aim, ("p", *given, "aim", "bounds")),
            Step("wg_curve_roots", ("bounds", "aim", self._curve.signature.full_name, turning, "drives", "states")),
            *self._foot_steps(),
            Step(self._rows, ("drives", "states", *self._named_feet, "p", *given, rows, states)),
        )

    @property
    def _named_feet(self) -> tuple[str, ...]:
        return tuple(port.name for port in self._feet)

    def _foot_steps(self) -> Iterator[Step]:
        """Every row's foot, one after another."""
        drives, tape = Port("drives", (self._slots,)), Tape()
        words = Signature(self.mechanism.name, self.leg.name, "curve_drives", (drives,), self._singled, "", "")
        yield Step(tape.function(words, symbols_of(drives)), ("drives", *(port.name for port in self._singled)))
        for drive, foot in zip(self._singled, self._feet, strict=True):
            yield Step(self._foot, (drive.name, *parameters_of(self.mechanism), foot.name))

    @cached_property
    def _foot(self) -> Function:
        """The foot in the linkage's plane."""
        tape, (drive,) = Tape(), symbols_of(DRIVE)
        words = signature(self.mechanism, self.leg.name, "curve_foot", [DRIVE], [Port("foot", (2,), "m")], "", "")
        return tape.function(words, self.planar(drive, tape))

    @cached_property
    def _curve(self) -> Solve:
        """Of the drive, as the routine calls it."""
        words = signature(self.mechanism, self.leg.name, "curve", [DRIVE], [_PROFILE], "", "")
        step = Step(self._profile, ("drive", *parameters_of(self.mechanism), "profile"))
        return Solve(words, (), (step,))

    @cached_property
    def _profile(self) -> Function:
        """The foot where the joint before the linkage does not count, and its slopes by the drive."""
        tape, (drive,) = Tape(), symbols_of(DRIVE)
        words = signature(self.mechanism, self.leg.name, "curve_profile", [DRIVE], [_PROFILE], "", "")
        at, along = self.profiled(drive, tape)
        return tape.function(words, [*at, *along])

    @cached_property
    def _rows(self) -> Function:
        """Joint values of the drives found: the joint turned or slid as near to the target as it comes."""
        drives, states = Port("drives", (self._slots,)), Port("states", (self._slots,), kind="integer")
        tape = Tape()
        target = self.target(tape)
        rows: list[sympy.Expr] = []
        statuses = []
        for drive, state, foot in zip(symbols_of(drives), symbols_of(states), self._feet, strict=True):
            values, free = self.carried(symbols_of(foot), target, tape)
            rows += [*values, drive]
            statuses.append(Select(Both(free, Same(state, 0)), SINGULAR, state) if free != sympy.false else state)
        given = [drives, states, *self._feet, TARGET]
        words = signature(self.mechanism, self.leg.name, "curve_rows", given, self._results("q", "status"), "", "")
        return tape.function(words, [*rows, *statuses])

    def _distances(self, output: Port) -> Function:
        """Of every row's foot from the target, where the joint before the linkage does not count: it brings them as near as it can."""
        tape = Tape()
        aim = self.seen(self.target(tape), tape)
        gaps = [minus(self.seen(self.hung(symbols_of(foot)), tape), aim) for foot in self._feet]
        words = signature(self.mechanism, self.leg.name, "curve_distances", [*self._feet, TARGET], [output], "", "")
        return tape.function(words, [sympy.sqrt(dot(gap, gap)) for gap in gaps])
