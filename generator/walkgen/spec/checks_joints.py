"""Rules of joints and soles: one geometry, one right unit for each quantity, radians that look like radians, one entry a joint."""

import math
from collections.abc import Iterator

from walkgen.spec.branches import branch_count
from walkgen.spec.checks_tree import joint_rows
from walkgen.spec.evaluate import Numbers
from walkgen.spec.joint_tables import JointRow
from walkgen.spec.problems import Finding, shown
from walkgen.spec.scalar import Scalar
from walkgen.spec.schema import Design, LegDesign, RobotSpec, SoleSpec
from walkgen.spec.table import Path, Table, entries
from walkgen.spec.tree import design_of

_ROW = ("a", "alpha", "d", "theta")
_REQUIRED = ("a", "alpha", "d")
_ORIGIN = ("xyz", "rpy", "axis")
_UNITS = ("_deg", "_mm")
_TURN = 2 * math.pi * (1 + 1e-9)
_TURNS_OF_LIMITS = 2
_CONVENTIONS = (
    'write dh = "classic" (Rz(theta) Tz(d) Tx(a) Rx(alpha)) or dh = "craig" (Rx(alpha) Tx(a) Rz(theta) Tz(d)); there is no default'
)


def check_joints(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Geometry of every joint, convention of every design, and the lists that have one entry a joint."""
    for key in ("leg_designs", "chain_designs"):
        for name, design in getattr(spec, key).items():
            if design.dh is None and any(_given(joint, _ROW) for joint in design.rows):
                yield Finding("WG120", (key, name, "dh"), "the DH convention is not named", _CONVENTIONS)
    yield from _branches(spec)
    yield from _soles(spec)
    for path, joint in joint_rows(spec):
        yield from _geometry(path, joint)
        yield from _units_of_kind(path, joint)
    for path, table, design in _users(spec):
        yield from _lists(path, table, design, numbers)


def _branches(spec: RobotSpec) -> Iterator[Finding]:
    """Every branch of the inverse of a leg of joints in series has a name, or none has."""
    for name, design in spec.leg_designs.items():
        if not design.planar:
            count = branch_count("".join(joint.type[0].upper() for joint in design.joints))
            yield from named_branches(("leg_designs", name, "branches"), design, count)


def named_branches(path: Path, design: LegDesign, count: int) -> Iterator[Finding]:
    """The inverse has as many branches as the design names, if it does."""
    if design.branches is not None and len(design.branches) != count:
        message = f"branches has {len(design.branches)} names; the inverse of these joints has {count or 'no'} branches"
        cure = f"give {count} names in their fixed order, or leave branches out" if count else "leave branches out: there is inverse_near"
        yield Finding("WG127", path, message, cure)


def _soles(spec: RobotSpec) -> Iterator[Finding]:
    """Every sole is a rectangle."""
    for path, sole in entries(spec):
        if isinstance(sole, SoleSpec):
            for key in ("length", "width"):
                if not _given(sole, (key,)):
                    yield Finding("WG111", (*path, key), f'missing key "{key}"', f"write {key} = 0.1 (m): a sole is a rectangle")


def check_units(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """No quantity in two units, and no angle in radians that must be degrees."""
    for path, table in entries(spec):
        if isinstance(table, Table):
            yield from _two_units(path, table)
            yield from _angles(path, table, numbers)


def _given(table: Table, quantities: tuple[str, ...]) -> list[str]:
    """The keys typed for these quantities, in any unit."""
    keys = [quantity + unit for quantity in quantities for unit in ("", *_UNITS)]
    return [key for key in keys if getattr(table, key, None) is not None]


def _geometry(path: Path, joint: JointRow) -> Iterator[Finding]:
    row, origin = _given(joint, _ROW), _given(joint, _ORIGIN)
    if row and origin:
        yield Finding("WG124", (*path, origin[0]), f"the joint has a DH row ({row[0]}) and an origin ({origin[0]})", "keep one of them")
    elif not row and not origin:
        rests_on = tuple((*path, key) for key in (*_ROW, *_ORIGIN))
        cure = "give a DH row (a, alpha_deg, d) or an origin and axis (xyz, rpy_deg, axis)"
        yield Finding("WG126", path, f'the joint "{shown(joint.name)}" has no geometry', cure, rests_on)
    elif origin and joint.axis is None:
        yield Finding("WG111", (*path, "axis"), 'missing key "axis"', "write axis = [0, 0, 1]: the joint's direction in its own frame")
    elif row:
        for key in _REQUIRED:
            if not _given(joint, (key,)):
                unit = "alpha_deg = 0" if key == "alpha" else f"{key} = 0.0 (m)"
                yield Finding("WG111", (*path, key), f'missing key "{key}"', f"write {unit}")


def _units_of_kind(path: Path, joint: JointRow) -> Iterator[Finding]:
    wrong, right = ("_mm", "rad, or _deg in the key") if joint.type == "revolute" else ("_deg", "m, or _mm in the key")
    for quantity in ("limits", "max_speed"):
        if getattr(joint, quantity + wrong) is not None:
            message = f"{quantity}{wrong}: the joint is {joint.type}"
            yield Finding("WG123", (*path, quantity + wrong), message, f"give {quantity} in {right}")


def _two_units(path: Path, table: Table) -> Iterator[Finding]:
    for quantity in type(table).model_fields:
        keys = _given(table, (quantity,))
        if len(keys) > 1 and not _of_different_names([getattr(table, key) for key in keys]):
            yield Finding(
                "WG122", (*path, keys[1]), f"{keys[1]}: {keys[0]} gives the same quantity already", f"remove {keys[0]} or {keys[1]}"
            )


def _of_different_names(values: list[object]) -> bool:
    """Whether all are tables by name, and no name stands in two of them."""
    names = [name for value in values if isinstance(value, dict) for name in value]
    return all(isinstance(value, dict) for value in values) and len(set(names)) == len(names)


def _angles(path: Path, table: Table, numbers: Numbers) -> Iterator[Finding]:
    for key in type(table).model_fields:
        value = getattr(table, key)
        if key == "zeros" or value is None or not table.is_angle(key):
            continue
        most = _TURN * (_TURNS_OF_LIMITS if key == "limits" else 1)
        sizes = [numbers.number(entry) for entry in (value if isinstance(value, tuple) else (value,))]
        if any(size is not None and abs(float(size)) > most for size in sizes):
            text = ", ".join("..." if size is None else f"{float(size):.10g}" for size in sizes)
            yield _radians(path, key, f"[{text}]" if isinstance(value, tuple) else text)


def _radians(path: Path, key: str, text: str) -> Finding:
    return Finding(
        "WG121", (*path, key), f"{key} = {text} is in radians and more than a turn", f"write {key}_deg = {text} if degrees are meant"
    )


def _users(spec: RobotSpec) -> Iterator[tuple[Path, Table, Design]]:
    """Tables with lists of one entry a joint, and the design that says how many joints there are."""
    for key in ("leg_designs", "chain_designs"):
        yield from (((key, name), design, design) for name, design in getattr(spec, key).items())
    for index, platform in enumerate(spec.platforms):
        chain = spec.chain_designs.get(platform.chain or "")
        if chain:
            yield ("platforms", index), platform, chain
    for index, leg in enumerate(spec.legs):
        design = design_of(spec, leg)
        if design:
            yield ("legs", index), leg, design


def _lists(path: Path, table: Table, design: Design, numbers: Numbers) -> Iterator[Finding]:
    count = len(design.rows)
    for key in ("signs", "zeros", "zeros_deg", "source_names"):
        listed = getattr(table, key, None)
        if listed is not None and len(listed) != count:
            message = f"{key} has {len(listed)} entries for {count} joints"
            yield Finding("WG125", (*path, key), message, "give one entry for each joint")
    for index, joint in enumerate(design.rows):
        yield from _zero(path, index, joint, table, numbers)


def _zero(path: Path, index: int, joint: JointRow, table: Table, numbers: Numbers) -> Iterator[Finding]:
    radians, degrees = (numbers.number(_entry(table, key, index)) for key in ("zeros", "zeros_deg"))
    if joint.type == "revolute" and radians is not None and abs(float(radians)) > _TURN:
        message = f"{float(radians):.10g} is in radians and more than a turn"
        yield Finding("WG121", (*path, "zeros", index), message, "write zeros_deg if degrees are meant")
    if joint.type == "prismatic" and degrees is not None and degrees != 0:
        message = f'the joint "{shown(joint.name)}" is prismatic'
        yield Finding("WG123", (*path, "zeros_deg", index), message, "write zeros in radians and metres")


def _entry(table: Table, key: str, index: int) -> Scalar | None:
    listed = getattr(table, key, None) or ()
    return listed[index] if index < len(listed) else None
