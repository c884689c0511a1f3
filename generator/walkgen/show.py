"""Any stage's product as text for people: the spec's exact numbers, the mechanism, equations, straight-line programs."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path

from pydantic import BaseModel

from walkgen import pipeline
from walkgen.examine import coverage_of, drives_text, percent
from walkgen.graph.coverage import titled
from walkgen.model.classify import inverse_class
from walkgen.model.gait import Gait, Schedule
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Joint, Limb, Mechanism, Transform
from walkgen.model.springs import Spring
from walkgen.show_code import chosen, equations, listing
from walkgen.spec.assur import SIDES, Triad
from walkgen.spec.scalar import Apply, Exact, Name, Pi, Scalar
from walkgen.spec.springs import MOUNT
from walkgen.symbolic.starts import start_of

_INFIX = {"add": " + ", "sub": " - ", "mul": "*", "div": "/", "pow": "**"}
_AXES = "xyz"


def show(path: Path, stage: str, name: str) -> str:
    """The product of a stage.

    Args:
        path: the spec.
        stage: "spec", "mechanism", "functions" or "program".
        name: only this function (full name, or name without robot and leg); all if empty.

    Raises:
        WalkgenError: the spec is wrong, or it has no such function.
    """
    views: dict[str, Callable[[Path, str], Iterable[str]]] = {
        "spec": lambda path, _: _tree(pipeline.spec_of(path), 0),
        "mechanism": lambda path, _: _mechanism(pipeline.mechanism_of(path)),
        "functions": _functions,
        "program": _programs,
    }
    return "\n".join(views[stage](path, name))


def scalar_text(scalar: Scalar) -> str:
    """The number as a person writes it: decimals where they end, multiples of pi, names, brackets where needed."""
    if isinstance(scalar, Apply):
        return _applied(scalar.function, scalar.arguments)
    if isinstance(scalar, Exact):
        return _fraction(scalar.value)
    return scalar.name if isinstance(scalar, Name) else "pi"


def _applied(function: str, arguments: tuple[Scalar, ...]) -> str:
    if function == "mul" and isinstance(arguments[0], Exact) and isinstance(arguments[1], Pi):
        return _pi_multiple(arguments[0].value)
    texts = [scalar_text(argument) for argument in arguments]
    if function == "neg":
        return f"-({texts[0]})" if " " in texts[0] else f"-{texts[0]}"
    if function in _INFIX:
        return _INFIX[function].join(_bracketed(*pair) for pair in zip(arguments, texts, strict=True))
    return f"{function}({', '.join(texts)})"


def _fraction(value: Fraction) -> str:
    rest = value.denominator
    for prime in (2, 5):
        while rest % prime == 0:
            rest //= prime
    if rest != 1:
        return f"{value.numerator}/{value.denominator}"
    places = len(str(value.denominator)) * 4
    digits = str(abs(value.numerator) * 10**places // value.denominator).rjust(places + 1, "0")
    text = f"{digits[:-places]}.{digits[-places:]}".rstrip("0").rstrip(".")
    return f"-{text}" if value < 0 else text


def _pi_multiple(factor: Fraction) -> str:
    sign = "-" if factor < 0 else ""
    times = "" if abs(factor.numerator) == 1 else f"{abs(factor.numerator)}*"
    over = "" if factor.denominator == 1 else f"/{factor.denominator}"
    return f"{sign}{times}pi{over}"


def _bracketed(scalar: Scalar, text: str) -> str:
    infix = isinstance(scalar, Apply) and (scalar.function in _INFIX or scalar.function == "neg")
    return f"({text})" if infix or text.startswith("-") or "/" in text else text


def _tree(value: object, depth: int) -> Iterator[str]:
    """Nested models as indented `key = value` lines; what was not given is left out."""
    indent = "    " * depth
    items: Iterable[tuple[object, object]]
    if isinstance(value, BaseModel):
        items = ((key, getattr(value, key)) for key in type(value).model_fields)
    elif isinstance(value, dict):
        items = value.items()
    else:
        items = enumerate(value) if isinstance(value, tuple) else ()
    for key, entry in items:
        if entry is None or entry in ((), {}):
            continue
        leaf = _leaf(entry)
        yield f"{indent}{key}" if leaf is None else f"{indent}{key} = {leaf}"
        if leaf is None:
            yield from _tree(entry, depth + 1)


def _leaf(entry: object) -> str | None:
    """The text of a value without structure of its own; None for tables."""
    if isinstance(entry, Exact | Pi | Name | Apply):
        return scalar_text(entry)
    if isinstance(entry, tuple):
        parts = [_leaf(part) for part in entry]
        return None if None in parts else f"[{', '.join(part for part in parts if part is not None)}]"
    return None if isinstance(entry, BaseModel | dict) else str(entry)


def _mechanism(mechanism: Mechanism) -> Iterator[str]:
    platforms = [platform.name for platform in mechanism.platforms]
    joints = sum(len(limb.joints) for limb in mechanism.limbs)
    yield f"{mechanism.name}: {len(platforms)} platforms, {len(mechanism.chains)} chains, {len(mechanism.legs)} legs, {joints} joints"
    if mechanism.description:
        yield f"    {mechanism.description}"
    for parameter in mechanism.parameters:
        yield f"runtime parameter {parameter.name} = {scalar_text(parameter.default)} {parameter.unit}"
    for chain in mechanism.chains:
        child = "" if chain.child is None else f" to {platforms[chain.child]}"
        yield from _limb(f"chain {chain.name}: {platforms[chain.platform]}{child}", chain)
    for leg in mechanism.legs:
        yield from _limb(f"leg {leg.name} on {platforms[leg.platform]}", leg)
        if leg.linkage is not None:
            yield from _start(mechanism, leg, leg.linkage)
            yield from _coverage(mechanism, leg, leg.linkage)
        yield from _inverse(mechanism, leg)
    for gait in mechanism.gaits:
        legs = [leg.name for leg in mechanism.legs]
        yield from _gait(gait, legs) if isinstance(gait, Gait) else _schedule(gait, legs)


def _limb(title: str, limb: Limb) -> Iterator[str]:
    yield title
    yield f"    mount  {_transform(limb.mount)}"
    for joint in limb.serial:
        yield f"    {joint.name}  {_joint(joint)}"
    yield f"    {'plane' if limb.linkage else 'tip'}  {_transform(limb.tip)}"
    if limb.linkage is not None:
        yield from _linkage(limb.drives, limb.linkage)
    for joint in limb.distal:
        yield f"    {joint.name}  {_joint(joint)}"
    if limb.distal:
        yield f"    tip  {_transform(limb.foot)}"
    yield from (f"    spring {spring.name}  {_ends(limb, spring)}, {scalar_text(spring.stiffness)} N/m" for spring in limb.springs)
    yield from (f"    cam {cam.name}  on the {cam.on}, balances {limb.joints[cam.joint].name}" for cam in limb.cams)
    if limb.sole:
        yield f"    sole  {scalar_text(limb.sole.length)} by {scalar_text(limb.sole.width)}, {_transform(limb.sole.turn)}"
    if limb.curved_sole:
        flat = " to ".join(scalar_text(edge) for edge in (limb.curved_sole.rear, limb.curved_sole.front))
        curves = ", ".join(limb.curved_sole.curves())
        yield f"    curved sole  flat from {flat} at {scalar_text(limb.curved_sole.depth)} below the ankle; rolls over {curves}"


def _ends(limb: Limb, spring: Spring) -> str:
    """What it joins: links of the linkage, joints that move the others, the mount."""
    serial, planar = (MOUNT, *(joint.name for joint in limb.serial)), limb.linkage.structure.names if limb.linkage else ()
    return " to ".join((planar if end.planar else serial)[end.link] for end in spring.ends)


def _linkage(drives: Sequence[Joint], linkage: Linkage) -> Iterator[str]:
    """How many freedoms, the drives, and the dyads with their sides."""
    names = linkage.structure.names
    links, freedoms = len(names) - len(linkage.structure.bars), linkage.structure.mobility
    yield f"    linkage of {links} links, {freedoms} degrees of freedom in its plane by count"
    for drive in drives:
        limits = f"  q in [{', '.join(scalar_text(limit) for limit in drive.limits)}]" if drive.limits else ""
        yield f"    {drive.name}  {drive.kind} drive{limits}"
    for group in linkage.forward.groups:
        if isinstance(group, Triad):
            yield f"    triad {group.name}  {_struts(group, linkage)} between {names[group.ends[0]]} and {names[group.ends[1]]}"
            continue
        sides = SIDES[group.kind]
        chosen = f", on side {sides[0 if linkage.side(group) > 0 else 1]} ({' or '.join(sides)})" if sides else ""
        base, first, second = (names[body] for body in group.bodies)
        yield f"    dyad {group.name}  {group.kind}: {first} and {second} on {base}{chosen}"


def _struts(triad: Triad, linkage: Linkage) -> str:
    """Its three links between two, with the kinds of their pairs."""
    structure = linkage.structure
    kinds = ("".join(structure.pairs[pair].kind for pair in strut.pairs) for strut in triad.struts)
    return ", ".join(f"{kind} {structure.names[strut.body]}" for kind, strut in zip(kinds, triad.struts, strict=True))


def _start(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> Iterator[str]:
    """Where triads start from, and all that they could be there: the chosen one first, each with the angles of links that tell it."""
    if not linkage.forward.triads:
        return
    found, names = start_of(mechanism, leg), linkage.structure.names
    if found is None:
        yield "    start: no assembly is found"
        return
    drives = ", ".join(f"{drive.name} = {float(value):.6g}" for drive, value in zip(leg.drives, found.drives, strict=True))
    yield f"    start at {drives}: {len(found.modes)} assemblies, the first is taken; start = {{ angles_deg = ... }} takes another"
    ternary = [names[max(triad.ends)] for triad in linkage.forward.triads]
    for mode in found.modes:
        angles = ", ".join(f"{name} = {degrees:.1f}" for name, degrees in zip(ternary, mode.degrees, strict=True))
        yield f"        angles_deg = {{ {angles} }}, sine of the transmission angle at least {mode.sine:.2g}"


def _coverage(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> Iterator[str]:
    """Freedoms by rank, how much of the drives' limits assembles, and what fails in the rest."""
    found, drives = coverage_of(mechanism, leg, linkage), leg.drives
    if found.best is not None and found.mobility is not None:
        twice = f": {', '.join(found.mobility.pairs)} say one thing twice" if found.mobility.pairs else ""
        where = drives_text(drives, found.best)
        yield f"    {found.mobility.freedoms} degrees of freedom by the rank of its pairs' equations at {where}{twice}"
    if found.limited and found.points:
        failing = "".join(f"; {titled(linkage, each.group)} cannot close in {percent(each.count, found.points)}" for each in found.failing)
        yield f"    assembles in {percent(found.assembled, found.points)} of the drives' limits{failing}"


