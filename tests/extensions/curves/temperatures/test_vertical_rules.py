"""Shifts of two temperatures that a free b_T leaves open: arms at even distances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.checks import Check

EVEN = (1e-3, 1e-2, 0.1, 1.0, 10.0)
UNEVEN = (2e-3, 5e-3, 0.3, 0.8, 30.0)
SHIFT = 1.12  # decades from 10 to -10 degC, with b_T = 1


def press_seal(tau: tuple[float, ...], a_t: float, kelvin: float, seed: int) -> dp.RelaxationTest:
    """Return a ramp of 5 mm in 0.5 s and a hold of an exact seal of five arms; noise 4 mN."""
    time = np.concatenate((np.arange(0, 2.5, 0.005), np.arange(2.5, 120, 0.1)))
    rate = 5e-3 / 0.5
    since_start, since_end = (np.maximum(time - start, 0.0) for start in (0.5, 1.0))
    displacement = rate * (since_start - since_end)
    force = 600.0 * displacement + 0.01
    for stiffness, slowness in zip((100.0, 100.0, 120.0, 100.0, 80.0), tau, strict=True):
        start, end = (-np.expm1(-t / (slowness * a_t)) for t in (since_start, since_end))
        force += stiffness * rate * slowness * a_t * (start - end)
    force += 0.004 * np.random.default_rng(seed).standard_normal(len(time))
    test = dp.RelaxationTest(time=time, displacement=displacement, force=force, units="SI")
    return replace(test, specimen=dp.Specimen(temperature=kelvin))


def fit_two_temperatures(tau: tuple[float, ...], **options: object) -> tuple[dp.Fit, Check | None]:
    """Return the fit of tests at -10 and 10 degC, and the check of rules for b_T."""
    tests = press_seal(tau, 10**SHIFT, 263.15, 0), press_seal(tau, 1.0, 283.15, 1)
    fit = dp.fit(*tests, reference=283.15, **options)
    name = "shifts_independent_of_vertical_rule"
    return fit, next((check for check in fit.checks if check.name == name), None)


def test_shift_that_a_free_vertical_factor_leaves_open_is_not_for_use() -> None:
    fit, check = fit_two_temperatures(EVEN)
    shift = fit.temperatures.shifts[0]
    assert check is not None
    assert abs(shift.log10_a_t - SHIFT) < 0.05 or check.failed
    if check.failed:
        assert fit.verdict.use != "use"
        assert "log10 a_T = 1.12" in check.message


def test_shift_of_a_stated_rule_is_right_and_is_not_compared() -> None:
    fit, check = fit_two_temperatures(EVEN, vertical="1")
    assert check is None
    assert fit.temperatures.shifts[0].log10_a_t == pytest.approx(SHIFT, abs=0.01)


def test_shift_of_arms_at_uneven_distances_is_determined() -> None:
    fit, check = fit_two_temperatures(UNEVEN)
    assert check is not None
    assert not check.failed
    assert fit.temperatures.shifts[0].log10_a_t == pytest.approx(SHIFT, abs=0.06)
