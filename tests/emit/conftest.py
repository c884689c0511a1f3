"""Compiled routines that tests of several files share."""

import pytest
from stance_library import Stances


@pytest.fixture(scope="session")
def stances(tmp_path_factory):
    return Stances(tmp_path_factory.mktemp("stances"))
