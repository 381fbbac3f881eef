"""The point from the quiet rig, every limit from the doubtful one."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from kit.fits import solid_intervals
from kit.foreign.catalogue import protocol_of, verdict_records
from kit.foreign.rigs import RIGS, Record, read
from kit.foreign.truths import TRUTHS, Seal

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.fit import Fit, list_model_values
from dashpot.datamodel.machine import DEFAULT_UNCERTAINTIES, Machine
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.fitting.admissible_spectra import compute_end_limits
from dashpot.fitting.nonlinear_ramp.checks import MAX_DELAY_SD, MAX_JOINT_DELAY_SD, clocks_agree
from dashpot.fitting.nuisance_priors import build_load_cell_priors, build_nuisance_terms
from dashpot.fitting.prediction_bounds import frf_band
from dashpot.fitting.relaxation import fit
from dashpot.fitting.relaxation_likelihood import (
    build_relaxation_data,
    compute_unmeasured_effects,
    select_motion_samples,
)
from dashpot.numerics.design_matrices.displacement_correlation import upper_factor
from dashpot.numerics.design_matrices.recorded_motion import build_recorded_block
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.maxwell import GeneralizedMaxwell

STATED_RIG = Machine(sync=1e-3, drift=2e-5, compliance=0.0, creep=0.0, rest=1e5)


@pytest.fixture(scope="module")
def record() -> RampHold:
    """Of a plate whose reading stands still in the hold."""
    return prepare(simulate_relaxation(PAPER, seed=1).test)


@cache
def foreign(truth: int, rig: str) -> tuple[Record, RampHold, Fit]:
    item = next(verdict_records([TRUTHS[truth]], [rig], 0))
    test = RelaxationTest(item.time, item.displacement, item.force, units="SI")
    record = prepare(test, machine=Machine(**item.machine_options))
    return item, record, fit(record)


def width(result: Fit) -> float:
    """Of k(T), N/m."""
    assert result.evidence.end_of_hold is not None
    low, high = result.evidence.end_of_hold.k_end
    return high - low


# -- parameters ------------------------------------------------------------------------------------


def test_hold_fit_includes_clock_differences_in_its_errors() -> None:
    """A hold that begins late by d has arms of k e^(d/tau); nothing of it shows d."""
    errors = {}
    for sync in (5e-3, 20e-3):
        record = prepare(simulate_relaxation(PAPER, seed=1).test, machine=Machine(sync=sync))
        result = fit(record, arms=2, method="hold")
        errors[sync] = {
            name: fact.error for fact in list_model_values(result) if (name := fact.name)
        }
        (message,) = [check for check in result.checks if check.name == "arms_supported"]
        errors[sync]["told"] = message.value
        slope = np.asarray(result.model.k) / np.asarray(result.model.tau)
    # what decides over arms judges by the noise
    assert errors[5e-3]["told"] == errors[20e-3]["told"]
    for name, by in (("k_1", slope[0]), ("k_2", slope[1])):
        more = errors[20e-3][name] ** 2 - errors[5e-3][name] ** 2
        assert more == pytest.approx(by**2 * (20e-3**2 - 5e-3**2), rel=1e-6)
    assert errors[20e-3]["tau_1"] == errors[5e-3]["tau_1"]


def test_a_profile_bears_it_as_well() -> None:
    """Of noise so large that the interval of an arm is its profile's."""
    test = simulate_relaxation(PAPER, seed=1).test
    noise = np.random.default_rng(1).normal(0.0, 0.05, len(test.force))
    ends, errors = [], []
    for sync in (5e-3, 2.0):
        record = prepare(replace(test, force=test.force + noise), machine=Machine(sync=sync))
        result = fit(record, arms=2, method="hold")
        assert "k_2" in {profile.parameter for profile in result.estimate.profiles}
        (fact,) = [value for value in list_model_values(result) if value.name == "k_2"]
        ends.append(fact.high - fact.low)
        errors.append(fact.error)
    assert errors[1] > 1.15 * errors[0]
    assert ends[1] / ends[0] == pytest.approx(errors[1] / errors[0], rel=0.15)


