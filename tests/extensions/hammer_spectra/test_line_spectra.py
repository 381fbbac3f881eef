"""Limits of a solid that a hammer alone identified, over every spectrum that its lines allow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.extensions.dynamic_stiffness.prediction import predict_stiffness
from dashpot.extensions.hammer_spectra import line_spectra
from dashpot.fitting.identification.identify import identify
from dashpot.preprocessing.prepare import prepare
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.mass_on_seals import predict_frf

pytestmark = pytest.mark.once

MASS, LINES = 0.3, np.linspace(4.0, 40.0, 109)
SPECTRA = {
    "ten arms": np.geomspace(1e-4, 1e3, 10),
    "a power law": np.geomspace(1e-6, 1e4, 51),
    "two arms": np.array([0.02, 2.0]),
}


def make_seal(times: np.ndarray, loss: float) -> GeneralizedMaxwell:
    """A seal whose arms grow with their speed, of this loss factor and 1.2 N/mm at 12.7 Hz."""
    weights = times**-0.2
    unit = GeneralizedMaxwell(1.0, tuple(weights), tuple(times))
    K = complex(unit.complex_stiffness(frequency=12.7))
    share = loss / (K.imag - loss * (K.real - 1))
    level = 1200.0 / (1 + share * (K.real - 1))
    return GeneralizedMaxwell(level, tuple(share * level * weights), tuple(times))


def measure(seal: GeneralizedMaxwell, noise: float, seed: int) -> FRF:
    frf = predict_frf(2 * seal, mass=MASS, frequency=LINES)
    sd = noise * np.abs(frf.value) / np.sqrt(2)
    draw = np.random.default_rng(seed).standard_normal((2, len(sd)))
    return replace(frf, value=frf.value + sd * (draw[0] + 1j * draw[1]), sd=sd, averages=5)


def count_missed(fit: Fit, seal: GeneralizedMaxwell) -> int:
    """Limits of storage and loss factor in the valid band that do not hold the true value."""
    low, high = fit.band
    lines = np.geomspace(low * 1.001, high * 0.999, 7)
    values = predict_stiffness(fit, frequency=lines.tolist()).values
    K = seal.complex_stiffness(frequency=lines)
    truths = np.column_stack((K.real, K.imag / K.real)).ravel()
    limits = [value for value in values if value.name != "loss"]
    return sum(
        not value.low <= truth <= value.high
        for value, truth in zip(limits, truths.tolist(), strict=True)
    )


@pytest.mark.parametrize("loss", [0.06, 0.15])
@pytest.mark.parametrize("times", SPECTRA.values(), ids=SPECTRA.keys())
def test_limits_of_a_hammer_hold_a_seal_with_more_arms_than_its_lines_show(
    times: np.ndarray, loss: float
) -> None:
    seal = make_seal(times, loss)
    fits = [
        identify(measure(seal, noise, seed), mass=MASS, seals=2)
        for seed, noise in enumerate((0.002, 0.02))
    ]
    assert [count_missed(fit, seal) for fit in fits] == [0] * len(fits)
    assert all(fit.band[0] <= 11.5 and fit.band[1] >= 13.5 for fit in fits)


def test_spectra_widen_the_limits_where_the_arms_are_too_few(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The covariance of one arm misses a seal of ten arms at the ends of the band."""
    seal = make_seal(SPECTRA["ten arms"], 0.08)
    frf = measure(seal, 0.02, 0)
    widened = identify(frf, mass=MASS, seals=2)
    monkeypatch.setattr(line_spectra, "widen_to_spectra", lambda fit, best, relaxations: fit)
    narrow = identify(frf, mass=MASS, seals=2)
    assert narrow.model == widened.model
    assert count_missed(narrow, seal) > 0
    assert count_missed(widened, seal) == 0
    assert widened.band[1] / widened.band[0] < narrow.band[1] / narrow.band[0]


def test_limits_of_a_joint_model_hold_a_seal_with_more_arms_than_its_tests_show() -> None:
    """Between the hold and the lines neither test limits the fast arms of ten."""
    seal = make_seal(SPECTRA["ten arms"], 0.08)
    time = np.arange(0.0, 31.0, 0.01)
    motion = 4e-3 * np.clip((time - 0.5) / 0.8, 0.0, 1.0)
    noise = 0.02 * np.random.default_rng(1).standard_normal(len(time))
    force = seal.force(time, motion) + noise
    test = prepare(RelaxationTest(time, motion, force, units="SI"))
    fit = identify(measure(seal, 0.02, 0), tests=[test], mass=MASS, seals=2)
    assert fit.method == "joint"
    assert count_missed(fit, seal) == 0


def test_spectra_change_little_where_the_arms_are_all_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    frf = measure(make_seal(SPECTRA["two arms"], 0.15), 1e-4, 0)
    widened = identify(frf, mass=MASS, seals=2)
    monkeypatch.setattr(line_spectra, "widen_to_spectra", lambda fit, best, relaxations: fit)
    narrow = identify(frf, mass=MASS, seals=2)
    errors, narrow_errors = widened.evidence.band_error, narrow.evidence.band_error
    assert errors is not None
    assert narrow_errors is not None
    assert errors.max_errors == pytest.approx(narrow_errors.max_errors, rel=0.1)
    assert widened.band == pytest.approx(narrow.band, rel=0.05)
