"""A folder becomes a robot, whatever state it is in; what cannot work says so."""

import json
import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tiny_robot import Tiny, write

from walkgen import compilers, toolchain
from walkgen.errors import ToolchainError
from walkgen.runtime import Robot, load

Q = [1.0, 2.0, 3.0]
P = [3.0, 6.0, np.cos(3.0)]


def library_of(folder: Path) -> Path:
    return next((folder / "_build").glob(f"*/{toolchain.library_name('tiny')}"))


def works(robot: Robot, backend: str) -> bool:
    return robot.backend == backend and bool(np.allclose(robot.legs["left"].foot_position(Q), P, rtol=1e-15))


def code_of(error: pytest.ExceptionInfo[ToolchainError]) -> str:
    return error.value.problems[0].code


@pytest.fixture
def no_compiler(folders: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch) -> None:
    folders("plain")  # compiled while there is a compiler
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(compilers.importlib.util, "find_spec", lambda _: None)


def test_compiles_once_then_finds(fresh: Path) -> None:
    first = load(fresh)
    assert works(first, "c")
    assert first.backend_reason == f"compiled {library_of(fresh)}"
    changed = library_of(fresh).stat().st_mtime_ns
    second = load(str(fresh))
    assert works(second, "c")
    assert second.backend_reason == f"found {library_of(fresh)}"
    assert library_of(fresh).stat().st_mtime_ns == changed


def test_build_folder_holds_library_and_record_only(built: Path) -> None:
    (folder,) = (built / "_build").iterdir()
    assert folder.name.startswith(f"{toolchain.platform_tag()}-")
    assert sorted(path.name for path in folder.iterdir()) == sorted(["build.json", toolchain.library_name("tiny")])


@pytest.mark.usefixtures("no_compiler")
def test_found_library_needs_no_compiler(built: Path) -> None:
    assert works(load(built), "c")


@pytest.mark.usefixtures("no_compiler")
def test_no_compiler_falls_back(fresh: Path) -> None:
    robot = load(fresh)
    assert works(robot, "numpy")
    assert "no C compiler answers (tried cc, gcc, clang)" in robot.backend_reason
    assert "in numpy (no C compiler" in repr(robot)


