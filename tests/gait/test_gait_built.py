"""A built robot's gaits: compiled C, its float library and the NumPy fall-back give what walkgen.gait gives, times to the last bit."""

import numpy as np
import pytest
from walkers import NAMES, SIDES, STANCE, spec

from walkgen.errors import UnsupportedMechanism
from walkgen.gait.pattern import Event, Gait
from walkgen.gait.schedule import Schedule
from walkgen.gait.standard import tripod, wave
from walkgen.gait.trajectory import Trajectory
from walkgen.pipeline import BuildOptions, build
from walkgen.runtime import load
from walkgen.runtime.robot import Robot
from walkgen.show import show

GAITS = f"""
[gait.tripod]
kind = "tripod"
period = "3*pace"
stride = 0.3
lift_mm = 80
{SIDES}{STANCE}
[gait.wave]
kind = "wave"
duty_factor = "5/6"
period = 3
{SIDES}
[gait.own]
kind = "free"
duty_factor = {{ lf = 0.8, rf = 0.75, lm = 0.7, rm = 0.82, lr = 0.9, rr = 0.65 }}
phase = {{ rr = 0.35, rf = -0.5, lf = 0.1, lm = "2/3", rm = 0.2, lr = 1.25 }}
period = 2
lift = 0.05
body = "waved"
margin = 0.04
[gait.steps]
kind = "events"
lift = 0.05
lifted = ["rr"]
events = [
  {{ at = "pace/5", leg = "lf", does = "lift" }}, {{ at = 0.7, leg = "rr", does = "place" }}, {{ at = 0.7, leg = "lm", does = "lift" }},
  {{ at = 1.1, leg = "lf", does = "place" }}, {{ at = 1.3, leg = "rf", does = "lift" }}, {{ at = 2.25, leg = "lm", does = "place" }},
]
"""
TIMES = np.random.default_rng(8).uniform(-20, 100, 500)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("gaits")
    (made / "six.toml").write_text(spec(GAITS, "pace = 0.5\nloose = { value = 1.0, runtime = true }"), encoding="utf-8")
    build(made / "six.toml", made, BuildOptions(float32=True, targets=("c", "numpy", "casadi")))
    return made / "six"


@pytest.fixture(params=["c", "numpy"])
def robot(request, folder, monkeypatch) -> Robot:
    monkeypatch.setenv("WALKGEN_BACKEND", request.param)
    return load(folder)


def test_the_robot_knows_its_gaits(robot):
    assert list(robot.gaits) == ["tripod", "wave", "own", "steps"]
    assert robot.gait is robot.gaits["tripod"]
    assert (robot.gait.kind, robot.gait.legs, robot.gait.period, robot.gait.stride, robot.gait.lift) == ("tripod", NAMES, 1.5, 0.3, 0.08)
    own = robot.gaits["own"]
    assert own.duty_factor == (0.8, 0.75, 0.7, 0.82, 0.9, 0.65)
    assert own.phase == (0.1, 0.5, 2 / 3, 0.2, 0.25, 0.35)
    assert (own.static, own.body, own.margin, own.stance) == (True, "waved", 0.04, None)
    left, right = NAMES[::2], NAMES[1::2]
    assert Gait.of(robot.gait) == tripod(left, right, period=1.5, stride=0.3).ordered(NAMES)
    exact = wave(left, right, 5 / 6, period=3.0).ordered(NAMES)
    assert np.allclose(Gait.of(robot.gaits["wave"]).phase, exact.phase, rtol=0, atol=1e-15)
    with pytest.raises(ValueError, match="no stance"):
        Trajectory.of(own)


def test_what_a_gait_has_no_numbers_for_is_missing(robot):
    assert hasattr(robot.gaits["own"], "foot_transfers")
    with pytest.raises(UnsupportedMechanism, match="has no stance"):
        robot.gaits["own"].foot_targets(0.0)
    with pytest.raises(UnsupportedMechanism, match="has no lift"):
        robot.gaits["wave"].foot_transfers(0.0)
    with pytest.raises(AttributeError, match="did you mean states"):
        robot.gaits["wave"].stats(0.0)


