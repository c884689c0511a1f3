"""Batches of functions without lanes: one loop for all of a kind gives row by row what the function does, and how many have no OK."""

import ctypes
import subprocess
from pathlib import Path

import numpy as np
import pytest

from walkgen import pipeline
from walkgen.emit.c_declaration import function_name
from walkgen.emit.c_each import each_lines
from walkgen.emit.c_files import c_sources
from walkgen.emit.c_printer import DOUBLE, FLOAT

MERO = Path(__file__).parents[2] / "specs" / "mero.toml"
NAMES = ("foot_position", "foot_jacobian", "foot_position_jacobian", "foot_hessian", "foot_bias_acceleration", "foot_acceleration")
RATES = ("inverse_velocity", "inverse_velocity_acceleration")
FLAGS = ("-std=c99", "-O1", "-ffp-contract=off", "-shared", "-fPIC", "-Wall", "-Wextra", "-Werror", "-DWALKGEN_NO_BLOCKS")
OWNER = "root_to_rear_right"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The robot's functions of one route, and its library in both precisions."""
    folder = tmp_path_factory.mktemp("each")
    code = pipeline.generate(MERO, pipeline.BuildOptions(functions=(*NAMES, *RATES), float32=True))
    for artifact in c_sources(code):
        (folder / artifact.path).write_text(artifact.text, encoding="utf-8")
    subprocess.run(["gcc", *FLAGS, "mero.c", "mero_f32.c", "-o", "mero.so", "-lm"], cwd=folder, check=True)
    return {body.signature.name: body for body in code.functions if body.signature.owner == OWNER}, ctypes.CDLL(str(folder / "mero.so"))


def pointers(arrays):
    return [array.ctypes.data_as(ctypes.c_void_p) for array in arrays]


@pytest.mark.parametrize("precision", [DOUBLE, FLOAT], ids=["double", "float"])
@pytest.mark.parametrize("name", [*NAMES, *RATES])
def test_batches_give_each_row_its_own(made, name, precision):
    (body, library), real = (made[0][name], made[1]), np.float64 if precision is DOUBLE else np.float32
    signature, rows, rng = body.signature, 7, np.random.default_rng(2)
    inputs = [rng.uniform(-1, 1, (rows, port.size)).astype(real) for port in signature.inputs]
    inputs[0][3] = np.nan
    batch, single = ([np.zeros((rows, p.size), real if p.kind == "real" else np.int32) for p in signature.outputs] for _ in range(2))
    assert "wg_each_" in each_lines(body, precision)[0]

    called = getattr(library, f"{function_name(signature, precision)}_batch")
    called.restype = ctypes.c_size_t
    bad = called(ctypes.c_size_t(rows), *pointers(inputs), *pointers(batch))
    one = getattr(library, function_name(signature, precision))
    one.restype = ctypes.c_int32
    for row in range(rows):
        found = [array[row] for array, port in zip(single, signature.outputs, strict=True) if port is not signature.returned]
        status = one(*pointers(array[row] for array in inputs), *pointers(found))
        if signature.returned:
            single[-1][row] = status
    for together, alone in zip(batch, single, strict=True):
        np.testing.assert_array_equal(together, alone)
    assert np.isfinite(batch[0][0]).all()
    assert np.isnan(batch[0][3]).any()
    if signature.status:
        assert bad == np.count_nonzero(batch[-1]) == 1
