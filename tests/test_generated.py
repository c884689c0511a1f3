"""The committed demo: the text of every small shipped robot is what a build writes today, and all of it stays small."""

from pathlib import Path

import pytest

from walkgen.pipeline import stale

ROOT = Path(__file__).parent.parent
GENERATED = ROOT / "generated"
LARGE = {
    "anthropomorphic_biped",
    "anthropomorphic_leg",
    "anthropomorphic_leg_poly",
    "mero",
    "mero_star",
    "mero_style",
    "solo12",
    "bessonov",
    "garrec",
    "hydraulic_leg",
    "minitaur",
    "odex",
    "pantograph",
    "quadruped",
    "balanced_leg_cam1",
    "balanced_leg_cam2",
    "balanced_leg_two_springs",
    "balanced_leg_total",
}  # their text is megabytes: git ignores it, other tests build them
SPECS = [spec for spec in sorted((ROOT / "specs").glob("*.toml")) if spec.stem not in LARGE]


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_generated_text_is_what_a_build_writes(spec):
    names = [Path(name).relative_to(ROOT) for name in stale(spec, GENERATED)]
    assert not names, f"{', '.join(map(str, names))} stale; run: walkgen build {spec.relative_to(ROOT)}"


def test_every_small_robot_is_there_and_no_other():
    folders = {path.relative_to(GENERATED).parts[0] for path in files()}
    assert folders - LARGE == {spec.stem for spec in SPECS}


def test_the_demo_is_under_six_megabytes():
    assert sum(path.stat().st_size for path in files() if path.relative_to(GENERATED).parts[0] not in LARGE) < 6_000_000


def test_large_robots_are_ignored():
    ignored = (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()
    assert {f"/generated/{name}/" for name in LARGE} <= set(ignored)


def files():
    return [path for path in GENERATED.rglob("*") if path.is_file() and not {"_build", "__pycache__"} & set(path.parts)]