@pytest.mark.parametrize(
    "rig", ["compliance 50 um/N", "crosshead creep 20 um", "seal warms .12 decade"]
)
def test_intervals_of_arms_include_rig_errors(rig: str) -> None:
    """Of two arms as Table 1 has them; the errors of the noise alone know nothing of it."""
    item, record, _ = foreign(0, rig)
    result = fit(record, arms=2)
    truth = {
        f"{name}_{j}": value
        for j, (k, tau) in enumerate(zip(item.seal.solid.k, item.seal.solid.tau, strict=True), 1)
        for name, value in (("k", k), ("tau", tau), ("b", k * tau))
    }
    facts = {fact.name: fact for fact in list_model_values(result)}
    assert all(facts[name].low < value < facts[name].high for name, value in truth.items())
    quiet = result.estimate.noise_only.confidence_limits(result.solid, 0.95)
    missed = [name for name, value in truth.items() if not quiet[name][0] < value < quiet[name][1]]
    assert len(missed) >= 3
    # a stiffness of which nothing is known would be held as well
    assert facts["k_1"].high - facts["k_1"].low < 0.15 * truth["k_1"]


@pytest.mark.parametrize("method", ["full", "hold"])
def test_a_named_rig_leaves_little_but_the_noise(record: RampHold, method: str) -> None:
    named = replace(
        record,
        machine=Machine(sync=1e-3, drift=1e-6, compliance=0.0, creep=0.0, rest=1e5),
        specimen=replace(record.specimen, warmed=0.0),
    )
    unknown, expected = (fit(item, arms=2, method=method) for item in (record, named))
    wide, narrow = (item.standard_error for item in (unknown, expected))
    quiet = expected.estimate.noise_only.standard_errors(expected.model)
    for name in ("k", "tau", "b"):
        for j in range(2):
            assert quiet[name][j] <= narrow[name][j]
            assert narrow[name][j] < 0.6 * wide[name][j]


def test_each_doubt_moves_the_fit_as_far_as_a_record_that_has_it(record: RampHold) -> None:
    """A force added for one standard deviation, and fitted again."""
    result = fit(record, arms=2)
    names = {"give", "settling", "warming"}
    time = record.time - record.time[0]
    unmeasured_effects = compute_unmeasured_effects(record, time, record.displacement, result.model)
    assert names <= set(unmeasured_effects)
    covariance = result.estimate.covariance - result.estimate.noise_only.covariance
    total = np.zeros_like(covariance)
    here = np.array([result.model.k_inf, *result.model.k, *np.log(result.model.tau)])
    for name in names:
        column, sd = unmeasured_effects[name]
        # a tenth of it, for a straight line is all that is claimed
        model = fit(replace(record, force=record.force + 0.1 * sd * column), arms=2).model
        there = np.array([model.k_inf, *model.k, *np.log(model.tau)])
        total += np.outer(there - here, there - here) / 0.01
    share = np.diag(total) / np.diag(covariance)
    assert np.all(share < 1.05)
    # of the slow arm and of k_inf the drift has a part, too; of the fast arm next to none
    assert np.all(share[[1, 3]] > 0.9)


# -- the table ------------------------------------------------------------------------------------


def test_every_doubt_says_its_source() -> None:
    for name, usual in DEFAULT_UNCERTAINTIES.items():
        assert usual.size > 0, name
        assert usual.quantity, name
        assert usual.source, name


def test_machine_replaces_default_with_stated_value() -> None:
    unknown, named = Machine(), Machine(sync=2e-3, compliance=5e-5, creep=3e-6)
    assert unknown.delay_sd(1e-3) == 5e-3
    assert unknown.delay_sd(8e-3) == 8e-3  # a sample at least
    assert named.delay_sd(1e-3) == 2e-3
    assert unknown.give_sd(8e-3, 2.0) == pytest.approx(1e-4)
    assert named.give_sd(8e-3, 2.0) == pytest.approx(0.1 * 5e-5 * 2)
    assert Machine(compliance=0.0).give_sd(8e-3, 2.0) == 0.0
    assert (unknown.creep_sd(8e-3), named.creep_sd(8e-3)) == (1e-5, 3e-6)


def test_drift_error_grows_as_its_root_when_the_cell_is_warm() -> None:
    cell, final, noise = Machine(), 1.5, 2e-3
    rate = math.hypot(2.4e-4 * final, 0.1 * noise)
    assert cell.drift_sd(final, 40.0) == pytest.approx(3.5e-3 * final / 40)
    for duration in (40.0, 400.0, 4000.0):
        warm = rate / math.sqrt(1 + duration / 120)
        assert cell.drift_sd(final, duration, noise) == pytest.approx(warm)
    # of a test of seconds the part of the force is more
    assert cell.drift_sd(final, 5.0, noise) == pytest.approx(3.5e-3 * final / 5)
    assert Machine(drift=1e-6).drift_sd(final, 40.0, noise) == 1e-6


