"""A spec's own text with other values of its parameters; all else, comments among it, stays."""

import re
from collections.abc import Mapping
from pathlib import Path

from walkgen.spec.document import Document, open_document
from walkgen.spec.positions import Positions

_ENTRY = re.compile(r"""(?P<key>[\w-]+|"[^"\n]*"|'[^'\n]*')(?P<sign>\s*=\s*)(?P<value>"[^"\n]*"|'[^'\n]*'|[^\s,}\]#]+)""")


def rewritten(path: Path, values: Mapping[str, float]) -> str:
    """The text of a spec with these values of its parameters, written so that they read back as the same doubles."""
    document = open_document(path)
    positions = Positions(document)
    changes = [_change(document, positions, name, value) for name, value in values.items()]
    text = document.text
    for start, end, new in sorted(changes, reverse=True):
        text = text[:start] + new + text[end:]
    return text


def _change(document: Document, positions: Positions, name: str, value: float) -> tuple[int, int, str]:
    """Where the value stands, and what to write there."""
    bare = not isinstance(document.tables["parameters"][name], dict)
    place = positions.place(("parameters", name) if bare else ("parameters", name, "value"))
    lines = document.text.split("\n")
    start = sum(len(line) + 1 for line in lines[: place.line - 1]) + place.column - 1
    found = _ENTRY.match(document.text, start)
    assert found is not None
    return found.start("value"), found.end("value"), repr(float(value))