def test_a_list_of_events_is_that_of_walkgen_gait(robot):
    built = robot.gaits["steps"]
    schedule = Schedule.of(built)
    assert schedule.legs == NAMES
    assert schedule.lifted == ("rr",)
    assert schedule.events[0] == Event(0.1, "lf", "lift")
    times = np.concatenate([np.linspace(-0.5, 3, 141), [event.at for event in schedule.events], [np.nan, np.inf, -np.inf]])
    np.testing.assert_array_equal(built.states(times), schedule.states(times))
    np.testing.assert_array_equal(built.leg_phase(times), schedule.leg_phase(times))
    for mine, theirs in zip(built.next_event(times), schedule.next_event(times), strict=True):
        np.testing.assert_array_equal(mine, theirs)
    start, end = np.random.default_rng(3).uniform(-1, 1, (2, 6, 3))
    for mine, theirs in zip(built.foot_transfers(times, start, end), schedule.feet(times, start, end, 0.05), strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=2e-15, atol=5e-15 * np.nanmax(np.abs(theirs)))
    time, state = -1.0, built.states(-1.0)
    for _ in range(5):  # the events' five instants, and none after them
        time, change = built.next_event(time)
        state = state + change
        assert (built.states(time) == state).all()
    assert np.isnan(built.next_event(time)[0])
    assert state.tolist() == [0, 1, 0, 0, 0, 0]
    assert repr(built) == "<gait 'steps': 6 events, 4 functions>"
    assert (built.kind, built.lift, built.stride, built.stance, built.static, built.body, built.margin) == (
        "events",
        0.05,
        0.0,
        None,
        True,
        "level",
        None,
    )
    with pytest.raises(AttributeError, match="has no 'foot_targets'"):
        built.foot_targets(0.0)


@pytest.mark.parametrize("name", ["tripod", "wave", "own"])
def test_states_phases_and_events_are_those_of_walkgen_gait(robot, name):
    built = robot.gaits[name]
    gait = Gait.of(built)
    events = np.array([cycle + event.at for cycle in range(-2, 30) for event in gait.events]) * gait.period
    times = np.concatenate([TIMES, events, [np.nan, np.inf, 1e300]])
    np.testing.assert_array_equal(built.states(times), gait.states(times))
    np.testing.assert_array_equal(built.leg_phase(times), gait.leg_phase(times))
    for mine, theirs in zip(built.next_event(times), gait.next_event(times), strict=True):
        np.testing.assert_array_equal(mine, theirs)


def test_feet_are_those_of_walkgen_gait(robot):
    built, trajectory = robot.gait, Trajectory.of(robot.gait)
    twists = np.random.default_rng(2).uniform(-1, 1, (len(TIMES), 3)) * (np.arange(len(TIMES)) % 3 > 0)[:, None]
    for mine, theirs in zip(built.foot_targets(TIMES, twists), trajectory.platform(TIMES, twists), strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=3e-14, atol=3e-14)
    for mine, theirs in zip(built.foot_targets(TIMES), trajectory.platform(TIMES), strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-14, atol=1e-14)
    start, end = np.random.default_rng(3).uniform(-1, 1, (2, len(TIMES), 6, 3))
    for mine, theirs in zip(built.foot_transfers(TIMES, start, end), trajectory.between(TIMES, start, end), strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=2e-15, atol=5e-15 * np.abs(theirs).max())
    assert built.foot_targets(0.2)[0].shape == (6, 3)


def test_footholds_to_come_of_feet_that_stand_do_not_count(robot):
    start = np.arange(18.0).reshape(6, 3)
    stands = robot.gait.states(0.1) == 0
    for kind in (robot.gait.foot_transfers, Trajectory.of(robot.gait).between):
        p, v, a = kind(0.1, start, np.where(stands[:, None], np.nan, start + 0.1))
        np.testing.assert_array_equal(p[stands], start[stands])
        assert not v[stands].any()
        assert not a[stands].any()
        assert np.isfinite(p).all()