def test_a_baseline_and_a_cell_speak_together() -> None:
    """The product of two normal densities, the first wider by what a slope may change."""
    cell, final, duration = Machine(drift=2e-4), 1.5, 40.0
    mean, sd = cell.combine_drift((3e-4, 1e-4), final, duration)
    seen = 1e-8 + (1e-3 * final / duration) ** 2
    at = np.linspace(-2e-3, 2e-3, 40001)
    density = np.exp(-((at - 3e-4) ** 2) / 2 / seen - at**2 / 2 / 4e-8)
    density /= density.sum()
    assert mean == pytest.approx(float(at @ density), rel=1e-6)
    assert sd == pytest.approx(float(np.sqrt(density @ (at - mean) ** 2)), rel=1e-4)
    assert cell.combine_drift((9.0, math.inf), final, duration) == (0.0, 2e-4)


def test_a_baseline_that_contradicts_the_data_sheet_is_not_averaged() -> None:
    """Box 1980: three standard deviations of what slope, change and cell leave."""
    cell, final, duration = Machine(drift=2e-4), 1.5, 40.0
    spread = math.sqrt(1e-10 + (1e-3 * final / duration) ** 2 + 4e-8)
    for slope in (2.9 * spread, -2.9 * spread, 3.1 * spread, -3.1 * spread):
        conflict = cell.drift_conflict((slope, 1e-5), final, duration)
        assert conflict == pytest.approx(abs(slope) / (3 * spread))
        mean, sd = cell.combine_drift((slope, 1e-5), final, duration)
        if conflict > 1:
            # a fit keeps to the cell, limits hold both
            assert (mean, sd) == (0.0, 2e-4)
            limit = cell.combine_drift((slope, 1e-5), final, duration, 1e-3)
            assert limit == (0.0, pytest.approx(math.hypot(2e-4, slope)))
        else:
            assert abs(mean) > 0.9 * abs(slope)
    assert cell.drift_conflict((9.0, math.inf), final, duration) == 0.0


# -- what a rig may add ---------------------------------------------------------------------------


def columns(
    record: RampHold, solid: GeneralizedMaxwell = PAPER
) -> dict[str, tuple[FloatArray, float]]:
    time = record.time[: record.hold.stop] - record.time[0]
    return compute_unmeasured_effects(record, time, record.displacement[: len(time)], solid)


def test_a_give_is_that_of_a_spring_in_series(record: RampHold) -> None:
    """To first order in C: the force of x - C F is that of x less C times the column."""
    time = record.time[: record.hold.stop] - record.time[0]
    x = record.displacement[: len(time)]
    column, sd = columns(record)["give"]
    assert sd == pytest.approx(0.0125 * record.depth)
    force = PAPER.force(time, x)
    variant, size = x.copy(), 1e-6
    for _ in range(4):
        variant = x - size * PAPER.force(time, variant) / force.max()
    change = (force - PAPER.force(time, variant)) / size
    later = time > 1.2 * (record.ramp_end - record.time[0])
    np.testing.assert_allclose(column[later], change[later], rtol=5e-3)


def test_a_crosshead_settles_where_no_reading_moves(record: RampHold) -> None:
    assert record.changed_readings == 0
    column, sd = columns(record)["settling"]
    assert sd == pytest.approx(1.25e-3 * record.depth)
    assert (column[: record.hold.start - 50] == 0).all()
    assert column[-1] == pytest.approx(PAPER.k_inf * np.log1p(record.hold_time), rel=0.1)
    shown = record.displacement.copy()
    shown[-5] += 1e-6
    assert "settling" not in columns(replace(record, displacement=shown))
    assert "settling" not in columns(replace(record, machine=Machine(creep=0.0)))


def test_a_seal_may_have_been_pressed_or_warm_up(record: RampHold) -> None:
    assert "preload" not in columns(record)
    relaxing, sd = columns(replace(record, preload=0.1))["preload"]
    # pressed to carry .1 N, it goes on relaxing, and the tare takes what it carries at rest
    rest = float(
        np.interp(
            build_load_cell_priors(record).offset_time, record.time - record.time[0], relaxing
        )
    )
    assert abs(rest) < 0.05 * np.abs(relaxing).max()
    assert relaxing[-1] < -5.0
    assert sd * PAPER.k_inf == pytest.approx(0.1, rel=0.5)
    _, warm = columns(record)["warming"]
    assert warm == 0.7
    noted = replace(record, specimen=Specimen(warmed=0.3))
    assert columns(noted)["warming"][1] == pytest.approx(math.hypot(0.3, 0.1))


