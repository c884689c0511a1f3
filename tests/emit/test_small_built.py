"""Where size counts: the bits of fast code from less of it, functions through one another, less answers; the C library's functions."""

import ctypes
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from walkgen import pipeline
from walkgen.emit.c_files import c_sources

SPECS = Path(__file__).parents[2] / "specs"
NAMES = (
    *("foot_position", "foot_position_jacobian", "foot_hessian", "foot_bias_acceleration", "inverse_branch", "inverse"),
    *("inverse_dynamics", "mass_matrix", "inverse_velocity_acceleration", "inverse_velocity", "inverse_distance"),
)
STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Wdouble-promotion", "-Werror", "-std=c99", "-ffp-contract=off")
LEFT_OUT = ("-DWALKGEN_NO_CLOSEST", "-DWALKGEN_NO_DAMPING")
OK, UNREACHABLE, BAD_INPUT, SINGULAR = range(4)
PRECISIONS = pytest.mark.parametrize("tag", ["", "_f32"])
ROWS = 300
LEGS = {"mero_leg": "leg", "phantomx_leg": "right_front"}
"""Robots, each with its leg's name."""


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    """The C of some functions of a leg, compiled with some flags, once."""
    known: dict[tuple[str, ...], ctypes.CDLL] = {}
    folders: dict[str, Path] = {}

    def built(robot, *flags):
        if robot not in folders:
            code = pipeline.generate(SPECS / f"{robot}.toml", pipeline.BuildOptions(float32=True))
            folders[robot] = tmp_path_factory.mktemp(robot)
            for artifact in c_sources(replace(code, functions=tuple(body for body in code.functions if body.signature.name in NAMES))):
                (folders[robot] / artifact.path).write_text(artifact.text, encoding="utf-8")
        if (robot, *flags) not in known:
            product = folders[robot] / f"{len(known)}.so"
            command = ["gcc", *STRICT, *flags, "-shared", "-fPIC", f"{robot}.c", f"{robot}_f32.c", "-o", str(product), "-lm"]
            answer = subprocess.run(command, cwd=folders[robot], capture_output=True, text=True, check=False)
            assert answer.returncode == 0, answer.stderr
            known[robot, *flags] = ctypes.CDLL(str(product))
        return known[robot, *flags]

    return built


def answers(library, function, given, outputs, statuses=0):
    """Outputs of every row by `_batch`, then the statuses."""
    real = given[0].dtype
    found = [np.full((len(given[0]), size), 7, real) for size in outputs]
    found += [np.full((len(given[0]), statuses), -1, np.int32)] if statuses else []
    call = library[function + "_batch"]
    call(ctypes.c_size_t(len(given[0])), *(ctypes.c_void_p(each.ctypes.data) for each in (*given, *found)))
    return found


def assert_same_bits(found, expected):
    for ours, theirs in zip(found, expected, strict=True):
        assert np.array_equal(ours, theirs, equal_nan=True)
        numbers = ~np.isnan(ours)
        assert np.array_equal(np.signbit(ours[numbers]), np.signbit(theirs[numbers]))


def inputs(tag, *sizes, seed=4):
    random = np.random.default_rng(seed)
    return [np.ascontiguousarray(random.uniform(-3, 3, (ROWS, size)), np.float32 if tag else np.float64) for size in sizes]


@PRECISIONS
@pytest.mark.parametrize("robot", LEGS)
def test_the_bits_are_those_of_fast_code(build, robot, tag):
    fast, small = build(robot, "-O2", "-DWALKGEN_PLAIN"), build(robot, "-Os")
    start = f"{robot}{tag}_{LEGS[robot]}"
    cases = {
        "foot_position": ((3,), (3,)),
        "foot_position_jacobian": ((3,), (3, 9)),
        "foot_hessian": ((3,), (27,)),
        "foot_bias_acceleration": ((3, 3), (6,)),
        "mass_matrix": ((3,), (9,)),
        "inverse_dynamics": ((3, 3, 3, 3), (3,)),
    }
    met = 0
    for name, (sizes, outputs) in cases.items():
        if hasattr(fast, f"{start}_{name}_batch"):
            given = inputs(tag, *sizes)
            assert_same_bits(*(answers(library, f"{start}_{name}", given, outputs) for library in (small, fast)))
            met += 1
    assert met > 3
    p = targets(tag)
    assert_same_bits(*(answers(library, f"{start}_inverse", [p], (12,), 4) for library in (small, fast)))
    branches = np.arange(len(p), dtype=np.int32) % 6 - 1
    assert_same_bits(*(answers(library, f"{start}_inverse_branch", [p, branches], (3,), 1) for library in (small, fast)))


