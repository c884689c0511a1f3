"""A spec with other functions asked for than it says itself, so that a benchmark builds what it measures and no more."""

import json
import re
from collections.abc import Sequence
from pathlib import Path

SPECS = Path(__file__).parents[1] / "specs"
_TABLE = re.compile(r"^\[generate\].*?(?=^\[|\Z)", re.MULTILINE | re.DOTALL)


def write_spec(spec: str, functions: Sequence[str] | None, folder: Path) -> Path:
    """specs/<spec>.toml in another folder, its `[generate]` table replaced; None asks for every function."""
    folder.mkdir(parents=True, exist_ok=True)
    asked = json.dumps("all" if functions is None else list(functions))
    text = _TABLE.sub("", (SPECS / f"{spec}.toml").read_text())
    path = folder / f"{spec}.toml"
    path.write_text(f"{text}\n[generate]\nfunctions = {asked}\n")
    return path
