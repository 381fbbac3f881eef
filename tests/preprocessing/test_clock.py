"""Detection of jumps in a clock and of changes of its step."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.signals.clock import find_clock_jumps, find_rate_change, has_few_pauses

EVEN = np.arange(0.0, 10.0, 0.01)


def leapt(at: int, by: float) -> np.ndarray:
    return EVEN + by * (np.arange(len(EVEN)) > at)


@pytest.mark.parametrize("at", [0, 3, 500, len(EVEN) - 2])
def test_find_clock_jumps_detects_a_jump_at_any_position(at: int) -> None:
    (item,) = find_clock_jumps(leapt(at, 0.1))
    assert item.at == at
    assert item.step == pytest.approx(0.11)
    assert item.expected_step == pytest.approx(0.01)
    assert not find_clock_jumps(leapt(at, 0.08))


def test_a_change_of_rate_is_no_leap() -> None:
    slower = np.concatenate((EVEN, EVEN[-1] + np.arange(1.0, 100.0)))
    assert not find_clock_jumps(slower)
    change = find_rate_change(slower)
    assert change is not None
    assert (change.at, change.step, change.expected_step) == (
        len(EVEN) - 1,
        1.0,
        pytest.approx(0.01),
    )


@pytest.mark.parametrize(
    "time",
    [EVEN, leapt(500, 10.0), EVEN[:30], np.geomspace(1e-3, 1e3, 43), np.geomspace(1e-3, 1e3, 600)],
    ids=["even", "leaps", "short", "7 a decade", "100 a decade"],
)
def test_no_clock_goes_on_in_other_steps_that_grows_by_and_by(time: np.ndarray) -> None:
    assert find_rate_change(time) is None


def test_a_machine_that_logs_as_its_reading_changes_does_not_tick_evenly() -> None:
    random = np.random.default_rng(1)
    jittered = EVEN + 0.004 * random.uniform(-1, 1, len(EVEN))
    dropped = EVEN[random.uniform(size=len(EVEN)) > 0.1]
    waits = np.cumsum(random.exponential(0.01, len(EVEN)))
    evenly = [has_few_pauses(item) for item in (EVEN, jittered, dropped, leapt(500, 10.0), waits)]
    assert evenly == [True, True, True, True, False]
    # pauses between bursts, as of a rounded reading
    assert not has_few_pauses(EVEN - 0.008 * (np.arange(len(EVEN)) % 10))
