"""Cause, cure and example of every error code, for `walkgen explain`."""

import tomllib
from difflib import get_close_matches
from importlib.resources import files

from walkgen.errors import Problem, WalkgenError


def codes() -> dict[str, dict[str, str]]:
    """Every code with its title, cause, cure and example."""
    return tomllib.loads(files("walkgen").joinpath("error_codes.toml").read_text("utf-8"))


def explain(code: str) -> str:
    """What an error code means and how to mend it.

    Raises:
        WalkgenError: no message has this code.
    """
    known = codes()
    entry = known.get(code.upper())
    if entry is None:
        near = get_close_matches(code.upper()[:20], known, n=1, cutoff=0)
        raise WalkgenError(Problem("WG601", f"there is no error code {code[:20]!r}", f"did you mean {near[0]}?"))
    return f"{code.upper()}: {entry['title']}\n\n{entry['cause']}\n\nCure: {entry['cure']}\n\nExample:\n    {entry['example']}"
