"""Shift factors: the laws against numbers computed apart, and against each other."""

import numpy as np
import pytest

import dashpot as dp
from dashpot.datamodel.shift_factors import Shift, TemperatureShifts

REFERENCE = 296.15
CELSIUS = np.array([-40.0, -20.0, 0.0, 40.0, 80.0]) + 273.15
WLF = dp.solids.WLF.universal(glass=218.15, reference=REFERENCE)


def test_universal_wlf_reproduces_reference_values():
    assert WLF.c1 == pytest.approx(6.943703704, rel=1e-9)
    assert WLF.c2 == pytest.approx(129.6, rel=1e-12)
    expected = [6.568368, 3.447797, 1.498172, -0.805204, -2.121067]
    np.testing.assert_allclose(WLF.log10_a_t(CELSIUS), expected, atol=6e-7)
    energies = WLF.activation_energy(np.array([253.15, 296.15, 353.15])) / 1e3
    np.testing.assert_allclose(energies, [147.220, 89.962, 61.708], atol=6e-4)


def test_arrhenius_reproduces_reference_values():
    law = dp.solids.Arrhenius(60e3, REFERENCE)
    expected = [1.797547, 0.891079, -0.574495, -1.708069]
    np.testing.assert_allclose(law.log10_a_t(CELSIUS[1:]), expected, atol=6e-7)


@pytest.mark.parametrize("law", [WLF, dp.solids.Arrhenius(60e3, REFERENCE)])
def test_the_energy_is_the_slope_of_the_shift_over_inverse_temperature(law):
    t, h = 281.0, 1e-3
    slope = (law.log10_a_t(t + h) - law.log10_a_t(t - h)) / (1 / (t + h) - 1 / (t - h))
    assert law.activation_energy(t) == pytest.approx(8.314462618 * np.log(10) * slope, rel=1e-6)


def test_a_wlf_law_is_the_same_from_every_reference():
    other = WLF.change_reference(313.15)
    difference = WLF.log10_a_t(CELSIUS) - other.log10_a_t(CELSIUS)
    np.testing.assert_allclose(difference, WLF.log10_a_t(313.15), rtol=1e-12)
    assert other.change_reference(REFERENCE).c1 == pytest.approx(WLF.c1, rel=1e-12)


def test_wlf_refuses_where_it_diverges():
    pole = REFERENCE - WLF.c2
    assert np.isfinite(WLF.log10_a_t(pole + 1e-6))
    with pytest.raises(dp.DataError, match="diverges"):
        WLF.log10_a_t(pole)
    with pytest.raises(dp.DataError, match="holds above"):
        WLF.change_reference(pole)


def test_free_shifts_follow_the_tests_and_reach_no_further():
    law = dp.solids.FreeShifts((273.15, 296.15), (1.5, 0.0), 296.15)
    inverse = (1 / 273.15 + 1 / 296.15) / 2
    assert law.log10_a_t(1 / inverse) == pytest.approx(0.75)
    assert law.activation_energy(280.0) == pytest.approx(
        1.5 * np.log(10) * 8.314462618 / (1 / 273.15 - 1 / 296.15)
    )
    assert law.log10_a_t(273.15) == 1.5
    with pytest.raises(dp.DataError, match="third temperature"):
        law.log10_a_t(273.14)
    with pytest.raises(dp.DataError, match="reference"):
        dp.solids.FreeShifts((273.15, 296.15), (1.5, 0.1), 296.15)


def test_a_shifted_solid_answers_slower_and_stiffer():
    seal = dp.GeneralizedMaxwell(200.0, (50.0, 20.0), (0.01, 3.0), b=0.3)
    omega = np.geomspace(1e-3, 1e3, 13)
    cold = seal.shift_to_temperature(30.0, 0.9)
    np.testing.assert_allclose(
        cold.complex_stiffness(omega=omega),
        0.9 * seal.complex_stiffness(omega=30.0 * omega),
        rtol=1e-12,
    )
    with pytest.raises(dp.DataError, match="a_t"):
        seal.shift_to_temperature(0.0)


def test_vertical_shift_interpolates_and_extrapolates():
    law = dp.solids.FreeShifts((273.15, 296.15), (1.5, 0.0), 296.15)
    shifts = (Shift(273.15, 1.5, 0.01, 0.9, 0.001), Shift(296.15, 0.0, 0.0))
    temperature_shifts = TemperatureShifts(law, shifts, np.zeros((4, 4)))
    assert temperature_shifts.tested_range == (273.15, 296.15)
    assert temperature_shifts.b_t(273.15) == pytest.approx(0.9)
    assert temperature_shifts.b_t(296.15) == 1.0
    assert temperature_shifts.b_t(284.65) == pytest.approx(np.sqrt(0.9))
    assert temperature_shifts.b_t(319.15) == pytest.approx(1 / 0.9)
    with pytest.raises(dp.DataError, match="covariance"):
        TemperatureShifts(law, shifts, np.zeros((3, 3)))
