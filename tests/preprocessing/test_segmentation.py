"""Ramps and holds, found in a recorded displacement."""

from __future__ import annotations

import itertools
from time import process_time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from kit.trials import Bench, Seal, record, relaxation_test

from dashpot.preprocessing.plate_motion import ideal_ramp
from dashpot.preprocessing.prepare import prepare
from dashpot.signals import segments
from dashpot.signals.segments import (
    MotionSegment,
    classify_loading,
    find_cycles,
    find_segments,
    negate_segments,
)


def kinds(time, x) -> list[str]:
    return [part.kind for part in find_segments(time, x)]


def path(t, *corners):
    return np.interp(t, [c[0] for c in corners], [c[1] for c in corners])


T = np.arange(0, 40, 0.01)


@pytest.mark.parametrize(
    ("corners", "expected"),
    [
        (((0, 0), (1, 0), (2, 8), (40, 8)), ["hold", "load", "hold"]),
        (((0, 0), (2, 8), (40, 8)), ["load", "hold"]),
        (
            ((0, 0), (1, 0), (2, 8), (30, 8), (31, 0), (40, 0)),
            ["hold", "load", "hold", "unload", "hold"],
        ),
        (
            ((0, 0), (1, 0), (2, 4), (9, 4), (10, 8), (40, 8)),
            ["hold", "load", "hold", "load", "hold"],
        ),
        (((0, 0), (10, 8), (20, 0), (30, 8), (40, 0)), ["load", "unload", "load", "unload"]),
        # a slow unloading is still a move, and a slow creep is still a hold
        (((0, 0), (1, 0), (1.5, 8), (20, 8), (40, 2)), ["hold", "load", "hold", "unload"]),
        (((0, 0), (1, 0), (1.5, 8), (40, 8.3)), ["hold", "load", "hold"]),
    ],
)
@pytest.mark.parametrize("grain", ["exact", "counted", "noisy"])
def test_find_segments_recovers_the_drawn_path(corners, expected: list[str], grain: str):
    x = path(T, *corners)
    if grain == "counted":
        x = np.round(x / 0.02) * 0.02
    if grain == "noisy":
        x = x + 0.01 * np.random.default_rng(0).standard_normal(len(x))
    assert kinds(T, x) == expected


def test_a_record_that_is_halved_shows_the_same(monkeypatch: pytest.MonkeyPatch):
    """However often its samples were looked at before."""
    ramps = path(T, (0, 0), (1, 0), (2, 4), (9, 4), (10, 8), (30, 8), (31, 0), (40, 0))
    drawn = [ramps, T % 0.07, np.exp(-T / 10) * np.sin(9 * T)]
    expected = [classify_loading(find_segments(T, x)) for x in drawn]
    moves = kinds(T, ramps)
    monkeypatch.setattr(segments, "_MAX_VISITS", 0)
    assert [classify_loading(find_segments(T, x)) for x in drawn] == expected
    assert kinds(T, ramps) == moves


@pytest.mark.parametrize("sign", [1, -1])
def test_find_segments_commutes_with_sign(sign: int):
    x = sign * path(T, (0, 0), (1, 0), (2, 4), (9, 4), (10, 8), (30, 8), (31, 2), (40, 0))
    x = x + 0.01 * np.random.default_rng(0).standard_normal(len(x))
    assert negate_segments(find_segments(T, x)) == find_segments(T, -x)


def test_cycles_without_end_are_looked_at_no_more_often_for_that(monkeypatch: pytest.MonkeyPatch):
    """Each was cut off the whole rest."""
    looked, farthest = [], segments._find_farthest_sample
    monkeypatch.setattr(
        segments, "_find_farthest_sample", lambda t, x: looked.append(len(x)) or farthest(t, x)
    )
    t = 0.01 * np.arange(20_000)
    find_segments(t, np.arange(len(t)) % 7.0)
    assert sum(looked) < 400 * len(t)  # 2,900 before


def test_cycles_of_unreturned_moves_take_linear_time():
    up = [MotionSegment("load", i, i + 1, i, i + 1, i, i + 2) for i in range(0, 20_000, 2)]
    down = [MotionSegment("unload", i, i + 1, i, i + 1, i + 1, i) for i in range(1, 20_000, 2)]
    both = tuple(itertools.chain.from_iterable(zip(up, down, strict=True)))
    began = process_time()
    assert find_cycles(both) == ()
    assert process_time() - began < 2  # 15 s before


def test_segments_cover_the_record_without_a_gap():
    segments = find_segments(T, path(T, (0, 0), (1, 0), (2, 8), (30, 8), (31, 3), (40, 3)))
    assert segments[0].first == 0
    assert segments[-1].last == len(T) - 1
    assert all(a.last == b.first for a, b in itertools.pairwise(segments))


