"""Height maps: text files of numbers beside the spec, read exactly, refused where a surface would have holes."""

import re
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path

_LARGEST_FILE = 1 << 20
_MOST_POINTS = 40_000
_FEWEST = 2
_LARGEST_HEIGHT = Decimal("1e6")
_SEPARATORS = re.compile(r"[,;\s]+")


class HeightMapError(ValueError):
    """A file that is no height map; the message says where and why."""


@dataclass(frozen=True)
class HeightGrid:
    """Heights (m), row after row: y grows from row to row, x from column to column."""

    rows: int
    columns: int
    heights: tuple[Decimal, ...]


def read_heights(folder: Path, name: str) -> HeightGrid:
    """The grid in a file of the spec's folder.

    Lines of numbers, separated by spaces, tabs, commas or semicolons; empty lines and lines that begin with # are skipped.

    Raises:
        HeightMapError: unreadable, outside the folder, too large, ragged, fewer than two rows or columns, not finite numbers.
    """
    lines = [(number, line) for number, line in enumerate(_text(folder, name).splitlines(), 1) if line.strip() and not _comment(line)]
    rows = [_row(number, line) for number, line in lines]
    if len(rows) < _FEWEST or len(rows[0]) < _FEWEST:
        raise HeightMapError(f"a height map has two rows and two columns at least, not {len(rows)} x {len(rows[0]) if rows else 0}")
    for (number, _), row in zip(lines, rows, strict=True):
        if len(row) != len(rows[0]):
            raise HeightMapError(f"line {number} has {len(row)} numbers, the first {len(rows[0])}")
    if len(rows) * len(rows[0]) > _MOST_POINTS:
        raise HeightMapError(f"{len(rows)} x {len(rows[0])} points are more than {_MOST_POINTS}")
    return HeightGrid(len(rows), len(rows[0]), tuple(height for row in rows for height in row))


def _comment(line: str) -> bool:
    return line.lstrip().startswith("#")


def _text(folder: Path, name: str) -> str:
    try:
        path = (folder / name).resolve()
        if not path.is_relative_to(folder.resolve()):
            raise HeightMapError("the file lies outside the spec's folder")
        with path.open("rb") as file:
            content = file.read(_LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        raise error if isinstance(error, HeightMapError) else HeightMapError(getattr(error, "strerror", None) or str(error)) from None
    if len(content) > _LARGEST_FILE:
        raise HeightMapError("the file is larger than 1 MiB")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise HeightMapError("the file is not UTF-8 text") from None


def _row(number: int, line: str) -> tuple[Decimal, ...]:
    """A trailing separator is allowed; an empty place between two commas is a hole."""
    if re.search(r"[,;]\s*[,;]|^\s*[,;]", line):
        raise HeightMapError(f"line {number} has an empty place")
    return tuple(_height(number, word) for word in _SEPARATORS.split(line.strip()) if word)


def _height(number: int, word: str) -> Decimal:
    try:
        height = Decimal(word)
    except InvalidOperation:
        raise HeightMapError(f'line {number}: "{word[:40]}" is not a number') from None
    if not height.is_finite() or abs(height) > _LARGEST_HEIGHT:
        raise HeightMapError(f'line {number}: "{word[:40]}" is not a height within {_LARGEST_HEIGHT:f} m')
    return height
