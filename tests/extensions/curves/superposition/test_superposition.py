"""Master curves: shifts of a simulated material come back, with honest errors and warnings."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from kit.fits import list_failed_checks
from kit.slopes import hold_slopes
from kit.sweeps import REFERENCE, TEMPERATURES, arrhenius, compliances, moduli, sweeps, wlf

import dashpot as dp
from dashpot.datamodel.shift_factors import Shift, TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.creep.fit import fit_creep
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.modulus.read import read_modulus
from dashpot.extensions.curves.shift_uncertainty import MasterCurveErrors
from dashpot.extensions.curves.superposition.isotherms import join_tests, split_isotherms
from dashpot.extensions.curves.superposition.joint_spectrum import (
    ShiftSearch,
    fit_spectrum,
    make_grid,
)
from dashpot.reading.read_options import ReadOptions
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import FreeShifts


def shifts(result):
    return np.array([shift.log10_a_t for shift in result.temperatures.shifts])


TRUE = wlf(TEMPERATURES)


def test_exact_sweeps_give_their_shifts_back():
    master_curve = dp.solids.superpose(sweeps(noise=0.0))
    np.testing.assert_allclose(shifts(master_curve), TRUE, atol=2e-4)
    assert master_curve.temperatures.vertical == "T/T_r"
    assert master_curve.temperatures.law.kind == "wlf"
    assert master_curve.temperatures.reference == pytest.approx(REFERENCE)
    assert master_curve.rms < 1e-4


def test_exact_relaxation_moduli_give_their_shifts_back():
    master_curve = dp.solids.superpose(moduli(noise=0.0), vertical="1")
    np.testing.assert_allclose(shifts(master_curve), TRUE, atol=2e-3)
    assert (np.diff(master_curve.curve.time) > 0).all()
    np.testing.assert_allclose(
        master_curve.solid.relaxation(master_curve.curve.time),
        master_curve.curve.modulus,
        rtol=2e-3,
    )


@pytest.mark.parametrize("flow", [0.0, 1e-6])
def test_exact_creep_compliances_give_their_shifts_back(flow):
    master_curve = dp.solids.superpose(
        compliances(noise=0.0, flow=flow), vertical="T/T_r", reference=REFERENCE
    )
    np.testing.assert_allclose(shifts(master_curve), TRUE, atol=2e-3)
    assert master_curve.temperatures.shifts[0].b_t == pytest.approx(TEMPERATURES[0] / REFERENCE)
    np.testing.assert_allclose(
        master_curve.solid.creep(master_curve.curve.time), master_curve.curve.compliance, rtol=2e-3
    )
    assert (master_curve.solid.k_inf == 0) == (flow > 0)


@pytest.mark.parametrize("data", [sweeps, moduli, compliances], ids=lambda make: make.__name__)
def test_the_slopes_of_shifted_isotherms_are_those_of_their_rows(data):
    isotherms = split_isotherms(join_tests(data())[0])[:3]
    shifts, free = np.array([2.0, 0.9, 0.0, -0.1, 0.04, 0.0]), np.array([0, 1, 3, 4])
    search = ShiftSearch(isotherms, make_grid(isotherms, shifts[:3]), shifts, free, noise=0.01)
    spectrum = isotherms[0].size.mean() * (0.1 + np.arange(1 + len(search.ln_tau)) % 3)
    hold_slopes(search.problem, shifts[free], spectrum)


def test_superpose_of_one_file_equals_separate_files():
    parts = compliances()
    columns = [
        np.concatenate([getattr(item, name) for item in parts]) for name in ("time", "compliance")
    ]
    warm = np.repeat(TEMPERATURES, len(parts[0].time))
    whole = dp.CreepCompliance(*columns, temperature=warm, units="SI")
    np.testing.assert_allclose(
        shifts(dp.solids.superpose(whole)), shifts(dp.solids.superpose(parts)), atol=1e-9
    )
    assert whole.select_temperature(REFERENCE) == parts[4]
    with pytest.raises(dp.FitError, match="one kind and one unit"):
        dp.solids.superpose([moduli(), parts[0]])


def test_few_arms_or_the_spectrum_of_all_follow_a_master_curve_of_creep():
    curve = dp.solids.superpose(compliances(), reference=REFERENCE, vertical="T/T_r")
    dense, few = fit_creep(curve), fit_creep(curve, arms=5)
    assert dense.model.arms > 6
    assert dense.evidence.creep is None
    assert few.model.arms == len(few.evidence.creep.spectrum.d) == 5
    assert few.temperatures == dense.temperatures == curve.temperatures
    b_t, a_t = TEMPERATURES[6] / REFERENCE, 10 ** wlf(TEMPERATURES[6])
    at = dense.at(TEMPERATURES[6]).creep(np.array([10.0]))
    assert at == pytest.approx(dense.model.creep(np.array([10.0 / a_t])) / b_t, rel=0.02)
    with pytest.raises(dp.FitError, match="no creep compliance"):
        fit_creep(dp.solids.superpose(moduli()))


def test_the_order_of_samples_and_the_unit_change_nothing():
    plain = sweeps()
    order = np.random.default_rng(1).permutation(len(plain.frequency))
    mixed, part = (
        dp.solids.superpose(plain.only(order)),
        dp.solids.superpose(replace(plain, unit="N/m")),
    )
    expected = dp.solids.superpose(plain)
    np.testing.assert_allclose(shifts(mixed), shifts(expected), atol=1e-9)
    np.testing.assert_allclose(shifts(part), shifts(expected), atol=1e-12)
    np.testing.assert_array_equal(mixed.curve.frequency, expected.curve.frequency)


def test_superpose_at_another_reference_shifts_by_a_constant():
    warm, cold = (
        dp.solids.superpose(sweeps(), reference=f"{t}degC", vertical="1") for t in (40, 0)
    )
    difference = shifts(warm) - shifts(cold)
    assert np.ptp(difference) < 1e-3
    assert shifts(warm)[6] == shifts(cold)[2] == 0.0


def test_superpose_of_separate_tests_equals_one_test():
    whole = sweeps()
    parts = []
    for kelvin in TEMPERATURES[::-1]:
        part = whole.only(whole.temperature == kelvin)
        parts.append(replace(part, temperature=None, specimen=Specimen(temperature=kelvin)))
    np.testing.assert_allclose(
        shifts(dp.solids.superpose(parts)), shifts(dp.solids.superpose(whole)), atol=1e-9
    )
    with pytest.raises(dp.FitError, match="test 1 says no temperature"):
        dp.solids.superpose([replace(parts[0], specimen=Specimen()), *parts[1:]])
    with pytest.raises(dp.FitError, match="one kind and one unit"):
        dp.solids.superpose([parts[0], replace(parts[1], unit="N/m")])


def test_the_curve_holds_every_sample_where_it_lies_at_the_reference():
    data = sweeps()
    master_curve = dp.solids.superpose(data)
    item = master_curve.temperature == TEMPERATURES[0]
    shift = master_curve.temperatures.shifts[0]
    np.testing.assert_allclose(
        master_curve.curve.frequency[item], data.frequency[:14] * 10**shift.log10_a_t
    )
    np.testing.assert_allclose(master_curve.curve.storage[item], data.storage[:14] / shift.b_t)
    assert shift.b_t == pytest.approx(TEMPERATURES[0] / REFERENCE)


def test_superpose_uses_stated_shifts_unchanged():
    table = [Shift(t + 0.5, s + 2.0, 0.1) for t, s in zip(TEMPERATURES, TRUE, strict=True)]
    master_curve = dp.solids.superpose(sweeps(rubbery=False), shifts=table)
    np.testing.assert_allclose(shifts(master_curve), TRUE, atol=1e-12)
    assert not master_curve.temperatures.covariance.any()
    assert master_curve.rms == pytest.approx(0.01, rel=0.1)
    with pytest.raises(dp.FitError, match="table of shifts has none within 2 K of 60 degC"):
        dp.solids.superpose(sweeps(), shifts=table[:-1])


@pytest.mark.parametrize(
    ("change", "check"),
    [
        pytest.param(lambda: sweeps(temperatures=TEMPERATURES[::2] - 20), "isotherms_overlap",
            id="apart"),
        pytest.param(lambda: sweeps(temperatures=TEMPERATURES - 25), "shifts_determined", id="ice"),
        pytest.param(lambda: exchange_labels(sweeps()), "shift_monotone", id="exchanged"),
        pytest.param(lambda: sweeps(complexity=0.1), "thermorheologically_simple", id="complex"),
        pytest.param(lambda: sweeps(noise=0.2), "vertical_shift_determined", id="noise"),
    ],
)  # fmt: skip
def test_superpose_checks_detect_invalid_master_curves(change, check):
    assert check in list_failed_checks(dp.solids.superpose(change()))


def exchange_labels(data):
    """The labels of 30 and 40 degC exchanged."""
    t = data.temperature
    warm, hot = np.isclose(t, 303.15), np.isclose(t, 313.15)
    return replace(data, temperature=np.where(warm, 313.15, np.where(hot, 303.15, t)))


def test_a_wrong_temperature_leaves_the_law_and_is_named():
    data = sweeps()
    wrong = np.where(np.isclose(data.temperature, 273.15), 278.15, data.temperature)
    master_curve = dp.solids.superpose(replace(data, temperature=wrong), law="wlf")
    assert "law_follows_shifts" in list_failed_checks(master_curve)
    unasked = dp.solids.superpose(replace(data, temperature=wrong))
    assert unasked.temperatures.law.kind == "free"
    assert "law_follows_shifts" in list_failed_checks(unasked)
    assert "law_follows_shifts" not in list_failed_checks(
        dp.solids.superpose(replace(data, temperature=wrong), law="free")
    )
    assert list_failed_checks(dp.solids.superpose(data)) <= {"isotherms_overlap"}


def test_superpose_passes_all_checks_for_valid_sweeps():
    master_curve = dp.solids.superpose(sweeps(temperatures=TEMPERATURES[1:]))
    assert [check.passed for check in master_curve.checks] == [True] * 9


def test_superpose_reports_a_violated_vertical_rule():
    data = sweeps(rubbery=False)
    softer = np.exp(-0.004 * (data.temperature - REFERENCE))
    other = replace(data, storage=data.storage * softer, loss=data.loss * softer)
    assert "vertical_rule_holds" in list_failed_checks(dp.solids.superpose(other))
    assert "vertical_rule_holds" not in list_failed_checks(dp.solids.superpose(data))


def test_superpose_counts_a_duplicate_sample_once():
    data = sweeps()
    twice = data.only(np.tile(np.arange(len(data.frequency)), 2))
    once, again = dp.solids.superpose(data).temperatures, dp.solids.superpose(twice).temperatures
    np.testing.assert_allclose(again.covariance, once.covariance, rtol=1e-9)


def test_free_vertical_shifts_are_a_diagnostic():
    master_curve = dp.solids.superpose(sweeps(), vertical="free")
    assert "vertical_shift_determined" in list_failed_checks(master_curve)
    assert master_curve.temperatures.shifts[0].b_t_se > 0


def test_what_cannot_be_shifted_is_refused():
    curves = sweeps(temperatures=[REFERENCE])
    with pytest.raises(dp.FitError, match="needs several temperatures"):
        dp.solids.superpose(curves)
    with pytest.raises(dp.FitError, match="says no temperature"):
        dp.solids.superpose(replace(curves, temperature=None))
    with pytest.raises(dp.FitError, match="one value at -20 degC"):
        dp.solids.superpose(sweeps(points=1))
    with pytest.raises(dp.FitError, match="within 2 K of the reference of 15 degC"):
        dp.solids.superpose(sweeps(), reference="15degC")
    with pytest.raises(dp.FitError, match="expected > 0"):
        dp.solids.superpose(replace(sweeps(), storage=-sweeps().storage))
    with pytest.raises(dp.FitError, match="expected one of"):
        dp.solids.superpose(sweeps(), vertical="2")


def test_published_moduli_are_shifted_as_published_and_lie_closer(real_data):
    folder = real_data / "pyvisco-master-curves"
    options = ReadOptions(modulus="E_relax")
    curve = read_modulus(folder / "time_user_raw.csv", options=options)
    published = dp.files.read_shifts(folder / "time_user_raw__shift_factors.csv")
    master_curve = dp.solids.superpose(curve, reference="3degC", vertical="1")
    steps = np.diff(shifts(master_curve)) - np.diff([shift.log10_a_t for shift in published])
    assert np.abs(steps).max() <= 0.3
    assert master_curve.rms <= 0.0065
    assert dp.solids.superpose(curve, reference="3degC", shifts=published).rms > 0.01


def test_a_published_master_curve_is_followed_by_three_times_per_decade(real_data):
    file = real_data / "pyvisco-master-curves" / "ansys-reference" / "freq_raw.input_master.csv"
    frequency, storage, loss = np.loadtxt(file, delimiter=",", skiprows=1, usecols=(0, 1, 2)).T
    curve = split_isotherms(
        dp.DynamicTest(frequency, storage, loss, np.full(len(loss), 300.0), units="SI")
    )
    at = np.zeros(1)
    assert fit_spectrum(curve, at, at, make_grid(curve, at, per_decade=3)).rms <= 0.024


def test_superpose_names_a_temperature_with_another_gain():
    data, at = sweeps(3), TEMPERATURES[7]
    gain = np.where(data.temperature == at, 1.05, 1.0)
    more = replace(data, storage=gain * data.storage, loss=gain * data.loss)
    assert "no_temperature_outlier" not in list_failed_checks(dp.solids.superpose(data))
    message = {check.name: check for check in dp.solids.superpose(more).checks}[
        "no_temperature_outlier"
    ]
    assert message.failed
    assert message.message.startswith("50 degC lies ")


@pytest.mark.slow
def test_twenty_sets_choose_their_vertical_rule_and_cover_the_truth():
    right, errors, inside, laws = 0, [], [], 0
    away = TEMPERATURES != REFERENCE
    for seed in range(20):
        rubbery, law = seed % 2 == 0, (wlf, arrhenius)[seed // 10]
        master_curve = dp.solids.superpose(sweeps(100 + seed, rubbery=rubbery, law=law))
        right += master_curve.temperatures.vertical == ("T/T_r" if rubbery else "1")
        laws += master_curve.temperatures.law.kind == law.__name__
        error = (shifts(master_curve) - law(TEMPERATURES))[away]
        se = np.array([shift.se for shift in master_curve.temperatures.shifts])[away]
        errors.append(error)
        inside.append(np.abs(error) < 1.96 * se)
    assert right >= 19
    assert np.sqrt(np.mean(np.square(errors))) <= 0.05
    assert np.mean(inside) >= 0.9
    assert laws >= 18


def test_band_of_a_master_curve_includes_the_errors_of_its_shifts() -> None:
    frequency = np.array([1e-3, 1.0, 1e3])
    shifts = TemperatureShifts(
        FreeShifts((273.15, 296.15), (3.0, 0.0), 296.15),
        (Shift(273.15, 3.0, 0.2), Shift(296.15, 0.0, 0.0)),
        np.zeros((4, 4)),
        vertical="1",
    )
    solid = GeneralizedMaxwell(1e6, (1e6,), (1e-3,))
    curve = DynamicTest(frequency, np.ones(3), np.ones(3), units="SI")
    superposition = SimpleNamespace(
        curve=curve, temperatures=shifts, temperature=np.array([296.15, 296.15, 273.15])
    )
    errors = MasterCurveErrors(superposition, solid, lambda _: (0.01, 0.02))
    # at the reference there is no shift, and no error of one
    assert errors(1.0) == pytest.approx((0.01, 0.02))
    size, loss_factor = errors(1e3)
    step = 10 ** (1.959964 * 0.2)
    K = [solid.complex_stiffness(omega=2e3 * np.pi * factor) for factor in (1 / step, 1.0, step)]
    ratios = [abs(abs(k) / abs(K[1])) for k in K]
    assert 1 + size == pytest.approx(1.01 * max(*ratios, 1 / min(ratios)), rel=1e-4)
    assert loss_factor > 0.02