def targets(tag):
    """In and out of reach, on the axis, and no numbers."""
    (p,) = inputs(tag, 3, seed=6)
    p *= 0.25
    p[:4] = [[0, 0, 0.3], [0, 0, 0.12], [np.nan, 0, 0], [0.75, 0, 0.12]]
    return p


@PRECISIONS
def test_without_closest_points_their_rows_are_nan(build, tag):
    whole, less = build("mero_leg", "-Os"), build("mero_leg", "-Os", *LEFT_OUT)
    p = targets(tag)
    (q, status), (found, told) = (answers(each, f"mero_leg{tag}_leg_inverse", [p], (12,), 4) for each in (whole, less))
    assert {OK, UNREACHABLE, BAD_INPUT, SINGULAR} <= set(status.ravel())
    assert np.array_equal(told, status)
    missed = np.repeat(status == UNREACHABLE, 3, axis=1)
    assert np.isfinite(q[missed]).all()
    assert np.isnan(found[missed]).all()
    assert np.array_equal(found[~missed], q[~missed], equal_nan=True)
    for branch in range(4):
        one, code = answers(less, f"mero_leg{tag}_leg_inverse_branch", [p, np.full(ROWS, branch, np.int32)], (3,), 1)
        assert np.array_equal(code[:, 0], status[:, branch])
        assert np.array_equal(np.isnan(one).all(axis=1), np.isin(code[:, 0], (UNREACHABLE, BAD_INPUT)))


@PRECISIONS
@pytest.mark.parametrize(("name", "given", "found"), [("inverse_velocity", 2, 1), ("inverse_velocity_acceleration", 3, 2)])
def test_without_damping_singular_rates_are_nan(build, tag, name, given, found):
    whole, less = build("mero_leg", "-Os"), build("mero_leg", "-Os", *LEFT_OUT)
    motion = inputs(tag, *[3] * given, seed=8)
    motion[0][:3] = [[0.3, 0.5, 0], [0.1, np.pi / 2, 0], [np.nan, 0.5, -1]]
    function = f"mero_leg{tag}_leg_{name}"
    (*rates, status), (*left, told) = (answers(each, function, motion, (3,) * found, 1) for each in (whole, less))
    assert {OK, BAD_INPUT, SINGULAR} <= set(status.ravel())
    assert set(told.ravel()) == {OK, SINGULAR}
    answered = told[:, 0] == OK
    assert (status[answered] == OK).all()
    assert np.mean(answered) > 0.9 * np.mean(status == OK)
    for ours, theirs in zip(left, rates, strict=True):
        assert np.array_equal(ours[answered], theirs[answered])
        assert np.isnan(ours[~answered]).all()


def one_from(build, robot, tag, *flags):
    """Answers of the robot's only leg, by the function's name without robot and leg."""
    library = build(robot, *flags)
    start = f"{robot}{tag}_{LEGS[robot]}_"
    return lambda name, *given: answers(library, start + name, *given)


@PRECISIONS
@pytest.mark.parametrize("robot", LEGS)
def test_a_part_has_the_bits_of_the_whole(build, robot, tag):
    fast, small = one_from(build, robot, tag, "-Os"), one_from(build, robot, tag, "-Os", "-DWALKGEN_SMALL")
    q, v = inputs(tag, 3, 3)
    assert_same_bits(small("foot_position", [q], (3,)), fast("foot_position", [q], (3,)))
    assert_same_bits(small("inverse_velocity", [q, v], (3,), 1), fast("inverse_velocity", [q, v], (3,), 1))


