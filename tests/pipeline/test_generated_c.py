"""The C of every shipped spec under strict compilers and sanitizers, and two robots in one program."""

import subprocess
from pathlib import Path

import pytest

from walkgen import pipeline
from walkgen.emit.emit import emit

SPECS = {path.stem: path for path in sorted((Path(__file__).parents[2] / "specs").glob("*.toml"))}
# kin of those that every run compiles
LARGE = (
    "anthropomorphic_biped",
    "anthropomorphic_leg_poly",
    "bessonov",
    "garrec",
    "mero",
    "mero_star",
    "mero_style",
    "minitaur",
    "odex",
    "pantograph",
    "quadruped",
    "solo12",
)
EVERY = [pytest.param(name, marks=pytest.mark.nightly) if name in LARGE else name for name in SPECS]
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Wshadow", "-Werror")
LANGUAGES = {"c99": ("gcc", "-std=c99"), "c++11": ("g++", "-x", "c++", "-std=c++11")}
SANITIZE = ("-O0", "-ffp-contract=off", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")


def run(command, folder):
    answer = subprocess.run(command, cwd=folder, check=False, capture_output=True, encoding="utf-8")
    assert answer.returncode == 0, answer.stdout[-2000:] + answer.stderr[-4000:]
    return answer.stdout


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """A robot's files with both precisions, by the name of its spec; written once."""
    root = tmp_path_factory.mktemp("sources")

    def folder(name):
        if not (root / name).is_dir():
            (root / name).mkdir()
            for artifact in emit(pipeline.generate(SPECS[name], pipeline.BuildOptions(float32=True))):
                (root / name / artifact.path).write_bytes(artifact.text.encode())
        return root / name

    return folder


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", EVERY)
def test_compiles_without_a_warning(sources, name):
    compiled(sources, name, "c99")


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", EVERY)
def test_compiles_as_cpp_without_a_warning(sources, name):
    compiled(sources, name, "c++11")


def compiled(sources, name, language):
    files = [f"{name}.c", f"{name}_f32.c", f"{name}_test.c"]
    run((*LANGUAGES[language], *WARNINGS, "-O0", "-c", *files), sources(name))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", EVERY)
def test_selftest_passes_under_sanitizers(sources, name):
    folder = sources(name)
    run(("gcc", "-std=c99", *WARNINGS, *SANITIZE, f"{name}.c", f"{name}_test.c", "-o", "selftest", "-lm"), folder)
    said = run(("./selftest",), folder)
    assert said.splitlines()[-1].endswith(" 0 failed")


def test_two_robots_link_into_one_program(sources, tmp_path):
    """Both in both precisions; every external symbol begins with its robot's prefix."""
    names = ("mero_leg", "phantomx_leg")
    objects = []
    for name in names:
        for stem in (name, f"{name}_f32"):
            run(("gcc", "-std=c99", "-O0", "-c", f"{stem}.c", "-o", tmp_path / f"{stem}.o"), sources(name))
            symbols = run(("nm", "-g", "--defined-only", "--format=posix", tmp_path / f"{stem}.o"), tmp_path).splitlines()
            assert len(symbols) > 30
            assert {symbol for symbol in (line.split()[0] for line in symbols) if not symbol.startswith(f"{stem}_")} == set()
            objects.append(str(tmp_path / f"{stem}.o"))
    includes = "\n".join(f'#include "{stem}.h"' for name in names for stem in (name, f"{name}_f32"))
    call = "{name}_{leg}_foot_position(q, p); sum += p[0]; {name}_f32_{leg}_foot_position(qf, pf); sum += (double)pf[0];"
    body = " ".join(call.format(name=name, leg=leg) for name, leg in zip(names, ("leg", leg_of("phantomx_leg")), strict=True))
    (tmp_path / "main.c").write_text(
        f"{includes}\nint main(void) {{ double q[3] = {{0, 0, 0}}, p[3], sum = 0; float qf[3] = {{0, 0, 0}}, pf[3]; {body} "
        "return sum > 0 ? 0 : 1; }\n",
        encoding="utf-8",
    )
    paths = [f"-I{sources(name)}" for name in names]
    run(("gcc", "-std=c99", *WARNINGS, *paths, "main.c", *objects, "-o", "both", "-lm"), tmp_path)
    run(("./both",), tmp_path)


def leg_of(name):
    return pipeline.mechanism_of(SPECS[name]).legs[0].name
