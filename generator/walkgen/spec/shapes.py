"""What has the wrong shape, in the language's own words: unknown and missing keys, types, lengths; and what is left without it."""

from collections.abc import Iterator, Mapping
from typing import Any, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from walkgen.spec.linkage_forms import SIX_BAR_POINTS
from walkgen.spec.problems import Finding, did_you_mean, nearest, shown
from walkgen.spec.schema import TAGS, RobotSpec
from walkgen.spec.table import Path, Table

_MOST_ERRORS = 500
_EXPECTED = {
    "string_type": "a text in quotes",
    "bool_type": "true or false",
    "tuple_type": "a list in square brackets",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
}
_CURES = {
    "gravity": "write gravity = [0.0, 0.0, -9.80665] (m/s^2)",
    "type": 'write type = "revolute" or type = "prismatic"',
    "walkgen": "write walkgen = 1 (the version of the spec language) on the first line",
    "robot": 'write [robot] with name = "..." and gravity = [0.0, 0.0, -9.80665]',
    "name": 'write name = "..."',
}
_SOLE_CURES = {
    "ellipse": "give two numbers: ellipse = [semi-axis along y, semi-axis along x]",
    "flat": "give two numbers: flat = [rear edge, front edge]",
    "flat_mm": "give two numbers: flat_mm = [rear edge, front edge]",
    "polynomial": "give one number at least: polynomial = [c2, c3, ...]",
    "points": "give one point at least: points = [[x, y], ...]",
}
_STAND_INS: Mapping[str, Any] = {
    "walkgen": 1,
    "name": "?",
    "type": "revolute",
    "surface": "plane",
    "kind": "free",
    **{"at": 0, "leg": "?", "does": "lift"},
    **{"hip": [0, 1], "velocity": [1, 0], "duration": 1, "load": [0, 0]},
    "gravity": [0, 0, -1],
    **dict.fromkeys(("value", "epsilon", "lambda_max", "E", "G", "A", "Iy", "Iz", "J"), 1),
    **dict.fromkeys(("ground", "crank", "coupler", "rocker", "second_coupler", "second_rocker"), 1),
    "cranks": [1, 1],
    "couplers": [1, 1],
    "inversion": "I",
}
STAND_IN_NAME = "?"


def shape_findings(error: ValidationError, tables: Mapping[str, Any]) -> tuple[Finding, ...]:
    """Pydantic's errors as findings, each at its path of the document."""
    details = [(_path(tables, detail["loc"]), detail) for detail in error.errors(include_url=False, include_input=False)[:_MOST_ERRORS]]
    unknown = {path: _unknown_key(path) for path, detail in details if detail["type"] == "extra_forbidden"}
    meant = {(*path[:-1], word) for path in unknown if (word := _meant(path))}
    found = [unknown[path] if path in unknown else _finding(path, detail, tables) for path, detail in details if path not in meant]
    return tuple({finding.path: finding for finding in reversed(found)}.values())[::-1]


def salvage(tables: dict[str, Any]) -> tuple[RobotSpec | None, tuple[Finding, ...], frozenset[Path]]:
    """The spec as far as it is well formed, what is not, and the paths that were left out or replaced for it.

    `tables` is changed: whatever has the wrong shape is removed, or replaced where it is required, until the rest validates.
    """
    findings: tuple[Finding, ...] = ()
    blamed: set[Path] = set()
    for _ in range(len(RobotSpec.model_fields)):
        try:
            return RobotSpec.model_validate(tables), findings, frozenset(blamed)
        except ValidationError as error:
            findings = findings or shape_findings(error, tables)
            details = error.errors(include_url=False, include_input=False)
        for detail in details:
            path = _path(tables, detail["loc"])
            blamed |= {(*path[:-1], word) for word in _quantities(path, detail)}
            blamed.add(_mend(tables, path, missing=detail["type"] == "missing"))
    return None, findings, frozenset(blamed)


def _path(tables: Mapping[str, Any], location: tuple[str | int, ...]) -> Path:
    """The document's path for pydantic's: without union tags, and without what only the models have."""
    path: Path = ()
    value: Any = tables
    for part in location:
        if part in TAGS and _child(value, part) is None:
            continue
        if not isinstance(value, dict | list):
            break
        path = (*path, part)
        value = _child(value, part)
    return path


def _finding(path: Path, detail: ErrorDetails, tables: Mapping[str, Any]) -> Finding:
    kind, context = detail["type"], detail.get("ctx", {})
    if kind.startswith("WG"):
        return Finding(kind, (*path, context["key"]) if "key" in context else path, detail["msg"], context.get("cure", _number_cure(kind)))
    if kind == "missing" and isinstance(path[-1], str):
        return Finding("WG111", path, f'missing key "{path[-1]}"', _CURES.get(path[-1], f"write {path[-1]} = ..."))
    if kind == "literal_error":
        return _choice(path, context["expected"], _value(tables, path))
    if kind in {"missing", "too_long", "too_short"}:
        return _length(path, context.get("max_length"), tables)
    expected = _EXPECTED.get(kind, "something else")
    return Finding("WG112", path, f"{expected} is expected here, not {_described(_value(tables, path))}", f"give {expected}")