def test_rig_effect_at_few_samples_equals_that_at_every_sample(record: RampHold) -> None:
    time = record.time[: record.hold.stop] - record.time[0]
    at = select_motion_samples(record, time)
    assert len(at) < 1000
    few = compute_unmeasured_effects(record, time[at], record.displacement[at], PAPER)
    for name, (column, _) in columns(record).items():
        between = np.interp(time, time[at], few[name][0])
        np.testing.assert_allclose(between, column, atol=0.01 * np.abs(column).max())


def test_a_sum_of_columns_that_are_there_doubts_as_a_column_does(record: RampHold) -> None:
    """The end of the hold by the fit's own block, and by one in which each doubt has a column.

    What is remembered has no such sum on the ramp, only in the hold.
    """
    result = fit(record)
    wide = compute_end_limits(
        [build_relaxation_data(record, result)],
        time=record.hold_time,
        model=result.model,
        dof=result.estimate.dof,
    )
    for name in ("k_end", "k_3end", "k_inf"):
        ends, others = getattr(wide, name), getattr(result.evidence.end_of_hold, name)
        np.testing.assert_allclose(ends, others, atol=0.07 * np.ptp(wide.k_end))


def test_the_point_knows_nothing_of_it_and_every_limit_does(record: RampHold) -> None:
    blind, wide = (
        build_nuisance_terms(record).priors["drift"],
        build_nuisance_terms(record, for_limits=True).priors["drift"],
    )
    assert blind.sd < wide.sd
    usual, expected = fit(record), fit(replace(record, machine=STATED_RIG))
    assert usual.model.k_inf == pytest.approx(expected.model.k_inf, rel=5e-3)
    assert width(usual) > 3 * width(expected)
    # each value that is named narrows the stiffness at the end
    for name in ("compliance", "creep", "drift", "rest"):
        less = replace(record, machine=replace(STATED_RIG, **{name: None}))
        assert width(fit(less)) > 1.02 * width(expected)


def test_end_of_hold_states_the_gain_of_naming_the_machine(record: RampHold) -> None:
    end = fit(record).evidence.end_of_hold
    assert end is not None
    expected = replace(
        record,
        machine=replace(STATED_RIG, drift=build_load_cell_priors(record).limit_drift.sd / 5),
    )
    assert end.if_machine_named * np.ptp(end.k_end) == pytest.approx(width(fit(expected)), rel=0.6)
    assert "give the drift, compliance and creep of the machine" in end.format_with_remedy("N/m")
    assert replace(end, if_machine_named=0.79).remedy.startswith("Record a baseline")
    assert replace(end, if_machine_named=0.81).remedy == "Hold longer."
    assert replace(end, if_machine_named=math.nan).remedy == "Hold longer."


def test_end_of_hold_of_a_stated_rig_is_within_one_per_cent() -> None:
    """A baseline of 10 s, a compliance of 0 that is named, and an encoder that shows the creep."""
    rig = replace(
        RIGS["crosshead creep 20 um, recorded"],
        protocol={"baseline": 10.0},
        machine_options={"compliance": 0.0},
    )
    half = []
    for truth in TRUTHS[:3]:
        item = read(Seal(truth), protocol_of(truth), rig)
        test = RelaxationTest(item.time, item.displacement, item.force, units="SI")
        end = fit(prepare(test, machine=Machine(**item.machine_options))).evidence.end_of_hold
        assert end is not None
        low, high = end.k_end
        assert low < item.seal.secant(end.end_time) < high
        half.append((high - low) / (high + low))
    assert np.median(half) < 0.008


def test_several_tests_together_are_a_point(record: RampHold) -> None:
    result = fit(record)
    names = build_relaxation_data(record, result, for_limits=False).block.fixed_names
    assert not {"give", "settling", "warming"} & set(names)
    assert {"give", "settling", "warming"} < set(
        build_relaxation_data(record, result).block.fixed_names
    )


# -- what is said of it ---------------------------------------------------------------------------


