"""walkgen's C of specs/mero_leg.toml: under every set of flags, and under the flags that walkgen itself compiles with."""

import json
from pathlib import Path

from peers.source import HERE, Peer, Source
from walkgen import pipeline, toolchain

SPEC = HERE.parents[1] / "specs" / "mero_leg.toml"
OUTPUT = HERE.parent / "_build" / "generated"


def built() -> Path:
    """The robot's folder, made by the pipeline."""
    return pipeline.build(SPEC, OUTPUT).folder


def unit(folder: Path) -> str:
    """The robot's C behind the names that the harness calls."""
    digest = json.loads((folder / "manifest.json").read_text())["digest"]
    return f'/* sources {digest} */\n{(folder / "mero_leg.c").read_text()}\n#include "walkgen_adapter.h"\n'


def _sources() -> tuple[Source, ...]:
    folder = built()
    text = unit(folder)
    return (
        Source("walkgen", "default flags", text, includes=(folder,), flags=toolchain.FLAGS),
        Source("walkgen", "spec", text, includes=(folder,)),
    )


PEER = Peer("walkgen", _sources)