def _joint(joint: Joint) -> str:
    sign, zero = ("-" if joint.sign < 0 else ""), scalar_text(joint.zero)
    motion = f"{'R' if joint.kind == 'revolute' else 'T'}z({sign}q{'' if zero == '0' else f' + {zero}'})"
    steps = " ".join(part for part in (_motions(joint.before), motion, _motions(joint.after)) if part)
    limits = f"  q in [{', '.join(scalar_text(limit) for limit in joint.limits)}]" if joint.limits else ""
    return f"{joint.kind}: {steps}{limits}"


def _transform(transform: Transform) -> str:
    return _motions(transform) or "identity"


def _motions(transform: Transform) -> str:
    return " ".join(f"{'R' if motion.kind == 'rotate' else 'T'}{_AXES[motion.axis]}({scalar_text(motion.amount)})" for motion in transform)


def _gait(gait: Gait, legs: Sequence[str]) -> Iterator[str]:
    """How long and how far, and when each leg supports."""
    name = f" {gait.name}" if gait.name else ""
    yield f"gait{name}: {gait.kind}, period {_fraction(gait.period)} s, stride {_fraction(gait.stride)} m"
    for leg, duty, phase in zip(legs, gait.duty_factor, gait.phase, strict=True):
        yield f"    {leg}  supports {_fraction(duty)} of the period from {_fraction(phase)} on"


