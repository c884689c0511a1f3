"""Equal legs: what is derived for one serves all that differ from it in name and place alone."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from walkgen.model.mechanism import Limb
from walkgen.signature import Argument, Signature
from walkgen.symbolic.function import Derivation, Function, Solve, Step

Arguments = tuple[Argument, ...]


def of_legs(legs: Iterable[Limb], derived: Callable[[Limb], Iterable[Derivation]]) -> Iterator[Derivation]:
    """The functions of each leg in turn.

    Args:
        legs: of the robot.
        derived: a leg's functions, in the frame of its platform.
    """
    known: list[tuple[Limb, tuple[Derivation, ...]]] = []
    for leg in legs:
        first = next((functions for other, functions in known if _alike(leg, other)), None)
        if first is None:
            known.append((leg, tuple(derived(leg))))
        yield from known[-1][1] if first is None else (_owned(function, leg.name) for function in first)


def _alike(leg: Limb, other: Limb) -> bool:
    return not _has_unknowns(leg) and replace(leg, name=other.name, platform=other.platform) == other


def _has_unknowns(leg: Limb) -> bool:
    """Whether its functions rest on unknowns, which are called after it (closing.py)."""
    return leg.curved_sole is not None or (leg.linkage is not None and bool(leg.linkage.forward.triads))


def _owned(function: Derivation, owner: str) -> Derivation:
    """The same for another leg: what has the leg's name in its own gets the other's."""
    return _Renaming(function.signature, owner).derivation(function)


class _Renaming:
    """From one owner's full names to another's."""

    def __init__(self, signature: Signature, owner: str) -> None:
        self._before, self._after = (f"{signature.robot}_{name}_" for name in (signature.owner, owner))
        self._from, self._to = signature.owner, owner

    def derivation(self, derivation: Derivation) -> Derivation:
        """With all that it calls."""
        return self.function(derivation) if isinstance(derivation, Function) else self.solve(derivation)

    def function(self, function: Function) -> Function:
        """One that has no name but its signature's."""
        return replace(function, signature=self.signature(function.signature))

    def solve(self, solve: Solve) -> Solve:
        """With its tables and what it calls back."""
        return replace(
            solve,
            signature=self.signature(solve.signature),
            steps=tuple(map(self.step, solve.steps)),
            closed_form=None if solve.closed_form is None else self.derivation(solve.closed_form),
            tables=tuple(replace(table, name=self.name(table.name)) for table in solve.tables),
            callbacks=tuple(map(self.solve, solve.callbacks)),
            slopes=tuple(map(self.step, solve.slopes)),
        )

    def signature(self, signature: Signature) -> Signature:
        """What belongs to nobody stays so."""
        return replace(signature, owner=self._to) if signature.owner == self._from else signature

    def step(self, step: Step) -> Step:
        """With names among its arguments."""
        guard = None if step.guard is None else (step.guard[0], self.arguments(step.guard[1]))
        callee = self.function(step.callee) if isinstance(step.callee, Function) else step.callee
        return replace(step, callee=callee, arguments=self.arguments(step.arguments), guard=guard)

    def arguments(self, arguments: Arguments) -> Arguments:
        """Tables and callbacks by their new names."""
        return tuple(self.name(argument) if isinstance(argument, str) else argument for argument in arguments)

    def name(self, name: str) -> str:
        """Of a table, a callback or anything else."""
        return self._after + name.removeprefix(self._before) if name.startswith(self._before) else name
