"""Rules of gaits: keys of each kind, legs that exist and are all there, factors in their range, three points that support a static one."""

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from itertools import compress

from walkgen.gait import phases
from walkgen.spec.checks_events import check_order, unsupported
from walkgen.spec.evaluate import Numbers
from walkgen.spec.gait import ONLY, GaitSpec
from walkgen.spec.gait_timing import WITHOUT_DUTY, Timing, timing
from walkgen.spec.problems import Finding, did_you_mean, shown
from walkgen.spec.scalar import Scalar, names, substitute
from walkgen.spec.schema import RobotSpec
from walkgen.spec.shapes import STAND_IN_NAME
from walkgen.spec.table import Path, entries, is_scalar
from walkgen.spec.tree import contacts_of

OWNER = "gait"
"""Whose functions those of the only gait are; those of a named one are gait_<name>'s."""
_PAIRS: Mapping[str, int] = {"tripod": 3, "crawl": 2, "trot": 2}
_SIDED = ("left", "right")
_UNSIDED = {"free": ("phase",), "events": ("events",)}
"""Kinds of gaits without sides, and what says instead when their legs step."""
_PERIODIC = ("period", "duty_factor")
_OPTIONAL: Mapping[str, tuple[str, ...]] = {"follow_the_leader": ("pitch",), "free": ("phase",), "events": ("events", "lifted")}
_FASTEST = 10**300
_CYCLIC = ("heel_off",)
_OWN_KEYS = (*_SIDED, "phase", "pitch", "events", "lifted")


def gaits_of(spec: RobotSpec) -> Iterator[tuple[str, Path, GaitSpec]]:
    """Name, place and table of every gait."""
    if isinstance(spec.gait, GaitSpec):
        yield ONLY, ("gait",), spec.gait
    else:
        yield from ((name, ("gait", name), gait) for name, gait in (spec.gait or {}).items())


def gait_owner(name: str) -> str:
    """Whose functions the gait's are called."""
    return f"{OWNER}_{name}" if name else OWNER


def is_static(gait: GaitSpec) -> bool:
    """Whether three legs, or a sole, are meant to support at every instant."""
    return gait.kind != "trot" if gait.static is None else gait.static


