"""Dynamic sweeps to a solid, alone and together with ramp and hold."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kit.fits import list_failed_checks

from dashpot.base.errors import DataError, FitError, Status
from dashpot.datamodel.relaxation import RampHold
from dashpot.extensions.curves.checks import kramers_kronig
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.dynamic.fit import fit_dynamic
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.extensions.curves.relaxation_spectrum import compute_passive_misfit
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import BROAD
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.workflow.json_archive import from_json, to_json

ZENER = GeneralizedMaxwell(1000.0, (500.0,), (0.01,))
WIDE = np.geomspace(0.1, 1000.0, 40)


def sweep(
    model: GeneralizedMaxwell,
    frequency: np.ndarray = WIDE,
    *,
    noise: float = 0.0,
    seed: int = 0,
    unit: str = "N/m",
) -> DynamicTest:
    """Storage and loss with errors relative to each."""
    value = model.complex_stiffness(omega=2 * np.pi * frequency)
    item, two = 1 + noise * np.random.default_rng(seed).standard_normal((2, len(frequency)))
    return DynamicTest(frequency, value.real * item, value.imag * two, unit=unit, units="SI")


def ramp_hold(model: GeneralizedMaxwell, *, noise: float, seed: int = 0) -> RampHold:
    """1 s to 8 mm, 40 s of hold, 100 Hz."""
    t = np.arange(4101) / 100.0
    force = model.ramp_hold_force(t, depth=8e-3, ramp_time=1.0)
    return RampHold(
        time=t,
        displacement=8e-3 * np.clip(t, 0.0, 1.0),
        force=force + noise * np.random.default_rng(seed).standard_normal(len(t)),
        onset=0.0,
        ramp_end=1.0,
        hold_end=41.0,
        depth=8e-3,
        force_noise=noise,
    )


def same(model: GeneralizedMaxwell, wanted: GeneralizedMaxwell, rel: float) -> None:
    assert model.arms == wanted.arms
    assert model.k_inf == pytest.approx(wanted.k_inf, rel=rel, abs=rel * sum(wanted.k))
    assert model.k == pytest.approx(wanted.k, rel=rel)
    assert model.tau == pytest.approx(wanted.tau, rel=rel)


# -- exact answers and laws -----------------------------------------------------------------------


def test_a_zener_solid_comes_back_exactly() -> None:
    result = fit_dynamic(sweep(ZENER))
    same(result.model, ZENER, 1e-9)
    assert result.status is Status.CONVERGED
    assert not list_failed_checks(result)
    assert result.band == pytest.approx((0.1, 1000.0))
    assert (result.method, result.unit) == ("dynamic", "N/m")
    assert from_json(to_json(result)) == result


def test_the_paper_seal_comes_back_exactly(paper_seal: GeneralizedMaxwell) -> None:
    result = fit_dynamic(sweep(paper_seal, np.geomspace(1e-3, 10, 60)))
    same(result.model, paper_seal, 1e-9)


def test_fit_dynamic_reports_a_missing_plateau_of_a_liquid() -> None:
    liquid = GeneralizedMaxwell(0.0, (1e6, 2e5), (0.01, 1.0))
    result = fit_dynamic(sweep(liquid, np.geomspace(0.01, 1000, 60), unit="Pa"))
    same(result.model, liquid, 1e-9)
    assert result.model.k_inf < 1e-6
    assert list_failed_checks(result) == {"plateau_seen"}


def test_a_spring_has_no_arm() -> None:
    result = fit_dynamic(sweep(GeneralizedMaxwell(1000.0)))
    assert result.model.arms == 0
    assert result.model.k_inf == pytest.approx(1000.0)


def test_fit_dynamic_recovers_a_parallel_dashpot_on_request() -> None:
    voigt = replace(ZENER, b=0.1)
    result = fit_dynamic(sweep(voigt), dashpot=True)
    same(result.model, voigt, 1e-8)
    assert result.model.b == pytest.approx(0.1, rel=1e-8)
    assert result.estimate.parameters[-1] == "b"


@given(
    st.lists(st.floats(0.3, 3.0), min_size=1, max_size=3),
    st.floats(0.0, 3.0),
    st.sampled_from([1.0, 1e3, 1e9]),
    st.sampled_from(["relative", "modulus"]),
)
@settings(max_examples=15, deadline=None)
def test_fit_dynamic_recovers_arms_spaced_by_a_decade_in_any_unit(
    k: list[float], k_inf: float, unit: float, weights: str
) -> None:
    solid = GeneralizedMaxwell(k_inf, tuple(k), tuple(10.0 ** (i - 2) for i in range(len(k))))
    data = sweep(unit * solid, np.geomspace(0.01, 100, 50), unit="Pa")
    result = fit_dynamic(data, weights=weights, max_arms=4)  # type: ignore[arg-type]
    same(result.model, unit * solid, 1e-5)


@given(st.permutations(range(40)))
@settings(max_examples=5, deadline=None)
def test_the_order_of_the_frequencies_does_not_matter(order: list[int]) -> None:
    data = sweep(ZENER, noise=0.01)
    mixed = DynamicTest(
        data.frequency[order],
        data.storage[order],
        data.loss[order],
        unit=data.unit,
        units="SI",
    )
    item, other = fit_dynamic(data, arms=1), fit_dynamic(mixed, arms=1)
    same(other.model, item.model, 1e-12)


def test_newtons_and_pascals_give_the_same_numbers() -> None:
    item, two = (fit_dynamic(sweep(ZENER, noise=0.01, unit=unit)) for unit in ("N/m", "Pa"))
    assert item.model == two.model
    np.testing.assert_array_equal(item.covariance, two.covariance)


def test_the_optimum_is_that_of_scipy_on_the_same_residuals() -> None:
    from scipy.optimize import least_squares

    data = sweep(ZENER, noise=0.02, seed=4)
    result = fit_dynamic(data, arms=1, max_arms=1)
    value = result.model.complex_stiffness(omega=data.omega)
    # relative to what the fit expects, storage and loss each by its own scatter
    individual = np.sqrt(np.mean((value.real - data.storage) ** 2 / value.real**2))
    its = np.sqrt(np.mean((value.imag - data.loss) ** 2 / value.imag**2))
    scale = np.concatenate((individual * value.real, its * value.imag))

    def compute_residual(p: np.ndarray) -> np.ndarray:
        at = GeneralizedMaxwell(p[0], (p[1],), (p[2],)).complex_stiffness(omega=data.omega)
        error = np.concatenate((at.real - data.storage, at.imag - data.loss))
        return np.asarray(error / scale)

    ours = np.array((result.model.k_inf, *result.model.k, *result.model.tau))
    rival = least_squares(compute_residual, (900.0, 400.0, 0.02), x_scale="jac")
    assert 0.5 * np.sum(compute_residual(ours) ** 2) == pytest.approx(rival.cost, rel=1e-3)
    assert ours == pytest.approx(rival.x, rel=2e-3)


# -- uncertainty ----------------------------------------------------------------------------------


def count_covered(seeds: range) -> np.ndarray:
    """How often the 95 % intervals of a Zener solid hold the truth: k_inf, k, tau."""
    held = np.zeros(3)
    for seed in seeds:
        result = fit_dynamic(sweep(ZENER, noise=0.01, seed=seed), arms=1)
        intervals = result.intervals(level=0.95)
        pairs = zip(
            (intervals["k_inf"], *intervals["k"], *intervals["tau"]),
            (1000.0, 500.0, 0.01),
            strict=True,
        )
        held += [low <= truth <= high for (low, high), truth in pairs]
    return held / len(seeds)


def test_intervals_hold_the_truth() -> None:
    assert (count_covered(range(40)) >= 0.85).all()


@pytest.mark.slow
def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    share = count_covered(range(1000))
    assert (share >= 0.93).all()
    # of k_inf the most is known, and nothing below it
    assert (share[1:] <= 0.995).all()


def test_large_noise_brings_no_bias() -> None:
    """Weights by the size of the data themselves would lower every stiffness by 2 %."""
    result = [fit_dynamic(sweep(ZENER, noise=0.1, seed=s), arms=1).model.k_0 for s in range(60)]
    assert np.mean(result) == pytest.approx(ZENER.k_0, rel=0.006)


def test_noise_brings_no_further_arm() -> None:
    orders = [
        fit_dynamic(sweep(ZENER, noise=0.02, seed=s), max_arms=3).model.arms for s in range(9)
    ]
    assert orders == [1] * 9


# -- with relaxation ------------------------------------------------------------------------------


def test_joint_fit_of_sweep_and_hold_recovers_arms_of_both_bands() -> None:
    """Three fast arms show only in the sweep, the slow one only in the hold."""
    data = sweep(BROAD, np.geomspace(1.0, 50.0, 30), noise=0.005, seed=1)
    held = ramp_hold(BROAD, noise=0.002, seed=2)
    joint = fit_dynamic(data, tests=held)
    assert joint.status is Status.CONVERGED
    assert not list_failed_checks(joint) - {"order_agreed"}
    assert joint.model.arms == BROAD.arms
    assert joint.model.tau == pytest.approx(BROAD.tau, rel=0.15)
    assert joint.model.k == pytest.approx(BROAD.k, rel=0.08)
    assert joint.band[0] < 0.01
    assert joint.band[1] == pytest.approx(50.0)
    omega = 2 * np.pi * np.geomspace(0.004, 50.0, 60)

    def compute_largest_error(model: GeneralizedMaxwell) -> float:
        return float(np.abs(model.loss(omega=omega) / BROAD.loss(omega=omega) - 1).max())

    assert compute_largest_error(joint.model) < 0.05
    assert compute_largest_error(fit_dynamic(data).model) > 0.3
    assert compute_largest_error(fit(held).model) > 0.3


def test_a_raw_record_of_the_rig_and_a_sweep_are_fitted_together() -> None:
    held = prepare(simulate_relaxation(BROAD, seed=1).test)
    result = fit_dynamic(sweep(BROAD, np.geomspace(1.0, 50.0, 30), noise=0.005, seed=1), tests=held)
    assert result.ok
    assert result.model.arms == BROAD.arms
    omega = 2 * np.pi * np.geomspace(0.004, 50.0, 60)
    assert np.abs(result.model.loss(omega=omega) / BROAD.loss(omega=omega) - 1).max() < 0.06
    message = result.intervals(level=0.99)["tau"]
    assert all(low < tau < high for (low, high), tau in zip(message, BROAD.tau, strict=True))


def test_fit_dynamic_reports_offset_and_drift_of_each_test() -> None:
    held = ramp_hold(ZENER, noise=1e-3)
    other = ramp_hold(ZENER, noise=1e-3, seed=7)
    shifted = replace(other, force=other.force + 0.5)
    result = fit_dynamic(sweep(ZENER, noise=0.01), tests=[held, shifted], arms=1)
    values = {item.name: item for item in result.estimate.nuisance}
    assert set(values) == {f"{kind} of test {i}" for kind in ("offset", "drift") for i in (1, 2)}
    assert values["offset of test 2"].value == pytest.approx(0.5, abs=2e-3)
    assert values["offset of test 1"].value == pytest.approx(0.0, abs=2e-3)


def test_fit_dynamic_reports_two_different_specimens() -> None:
    result = fit_dynamic(
        sweep(1.3 * ZENER, noise=0.005), tests=ramp_hold(ZENER, noise=1e-3), max_arms=3
    )
    check = next(check for check in result.checks if check.name == "data_agree")
    assert check.failed
    assert "The tests contradict each other" in check.message


def test_a_fit_that_spends_freedom_on_few_lines_leaves_no_more_than_their_scatter() -> None:
    """Up to thirteen parameters for 32 values: the sound pair agrees, 5 % of stiffness does not."""
    lines, two = np.geomspace(0.1, 30.0, 16), GeneralizedMaxwell(200.0, (80.0, 60.0), (0.03, 3.0))
    for seed in range(4):
        held = ramp_hold(two, noise=2e-3, seed=seed)
        for factor, agrees in ((1.0, True), (1.05, False)):
            result = fit_dynamic(sweep(factor * two, lines, noise=0.01, seed=seed), tests=held)
            assert ("data_agree" not in list_failed_checks(result)) == agrees


def test_fit_dynamic_with_a_relaxation_test_states_the_error_of_every_spectrum() -> None:
    """The covariance of the arms that were found misses most of the error at the end of a hold."""
    fastest, slowest = 2 * np.pi * 50.0, 1e6
    tau = tuple(np.geomspace(0.1 / fastest, slowest, 60).tolist())
    for seed, power in enumerate((0.1, 0.2, 0.3)):
        model = GeneralizedMaxwell(150.0, tuple(15.0 * np.asarray(tau) ** -power), tau)
        data = sweep(model, np.geomspace(0.1, 50.0, 12), noise=0.01, seed=seed)
        result = fit_dynamic(data, tests=ramp_hold(model, noise=3e-3, seed=seed))
        lines = np.geomspace(*result.band, 15)
        stiffness, loss_factor = result.evidence.band_error.max_errors
        K, wanted = (
            solid.complex_stiffness(omega=2 * np.pi * lines) for solid in (result.model, model)
        )
        ratio = (K.imag / K.real) / (wanted.imag / wanted.real)
        assert np.abs(np.abs(K) / np.abs(wanted) - 1).max() <= stiffness
        assert 0.02 < np.abs(ratio - 1).max() <= loss_factor <= 0.3
        end = result.evidence.end_of_hold
        assert end.k_end[0] < model.relaxation(end.end_time) < end.k_end[1]
        assert model.k_inf < result.intervals()["k_inf"][1]
        assert from_json(to_json(result)) == result


def test_fit_dynamic_accepts_five_lines_with_a_relaxation_test() -> None:
    lines, two = np.geomspace(0.1, 50.0, 5), GeneralizedMaxwell(200.0, (80.0, 60.0), (0.03, 3.0))
    for seed in range(6):
        held = ramp_hold(two, noise=2e-3, seed=seed)
        for factor, agrees in ((1.0, True), (1.3, False)):
            result = fit_dynamic(sweep(factor * two, lines, noise=0.01, seed=seed), tests=held)
            if agrees:
                assert "data_agree" not in list_failed_checks(result)
            else:
                assert result.verdict.use != "use"


def test_fit_dynamic_weighs_a_sweep_of_few_lines_by_its_scatter() -> None:
    """As many arms as nine lines allow follow them: their scatter seemed none, and they ruled."""
    tau, failed = (0.003, 0.015, 0.075, 0.5, 16.4), 0
    five = GeneralizedMaxwell(200.0, (20.0, 20.0, 20.0, 120.0, 18.0), tau)
    for seed in range(6):
        data = sweep(five, np.geomspace(0.01, 100.0, 9), noise=0.005, seed=seed)
        result = fit_dynamic(data, tests=ramp_hold(five, noise=3e-3, seed=seed))
        assert result.verdict.use != "do not use"
        failed += "data_agree" in list_failed_checks(result)
    assert failed <= 1


def test_fit_dynamic_reports_a_gap_between_bands() -> None:
    data = sweep(ZENER, np.geomspace(100.0, 1000.0, 20), noise=0.01)
    result = fit_dynamic(data, tests=ramp_hold(ZENER, noise=1e-3), arms=1)
    assert "bands_overlap" in list_failed_checks(result)
    assert result.band == pytest.approx((100.0, 1000.0))


# -- what the data confess ------------------------------------------------------------------------


@pytest.mark.parametrize("noise", [0.0, 0.03, 0.15])
def test_kramers_and_kronig_pass_what_is_passive_and_noisy(noise: float) -> None:
    tau = np.geomspace(1e-4, 10, 6)
    for slope in (0.05, 0.1, 0.2):
        solid = GeneralizedMaxwell(100.0, tuple(100 * tau**-slope), tuple(tau))
        for seed in range(10):
            check = kramers_kronig(compute_passive_misfit(sweep(solid, noise=noise, seed=seed)))
            assert check.passed, check.message


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_kramers_kronig_check_detects_an_inconsistent_loss(factor: float) -> None:
    data = sweep(ZENER)
    result = fit_dynamic(replace(data, loss=factor * data.loss), arms=1)
    check = next(check for check in result.checks if check.name == "kramers_kronig")
    assert check.failed
    assert check.value is not None
    assert check.value > 0.05
    assert "Storage and loss contradict each other (Kramers-Kronig)" in check.message


def test_storage_check_detects_moving_mass() -> None:
    data = sweep(ZENER)
    result = fit_dynamic(replace(data, storage=data.storage - 1e-5 * data.omega**2), arms=1)
    check = next(check for check in result.checks if check.name == "storage_rises")
    assert check.failed
    assert "% at 1000 Hz. No relaxing part does that: mass moved along" in check.message


def test_fit_dynamic_reports_amplitude_dependence() -> None:
    # three frequencies show so little of a third arm that nothing but rounding is left of it
    frequency = np.repeat([1.0, 5.0, 20.0], 12)
    variant, s = np.tile(np.geomspace(1e-3, 0.3, 12), 3), 2j * np.pi * frequency
    value = 2e5 + 5e4 * s * 0.01 / (1 + s * 0.01) + 3e4 * s * 0.1 / (1 + s * 0.1)
    value += (8e4 + 4e4j * variant**0.6) / (1 + variant**1.2)
    result = fit_dynamic(DynamicTest(frequency, value.real, value.imag, None, "N/m", units="SI"))
    assert result.verdict.use == "use with care"
    assert result.verdict.failed_checks[0].name == "kramers_kronig"


def test_loss_check_detects_the_wrong_sign() -> None:
    data = sweep(ZENER)
    result = fit_dynamic(replace(data, loss=-data.loss))
    message = next(check.message for check in result.checks if check.name == "loss_positive")
    assert "40 of 40 losses are below zero beyond scatter, the first at 0.1 Hz" in message
    assert result.verdict.use == "do not use"
    half = fit_dynamic(replace(data, loss=np.where(np.arange(40) < 20, -1, 1) * data.loss))
    (check,) = [check for check in half.checks if check.name == "loss_positive"]
    assert check.grade == "limit"


def test_fit_dynamic_reports_an_arm_outside_the_sweep() -> None:
    slow = GeneralizedMaxwell(1000.0, (500.0,), (3.0,))
    result = fit_dynamic(sweep(slow, np.geomspace(1.0, 50.0, 30)), arms=1)
    assert result.status is Status.TAU_AT_BOUND
    message = next(check.message for check in result.checks if check.name == "tau_inside_window")
    assert "Only the tail of this arm was measured" in message


# -- what is refused ------------------------------------------------------------------------------


def test_fit_dynamic_asks_which_of_several_temperatures() -> None:
    data = sweep(ZENER)
    hot = replace(data, temperature=np.where(data.frequency > 10, 350.0, 300.0))
    with pytest.raises(
        DataError, match=r"no sample within 1 K of 46\.85 degC; the test has 27 degC, 77"
    ):
        fit_dynamic(hot, temperature=320.0)
    with pytest.raises(DataError, match="the test has no temperatures"):
        fit_dynamic(data, temperature=320.0)
    result = fit_dynamic(hot, temperature=300.0)
    assert result.band[1] <= 10.0
    same(result.model, ZENER, 1e-6)


def test_what_makes_no_sense_is_refused() -> None:
    data, held = sweep(ZENER), ramp_hold(ZENER, noise=0.0)
    with pytest.raises(FitError, match="the sweep is in Pa, the relaxation tests in N and m"):
        fit_dynamic(sweep(ZENER, unit="Pa"), tests=held)
    with pytest.raises(FitError, match="a parallel dashpot is fitted to a sweep alone"):
        fit_dynamic(data, tests=held, dashpot=True)
    with pytest.raises(FitError, match="relaxation tests, prepared or as read, found a float"):
        fit_dynamic(data, tests=[1.0])  # type: ignore[list-item]
    with pytest.raises(FitError, match="weights = 'equal'; expected one of relative, modulus"):
        fit_dynamic(data, weights="equal")  # type: ignore[arg-type]
    with pytest.raises(FitError, match=r'arms = 1\.5; expected "auto" or a whole number'):
        fit_dynamic(data, arms=1.5)  # type: ignore[arg-type]
    with pytest.raises(FitError, match="max_arms = -1; expected a whole number"):
        fit_dynamic(data, max_arms=-1)
    with pytest.raises(FitError, match=r"the storage at 1e\+03 Hz is -\d.* leave it out"):
        fit_dynamic(replace(data, storage=data.storage - 5e-5 * data.omega**2 * (WIDE > 900)))
    with pytest.raises(FitError, match="2 samples cannot determine 3 parameters"):
        fit_dynamic(sweep(ZENER, np.array([10.0])), arms=1)


# -- real data ------------------------------------------------------------------------------------


def test_fit_dynamic_fits_one_isotherm_of_a_real_machine(real_data: Path) -> None:
    data = read_dynamic(real_data / "pyvisco-master-curves" / "freq_user_raw.csv")
    result = fit_dynamic(data, temperature=343.0)
    value = result.model.complex_stiffness(omega=2 * np.pi * data.frequency)
    assert data.temperature is not None
    near = np.abs(data.temperature - 343.0) <= 1.0
    assert np.abs(value.real / data.storage - 1)[near].max() < 0.05
    assert np.abs(value.imag / data.loss - 1)[near].max() < 0.1
    assert result.unit == "Pa"
    assert result.model.k_0 > 1e8


def test_kramers_kronig_check_detects_an_inconsistent_master_curve(real_data: Path) -> None:
    data = read_dynamic(real_data / "pyvisco-master-curves" / "freq_user_master.csv")
    assert "kramers_kronig" in list_failed_checks(fit_dynamic(data, arms=3))


def test_fit_dynamic_uses_a_dense_spectrum_for_a_broad_material() -> None:
    """Twenty decades of equal arms: six cannot follow, so a table is given and called one."""
    many = GeneralizedMaxwell(1e6, (1e6,) * 20, tuple(10.0**n for n in range(-10, 10)))
    frequency = np.geomspace(1e-11, 1e10, 150)
    K = many.complex_stiffness(omega=2 * np.pi * frequency)
    result = fit_dynamic(DynamicTest(frequency, K.real, K.imag, units="SI"))
    check = next(check for check in result.checks if check.name == "few_arms_sufficient")
    assert check.failed
    assert result.status is Status.NOT_IDENTIFIED
    assert result.model.arms > 6
    np.testing.assert_allclose(
        result.model.complex_stiffness(omega=2 * np.pi * frequency), K, rtol=0.02
    )
    assert result.standard_error["k_inf"] == np.inf
    few = fit_dynamic(DynamicTest(frequency, K.real, K.imag, units="SI"), arms=3)
    assert few.model.arms == 3
