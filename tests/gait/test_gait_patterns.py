"""Gaits: support shares, event sequences, classes and the usual gaits, against the definitions of theory 3.1."""

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from gaits import random_gait

from walkgen.gait import phases
from walkgen.gait.pattern import Event, Gait, event_sequences
from walkgen.gait.schedule import Schedule
from walkgen.gait.standard import crawl, follow_the_leader, overlapping, tripod, trot, wave

SEEDS = range(40)
LEFT, RIGHT = ("lf", "lm", "lr"), ("rf", "rm", "rr")


def _defined_states(gait: Gait, t: float) -> list[int]:
    """Theory 3.1 read aloud, on exact fractions."""
    x = Fraction(t) / Fraction(gait.period)
    rests = [x - Fraction(phase) - math.floor(x - Fraction(phase)) for phase in gait.phase]
    return [0 if rest < Fraction(factor) else 1 for rest, factor in zip(rests, gait.duty_factor, strict=True)]


@pytest.mark.parametrize("seed", SEEDS)
def test_states_are_those_of_the_definition(seed):
    gait = random_gait(seed)
    times = np.random.default_rng(seed).uniform(-5 * gait.period, 50 * gait.period, 40)
    assert gait.states(times).tolist() == [_defined_states(gait, time) for time in times]


@pytest.mark.parametrize("seed", SEEDS)
def test_the_share_of_support_is_the_duty_factor(seed):
    gait = random_gait(seed)
    lengths = np.array([span.end - span.start for span in gait.spans])
    down = np.array([[leg in span.supporting for leg in gait.legs] for span in gait.spans])
    np.testing.assert_allclose(lengths @ down, gait.duty_factor, rtol=0, atol=1e-12)
    sampled = (gait.states((np.arange(20000) + 0.5) / 20000 * gait.period) == 0).mean(axis=0)
    np.testing.assert_allclose(sampled, gait.duty_factor, atol=1.01 / 20000)


@pytest.mark.parametrize("seed", SEEDS)
def test_events_lead_from_one_state_to_the_next(seed):
    """Following next_event gives the cycle's events, and the state at each event's time is the state after it."""
    gait = random_gait(seed)
    time = float(np.random.default_rng(seed).uniform(-3, 30)) * gait.period
    state, seen = gait.states(time), []
    for _ in range(3 * len(gait.events)):
        before, (time, change) = time, gait.next_event(time)
        assert time > before
        assert (gait.states(np.linspace(before, time, 7)[1:-1]) == state).all()
        state = state + change
        assert (gait.states(time) == state).all()
        seen += [(float(phases.fraction(time / gait.period)), gait.legs[leg], change[leg]) for leg in np.flatnonzero(change)]
    cycle = [(event.at, event.leg, 1 if event.does == "lift" else -1) for event in gait.events]
    start = next(n for n, event in enumerate(cycle) if event[1:] == seen[0][1:])
    for (at, *what), (expected, *meant) in zip(seen, (cycle[start:] + cycle[:start]) * 3, strict=True):
        assert what == meant
        assert math.sin(math.pi * (at - expected)) == pytest.approx(0, abs=1e-12)


def test_times_that_are_events_have_the_state_after_them():
    """Where rounding of t/T - phase would fall short: tenths of a period at 0.1 s."""
    gait = Gait(("a", "b", "c"), (0.3, 0.7, 0.9), (0.1, 0.2, 0.6), period=0.1)
    for cycle in range(200):
        for event in gait.events:
            place = gait.legs.index(event.leg)
            assert gait.states((cycle + event.at) * 0.1)[place] == (event.does == "lift")


def test_a_time_that_is_no_time_has_no_state():
    gait = tripod(LEFT, RIGHT)
    assert (gait.states([math.nan, math.inf]) == -1).all()
    assert np.isnan(gait.leg_phase(math.nan)).all()
    time, change = gait.next_event(math.nan)
    assert math.isnan(time)
    assert not change.any()


