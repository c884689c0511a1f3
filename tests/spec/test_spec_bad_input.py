"""Every mistake of a user gets its code, its exact place, what is wrong and a cure; several are reported together."""

from pathlib import Path

import pytest
from bad_specs import EXAMPLE, MARK, ONE, Bad

from walkgen.errors import Problem, SpecError
from walkgen.spec.read import read

DATA = Path(__file__).parent / "data"


def problems(folder: Path, text: str) -> tuple[Problem, ...]:
    spec = folder / "robot.toml"
    spec.write_text(text, encoding="utf-8")
    with pytest.raises(SpecError) as error:
        read(spec)
    assert [path.name for path in folder.iterdir()] == ["robot.toml"], "reading writes nothing"
    return error.value.problems


@pytest.mark.parametrize("bad", ONE, ids=lambda bad: bad.name)
def test_one_mistake_is_reported_once_at_its_place(bad: Bad, tmp_path: Path) -> None:
    found = problems(tmp_path, bad.text)
    about = [problem for problem in found if problem.code == bad.code]
    assert len(about) == 1, "\n".join(map(str, found))
    place = about[0].place
    assert place is not None
    assert (place.line, place.column) == bad.place, str(about[0])
    assert place.file == str(tmp_path / "robot.toml")
    assert place.source == bad.text.split("\n")[place.line - 1][:200].rstrip()
    assert bad.says in str(about[0])
    assert about[0].cure


FOLLOW = {
    "chain of no joints": {"WG145"},  # nothing uses it either
    "upper case": {"WG140"},  # whoever used the old name now names nothing
    "comment mark": {"WG140"},
    "quote": {"WG140"},
    "not ASCII": {"WG140"},
    "newline": {"WG140"},
    "too long": {"WG140"},
    "empty": {"WG140"},
    "keyword of C++": {"WG140"},
}


@pytest.mark.parametrize("bad", ONE, ids=lambda bad: bad.name)
def test_one_mistake_has_no_false_consequences(bad: Bad, tmp_path: Path) -> None:
    found = {problem.code for problem in problems(tmp_path, bad.text)}
    assert found == {bad.code} | FOLLOW.get(bad.name, set())


def test_many_mistakes_are_reported_together(tmp_path: Path) -> None:
    text = EXAMPLE
    for old, new in (
        ("gravity = [0.0, 0.0, -9.80665]", "gravity = [0.0, 0.0, -9.80665, 1.0]"),
        ("alpha_deg = 90", "alfa_deg = 90"),
        ("limits_deg = [-90, 90]", "limits_deg = [90, -90]"),
        ('design = "mero_leg"', 'design = "mero_log"'),
        ("mass = 12.0", "mass = nan"),
        ('platform = "front"', 'platform = "frnt"'),
    ):
        text = text.replace(old, new, 1)
    found = problems(tmp_path, text)
    assert [problem.code for problem in found] == ["WG112", "WG110", "WG160", "WG113", "WG140", "WG140"]
    lines = [problem.place.line for problem in found if problem.place]
    assert lines == sorted(lines)
    assert len(lines) == len(found)


def test_unphysical_inertias_are_accepted_on_demand(tmp_path: Path) -> None:
    spec = tmp_path / "robot.toml"
    broken = EXAMPLE.replace(
        "inertia = [0.002, 0.002, 0.002, 0.0, 0.0, 0.0] }", "inertia = [0.1, 0.1, 0.9, 0.0, 0.0, 0.0], allow_unphysical = true }", 1
    )
    broken = broken.replace("inertia = [0.2, 0.3, 0.4,", "allow_unphysical = true\ninertia = [0.2, 0.3, 4.0,", 1)
    assert broken.count("allow_unphysical") == 2
    spec.write_text(broken, encoding="utf-8")
    assert read(spec).platforms[0].allow_unphysical


def test_massless_links_and_flat_plates_are_real(tmp_path: Path) -> None:
    spec = tmp_path / "robot.toml"
    text = EXAMPLE.replace("mass = 1.2, com = [0.0, 0.0, 0.0], inertia = [0.002, 0.002, 0.002, 0.0", "mass = 0, inertia = [0, 0, 0, 0.0", 1)
    text = text.replace("inertia = [0.2, 0.3, 0.4, 0.0, 0.0, 0.0]", "inertia = [0.1, 0.2, 0.3, 0.0, 0.0, 0.0]", 1)
    assert text.count("mass = 0,") == text.count("[0.1, 0.2, 0.3,") == 1
    spec.write_text(text, encoding="utf-8")
    assert read(spec).legs


def test_columns_count_characters_not_bytes(tmp_path: Path) -> None:
    text = EXAMPLE.replace("mount = { xyz", 'mount = { "äöü" = 1, xyzz = 2, xyz', 1)
    columns = [problem.place.column for problem in problems(tmp_path, text) if problem.place]
    assert columns == [11, 22]


def test_windows_files_have_the_same_places(tmp_path: Path) -> None:
    bad = next(bad for bad in ONE if bad.name == "crossed limits")
    spec = tmp_path / "robot.toml"
    spec.write_bytes(b"\xef\xbb\xbf" + bad.text.replace("\n", "\r\n").encode())
    with pytest.raises(SpecError) as error:
        read(spec)
    place = error.value.problems[0].place
    assert place is not None
    assert (place.line, place.column) == bad.place


def test_the_example_of_a_linkage_is_read() -> None:
    assert read(DATA / "example_linkage.toml").leg_designs["hydraulic"].planar


def test_messages_escape_what_terminals_obey(tmp_path: Path) -> None:
    for problem in problems(tmp_path, EXAMPLE.replace('name = "front_left"', 'name = "a\\u001b[2Jb"', 1)):
        assert "\x1b" not in str(problem)


def test_keys_that_look_like_inner_marks_are_unknown(tmp_path: Path) -> None:
    text = EXAMPLE.replace("walkgen = 1", 'walkgen = 1\n"end:pose" = 1', 1).replace('end = "level"', 'end = { "end:pose" = 2 }\n#', 1)
    found = problems(tmp_path, text)
    assert [(problem.code, problem.place.column) for problem in found if problem.place] == [("WG110", 1), ("WG110", 9), ("WG124", 1)]


def test_marks_are_unique() -> None:
    assert all(bad.marked.count(MARK) == 1 for bad in ONE)
    assert len({bad.name for bad in ONE}) == len(ONE)
