"""Files that are no spec, and files made to hurt: refused early, cheaply, and never with a traceback."""

import resource
import subprocess
import sys
from pathlib import Path

import pytest
from bad_specs import EXAMPLE

from walkgen.errors import Problem, SpecError
from walkgen.spec.read import read

MEGABYTE = 1 << 20


def problem_of(path: Path) -> Problem:
    with pytest.raises(SpecError) as error:
        read(path)
    return error.value.problems[0]


def written(folder: Path, content: bytes) -> Path:
    path = folder / "robot.toml"
    path.write_bytes(content)
    return path


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    problem = problem_of(tmp_path / "nero.toml")
    assert problem.code == "WG101"
    assert "nero.toml" in problem.message


@pytest.mark.parametrize("path", [Path(), Path("/dev/null"), Path("a\0b"), Path("x" * 5000)], ids=["folder", "device", "zero", "long"])
def test_what_is_no_file_is_refused(path: Path) -> None:
    assert problem_of(path).code == "WG101"


def test_a_large_file_is_refused(tmp_path: Path) -> None:
    assert problem_of(written(tmp_path, b"#" * (MEGABYTE + 1))).code == "WG102"
    small = written(tmp_path, EXAMPLE.encode() + b"#" * (MEGABYTE - len(EXAMPLE.encode())))
    assert small.stat().st_size == MEGABYTE
    assert read(small).legs


def test_another_encoding_is_refused_at_its_place(tmp_path: Path) -> None:
    problem = problem_of(written(tmp_path, b"walkgen = 1\n# f\xfcr"))
    assert problem.code == "WG103"
    assert problem.place is not None
    assert (problem.place.line, problem.place.column) == (2, 4)


@pytest.mark.parametrize(
    ("text", "line", "column"),
    [("a = 1\nb = = 2\n", 2, 5), ("a = 1\na = 2\n", 2, 6), ('[robot\nname = "x"\n', 1, 7), ("a = 'x", 1, 7), ("a = 1\rb = 2", 1, 6)],
)
def test_a_mistake_of_syntax_has_its_place(text: str, line: int, column: int, tmp_path: Path) -> None:
    problem = problem_of(written(tmp_path, text.encode()))
    assert problem.code == "WG104"
    assert problem.place is not None
    assert (problem.place.line, abs(problem.place.column - column) <= 1) == (line, True)


def parameters(rows: list[str]) -> str:
    return EXAMPLE.replace("[parameters]", "\n".join(["[parameters]", *rows]))


BOMBS = {
    "arrays": ("WG105", "a = " + "[" * 20_000),
    "tables": ("WG105", "a = " + "{a = " * 10_000),
    "key": ("WG105", ".".join("a" * 500_000) + " = 1"),
    "header": ("WG105", "[" + ".".join("a" * 500_000) + "]"),
    "keys": ("WG105", "\n".join(f"{'a.' * 200}b{index} = 1" for index in range(2000))),
    "keys in a table": ("WG105", "x = {" + ",".join(f"{'a.' * 100}b{index} = 1" for index in range(4000)) + "}"),
    "short keys": ("WG107", "\n".join(f"{'a.' * 11}b{index} = 1" for index in range(30_000))),
    "many entries": ("WG107", "a = [" + "1," * 400_000 + "]"),
    "many tables": ("WG107", "[[a]]\n" * 100_000),
    "digits": ("WG113", "a = " + "9" * 900_000),
    "powers": ("WG114", parameters(["a = '((((9**64)**64)**64)**64)**64'"])),
    "chained powers": ("WG164", parameters(["a0 = '1.000000001'"] + [f"a{index} = 'a{index - 1}**64'" for index in range(1, 12)])),
    "laughs": ("WG164", parameters(["a0 = 'sin(1)'"] + [f"a{index} = '{'+'.join([f'a{index - 1}'] * 40)}'" for index in range(1, 30)])),
    "brackets": ("WG114", EXAMPLE.replace('a = "shank"', f'a = "{"(" * 900}"', 1)),
}
SCRIPT = """
import resource, sys
from pathlib import Path
from walkgen.errors import SpecError
from walkgen.spec.read import read
before = resource.getrusage(resource.RUSAGE_SELF)
try:
    read(Path(sys.argv[1]))
    code = "none"
except SpecError as error:
    code = error.problems[0].code
after = resource.getrusage(resource.RUSAGE_SELF)
peak = next(line.split()[1] for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
print(code, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, int(peak) / 1024)
"""


def bound() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
    resource.setrlimit(resource.RLIMIT_AS, (600 * MEGABYTE, 600 * MEGABYTE))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", BOMBS)
def test_bombs_cost_neither_time_nor_memory(name: str, tmp_path: Path) -> None:
    expected, text = BOMBS[name]
    path = written(tmp_path, text.encode())
    done = subprocess.run([sys.executable, "-c", SCRIPT, str(path)], preexec_fn=bound, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    code, seconds, memory = done.stdout.split()
    assert code == expected
    assert float(seconds) < 2.0  # of processor time; a twentieth is usual
    assert float(memory) < 100  # MiB, interpreter and imports included


def test_a_long_list_of_problems_is_cut(tmp_path: Path) -> None:
    path = written(tmp_path, "\n".join(f"k{index} = {index}" for index in range(3000)).encode())
    with pytest.raises(SpecError) as error:
        read(path)
    assert len(error.value.problems) == 201
    assert error.value.problems[-1].code == "WG106"


def test_reading_leaves_no_trace(tmp_path: Path) -> None:
    path = written(tmp_path, EXAMPLE.encode())
    read(path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["robot.toml"]
