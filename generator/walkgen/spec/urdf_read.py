"""Reads URDF text into links and joints with exact numbers, every problem with its place; nothing is folded or renamed here."""

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, ParseError, TreeBuilder

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import DefusedXMLParser

from walkgen.errors import Place, Problem, SpecError
from walkgen.spec.urdf_pose import IDENTITY, ORIGIN, Inertial, Pose, Triple

MOVABLE = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}
_LARGEST = 16 * 1024 * 1024
_OTHER_FORMATS = {
    "sdf": ("WG504", "this is SDF, not URDF", "convert it first, for instance: gz sdf -p, or export URDF from the tool that made it"),
    "mujoco": ("WG504", "this is MuJoCo's MJCF, not URDF", "export URDF from the tool that made it"),
}


@dataclass(frozen=True)
class UrdfLink:
    """A rigid body; `inertial` is None where the file gives none."""

    name: str
    inertial: Inertial | None
    place: Place


@dataclass(frozen=True)
class UrdfJoint:
    """A joint: `origin` of the child link's frame in the parent link's, `axis` in the child's; rad, m, s, N m, N."""

    name: str
    kind: str
    parent: str
    child: str
    origin: Pose
    axis: Triple
    limits: tuple[Decimal, Decimal] | None
    max_speed: Decimal | None
    max_effort: Decimal | None
    place: Place


@dataclass(frozen=True)
class Urdf:
    """The file as written: links and joints in file order."""

    name: str
    links: tuple[UrdfLink, ...]
    joints: tuple[UrdfJoint, ...]
    place: Place


def read_urdf(path: Path) -> Urdf:
    """Read a URDF file.

    Raises:
        SpecError: not XML, a DOCTYPE, xacro or SDF, mimic or floating joints, missing names, what is not a number; all at once.
    """
    text = _text(path)
    return _Reader(str(path), text.splitlines()).robot(text)


def _text(path: Path) -> str:
    try:
        data = path.read_bytes() if path.stat().st_size <= _LARGEST else None
    except OSError as error:
        raise SpecError(Problem("WG501", f"cannot read {path}: {error.strerror}", "name an existing URDF file")) from error
    if data is None:
        raise SpecError(Problem("WG501", f"{path} is larger than 16 MiB", "a URDF without embedded meshes is far smaller"))
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SpecError(Problem("WG501", f"{path} is not UTF-8 text", "save the file as UTF-8")) from error


class _Positions(TreeBuilder):
    """Builds the tree and remembers where each element starts."""

    def __init__(self, position: Callable[[], tuple[int, int]]) -> None:
        super().__init__()
        self.position = position
        self.of: dict[Element, tuple[int, int]] = {}

    def start(self, tag: str, attrs: dict[str, str], /) -> Element:
        element = super().start(tag, attrs)
        self.of[element] = self.position()
        return element


