"""What the self-test's C is laid out from: checks of functions, and constant arrays of numbers, which several may share."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

_WIDTH = 100

Row = Sequence[Any]


@dataclass(frozen=True)
class Table:
    """A constant array `name`[rows][columns]; `lines` are its rows, filled."""

    name: str
    rows: int
    columns: int
    lines: tuple[str, ...]


@dataclass(frozen=True)
class Check:
    """One C function of the self-test: its tables, the lines run for each sample, the error allowed.

    `shared` gives the tables that other checks have too by the names under which all find them.
    """

    name: str
    tables: tuple[Table, ...]
    samples: int
    lines: tuple[str, ...]
    tolerance: str
    shared: tuple[tuple[str, Table], ...] = ()


def sharing(checks: Sequence[Check]) -> tuple[list[Check], dict[str, Table]]:
    """The checks without what several have alike, and that by names of its own: equal legs have many numbers in common."""
    uses = Counter(table for check in checks for table in check.tables)
    names = {table: f"{table.name}_{number}" for number, table in enumerate((table for table, count in uses.items() if count > 1), 1)}
    own = [
        replace(
            check,
            tables=tuple(table for table in check.tables if table not in names),
            shared=tuple((names[table], table) for table in check.tables if table in names),
        )
        for check in checks
    ]
    return own, {name: table for table, name in names.items()}


def table(name: str, rows: Sequence[Row]) -> Table:
    """Rows of numbers, as doubles, under a name."""
    return Table(name, len(rows), len(rows[0]), tuple(line for row in rows for line in _row_lines(row)))


def _row_lines(row: Row) -> Iterator[str]:
    line = "{"
    for value in row:
        text = literal(value)
        if len(line) + len(text) > _WIDTH:
            yield line.rstrip()
            line = " "
        line += f"{text}, "
    yield line.rstrip(" ,") + "},"


def literal(value: Any) -> str:
    """The nearest double in its shortest form."""
    return repr(float(value))
