"""Tests at several temperatures, one solid: against seals whose law is known, made apart."""

from __future__ import annotations

from dataclasses import replace
from operator import itemgetter

import numpy as np
import pytest
from kit import cold
from kit.fits import list_failed_checks, restrict_to_noise
from kit.foreign.kinds import wlf
from kit.foreign.rigs import Protocol, read
from kit.foreign.truths import TRUTHS, Solid
from kit.foreign.truths import Seal as ForeignSeal
from kit.slopes import hold_slopes

import dashpot as dp
from dashpot.base.errors import Status
from dashpot.base.option_fields import Vertical
from dashpot.datamodel.bounds import StiffnessBounds
from dashpot.datamodel.fit import get_temperature_law
from dashpot.extensions.curves.temperatures.joint_problem import JointTests, ShiftedSolid
from dashpot.fitting.prediction_bounds import parameter_band, unresolved_arm_band
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.numerics.design_matrices.block import DataBlock, Evaluation
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Climate, Rig
from dashpot.workflow.json_archive import from_json, to_json

AMBIENT, FRIDGE = 23.0, 0.0
STATED_RIG = dp.Machine(sync=1e-3, drift=0.2e-3, compliance=0.0, creep=0.0)
PAIR, TRIPLE = (AMBIENT, FRIDGE), (AMBIENT, 10.0, FRIDGE)


def fit_cold_tests(seal: str, celsius=PAIR, seed: int = 0, *, vertical="free", **changes) -> dp.Fit:
    return fit_tests(cold.records(seal, celsius, seed, **changes), vertical=vertical)


def holds_truth(fit: dp.Fit, seal: str) -> tuple[bool, bool]:
    """Whether storage stiffness and loss factor of the truth are within the fit's errors."""
    band, true = parameter_band(fit, [cold.RESONANCE]), cold.complex_stiffness(seal)
    low, high = band.storage[:, 0]
    least, most = band.loss_factor[:, 0]
    return low <= true.real <= high, least <= true.imag / true.real <= most


def off(fit: dp.Fit, seal: str) -> float:
    """Relative error of the loss factor at the resonance."""
    stiffness = fit.model.complex_stiffness(omega=2 * np.pi * cold.RESONANCE)
    return stiffness.imag / stiffness.real / cold.loss_factor(seal) - 1


@pytest.fixture(scope="module")
def pair() -> dp.Fit:
    return fit_cold_tests("hidden")


@pytest.fixture(scope="module")
def stated_pair() -> dp.Fit:
    """Of the same tests on a machine that is known: no limit doubts it."""
    return fit_tests(prepare_on_stated_machine(cold.records("hidden", PAIR, 0)))


def prepare_on_stated_machine(records: list[dp.RelaxationTest]) -> list[dp.RampHold]:
    return [prepare(record, machine=STATED_RIG) for record in records]


@pytest.fixture(scope="module")
def triple() -> dp.Fit:
    return fit_cold_tests("broad", TRIPLE)


def test_fit_with_a_cold_test_recovers_an_arm_hidden_at_room_temperature(pair):
    fitted_tests = fit_tests(cold.records("hidden", [AMBIENT], 0)[0])
    assert fitted_tests.model.arms == 2
    assert off(fitted_tests, "hidden") < -0.5
    assert pair.model.arms == 3
    assert abs(off(pair, "hidden")) < 0.03
    assert all(holds_truth(pair, "hidden"))
    assert pair.verdict.use == "use"
    assert pair.band[1] > 20 * fitted_tests.band[1]


def test_shift_and_stiffness_are_those_of_the_seal(pair):
    fridge, folder = pair.temperatures.shifts
    assert (fridge.temperature, folder.temperature) == (273.15, 296.15)
    assert (folder.log10_a_t, folder.se, folder.b_t) == (0.0, 0.0, 1.0)
    assert fridge.log10_a_t == pytest.approx(cold.log10_a(273.15), abs=0.01)
    assert fridge.se < 0.005
    assert fridge.b_t == pytest.approx(273.15 / 296.15, abs=3 * fridge.b_t_se)
    assert get_temperature_law(pair).kind == "free"
    chilled = pair.at("0degC").complex_stiffness(omega=2 * np.pi * cold.RESONANCE)
    assert chilled.real == pytest.approx(
        cold.complex_stiffness("hidden", celsius=FRIDGE).real, rel=2e-3
    )


