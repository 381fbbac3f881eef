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


def test_shift_of_a_stated_rule_is_right_and_another_rule_is_a_note_at_most() -> None:
    fit, check = fit_two_temperatures(EVEN, vertical="1")
    assert check is not None
    assert not check.failed or check.grade == "note"
    assert fit.temperatures.shifts[0].log10_a_t == pytest.approx(SHIFT, abs=0.01)


def test_shift_of_arms_at_uneven_distances_is_determined() -> None:
    fit, check = fit_two_temperatures(UNEVEN)
    assert check is not None
    assert not check.failed
    assert fit.temperatures.shifts[0].log10_a_t == pytest.approx(SHIFT, abs=0.06)


def press_power_law(
    kelvin: float,
    a_t: float,
    b_t: float,
    seed: int,
    *,
    k_inf: float = 100.0,
    size: float = 120.0,
    power: float = 0.15,
    noise: float = 0.004,
) -> dp.RelaxationTest:
    """Return a ramp of 8 mm in 1 s and a hold of k(t) = b (K + C (t/a)^-p)."""
    time = np.concatenate((np.arange(0, 2.5, 0.005), np.arange(2.5, 41.5, 0.02)))
    rate, exponent = 8e-3, 1 - power
    since_start, since_end = (np.maximum(time - start, 0.0) for start in (0.5, 1.5))
    displacement = rate * (since_start - since_end)
    ramps = (since_start**exponent - since_end**exponent) / exponent
    force = b_t * (k_inf * displacement + size * a_t**power * rate * ramps)
    force += noise * np.random.default_rng(seed).standard_normal(len(time))
    test = dp.RelaxationTest(time=time, displacement=displacement, force=force, units="SI")
    return replace(test, specimen=dp.Specimen(temperature=kelvin))


def test_shifts_of_a_power_law_rest_on_the_rule_for_the_vertical_factor() -> None:
    """BIC counted the arms that a smooth spectrum takes, and chose a shift 36 SE off."""
    true = {268.15: 2.0, 281.15: 0.9, 296.15: 0.0}
    tests = [
        press_power_law(kelvin, 10**log_a, kelvin / 296.15, i)
        for i, (kelvin, log_a) in enumerate(true.items())
    ]
    fit = dp.fit(*tests, reference=296.15)
    deviations = [
        abs(shift.log10_a_t - true[shift.temperature]) / max(shift.se, 1e-9)
        for shift in fit.temperatures.shifts
        if shift.temperature < 296
    ]
    assert max(deviations) < 3 or fit.verdict.use != "use"
    names = {check.name for check in fit.checks if check.failed}
    assert max(deviations) < 3 or "shifts_independent_of_vertical_rule" in names


def test_rule_that_takes_more_arms_than_bic_asks_for_is_an_alternative() -> None:
    """Nine arms with T/T_r follow the tests as eight do with b_T free; eight do not."""
    true = {273.15: 1.019, 283.15: 0.527, 296.15: 0.0}
    tests = [
        press_power_law(
            kelvin,
            10**log_a,
            kelvin / 296.15,
            i + 8,
            k_inf=212.3,
            size=333.0,
            power=0.15,
            noise=0.002,
        )
        for i, (kelvin, log_a) in enumerate(true.items())
    ]
    fit = dp.fit(*tests, reference=296.15)
    deviations = [
        abs(shift.log10_a_t - true[shift.temperature]) / max(shift.se, 1e-9)
        for shift in fit.temperatures.shifts
        if shift.temperature < 296
    ]
    names = {check.name for check in fit.checks if check.failed}
    assert max(deviations) < 3 or "shifts_independent_of_vertical_rule" in names


def test_rule_that_does_not_exist_is_refused() -> None:
    """T was taken for T/T_r, and the result called its rule T."""
    with pytest.raises(dp.DashpotError, match="expected one of 1, T/T_r, free"):
        fit_two_temperatures(UNEVEN, vertical="T")
