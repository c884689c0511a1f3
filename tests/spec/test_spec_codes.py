"""Every code that a message can carry is explained, and nothing else is."""

import re
from pathlib import Path

import pytest

from walkgen.errors import WalkgenError
from walkgen.explanations import codes, explain

GENERATOR = Path(__file__).parents[2] / "generator" / "walkgen"


def test_codes_raised_and_codes_explained_are_the_same() -> None:
    raised = {code for path in GENERATOR.rglob("*.py") for code in re.findall(r'"(WG\d{3})"', path.read_text(encoding="utf-8"))}
    assert raised == set(codes()), "mend generator/walkgen/error_codes.toml"


@pytest.mark.parametrize("code", codes())
def test_every_explanation_is_complete(code: str) -> None:
    entry = codes()[code]
    assert set(entry) == {"title", "cause", "cure", "example"}
    assert all(entry.values())
    text = explain(code.lower())
    assert text.startswith(f"{code}: ")
    assert entry["cure"] in text


def test_an_unknown_code_names_the_nearest() -> None:
    with pytest.raises(WalkgenError, match="WG601"):
        explain("WG999")
