"""Creep: the force is given, the displacement answers; laws, the paper's seal, then noise."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kit import cold
from kit.fits import formal_errors

import dashpot as dp
from dashpot.base.errors import DataError, FitError
from dashpot.extensions.curves.creep.compliance import measured_compliance
from dashpot.extensions.curves.creep.fit import estimate_preload_baseline
from dashpot.extensions.curves.creep.fit import fit_creep as fit
from dashpot.extensions.curves.creep.load_noise import load_sensitivity
from dashpot.extensions.curves.creep.preprocess import load_hold
from dashpot.extensions.curves.creep.read import read_creep
from dashpot.extensions.curves.creep.retardation_spectrum import compute_relaxation_sensitivity
from dashpot.extensions.curves.datamodel.creep import CreepCompliance, CreepTest
from dashpot.reading.readers.inspect import inspect_file
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.interconversion import CreepSpectrum, relaxation_spectrum
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.networks import creep_of, from_creep
from dashpot.workflow import fit_files
from dashpot.workflow.json_archive import from_json, to_json

T1 = creep_of(PAPER)


def compute_ramp_creep(
    time: np.ndarray, creep: CreepSpectrum = T1, *, rise: float = 1.0
) -> np.ndarray:
    """Displacement under a force of 1 N reached in `rise` from t = 0, in closed form, m."""

    def integral(t: np.ndarray) -> np.ndarray:
        t = np.maximum(t, 0)[:, None]
        lam, d = np.array(creep.lam), np.array(creep.d)
        slow = (t + lam * np.expm1(-t / lam)) @ d
        return creep.glass * t[:, 0] + creep.flow * t[:, 0] ** 2 / 2 + slow

    return (integral(time) - integral(time - rise)) / rise


CLOCK = np.arange(-1.5, 40.0, 0.01)
LOAD = np.clip(CLOCK, 0, 1)


def record(creep: CreepSpectrum = T1, *, noise: float = 0.0, force_noise: float = 0.0,
           seed: int = 0, clock: np.ndarray = CLOCK) -> CreepTest:  # fmt: skip
    random = np.random.default_rng(seed)
    x = compute_ramp_creep(clock, creep) + noise * random.standard_normal(len(clock))
    force = np.clip(clock, 0, 1) + force_noise * random.standard_normal(len(clock))
    return CreepTest(clock, x, force, units="SI")


def test_the_papers_seal_creeps_as_its_reference_says() -> None:
    at = compute_ramp_creep(np.array([0.5, 1, 2, 5, 41]))
    expected = [1.725238e-3, 3.743264e-3, 4.433572e-3, 4.744189e-3, 5.043470e-3]
    assert at == pytest.approx(expected, rel=1e-6)
    assert PAPER.displacement(CLOCK, LOAD) == pytest.approx(compute_ramp_creep(CLOCK), abs=1e-12)


def test_displacement_is_the_inverse_of_force() -> None:
    x = compute_ramp_creep(CLOCK)
    assert PAPER.force(CLOCK, PAPER.displacement(CLOCK, LOAD)) == pytest.approx(LOAD, abs=2e-3)
    assert PAPER.displacement(CLOCK, PAPER.force(CLOCK, x)) == pytest.approx(x, abs=2e-5)


def test_without_noise_the_fit_is_the_seal_to_rounding() -> None:
    result = fit(record())
    assert result.ok
    assert result.method == "creep"
    assert result.evidence.creep is not None
    spectrum = result.evidence.creep.spectrum
    assert spectrum.lam == pytest.approx((0.776312, 17.928823), rel=1e-6)
    assert spectrum.d == pytest.approx((1.638841e-3, 0.436354e-3), rel=1e-6)
    assert spectrum.glass == pytest.approx(3.013864e-3, rel=1e-6)
    assert spectrum.equilibrium == pytest.approx(5.089059e-3, rel=1e-6)
    assert result.model.k_inf == pytest.approx(PAPER.k_inf, rel=1e-9)
    assert result.model.k == pytest.approx(PAPER.k, rel=1e-9)
    assert result.model.tau == pytest.approx(PAPER.tau, rel=1e-9)


@pytest.mark.parametrize(
    "creep",
    [T1, CreepSpectrum(2e-3, (1e-3, 4e-4), (0.3, 8.0), 3e-5), CreepSpectrum(0.0, (1e-3,), (2.0,))],
    ids=["solid", "flows", "dashpot"],
)
def test_the_sensitivity_is_the_derivative_of_the_interconversion(creep: CreepSpectrum) -> None:
    def solid(values: np.ndarray) -> np.ndarray:
        n = len(creep.d)
        k_inf, k, tau, b = relaxation_spectrum(
            CreepSpectrum(values[0], tuple(values[1 : 1 + n]),
                          tuple(np.exp(values[1 + n : -1])), values[-1])
        )  # fmt: skip
        return np.array([k_inf, *k, *np.log(tau), b])

    at = np.array([creep.glass, *creep.d, *np.log(creep.lam), creep.flow])
    expected = compute_relaxation_sensitivity(creep, relaxation_spectrum(creep)[2])
    for i, value in enumerate(at):
        if value == 0:  # beyond it lies another kind of solid
            continue
        step = np.zeros(len(at))
        step[i] = 1e-6 * abs(value)
        slope = (solid(at + step) - solid(at - step)) / (2 * step[i])
        assert expected[:, i] == pytest.approx(slope, rel=1e-5, abs=1e-6 * np.abs(slope).max())


@pytest.mark.parametrize(("length", "knows"), [(0.6, False), (4.0, True)])
def test_baseline_that_shows_the_slope_within_the_usual_drift_knows_it(
    length: float, knows: bool
) -> None:
    """The standard error of a slope over n white samples in T is noise sqrt(12/n)/T."""
    noise, step = 2e-6, 0.01
    clock = np.arange(-length, 40.0, step)
    slope_error = noise * np.sqrt(12 * step / length) / length
    baseline = estimate_preload_baseline(load_hold(record(noise=noise, clock=clock)))
    assert bool(slope_error < 0.9 * baseline.default_drift) is knows
    assert bool(baseline.has_measured_drift) is knows


def test_creep_fit_reports_flow() -> None:
    fluid = CreepSpectrum(2e-3, (1e-3,), (0.8,), 4e-5)
    result = fit(record(fluid, noise=1e-6))
    assert result.evidence.creep is not None
    assert result.evidence.creep.spectrum.flow == pytest.approx(4e-5, rel=1e-2)
    assert result.model.k_inf == 0
    assert result.model.arms == 2
    checks = {check.name: check for check in result.checks}
    assert checks["flow_distinguished"].passed
    assert "The part flows" in checks["creep_finished"].message
    assert "plateau_determined" not in checks
    assert result.stiffness_limits is not None
    low, high = result.stiffness_limits["k_end"]
    assert low < 1 / float(fluid.compliance(result.evidence.end_of_hold.end_time)) < high
    assert "k_inf" not in result.estimate.parameters


def test_a_solid_cut_short_says_that_its_end_is_open() -> None:
    slow = CreepSpectrum(2e-3, (1e-3, 2e-3), (0.8, 60.0))
    result = fit(record(slow, noise=1e-6))
    checks = {check.name: check for check in result.checks}
    assert checks["creep_finished"].failed or checks["flow_distinguished"].failed
    assert result.verdict.use != "use"


def test_a_step_at_the_first_sample_needs_no_baseline() -> None:
    time = np.arange(0.0, 40.0, 0.01)
    result = fit(CreepTest(time, T1.compliance(time), np.ones(len(time)), units="SI"))
    assert result.model.k == pytest.approx(PAPER.k, rel=1e-6)
    checks = {check.name: check for check in result.checks}
    assert checks["load_begins_at_rest"].failed


def test_creep_fit_includes_recovery() -> None:
    time = np.arange(-1.5, 60.0, 0.01)
    load = np.interp(time, [0, 1, 30, 31], [0, 1, 1, 0])
    x = compute_ramp_creep(time) - compute_ramp_creep(time - 30)
    random = np.random.default_rng(0)
    result = fit(CreepTest(time, x + 2e-6 * random.standard_normal(len(x)), load, units="SI"))
    assert result.model.tau == pytest.approx(PAPER.tau, rel=5e-3)
    assert result.verdict.use == "use"


@pytest.mark.parametrize(("sign", "shift"), [(1, 0.0), (-1, 0.0), (-1, 12e-3), (1, -3e-3)])
def test_signs_and_zeros_do_not_matter(sign: int, shift: float) -> None:
    test = record()
    turned = CreepTest(
        test.time, sign * test.displacement + shift, -sign * test.force - 0.3, units="SI"
    )
    result = fit(turned)
    assert result.model.k_inf == pytest.approx(PAPER.k_inf, rel=1e-6)
    assert load_hold(turned).preload == pytest.approx(0.3 * sign)


def test_creep_proportionality_is_checked_between_load_levels() -> None:
    time = np.arange(-1.5, 90.0, 0.01)
    load = np.interp(time, [0, 1, 30, 31, 60, 61], [0, 0.5, 0.5, 1, 1, 1.5])
    straight = 0.5 * (
        compute_ramp_creep(time) + compute_ramp_creep(time - 30) + compute_ramp_creep(time - 60)
    )
    random = np.random.default_rng(0)
    for bend, failed in ((0.0, False), (0.1, True)):
        x = straight * (1 - bend * straight / straight.max())
        result = fit(
            CreepTest(time, x + 2e-6 * random.standard_normal(len(x)), load, units="SI"), arms=2
        )
        (check,) = [check for check in result.checks if check.name == "levels_agree"]
        assert check.failed == failed, check.message


def test_a_compliance_is_fitted_as_the_curve_it_is() -> None:
    time = np.geomspace(0.01, 200, 120)
    material = GeneralizedMaxwell(2e5, (3e5, 1e5), (0.05, 4.0))
    curve = CreepCompliance(time, material.creep(time), units="SI")
    result = fit(curve)
    assert result.unit == "Pa"
    assert result.model.k == pytest.approx(material.k, rel=1e-6)
    assert result.model.tau == pytest.approx(material.tau, rel=1e-6)
    of_part = CreepCompliance(time, material.creep(time), "m/N", units="SI")
    assert fit(of_part).unit == "N/m"
    with pytest.raises(DataError, match="the compliance falls with time"):
        fit(CreepCompliance(time, material.relaxation(time), units="SI"))


def test_a_material_is_fitted_by_its_stress_and_strain() -> None:
    test = record()
    result = fit(CreepTest(test.time, test.displacement, test.force, "Pa", units="SI"))
    assert result.unit == "Pa"
    assert result.estimate.residual.unit == "1"
    assert result.model.k == pytest.approx(PAPER.k, rel=1e-9)


def test_arms_are_those_of_the_solid() -> None:
    assert fit(record(), arms=2).model.arms == 2
    assert fit(record(), arms=0).model.arms == 0
    flowing = fit(record(CreepSpectrum(2e-3, (1e-3,), (0.8,), 4e-5)), arms=2)
    assert flowing.model.arms == 2


def test_what_makes_no_sense_is_refused() -> None:
    for choice in ({"method": "hold"}, {"elastic": "nonlinear"}, {"model": "fractional"}):
        with pytest.raises(FitError, match="linear model with arms: leave out --method"):
            dp.fit(record(), **choice)
    with pytest.raises(FitError, match=r"shifted to no other: leave out --reference"):
        dp.fit(record(), reference="0degC")
    noise = np.random.default_rng(0).standard_normal((2, 500))
    with pytest.raises(DataError, match="no force is held"):
        fit(CreepTest(np.arange(500.0), 1e-3 * noise[0], noise[1], units="SI"))


def test_creep_fit_round_trips_through_json() -> None:
    result = fit(record(noise=1e-6))
    again = from_json(to_json(result))
    assert again == result
    assert again.evidence.creep == result.evidence.creep
    for value in (
        record(),
        load_hold(record()),
        CreepCompliance([1.0, 2.0], [1.0, 2.0], units="SI"),
    ):
        assert from_json(to_json(value)) == value


CASES = {
    "straight": lambda t: np.clip(t, 0, 1),
    "hunts": lambda t: np.clip(t, 0, 1) + 0.02 * (t > 1) * np.sin(4.4 * (t - 1)),
    "recovers": lambda t: np.interp(t, [0, 1, 25, 26], [0, 1, 1, 0]),
}


@pytest.mark.parametrize("case", CASES)
def test_noise_of_the_load_is_in_the_errors(case: str) -> None:
    off = []
    for seed in range(8):
        random, load = np.random.default_rng(seed), CASES[case](CLOCK)
        x = PAPER.displacement(CLOCK, load) + 5e-6 * random.standard_normal(len(CLOCK))
        noisy = load + 4e-3 * random.standard_normal(len(CLOCK))
        result = fit(CreepTest(CLOCK, x, noisy, units="SI"))
        assert result.model.arms == 2
        expected = formal_errors(result)
        off.append([
            (result.model.k_inf - PAPER.k_inf) / expected["k_inf"],
            *(np.subtract(result.model.k, PAPER.k) / expected["k"]),
            *(np.subtract(result.model.tau, PAPER.tau) / expected["tau"]),
        ])  # fmt: skip
    assert np.abs(off).max() < 4
    assert (np.sqrt(np.mean(np.square(off), axis=0)) < 1.7).all()


def test_a_straight_load_has_the_corners_of_its_ramp() -> None:
    straight = load_hold(record(force_noise=4e-3))
    assert len(straight.corners) == 4
    assert straight.corners[1:3] == pytest.approx((0.0, 1.0), abs=5e-3)
    assert straight.resolution == 0
    hunting = CASES["hunts"](CLOCK) + 4e-3 * np.random.default_rng(0).standard_normal(len(CLOCK))
    freed = load_hold(CreepTest(CLOCK, PAPER.displacement(CLOCK, LOAD), hunting, units="SI"))
    assert freed.resolution > 0
    assert np.std(freed.load - CASES["hunts"](CLOCK)) < 3e-3


def test_load_sensitivity_is_the_transpose_of_the_response() -> None:
    """The transpose of the response, against the response itself."""
    random = np.random.default_rng(0)
    time = np.cumsum(random.uniform(0.5, 1.5, 40))
    columns = random.standard_normal((40, 3))
    for creep in (T1, CreepSpectrum(2e-3, (1e-3,), (5.0,), 1e-3)):
        solid = from_creep(creep)
        answers = np.stack([solid.displacement(time, item) for item in np.eye(40)], axis=1)
        assert load_sensitivity(columns, time, creep) == pytest.approx(
            answers.T @ columns, abs=1e-15
        )


@pytest.mark.slow
def test_intervals_cover_the_truth() -> None:
    inside = []
    for seed in range(100):
        test = record(noise=5e-6, force_noise=4e-3, seed=seed)
        between = fit(test, arms=2).intervals()
        truths = (PAPER.k_inf, *PAPER.k, *PAPER.tau)
        ends = (between["k_inf"], *between["k"], *between["tau"])
        inside.append(
            [low <= truth <= high for truth, (low, high) in zip(truths, ends, strict=True)]
        )
    assert (np.mean(inside, axis=0) >= 0.9).all()


@pytest.mark.parametrize(("variant", "fails"), [(0.0097, False), (0.0103, True)])
def test_creep_check_detects_motion_before_the_load(variant: float, fails: bool) -> None:
    x = compute_ramp_creep(CLOCK)
    # the medians of the first and the last third lie 1 s apart
    rate = variant * float(x.max()) / (1 - 1.5 * variant)
    result = fit(CreepTest(CLOCK, x + rate * np.minimum(CLOCK, 0), LOAD, units="SI"))
    (check,) = [check for check in result.checks if check.name == "load_begins_at_rest"]
    assert check.failed is fails
    assert "% of the travel" in check.message


def test_a_curve_called_by_its_symbol_and_unit_is_a_compliance(tmp_path: Path) -> None:
    time = np.geomspace(0.01, 100, 40)
    rows = "".join(f"{t:.6g},{j:.6g}\n" for t, j in zip(time, T1.compliance(time), strict=True))
    (tmp_path / "curve.csv").write_text("time [s],J(t) [1/Pa]\n" + rows)
    assert inspect_file(tmp_path / "curve.csv").kind == "creep"
    assert isinstance(read_creep(tmp_path / "curve.csv"), dp.CreepCompliance)


def make_creep_test(celsius: float, *, noise: float = 1e-6) -> CreepTest:
    """The paper's seal as it creeps at another temperature, its clock and its size known."""
    kelvin = celsius + 273.15
    a_t, b_t = 10 ** cold.log10_a(kelvin), kelvin / cold.REFERENCE
    there = CreepSpectrum(
        T1.glass / b_t, tuple(d / b_t for d in T1.d), tuple(a_t * lam for lam in T1.lam)
    )
    return replace(
        record(there, noise=noise, seed=round(celsius)), specimen=dp.Specimen(temperature=kelvin)
    )


