"""`walkgen import` and `walkgen export` as a user meets them."""

from pathlib import Path

from typer.testing import CliRunner

from walkgen.cli import app

LEG = Path(__file__).parents[2] / "specs" / "mero_leg.toml"
URDF = """<robot name="hopper">
  <link name="base"/><link name="thigh"/><link name="shank"/><link name="Foot"/>
  <joint name="HIP" type="revolute"><parent link="base"/><child link="thigh"/><limit lower="-1" upper="1"/></joint>
  <joint name="KNEE" type="revolute"><parent link="thigh"/><child link="shank"/><origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/></joint>
  <joint name="ankle" type="fixed"><parent link="shank"/><child link="Foot"/><origin xyz="0 0 -0.2"/></joint>
</robot>
"""
HIP = """<link name="thigh{side}"/><link name="foot{side}"/>
  <joint name="hip{side}" type="continuous"><parent link="torso"/><child link="thigh{side}"/><axis xyz="0 1 0"/></joint>
  <joint name="sole{side}" type="fixed"><parent link="thigh{side}"/><child link="foot{side}"/><origin xyz="0 0 -0.4"/></joint>
"""


def run(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


# ---- import ------------------------------------------------------------------------------------------------------------------


def test_import_writes_a_spec_that_builds(tmp_path):
    (tmp_path / "hopper.urdf").write_text(URDF, encoding="utf-8")
    spec = tmp_path / "hopper.toml"
    result = run("import", tmp_path / "hopper.urdf", "--foot", "Foot", "-o", spec)
    assert (result.exit_code, result.stdout) == (0, "")
    assert "HIP -> hip" in result.stderr
    assert run("check", spec).exit_code == 0
    assert run("build", spec, "-o", tmp_path / "generated", "--targets", "numpy").exit_code == 0
    assert run("import", tmp_path / "hopper.urdf", "--foot", "Foot").stdout == spec.read_text(encoding="utf-8")


def test_import_never_overwrites(tmp_path):
    (tmp_path / "hopper.urdf").write_text(URDF, encoding="utf-8")
    (tmp_path / "mine.toml").write_text("mine", encoding="utf-8")
    result = run("import", tmp_path / "hopper.urdf", "--foot", "Foot", "-o", tmp_path / "mine.toml")
    assert result.exit_code == 2
    assert "WG517" in result.stderr
    assert (tmp_path / "mine.toml").read_text(encoding="utf-8") == "mine"
    assert run("import", tmp_path / "hopper.urdf", "--foot", "Foot", "-o", tmp_path / "none" / "a.toml").exit_code == 2


def test_import_problems_have_places(tmp_path):
    path = tmp_path / "hopper.urdf"
    path.write_text(URDF.replace('"-0.3"', '"x"').replace("0 0 -0.3", "0 0 x"), encoding="utf-8")
    result = run("import", path, "--foot", "Foot")
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{path}:4:81  WG508  ")


# ---- export ------------------------------------------------------------------------------------------------------------------


def test_export_writes_what_import_reads(tmp_path):
    urdf = tmp_path / "leg.urdf"
    result = run("export", LEG, "--urdf", "-o", urdf)
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", f"{urdf} written\n")
    assert run("export", LEG, "--urdf").stdout == urdf.read_text(encoding="utf-8")
    assert run("import", urdf, "--foot", "leg", "-o", tmp_path / "back.toml").exit_code == 0
    assert run("check", tmp_path / "back.toml").exit_code == 0


def test_export_never_overwrites(tmp_path):
    (tmp_path / "mine.urdf").write_text("mine", encoding="utf-8")
    result = run("export", LEG, "--urdf", "-o", tmp_path / "mine.urdf")
    assert result.exit_code == 2
    assert "WG517" in result.stderr
    assert (tmp_path / "mine.urdf").read_text(encoding="utf-8") == "mine"


def test_export_needs_a_format_and_a_sound_spec(tmp_path):
    bad = tmp_path / "bad.toml"
    bad.write_text(LEG.read_text(encoding="utf-8").replace("limits_deg = [-60, 60]", "limits_deg = [60, -60]"), encoding="utf-8")
    assert run("export", LEG).exit_code == 2
    result = run("export", bad, "--urdf")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "WG160" in result.stderr


def test_import_keeps_a_waist_as_a_chain(tmp_path):
    path = tmp_path / "two.urdf"
    legs = [HIP.format(side=side) for side in "LR"]
    waist = '<joint name="waist" type="revolute"><parent link="base"/><child link="torso"/><limit lower="-1" upper="1"/></joint>'
    path.write_text(f'<robot name="two"><link name="base"/><link name="torso"/>{waist}{"".join(legs)}</robot>', encoding="utf-8")
    result = run("import", path, "--foot", "footL", "--foot", "footR", "-o", tmp_path / "two.toml")
    assert result.exit_code == 0
    assert {"torso -> torso", "footL -> footl", "waist -> waist"} <= set(result.stderr.splitlines())
    assert run("build", tmp_path / "two.toml", "-o", tmp_path / "generated", "--targets", "numpy").exit_code == 0
