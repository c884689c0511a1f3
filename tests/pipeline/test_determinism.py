"""The same spec gives the same bytes: for any hash seed, locale, time zone, folder and repetition."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from small_robots import committed, text, written

SPECS = Path(__file__).parents[2] / "specs"
SETTINGS = (
    {"PYTHONHASHSEED": "0", "LC_ALL": "C", "TZ": "UTC"},
    {"PYTHONHASHSEED": "1", "LC_ALL": "C.UTF-8", "TZ": "Asia/Kolkata"},
    {"PYTHONHASHSEED": "random", "LC_ALL": "de_DE.UTF-8", "TZ": "America/St_Johns", "PYTHONUTF8": "0", "PYTHONOPTIMIZE": "1"},
)


def build(folder, setting, robots):
    """Robots built by the command line in a process of its own, without a compiler: what the compiler makes is not committed."""
    folder.mkdir()
    small = written(folder / "small.toml", text())
    environment = {**os.environ, **setting, "CC": str(folder / "no-compiler")}
    command = (sys.executable, "-m", "walkgen.cli", "build", small, *(SPECS / f"{robot}.toml" for robot in robots))
    subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
    return committed(folder / "generated")


LARGE = ("mero_leg_param", "mero_star", "hydraulic_leg")


@pytest.fixture(scope="module", params=[("ambler_rpp",), pytest.param(LARGE, marks=pytest.mark.nightly)])
def outputs(request, tmp_path_factory):
    """One output for each setting, in folders of different names."""
    root = tmp_path_factory.mktemp("determinism")
    return [build(root / f"place {index}", setting, request.param) for index, setting in enumerate(SETTINGS)]


def test_bytes_do_not_depend_on_the_process(outputs):
    first, *others = outputs
    assert len(first) > 40
    for setting, other in zip(SETTINGS[1:], others, strict=True):
        assert [name for name in {*first, *other} if first.get(name) != other.get(name)] == [], setting


def test_no_path_is_in_them(outputs):
    assert not any(b"place 0" in content for content in outputs[0].values())
