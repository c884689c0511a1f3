"""The legs that these tests share, built once: by name, in C or NumPy, each with its anatomy."""

from dataclasses import dataclass
from typing import Any

import pytest
from anatomy import Anatomy
from legs import LEGS, TEXT

from oracles.walker import read


@dataclass(frozen=True)
class Specimen:
    """One leg: what was generated for it, and what is known of it."""

    name: str
    anatomy: Anatomy
    robot: Any
    generated: Any


@pytest.fixture(scope="session")
def anatomies():
    return {limb.name: Anatomy(limb) for limb in read(TEXT).legs}


@pytest.fixture(scope="session")
def specimen(built, anatomies):
    """A leg by its name, and the backend."""

    def find(name: str, backend: str = "c") -> Specimen:
        robot = built(TEXT).c if backend == "c" else built(TEXT).numpy
        return Specimen(name, anatomies[name], robot, robot.legs[name])

    return find


@pytest.fixture(params=LEGS)
def leg(request, specimen):
    return specimen(request.param)
