"""The file as text and as a plain document, refusing early what would cost time or memory: size, encoding, nesting, syntax."""

import re
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Any

import tomli

from walkgen.errors import Place, Problem, SpecError

_LARGEST_FILE = 1 << 20
_MOST_ENTRIES = 30_000
_MOST_PARTS = 12
_DEEPEST = 32
_KEY_PART = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
_LONG_KEY = re.compile(rf"(?:^|[\[{{,])[ \t]*(?:{_KEY_PART}[ \t]*\.[ \t]*){{{_MOST_PARTS}}}", re.MULTILINE)
_TOKEN = re.compile(r'"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'|#[^\n]*|[\[{]|[\]}]')
_LONG_NUMBER = re.compile(r"0x[\da-fA-F_]{1000,}|\d[\d_]{1000,}")


@dataclass(frozen=True)
class Document:
    """A spec's text and the TOML tables in it; numbers with a point are Decimal."""

    file: str
    text: str
    tables: dict[str, Any]


def open_document(path: Path) -> Document:
    """Read and parse a TOML file.

    Raises:
        SpecError: unreadable, too large, not UTF-8, nested too deep, or not TOML.
    """
    text = _text(path)
    _refuse_long_keys(path, text)
    _refuse_bulk(path, text)
    _refuse_long_numbers(path, text)
    try:
        return Document(str(path), text, tomli.loads(text, parse_float=_decimal))
    except tomli.TOMLDecodeError as error:
        place = place_at(str(path), text, _offset(text, error.lineno, error.colno))
        raise SpecError(Problem("WG104", f"not TOML: {error.msg}", "see https://toml.io for the syntax", place)) from None
    except RecursionError:
        raise _too_deep(path, text, _first_too_deep(text)) from None


def place_at(file: str, text: str, offset: int) -> Place:
    """Line and column (from 1) of a character of the text, with its line."""
    start = text.rfind("\n", 0, offset) + 1
    end = text.find("\n", offset)
    source = text[start : end if end >= 0 else len(text)]
    return Place(file, text.count("\n", 0, offset) + 1, offset - start + 1, source_line(source))


def source_line(line: str) -> str:
    """A line of the file as shown beside a problem: without control characters, cut to length."""
    return "".join(letter if letter.isprintable() else " " for letter in line[:200]).rstrip()


def _text(path: Path) -> str:
    try:
        if path.exists() and not path.is_file():
            raise SpecError(Problem("WG101", f"{path} is not a file", "name the spec's .toml file"))
        with path.open("rb") as file:
            content = file.read(_LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SpecError(Problem("WG101", f"cannot read {path}: {reason}", "check the path; walkgen new writes a starting spec")) from None
    if len(content) > _LARGEST_FILE:
        raise SpecError(Problem("WG102", f"{path} is larger than 1 MiB", "a spec is a few pages; split the robot or drop generated parts"))
    return _decoded(path, content)


def _decoded(path: Path, content: bytes) -> str:
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8")
        place = place_at(str(path), before, len(before))
        raise SpecError(Problem("WG103", "the file is not UTF-8 text", "save it as UTF-8", place)) from None


def _refuse_bulk(path: Path, text: str) -> None:
    """Refuse what would take seconds to say little: tens of thousands of keys or list entries."""
    if sum(map(text.count, "=,.[")) > _MOST_ENTRIES:
        cure = "describe repeated legs once, as a leg design"
        raise SpecError(
            Problem("WG107", f"more than {_MOST_ENTRIES} keys, list entries and decimal points", cure, place_at(str(path), text, 0))
        )


def _refuse_long_numbers(path: Path, text: str) -> None:
    match = _LONG_NUMBER.search(text)
    if match:
        place = place_at(str(path), text, match.start())
        raise SpecError(Problem("WG113", "a number of thousands of digits", "give a number that a double can hold", place))


def _refuse_long_keys(path: Path, text: str) -> None:
    match = _LONG_KEY.search(text)
    if match:
        raise _too_deep(path, text, match.start() + len(match.group()) - len(match.group().lstrip("[{, \t")))


def _too_deep(path: Path, text: str, offset: int) -> SpecError:
    return SpecError(
        Problem("WG105", "tables nest too deep", "no key of a spec has more than eight parts", place_at(str(path), text, offset))
    )


def _first_too_deep(text: str) -> int:
    depth = 0
    for token in _TOKEN.finditer(text):
        depth += {"[": 1, "{": 1, "]": -1, "}": -1}.get(token.group(), 0)
        if depth > _DEEPEST:
            return token.start()
    return 0


def _offset(text: str, line: int, column: int) -> int:
    start = 0
    for _ in range(line - 1):
        start = text.find("\n", start) + 1
    return start + column - 1


def _decimal(text: str) -> Decimal:
    """The number as typed; what no Decimal can hold becomes infinite, which the models refuse."""
    try:
        return Decimal(text)
    except InvalidOperation:
        return Decimal("inf")
