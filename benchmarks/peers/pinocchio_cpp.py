"""Pinocchio's C++ interface, compiled against the headers and linked with the library that its wheels carry."""

from pathlib import Path

import pinocchio

from peers.eigen import HEADERS
from peers.source import HERE, Peer, Source

PREFIX = next(parent for parent in Path(pinocchio.__file__).parents if parent.name == "cmeel.prefix")
DEFINES = (
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)
"""What its CMake target defines."""
LINK = (*DEFINES, f"-L{PREFIX / 'lib'}", f"-Wl,-rpath,{PREFIX / 'lib'}", "-lpinocchio_default")
"""What its units are compiled and linked with."""


def _sources() -> tuple[Source, ...]:
    text = (HERE / "pinocchio.cpp").read_text()
    return (Source("Pinocchio", "model", text, "c++", (PREFIX / "include", HEADERS), LINK),)


PEER = Peer("Pinocchio", _sources, "pin")
