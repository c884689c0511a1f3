"""Many rows side by side: the bits of one row after another, at any number of rows, for angles and targets of every kind; and vectors."""

import ctypes
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from test_csupport_trig_together import has, needs_avx2

from walkgen import pipeline
from walkgen.emit.c_declaration import function_name
from walkgen.emit.c_files import c_sources
from walkgen.emit.c_lanes import laned
from walkgen.emit.c_printer import DOUBLE, FLOAT
from walkgen.emit.python_loops import python_sources
from walkgen.toolchain import FLAGS

SPECS = Path(__file__).parents[2] / "specs"
WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")
QUICK = tuple(flag for flag in FLAGS if flag not in {"-O0", "-O2"})
"""walkgen's own flags but the level."""
AVX2 = ("-O2", "-mavx2", "-mfma")
AVX512 = ("-O2", "-mavx512f", "-mavx512dq", "-mavx512vl", "-mfma", "-mprefer-vector-width=512")
needs_avx512 = pytest.mark.skipif(not all(map(has, ("avx512f", "avx512dq", "avx512vl"))), reason="this processor has no AVX-512")
BUILDS = {
    "any processor": ("-O2",),
    "AVX2 in plain C": ("-O2", "-mavx2", "-mfma", "-DWALKGEN_PLAIN"),
    "AVX2, not fused": ("-O2", "-mavx2", "-mfma", "-DWALKGEN_NO_FMA"),
    "size": ("-Os",),
    "C library": ("-O1", "-DWALKGEN_LIBM"),
}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A robot's code, and the folder of its C files."""
    done = {}

    def make(name):
        if name not in done:
            code = pipeline.generate(SPECS / f"{name}.toml", pipeline.BuildOptions(float32=True))
            folder = tmp_path_factory.mktemp(name)
            for artifact in (*c_sources(code), *python_sources(code)):
                (folder / artifact.path).write_text(artifact.text, encoding="utf-8")
            done[name] = code, folder
        return done[name]

    return make


def compiled(folder, source, product, *flags, compiler=("gcc", "-std=c99")):
    """What the compiler says of vectors; its complaint is the assertion's text."""
    command = [*compiler, *QUICK[1:], *flags, source, "-o", product, "-lm"]
    answer = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    return answer.stderr


