"""Functions that leave for a copy of their own beyond the range of sines and arctangents: the same bits, and no registers saved before."""

import ctypes
import itertools
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_csupport_trig_together import needs_avx2

from walkgen import pipeline
from walkgen.emit.c_files import c_sources
from walkgen.toolchain import FLAGS

SPEC = Path(__file__).parents[2] / "specs" / "mero_leg.toml"
NAMES = ("inverse_branch", "inverse_velocity_acceleration", "inverse", "foot_jacobian", "foot_bias_acceleration")
LEAVING = [f"mero_leg_leg_{name}" for name in NAMES[:3]]
BRANCHES = {LEAVING[2]: 4}
STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")
PLAIN = "-DWALKGEN_PLAIN"
TARGETS = {"vectors": (*FLAGS, "-O2", "-mavx2", "-mfma"), "pairs": FLAGS, "size": ("-Os",)}
PRECISIONS = pytest.mark.parametrize("tag", ["", "_f32"])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The leg's C, these functions alone."""
    code = pipeline.generate(SPEC, pipeline.BuildOptions(float32=True))
    few = replace(code, functions=tuple(body for body in code.functions if body.signature.name in NAMES))
    made = tmp_path_factory.mktemp("leaving")
    for artifact in c_sources(few):
        (made / artifact.path).write_text(artifact.text, encoding="utf-8")
    return made


def compiled(folder, tag, product, *flags):
    command = ["gcc", "-std=c99", "-ffp-contract=off", *STRICT, *flags, f"mero_leg{tag}.c", "-o", product, "-lm"]
    answer = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    return folder / product


def functions(assembly):
    """Its functions by name, each the lines up to its end."""
    return {found[1]: found[2] for found in re.finditer(r"^(\w+):\n(.*?)\.cfi_endproc", assembly, re.MULTILINE | re.DOTALL)}


@needs_avx2
@PRECISIONS
@pytest.mark.parametrize("target", ["vectors", "pairs"])
def test_they_call_nothing_and_save_no_registers(folder, tag, target):
    """But for the frame's, where vectors are more than the processor has registers for."""
    text = functions(compiled(folder, tag, f"{target}{tag}.s", *TARGETS[target], "-S").read_text())
    for name in LEAVING:
        lines = text[name.replace("mero_leg_", f"mero_leg{tag}_", 1)]
        assert "ret" in lines
        assert not re.search(r"^\s(push(?!q\s+%rbp)|call)", lines, re.MULTILINE), name


def answers(library, tag, name, given, branches):
    """The bits of the outputs and the statuses, rows one after another."""
    real = np.float32 if tag else np.float64
    call = library[name.replace("mero_leg_", f"mero_leg{tag}_", 1) + "_batch"]
    rows = len(given)
    arrays = [np.ascontiguousarray(given[:, at : at + 3], real) for at in range(0, given.shape[1], 3)]
    arrays += [branches] if "branch" in name else []
    found = [np.full((rows, 3 * BRANCHES.get(name, 1)), 7, real) for _ in range(1 if "inverse_velocity" not in name else 2)]
    status = np.full(rows * BRANCHES.get(name, 1), -1, np.int32)
    call(ctypes.c_size_t(rows), *(ctypes.c_void_p(each.ctypes.data) for each in (*arrays, *found, status)))
    bits = np.uint32 if tag else np.uint64
    return status, *(np.where(np.isnan(each), bits(0), each.view(bits)) for each in found)


def far_motions(random):
    """Poses where one or more angles are huge, infinite or no number, and ordinary and singular ones."""
    sizes = [0.0, 0.7, -1.2, 9.9e3, 1.01e4, -9.99e4, 1.0001e5, 3e9, 1e300, np.inf, np.nan]
    q = np.array([*itertools.product(sizes, repeat=3)])
    return np.hstack([q, random.normal(size=(len(q), 6))])


def far_points(random):
    """Targets from below the least number to beyond the greatest, above the hip, in and out of reach."""
    sizes = [0.0, -0.0, 1e-310, 1e-292, -1e-31, 0.12, -0.3, 0.4, 1e20, -1e31, 1e305, np.inf, np.nan]
    near = random.normal(size=(400, 3)) * 0.3
    return np.concatenate([np.array([*itertools.product(sizes, repeat=3)]), near])