@pytest.mark.usefixtures("no_compiler")
def test_c_forced_without_compiler(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WALKGEN_BACKEND", "c")
    with pytest.raises(ToolchainError, match="pip install") as error:
        load(fresh)
    assert code_of(error) == "WG401"


@pytest.mark.usefixtures("no_compiler")
def test_no_compiler_and_no_numpy_file(fresh: Path) -> None:
    (fresh / "tiny_numpy.py").unlink()
    with pytest.raises(ToolchainError) as error:
        load(fresh)
    assert code_of(error) == "WG401"


def test_numpy_forced(built: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WALKGEN_BACKEND", "numpy")
    robot = load(built)
    assert works(robot, "numpy")
    assert robot.backend_reason == "WALKGEN_BACKEND=numpy"


def test_unknown_backend(built: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WALKGEN_BACKEND", "fortran")
    with pytest.raises(ToolchainError, match="use c, direct, ufunc, numpy") as error:
        load(built)
    assert code_of(error) == "WG407"


@pytest.mark.parametrize("damage", [lambda p: p.write_bytes(b"not a library"), lambda p: p.write_bytes(p.read_bytes()[:-1]), Path.unlink])
def test_damaged_library_is_built_again(built: Path, damage: Callable[[Path], object]) -> None:
    damage(library_of(built))
    robot = load(built)
    assert works(robot, "c")
    assert robot.backend_reason.startswith("compiled")


def test_library_that_does_not_load_is_built_again(built: Path) -> None:
    """The record vouches for the bytes, but they are another machine's."""
    library, record = library_of(built), library_of(built).with_name("build.json")
    library.write_bytes(b"\x7fELF of another machine")
    content = json.loads(record.read_text())
    content["library"] = toolchain.hashlib.sha256(library.read_bytes()).hexdigest()
    record.write_text(json.dumps(content))
    robot = load(built)
    assert works(robot, "c")
    assert robot.backend_reason.startswith("compiled")


@pytest.mark.parametrize("name", ["tiny.c", "tiny.h", "walkgen_loops.h"])
def test_changed_source_is_refused(built: Path, name: str) -> None:
    (built / name).write_text((built / name).read_text() + "\n")
    with pytest.raises(ToolchainError, match=r"walkgen build specs/tiny\.toml") as error:
        load(built)
    assert code_of(error) == "WG403"


def test_missing_source_is_refused(built: Path) -> None:
    (built / "tiny.c").unlink()
    with pytest.raises(ToolchainError, match=r"tiny\.c cannot be read") as error:
        load(built)
    assert code_of(error) == "WG403"


def test_older_builds_are_removed_and_nothing_else(built: Path) -> None:
    old = library_of(built).parent
    others = [f"{toolchain.platform_tag()}-notes", "plan9-sparc-0123456789abcdef", "mine"]
    for name in others:
        (built / "_build" / name).mkdir()
    shutil.rmtree(built.parent / "new", ignore_errors=True)
    new = write(Tiny(functions=("foot_position",)), built.parent / "new" / "tiny")
    for path in new.iterdir():
        shutil.copy(path, built / path.name)
    robot = load(built)
    assert works(robot, "c")
    assert list(robot.functions) == ["tiny_left_foot_position"]
    names = {path.name for path in (built / "_build").iterdir()}
    assert not old.exists()
    assert names == {*others, library_of(built).parent.name}


def test_folder_that_takes_no_files_builds_in_the_cache(fresh: Path, tmp_path: Path) -> None:
    (fresh / "_build").write_text("a file where the folder would be; works for root as well")
    robot = load(fresh)
    assert works(robot, "c")
    assert robot.backend_reason.startswith(f"compiled {tmp_path / 'cache' / 'walkgen' / 'tiny'}")
    assert load(fresh).backend_reason.startswith(f"found {tmp_path / 'cache'}")


def test_no_cache_either(fresh: Path, tmp_path: Path) -> None:
    (fresh / "_build").write_text("")
    (tmp_path / "cache").write_text("")
    assert works(load(fresh), "c")


def test_two_threads_load_at_once(fresh: Path) -> None:
    robots: list[Robot] = []
    threads = [threading.Thread(target=lambda: robots.append(load(fresh))) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [works(robot, "c") for robot in robots] == [True, True]
    assert [path.suffix for path in sorted(library_of(fresh).parent.iterdir())] == [".json", library_of(fresh).suffix]


def test_two_processes_load_at_once(fresh: Path) -> None:
    code = f"from walkgen.runtime import load; r = load({str(fresh)!r}); print(r.backend, r.legs['left'].foot_position({Q})[1])"
    started = [subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) for _ in range(2)]
    assert [process.communicate()[0] for process in started] == ["c 6.0\n", "c 6.0\n"]
    assert [path.name for path in (fresh / "_build").iterdir() if path.name.startswith(".tmp-")] == []


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (None, "WG404"),
        ("{", "WG404"),
        ('{"format": 1}', "WG404"),
        ('{"format": 2}', "WG405"),
        ("[]", "WG405"),
    ],
)
def test_no_manifest(tmp_path: Path, text: str | None, code: str) -> None:
    if text is not None:
        (tmp_path / "manifest.json").write_text(text)
    with pytest.raises(ToolchainError) as error:
        load(tmp_path)
    assert code_of(error) == code


def test_compiler_that_refuses(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = fresh / "tiny.c"
    source.write_text(source.read_text() + "\n#error no thanks\n")
    content = json.loads((fresh / "manifest.json").read_text())
    content["digest"] = toolchain.source_digest(fresh, content["sources"])
    (fresh / "manifest.json").write_text(json.dumps(content))
    robot = load(fresh)
    assert robot.backend == "numpy"
    assert "refused the sources" in robot.backend_reason
    monkeypatch.setenv("WALKGEN_BACKEND", "c")
    with pytest.raises(ToolchainError, match="no thanks") as error:
        load(fresh)
    assert code_of(error) == "WG402"


def test_generator_packages_are_not_needed(built: Path) -> None:
    blocked = ("sympy", "casadi", "jinja2", "pydantic", "mpmath", "tomli", "typer", "rich", "scipy")
    code = f"""
import sys
sys.modules.update(dict.fromkeys({blocked}))
from walkgen.runtime import load
robot = load({str(built)!r})
assert robot.legs["left"].foot_position({Q})[1] == 6.0
assert not [name for name in sys.modules if name.startswith(("walkgen.spec", "walkgen.model", "walkgen.emit", "walkgen.graph"))]
"""
    for backend in ("c", "numpy"):
        subprocess.run([sys.executable, "-c", code], check=True, env={**os.environ, "WALKGEN_BACKEND": backend})
