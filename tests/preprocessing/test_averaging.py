"""Averaging a long record: the solid that answers it is the same."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing import signal_conditioning
from dashpot.preprocessing.prepare import prepare
from dashpot.preprocessing.signal_conditioning import decimate
from dashpot.solids.maxwell import GeneralizedMaxwell

SEAL = GeneralizedMaxwell(196.5, (117.5, 17.8), (0.5021, 16.416))


def long_record(
    monkeypatch: pytest.MonkeyPatch, *, noise: float = 0.0, count: float = 0.0, enough: int = 8_000
) -> tuple[RampHold, RampHold]:
    """A record of 41k samples prepared whole, and with some thousand samples being enough."""
    time = np.arange(41_001) / 1000
    x = 8e-3 * np.clip(time - 0.5, 0.0, 1.0)
    force = SEAL.force(time, x) + noise * np.random.default_rng(2).standard_normal(len(time))
    read = count * np.round(x / count) if count else x
    test = RelaxationTest(time=time, displacement=read, force=force, units="SI")
    whole = prepare(test)
    monkeypatch.setattr(signal_conditioning, "MAX_FIT_SAMPLES", enough)
    monkeypatch.setattr(signal_conditioning, "MIN_RAMP_SAMPLES", 100)
    return whole, prepare(test)


def test_a_solid_answers_a_mean_with_a_mean(monkeypatch: pytest.MonkeyPatch) -> None:
    _, few = long_record(monkeypatch)
    assert len(few.time) == 41_001 // 5
    model = fit(few, arms=2).model
    assert model.k_inf == pytest.approx(SEAL.k_inf, rel=1e-4)
    assert model.k == pytest.approx(SEAL.k, rel=1e-3)
    assert model.tau == pytest.approx(SEAL.tau, rel=1e-3)


@pytest.mark.parametrize("count", [0.0, 20e-6])
def test_estimates_and_errors_stay(monkeypatch: pytest.MonkeyPatch, count: float) -> None:
    whole, few = long_record(monkeypatch, noise=3e-3, count=count)
    assert few.encoder_step == pytest.approx(whole.encoder_step)
    assert few.force_noise == pytest.approx(whole.force_noise / np.sqrt(5), rel=0.1)
    item, other = fit(whole, arms=2), fit(few, arms=2)
    errors = np.sqrt(np.diag(item.covariance))
    np.testing.assert_allclose(np.sqrt(np.diag(other.covariance)), errors, rtol=0.25)
    away = [
        other.model.k_inf - item.model.k_inf,
        *np.subtract(other.model.k, item.model.k),
        *np.log(np.divide(other.model.tau, item.model.tau)),
    ]
    assert np.all(np.abs(away) < 0.5 * errors)
    assert "averaged each 5 of 41001 samples" in few.steps[-1].message


def test_decimate_returns_short_uneven_or_coarse_records_unchanged(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole, _ = long_record(monkeypatch, enough=20_501)
    assert decimate(whole) is whole  # not twice as long as enough
    monkeypatch.setattr(signal_conditioning, "MAX_FIT_SAMPLES", 20_500)
    assert len(decimate(whole).time) == 41_001
    monkeypatch.setattr(signal_conditioning, "MAX_FIT_SAMPLES", 13_667)
    assert len(decimate(whole).time) == 13_667
    monkeypatch.setattr(signal_conditioning, "MIN_RAMP_SAMPLES", 700)
    assert decimate(whole) is whole  # its ramp has a thousand samples
    monkeypatch.setattr(signal_conditioning, "MIN_RAMP_SAMPLES", 100)
    late = whole.time + 0.4e-3 * (np.arange(len(whole.time)) > 30_000)
    assert decimate(replace(whole, time=late)) is not whole
    later = whole.time + 0.4e-3 * (np.arange(len(whole.time)) > 30_000) * 2
    uneven = replace(whole, time=later, hold_end=float(later[-1]))
    assert decimate(uneven) is uneven


def test_prepare_of_a_long_record_needs_memory_of_ten_channels() -> None:
    """A record of 3 million samples, 24 MB a channel, is prepared beside the app's other lanes."""
    time = np.arange(200_000) / 4000
    x = 8e-3 * np.clip(time - 0.5, 0.0, 1.0)
    hum = 0.02 * np.sin(2 * np.pi * 50 * time)
    noise = 2e-3 * np.random.default_rng(3).standard_normal(len(time))
    test = RelaxationTest(time, x, 300 * x + hum + noise, units="SI")
    tracemalloc.start()
    try:
        ramp_hold = prepare(test, with_checks=False)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert [round(line.frequency) for line in ramp_hold.hum] == [50]
    assert most < 10 * time.nbytes