@needs_avx2
@PRECISIONS
@pytest.mark.parametrize("target", TARGETS)
def test_the_bits_are_those_of_plain_c(folder, tag, target):
    random = np.random.default_rng(5)
    with np.errstate(over="ignore"):
        points = far_points(random)
        given = dict(zip(LEAVING, (points, far_motions(random), points), strict=True))
        flags = (*TARGETS[target], "-shared", "-fPIC")
        fast, plain = (ctypes.CDLL(str(compiled(folder, tag, f"{target}{tag}{len(more)}.so", *flags, *more))) for more in ((), (PLAIN,)))
        for name, rows in given.items():
            branches = np.arange(len(rows), dtype=np.int32) % 4
            found, expected = (answers(library, tag, name, rows, branches) for library in (fast, plain))
            assert set(expected[0]) >= ({0, 2, 3} if "velocity" in name else {0, 1, 2})
            for ours, theirs in zip(found, expected, strict=True):
                assert np.array_equal(ours, theirs), name


@needs_avx2
@PRECISIONS
def test_the_rest_has_the_bits_of_what_it_is_the_rest_of(folder, tag):
    """Where size counts it serves all inputs; the signs of zeros among them."""
    vectors = TARGETS["vectors"]
    fast, small = (
        ctypes.CDLL(str(compiled(folder, tag, f"rest{tag}{level}.so", *vectors, level, "-shared", "-fPIC"))) for level in ("-O2", "-Os")
    )
    points = far_points(np.random.default_rng(6))
    branches = np.arange(len(points), dtype=np.int32) % 4
    for name in (LEAVING[0], LEAVING[2]):
        with np.errstate(over="ignore"):
            found, expected = (answers(library, tag, name, points, branches) for library in (fast, small))
        assert set(found[0]) >= {0, 1, 2}
        for ours, theirs in zip(found, expected, strict=True):
            assert np.array_equal(ours, theirs), name


@needs_avx2
def test_huge_angles_have_the_rates_of_their_turns(folder):
    """Not left unanswered: 2 pi times a power of 2 more, as near as such an angle comes, is the same pose."""
    library = ctypes.CDLL(str(compiled(folder, "", "huge.so", *TARGETS["vectors"], "-shared", "-fPIC")))
    random = np.random.default_rng(8)
    q = random.uniform([-1, 0.2, -1.6], [1, 0.8, -0.8], (50, 3))
    v = random.normal(size=(50, 6))
    huge = q + 2 * np.pi * np.array([2.0**20, 0.0, 0.0])
    branches = np.zeros(50, np.int32)
    (near, *rates), (far, *turned) = (answers(library, "", LEAVING[1], np.hstack([each, v]), branches) for each in (q, huge))
    assert not near.any()
    assert not far.any()
    for ours, theirs in zip(turned, rates, strict=True):
        assert np.allclose(ours.view(float), theirs.view(float), rtol=1e-6, atol=1e-6)


@PRECISIONS
@pytest.mark.parametrize("angles", ["one", "branches"])
def test_inverses_leave_before_their_arctangents_unless_the_target_is_usual(folder, tag, angles):
    """So what decides is known before they are called, and nothing is kept over them for it; nor is computed what only others need."""
    text = (folder / f"mero_leg{tag}.c").read_text()
    kernel, whole = (re.search(rf"inverse_{angles}_{part}\)?\(.*?\n}}", text, re.DOTALL)[0] for part in ("usual", "kernel"))
    assert kernel.index("WG_LEAVE_BEYOND(usual)") < kernel.index("WG_NEAR_ATAN2_")
    assert re.search(r"= \(WG_STATE\)\(WG_SELECT\(usual, 0\.0f?, 1\.0f?\)\)|state = WG_SELECT\(usual, 0\.0f?, 1\.0f?\)", kernel)
    assert kernel.count("WG_SELECT") < whole.count("WG_SELECT") / 2
    assert "isfinite" in whole
    assert "isfinite" not in kernel
    rates = re.search(r"regular_rates_usual\)?\(.*?\n}", text, re.DOTALL)[0]
    assert "WG_LEAVE_BEYOND" not in rates
