"""Where each key and list entry of a TOML text stands, for problems of tables that parsed well."""

from collections.abc import Sequence

import tomli
import tree_sitter_toml
from tree_sitter import Language, Node, Parser

from walkgen.errors import Place
from walkgen.spec.document import Document, source_line
from walkgen.spec.table import Path

_LANGUAGE = Language(tree_sitter_toml.language())
_DEEPEST = 40
_KEYS = frozenset({"bare_key", "quoted_key", "dotted_key"})


class Positions:
    """Places of the paths of one document; a path that is not in it takes its longest known beginning."""

    def __init__(self, document: Document) -> None:
        self._file = document.file
        self._lines = document.text.split("\n")
        self._points: dict[Path, tuple[int, int]] = {}
        self._counts: dict[Path, int] = {}
        for node in Parser(_LANGUAGE).parse(document.text.encode()).root_node.named_children:
            self._statement(node)

    def place(self, path: Path) -> Place:
        """Line and column (from 1, in characters) of the key or list entry."""
        while path and path not in self._points:
            path = path[:-1]
        row, byte = self._points.get(path, (0, 0))
        line = self._lines[row]
        return Place(self._file, row + 1, len(line.encode()[:byte].decode("utf-8", "ignore")) + 1, source_line(line))

    def _statement(self, node: Node) -> None:
        if node.type == "pair":
            self._pair(node, (), 0)
        elif node.type in {"table", "table_array_element"}:
            head, *pairs = [child for child in node.named_children if child.type != "comment"]
            path = self._header(_parts(head), repeated=node.type == "table_array_element")
            for pair in pairs:
                self._pair(pair, path, 0)

    def _header(self, parts: Sequence[Node], *, repeated: bool) -> Path:
        """The table that a header opens; keys of repeated tables stand for their last element."""
        path: Path = ()
        for part in parts:
            path = (*path, _key(part))
            self._mark(path, part)
            if path in self._counts and not (repeated and part is parts[-1]):
                path = (*path, self._counts[path] - 1)
        if repeated:
            index = self._counts.get(path, 0)
            self._counts[path] = index + 1
            path = (*path, index)
            self._mark(path, parts[-1])
        return path

    def _pair(self, node: Node, table: Path, depth: int) -> None:
        children = [child for child in node.named_children if child.type != "comment"]
        if node.type != "pair" or len(children) != 2 or depth > _DEEPEST:
            return
        path = table
        for part in _parts(children[0]):
            path = (*path, _key(part))
            self._mark(path, part)
        self._value(children[1], path, depth + 1)

    def _value(self, node: Node, path: Path, depth: int) -> None:
        if node.type == "inline_table":
            for pair in node.named_children:
                self._pair(pair, path, depth)
        elif node.type == "array" and depth <= _DEEPEST:
            entries = [child for child in node.named_children if child.type != "comment"]
            for index, entry in enumerate(entries):
                self._mark((*path, index), entry)
                self._value(entry, (*path, index), depth + 1)

    def _mark(self, path: Path, node: Node) -> None:
        self._points.setdefault(path, (node.start_point[0], node.start_point[1]))


def _parts(key: Node) -> list[Node]:
    """The parts of a key, from left to right (dotted keys of three parts and more nest to the left)."""
    if key.type != "dotted_key":
        return [key] if key.type in _KEYS else []
    return [part for child in key.named_children for part in _parts(child)]


def _key(node: Node) -> str:
    text = (node.text or b"").decode()
    if node.type == "bare_key":
        return text
    try:
        return next(iter(tomli.loads(f"{text} = 0")))
    except tomli.TOMLDecodeError:
        return text
