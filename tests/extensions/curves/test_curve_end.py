"""Limits at the end of a modulus, a compliance and a sweep, over every spectrum."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.curve_ends import Score, evaluate_curve
from kit.foreign.curves import compliances, crept, moduli, sweeps
from kit.foreign.truths import Solid

import dashpot as dp
from dashpot.datamodel.fit import list_model_values
from dashpot.extensions.curves.curve_uncertainty import weight_curve
from dashpot.extensions.curves.modulus.fit import fit_modulus
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.workflow.json_archive import from_json, to_json

T = np.geomspace(1e-2, 100.0, 81)
ZENER = GeneralizedMaxwell(1e6, (1e6,), (1.0,))


def curve(solid: GeneralizedMaxwell, t: np.ndarray = T, noise: float = 5e-3, seed: int = 0):
    error = noise * np.random.default_rng(seed).standard_normal(len(t))
    return dp.RelaxationModulus(t, solid.relaxation(t) * (1 + error), units="SI")


def test_foreign_creep_compliance_agrees_with_the_closed_form() -> None:
    """The foreign compliance against the closed form of one arm."""
    k_inf, k, tau = 2.0, 3.0, 4.0
    t = np.array([0.1, 1.0, 30.0])
    zener = Solid.arms("", k_inf, (k,), (tau,))
    late = tau * (k_inf + k) / k_inf
    wanted = 1 / k_inf - (1 / k_inf - 1 / (k_inf + k)) * np.exp(-t / late)
    np.testing.assert_allclose(crept(zener, t), wanted, rtol=1e-12)


def test_a_curve_that_levels_off_keeps_its_plateau() -> None:
    fit = fit_modulus(curve(ZENER))
    end = fit.evidence.end_of_hold
    assert end is not None
    assert (end.test_kind, end.end_time) == ("curve", 100.0)
    low, high = end.k_10end
    assert 0.8e6 < low < 1e6 < high < 1.02e6
    assert fit.verdict.use == "use"
    assert fit.intervals()["k_inf"] == (0.0, end.k_inf[1])
    assert list_model_values(fit)[0].words == "k(100 s)"
    assert list_model_values(fit)[0].unit == "Pa"
    assert from_json(to_json(fit)) == fit


def test_fit_modulus_reports_a_missing_plateau_with_valid_limits() -> None:
    """An arm ten times slower than the end is a spring to it."""
    slow = GeneralizedMaxwell(1e6, (1e6, 5e5), (1.0, 300.0))
    fit = fit_modulus(curve(slow, T[T < 30]))
    assert fit.verdict.use == "use with care"
    assert fit.verdict.failed_checks[0].name == "plateau_determined"
    end = fit.evidence.end_of_hold
    assert end is not None
    for name, times in (("k_end", 1), ("k_3end", 3), ("k_10end", 10), ("k_inf", np.inf)):
        low, high = getattr(end, name)
        assert low <= slow.relaxation(times * end.end_time) <= high
    assert fit.model.k_inf > 1.1 * slow.k_inf


def test_a_curve_that_falls_tells_how_many_times_as_stiff_it_was() -> None:
    """1 + 9 exp(-t / 50) is 10 at first and 2.218 at 100."""
    fit = fit_modulus(curve(GeneralizedMaxwell(1e6, (9e6,), (50.0,)), noise=1e-3))
    message = next(check.message for check in fit.checks if check.name == "curve_level_at_end")
    assert float(message.split("At first it was ")[1].split()[0]) == pytest.approx(4.508, abs=0.02)


def test_what_neighbours_have_in_common_is_doubted_though_no_residual_shows_it() -> None:
    """Without scatter the limits are those of .2 % in each quarter decade."""
    exact = fit_modulus(curve(ZENER, noise=0.0)).evidence.end_of_hold
    assert exact is not None
    assert 1e-4 < np.ptp(exact.k_end) / 1e6 < 1e-2
    rough = fit_modulus(curve(ZENER, noise=2e-2)).evidence.end_of_hold
    assert rough is not None
    assert np.ptp(rough.k_end) > 2 * np.ptp(exact.k_end)


def test_the_noise_of_a_curve_is_what_the_nearest_spectrum_leaves() -> None:
    values = curve(ZENER, noise=1e-2).modulus
    block = build_hold_block(T, values, weights=1 / ZENER.relaxation(T), compress=False)
    data = weight_curve(block, T, window=(1e-3, 1e3), common_error=0.0)
    rows = data.rows(np.log([1.0]), with_slopes=False)
    residual = rows.target - np.column_stack((rows.spring, rows.arms)) @ [1e6, 1e6]
    assert np.sqrt(np.mean(residual**2)) == pytest.approx(1.0, rel=0.15)
    assert 40 < data.dof < 80


def test_part_of_a_material_scales_its_limits() -> None:
    fit = fit_modulus(curve(ZENER))
    part = fit.part(0.02)
    assert part.stiffness_limits is not None
    assert fit.stiffness_limits is not None
    assert part.stiffness_limits["k_end"] == tuple(
        0.02 * end for end in fit.stiffness_limits["k_end"]
    )
    assert part.evidence.end_of_hold.format_with_remedy(part.unit).startswith(
        "the stiffness later on. At 100 s it is"
    )
    assert fit.evidence.end_of_hold.format_with_remedy("Pa").endswith("MPa. Measure longer.")


def test_a_sweep_tells_its_storage_in_hertz() -> None:
    f = np.geomspace(1e-3, 10, 41)
    value = ZENER.complex_stiffness(omega=2 * np.pi * f)
    fit = dp.fit(dp.DynamicTest(f, value.real, value.imag, units="SI"))
    end = fit.evidence.end_of_hold
    assert end is not None
    assert list_model_values(fit)[0].words == "K'(0.00100 Hz)"
    assert end.k_end[0] < value.real[0] < end.k_end[1]
    assert "At 0.00100 Hz the storage is" in end.format_limits("Pa")
    assert (
        replace(end, test_kind="creep")
        .format_limits("Pa")
        .startswith("At 159 s stress over strain is")
    )


def test_fit_modulus_of_few_values_limits_the_end_where_they_show_scatter() -> None:
    end = fit_modulus(curve(ZENER, T[::12]), arms=1).evidence.end_of_hold
    assert end is not None
    assert end.k_end[0] < ZENER.relaxation(end.end_time) < end.k_end[1]


@pytest.mark.parametrize(("times", "share"), [(5, 0.5), (16, 0.5), (20, 0.35), (20, 0.5)])
def test_what_seems_to_flow_may_rest_long_after_a_creep_test(times: float, share: float) -> None:
    """A retardation of so many holds is a flow to it: at rest a part is no softer than so."""
    time, glass = np.arange(5401) / 100.0, 1 / 400.0
    parts = (0.3 * glass, 3.0), (share * glass, 50.0 * times)

    def integrate_compliance(t: np.ndarray) -> np.ndarray:
        t = np.maximum(t, 0.0)
        creeping = sum(size * (t + late * np.expm1(-t / late)) for size, late in parts)
        return glass * t + creeping

    ramps = integrate_compliance(time - 4.0) - integrate_compliance(time - 4.2)
    random = np.random.default_rng(3)
    fit = dp.fit(
        dp.CreepTest(
            time=time,
            displacement=1.5 / 0.2 * ramps + 1e-6 * random.standard_normal(len(time)),
            force=1.5 * np.clip((time - 4.0) / 0.2, 0, 1)
            + 2e-3 * random.standard_normal(len(time)),
            units="SI",
        )
    )
    end = fit.evidence.end_of_hold
    assert end is not None
    assert 1 / ((1.3 + share) * glass) < end.k_inf[1]


def test_values_that_some_spectrum_follows_exactly_are_too_few() -> None:
    """Nine values of a power law: as many parameters are as good as any."""
    solid, t = Solid.power_law("", 1e6, 2e6, 0.05, 0.3), np.geomspace(0.1, 1000.0, 9)
    error = 5e-3 * np.random.default_rng(3).standard_normal(9)
    fit = fit_modulus(t, np.array([solid.relaxation(time) for time in t]) * (1 + error))
    assert fit.evidence.end_of_hold is None
    assert fit.verdict.use == "use with care"
    assert "values_enough" in [check.name for check in fit.verdict.failed_checks]
    assert from_json(to_json(fit)) == fit


@pytest.mark.parametrize("count", [4, 5, 6, 7])
def test_a_sweep_of_few_lines_claims_no_more_than_it_knows(count: int) -> None:
    for seed in range(6):
        random = np.random.default_rng([count, seed])
        solid = Solid.power_law(
            "", 1e6, random.uniform(0.3, 2) * 1e6, 1e-4, random.uniform(0.1, 0.5)
        )
        if seed % 2:
            tau = 10.0 ** random.uniform(-3, 1, 5)
            solid = Solid.arms("", 1e6, random.uniform(0.05, 0.6, 5) * 1e6, tau)
        f = np.geomspace(0.1, 10.0 ** random.uniform(0.5, 2), count)
        value = np.array([solid.stiffness(2 * np.pi * line) for line in f])
        storage, loss = 1 + 0.01 * random.standard_normal((2, count))
        fit = dp.fit(dp.DynamicTest(f, value.real * storage, value.imag * loss, units="SI"))
        if fit.verdict.use != "use":
            continue
        stiffness, loss_factor = fit.evidence.band_error.max_errors
        lines = np.geomspace(*fit.band, 9)
        wanted = np.array([solid.stiffness(2 * np.pi * line) for line in lines])
        result = fit.model.complex_stiffness(omega=2 * np.pi * lines)
        ratio = (result.imag / result.real) / (wanted.imag / wanted.real)
        assert np.abs(np.abs(result) / np.abs(wanted) - 1).max() <= stiffness
        assert np.abs(ratio - 1).max() <= loss_factor


# -- how often ------------------------------------------------------------------------------------


def require_score(score: Score, *, intact: float = 0.6) -> None:
    assert min(score.held.values()) >= 0.95, score
    assert score.used_off <= 0.05 * score.used, score
    assert score.faultless_used >= intact * score.faultless, score


def test_limits_hold_on_a_few_curves_of_every_kind() -> None:
    some = [
        evaluate_curve(item)
        for make, chosen in ((moduli, (1, 7, 9)), (compliances, (3, 9)), (sweeps, (1, 9)))
        for i, item in enumerate(make(10))
        if i in chosen
    ]
    require_score(Score.of(some), intact=0.5)
    assert any(line["use"] == "use" for line in some)
    assert any("plateau_determined" in line["reason"] for line in some)


@pytest.mark.slow
@pytest.mark.parametrize(("make", "count"), [(moduli, 300), (compliances, 100), (sweeps, 100)])
def test_limits_hold_and_use_is_right(make, count) -> None:
    require_score(Score.of(map(evaluate_curve, make(count, 1))))


@pytest.mark.slow
def test_a_curve_cut_to_its_first_tenth_holds_what_came_later() -> None:
    for make in (moduli, compliances, sweeps):
        cut = [item.cut() for item in make(60, 2)]
        score = Score.of(evaluate_curve(item) for item in cut if len(item.at) >= 12)
        assert min(score.held.values()) >= 0.95, score
        assert score.used_off <= max(0.05 * score.used, 1), score