def test_formula_and_event_sequences():
    gait = Gait(("a", "b", "c", "d"), (0.6, 0.7, 0.8, 0.9), (0.25, 0.5, 0.0, 0.125))
    assert gait.formula == (0.6, 0.7, 0.8, 0.9, 0.25, 0.75, 0.875)
    assert (event_sequences(4), event_sequences(6)) == (5040, 39916800)
    named = [(event.leg, event.does) for event in gait.events]
    assert sorted(named) == sorted((leg, does) for leg in "abcd" for does in ("lift", "place"))
    assert [event.at for event in gait.events] == sorted(event.at for event in gait.events)


def test_wave_gait_phases():
    """phi_L = F(m beta), phi_R = F(m beta + 1/2); the tripod is n = 3, beta = 1/2."""
    assert wave(LEFT, RIGHT, 0.75).phase == (0.0, 0.75, 0.5, 0.5, 0.25, 0.0)
    assert tripod(LEFT, RIGHT).phase == wave(LEFT, RIGHT, 0.5).phase == (0.0, 0.5, 0.0, 0.5, 0.0, 0.5)
    assert crawl(("lf", "lh"), ("rf", "rh"), 0.8).phase == pytest.approx((0, 0.8, 0.5, 0.3), abs=1e-15)
    assert trot(("lf", "lh"), ("rf", "rh")).phase == (0.0, 0.5, 0.5, 0.0)
    assert phases.wave(3, Fraction(2, 3)) == (0, Fraction(2, 3), Fraction(1, 3), Fraction(1, 2), Fraction(1, 6), Fraction(5, 6))


@pytest.mark.parametrize("pairs", [2, 3, 4, 5])
def test_wave_gaits_are_static_from_their_least_duty_factor_on(pairs):
    names = [f"{n}" for n in range(2 * pairs)]
    left, right = names[:pairs], names[pairs:]
    least = 3 / (2 * pairs)
    for factor in (least, least + 0.01, 0.99):
        gait = wave(left, right, factor)
        assert gait.is_static
        assert gait.is_regular
        assert gait.is_symmetric(left, right)
        assert gait.is_singular  # a leg lifts as its hind neighbour is placed
    with pytest.raises(ValueError, match=r"a wave gait of \d+ legs needs"):
        wave(left, right, least - 0.01)


def test_classes():
    assert not trot(("a", "b"), ("c", "d")).is_static
    assert trot(("a", "b"), ("c", "d")).fewest_supporting == 2
    gait = Gait(("a", "b"), (0.6, 0.7), (0.0, 0.45))
    assert not gait.is_regular
    assert not gait.is_singular
    assert not gait.is_symmetric(("a",), ("b",))
    assert Gait(("a", "b"), (0.6, 0.6), (0.9, 0.4)).is_symmetric(("a",), ("b",))


def test_stroke_and_speed():
    gait = wave(LEFT, RIGHT, 0.75, period=2.0, stride=0.4)
    assert gait.stroke == pytest.approx((0.3,) * 6)
    assert gait.speed == pytest.approx(0.2)


@pytest.mark.parametrize("pitch", [0.3, 0.45, 0.8])
def test_follow_the_leader_steps_into_the_place_of_the_foot_before(pitch):
    """Footholds of a side coincide, and the foot before has left when the next one comes."""
    duty, stride = 0.7, 0.4
    gait = follow_the_leader(LEFT, RIGHT, duty, pitch, stride)
    places = {}
    for side in (LEFT, RIGHT):
        for m, leg in enumerate(side):
            placed = gait.phase[gait.legs.index(leg)] + np.arange(-6, 6)
            places[leg] = placed * stride - m * pitch, placed
    for side in (LEFT, RIGHT):
        for ahead, behind in pairwise(side):
            x, placed = places[behind]
            for spot, time in zip(x[6:9], placed[6:9], strict=True):
                nearest = np.argmin(abs(places[ahead][0] - spot))
                assert places[ahead][0][nearest] == pytest.approx(spot, abs=1e-12)
                assert places[ahead][1][nearest] + duty <= time + 1e-12
    with pytest.raises(ValueError, match="the fore foot is still there"):
        follow_the_leader(LEFT, RIGHT, duty, 0.2, stride)


