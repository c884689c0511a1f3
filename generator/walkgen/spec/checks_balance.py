"""Rules of balancing: joints that the leg has, ranges that do not meet, parameters that may move."""

from collections.abc import Iterator

from walkgen.spec.balance import BalanceSpec
from walkgen.spec.evaluate import Numbers
from walkgen.spec.planar import pin_name
from walkgen.spec.problems import Finding, did_you_mean, shown
from walkgen.spec.scalar import Scalar
from walkgen.spec.schema import LegDesign, RobotSpec
from walkgen.spec.springs import MOUNT
from walkgen.spec.table import Path
from walkgen.spec.tree import design_of

_UNITS = ("", "_deg", "_mm")
CAMS = {"cam_on_link": "arm", "cam_on_frame": "anchor"}
"""Devices that are cams, and the length that each has alone."""


def check_balances(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Every balance of the spec, linkages in the long form."""
    for name, balance in spec.balance.items():
        path: Path = ("balance", name)
        leg = next((leg for leg in spec.legs if leg.name == balance.leg), None)
        if leg is None:
            cure = did_you_mean(balance.leg, (leg.name for leg in spec.legs), "legs")
            yield Finding("WG210", (*path, "leg"), f'there is no leg "{shown(balance.leg)}"', cure)
        elif (design := design_of(spec, leg)) is not None:
            yield from _leg(path, balance, design, numbers)
            if balance.cam is not None:
                yield from _cam((*path, "leg"), name, spec, design)
        yield from _parameters(path, balance, spec)


def _leg(path: Path, balance: BalanceSpec, design: LegDesign, numbers: Numbers) -> Iterator[Finding]:
    joints = dict(driven(design))
    for key in ("support", "transfer", "held"):
        for unit in _UNITS:
            for joint in getattr(balance, key + unit) or {}:
                yield from _joint((*path, key + unit, joint), joint, unit, joints)
    yield from _crossed(path, balance, numbers)
    yield from _relieved(path, balance)
    for joint in balance.supported.keys() & balance.transferred.keys():
        yield from _apart(path, joint, balance, numbers)
    if not design.springs and balance.device not in CAMS:
        yield Finding("WG212", (*path, "leg"), "the leg has no springs", "describe them: [[leg_designs.NAME.springs]]")
    known = (MOUNT, *(row.name for row in design.rows), *design.links)
    for link in balance.boxes:
        if link not in known:
            yield Finding("WG201", (*path, "boxes", link), f'there is no link "{shown(link)}"', did_you_mean(link, known, "links"))


def _cam(path: Path, name: str, spec: RobotSpec, design: LegDesign) -> Iterator[Finding]:
    """One cam a leg, on a link that turns, and no springs beside it."""
    balance = spec.balance[name]
    turning = [row.name for row in design.joints if row.type == "revolute"]
    if design.planar or not balance.supported.keys() <= set(turning):
        cure = f"balance one of {', '.join(turning)}" if turning and not design.planar else "balance this leg by springs"
        yield Finding("WG224", path, "a cam balances a joint in series that turns, of a leg without a linkage", cure)
    if design.springs:
        message = "the leg has springs: a cam balances what it weighs alone"
        yield Finding("WG224", path, message, "remove the springs, or the balance")
    if any(leg.name == balance.leg and leg.mirror_of for leg in spec.legs):
        yield Finding("WG224", path, "the leg is a mirror image, and has the cam of what it mirrors", "name the leg that it mirrors")
    others = [other for other, each in spec.balance.items() if each.cam is not None and each.leg == balance.leg]
    if others[0] != name:
        yield Finding("WG224", path, f"the leg has the cam of the balance {others[0]} already", "keep one of them")


def _relieved(path: Path, balance: BalanceSpec) -> Iterator[Finding]:
    """As many joints as the device takes, and what belongs to it."""
    ranged = balance.supported.keys() | balance.transferred.keys()
    if len(ranged) < 1 + (balance.device == "total") or (balance.device != "total" and len(ranged) > 1):
        wanted = "two joints or more" if balance.device == "total" else "one joint"
        message = f"the device {balance.device} relieves {wanted}, and {len(ranged)} have a range"
        yield Finding("WG211", path, message, "write support_deg = { hip = [-50, 40] } for each, or choose another device")
    needed = CAMS.get(balance.device)
    if (needed is None) != (balance.cam is None):
        cure = "remove the table cam" if needed is None else "write [balance.NAME.cam] with start, roller, stiffness, free_length and reach"
        yield Finding("WG221", (*path, "device"), f"the device {balance.device} and the table cam do not fit", cure)
    elif needed is not None and balance.cam is not None:
        if balance.transferred:
            message = "a cam balances one load: it has no range without it"
            yield Finding("WG221", path, message, "leave transfer out, or balance by springs")
        if getattr(balance.cam, needed) is None:
            message = f'missing key "{needed}" of the device {balance.device}'
            yield Finding("WG111", (*path, "cam", needed), message, f"write {needed} = 0.12 (m)")
        other = next(key for device, key in CAMS.items() if device != balance.device)
        if getattr(balance.cam, other) is not None:
            yield Finding(
                "WG221", (*path, "cam", other), f"{other} belongs to the other cam", f"remove {other}, or choose the other device"
            )


def driven(design: LegDesign) -> Iterator[tuple[str, str]]:
    """Name and kind of everything with a q: joints in series, driven pins, sliders, cylinders."""
    yield from ((row.name, row.type) for row in design.joints)
    yield from ((pin_name(pin.joins, pin.name), "revolute") for pin in design.pins if pin.driven)
    for pairs in (design.sliders, design.cylinders):
        yield from ((pair.name, "prismatic") for pair in pairs if pair.driven)
    yield from ((row.name, row.type) for row in design.joints_after)


def _joint(path: Path, joint: str, unit: str, joints: dict[str, str]) -> Iterator[Finding]:
    if joint not in joints:
        yield Finding("WG210", path, f'the leg has no joint "{shown(joint)}"', did_you_mean(joint, joints, "joints"))
    elif unit == {"revolute": "_mm", "prismatic": "_deg"}[joints[joint]]:
        what = "turns" if joints[joint] == "revolute" else "slides"
        yield Finding("WG123", path, f"the joint {joint} {what}: it has no values in {unit[1:]}", "write them in rad or m, or in deg or mm")


def _crossed(path: Path, balance: BalanceSpec, numbers: Numbers) -> Iterator[Finding]:
    for key in (f"{phase}{unit}" for phase in ("support", "transfer") for unit in _UNITS):
        for joint, pair in (getattr(balance, key) or {}).items():
            low, high = (numbers.number(entry) for entry in pair)
            if low is not None and high is not None and low >= high:
                message = f"{key} of {joint} is crossed or empty: {float(low):g} to {float(high):g}"
                yield Finding("WG160", (*path, key, joint), message, "give the least value first")


def _apart(path: Path, joint: str, balance: BalanceSpec, numbers: Numbers) -> Iterator[Finding]:
    """One range cannot ask for two moments at once."""
    (a, b), (c, d) = (_pair(ranges[joint], numbers) for ranges in (balance.supported, balance.transferred))
    low, high = max(a, c), min(b, d)
    if low < high:
        key = next(f"transfer{unit}" for unit in _UNITS if joint in (getattr(balance, f"transfer{unit}") or {}))
        message = f"support and transfer of {joint} overlap from {low:.4g} to {high:.4g}: the springs cannot tell them apart there"
        yield Finding("WG213", (*path, key, joint), message, "let them meet at most, or drop one of them")


def _pair(pair: tuple[Scalar, Scalar], numbers: Numbers) -> tuple[float, float]:
    low, high = (numbers.number(entry) for entry in pair)
    return (float("inf"), float("-inf")) if low is None or high is None else (float(low), float(high))


def _catalogue(path: Path, balance: BalanceSpec, spec: RobotSpec) -> Iterator[Finding]:
    """Every key of a row is the end of a parameter's name, for every spring."""
    leg = next((leg for leg in spec.legs if leg.name == balance.leg), None)
    design = design_of(spec, leg) if leg else None
    for index, row in enumerate(balance.catalogue):
        for key in row:
            for spring in design.springs if design else ():
                if f"{spring.name}_{key}" not in spec.parameters:
                    message = f'the catalogue gives "{shown(key)}", and there is no parameter {shown(spring.name)}_{shown(key)}'
                    cure = did_you_mean(f"{spring.name}_{key}", spec.parameters, "known parameters")
                    yield Finding("WG214", (*path, "catalogue", index, key), message, cure)


def _weighed(path: Path, balance: BalanceSpec, spec: RobotSpec) -> Iterator[Finding]:
    """Every spring has a parameter for its mass."""
    leg = next((leg for leg in spec.legs if leg.name == balance.leg), None)
    design = design_of(spec, leg) if leg else None
    for name in (f"{spring.name}_mass" for spring in (design.springs if design else ())):
        if name not in spec.parameters:
            cure = f'write {name} = 0.3 among [parameters], and masses = {{ at_second = "{name}/2" }} at the spring'
            yield Finding("WG214", path, f"there is no parameter {shown(name)} for the spring's mass", cure)
        elif name in (balance.vary or ()) or any("mass" in row for row in balance.catalogue):
            yield Finding("WG214", path, f"{shown(name)} is varied or chosen, and cannot be found", "leave it out there, or remove the key")


def _parameters(path: Path, balance: BalanceSpec, spec: RobotSpec) -> Iterator[Finding]:
    for index, name in enumerate(balance.vary or ()):
        here = (*path, "vary", index)
        if name not in spec.parameters:
            yield Finding("WG141", here, f'there is no parameter "{shown(name)}"', did_you_mean(name, spec.parameters, "known parameters"))
        elif spec.parameters[name].bounds is None:
            cure = f"write {name} = {{ value = ..., bounds = [low, high] }}"
            yield Finding("WG214", here, f"the parameter {name} has no bounds to vary between", cure)
    yield from _catalogue(path, balance, spec)
    if balance.energy_per_mass is not None:
        yield from _weighed((*path, "energy_per_mass"), balance, spec)
    if balance.device not in CAMS and balance.vary is None and not any(entry.bounds for entry in spec.parameters.values()):
        yield Finding(
            "WG214", (*path, "vary"), "no parameter has bounds to vary between", "write x = { value = 0.1, bounds = [0.05, 0.2] }"
        )
