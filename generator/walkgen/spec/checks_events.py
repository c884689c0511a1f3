"""Rules of gaits that are lists of events: in order of time, every leg lifted and placed in turn, three legs that support a static one."""

from collections.abc import Iterator, Mapping
from itertools import groupby

from walkgen.gait import phases
from walkgen.spec.evaluate import Numbers
from walkgen.spec.gait import GaitSpec
from walkgen.spec.problems import Finding, shown
from walkgen.spec.table import Path

_CURE = "list events in order of time, each leg lifted and placed in turn; lifted names those in transfer before the first"


def check_order(path: Path, gait: GaitSpec, numbers: Numbers) -> Iterator[Finding]:
    """Events that cannot follow those before them."""
    up = set(gait.lifted or ())
    last: dict[str, float] = {}
    times = _times(gait, numbers)
    because = tuple((*path, "events", number, *key) for number in range(len(times)) for key in ((), ("at",), ("leg",), ("does",)))
    for number, (event, at) in enumerate(zip(gait.events or (), times, strict=True)):
        leg, does = shown(event.leg), f"{event.does} of {shown(event.leg)} at {at:g} s"
        message = ""
        if number and at < times[number - 1]:
            message = f"the {does} stands after {times[number - 1]:g} s"
        elif (event.leg in up) == (event.does == "lift"):
            message = f"the {does}: {leg} is {'in transfer' if event.leg in up else 'placed'} already"
        elif last.get(event.leg) == at:
            message = f"the {does}: {leg} would be lifted and placed at one instant"
        if message:
            yield Finding("WG194", (*path, "events", number), message, _CURE, because)
        last[event.leg] = at
        (up.add if event.does == "lift" else up.discard)(event.leg)


def unsupported(gait: GaitSpec, contacts: Mapping[str, int], numbers: Numbers) -> tuple[int, str, tuple[bool, ...]] | None:
    """Where the legs that support have fewest points, if too few: the last event before, or -1; when, in words; which of them support."""

    def points(span: tuple[int, str, frozenset[str]]) -> int:
        return sum(count for leg, count in contacts.items() if leg not in span[2])

    found = min(_spans(gait, numbers), key=points, default=None)
    if found is None or points(found) >= phases.STATIC:
        return None
    number, when, up = found
    return number, when, tuple(leg not in up for leg in contacts)


def _spans(gait: GaitSpec, numbers: Numbers) -> Iterator[tuple[int, str, frozenset[str]]]:
    """The number of the event before, when, and the legs in transfer, of every time between events, before and after all."""
    up, times = set(gait.lifted or ()), _times(gait, numbers)
    yield -1, f"before {times[0]:g} s", frozenset(up)
    for at, group in groupby(range(len(times)), key=lambda number: times[number]):
        here = list(group)
        for event in (gait.events or ())[here[0] : here[-1] + 1]:
            (up.add if event.does == "lift" else up.discard)(event.leg)
        until = f"to {times[here[-1] + 1]:g} s" if here[-1] + 1 < len(times) else "on"
        yield here[-1], f"from {at:g} s {until}", frozenset(up)


def _times(gait: GaitSpec, numbers: Numbers) -> list[float]:
    return [float(numbers.number(event.at) or 0) for event in gait.events or ()]