def test_k_inf_is_at_most_and_k_of_t_lies_in_its_interval(record: RampHold) -> None:
    result = fit(record)
    low, high = result.intervals()["k_inf"]
    assert result.evidence.end_of_hold is not None
    assert (low, high) == (0.0, result.evidence.end_of_hold.k_inf[1])
    assert solid_intervals(result)["k_inf"] == (low, high)
    k = result.model.k_inf
    narrow, wide = result.intervals(0.68)["k_inf"][1], result.intervals(0.99)["k_inf"][1]
    assert k <= narrow < high < wide
    assert (wide - k) / (high - k) == pytest.approx(2.576 / 1.96, rel=1e-3)
    first, second, *_ = list_model_values(result)
    assert first.name == "k_end"
    assert first.low <= first.value <= first.high
    assert second.cells.interval.startswith("at most")
    assert not second.cells.error


def test_limits_hold_a_fit_that_the_record_would_not() -> None:
    """One arm for two: its k(T) lies outside what the record allows, and says so."""
    test = prepare(simulate_relaxation(PAPER, seed=2).test)
    poor = fit(replace(test, machine=STATED_RIG), arms=0)
    end = poor.evidence.end_of_hold
    assert end is not None
    assert end.distance_outside > 0.25
    assert end.k_end[0] <= float(poor.model.relaxation(end.end_time)) <= end.k_end[1]


# -- a compliance that is named, a force that is late ---------------------------------------------


def test_a_named_compliance_carries_no_noise_of_the_force() -> None:
    item, record, result = foreign(0, "compliance 50 um/N, named")
    assert record.machine_deflection is not None
    # the encoder's readings are what they were
    steps = record.travel / record.displacement_quantum
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-3)
    held = record.machine_deflection[record.settled_samples]
    assert np.std(np.diff(held)) < 0.2 * 50e-6 * np.sqrt(2) * record.force_noise
    assert np.mean(held) == pytest.approx(
        50e-6 * np.mean(record.force[record.settled_samples]), rel=1e-3
    )
    mass = item.seal.mass_at(12.7, 2)
    bound = frf_band(result, record, mass=mass, frequency=[12.7], seals=2)
    assert bound.unmeasured[0, 0] <= bound.magnitude[0] <= bound.unmeasured[1, 0]
    assert (
        bound.unmeasured[0, 0]
        <= abs(item.seal.accelerance(12.7, mass, 2))
        <= bound.unmeasured[1, 0]
    )


def test_a_force_that_is_five_milliseconds_late_leaves_the_bound_right() -> None:
    """By its tangent at no delay the resonance of this seal was put below 12.69 Hz."""
    item, record, result = foreign(40, "skew 5 ms, 1 kHz")
    late = next(n.value for n in result.estimate.nuisance if n.name == "delay")
    assert late == pytest.approx(5e-3, abs=1e-3)
    mass = item.seal.mass_at(12.7, 2)
    bound = frf_band(result, record, mass=mass, frequency=[12.7], seals=2)
    assert bound.peak_frequency is not None
    assert bound.peak_frequency[0] < 12.7 < bound.peak_frequency[1]
    assert (
        bound.unmeasured[0, 0]
        <= abs(item.seal.accelerance(12.7, mass, 2))
        <= bound.unmeasured[1, 0]
    )


def truth_named(name: str) -> int:
    return next(i for i, solid in enumerate(TRUTHS) if solid.name == name)


@pytest.mark.parametrize(
    ("truth", "rig", "done"),
    [
        ("springpot, 1", "filter 10 Hz", []),
        ("5 arms, 0", "filter 20 Hz Butterworth", ["put the motion behind a low-pass of 9.92 ms"]),
    ],
)
def test_fit_reports_an_unstated_filter_with_a_valid_bound(
    truth: str, rig: str, done: list[str]
) -> None:
    """To first order of the delay the second is a bent law, and its contact is behind air."""
    item, record, result = foreign(truth_named(truth), rig)
    message = [step.message for step in result.steps if step.name == "lag"]
    assert [text.partition(",")[0] for text in message] == done
    assert result.verdict.use == "use"
    assert result.elastic_law is not None
    assert result.elastic_law.kind == "linear"
    (output,) = [check for check in result.checks if check.name == "clocks_agree"]
    assert (output.failed, output.grade) == (True, "note")
    mass = item.seal.mass_at(12.7, 2)
    bound = frf_band(result, record, mass=mass, frequency=[12.7], seals=2)
    assert bound.peak_frequency is not None
    assert bound.peak_frequency[0] < 12.7 < bound.peak_frequency[1]
    assert (
        bound.unmeasured[0, 0]
        <= abs(item.seal.accelerance(12.7, mass, 2))
        <= bound.unmeasured[1, 0]
    )


