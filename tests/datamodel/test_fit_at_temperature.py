"""A fit shifted to another temperature, against independent numbers and random draws."""

from dataclasses import replace

import numpy as np
import pytest
from kit.fits import a_fit

import dashpot as dp
from dashpot.datamodel.shift_factors import Shift, TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.solids.demo_seals import BROAD
from dashpot.workflow.json_archive import from_json, to_json

REFERENCE = 296.15
LAW = dp.solids.WLF.universal(glass=218.15, reference=REFERENCE)

TESTED = (273.15, 283.15, REFERENCE)


def make_shifts(
    law=LAW, vertical="T/T_r", parameters=("c1", "c2"), doubt=((1e-2, 0.1), (0.1, 4.0))
):
    shifts = tuple(
        Shift(t, float(LAW.log10_a_t(t)), 0.0 if t == REFERENCE else 1e-3, t / REFERENCE)
        for t in TESTED
    )
    return TemperatureShifts(law, shifts, np.zeros((6, 6)), parameters, np.array(doubt), vertical)


FIT = replace(a_fit(BROAD, specimen=Specimen(temperature=REFERENCE)), temperatures=make_shifts())
FREE = TemperatureShifts(
    dp.solids.FreeShifts((273.15, REFERENCE), (1.5, 0.0), REFERENCE),
    (Shift(273.15, 1.5, 0.01), Shift(REFERENCE, 0.0, 0.0)),
    np.diag([1e-4, 0.0, 0.0, 0.0]),
)


@pytest.mark.parametrize(
    ("celsius", "storage", "loss_factor"),
    [
        (-20, 0.334912, 9.1011e-5),
        (0, 0.361079, 0.00801357),
        (23, 0.364878, 0.0561894),
        (40, 0.359200, 0.0970919),
        (80, 0.267204, 0.158968),
    ],
)
def test_the_broad_seal_at_its_temperatures(celsius, storage, loss_factor):
    at = FIT.at(f"{celsius}degC").complex_stiffness(omega=2 * np.pi * 12.71)
    assert 1e-3 * at.real == pytest.approx(storage, rel=2e-6)
    assert at.imag / at.real == pytest.approx(loss_factor, rel=2e-5)


def test_the_whole_fit_moves_with_its_solid():
    cold = FIT.at_temperature(273.15)
    assert cold.model == FIT.at(273.15)
    assert cold.specimen.temperature == 273.15
    assert cold.band[1] / FIT.band[1] == pytest.approx(10 ** -LAW.log10_a_t(273.15))
    assert cold.temperatures.reference == 273.15
    assert FIT.at_temperature(REFERENCE) is FIT


@pytest.mark.parametrize("slope", [0.0, 0.03])
@pytest.mark.parametrize("kind", ["wlf", "arrhenius", "free"])
def test_there_and_back_is_where_it_was(kind, slope):
    law, names, doubt = {
        "wlf": (LAW, ("c1", "c2"), ((1e-2, 0.1), (0.1, 4.0))),
        "arrhenius": (dp.solids.Arrhenius(6e4, REFERENCE), ("energy",), ((1e6,),)),
        "free": (FREE.law, (), ((),)),
    }[kind]
    expected = FREE if kind == "free" else make_shifts(law, "free", names, doubt)
    fit = replace(FIT, temperatures=replace(expected, slope=slope))
    there = fit.at_temperature(280.0)
    np.testing.assert_allclose(there.at(REFERENCE).tau, fit.model.tau, rtol=1e-9)
    np.testing.assert_allclose(there.at(REFERENCE).k, fit.model.k, rtol=1e-9)
    np.testing.assert_allclose(there.at(285.0).tau, fit.at(285.0).tau, rtol=1e-3)
    again = there.at_temperature(REFERENCE).temperatures
    assert again.error(278.0)[0] == pytest.approx(fit.temperatures.error(278.0)[0], rel=0.03)
    assert [shift.temperature for shift in again.shifts].count(REFERENCE) == 1


@pytest.mark.parametrize("kelvin", [253.15, 278.0, 290.0, 353.15])
def test_tested_range_stays_that_of_the_tests(kelvin):
    """A reference is no test, wherever it lies and however often it moves."""
    there = FIT.at_temperature(kelvin)
    again = there.at_temperature(345.0).at_temperature(TESTED[1])
    for fit in (there, there.at_temperature(300.0), again):
        shifts = from_json(to_json(fit)).temperatures
        assert shifts == fit.temperatures
        assert shifts.tested_range == (TESTED[0], TESTED[-1])
        assert [shift.temperature for shift in shifts.tested_shifts] == list(TESTED)
        assert shifts.coldest == pytest.approx(FIT.temperatures.coldest)
        assert shifts.find_nearest(kelvin) in shifts.tested_shifts
    assert FIT.temperatures.untested is None
    assert "untested" not in to_json(FIT.at_temperature(TESTED[0]))


def test_errors_at_another_temperature_hold_the_doubt_of_both_shifts():
    law, draws = make_shifts(), np.random.default_rng(1).standard_normal((20000, 2))
    c = np.array([LAW.c1, LAW.c2]) + draws @ np.linalg.cholesky(law.law_covariance).T
    above = 263.15 - REFERENCE
    spread = np.std(np.log(10) * -c[:, 0] * above / (c[:, 1] + above))
    assert law.error(263.15)[0] == pytest.approx(spread, rel=0.03)
    free = replace(a_fit(BROAD), temperatures=FREE).at_temperature(273.15)
    row = free.estimate.parameters.index("ln_tau_1")
    expected = 0.01**2 + (0.01 * np.log(10)) ** 2
    assert free.covariance[row, row] == pytest.approx(expected)
    # every arm moves together
    assert free.covariance[row, row + 1] == pytest.approx((0.01 * np.log(10)) ** 2)


def test_a_law_is_refused_nearer_than_ten_kelvin_to_the_glass_transition():
    assert pytest.approx(218.15) == LAW.glass
    assert FIT.at(228.2).tau[0] > BROAD.tau[0]
    with pytest.raises(dp.DataError, match="glass transition"):
        FIT.at(228.1)
    # what was tested is known whatever the law says of the glass
    glassy = dp.solids.WLF(LAW.c1, 60.0, REFERENCE)
    assert replace(FIT, temperatures=make_shifts(glassy)).at(273.15).arms == BROAD.arms


def test_fit_at_two_temperatures_refuses_extrapolation():
    with pytest.raises(dp.DataError, match="third temperature"):
        replace(FIT, temperatures=FREE).at(263.15)


def test_fit_at_one_temperature_refuses_any_other():
    fit = a_fit(BROAD, specimen=Specimen(temperature=REFERENCE))
    assert fit.at(REFERENCE + 0.4) == fit.model
    assert fit.temperatures is None
    with pytest.raises(dp.DataError, match="23 degC"):
        fit.at("0degC")
    with pytest.raises(dp.DataError, match="nobody noted"):
        a_fit(BROAD).at("23degC")


def test_two_seals_side_by_side_move_alike():
    two = FIT.in_parallel(2)
    assert two.at(273.15) == 2 * FIT.at(273.15)
    pressed = FIT.at_compression(2e-3)
    assert pressed.at(273.15) == FIT.at(273.15)