def test_a_record_that_only_scatters_rests():
    noise = np.random.default_rng(0).standard_normal(500)
    assert kinds(np.arange(500.0), noise) == ["hold"]
    assert kinds(np.arange(500.0), np.zeros(500)) == ["hold"]


def test_overshoot_and_ringing_belong_to_the_hold():
    t = T[T > 2] - 2
    ring = 8 * (1 + 0.04 * np.exp(-3 * t) * np.cos(2 * np.pi * 5 * t))
    x = np.concatenate((path(T[T <= 2], (0, 0), (1, 0), (2, 8)), ring))
    assert kinds(T, x) == ["hold", "load", "hold"]


@given(
    start=st.floats(1.0, 5.0),
    duration=st.floats(0.05, 5.0),
    rate=st.sampled_from([50.0, 200.0, 1000.0]),
    seed=st.integers(0, 5),
)
def test_ideal_ramp_recovers_its_corners(start: float, duration: float, rate: float, seed: int):
    time = np.arange(0, 30, 1 / rate)
    x = path(time, (0, 0), (start, 0), (start + duration, 8), (30, 8))
    x = x + 1e-3 * np.random.default_rng(seed).standard_normal(len(x))
    cycle = find_cycles(find_segments(time, x))[0]
    line = ideal_ramp(time, x, cycle.ramp, origin=0.0, level=8.0)
    inside = max(0.6 * duration * rate, 2.0)
    allowed = 4e-3 * duration / 8 * (1 + 6 / inside**0.5)
    # a ramp of fewer than three samples is known to one sample only
    allowed += 1 / rate if 0.6 * duration * rate < 4 else 1e-9
    assert line.time_of(0.0) == pytest.approx(start, abs=allowed)
    assert line.time_of(8.0) == pytest.approx(start + duration, abs=allowed)


def test_ideal_ramp_of_one_step_joins_its_two_samples():
    t = np.arange(100.0)
    x = np.where(t >= 10, 5.0, 0.0)
    ramp = find_cycles(find_segments(t, x))[0].ramp
    line = ideal_ramp(t, x, ramp, origin=0.0, level=5.0)
    assert line.time_of(0.0) == pytest.approx(9.0)
    assert line.time_of(5.0) == pytest.approx(10.0)


def test_a_loading_ends_where_the_plate_comes_back():
    corners = [(0.0, 0.0)]
    for start in (1, 13, 25):
        corners += [(start, 0), (start + 1, 8), (start + 5, 8), (start + 6, 0)]
    cycles = find_cycles(find_segments(T, path(T, *corners)))
    assert len(cycles) == 3
    assert all(cycle.ramp_count == 1 and cycle.rest is not None for cycle in cycles)
    assert [round(cycle.hold.duration) for cycle in cycles] == [4, 4, 4]


def test_a_turning_point_is_no_hold():
    assert (
        find_cycles(find_segments(T, path(T, (0, 0), (10, 8), (10.5, 8), (20, 0), (40, 0)))) == ()
    )


def test_a_partial_unloading_stays_within_the_loading():
    x = path(T, (0, 0), (1, 0), (2, 8), (10, 8), (11, 5), (40, 5))
    (cycle,) = find_cycles(find_segments(T, x))
    assert cycle.ramp_count == 2
    assert isinstance(cycle.hold, MotionSegment)
    assert cycle.hold.level == pytest.approx(5.0)
    assert "unloading 10 to 11 s by -3000 mm" in cycle.words()


@pytest.mark.parametrize("ramp", [0.5, 1.0, 2.0])
@pytest.mark.parametrize(
    ("axis", "interval", "rate"),
    [(12.0, 0.06, 1000.0), (25.0, 0.06, 1000.0), (60.0, 0.02, 250.0), (40.0, 0.1, 500.0)],
)
def test_prepare_merges_a_stepwise_axis_into_one_ramp(ramp, axis, interval, rate):
    seal = Seal.of_arms(196.5, (117.5, 17.8), (0.5021, 16.416))
    bench = Bench(ramp=ramp, axis=axis, interval=interval, damping=0.6, rate=rate, hold=30.0)
    ramp_hold = prepare(relaxation_test(record(seal, bench)))
    assert ramp_hold.ramp_time == pytest.approx(ramp, rel=0.15)
    assert ramp_hold.depth == pytest.approx(8e-3, rel=2e-3)


def test_find_segments_keeps_a_staircase_of_holds():
    time = np.arange(0, 60, 0.01)
    steps = sum(2e-3 * np.clip((time - at) / 0.2, 0, 1) for at in (1.0, 6.0, 11.0, 16.0))
    kinds = [segment.kind for segment in find_segments(time, steps)]
    assert kinds == ["hold", *["load", "hold"] * 4]
