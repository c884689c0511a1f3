"""Legs with linkages as `adapt` takes them: by functions of their own, since their feet do not follow from axes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.model.classify import CARRIED, inverse_class
from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.signature import Port, Records
from walkgen.symbolic.branches import UNREACHABLE
from walkgen.symbolic.driven_search import DrivenSearch, inverse_driven
from walkgen.symbolic.first_root import whole
from walkgen.symbolic.forward import Route
from walkgen.symbolic.function import Derivation, Function, Solve
from walkgen.symbolic.linkage_rows import inverses
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.rows import TARGET
from walkgen.symbolic.tape import Tape, symbols_of

_AIM, _STATUS = Port("aim", (6,)), Port("status", kind="integer")
_MOST_ROWS = 96
"""As many as the routine has room for; of legs with more one pose is sought from a seed."""


def driven_legs(mechanism: Mechanism) -> tuple[Records, tuple[Solve, ...]]:
    """A row for every leg, which is empty where the leg is one of joints in series, and the functions that rows name."""
    legs = [DrivenLeg(mechanism, leg) if leg.linkage else None for leg in mechanism.legs]
    rows = tuple(leg.record if leg else () for leg in legs)
    return Records("wg_driven_leg", rows), tuple(callback for leg in legs if leg for callback in leg.callbacks)


@dataclass(frozen=True)
class DrivenLeg:
    """One leg: its foot, all its poses at a target, and a pose somewhere."""

    mechanism: Mechanism
    leg: Limb

    @property
    def record(self) -> tuple[str | int, ...]:
        """The functions' names, how many poses there are, and the number of the platform."""
        return (*(callback.signature.full_name for callback in self.callbacks), self._slots, self.leg.platform)

    @cached_property
    def callbacks(self) -> tuple[Solve, ...]:
        """In the order of the routine's struct."""
        return self.search.foot, self._called("adapt_rows", self._inverse), self._called("adapt_somewhere", self._somewhere)

    @cached_property
    def search(self) -> DrivenSearch:
        """In the leg's drives."""
        return DrivenSearch(self.mechanism, Route(self.leg.name, (self.leg,)))

    def numbers(self) -> Iterator[sympy.Expr]:
        """Axes and points: a routine that needs a length takes the foot's lever about them."""
        for _ in self.leg.joints:
            yield from (*(sympy.S.Zero for _ in range(2)), sympy.S.One, *(sympy.S.Zero for _ in range(3)))

    @property
    def foot(self) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
        """As far away as the foot gets."""
        return self.search.reach, sympy.S.Zero, sympy.S.Zero

    @property
    def _slots(self) -> int:
        """One where rows are unknown, too many, or take a search along the drive for every target that is tried."""
        found = inverse_class(self.mechanism, self.leg)
        return len(found.branch_names) if found.name not in ("", CARRIED) and len(found.branch_names) <= _MOST_ROWS else 1

    @property
    def _inverse(self) -> Derivation:
        """All poses, or one near a seed."""
        if inverse_class(self.mechanism, self.leg).name and len(inverse_class(self.mechanism, self.leg).branch_names) == self._slots:
            return next(iter(inverses(self.mechanism, self.leg)))
        return inverse_driven(self.mechanism, self.search.route)

    @property
    def _somewhere(self) -> Solve:
        """Closest to the target within the limits, whatever the seed."""
        q, seed = (joint_port(name, self.leg.joints) for name in ("q", "q_seed"))
        words = signature(self.mechanism, self.leg.name, "adapt_guess", [seed], [q, _STATUS], "", "")
        guess = Tape().function(words, [*symbols_of(seed), UNREACHABLE])
        search = self.search
        steps = (search.bounds, whole(guess), search.closest)
        return Solve(words, search.ports, steps, callbacks=(search.motion,))

    def _called(self, name: str, found: Derivation) -> Solve:
        """As the routine calls it: of a target with a seed."""
        own = found if isinstance(found, Solve) else Solve(found.signature, (), (whole(found),))
        words, alone = own.signature, own.signature.returned is not None
        seed = joint_port("q_seed", self.leg.joints)
        listed = self._listed(words.outputs) if alone else None
        outputs = listed.signature.outputs if listed else words.outputs
        inner = (TARGET, seed, *own.locals, *(words.outputs if listed else ()))
        steps = (whole(self._apart(seed)), *own.steps, *([whole(listed)] if listed else []))
        outer = signature(self.mechanism, self.leg.name, name, [_AIM], outputs, "", "")
        return Solve(outer, inner, steps, tables=own.tables, callbacks=own.callbacks)

    def _apart(self, seed: Port) -> Function:
        words = signature(self.mechanism, self.leg.name, "adapt_apart", [_AIM], [TARGET, seed], "", "")
        return Tape().function(words, symbols_of(_AIM))

    def _listed(self, found: Sequence[Port]) -> Function:
        """One pose as a row."""
        outputs = [Port("rows", (1, len(self.leg.joints))), Port("states", (1,), kind="integer")]
        words = signature(self.mechanism, self.leg.name, "adapt_listed", found, outputs, "", "")
        return Tape().function(words, [symbol for port in found for symbol in symbols_of(port)])


def kind_of(joint: Joint, *, driven: bool) -> int:
    """1 slides; joints of legs that are no chains of axes slide in their foot's Jacobian, even where q is an angle, 2."""
    return 1 if joint.kind == "prismatic" else 2 if driven else 0