def _schedule(gait: Schedule, legs: Sequence[str]) -> Iterator[str]:
    """What happens when."""
    name = f" {gait.name}" if gait.name else ""
    up = ", ".join(leg for leg, lifted in zip(legs, gait.lifted, strict=True) if lifted)
    yield f"gait{name}: {len(gait.events)} events; in transfer before them: {up or 'no leg'}"
    for event in gait.events:
        yield f"    {_fraction(event.at)} s  {event.does} {legs[event.leg]}"


def _inverse(mechanism: Mechanism, leg: Limb) -> Iterator[str]:
    found = inverse_class(mechanism, leg)
    yield f"    inverse: {found.name or 'none in closed form'}: {found.reason}"
    if found.branch_names:
        yield f"    branches: {', '.join(found.branch_names)}"


def _functions(path: Path, name: str) -> Iterator[str]:
    functions = pipeline.functions_of(path)
    reasons = tuple(_reasons(pipeline.mechanism_of(path), name)) if name.endswith("inverse") else ()
    yield from reasons
    if reasons and name not in {part for function in functions for part in (function.signature.name, function.signature.full_name)}:
        return
    for function in chosen(functions, name):
        yield from equations(function)
        yield ""


def _reasons(mechanism: Mechanism, name: str) -> Iterator[str]:
    """Why each leg meant by the name of an inverse has the class it has."""
    for leg in mechanism.legs:
        if name in {"inverse", f"{mechanism.name}_{leg.name}_inverse"}:
            yield f"leg {leg.name}"
            yield from _inverse(mechanism, leg)
            yield ""


def _programs(path: Path, name: str) -> Iterator[str]:
    for program in chosen(pipeline.programs_of(path), name):
        yield from listing(program, whole=bool(name))
        yield ""
