"""The committed demo: every shipped spec's text is what a build writes today, and all of it stays small."""

from pathlib import Path

import pytest

from walkgen.pipeline import stale

ROOT = Path(__file__).parent.parent
SPECS = sorted((ROOT / "specs").glob("*.toml"))
GENERATED = ROOT / "generated"


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_generated_text_is_what_a_build_writes(spec):
    names = [Path(name).relative_to(ROOT) for name in stale(spec, GENERATED)]
    assert not names, f"{', '.join(map(str, names))} stale; run: walkgen build {spec.relative_to(ROOT)}"


def test_every_folder_has_a_spec():
    folders = {folder.name for folder in GENERATED.iterdir() if folder.is_dir() and not folder.name.startswith(("_", "."))}
    assert folders == {spec.stem for spec in SPECS}


def test_the_demo_is_under_six_megabytes():
    files = [path for path in GENERATED.rglob("*") if path.is_file() and not {"_build", "__pycache__"} & set(path.parts)]
    assert sum(path.stat().st_size for path in files) < 6_000_000