def test_a_force_is_too_late_from_so_much_on() -> None:
    thought = 5e-3
    for times, grade in ((0.99, "note"), (1.01, "limit")):
        for many, far in ((1, MAX_DELAY_SD), (2, MAX_JOINT_DELAY_SD)):
            late = times * far * thought
            for value in (late, -late):
                check = clocks_agree([(value, 1e-4, thought)] * many)
                assert check.failed
                assert check.grade == grade


# -- rounding -------------------------------------------------------------------------------------


def test_what_creeps_on_is_correlated_by_itself() -> None:
    """A stretch with 1e-14 of the energy of the motion, whose force is known to ten digits."""
    t = np.arange(0, 8.0, 2e-3)
    x = 8e-3 * np.clip(t, 0, 1) + 1e-9 * (1 - np.exp(-np.maximum(t - 1, 0) / 0.1))
    weights = np.where(t < 1.2, 0.5, 1.0)
    block = build_recorded_block(t, x, PAPER.force(t, x), weights=weights, tau_range=(1e-5, 500.0))
    log_tau = np.log(np.geomspace(2e-5, 400.0, 40))
    result, whole = block.evaluate(log_tau, False), block.exact.evaluate(log_tau, False)
    individual = np.concatenate((result.fixed, result.arms), axis=1)
    direct = np.concatenate((whole.fixed, whole.arms), axis=1)
    scale = np.linalg.norm(direct, axis=0)
    # the ridge may take 1e-9, and rounding beside it as much as the processor's sums leave
    assert (
        np.abs((individual.T @ individual - direct.T @ direct) / np.outer(scale, scale)).max()
        < 2e-9
    )


def test_a_column_of_nothing_stays_nothing_and_rounding_is_refused() -> None:
    factor = upper_factor(np.diag([4.0, 0.0, 9.0]))
    np.testing.assert_array_equal(factor, np.diag([2.0, 0.0, 3.0]))
    fine = np.array([[1.0, 1.0 + 4e-10], [1.0 + 4e-10, 1.0]])
    assert np.isfinite(upper_factor(fine)).all()
    with pytest.raises(ValueError, match="distinguished"):
        upper_factor(np.array([[1.0, 1.0 + 4e-9], [1.0 + 4e-9, 1.0]]))


# -- coverage -------------------------------------------------------------------------------------

HIDDEN = ("drift .2 mN/s", "compliance 50 um/N", "crosshead creep 20 um", "seal warms .12 decade")


def holds(truth: int, rig: str) -> bool:
    item, _, result = foreign(truth, rig)
    end = result.evidence.end_of_hold
    assert end is not None
    wanted = {
        n: item.seal.secant(times * end.end_time) for n, times in (("k_end", 1), ("k_3end", 3))
    }
    wanted["k_inf"] = item.seal.secant(np.inf)
    ends = {name: getattr(end, name) for name in wanted}
    return all(ends[name][0] <= value <= ends[name][1] for name, value in wanted.items())


@pytest.mark.parametrize("rig", HIDDEN)
def test_what_a_rig_hides_is_inside_the_limits(rig: str) -> None:
    assert holds(0, rig)
    assert foreign(0, rig)[2].verdict.use == "use"


@pytest.mark.slow
@pytest.mark.parametrize("rig", HIDDEN)
def test_limits_miss_at_most_one_of_a_third_of_the_truths(rig: str) -> None:
    truths = range(1, len(TRUTHS), 3)
    assert sum(not holds(truth, rig) for truth in truths) <= 1


def test_limits_hold_the_solid_that_is_shown():
    """A fractional solid's own k_inf lies above the bound of arms: it is not printed outside it."""
    record = prepare(simulate_relaxation(PAPER, hold_time=40.0, seed=1).test)
    result = fit(record, family="fractional")
    (shown,) = [fact for fact in result.facts if fact.name == "k_inf"]
    assert shown.value <= shown.high
    limits = result.stiffness_limits
    assert limits is not None
    here, later = (
        float(result.model.relaxation(n * result.evidence.end_of_hold.end_time)) for n in (1, 3)
    )
    assert limits["k_end"][0] <= here <= limits["k_end"][1]
    assert limits["k_3end"][0] <= later <= limits["k_3end"][1]