def test_a_test_measures_the_compliance_that_a_step_would_have_shown() -> None:
    """Also in the cold, where slow creep looks like a drift of the reading."""
    for celsius in (23.0, 0.0):
        creep_compliance = measured_compliance(make_creep_test(celsius))
        kelvin = celsius + 273.15
        reduced = creep_compliance.time / 10 ** cold.log10_a(kelvin)
        expected = T1.compliance(reduced) * cold.REFERENCE / kelvin
        np.testing.assert_allclose(creep_compliance.compliance, expected, rtol=2e-3)
        assert creep_compliance.unit == "m/N"
    short = make_creep_test(23.0)
    mask = short.time < 2.0
    cut = CreepTest(short.time[mask], short.displacement[mask], short.force[mask], units="SI")
    with pytest.raises(FitError, match="hold longer"):
        measured_compliance(cut)


@pytest.mark.once
def test_creep_tests_at_several_temperatures_share_one_model(tmp_path: Path) -> None:
    files, temperatures = [], (23.0, 10.0, 0.0)
    for celsius in temperatures:
        test = make_creep_test(celsius)
        files.append(tmp_path / f"{celsius:g}.csv")
        columns = np.column_stack((test.time, 1e3 * test.displacement, test.force))
        head = "time [s],displacement [mm],force [N]"
        np.savetxt(files[-1], columns, delimiter=",", header=head, comments="")
    kelvin = [temperature + 273.15 for temperature in temperatures]
    result, (curve,) = fit_files(files, temperatures=kelvin)
    assert isinstance(curve, dp.solids.Superposition)
    for shift in result.temperatures.shifts:
        assert shift.log10_a_t == pytest.approx(cold.log10_a(shift.temperature), abs=0.01)
    assert result.temperatures.vertical == "T/T_r"
    assert result.model.k == pytest.approx(PAPER.k, rel=0.02)
    assert result.model.tau == pytest.approx(PAPER.tau, rel=0.02)
    with pytest.raises(FitError, match="says no temperature"):
        fit_files(files)