def inputs(signature, real, rows, seed):
    """Rows of every input: angles of one turn; every ninth row far away, out of reach, at the origin, infinite or no number; whole numbers
    that name something, or nothing.
    """
    rng = np.random.default_rng(seed)
    whole = [rng.choice([0, 1, 2, 3, 1, 2, 4, -1, 2**31 - 1, -(2**31)], (rows, port.size)).astype(np.int32) for port in signature.inputs]
    found = [rng.uniform(-0.6, 0.6, (rows, port.size)).astype(real) for port in signature.inputs]
    strange = np.array([2e5, 3.0, 0.0, np.inf, np.nan, -1e-300, 1e22], real)
    for row in range(0, rows, 9):
        array = found[row % len(found)]
        array[row, rng.integers(array.shape[1])] = strange[row // 9 % len(strange)]
        if row % 2:
            array[row] = 0
    return [array if port.kind == "real" else numbers for port, array, numbers in zip(signature.inputs, found, whole, strict=True)]


def results(signature, real, rows):
    return [np.zeros((rows, port.size), real if port.kind == "real" else np.int32) for port in signature.outputs]


def pointers(arrays):
    return [array.ctypes.data_as(ctypes.c_void_p) for array in arrays]


def one_row(signature, given):
    """Whole numbers go by value."""
    places = zip(signature.inputs, given, pointers(given), strict=True)
    return [place if port.kind == "real" else ctypes.c_int32(int(array[0, 0])) for port, array, place in places]


def one_by_one(library, name, signature, given, found):
    """The function of one row; what it returns."""
    returned = signature.returned
    for row in range(len(given[0])):
        written = [array[row:] for port, array in zip(signature.outputs, found, strict=True) if port is not returned]
        answer = library[name](*one_row(signature, [array[row:] for array in given]), *pointers(written))
        if returned:
            found[signature.outputs.index(returned)][row] = answer


def batched(library, name, signature, given, found):
    """The rows in one call; the number that it returns."""
    function = library[f"{name}_batch"]
    function.restype = ctypes.c_size_t if signature.status else None
    return function(ctypes.c_size_t(len(given[0])), *pointers(given), *pointers(found))


def bits(array):
    """Of everything but NaN, whose sign means nothing."""
    return np.where(np.isnan(array), array.dtype.type(0), array).tobytes(), np.isnan(array).tobytes()


def check_batches(library, code, precision):
    real = np.float64 if precision is DOUBLE else np.float32
    for each in laned(code):
        name, signature = function_name(each.signature, precision), each.signature
        for rows in (1, 4, 5, 32, 33, 200):
            given = inputs(signature, real, rows, rows)
            alone, together = results(signature, real, rows), results(signature, real, rows)
            one_by_one(library, name, signature, given, alone)
            bad = batched(library, name, signature, given, together)
            for port, one, other in zip(signature.outputs, alone, together, strict=True):
                assert bits(one) == bits(other), (name, port.name, rows)
            if signature.status:
                status = alone[signature.outputs.index(signature.status)]
                assert bad == (~(status == 0).any(axis=1)).sum(), (name, rows)


PRECISIONS = pytest.mark.parametrize("precision", [DOUBLE, FLOAT], ids=lambda precision: precision.real)


@needs_avx2
@PRECISIONS
def test_a_batch_has_the_bits_of_single_rows(made, precision):
    check_build(made, precision, "AVX2", *AVX2)


@pytest.mark.nightly
@needs_avx2
@PRECISIONS
@pytest.mark.parametrize("build", BUILDS)
def test_a_batch_has_them_in_every_build(made, precision, build):
    check_build(made, precision, build, *BUILDS[build])


def check_build(made, precision, build, *flags):
    code, library = leg_library(made, precision, build, *flags)
    check_batches(library, code, precision)


def leg_library(made, precision, build, *flags):
    code, folder = made("mero_leg")
    source = f"{'_'.join(part for part in ('mero_leg', precision.tag) if part)}.c"
    product = f"{build.replace(' ', '_')}_{source}.so"
    compiled(folder, source, product, *flags, "-shared", "-fPIC", *WARNINGS)
    return code, ctypes.CDLL(str(folder / product))


def answers(library, code, precision, rows=200):
    """Of every function with lanes, by name and port: the bits of a batch."""
    real = np.float64 if precision is DOUBLE else np.float32
    for each in laned(code):
        name, signature = function_name(each.signature, precision), each.signature
        found = results(signature, real, rows)
        batched(library, name, signature, inputs(signature, real, rows, rows), found)
        yield from (((name, port.name), bits(array)) for port, array in zip(signature.outputs, found, strict=True))


@needs_avx512
@PRECISIONS
def test_avx512_has_the_bits_of_single_rows(made, precision):
    check_build(made, precision, "AVX-512", *AVX512)


@pytest.mark.nightly
@needs_avx512
@PRECISIONS
def test_avx512_avx2_and_plain_c_have_equal_bits(made, precision):
    builds = {
        "AVX-512": AVX512,
        "AVX2": AVX2,
        "AVX2 in plain C": BUILDS["AVX2 in plain C"],
        "blocks left out": (*AVX2, "-DWALKGEN_NO_BLOCKS"),
    }
    first, *others = (
        dict(answers(leg_library(made, precision, name, *flags)[1], made("mero_leg")[0], precision)) for name, flags in builds.items()
    )
    assert len(first) > 15
    assert all(other == first for other in others)


@pytest.mark.nightly
@needs_avx2
@pytest.mark.parametrize("name", ["ambler_rrp", "ambler_rpp", "phantomx_leg"])
def test_batches_of_other_legs(made, name):
    code, folder = made(name)
    compiled(folder, f"{name}.c", "lanes.so", *AVX2, "-shared", "-fPIC", *WARNINGS)
    check_batches(ctypes.CDLL(str(folder / "lanes.so")), code, DOUBLE)


def blocks(folder, name):
    """Lines of the loops over lanes."""
    lines = (folder / f"{name}.c").read_text().splitlines()
    return {number for number, line in enumerate(lines, 1) if line.strip() == "WG_EACH_LANE {"}


def vectors(folder, name, *flags):
    """Lines of the C file whose loops gcc made vectors of 32 bytes or more."""
    said = compiled(folder, f"{name}_python_wide.c", "wide.o", "-O2", "-fPIC", "-c", "-fopt-info-vec-optimized", *flags)
    found = re.findall(rf"{name}\.c:(\d+):.*loop vectorized using (?:32|64) byte vectors", said)
    return {int(number) for number in found} & blocks(folder, name)


@needs_avx2
def test_every_block_becomes_vectors(made):
    _, folder = made("mero_leg")
    assert len(blocks(folder, "mero_leg")) > 15
    assert vectors(folder, "mero_leg", "-DWALKGEN_PART=2") == blocks(folder, "mero_leg")


def test_equal_legs_share_their_blocks():
    code = pipeline.generate(SPECS / "mero.toml", pipeline.BuildOptions(functions=("foot_position", "foot_jacobian", "inverse")))
    found = laned(code)
    assert len({each.signature.owner for each in found}) == 6
    assert sum(each.owns_table for each in found) < len(found) / 2
