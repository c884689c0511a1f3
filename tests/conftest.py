"""Fixtures that build robots from spec text, each text once a session."""

import gc
import hashlib
import json
import os
import pickle
import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import walkgen  # noqa: F401  # before any test imports sympy, whose cache it sets

if TYPE_CHECKING:
    from oracles.backends import Built
    from walkgen.emit.artifact import RobotCode

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices here are small, and the tests' own processes fill the cores
gc.set_threshold(200_000, 50, 100)  # derivations make many objects and few cycles: a tenth of the tests' time was the search for these

GOLDEN = (5**0.5 - 1) / 2
SPECS = Path(__file__).parents[1] / "specs"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Leave to the night what `sampled` leaves out; multiples of the golden ratio favour no parameter of a product of several."""
    cases = defaultdict[str, list[pytest.Item]](list)
    for item in items:
        if item.get_closest_marker("sampled"):
            cases[item.nodeid.partition("[")[0]].append(item)
    for group in cases.values():
        marker = group[0].get_closest_marker("sampled")
        assert marker
        order = sorted(range(len(group)), key=lambda place: place * GOLDEN % 1)
        for place in order[marker.args[0] :]:
            group[place].add_marker("nightly")


@pytest.fixture(scope="session", autouse=True)
def _compiled_quickly() -> Iterator[None]:
    """Libraries that tests build in their own process are compiled at -O0, without wide vectors: a fraction of the usual time.

    Rows have the same arithmetic; wide vectors have tests of their own.

    What `walkgen build` itself compiles is tested by the command; `WALKGEN_AS_SHIPPED=1` (`make nightly`) keeps its flags everywhere.
    """
    from walkgen import toolchain

    with pytest.MonkeyPatch.context() as patch:
        if not os.environ.get("WALKGEN_AS_SHIPPED"):
            quick = ("-O0" if flag == "-O1" else flag for flag in toolchain.FLAGS)
            patch.setattr(toolchain, "FLAGS", (*quick, "-DWALKGEN_PLAIN"))
        yield


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], "Built"]:
    """Build a robot from the text of its spec; the processes of one test run share what is built."""
    from filelock import FileLock

    from oracles.backends import Built  # what needs sympy waits for the first robot, so that other tests start at once

    own = tmp_path_factory.getbasetemp()
    shared = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
    done: dict[str, Built] = {}

    def build(text: str) -> Built:
        if text not in done:
            folder = shared / "built" / hashlib.sha256(text.encode()).hexdigest()[:16]
            folder.mkdir(parents=True, exist_ok=True)
            spec, finished = folder / "spec.toml", folder / "folder"
            with FileLock(folder / "lock"):
                if not finished.exists():
                    spec.write_text(text, encoding="utf-8")
                    finished.write_text(str(_build(spec, folder)))
            done[text] = Built(spec, Path(finished.read_text()))
        return done[text]

    return build


def _build(spec: Path, folder: Path) -> Path:
    """The robot's folder; its programs are kept beside the spec, so that no test derives them once more."""
    from oracles.backends import KEPT
    from walkgen import pipeline

    kept: list[RobotCode] = []
    generate = pipeline.generate

    def keeping(*arguments: Any) -> "RobotCode":
        kept.append(generate(*arguments))
        return kept[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pipeline, "generate", keeping)
        found = pipeline.build(spec, folder / "generated").folder
    spec.with_name(KEPT).write_bytes(pickle.dumps(kept[0].functions))
    return found


@pytest.fixture(scope="session")
def shipped(built: Callable[[str], "Built"]) -> Callable[..., "Built"]:
    """Build a robot of specs/ by its name; where only some of its functions are tested, these alone are worth their time."""

    def build(name: str, functions: Sequence[str] = ()) -> "Built":
        text = (SPECS / f"{name}.toml").read_text(encoding="utf-8")
        return built(asking_for(functions, text) if functions else text)

    return build


def asking_for(functions: Sequence[str], text: str) -> str:
    """A spec with these functions in C and NumPy instead of what its `[generate]` table says."""
    without = re.sub(r"^\[generate\].*?(?=^\[|\Z)", "", text, flags=re.MULTILINE | re.DOTALL)
    return f'{without}\n[generate]\nfunctions = {json.dumps(list(functions))}\ntargets = ["c", "numpy"]\n'