@PRECISIONS
@pytest.mark.parametrize("robot", LEGS)
def test_branches_come_one_after_the_other(build, robot, tag):
    fast, small = one_from(build, robot, tag, "-Os"), one_from(build, robot, tag, "-Os", "-DWALKGEN_SMALL")
    p = targets(tag)
    q, status = small("inverse", [p], (12,), 4)
    whole, expected = fast("inverse", [p], (12,), 4)
    assert {OK, UNREACHABLE, BAD_INPUT} <= set(status.ravel())
    assert np.array_equal(status, expected)
    for branch in range(4):
        one = small("inverse_branch", [p, np.full(ROWS, branch, np.int32)], (3,), 1)
        assert_same_bits((q[:, 3 * branch : 3 * branch + 3], status[:, branch : branch + 1]), one)
    reached = np.repeat(status == OK, 3, axis=1)
    assert np.abs(np.exp(1j * q[reached]) - np.exp(1j * whole[reached])).max() < (2e-3 if tag else 1e-7)  # knees nearly stretched too
    found, wanted = (each("foot_position", [np.ascontiguousarray(rows[:, :3])], (3,))[0] for each, rows in ((small, q), (fast, whole)))
    assert np.abs(found - wanted)[status[:, 0] == OK].max() < (2e-6 if tag else 2e-15)


@PRECISIONS
@pytest.mark.parametrize("robot", LEGS)
def test_masses_come_from_efforts(build, robot, tag):
    fast, small = one_from(build, robot, tag, "-Os"), one_from(build, robot, tag, "-Os", "-DWALKGEN_SMALL")
    (q,) = inputs(tag, 3)
    (M,), (expected,) = (each("mass_matrix", [q], (9,)) for each in (small, fast))
    epsilon = np.finfo(M.dtype).eps
    assert (np.abs(M - expected).max(axis=1) <= 8 * epsilon * np.abs(expected).max(axis=1)).all()
    assert np.array_equal(M[expected == 0], expected[expected == 0])
    assert np.array_equal(M.reshape(-1, 3, 3), M.reshape(-1, 3, 3).transpose(0, 2, 1))


@pytest.mark.parametrize("robot", ["ambler_rpp", "ambler_rrp", "mero_leg"])
def test_small_c_passes_its_self_test(robot, tmp_path):
    folder = SPECS.parent / "generated" / robot
    assert "WALKGEN_SMALL" in (folder / f"{robot}.c").read_text(encoding="utf-8")
    program = tmp_path / "program"
    command = ["gcc", *STRICT, "-Os", "-DWALKGEN_SMALL", f"{robot}.c", f"{robot}_test.c", "-o", str(program), "-lm"]
    answer = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    told = subprocess.run([program], capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stdout


@PRECISIONS
@pytest.mark.parametrize("robot", LEGS)
def test_the_c_librarys_functions_give_the_same(build, robot, tag):
    own, library = one_from(build, robot, tag, "-O2"), one_from(build, robot, tag, "-O2", "-DWALKGEN_LIBM")
    (q,), p = inputs(tag, 3), targets(tag)
    tolerance = 2e-5 if tag else 1e-13
    for found, expected in zip(*(each("foot_position_jacobian", [q], (3, 9)) for each in (library, own)), strict=True):
        assert np.abs(found - expected).max() < tolerance
    for branch in range(4):
        given = [p, np.full(ROWS, branch, np.int32)]
        (found, status), (expected, told) = (each("inverse_branch", given, (3,), 1) for each in (library, own))
        assert np.array_equal(status, told)
        assert np.nanmax(np.abs(np.exp(1j * found) - np.exp(1j * expected))) < tolerance
        assert np.array_equal(np.isnan(found), np.isnan(expected))


@PRECISIONS
@pytest.mark.parametrize("flags", [("-O2",), ("-O2", "-DWALKGEN_LIBM"), ("-Os", "-DWALKGEN_SMALL"), ("-O2", "-DWALKGEN_PLAIN")])
def test_a_folded_knee_is_half_a_turn(build, tag, flags):
    p = np.array([[0.05, 0, 0.12], [-0.03, 0.04, 0.12], [0, 0.05, 0.12]], np.float32 if tag else np.float64)
    for branch in range(4):
        given = [p, np.full(len(p), branch, np.int32)]
        q, _ = one_from(build, "mero_leg", tag, *flags)("inverse_branch", given, (3,), 1)
        assert np.abs(np.abs(q[:, 2]) - np.pi).max() < (2e-2 if tag else 1e-6)  # the root of a rounding
        assert (q <= np.float32(np.pi) if tag else q <= np.pi).all()
        assert (q > -np.pi).all()