def test_single_precision(folder, monkeypatch):
    monkeypatch.setenv("WALKGEN_BACKEND", "c")
    robot = load(folder)
    times = np.linspace(0.01, 7, 101, dtype=np.float32)
    gait = Gait.of(robot.gait)
    u = robot.gait.leg_phase(times)
    assert u.dtype == np.float32
    away = abs(gait.leg_phase(times) - u)
    assert np.minimum(away, 1 - away).max() < 1e-5
    for mine, theirs in zip(robot.gait.foot_targets(times), Trajectory.of(robot.gait).platform(times), strict=True):
        np.testing.assert_allclose(mine, theirs, atol=3e-5 * max(1, np.abs(theirs).max()))
    time, state = np.float32(0.0), robot.gaits["own"].states(np.float32(0.0))
    for _ in range(400):  # following events never stands still, nor loses one
        after, change = robot.gaits["own"].next_event(time)
        assert after > time
        time, state = after, state + change
        assert (robot.gaits["own"].states(time) == state).all()


def test_no_casadi_form(folder):
    with pytest.raises(UnsupportedMechanism, match="has no CasADi form"):
        load(folder).casadi("gait_tripod_states")


def test_header_and_stub_name_the_gaits(folder):
    header, stub = ((folder / name).read_text(encoding="utf-8") for name in ("six.h", "__init__.pyi"))
    assert "#define SIX_GAIT_TRIPOD_PERIOD 1.5" in header
    assert "#define SIX_GAIT_TRIPOD_LIFT 0.08" in header
    assert "#define SIX_GAIT_STEPS_EVENTS 6" in header
    assert "SIX_GAIT_STEPS_PERIOD" not in header
    assert 'gaits: Mapping[Literal["tripod", "wave", "own", "steps"], _Gait1 | _Gait2 | _Gait3 | _Gait4]' in stub
    assert "events: tuple[tuple[float, str, str], ...]" in stub
    compile(stub, "stub", "exec")


def test_show_says_when_legs_support(tmp_path):
    (tmp_path / "six.toml").write_text(spec(GAITS, "pace = 0.5"), encoding="utf-8")
    said = show(tmp_path / "six.toml", "mechanism", "").splitlines()
    assert "gait wave: wave, period 3 s, stride 0 m" in said
    assert "    rr  supports 0.65 of the period from 0.35 on" in said
    assert "gait steps: 6 events; in transfer before them: rr" in said
    assert "    0.1 s  lift lf" in said


def test_a_robot_with_one_gait_does_not_name_it(tmp_path):
    gait = f'[gait]\nkind = "wave"\nduty_factor = 0.75\nperiod = 2.0\nlift = 0.1\nstride = 0.2\n{SIDES}{STANCE}'
    (tmp_path / "six.toml").write_text(spec(gait), encoding="utf-8")
    build(tmp_path / "six.toml", tmp_path, BuildOptions(targets=("numpy",)))
    robot = load(tmp_path / "six")
    assert list(robot.gaits) == [""]
    assert "six_gait_states" in robot.functions
    assert robot.gait.states(0.1).tolist() == Gait.of(robot.gait).states(0.1).tolist()


def test_a_robot_without_gaits_says_so(tmp_path):
    (tmp_path / "six.toml").write_text(spec("", functions='["foot_position"]'), encoding="utf-8")
    build(tmp_path / "six.toml", tmp_path, BuildOptions(targets=("numpy",)))
    robot = load(tmp_path / "six")
    assert not robot.gaits
    assert not any("gait" in name for name in robot.functions)
    with pytest.raises(UnsupportedMechanism, match=r"has no \[gait\]"):
        robot.gait  # noqa: B018
