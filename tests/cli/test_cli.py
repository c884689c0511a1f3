"""The command line as a user meets it: what it prints, where, its exit codes, and what it leaves on disk."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from walkgen.cli import app

SPECS = Path(__file__).parents[2] / "specs"
LEG = SPECS / "mero_leg.toml"
BAD = LEG.read_text(encoding="utf-8").replace("limits_deg = [-60, 60]", "limits_deg = [60, -60]").replace("gravity", "gravitas", 1)


def run(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def tree(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture(scope="module")
def generated(tmp_path_factory):
    """A folder with mero_leg built by the command line, and what that printed."""
    folder = tmp_path_factory.mktemp("cli") / "generated"
    return folder, run("build", LEG, "-o", folder)


@pytest.fixture
def bad(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text(BAD, encoding="utf-8")
    return path


# ---- start-up ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("arguments", [["--help"], ["build", "--help"], ["--version"], ["explain", "WG101"]])
def test_light_commands_import_nothing_heavy(arguments):
    heavy = ("sympy", "casadi", "numpy", "jinja2")
    code = f"""
import sys
from walkgen.cli import app
try:
    app({arguments!r})
except SystemExit as end:
    assert not end.code, end.code
assert not [name for name in {heavy!r} if name in sys.modules]
"""
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)


def test_help_names_every_command():
    commands = ("build", "check", "show", "new", "test", "import", "export", "gait", "doctor", "explain")
    assert all(re.search(rf"^\W*{command}\b", run("--help").stdout, re.MULTILINE) for command in commands)


def test_an_unknown_command_is_the_users_error():
    assert run("biuld").exit_code == 2


# ---- build -------------------------------------------------------------------------------------------------------------------


def test_build_says_what_it_made(generated):
    folder, result = generated
    assert result.exit_code == 0
    first = result.stdout.splitlines()[0]
    match = re.fullmatch(r"(.*): (\d+) files, (\d+) functions, (\d+) operations, \d+\.\d s", first)
    assert match
    manifest = json.loads((folder / "mero_leg" / "manifest.json").read_text(encoding="utf-8"))
    assert match[1] == str(folder / "mero_leg")
    assert int(match[3]) == len(manifest["functions"])
    assert int(match[4]) == sum(function["operations"] for function in manifest["functions"])
    listed = {line.strip() for line in result.stdout.splitlines()[1:-1]}
    assert listed == {str(path) for path in tree(folder / "mero_leg") if path.parts[0] != "_build"}
    assert int(match[2]) == len(listed)
    assert result.stderr == ""


def test_check_finds_nothing_after_a_build(generated):
    before = tree(generated[0])
    result = run("build", "--check", LEG, "-o", generated[0])
    assert (result.exit_code, result.stdout) == (0, "1 robot up to date\n")
    assert tree(generated[0]) == before


def test_check_names_what_is_stale_and_changes_nothing(generated, tmp_path):
    folder = tmp_path / "generated"
    shutil.copytree(generated[0], folder)
    (folder / "mero_leg" / "mero_leg.c").write_text("/* edited */\n", encoding="utf-8")
    (folder / "mero_leg" / "mero_leg.pc").unlink()
    before = tree(folder)
    result = run("build", "--check", LEG, "-o", folder)
    assert result.exit_code == 1
    cure = f"is stale; run: walkgen build {LEG} -o {folder}"
    assert set(result.stdout.splitlines()) == {f"{folder / 'mero_leg' / name} {cure}" for name in ("mero_leg.c", "mero_leg.pc")}
    assert tree(folder) == before


def test_targets_choose_what_is_written(tmp_path):
    assert run("build", LEG, "-o", tmp_path, "--targets", "numpy").exit_code == 0
    names = {path.name for path in (tmp_path / "mero_leg").iterdir()}
    assert "mero_leg_numpy.py" in names
    assert not {"mero_leg.c", "mero_leg_casadi.py"} & names


def test_an_unknown_target_is_the_users_error(tmp_path):
    result = run("build", LEG, "-o", tmp_path / "out", "--targets", "c,fortran")
    assert result.exit_code == 2
    assert "fortran" in result.stderr
    assert not (tmp_path / "out").exists()


def test_a_wrong_spec_is_reported_whole_and_writes_nothing(bad, tmp_path):
    result = run("build", bad, "-o", tmp_path / "generated")
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    places = re.findall(rf"^{re.escape(str(bad))}:(\d+):(\d+)  (WG\d\d\d)  ", result.stderr, re.MULTILINE)
    assert len(places) >= 2
    lines = BAD.splitlines()
    assert {"gravitas" in lines[int(line) - 1] for line, _, _ in places} == {True, False}
    assert not (tmp_path / "generated").exists()


def test_a_wrong_spec_does_not_keep_the_next_from_being_built(bad, tmp_path):
    result = run("build", bad, LEG, "-o", tmp_path / "generated", "--targets", "numpy")
    assert result.exit_code == 2
    assert (tmp_path / "generated" / "mero_leg" / "manifest.json").is_file()


def test_no_traceback_reaches_the_user(bad, tmp_path):
    command = [sys.executable, "-m", "walkgen.cli", "build", str(bad), str(tmp_path / "none.toml")]
    result = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert result.returncode == 2
    assert "Traceback" not in result.stderr
    assert "none.toml" in result.stderr


# ---- check -------------------------------------------------------------------------------------------------------------------


def test_check_passes_every_shipped_spec():
    specs = sorted(SPECS.glob("*.toml"))
    result = run("check", *specs)
    assert (result.exit_code, result.stdout) == (0, f"{len(specs)} specs without a problem\n")


def test_check_in_json(bad):
    result = run("check", bad, "--format", "json")
    assert result.exit_code == 2
    problems = json.loads(result.stdout)
    assert all({"file", "line", "column", "code", "message", "cure"} == set(problem) for problem in problems)
    assert json.loads(run("check", LEG, "--format", "json").stdout) == []


def test_the_schema_knows_every_table():
    schema = json.loads(run("check", "--schema").stdout)
    assert {"walkgen", "robot", "generate", "parameters", "leg_designs", "chain_designs", "platforms", "legs"} <= set(schema["properties"])


def test_check_without_a_spec_says_what_is_missing():
    assert run("check").exit_code == 2


# ---- show, new, test, doctor, explain ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], ["1 platforms, 0 chains, 1 legs, 3 joints", "Tz(0.12) Rx(pi/2)", "inverse: yaw-pitch-pitch: axis 1"]),
        (["--stage", "spec"], ["alpha_deg = 90", "gravity = [0, 0, -9.80665]"]),
        (["--function", "foot_position"], ["mero_leg_leg_foot_position(q[3] rad) -> p[3] m", "= cos(q[0])", "p[2] = "]),
        (["--function", "inverse"], ["yaw-pitch-pitch", "rho_plus_knee_plus", "mero_leg_leg_inverse(p[3] m) -> q[4, 3] rad, status[4]"]),
        (["--stage", "program", "--function", "foot_position"], ["operations: ", "v0 = q[0]", "p[0] = v"]),
        (["--stage", "program"], ["mero_leg_leg_foot_hessian", "mero_leg_foot_positions"]),
    ],
)
def test_show(arguments, words):
    result = run("show", LEG, *arguments)
    assert result.exit_code == 0
    assert [word for word in words if word not in result.stdout] == []


PERPENDICULAR = "axis 1 is perpendicular to axis 2 and axis 2 parallel to axis 3"
PIEPER = "the roots of a quartic by elimination (Pieper 1968), then Newton's polish"
ARM = [(0.0, 90, 0.3), (0.4, 0, 0.0), (0.0, 90, 0.05), (0.0, -90, 0.4), (0.0, 90, 0.0), (0.0, 0, 0.1)]
SHOWN = {
    "ambler_rrp": (
        SPECS / "ambler_rrp.toml",
        ["general RRP: the joints are RRP, not three revolute ones", PIEPER, "root_1, root_2, root_3, root_4"],
    ),
    "ambler_rpp": (SPECS / "ambler_rpp.toml", ["general RPP", "the roots of a quadratic", "branches: root_1, root_2"]),
    "mero_leg": (LEG, [f"yaw-pitch-pitch: {PERPENDICULAR}"]),
    "solo12": (SPECS / "solo12.toml", [f"yaw-pitch-pitch: {PERPENDICULAR}"]),
}


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.nightly) if name == "solo12" else name for name in SHOWN])
def test_show_says_the_class_of_the_inverse_and_why(name):
    path, words = SHOWN[name]
    result = run("show", path, "--function", "inverse")
    assert result.exit_code == 0
    assert [word for word in words if word not in result.stdout] == []


def test_show_says_how_far_a_printed_angle_is_from_the_class(tmp_path):
    (tmp_path / "leg.toml").write_text(LEG.read_text(encoding="utf-8").replace("alpha_deg = 90", "alpha = 1.57", 1), encoding="utf-8")
    result = run("show", tmp_path / "leg.toml", "--function", "inverse")
    assert result.exit_code == 0
    assert f"inverse: general RRR: axes 1 and 2 are 1.57 rad apart, not perpendicular; {PIEPER}" in result.stdout


def test_show_says_why_there_is_no_closed_inverse(tmp_path):
    """Six joints: the reason, and no equations."""
    rows = "".join(
        f'[[leg_designs.arm.joints]]\nname = "j{i}"\ntype = "revolute"\na = {a}\nalpha_deg = {alpha}\nd = {d}\n'
        for i, (a, alpha, d) in enumerate(ARM)
    )
    head = 'walkgen = 1\n[robot]\nname = "arm"\ngravity = [0, 0, -9.81]\n[generate]\nfunctions = ["inverse_near", "inverse_pose"]\n'
    rows = f'[leg_designs.arm]\ndh = "classic"\n{rows}'
    tail = '[[platforms]]\nname = "body"\n[[legs]]\nname = "arm"\ndesign = "arm"\nplatform = "body"\n'
    (tmp_path / "arm.toml").write_text(head + rows + tail, encoding="utf-8")
    result = run("show", tmp_path / "arm.toml", "--function", "inverse")
    assert result.exit_code == 0
    assert "inverse: none in closed form: 6 joints leave the foot position redundant: solved by iteration from a seed" in result.stdout
    assert "branches" not in result.stdout
    for name in ("inverse_near", "inverse_pose"):
        assert f"arm_arm_{name}(" in run("show", tmp_path / "arm.toml", "--function", name).stdout


def test_show_of_an_unknown_function_names_the_nearest():
    result = run("show", LEG, "--function", "foot_positon")
    assert result.exit_code == 2
    assert "did you mean 'foot_position'?" in result.stderr


@pytest.mark.parametrize("kind", ["leg", "hexapod", "quadruped", "modular"])
def test_new_specs_are_commented_and_right(kind, tmp_path):
    result = run("new", kind)
    assert result.exit_code == 0
    assert result.stdout.startswith("#:schema ")
    (tmp_path / "new.toml").write_text(result.stdout, encoding="utf-8")
    assert run("check", tmp_path / "new.toml").exit_code == 0


def test_new_of_an_unknown_kind_names_the_kinds():
    result = run("new", "octopod")
    assert result.exit_code == 2
    assert "hexapod" in result.stderr


def test_the_self_test_passes_and_finds_a_wrong_number(generated, tmp_path, capfd):
    assert run("test", generated[0] / "mero_leg").exit_code == 0
    folder = tmp_path / "mero_leg"
    shutil.copytree(generated[0] / "mero_leg", folder)
    source = (folder / "mero_leg.c").read_text(encoding="utf-8")
    (folder / "mero_leg.c").write_text(source.replace("0.35", "0.36"), encoding="utf-8")
    assert run("test", folder).exit_code == 1
    assert "foot_position" in capfd.readouterr().out


def test_the_self_test_of_no_robot_is_the_users_error(tmp_path):
    result = run("test", tmp_path)
    assert result.exit_code == 2
    assert "WG520" in result.stderr


def test_doctor_names_compiler_and_packages(monkeypatch):
    lines = run("doctor").stdout.splitlines()
    assert any(line.startswith("C compiler  ") and line.endswith("(used)") for line in lines)
    assert any(re.fullmatch(r"required  sympy 1\.\d+.*", line) for line in lines)
    monkeypatch.setenv("CC", "no-such-compiler")
    assert "C compiler  missing" in run("doctor").stdout


def test_explain_gives_cause_and_cure():
    result = run("explain", "WG512")
    assert result.exit_code == 0
    assert "WG512" in result.stdout
    assert run("explain", "WG999").exit_code == 2