def test_model_at_the_cold_temperature_has_the_error_of_the_cold_test(pair):
    """Relaxation time, shift and slope err together: their product is what the test measured."""
    chilled, quiet = pair.at_temperature("0degC"), restrict_to_noise(pair)
    arm = chilled.estimate.parameters.index("ln_tau_1")
    noise = restrict_to_noise(chilled).covariance
    result, error = np.log(chilled.model.tau[0]), float(np.sqrt(noise[arm, arm]))
    assert error < 0.2 * float(np.sqrt(quiet.covariance[arm, arm]))
    # a rig that may have given or settled adds to either, and each is distinguished from the noise
    np.testing.assert_array_equal(noise, quiet.at_temperature("0degC").covariance)
    assert float(np.sqrt(chilled.covariance[arm, arm])) > 2 * error
    true = np.log(0.0125) + np.log(10) * cold.log10_a(273.15)
    assert abs(result - true) < 3 * error < 0.05


def test_fit_without_intervals_equals_the_full_fit(pair):
    records = cold.records("hidden", PAIR, 0)
    point = fit_tests(records, arms=3, intervals=False)
    assert np.allclose(point.model.k, pair.model.k, rtol=1e-9)
    assert point.temperatures.shifts[0].log10_a_t == pytest.approx(
        pair.temperatures.shifts[0].log10_a_t, abs=1e-9
    )
    assert {check.name for check in point.checks} == {"uncertainty_estimated"}
    assert (
        point.temperatures.shifts[0].se
        == point.at_temperature("0degC").standard_error["k_inf"]
        == np.inf
    )
    assert from_json(to_json(point)) == point


def test_fit_of_two_temperatures_recommends_a_third(pair, triple):
    message = {check.name: check for check in pair.checks}["shifts_distinguished"]
    assert message.failed
    assert "three are needed" in message.message
    assert "shifts_distinguished" not in list_failed_checks(triple)


def test_three_temperatures_carry_a_law(triple):
    law = get_temperature_law(triple)
    assert law.kind == "wlf"
    at, error = law.log10_a_t(263.15), triple.temperatures.error(263.15)[0] / np.log(10)
    assert abs(at - cold.log10_a(263.15)) < 3 * error < 0.1
    assert triple.verdict.use == "use"
    assert abs(off(triple, "broad")) < 0.04


@pytest.mark.parametrize("wrong", [5.0, -5.0])
def test_a_temperature_that_was_noted_wrong_is_no_law(wrong):
    tests = cold.records("hidden", TRIPLE, 0)
    noted = dp.Specimen(temperature=tests[-1].specimen.temperature + wrong)
    fitted_tests = fit_tests([*tests[:-1], replace(tests[-1], specimen=noted)])
    assert fitted_tests.verdict.use == "use with care"
    assert list_failed_checks(fitted_tests) == {
        "glass_below_tests" if wrong > 0 else "law_follows_shifts"
    }


@pytest.mark.parametrize("vertical", ["free", "1"])
@pytest.mark.parametrize("arms", [0, 1, 3])
def test_the_slopes_of_shifted_tests_are_those_of_their_rows(vertical: Vertical, arms: int) -> None:
    """In a made-up block: an arm's column is the logarithm's cosine."""
    at = np.linspace(0.0, 3.0, 7)

    def rows(log_tau: np.ndarray, derivative: bool) -> Evaluation:
        column = np.cos(at[:, None] + log_tau)
        return Evaluation(at, np.ones((7, 1)), column, -np.sin(at[:, None] + log_tau))

    block = DataBlock(rows, ("k_inf",), (1e-3, 1e3), 7, floor=2.0)
    warm = np.array([273.15, 283.15, 296.15])
    joint = JointTests([block] * 4, np.array([2, 0, 1, 0]), warm, 2, vertical, slope_sd=0.3)
    log_a, log_b = np.array([1.5, 0.7, 0.0]), np.array([-0.1, 0.05, 0.0])
    tau = np.array([-1.0, 0.5, 2.0])[:arms]
    point = ShiftedSolid(3.0, np.array([2.0, 1.0, 0.5])[:arms], tau, log_a, log_b, 0.1 * (arms > 1))
    problem = joint.problem(point)
    theta = joint.theta(point)
    assert len(theta) == len(problem.parameters) == len(joint.names(arms)) - 1 - arms
    hold_slopes(problem, theta, point.stiffnesses)


