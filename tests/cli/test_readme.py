"""The README says only what is so: its spec becomes its C, its programs run and print what it prints."""

import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from walkgen import pipeline, toolchain

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def workplace(shipped, tmp_path_factory):
    """A folder with generated/mero, as after the README's first command."""
    folder = tmp_path_factory.mktemp("readme")
    (folder / "generated").symlink_to(shipped("mero").folder.parent, target_is_directory=True)
    return folder


def test_the_two_commands_are_single_lines():
    commands = [block.strip() for block in blocks("sh")]
    assert len(commands) == 2
    assert all("\n" not in command for command in commands)
    assert commands[0].endswith("walkgen build specs/mero.toml")
    assert commands[1].endswith("pytest -n 2")


def test_twelve_lines_become_the_function_shown(tmp_path):
    toml, shown = blocks("toml")[0], blocks("c")[0]
    assert len(toml.splitlines()) == 12
    (tmp_path / "hop.toml").write_text(toml, encoding="utf-8")
    pipeline.build(tmp_path / "hop.toml", tmp_path, pipeline.BuildOptions(targets=("c",)))
    assert shown in (tmp_path / "hop" / "hop.c").read_text(encoding="utf-8")


@pytest.mark.parametrize("program", blocks("python"))
def test_python_runs(workplace, tmp_path, program, monkeypatch):
    """In this process: another would compile the library once more, with its own flags."""
    (tmp_path / "program.py").write_text(program, encoding="utf-8")
    monkeypatch.chdir(workplace)
    runpy.run_path(str(tmp_path / "program.py"))


def test_the_c_program_prints_what_is_shown(workplace, tmp_path):
    mero = (workplace / "generated" / "mero").resolve()
    (tmp_path / "main.c").write_text(blocks("c")[1], encoding="utf-8")
    for source in mero.glob("*.[ch]"):
        (tmp_path / source.name).write_bytes(source.read_bytes())
    program = toolchain.build_program(tmp_path, ("main.c", "mero.c"), tmp_path / "main", toolchain.FLAGS)
    printed = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    assert blocks("console")[0].partition("\n")[2] == printed


def test_links_lead_somewhere():
    for target in re.findall(r"\]\(([^)]+)\)", README):
        assert (Path(__file__).parents[2] / target).exists(), target


def test_figures_are_those_measured_last():
    program = "import readme; print(*readme.lines(), sep=chr(10))"
    folder = Path(__file__).parents[2] / "benchmarks"
    measured = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=True).stdout
    shown = README.partition("<!-- figures")[2].partition("-->\n")[2].partition("<!-- end of figures")[0]
    shown_words, measured_words = shown.split(), measured.split()
    assert len(shown_words) == len(measured_words), "the README's figures are stale; run: python benchmarks/readme.py"
    figures = [pair for pair in zip(shown_words, measured_words, strict=True) if all(re.fullmatch(r"[0-9.]+", word) for word in pair)]
    assert len(figures) > 20
    assert all(float(old) == pytest.approx(float(new), rel=0.3) for old, new in figures), "stale; run: python benchmarks/readme.py"
