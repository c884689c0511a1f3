"""Fixtures that build robots from spec text, each text once a session."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from oracles.backends import Built

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices here are small, and the tests' own processes fill the cores

SPECS = Path(__file__).parents[1] / "specs"


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], "Built"]:
    """Build a robot from the text of its spec."""
    from oracles.backends import Built  # what needs sympy waits for the first robot, so that other tests start at once
    from walkgen import pipeline

    done: dict[str, Built] = {}

    def build(text: str) -> Built:
        if text not in done:
            folder = tmp_path_factory.mktemp("built")
            spec = folder / "spec.toml"
            spec.write_text(text, encoding="utf-8")
            done[text] = Built(spec, pipeline.build(spec, folder / "generated").folder)
        return done[text]

    return build


@pytest.fixture(scope="session")
def shipped(built: Callable[[str], "Built"]) -> Callable[[str], "Built"]:
    """Build a robot of specs/ by its name."""
    return lambda name: built((SPECS / f"{name}.toml").read_text(encoding="utf-8"))