LINES = np.array([0.01, 0.1, 1.0, 5.0, cold.RESONANCE, 50.0])


def check_bounds(seal: str, bounds: StiffnessBounds) -> np.ndarray:
    """Whether storage and loss of the truth lie within the bounds, line by line, shape (2, n)."""
    true = np.array([cold.complex_stiffness(seal, f) for f in LINES])
    return np.array(
        [
            (low <= part) & (part <= high)
            for (low, high), part in ((bounds.storage, true.real), (bounds.loss, true.imag))
        ]
    )


def test_cold_test_narrows_the_unresolved_arm_band(pair, stated_pair):
    records = cold.records("hidden", PAIR, 0)
    both = unresolved_arm_band(pair, records, LINES)
    stiffness_bounds = unresolved_arm_band(fit_tests(records[0]), records[0], LINES)
    assert check_bounds("hidden", both).all()
    at = list(LINES).index(cold.RESONANCE)
    low, high = both.loss[:, at] / cold.complex_stiffness("hidden").imag
    assert 0.9 < low < 1 < high < 1.4
    assert high > 1.2  # a machine of which nothing is known may hide as much
    expected = unresolved_arm_band(
        stated_pair, prepare_on_stated_machine(records), [cold.RESONANCE]
    )
    low, high = expected.loss[:, 0] / cold.complex_stiffness("hidden").imag
    assert 0.9 < low < 1 < high < 1.2
    assert np.ptp(stiffness_bounds.loss[:, at]) > 10 * np.ptp(both.loss[:, at])


@pytest.mark.once
def test_quasi_random_starts_find_the_same_solid():
    records = cold.records("hidden", PAIR, 0)
    plain, thorough = (
        fit_tests(records, arms=3, intervals=False, thorough=more) for more in (False, True)
    )
    assert thorough.model.tau == pytest.approx(plain.model.tau, rel=1e-4)
    assert thorough.model.tau != plain.model.tau
    assert dict(thorough.steps[-1].parameters)["thorough"] == "true"


def test_records_that_were_not_fitted_bound_nothing(pair):
    warm = cold.a_test("hidden", AMBIENT, 0)
    with pytest.raises(dp.DataError, match="a record has none"):
        unresolved_arm_band(pair, replace(warm, specimen=dp.Specimen()), LINES)
    with pytest.raises(dp.DataError, match="10 degC, and no test of the fit is"):
        unresolved_arm_band(pair, cold.a_test("hidden", 10.0, 0), LINES)


def test_limits_at_the_end_of_the_hold_have_the_expected_width(pair, stated_pair):
    k_inf, k, tau = cold.HIDDEN
    end = k_inf + np.sum(np.array(k) * np.exp(-40 / np.array(tau)))
    for result, least, most in ((pair, 1.03, 1.06), (stated_pair, 1.005, 1.02)):
        low, high = result.stiffness_limits["k_end"]
        assert low < end < high
        assert least * low < high < most * low


def test_the_order_of_the_files_does_not_matter(pair):
    warm, chilled = cold.records("hidden", PAIR, 0)
    swapped = fit_tests([chilled, warm])
    assert swapped.model.tau == pytest.approx(pair.model.tau, rel=1e-4)
    assert swapped.temperatures.shifts[0].log10_a_t == pytest.approx(
        pair.temperatures.shifts[0].log10_a_t, abs=1e-5
    )
    names = {nuisance.name for nuisance in swapped.estimate.nuisance}
    assert {"delay of test 1", "warming of test 2", "shift slope"} <= names


