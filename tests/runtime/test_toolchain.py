"""A compiler is found in a fixed order, and what it builds is named by what went in."""

import importlib.util
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from walkgen import compilers, toolchain
from walkgen.errors import ToolchainError

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wcast-qual", "-Werror")


def test_cc_is_taken_with_its_flags(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "gcc -DCHOSEN=1")
    compiler = compilers.find_compiler()
    assert compiler.label == "$CC"
    assert compiler.command == (shutil.which("gcc"), "-DCHOSEN=1")
    assert compilers.which() == (compiler,)


@pytest.mark.parametrize("command", ["no-such-compiler", "false"])
def test_cc_that_does_not_answer(monkeypatch: pytest.MonkeyPatch, command: str) -> None:
    monkeypatch.setenv("CC", command)
    with pytest.raises(ToolchainError, match=f"tried {command}") as error:
        compilers.find_compiler()
    assert error.value.problems[0].code == "WG401"


def test_order_without_cc(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CC", raising=False)
    labels = [label for label, _ in compilers.candidates()]
    assert labels[:3] == ["cc", "gcc", "clang"]
    assert labels[3:] == (["ziglang"] if importlib.util.find_spec("ziglang") else [])
    assert compilers.which()[0] == compilers.find_compiler()


def test_flags_and_sources_name_the_build(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sources = ("tiny.h", "tiny.c", "walkgen_status.h", "walkgen_math.h", "walkgen_real_f64.h", "tiny_python.c", "walkgen_loops.h")
    digest = toolchain.source_digest(fresh, sources)
    first = toolchain.build_library(fresh, "tiny", sources, digest)
    assert toolchain.find_library(fresh, "tiny", digest) == first
    monkeypatch.setattr(toolchain, "FLAGS", (*toolchain.FLAGS, "-DOTHER"))
    assert toolchain.find_library(fresh, "tiny", digest) is None
    second = toolchain.build_library(fresh, "tiny", sources, digest)
    assert second.path.parent != first.path.parent
    assert not first.path.exists()


def test_digest_is_over_names_and_bytes_in_order(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"1")
    (tmp_path / "b").write_bytes(b"2")
    assert toolchain.source_digest(tmp_path, ("a", "b")) == toolchain.hashlib.sha256(b"a\x001b\x002").hexdigest()


@pytest.mark.skipif(sys.platform == "win32", reason="a compiler in a shell script")
@pytest.mark.parametrize(("name", "effort"), [("clang version 15", "-O2"), ("gcc 12", "-O1")])
def test_each_compiler_gets_the_passes_it_knows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, effort: str) -> None:
    told, script = tmp_path / "told", tmp_path / "compiler"
    script.write_text(f'#!/bin/sh\ncase "$1" in --version) echo "{name}"; exit;; esac\necho "$@" >> {told}\nexec gcc "$@"\n')
    script.chmod(0o755)
    monkeypatch.setenv("CC", str(script))
    (tmp_path / "main.c").write_text("int main(void) { return 0; }\n")
    toolchain.build_program(tmp_path, ("main.c",), tmp_path / "main", toolchain._EFFORT + toolchain._IDLE)
    flags = told.read_text().split()
    assert effort in flags
    assert ("-fno-dse" in flags) == (effort == "-O1")


def test_program(tmp_path: Path) -> None:
    (tmp_path / "one.c").write_text(
        '#include <math.h>\n#include <stdio.h>\nint two(void);\nint main(void) { printf("%g", sqrt(two())); }\n'
    )
    (tmp_path / "two.c").write_text("int two(void);\nint two(void) { return 4; }\n")
    program = toolchain.build_program(tmp_path, ("one.c", "two.c"), tmp_path / "program")
    assert subprocess.run([program], check=True, capture_output=True).stdout == b"2"
    assert sorted(path.name for path in tmp_path.iterdir() if path.name != "cache") == ["one.c", "program", "two.c"]


def test_parts_of_a_large_source_are_compiled_apart(tmp_path: Path) -> None:
    """Each defines what the other calls; a part compiled twice, or left out, would not link."""
    guards = [f"#if !defined(WALKGEN_PART) || WALKGEN_PART == {part}\n" for part in (1, 2)]
    halves = ("int two(void);\nint main(void) { return two() - 2; }\n", "int two(void);\nint two(void) { return 2; }\n")
    (tmp_path / "whole.c").write_text("".join(f"{guard}{half}#endif\n" for guard, half in zip(guards, halves, strict=True)))
    program = toolchain.build_program(tmp_path, ("whole.c",), tmp_path / "program")
    assert subprocess.run([program], check=False).returncode == 0


def test_every_refusal_is_shown(tmp_path: Path) -> None:
    (tmp_path / "one.c").write_text("#error first\n")
    with pytest.raises(ToolchainError, match=r"(?s)refused the sources.*\$ .*-c one\.c.*first") as error:
        toolchain.build_program(tmp_path, ("one.c",), tmp_path / "program")
    assert error.value.problems[0].code == "WG402"
    assert not (tmp_path / "program").exists()


@pytest.mark.skipif(not importlib.util.find_spec("ziglang"), reason="the zig extra is not installed")
@pytest.mark.nightly
def test_zig_builds_the_library(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from walkgen.runtime import load

    monkeypatch.setenv("CC", f"{sys.executable} -m ziglang cc")
    robot = load(fresh)
    assert robot.backend == "c"
    assert robot.legs["left"].foot_position([1, 2, 3])[1] == 6


@pytest.mark.parametrize("variant", ["plain", "both"])
@pytest.mark.parametrize(
    "command",
    [("gcc", "-std=c99", "-Wdouble-promotion", "-Wmissing-prototypes"), ("g++", "-std=c++11", "-x", "c++")],
    ids=["c99", "c++11"],
)
def test_loops_compile_without_a_warning(folders: Callable[[str], Path], tmp_path: Path, variant: str, command: tuple[str, ...]) -> None:
    compiler, *flags = command
    program = shutil.which(compiler)
    if program is None:
        pytest.skip(f"{compiler} is not installed")
    arguments = [program, *flags, *WARNINGS, "-c", "tiny_python.c", "-o", str(tmp_path / "loops.o")]
    subprocess.run(arguments, cwd=folders(variant), check=True)


def test_library_has_no_symbol_outside_its_prefix(folders: Callable[[str], Path]) -> None:
    nm = shutil.which("nm")
    if nm is None:
        pytest.skip("nm is not installed")
    library = next((folders("both") / "_build").glob(f"*/{toolchain.library_name('tiny')}"))
    listed = subprocess.run([nm, "-D", "--defined-only", str(library)], check=True, capture_output=True, text=True).stdout
    names = [line.split()[-1] for line in listed.splitlines()]
    assert "tiny_left_foot_position_loop" in names
    assert "tiny_f32_left_foot_position_loop" in names
    assert [name for name in names if not name.startswith(("tiny_", "_init", "_fini"))] == []