class _Reader:
    """One pass over one file; `problems` gathers what the user has to mend."""

    def __init__(self, file: str, lines: list[str]) -> None:
        self.file = file
        self.lines = lines
        self.positions: dict[Element, tuple[int, int]] = {}
        self.problems: list[Problem] = []

    def robot(self, text: str) -> Urdf:
        root = self._parse(text)
        self._refuse_other_formats(root)
        links = tuple(self._link(element) for element in root.findall("link"))
        joints = tuple(self._joint(element) for element in root.findall("joint"))
        if self.problems:
            raise SpecError(*self.problems)
        return Urdf(root.get("name", ""), links, joints, self._place(root))

    def _parse(self, text: str) -> Element:
        parser: Any = None
        target = _Positions(lambda: (parser.parser.CurrentLineNumber, parser.parser.CurrentColumnNumber + 1))
        parser = DefusedXMLParser(target=target, forbid_dtd=True)
        try:
            parser.feed(text)
            root: Element = parser.close()
        except ParseError as error:
            line, column = error.position
            raise SpecError(Problem("WG501", f"not well-formed XML: {error.msg}", "mend the XML", self._at(line, column + 1))) from error
        except DefusedXmlException as error:
            cure = "remove the DOCTYPE and its entities: a URDF needs neither"
            raise SpecError(Problem("WG502", "a DOCTYPE is not read", cure, self._at(*target.position()))) from error
        self.positions = target.of
        return root

    def _refuse_other_formats(self, root: Element) -> None:
        if root.tag in _OTHER_FORMATS:
            code, message, cure = _OTHER_FORMATS[root.tag]
            raise SpecError(Problem(code, message, cure, self._place(root)))
        for element in root.iter():
            values = element.attrib.values()
            if "xacro" in str(element.tag).partition("}")[0] or any("${" in value or "$(" in value for value in values):
                cure = f"expand it first: xacro {self.file} > robot.urdf"
                raise SpecError(Problem("WG503", "this is a xacro file, not URDF", cure, self._place(element)))
        if root.tag != "robot":
            raise SpecError(Problem("WG501", f"the root element is <{root.tag}>, not <robot>", "name a URDF file", self._place(root)))

    def _link(self, element: Element) -> UrdfLink:
        inertial = element.find("inertial")
        return UrdfLink(self._name(element), None if inertial is None else self._inertial(inertial), self._place(element))

    def _inertial(self, element: Element) -> Inertial | None:
        inertia = element.find("inertia")
        keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        moments = tuple(self._number(inertia if inertia is not None else element, key, "0") for key in keys)
        mass = element.find("mass")
        value = Decimal(0) if mass is None else self._number(mass, "value", None)
        if mass is None:
            self._add("WG507", "<inertial> without <mass>", 'add <mass value="..."/> (kg)', element)
        if value < 0:
            self._add("WG508", f"the mass is negative: {value}", "give it in kg; a frame without mass needs no <inertial>", element)
        xx, yy, zz, xy, xz, yz = moments
        inertial = Inertial(value, self._origin(element), (xx, yy, zz, xy, xz, yz))
        return inertial if value or any(moments) else None

    def _joint(self, element: Element) -> UrdfJoint:
        kind = element.get("type", "")
        if kind not in MOVABLE and kind != "fixed":
            self._refuse_kind(element, kind)
        if element.find("mimic") is not None:
            cure = "remove <mimic> to give the joint its own drive, or make the joint fixed"
            self._add("WG505", f"joint {element.get('name')!r} mimics another: not supported", cure, element)
        limit = element.find("limit")
        return UrdfJoint(
            self._name(element),
            kind,
            self._end(element, "parent"),
            self._end(element, "child"),
            self._origin(element),
            self._axis(element) if kind != "fixed" else ORIGIN,
            self._limits(limit) if limit is not None and kind in {"revolute", "prismatic"} else None,
            self._positive(limit, "velocity"),
            self._positive(limit, "effort"),
            self._place(element),
        )

    def _refuse_kind(self, element: Element, kind: str) -> None:
        cure = "allowed are revolute, continuous, prismatic and fixed"
        if kind == "floating":
            cure = "delete the floating joint and the link above it: the first platform is free anyway"
        self._add("WG506", f"joint {element.get('name')!r} is of type {kind!r}", cure, element)

    def _axis(self, element: Element) -> Triple:
        axis = element.find("axis")
        triple = (Decimal(1), Decimal(0), Decimal(0)) if axis is None else self._triple(axis, "xyz", "1 0 0")
        if not any(triple):
            self._add("WG508", f"the axis of joint {element.get('name')!r} has no length", 'give a direction, such as xyz="0 0 1"', element)
        return triple

    def _limits(self, limit: Element) -> tuple[Decimal, Decimal] | None:
        if "lower" not in limit.attrib and "upper" not in limit.attrib:
            return None
        lower, upper = self._number(limit, "lower", "0"), self._number(limit, "upper", "0")
        if lower > upper:
            self._add("WG508", f"limits crossed: lower {lower} lies above upper {upper}", "exchange them", limit)
        return lower, upper

    def _positive(self, limit: Element | None, key: str) -> Decimal | None:
        """The attribute, or None where it is absent or 0 (which exporters write for "not given")."""
        value = Decimal(0) if limit is None else self._number(limit, key, "0")
        if value < 0 and limit is not None:
            self._add("WG508", f"{key} is negative: {value}", "give its magnitude, or leave it out", limit)
        return value or None

    def _end(self, element: Element, which: str) -> str:
        end = element.find(which)
        link = "" if end is None else end.get("link", "")
        if not link:
            self._add("WG507", f"joint {element.get('name')!r} has no <{which}>", f'add <{which} link="..."/>', element)
        return link

    def _origin(self, element: Element) -> Pose:
        origin = element.find("origin")
        return IDENTITY if origin is None else Pose(self._triple(origin, "xyz", "0 0 0"), self._triple(origin, "rpy", "0 0 0"))

    def _name(self, element: Element) -> str:
        if not element.get("name"):
            self._add("WG507", f"<{element.tag}> without a name", 'add name="..."', element)
        return element.get("name", "")

    def _triple(self, element: Element, key: str, default: str) -> Triple:
        words = element.get(key, default).split()
        if len(words) != 3:
            self._add("WG508", f"{key} needs three numbers, not {element.get(key)!r}", f'{key}="{default}", separated by spaces', element)
            return ORIGIN
        x, y, z = (self._decimal(element, key, word) for word in words)
        return x, y, z

    def _number(self, element: Element, key: str, default: str | None) -> Decimal:
        text = element.get(key, default)
        if text is None:
            self._add("WG507", f"<{element.tag}> without {key}", f'add {key}="..."', element)
            return Decimal(0)
        return self._decimal(element, key, text)

    def _decimal(self, element: Element, key: str, text: str) -> Decimal:
        try:
            number = Decimal(text.strip())
        except InvalidOperation:
            number = Decimal("nan")
        if number.is_finite() and (number == 0 or abs(number.adjusted()) < 300) and "_" not in text:
            return number if number else Decimal(0)
        self._add("WG508", f"{key}: {text!r} is not a finite number", "give a decimal number in SI units or radians", element)
        return Decimal(0)

    def _add(self, code: str, message: str, cure: str, element: Element) -> None:
        self.problems.append(Problem(code, message, cure, self._place(element)))

    def _place(self, element: Element) -> Place:
        return self._at(*self.positions[element])

    def _at(self, line: int, column: int) -> Place:
        return Place(self.file, line, column, self.lines[line - 1] if 0 < line <= len(self.lines) else "")
