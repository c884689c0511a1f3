"""A fixture that builds robots whose specs name height maps beside them."""

from collections.abc import Callable, Mapping

import pytest

from oracles.backends import Built
from walkgen import pipeline


@pytest.fixture(scope="session")
def mapped(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, Mapping[str, str]], Built]:
    """Build a robot from the text of its spec and the texts of files beside it."""

    def build(text: str, files: Mapping[str, str]) -> Built:
        folder = tmp_path_factory.mktemp("mapped")
        for name, content in {**files, "spec.toml": text}.items():
            (folder / name).write_text(content, encoding="utf-8")
        return Built(folder / "spec.toml", pipeline.build(folder / "spec.toml", folder / "generated").folder)

    return build