@pytest.mark.parametrize(
    ("seal", "celsius", "vertical", "changes"),
    [
        ("hidden", PAIR, "1", {}),
        ("broad", PAIR, "T/T_r", {"stiffer": 1.03}),
        ("broad", TRIPLE, "free", {"apart": cold.fast_arms_less}),
        ("hidden", TRIPLE, "free", {"apart": cold.fast_arms_less}),
    ],
    ids=["b is 1", "b 3 % off", "arms in groups", "a hidden arm apart"],
)
def test_fit_reports_tests_that_share_no_model(seal, celsius, vertical, changes):
    fit = fit_cold_tests(seal, celsius, vertical=vertical, **changes)
    assert "thermorheologically_simple" in list_failed_checks(fit)
    assert fit.verdict.use != "use"
    assert fit.status is Status.TESTS_DISAGREE


def test_fit_reports_a_small_shift_slope_without_penalty():
    fit = fit_cold_tests("hidden", TRIPLE, shift_factor=cold.make_growing_shift(0.03))
    slope = next(item for item in fit.estimate.nuisance if item.name == "shift slope")
    assert abs(slope.value - 0.03) < 3 * slope.standard_error < 0.03
    assert "thermorheologically_simple" not in list_failed_checks(fit)
    assert all(holds_truth(fit, "hidden"))


def test_fit_distinguishes_warming_from_another_shift():
    fit = fit_cold_tests("hidden", warms=0.5)
    warming = [item for item in fit.estimate.nuisance if item.name.startswith("warming")]
    chilled = next(item for item in warming if item.name.endswith("2"))
    assert abs(chilled.value - 0.5) < 4 * chilled.standard_error < 0.2
    assert abs(off(fit, "hidden")) < 0.03
    assert "temperature_steady" not in list_failed_checks(fit)
    assert "temperature_steady" in list_failed_checks(fit_cold_tests("hidden", warms=2.0))


def test_fit_reports_temperatures_without_overlap():
    assert "isotherms_overlap" in list_failed_checks(fit_cold_tests("hidden", (AMBIENT, -20.0)))


def test_fit_of_tests_at_one_temperature_has_no_shifts():
    warm, again = (cold.a_test("hidden", AMBIENT, seed) for seed in (0, 1))
    other = replace(again, specimen=dp.Specimen(temperature=296.15 + 0.4))
    fitted_tests = fit_tests([warm, other])
    assert fitted_tests.temperatures is None
    assert fitted_tests.model == fit_tests([warm, again]).model


def test_fit_shares_the_shift_of_tests_at_one_temperature():
    tests = [*cold.records("hidden", PAIR, 0), cold.a_test("hidden", FRIDGE, 5)]
    fitted_tests = fit_tests(tests)
    assert len(fitted_tests.temperatures.shifts) == 2
    assert abs(off(fitted_tests, "hidden")) < 0.03
    assert fitted_tests.temperatures.shifts[0].log10_a_t == pytest.approx(
        cold.log10_a(273.15), abs=0.01
    )


def test_fit_asks_for_a_missing_temperature():
    warm, chilled = cold.records("hidden", PAIR, 0)
    nameless = replace(cold.a_test("hidden", 10.0, 0), specimen=dp.Specimen())
    with pytest.raises(dp.FitError, match="test 2 of 3 has no temperature"):
        fit_tests([warm, nameless, chilled])
    with pytest.raises(dp.FitError, match="test 2 of 2 has no temperature, where test 1 is of 0"):
        fit_tests([chilled, nameless])


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"reference": 293.15}, "--reference"),
        ({"shift_law": "wlf", "vertical": "1"}, "--shift and --vertical"),
    ],
)
def test_fit_of_one_temperature_refuses_shift_options(options, named: str):
    warm = cold.a_test("hidden", AMBIENT, 0)
    for test in (warm, replace(warm, specimen=dp.Specimen())):
        with pytest.raises(dp.FitError, match=f"leave out {named}"):
            fit_tests(test, **options)
    # what is said and so needs no choice
    assert fit_tests(warm, reference=296.15, arms=2, intervals=False).temperatures is None


@pytest.mark.parametrize("options", [{"method": "hold"}, {"family": "fractional"}])
def test_what_knows_of_no_temperature_is_refused(options):
    with pytest.raises(dp.FitError, match="several temperatures"):
        fit_tests(cold.records("hidden", PAIR, 0), **options)


