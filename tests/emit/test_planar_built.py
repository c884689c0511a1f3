"""Component-major arrays: `_planar` has the bits of `_batch`, at any stride, in lanes and row by row; it is there where it is asked for."""

import ctypes
import subprocess
from pathlib import Path

import numpy as np
import pytest
from test_lanes_built import AVX2, PRECISIONS, QUICK, WARNINGS, bits, inputs, one_by_one, pointers, results

from walkgen import pipeline
from walkgen.emit.c_declaration import function_name
from walkgen.emit.c_files import c_sources
from walkgen.emit.c_printer import DOUBLE

SPECS = Path(__file__).parents[2] / "specs"
BUILDS = {"lanes": AVX2, "any processor": ("-O2",), "row by row": ("-O1", "-DWALKGEN_NO_BLOCKS")}
ROWS, STRIDE = (1, 5, 32, 77), 112


@pytest.fixture(scope="module", params=["mero_leg", "mero_leg_param"])
def made(request, tmp_path_factory):
    """A robot's code and the folder of its C files."""
    code = pipeline.generate(SPECS / f"{request.param}.toml", pipeline.BuildOptions(float32=True, planar=True))
    folder = tmp_path_factory.mktemp(request.param)
    for artifact in c_sources(code):
        (folder / artifact.path).write_text(artifact.text, encoding="utf-8")
    return code, folder


def library(folder, stem, build):
    product = folder / f"{stem}_{build.replace(' ', '_')}.so"
    command = ["gcc", "-std=c99", *QUICK[1:], *BUILDS[build], "-shared", "-fPIC", *WARNINGS, f"{stem}.c", "-o", str(product), "-lm"]
    if not product.exists():
        answer = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert answer.returncode == 0, answer.stderr
    return ctypes.CDLL(str(product))


def component_major(array, shared):
    """Elements by rows, -7 between them; what all rows share stays as it is."""
    if shared:
        return array
    planar = np.full((array.shape[1], STRIDE), -7, array.dtype)
    planar[:, : len(array)] = array.T
    return planar


def given_rows(signature, real, rows):
    """Inputs; one row of parameters."""
    found = inputs(signature, real, rows, rows)
    return [array[:1] if port.name == "param" else array for port, array in zip(signature.inputs, found, strict=True)]


def check(loaded, code, precision):
    real = np.float64 if precision is DOUBLE else np.float32
    for signature in (body.signature for body in code.functions):
        name = function_name(signature, precision)
        if signature.counts or signature.workspace:
            assert not hasattr(loaded, f"{name}_planar")
            continue
        for rows in ROWS:
            given, rowwise = given_rows(signature, real, rows), results(signature, real, rows)
            answer = batch_of(loaded, name, signature, rows, given, rowwise)
            arrays = [component_major(array, port.name == "param") for port, array in zip(signature.inputs, given, strict=True)]
            planar = [component_major(np.zeros_like(array), shared=False) for array in rowwise]
            function = loaded[f"{name}_planar"]
            function.restype = ctypes.c_size_t if signature.status else None
            assert function(ctypes.c_size_t(rows), ctypes.c_size_t(STRIDE), *pointers(arrays), *pointers(planar)) == answer
            for array, other in zip(rowwise, planar, strict=True):
                assert bits(np.ascontiguousarray(array.T)) == bits(np.ascontiguousarray(other[:, :rows])), name
                assert (other[:, rows:] == -7).all(), name


def batch_of(loaded, name, signature, rows, given, found):
    """What the batch returns."""
    function = loaded[f"{name}_batch"]
    function.restype = ctypes.c_size_t if signature.status else None
    return function(ctypes.c_size_t(rows), *pointers(given), *pointers(found))


@pytest.mark.parametrize("build", ["lanes", "row by row"])
def test_planar_arrays_have_the_bits_of_rows(made, build):
    code, folder = made
    check(library(folder, code.mechanism.name, build), code, DOUBLE)


@pytest.mark.nightly
@PRECISIONS
@pytest.mark.parametrize("build", BUILDS)
def test_planar_arrays_in_every_build(made, precision, build):
    code, folder = made
    stem = "_".join(part for part in (code.mechanism.name, precision.tag) if part)
    check(library(folder, stem, build), code, precision)


def test_planar_functions_are_there_where_they_are_asked_for(made):
    code, folder = made
    text = (folder / f"{code.mechanism.name}.h").read_text()
    assert text.count("_planar(size_t rows, size_t stride,") == text.count("_batch(size_t rows")
    plain = pipeline.generate(SPECS / f"{code.mechanism.name}.toml")
    assert not any("planar" in artifact.text for artifact in c_sources(plain))


@pytest.mark.parametrize("padding", [5, 8])
def test_planes_are_lanes_wherever_they_begin(made, padding):
    """Many blocks, each plane at the start of a line of the cache or in its midst."""
    code, folder = made
    loaded, rows = library(folder, code.mechanism.name, "lanes"), 10_003
    signature = signature_of(code, "foot_jacobian")
    name = function_name(signature, DOUBLE)
    (q, *param), found = given_rows(signature, np.float64, rows), np.zeros((rows, 9))
    loaded[f"{name}_batch"](ctypes.c_size_t(rows), *pointers([q, *param, found]))
    given, planes = np.ascontiguousarray(np.pad(q.T, ((0, 0), (0, padding)))), np.full((9, rows + padding), -7.0)
    loaded[f"{name}_planar"](ctypes.c_size_t(rows), ctypes.c_size_t(rows + padding), *pointers([given, *param, planes]))
    assert np.array_equal(planes[:, :rows].T, found, equal_nan=True)
    assert (planes[:, rows:] == -7).all()


@pytest.mark.parametrize("away", [1, 33, 47, 99])
def test_statuses_are_written_where_all_feet_are_reached(made, away):
    """Of blocks without another status than OK, and of the one that a foot out of reach is in."""
    code, folder = made
    loaded, rows = library(folder, code.mechanism.name, "lanes"), 100
    forward, inverse = (signature_of(code, name) for name in ("foot_position", "inverse"))
    q, *param = given_rows(forward, np.float64, rows)
    q[:] = np.random.default_rng(5).uniform([-1, -0.6, -1.4], [1, 0.6, -0.4], (rows, 3))
    p = np.full((rows, 3), -7.0)
    batch_of(loaded, function_name(forward, DOUBLE), forward, rows, [q, *param], [p])
    p[away] = 9
    name, given = function_name(inverse, DOUBLE), [p, *param]
    one, many, planar = ([np.full_like(array, -7) for array in results(inverse, np.float64, rows)] for _ in range(3))
    planar = [component_major(array, shared=False) for array in planar]
    one_by_one(loaded, name, inverse, [np.resize(array, (rows, array.shape[1])) for array in given], one)
    assert batch_of(loaded, name, inverse, rows, given, many) == 1
    arrays = [component_major(array, port.name == "param") for port, array in zip(inverse.inputs, given, strict=True)]
    assert loaded[f"{name}_planar"](ctypes.c_size_t(rows), ctypes.c_size_t(STRIDE), *pointers(arrays), *pointers(planar)) == 1
    assert np.array_equal(one[-1].any(axis=1), np.arange(rows) == away)
    for first, second, third in zip(one, many, planar, strict=True):
        assert bits(first) == bits(second) == bits(np.ascontiguousarray(third[:, :rows].T))


def signature_of(code, name):
    return next(body.signature for body in code.functions if body.signature.name == name)
