"""The tiny robot on disk: once a session for reading, a fresh copy for tests that damage it."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from tiny_robot import Tiny, write

from walkgen.runtime import Robot, load

VARIANTS = {"plain": Tiny(), "parameters": Tiny(parameters=True), "single": Tiny(float32=True), "both": Tiny(parameters=True, float32=True)}


@pytest.fixture(scope="session")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The folder of a variant, compiled, not to be changed."""
    made: dict[str, Path] = {}

    def folder(variant: str) -> Path:
        if variant not in made:
            made[variant] = write(VARIANTS[variant], tmp_path_factory.mktemp(variant) / "tiny")
            assert load(made[variant]).backend == "c"
        return made[variant]

    return folder


@pytest.fixture(autouse=True)
def _own_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No test reads or fills the developer's cache, and none inherits a choice of backend."""
    monkeypatch.delenv("WALKGEN_BACKEND", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def robots(folders: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch) -> Callable[..., Robot]:
    """A variant of the robot, loaded with a backend."""

    def robot(variant: str = "plain", backend: str = "c") -> Robot:
        folder = folders(variant)
        with monkeypatch.context() as patch:
            patch.setenv("WALKGEN_BACKEND", backend)
            return load(folder)

    return robot


@pytest.fixture
def fresh(folders: Callable[[str], Path], tmp_path: Path) -> Path:
    """A copy of the plain robot without its library."""
    return Path(shutil.copytree(folders("plain"), tmp_path / "fresh" / "tiny", ignore=shutil.ignore_patterns("_build", "__pycache__")))


@pytest.fixture
def built(folders: Callable[[str], Path], tmp_path: Path) -> Path:
    """A copy of the plain robot with its library."""
    return Path(shutil.copytree(folders("plain"), tmp_path / "built" / "tiny"))
