"""A small robot that walks, built once for all tests of walks, with the command line's own cache."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

DUO = Path(__file__).with_name("duo.toml")


@pytest.fixture(scope="session")
def duo(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The spec; its robot is in the cache that XDG_CACHE_HOME names until the session ends."""
    from filelock import FileLock

    from walkgen.walking import walked
    from walkgen.walking_request import Wanted

    own = tmp_path_factory.getbasetemp()
    shared = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "walks"
    shared.mkdir(exist_ok=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(shared))
        with FileLock(shared / "lock"):
            walked(DUO, Wanted(cycles=1, rate=10.0))
        yield DUO