def check_gaits(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Every gait by itself, and the names that gaits take."""
    for _, path, gait in gaits_of(spec):
        found = (*_keys(path, gait), *_legs(path, gait, spec), *_numbers(path, gait, spec, numbers))
        yield from found
        if not found and _computable(gait, numbers):
            yield from _supported(path, gait, spec, numbers) if gait.events is None else _events(path, gait, spec, numbers)
            yield from _free_places(path, gait, numbers)
    yield from _owners(spec)


def _keys(path: Path, gait: GaitSpec) -> Iterator[Finding]:
    because = ((*path, "kind"),)
    for key in _needed(gait):
        if _missing(gait, key):
            yield Finding("WG111", (*path, key), f'missing key "{key}" of a gait "{gait.kind}"', f"write {key} = ...", because)
    if gait.events == ():
        yield Finding(
            "WG112", (*path, "events"), "the list has no entries, which are too few", "list what happens in order of time", because
        )
    allowed = (*(() if gait.kind in _UNSIDED else _SIDED), *_OPTIONAL.get(gait.kind, ()))
    for key in (*_OWN_KEYS, *((*_PERIODIC, *_CYCLIC) if gait.kind == "events" else ())):
        if key not in allowed and not _missing(gait, key):
            cure = f"it has {', '.join(allowed)}"
            yield Finding("WG124", (*path, key), f'{key} does not belong to a gait "{gait.kind}"', cure, because)
    if gait.kind not in _UNSIDED and isinstance(gait.duty_factor, dict):
        cure = 'give one number, or write kind = "free" with a phase for each leg'
        yield Finding("WG124", (*path, "duty_factor"), f'the legs of a gait "{gait.kind}" have one duty factor', cure, because)
    if gait.body == "level" and not _missing(gait, "margin"):
        yield Finding("WG124", (*path, "margin"), "a level body keeps no margin", 'write body = "waved" or body = "swinging"')


def _needed(gait: GaitSpec) -> Iterator[str]:
    yield from _UNSIDED.get(gait.kind, _SIDED)
    if gait.kind != "events":
        yield "period"
    if gait.kind not in WITHOUT_DUTY:
        yield "duty_factor"
    if gait.kind == "follow_the_leader":
        yield from ("pitch", "stride")
    if gait.stance is not None:
        yield "lift"
    if gait.body != "level":
        yield "margin"


def _missing(gait: GaitSpec, key: str) -> bool:
    return getattr(gait, key) is None and getattr(gait, f"{key}_mm", None) is None


def _legs(path: Path, gait: GaitSpec, spec: RobotSpec) -> Iterator[Finding]:
    """Legs that a gait names exist; each list or table has every leg once."""
    known = [leg.name for leg in spec.legs]
    for key in ("phase", "duty_factor", "stance"):
        table = getattr(gait, key)
        if isinstance(table, dict):
            yield from _references([((*path, key, leg), leg) for leg in table], known)
            yield from _all_there((*path, key), list(table), known)
    if isinstance(gait.stance, str):
        yield from _same_stance(path, gait.stance, spec)
    listed = [((*path, side, place), leg) for side in _SIDED for place, leg in enumerate(getattr(gait, side) or ())]
    placed = [((*path, "lifted", place), leg) for place, leg in enumerate(gait.lifted or ())]
    placed += [((*path, "events", place, "leg"), event.leg) for place, event in enumerate(gait.events or ())]
    yield from _references([*listed, *placed], known)
    if gait.left is not None and gait.right is not None:
        yield from _all_there((*path, "left"), [leg for _, leg in listed], known)
        yield from _paired(path, gait, len(gait.left), len(gait.right))


def _same_stance(path: Path, name: str, spec: RobotSpec) -> Iterator[Finding]:
    known = [other for other, _, gait in gaits_of(spec) if other and isinstance(gait.stance, dict)]
    if name not in known:
        cure = did_you_mean(name, known, "gaits with a stance")
        yield Finding("WG140", (*path, "stance"), f'there is no gait "{shown(name)}" with a stance of its own', cure)


def _references(listed: Iterable[tuple[Path, str]], known: list[str]) -> Iterator[Finding]:
    for place, leg in listed:
        if leg not in known and STAND_IN_NAME not in known:
            yield Finding("WG140", place, f'there is no leg "{shown(leg)}"', did_you_mean(leg, known, "known legs"))


def _all_there(path: Path, given: list[str], known: list[str]) -> Iterator[Finding]:
    missing = [leg for leg in known if leg not in given]
    twice = sorted({leg for leg in given if given.count(leg) > 1})
    if missing and set(given) <= set(known):  # else a misspelt name says it
        yield Finding("WG195", path, f"{_listed(missing)} not in the gait", "name every leg of the robot once", (("legs",),))
    if twice:
        yield Finding("WG195", path, f"{_listed(twice)} in the gait more than once", "name every leg of the robot once")


def _listed(legs: list[str]) -> str:
    return f"{', '.join(map(shown, legs))} {'is' if len(legs) == 1 else 'are'}"


def _paired(path: Path, gait: GaitSpec, left: int, right: int) -> Iterator[Finding]:
    pairs = _PAIRS.get(gait.kind, left)
    if (left, right) != (pairs, pairs) or not pairs:
        count = f"{pairs} legs" if gait.kind in _PAIRS else "as many legs"
        message = f'a gait "{gait.kind}" has {count} on each side, not {left} on the left and {right} on the right'
        yield Finding("WG195", (*path, "left"), message, "list the legs from the front, each beside one on the other side")


def _numbers(path: Path, gait: GaitSpec, spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Duty factors between 0 and 1; nothing that is known only when the code runs."""
    factors = gait.duty_factor if isinstance(gait.duty_factor, dict) else {ONLY: gait.duty_factor}
    for leg, factor in factors.items():
        value = numbers.number(factor)
        if value is not None and not 0 < float(value) < 1:
            place = (*path, "duty_factor", leg) if leg else (*path, "duty_factor")
            yield Finding("WG196", place, f"a duty factor of {float(value):g} is not between 0 and 1", _duty_cure(value))
    heel_off = numbers.number(gait.heel_off)
    if heel_off is not None and not 0 <= heel_off < 1:
        message = f"a heel that is lifted after {float(heel_off):g} of the support"
        yield Finding("WG161", (*path, "heel_off"), message, "give a share of the support, less than 1")
    for place, scalar in entries(gait, path):
        if is_scalar(scalar):
            yield from _fixed(place, scalar, spec, numbers)
    yield from _speed(path, gait, numbers)


def _speed(path: Path, gait: GaitSpec, numbers: Numbers) -> Iterator[Finding]:
    stride, period = (numbers.number(scalar) for scalar in (gait.si("stride"), gait.period))
    if stride is not None and period is not None and period > 0 and abs(Fraction(stride) / Fraction(period)) > _FASTEST:
        yield Finding("WG113", (*path, "stride"), "stride / period is not a speed that a double can hold", "give m, and s")


def _duty_cure(value: Fraction | float) -> str:
    per_cent = f", {float(value) / 100:g} if per cent were meant" if 1 < value < 100 else ""
    return f"give the share of the period in which the leg supports{per_cent}"


def _fixed(place: Path, scalar: Scalar, spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    running = sorted(name for name in names(substitute(scalar, numbers.constants)) if name in spec.parameters)
    if running:
        message = f'the runtime parameter "{shown(running[0])}" is not known when the gait is generated'
        yield Finding("WG199", place, message, "give a number, or a parameter without runtime = true")


def _computable(gait: GaitSpec, numbers: Numbers) -> bool:
    return all(numbers.number(scalar) is not None for _, scalar in entries(gait) if is_scalar(scalar))


def _fraction(numbers: Numbers, scalar: Scalar | None) -> Fraction:
    value = numbers.number(scalar)
    assert value is not None
    return Fraction(value)


def _timing(gait: GaitSpec, numbers: Numbers) -> Timing | None:
    try:
        return timing(gait, lambda scalar: _fraction(numbers, scalar))
    except ZeroDivisionError:
        return None


def _supported(path: Path, gait: GaitSpec, spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Three legs, or a sole, support a static gait at every instant."""
    times = _timing(gait, numbers)
    if not times or not is_static(gait):
        return
    duty, phase = zip(*times.values(), strict=True)
    contacts = contacts_of(spec)
    points = [contacts[leg] for leg in times]
    short = [span for span in phases.spans(duty, phase) if sum(compress(points, span[2])) < phases.STATIC]
    if short:
        start, end, downs = min(short, key=lambda span: sum(span[2]))
        place = next((key for key in ("static", "duty_factor") if not _missing(gait, key)), "kind")
        at = float(start * _fraction(numbers, gait.period))
        message = f"from {float(start):.4g} to {float(end):.4g} of the period (t = {at:.4g} s) {_standing(list(times), downs)}"
        yield Finding("WG197", (*path, place), message, _static_cure(len(times)))


def _events(path: Path, gait: GaitSpec, spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Events that can follow each other; three legs, or a sole, support a static gait from first to last, and before and after."""
    legs = [leg.name for leg in spec.legs]
    wrong = tuple(check_order(path, gait, numbers))
    yield from wrong
    found = None if wrong or not is_static(gait) else unsupported(gait, contacts_of(spec), numbers)
    if found is not None:
        number, when, downs = found
        place: Path = (*path, "lifted") if number < 0 else (*path, "events", number)
        cure = "place a leg before the next one is lifted; or write static = false"
        yield Finding("WG197", place, f"{when} {_standing(legs, downs)}", cure)


def _standing(legs: list[str], downs: tuple[bool, ...]) -> str:
    down, up = list(compress(legs, downs)), list(compress(legs, (not here for here in downs)))
    supporting = f"only {', '.join(down)}" if down else "no leg"
    return f"{supporting} support{'s' if len(down) < 2 else ''} and {', '.join(up)} {'is' if len(up) < 2 else 'are'} in transfer"


def _static_cure(legs: int) -> str:
    if legs > phases.STATIC:
        least = Fraction(phases.STATIC, legs)
        return f"a static gait of {legs} legs needs duty factors of {least} on average at least; or write static = false"
    return "write static = false: three legs that support leave none to step" if legs == phases.STATIC else "write static = false"


def _free_places(path: Path, gait: GaitSpec, numbers: Numbers) -> Iterator[Finding]:
    """Of followers: the foot before has left its place."""
    if gait.kind != "follow_the_leader":
        return
    pitch, stride = (_fraction(numbers, gait.si(key)) for key in ("pitch", "stride"))
    times = _timing(gait, numbers)
    stroke = next(iter(times.values()))[0] * stride if times else stride
    if stride <= 0 or stroke > pitch:
        message = f"a stroke of {float(stroke):.4g} m is longer than the pitch of {float(pitch):.4g} m: the foot before is still there"
        message = message if stride > 0 else "a follower's stride is more than 0"
        yield Finding("WG198", (*path, "stride"), message, "take a stride of pitch / duty_factor at most")


def _owners(spec: RobotSpec) -> Iterator[Finding]:
    """The gaits' functions are called gait_..., so no leg's or platform's may be."""
    owners = {gait_owner(name) for name, _, _ in gaits_of(spec)}
    listed: list[tuple[Path, str]] = [(("legs", index, "name"), leg.name) for index, leg in enumerate(spec.legs)]
    listed += [(("platforms", index, "name"), platform.name) for index, platform in enumerate(spec.platforms)]
    for place, name in listed:
        if name in owners:
            yield Finding("WG133", place, f"the functions of a gait are called {shown(spec.robot.name)}_{name}_...", "rename it")
