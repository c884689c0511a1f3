"""Direct calls give what NumPy's ufuncs give, to the bit and to the type, and really go past them."""

import sys
import sysconfig
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tiny_robot import BACKENDS, Tiny, code_of, needs_headers, write

from walkgen.errors import ToolchainError
from walkgen.runtime import Leg, Robot, direct, load
from walkgen.runtime.calls import Truths
from walkgen.runtime.ufuncs import Loops, find_loops
from walkgen.signature import Port, Signature

Robots = Callable[..., Robot]
pytestmark = needs_headers


def both(robots: Robots, variant: str = "plain") -> tuple[Robot, Robot]:
    return robots(variant, "direct"), robots(variant, "ufunc")


def described(answer: Any) -> Any:
    """All that a caller can tell of an answer."""
    if isinstance(answer, tuple):
        return tuple(map(described, answer))
    array = np.asarray(answer)
    writes = isinstance(answer, np.ndarray) and answer.flags.writeable
    return type(answer), array.dtype, array.shape, array.tobytes(), writes


def outcome(function: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
    """The answer, or which error it is."""
    try:
        return described(function(*arguments, **named))
    except (TypeError, ValueError, OverflowError) as error:
        return type(error), str(error)


ONE = np.array([0.4, -0.7, 1.3])
FORMS = [
    *(ONE, ONE.tolist(), tuple(ONE), [1, 2, 3], (1, 2.5, 3), [2**60 + 1, 1, 1], [2**70, 1, 1], [True, False, True], [np.float64(1), 2, 3]),
    *(np.array([1, 2, 3]), ONE.astype(np.float32), ONE.astype(">f8"), ONE.astype(np.longdouble), ONE.view(np.matrix), ["1", "2", "3"]),
    *(np.arange(9.0)[::3], ONE[::-1], np.broadcast_to(0.5, 3), np.frombuffer(b"\0" + ONE.tobytes(), np.uint8)[1:].view(float), ONE * 1j),
    *(ONE[None], np.zeros((0, 3)), np.zeros((2, 3)), np.zeros(4), [1.0, 2.0], [], 1.0, None, [[1.0, 2.0, 3.0]], [1.0, None, 2.0], "abc"),
    *(np.array([1e308, -np.inf, np.nan]), np.array([-0.0, 1e-320, 7e4]), [float("nan"), 0.0, -0.0]),
]


@pytest.mark.parametrize("variant", ["plain", "single", "parameters", "both"])
def test_every_form_of_an_input(robots: Robots, variant: str) -> None:
    own, plain = (robot.legs["left"] for robot in both(robots, variant))
    for name, form in product(("foot_position", "foot_hessian", "foot_position_jacobian", "gravity_torque"), FORMS):
        assert outcome(getattr(own, name), form) == outcome(getattr(plain, name), form), (name, form)


BRANCHES = (0, 2, -7, 2**40, 2**70, 1.0, True, np.int64(3), np.int8(3), np.array(3), np.array([1, 2]), [1, 2], None, np.uint64(2**63))


@pytest.mark.parametrize("variant", ["plain", "single"])
def test_every_form_of_an_integer(robots: Robots, variant: str) -> None:
    own, plain = (robot.legs["left"].inverse_branch for robot in both(robots, variant))
    for point, branch in product(([1.0, 4.0, 9.0], np.array([-1.0, 4.0, 9.0]), np.ones(3, np.float32)), BRANCHES):
        assert outcome(own, point, branch) == outcome(plain, point, branch), (point, branch)


HEIGHTS = (2, 2.5, np.float64(2.5), np.float32(2.5), np.array(2.5), np.array([2.5]), True, 2**70, "high", np.array(1))


@pytest.mark.parametrize("variant", ["plain", "single"])
def test_every_form_of_a_number(robots: Robots, variant: str) -> None:
    own, plain = (robot.legs["left"].potential_energy for robot in both(robots, variant))
    for height in HEIGHTS:
        assert outcome(own, height) == outcome(plain, height), height


@pytest.mark.parametrize("variant", ["plain", "single", "parameters", "both"])
def test_inputs_of_several_ranks_and_precisions(robots: Robots, variant: str) -> None:
    own, plain = (robot.legs["left"].foot_torque for robot in both(robots, variant))
    matrices = [np.arange(6.0).reshape(2, 3), np.asfortranarray(np.ones((2, 3))), np.ones((3, 2)).T, np.ones((2, 3), np.float32)]
    for J in (*matrices, matrices[0].tolist(), np.ones((3, 2)), matrices[0][None]):
        for f in (ONE, ONE.tolist(), ONE.astype(np.float32), np.arange(6.0)[::2]):
            for offset in (1, 2.5, np.float32(3), np.array(4.0), np.array(4, np.float32)):
                assert outcome(own, J, f, offset) == outcome(plain, J, f, offset)


@pytest.mark.parametrize("variant", ["parameters", "both"])
def test_parameters_and_wrong_calls(robots: Robots, variant: str) -> None:
    own, plain = (robot.legs["left"].foot_position for robot in both(robots, variant))
    calls: list[tuple[tuple[Any, ...], dict[str, Any]]] = [
        *(((ONE,), {"param": [3.0, 4.0]}), ((ONE,), {"param": None}), ((ONE, [3.0, 4.0]), {}), ((), {}), ((), {"q": ONE})),
        *(((ONE,), {"q": ONE}), ((ONE,), {"wrong": 1}), ((ONE,), {"out": np.zeros(3)}), ((ONE.astype(np.float32),), {})),
        *(((ONE.astype(np.float32),), {"param": [3.0, 4.0]}), ((ONE,), {"dtype": np.float32})),
    ]
    for arguments, named in calls:
        assert outcome(own, *arguments, **named) == outcome(plain, *arguments, **named)


@given(st.lists(st.floats(width=64) | st.integers(-(2**66), 2**66), min_size=2, max_size=4), st.integers(-(2**66), 2**66))
@settings(max_examples=200, deadline=None)
def test_any_numbers(pair: tuple[Robot, Robot], numbers: list[float], branch: int) -> None:
    own, plain = (robot.legs["left"] for robot in pair)
    assert outcome(own.foot_position, numbers) == outcome(plain.foot_position, numbers)
    assert outcome(own.inverse_branch, numbers, branch) == outcome(plain.inverse_branch, numbers, branch)


@pytest.fixture(scope="module")
def pair(folders: Callable[[str], Path]) -> tuple[Robot, Robot]:
    with pytest.MonkeyPatch.context() as patch:
        found = []
        for backend in ("direct", "ufunc"):
            patch.setenv("WALKGEN_BACKEND", backend)
            found.append(load(folders("plain")))
        return found[0], found[1]


class Library:
    """A robot's functions around which nothing stands but one that must not be reached."""

    def __init__(self, folder: Path, tiny: Tiny) -> None:
        from ctypes import CDLL

        self._library = CDLL(str(next(folder.glob("_build/*/libtiny.*"))))
        self._tiny = tiny

    def function(self, name: str) -> Any:
        signature = next(body.signature for body in code_of(self._tiny).functions if body.signature.name == name)
        loops = find_loops(signature, self._library, self._tiny.float32)
        assert loops is not None
        return direct.direct(_unreachable, signature, loops, _unreachable)


def _unreachable(*arguments: Any, **named: Any) -> Any:
    raise LookupError((arguments, named))


def test_common_calls_go_past_the_ufunc(folders: Callable[[str], Path]) -> None:
    library = Library(folders("plain"), Tiny())
    position, branch = library.function("foot_position"), library.function("inverse_branch")
    for form in (ONE, ONE.tolist(), tuple(ONE), [1, 2, 3], np.arange(9.0)[::3], np.broadcast_to(0.5, 3)):
        assert position(form).shape == (3,)
    q, status = branch([1.0, 4.0, 9.0], 2)
    assert q.tolist() == [3, 4, 5]
    assert (status, type(status)) == (0, np.int32)
    for form in (ONE[None], ONE.astype(np.float32), [1, 2], None):
        with pytest.raises(LookupError):
            position(form)
    with pytest.raises(LookupError):
        position(ONE, out=None)


def test_float_calls_go_past_the_ufunc(folders: Callable[[str], Path]) -> None:
    position = Library(folders("single"), Tiny(float32=True)).function("foot_position")
    assert position(ONE.astype(np.float32)).dtype == np.float32
    assert position(ONE).dtype == np.float64


def test_a_truth_is_a_bool() -> None:
    signature = Signature("tiny", "", "within", (Port("q", (3,)),), (Port("within", kind="truth"),))
    bare = Truths(lambda *_: np.int32(1), signature)
    for value in (0, 1):
        loop = _constant_loop(value)
        assert direct.direct(bare, signature, loop, bare)(ONE) is np.bool_(value)


def _constant_loop(value: int) -> Loops:
    """A loop that writes a number of 32 bits into its last argument; kept for ever."""
    import ctypes

    def write_it(arguments: Any, *_: Any) -> None:
        ctypes.cast(arguments[1], ctypes.POINTER(ctypes.c_int32))[0] = value

    kind = ctypes.CFUNCTYPE(None, *[ctypes.POINTER(ctypes.c_void_p)] * 4)
    made = kind(write_it)
    _KEPT.append(made)
    return ctypes.cast(made, ctypes.c_void_p).value or 0, 0


_KEPT: list[Any] = []


def references(leg: Leg) -> list[int]:
    """To what calls give."""
    position, pair = leg.foot_position(ONE), leg.inverse(ONE)
    return [sys.getrefcount(value) for value in (position, pair, *pair)]


def test_nothing_is_kept_of_a_call(robots: Robots) -> None:
    leg = robots("plain", "direct").legs["left"]
    q, numbers, far = ONE.copy(), [0.25, 0.5, 0.75], np.zeros((5, 3))
    before = [sys.getrefcount(value) for value in (q, numbers, numbers[0], far, leg.foot_position)]
    for _ in range(100):
        leg.foot_position(q), leg.inverse(numbers), leg.inverse_branch(q, 1), leg.foot_position(far)
        outcome(leg.foot_position, None)
    assert [sys.getrefcount(value) for value in (q, numbers, numbers[0], far, leg.foot_position)] == before
    assert references(leg) == references(robots("plain", "ufunc").legs["left"])


def test_threads_stand_behind_direct_calls(folders: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WALKGEN_BACKEND", "direct")
    leg = load(folders("plain"), threads=2).legs["left"]
    rows = np.random.default_rng(1).normal(size=(4096, 3))
    assert (leg.foot_position(rows)[7] == leg.foot_position(rows[7])).all()


@pytest.mark.parametrize(("missing", "said"), [("include", "Python.h is missing"), ("compiler", "no C compiler answers")])
def test_without_headers_or_compiler_ufuncs_serve(
    folders: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, missing: str, said: str
) -> None:
    direct._layer.cache_clear()
    if missing == "include":
        monkeypatch.setattr(sysconfig, "get_path", lambda _: str(tmp_path))
    else:
        monkeypatch.setenv("CC", "no-such-compiler")
    try:
        function = load(folders("plain")).legs["left"].foot_position
        assert type(function) is np.ufunc
        monkeypatch.setenv("WALKGEN_BACKEND", "direct")
        with pytest.raises(ToolchainError, match=said) as error:
            load(folders("plain"))
        assert error.value.problems[0].code == "WG413"
    finally:
        direct._layer.cache_clear()


def test_compiled_once_for_a_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    direct._layer.cache_clear()
    folder = write(Tiny(functions=("foot_position",)), tmp_path / "tiny")
    load(folder)
    (made,) = (tmp_path / "cache" / "walkgen" / "direct-calls").iterdir()
    stamp = made.stat().st_mtime_ns
    direct._layer.cache_clear()
    monkeypatch.setenv("CC", "no-such-compiler")
    monkeypatch.setenv("WALKGEN_BACKEND", "direct")
    assert load(folder).legs["left"].foot_position(ONE).shape == (3,)
    assert made.stat().st_mtime_ns == stamp


@pytest.mark.parametrize("backend", BACKENDS)
def test_names_and_texts(robots: Robots, backend: str) -> None:
    function = robots("plain", backend).legs["left"].foot_position
    assert "tiny_left_foot_position" in repr(function)
    assert not hasattr(function, "no_such_thing")


@pytest.mark.parametrize("variant", ["plain", "single", "parameters"])
def test_large_results_have_room_of_their_own(robots: Robots, variant: str) -> None:
    own, plain = (robot.legs["left"] for robot in both(robots, variant))
    q = np.random.default_rng(2).normal(size=(400_000, 3))
    for name in ("foot_position_jacobian", "foot_position", "inverse"):
        assert described(getattr(own, name)(q)) == described(getattr(plain, name)(q))
    J = own.foot_hessian(q)
    assert not J.flags.owndata
    assert J.flags.writeable
    place = np.empty_like(J)
    assert own.foot_hessian(q, out=place) is place
    assert np.array_equal(place, J)
    assert outcome(own.foot_hessian, q[:, :2]) == outcome(plain.foot_hessian, q[:, :2])
    assert outcome(own.foot_position, q.astype(np.complex128)) == outcome(plain.foot_position, q.astype(np.complex128))
