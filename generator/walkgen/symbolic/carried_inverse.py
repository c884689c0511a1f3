"""The inverse of a leg with one drive and two joints: with the drive held they meet two of three equations, where the third is met says a
search over the drive.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property

import sympy

from walkgen.model.classify import inverse_class
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.branches import UNREACHABLE
from walkgen.symbolic.carried import Carried
from walkgen.symbolic.choices import chosen
from walkgen.symbolic.closing import called_back
from walkgen.symbolic.curve import BOUNDS, drive_bounds
from walkgen.symbolic.driven_search import DrivenSearch, admissible_words
from walkgen.symbolic.forward import Route
from walkgen.symbolic.function import Function, Same, Select, Solve, Step
from walkgen.symbolic.limits import row_distances
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.reach import iterated
from walkgen.symbolic.rows import TARGET, parameters_of, row_ports
from walkgen.symbolic.selection import NEAREST_BRANCH, ONE_BRANCH, by_index, nearest
from walkgen.symbolic.tape import Tape, symbols_of

_STATUS, _FOUND = Port("status", kind="integer"), Port("found", kind="integer")
_REACH = Port("span_reach", (), "m")
_SOURCE = "every root of what two joints leave of the foot's equations, along the drive (walkgen_crossings.h)"
_DISTANCE_DOC = "Distance from p of the foot at every branch of inverse: 0 but for rounding where it reaches, NaN for a bad input."


def carried_inverse(mechanism: Mechanism, leg: Limb) -> Iterator[Solve]:
    """`inverse` and what is chosen or measured of its rows."""
    assert leg.linkage is not None
    carried = CarriedInverse(mechanism, leg, leg.linkage)
    yield from (
        carried.inverse(),
        carried.inverse_branch(),
        carried.inverse_near(),
        carried.inverse_admissible(),
        carried.inverse_distance(),
    )


class CarriedInverse:
    """The rows of one leg, and what is chosen among them."""

    def __init__(self, mechanism: Mechanism, leg: Limb, linkage: Linkage) -> None:
        self._mechanism, self._leg, self._linkage = mechanism, leg, linkage
        self._found, self._given = inverse_class(mechanism, leg), parameters_of(mechanism)
        self._slots, self._route = len(self._found.branch_names), Route(leg.name, (leg,))
        self._carried, self._searched = Carried(mechanism, leg, linkage), DrivenSearch(mechanism, self._route)

    # ---- functions

    def inverse(self) -> Solve:
        """All rows."""
        doc = (
            "All joint values that reach p, a row a value of the drive, in order of the drive; rows beyond the last are UNREACHABLE and "
            "hold the first again, or what a search finds to come closest."
        )
        words = signature(self._mechanism, self._leg.name, "inverse", [TARGET], self._results("q", "status"), doc, _SOURCE)
        return self._solve(words, self._steps("q", "status"))

    def inverse_branch(self) -> Solve:
        """One row by its number."""
        port = Port("branch", kind="integer")
        return self._one("inverse_branch", port, by_index, ONE_BRANCH)

    def inverse_near(self) -> Solve:
        """The row nearest to a seed, or what a descent from there comes to."""
        port = joint_port("q_seed", self._leg.joints)
        found = self._one("inverse_near", port, nearest, NEAREST_BRANCH)
        return replace(
            found,
            locals=(*found.locals, *self._searched.ports),
            steps=(*found.steps, self._searched.bounds, self._searched.nearer),
            closed_form=iterated(self._mechanism, self._route, TARGET, found.signature),
        )

    def inverse_admissible(self) -> Solve:
        """The row within the limits, or what a search within them finds."""
        steps = (*self._steps("rows", "row_states"), *self._searched.within("rows", "row_states", self._slots))
        found = self._solve(admissible_words(self._mechanism, self._leg), steps, *self._results("rows", "row_states"))
        return replace(found, locals=(*found.locals, *self._searched.ports))

    def inverse_distance(self) -> Solve:
        """Of every row from the target."""
        output = Port("distance", (self._slots,), "m")
        words = signature(self._mechanism, self._leg.name, "inverse_distance", [TARGET], [output], _DISTANCE_DOC, "as inverse")
        last = Step(row_distances(self._mechanism, self._leg, output), ("rows", "p", *self._given, "distance"))
        return self._solve(words, (*self._steps("rows", "row_states"), last), *self._results("rows", "row_states"))

    def _one(self, name: str, port: Port, choose: Callable[[Mechanism, Limb, int], Function], doc: str) -> Solve:
        outputs = [joint_port("q", self._leg.joints), _STATUS]
        words = signature(self._mechanism, self._leg.name, name, [TARGET, port], outputs, doc, _SOURCE)
        last = Step(choose(self._mechanism, self._leg, self._slots), ("rows", "row_states", port.name, "q", "status"))
        return self._solve(words, (*self._steps("rows", "row_states"), last), *self._results("rows", "row_states"))

    def _solve(self, words: Signature, steps: tuple[Step, ...], *rows: Port) -> Solve:
        found = (BOUNDS, *self._results("roots", "root_states"), self._best, _FOUND, self._span, _REACH)
        return Solve(words, (*rows, *found), steps, callbacks=(self._profile, self._searched.motion))

    # ---- steps

    def _results(self, rows: str, states: str) -> tuple[Port, Port]:
        return row_ports(self._leg, self._found, rows, states)

    @property
    def _best(self) -> Port:
        return joint_port("best", self._leg.joints)

    @property
    def _span(self) -> Port:
        """Between which joint values to look for what comes closest."""
        return Port("span", (len(self._leg.joints), 2), "rad or m")

    def _steps(self, rows: str, states: str) -> tuple[Step, ...]:
        """The roots; where there are none, the search."""
        searched, closed = self._searched, int(self._leg.drives[0].kind == "revolute")
        results = ("roots", "root_states", "best", "found")
        asked = ("wg_any_unreachable", ("found", 1))
        search = ("p", "span", "span_reach", searched.sequence, searched.edges, searched.motion.signature.full_name, "best", "found")
        return (
            Step(self._spans, (*self._given, "bounds", "span", "span_reach")),
            Step("wg_crossings", ("bounds", "p", self._profile.signature.full_name, self._carried.sides, closed, *results)),
            Step("wg_closest_driven", search, asked),
            Step(self._filled, (*results, rows, states)),
        )

    @cached_property
    def _profile(self) -> Solve:
        return called_back(self._carried.profile, "carried")

    @cached_property
    def _spans(self) -> Function:
        """The drive's bounds, those of all joints, about how far the foot gets."""
        low, high = drive_bounds(self._mechanism, self._leg)
        held = self._leg.drives[0].kind == "prismatic"
        every = [(low, high) if held and joint is self._leg.drives[0] else (-sympy.oo, sympy.oo) for joint in self._leg.joints]
        outputs = [BOUNDS, self._span, _REACH]
        words = signature(self._mechanism, self._leg.name, "carried_spans", [], outputs, "", "")
        return Tape().function(words, [low, high, *(bound for pair in every for bound in pair), self._searched.reach])

    @cached_property
    def _filled(self) -> Function:
        """Rows, those of the search where nothing else is known."""
        roots, best = self._results("roots", "root_states"), symbols_of(self._best)
        values, states, (found,) = symbols_of(roots[0]), symbols_of(roots[1]), symbols_of(_FOUND)
        none, count = Same(states[0], UNREACHABLE), len(self._leg.joints)
        rows = [Select(none, best[place % count], value) for place, value in enumerate(values)]
        words = Signature(
            self._mechanism.name, self._leg.name, "carried_rows", (*roots, self._best, _FOUND), self._results("rows", "states")
        )
        return Tape().function(words, [*rows, chosen(none, found, states[0]), *states[1:]])