@pytest.mark.slow
def test_twenty_pairs_find_the_shift_and_the_damping():
    """Broad and hidden-arm seals at 23 and 0 degC, delay and hum on."""
    shift, damping, holds, within = [], [], [], []
    for seal in cold.SEALS:
        for seed in range(10):
            records = [prepare(record) for record in cold.records(seal, PAIR, seed)]
            fitted_tests = fit_tests(records)
            within.append(check_bounds(seal, unresolved_arm_band(fitted_tests, records, LINES)))
            shift.append(abs(fitted_tests.temperatures.shifts[0].log10_a_t - cold.log10_a(273.15)))
            damping.append(abs(off(fitted_tests, seal)))
            holds.append(holds_truth(fitted_tests, seal))
    assert np.sum(np.array(shift) < 0.01) >= 19
    assert np.sum(np.array(damping) < 0.03) == 20
    assert (np.sum(holds, axis=0) >= 18).all()
    assert (np.sum(within, axis=0) >= 18).all()


def foreign_pair(truth: Solid, seed: int = 1) -> dp.Fit:
    """At 23 and 0 degC by a WLF law with b_T = T/T_r: a truth and a rig that are not ours."""
    tests = []
    for celsius in PAIR:
        kelvin = celsius + 273.15
        a_t, b_t = 10 ** wlf(kelvin, 296.15, 8.86, 150.0), kelvin / 296.15
        k, tau = b_t * np.array(truth.k), a_t * np.array(truth.tau)
        seal = ForeignSeal(Solid.arms(truth.name, b_t * truth.k_inf, k, tau))
        record = read(seal, Protocol(hold=80.0), seed=seed, name=f"{truth.name} | {celsius:g}")
        piece = dp.Specimen(temperature=kelvin)
        columns = (record.time, record.displacement, record.force)
        tests.append(prepare(dp.RelaxationTest(*columns, piece, units="SI")))
    return fit_tests(tests)


@pytest.mark.slow
def test_two_temperatures_tell_the_damping_of_foreign_arms():
    """Twenty truths of two to five arms, the fastest of 3 to 180 ms."""
    arms = [truth for truth in TRUTHS if truth.name == "broad" or truth.name[:6] in {
        "2 arms", "3 arms", "4 arms", "5 arms"}][:20]  # fmt: skip
    omega = 2 * np.pi * cold.RESONANCE
    assert len(arms) == 20
    away, held = [], []
    for arm in arms:
        fit, K = foreign_pair(arm), arm.stiffness(omega)
        away.append(fit.model.loss_factor(omega=omega) * K.real / K.imag - 1)
        low, high = parameter_band(fit, [cold.RESONANCE]).loss_factor[:, 0]
        held.append(low <= K.imag / K.real <= high)
    # of two truths the interval itself is 3 to 10 % wide
    assert np.sum(np.abs(away) < 0.03) >= 18
    assert np.sum(held) >= 19


@pytest.mark.slow
def test_two_temperatures_of_a_power_law_are_used_with_care():
    for truth in TRUTHS:
        if truth.name.startswith(("springpot", "power law", "fractional")):
            assert foreign_pair(truth).verdict.use != "use", truth.name


@pytest.mark.slow
def test_counts_that_beat_with_the_samples_are_within_the_bounds():
    """Rigs of 500 Hz and 20 um: each motion meets the counts elsewhere."""
    k_inf, k, tau = cold.BROAD
    solid = dp.GeneralizedMaxwell(
        k_inf, *zip(*sorted(zip(k, tau, strict=True), key=itemgetter(1)), strict=True)
    )
    inside = []
    for seed in range(20):
        random = np.random.default_rng(seed)
        ramp = 1 + 0.05 * random.uniform(-1, 1)
        tests = []
        for i, celsius in enumerate(PAIR):
            gap, baseline = 20e-6 * random.uniform(), 1.5 + 0.01 * random.uniform()
            rig = Rig(rate=500.0, encoder=20e-6, gap=gap, baseline=baseline)
            climate = Climate(celsius + 273.15)
            made = simulate_relaxation(
                solid, ramp_time=ramp, rig=rig, seed=1000 * seed + i, climate=climate
            )
            tests.append(made.test)
        inside.append(check_bounds("broad", unresolved_arm_band(fit_tests(tests), tests, LINES)))
    assert np.mean(inside, axis=0).min() >= 0.85
    assert np.mean(inside) >= 0.94
