"""Findings of the checks: a code, a place in the document and a cure, before the document's lines are known."""

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

from walkgen.spec.table import Path

_LONGEST_WORD = 40


@dataclass(frozen=True)
class Finding:
    """One broken rule at a path of the document."""

    code: str
    path: Path
    message: str
    cure: str = ""
    because: tuple[Path, ...] = ()
    """Other paths that it rests on: where one of them has the wrong shape, it is no finding of its own."""


def dotted(path: Path) -> str:
    """The path as a reader writes it: legs[0].mount.xyz."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{shown(part)}" for part in path)
    return text.removeprefix(".")


def shown(text: str, longest: int = 60) -> str:
    """A text of the user's, made safe to print: escaped and cut to length."""
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in text[:longest]) + (
        "..." if len(text) > longest else ""
    )


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The known word most like the misspelt one, if any comes close."""
    if len(word) > _LONGEST_WORD:
        return None
    plain = word.lower().replace("-", "_")
    return next(iter(get_close_matches(plain, list(known), n=1, cutoff=0.6)), None)


def did_you_mean(word: str, known: Iterable[str], what: str) -> str:
    """The cure for a misspelt word: the nearest known one, else all of them."""
    choices = list(dict.fromkeys(known))
    match = nearest(word, choices)
    if match:
        return f'did you mean "{match}"?'
    return f"{what}: {', '.join(choices)}" if choices else f"{what}: none is defined"