def test_overlapping_gait_passes_the_last_foot_to_the_front():
    gait = overlapping(LEFT, RIGHT)
    assert gait.duty_factor == pytest.approx((5 / 6,) * 6)
    assert {len(span.supporting) for span in gait.spans} == {5}
    for side in (LEFT, RIGHT):
        placed = [event.leg for event in gait.events if event.does == "place" and event.leg in side]
        assert placed == list(reversed(side))
    lifted = [event.leg[0] for event in gait.events if event.does == "lift"]
    assert all(here != there for here, there in pairwise(lifted))  # sides in turn
    for time in np.linspace(0, 1, 97):
        u = gait.leg_phase(time)
        for event in (event for event in gait.events if event.does == "lift"):
            if abs(time - event.at) < 1e-3:
                side = LEFT if event.leg in LEFT else RIGHT
                assert max(side, key=lambda leg: u[gait.legs.index(leg)]) == event.leg  # the rearmost lifts


def test_bad_gaits():
    for duty in (0.0, 1.0, -0.1, math.nan):
        with pytest.raises(ValueError, match="the duty factor of a"):
            Gait(("a",), (duty,), (0.0,))
    with pytest.raises(ValueError, match="a name of its own"):
        Gait(("a", "a"), (0.5, 0.5), (0.0, 0.5))
    with pytest.raises(ValueError, match="period"):
        Gait(("a",), (0.5,), (0.0,), period=0.0)
    with pytest.raises(ValueError, match="3 legs on each side"):
        tripod(("a", "b"), ("c", "d"))
    with pytest.raises(ValueError, match="the gait's legs are a, b"):
        Gait(("a", "b"), (0.5, 0.6), (0.0, 0.5)).ordered(("a", "c"))
    assert Gait(("a", "b"), (0.5, 0.6), (0.0, 0.5)).ordered(("b", "a")) == Gait(("b", "a"), (0.6, 0.5), (0.5, 0.0))


@pytest.mark.parametrize("seed", SEEDS)
def test_a_schedule_of_a_gaits_events_is_that_gait(seed):
    gait = random_gait(seed)
    events = tuple(Event((cycle + event.at) * gait.period, event.leg, event.does) for cycle in range(4) for event in gait.events)
    lifted = tuple(leg for leg, state in zip(gait.legs, gait.states(events[0].at - 1e-9), strict=True) if state)
    schedule = Schedule(gait.legs, events, lifted)
    times = np.random.default_rng(seed).uniform(0, 4 * gait.period - 1e-3, 60)
    assert (schedule.states(times) == gait.states(times)).all()
    inner = times[(times > gait.period) & (times < 3 * gait.period)]
    for mine, theirs in zip(schedule.next_event(inner), gait.next_event(inner), strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-12)
    u, factors = gait.leg_phase(inner), np.array(gait.duty_factor)
    np.testing.assert_allclose(schedule.leg_phase(inner), np.where(u < factors, u / factors, (u - factors) / (1 - factors)), atol=1e-11)
    assert schedule.fewest_supporting == gait.fewest_supporting


def test_bad_schedules():
    with pytest.raises(ValueError, match="no leg c"):
        Schedule(("a", "b"), (Event(0.0, "c", "lift"),))
    with pytest.raises(ValueError, match="order of time"):
        Schedule(("a", "b"), (Event(1.0, "a", "lift"), Event(0.5, "b", "lift")))
    with pytest.raises(ValueError, match="lifted already"):
        Schedule(("a", "b"), (Event(0.0, "a", "lift"), Event(0.5, "a", "lift")))
    over = Schedule(("a",), (Event(0.0, "a", "lift"), Event(1.0, "a", "place")))
    assert math.isnan(over.next_event(1.0)[0])
    assert over.states([-1.0, 0.0, 0.5, 1.0, 9.0, math.nan]).ravel().tolist() == [0, 1, 1, 0, 0, -1]
