"""Whatever a file holds, reading it gives a RobotSpec or problems with places, never another exception."""

from pathlib import Path

from bad_specs import EXAMPLE
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from walkgen.errors import WalkgenError
from walkgen.spec.read import read
from walkgen.spec.schema import RobotSpec

LINES = EXAMPLE.split("\n")
VALUES = st.sampled_from(
    [
        "nan",
        "-inf",
        "1e400",
        "-1",
        "0",
        "true",
        "1979-05-27",
        "[]",
        "{}",
        "[[1]]",
        "{ a = 1 }",
        "[1, 2]",
        "[1, 2, 3]",
        "[nan, 0, 1]",
        "9" * 400,
        '"pi"',
        '"thigh"',
        '"shank"',
        '"1/(thigh - 0.35)"',
        '"sqrt(-1)"',
        '"a+"',
        '"level"',
        '"*/"',
        '"é"',
        '""',
        '"{x}"',
        '"x\\u0000"',
        "'''\na'''",
    ]
)
KEYS = st.sampled_from(
    [
        "walkgen",
        "name",
        "joints",
        "link",
        "legs",
        "platforms",
        "parent",
        "chain",
        "mirror_of",
        "end",
        "foot",
        "signs",
        "zeros_deg",
        "dh",
        "pins",
        "mass",
        "inertia",
        "axis",
        "xyz",
        "alpha",
        "limits",
        "source_names",
        "functions",
        "domain",
        "damping",
        "bounds",
        "value",
        '"a b"',
        '"end:pose"',
        "x",
        "height",
    ]
)
HEADERS = st.sampled_from(
    [
        "[robot]",
        "[robot.name]",
        "[[legs]]",
        "[legs]",
        "[[platforms]]",
        "[parameters]",
        "[leg_designs.x]",
        "[[leg_designs.x.joints]]",
        "[x.y]",
        "[chain_designs]",
        "[sections.a]",
        "[parameters.domain]",
        '[leg_designs."end:pose"]',
        "[[terrain]]",
        "[generate]",
        "[[leg_designs.mero_leg.joints]]",
        "[leg_designs.mero_leg.joints.link]",
    ]
)
ASSIGNMENTS = st.builds("{} = {}".format, KEYS, VALUES)
FUZZ = settings(max_examples=150, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])


def check(folder: Path, text: str) -> None:
    path = folder / "robot.toml"
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        assert isinstance(read(path), RobotSpec)
    except WalkgenError as error:
        for problem in error.problems:
            assert problem.code == "WG106" or problem.place is not None
            assert problem.cure
            assert str(problem).encode()
            assert all(letter.isprintable() or letter == "\n" for letter in str(problem).replace(str(path), ""))


@FUZZ
@given(st.text(max_size=200))
def test_any_text(tmp_path: Path, text: str) -> None:
    check(tmp_path, text)


@FUZZ
@given(st.lists(st.one_of(HEADERS, ASSIGNMENTS), max_size=25).map("\n".join))
def test_any_tables(tmp_path: Path, text: str) -> None:
    check(tmp_path, text)


@FUZZ
@given(st.lists(st.tuples(st.integers(0, len(LINES) - 1), st.one_of(HEADERS, ASSIGNMENTS, VALUES, st.sampled_from(LINES))), max_size=5))
def test_any_change_of_a_good_spec(tmp_path: Path, changes: list[tuple[int, str]]) -> None:
    lines = list(LINES)
    for index, change in changes:
        key, equals, _ = lines[index].partition("=")
        lines[index] = f"{key}= {change}" if equals and "=" not in change and "[" not in change[:1] else change
    check(tmp_path, "\n".join(lines))


@FUZZ
@given(st.integers(0, len(EXAMPLE)), st.integers(0, 40), st.text(alphabet="=.\"[]{},#\n\\ a1'", max_size=4))
def test_any_cut_of_a_good_spec(tmp_path: Path, start: int, length: int, filling: str) -> None:
    check(tmp_path, EXAMPLE[:start] + filling + EXAMPLE[start + length :])