def _number_cure(kind: str) -> str:
    if kind == "WG114":
        return "write a number, or arithmetic of numbers and parameter names in quotes"
    return "give a number such as 0.35 (a text in quotes may do arithmetic)"


def _choice(path: Path, expected: str, value: Any) -> Finding:
    choices = [choice.strip(" '") for choice in expected.replace(" or ", ",").split(",")]
    if path == ("walkgen",):
        return Finding("WG115", path, "this walkgen reads version 1 of the spec language", "write walkgen = 1")
    if isinstance(value, str):
        return Finding("WG116", path, f'"{shown(value)}" is not one of {", ".join(choices)}', did_you_mean(value, choices, "choose one of"))
    return Finding("WG116", path, f"{_described(value)} is not one of {', '.join(choices)}", f"choose one of {', '.join(choices)}")


def _length(path: Path, most: Any, tables: Mapping[str, Any]) -> Finding:
    listed = path[:-1] if isinstance(path[-1], int) else path
    given = len(_value(tables, listed) or ())
    if most is None or isinstance(path[-1], int):
        return Finding("WG112", listed, f"the list has {given} entries, which are too few", _shape_cure(listed))
    exact = f"{most} entries are expected" if most <= len("xxyyzz") else f"at most {most} entries are supported"
    return Finding("WG112", listed, f"the list has {given} entries; {exact}", _shape_cure(listed))


def _shape_cure(path: Path) -> str:
    key = str(path[-1])
    if key == "inertia":
        return "give six numbers: ixx, iyy, izz, ixy, ixz, iyz"
    if key in {"cranks", "couplers"}:
        return f"give two numbers: {key} = [first, second]"
    if path[0] == "leg_designs" and (key in SIX_BAR_POINTS or (key == "foot" and len(path) > len(("leg_designs", "name", "foot")))):
        return f"give two numbers: {key} = [x, y]"
    named = next((part for part in reversed(path) if isinstance(part, str)), "")
    if "curved_sole" in path and named in _SOLE_CURES:
        return _SOLE_CURES[named]
    pair = "limits" in key or key in {"bounds", "x", "y", "u", "v"}
    return "give two numbers: [least, largest]" if pair else f"give three numbers: {key} = [x, y, z]"


def _described(value: Any) -> str:
    if isinstance(value, str):
        return f'the text "{shown(value)}"'
    names = {bool: "true or false", dict: "a table", list: f"a list of {len(value) if isinstance(value, list) else 0}"}
    return names.get(type(value), "a date" if hasattr(value, "isoformat") else "a number")


def _value(tables: Any, path: Path) -> Any:
    for part in path:
        tables = _child(tables, part)
    return tables


def _child(value: Any, part: str | int) -> Any:
    if isinstance(value, dict):
        return value.get(part)
    return value[part] if isinstance(value, list) and isinstance(part, int) and part < len(value) else None


def _keys(path: Path) -> tuple[str, ...]:
    """The keys allowed in the table at the path; no keys where names are free."""
    model: type[Table] = RobotSpec
    named = perhaps = False
    for part in path:
        if named or isinstance(part, int) or (perhaps and part not in model.model_fields):
            named = perhaps = False
            continue
        if part not in model.model_fields:
            return ()
        annotation = model.model_fields[part].annotation
        tables = tuple(_tables_in(annotation))
        model = tables[0] if tables else model
        perhaps = _has_names(annotation)
        named = perhaps and (not tables or getattr(annotation, "__origin__", None) is dict)
    return () if named else tuple(model.model_fields)


def _has_names(annotation: Any) -> bool:
    """Whether the value may be a table of free names."""
    return getattr(annotation, "__origin__", None) is dict or any(_has_names(argument) for argument in get_args(annotation))


def _tables_in(annotation: Any) -> Iterator[type[Table]]:
    if isinstance(annotation, type) and issubclass(annotation, Table):
        yield annotation
    for argument in get_args(annotation):
        yield from _tables_in(argument)


def _meant(path: Path) -> str | None:
    return nearest(str(path[-1]), _keys(path[:-1]))


def _unknown_key(path: Path) -> Finding:
    keys, word = _keys(path[:-1]), str(path[-1])
    match = nearest(word, keys)
    suffix = f'; did you mean "{match}"?' if match else ""
    return Finding("WG110", path, f'unknown key "{shown(word)}"{suffix}', f"allowed here: {', '.join(keys)}")


def _quantities(path: Path, detail: ErrorDetails) -> tuple[str | int, ...]:
    """The keys that the error speaks of, with and without unit; a misspelt key speaks of the one that was meant."""
    word = path[-1]
    if detail["type"] == "extra_forbidden":
        word = _meant(path) or word
    return (word, word.removesuffix("_deg").removesuffix("_mm")) if isinstance(word, str) else (word,)


def _mend(tables: dict[str, Any], path: Path, *, missing: bool) -> Path:
    """Take the broken value out, or put a stand-in where the language requires one; the path of what was changed."""
    while isinstance(path[-1], int):
        path = path[:-1]
    table = _value(tables, path[:-1])
    key, keys = str(path[-1]), _keys(path[:-1])
    if not isinstance(table, dict):
        return path
    if missing or (key in keys and key in _STAND_INS):
        table[key] = _STAND_INS.get(key, {})
    elif not keys:
        table[key] = {}
    else:
        table.pop(key, None)
    return path
