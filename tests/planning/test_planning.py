"""Planned tests: the expected error of each parameter and the advice."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kit.fits import restrict_to_noise
from kit.foreign.rigs import Protocol, read
from kit.foreign.truths import TABLE_1
from kit.foreign.truths import Seal as ForeignSeal
from kit.plans import make_bench_plan
from kit.trials import Bench as TrialBench
from kit.trials import Seal, record, relaxation_test

from dashpot.base.errors import DataError
from dashpot.base.option_fields import Method
from dashpot.datamodel.fit import list_model_values
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.fitting.nuisance_priors import build_load_cell_priors
from dashpot.fitting.relaxation import fit
from dashpot.planning.checks import format_percent
from dashpot.planning.expected_errors import (
    ExpectedArm,
    ExpectedError,
    expected_end,
    expected_error,
    half_sine,
    hammer_rows,
    record_need,
)
from dashpot.planning.planned_ramp_hold import Bench
from dashpot.preprocessing.prepare import prepare
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.mass_on_seals import mass_for_peak, predict_frf

PAPER = GeneralizedMaxwell(196.5, (117.5, 17.8), (59.0 / 117.5, 292.2 / 17.8))
LSB = 1 / 1280


@cache
def a_foreign_record(baseline: float) -> RelaxationTest:
    """Of Table 1, by a rig that shares no line with the project."""
    item = read(ForeignSeal(TABLE_1), Protocol(rate=250.0, baseline=baseline))
    return RelaxationTest(item.time, item.displacement, item.force, units="SI")


def expected_force_error(
    arm: tuple[float, float], *, at: float = 12.71, **changes: object
) -> ExpectedError:
    """What the force alone would show, without offset, drift and delay."""
    model = PAPER + GeneralizedMaxwell(0.0, (arm[0],), (arm[1],))
    bench = Bench(machine=None, **changes)  # type: ignore[arg-type]
    return expected_error(model, bench, at, model.tau.index(arm[1]))


# -- the bench --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ramp_time", "hold", "full"),
    [(1.0, 1.07, 0.38), (0.3, 0.32, 0.116), (0.1, 0.107, 0.038), (0.03, 0.030, 0.013)],
)
def test_plan_reproduces_row_b3(ramp_time: float, hold: float, full: float) -> None:
    """SD of the loss factor at 12.71 Hz with an arm of 50 N/m at 12.5 ms."""
    for method, expected in (("hold", hold), ("full", full)):
        message = expected_force_error((50.0, 0.0125), ramp_time=ramp_time, method=method)
        assert message.loss_factor_sd == pytest.approx(expected, rel=0.015)


@pytest.mark.parametrize(
    ("noise", "rate", "three", "ten", "loss_factor"),
    [
        (LSB / np.sqrt(12), 1000, 0.28, 0.084, 0.07),
        (LSB, 1000, 0.97, 0.29, 0.24),
        (LSB, 100, 2.07, 0.62, 0.52),
        (5e-3, 1000, 6.20, 1.86, 1.55),
    ],
)
def test_the_table_of_vibration_4b(
    noise: float, rate: float, three: float, ten: float, loss_factor: float
) -> None:
    """Relative SD of a hidden arm of 3 and 10 % of the glassy stiffness, hold-only fit."""
    options = {"method": "hold", "noise": noise, "rate": rate, "force_alone": True}
    weak = make_bench_plan(arm=(0.03 * PAPER.k_0, 0.0125), **options).expected
    strong = make_bench_plan(arm=(0.10 * PAPER.k_0, 0.0125), **options).expected
    assert weak.arm_sd == pytest.approx(three, rel=0.015)
    assert strong.arm_sd == pytest.approx(ten, rel=0.015)
    assert strong.loss_factor_sd == pytest.approx(loss_factor, rel=0.02)


def test_a_faster_ramp_mends_it() -> None:
    """3 % arm, 1 LSB: 97, 29, 9.7, 2.7, 1.0 %."""
    arm = (0.03 * PAPER.k_0, 0.0125)
    message = [
        make_bench_plan(
            method="hold", noise=LSB, arm=arm, ramp_time=c, force_alone=True
        ).expected.arm_sd
        for c in (1.0, 0.3, 0.1, 0.03, 0.01)
    ]
    assert message == pytest.approx([0.97, 0.29, 0.097, 0.027, 0.0105], rel=0.015)


def test_the_sensitivities_are_slopes_of_the_force() -> None:
    model = PAPER + GeneralizedMaxwell(0.0, (33.0,), (0.0125,))
    bench = Bench(8e-3, 0.5, 5.0, 100.0, 1e-3, "full", 2.0, Machine())
    J = bench.sensitivity(model)
    t = bench.time()

    def force(p: np.ndarray) -> np.ndarray:
        solid = GeneralizedMaxwell(p[0], tuple(p[1:4]), tuple(np.exp(p[4:])))
        return solid.ramp_hold_force(t, depth=8e-3, ramp_time=0.5)

    at = np.array([model.k_inf, *model.k, *np.log(model.tau)])
    for i in range(len(at)):
        step = np.zeros(len(at))
        step[i] = 1e-5 * max(1.0, abs(at[i]))
        numeric = (force(at + step) - force(at - step)) / (2 * step[i])
        assert J[:, i] == pytest.approx(numeric, rel=1e-6, abs=1e-9)
    assert J[:, -3:-1] == pytest.approx(np.column_stack((np.ones_like(t), t + 1.0)))
    later = (model.ramp_hold_force(t + h, depth=8e-3, ramp_time=0.5) for h in (1e-6, -1e-6))
    late = -np.subtract(*later) / 2e-6
    smooth = np.abs(t - 0.5) > 1e-3  # where the plate stops a delay has no slope
    assert J[smooth, -1] == pytest.approx(late[smooth], rel=1e-5, abs=1e-7)


@pytest.mark.parametrize("method", ["full", "hold"])
@pytest.mark.parametrize(("ramp_time", "rate"), [(1.0, 1000.0), (0.05, 2000.0), (5.0, 50.0)])
def test_rows_of_grouped_samples_hold_the_information_of_all(
    method: str, ramp_time: float, rate: float
) -> None:
    """For every direction of the parameters, determined or not, with effects of the rig."""
    model = PAPER + GeneralizedMaxwell(0.0, (33.0,), (0.0125,))
    bench = Bench(8e-3, ramp_time, 40.0, rate, 5e-3, method, 1.0, Machine())
    rows, unmeasured = bench.rows(model)
    time, columns = bench.time(), bench.sensitivity(model)
    effects = bench.unmeasured_effects(model, time, columns[:, 1 : 1 + model.arms])
    prior_rows = np.eye(columns.shape[1])[1 + 2 * model.arms :] / bench.prior_sd(model)[:, None]
    every = np.vstack((columns / bench.noise, prior_rows))
    scale = np.linalg.norm(every, axis=0)
    inverses = [np.linalg.pinv(matrix / scale) for matrix in (rows, every)]
    covariances = [inverse @ inverse.T for inverse in inverses]
    deviations = np.sqrt(np.diag(covariances[1]))
    difference = (covariances[0] - covariances[1]) / np.outer(deviations, deviations)
    assert np.abs(difference).max() < 1e-3
    shifts = [
        inverses[0] @ unmeasured,
        inverses[1] @ np.pad(effects / bench.noise, ((0, len(prior_rows)), (0, 0))),
    ]
    assert np.abs(shifts[0] - shifts[1]).max() < 1e-3 * np.abs(shifts[1]).max()


def test_no_error_is_zero_where_little_is_determined() -> None:
    """Of 122 samples and a ramp of one: the limit was 0 where its terms cancelled."""
    model = GeneralizedMaxwell(
        370.3120776317598,
        (284.1073427241991, 108.20050472147489, 66.25896222420332, 57.99801709931713),
        (0.019842149200051208, 7.887791391853817, 15.887744532502307, 38.65011183173403),
    )
    bench = Bench(
        depth=8e-3, ramp_time=0.04757466916304349, hold_time=4.305161040811437,
        rate=28.31379301182, noise=5e-3,
    )  # fmt: skip
    end = expected_end(model, bench)
    assert 1e-3 < end.if_machine_named <= end.half_width < 0.1


def test_planned_priors_equal_those_of_the_fit() -> None:
    """The priors of the planned test are those of its record, made and prepared."""
    bench = Bench(8e-3, 1.0, 20.0, 1000.0, 4.5e-3, "full", 1.5, Machine(sync=2e-3))
    seal = Seal.of_arms(PAPER.k_inf, PAPER.k, PAPER.tau)
    made = record(seal, TrialBench(hold=20.0, count=0.0))
    load_cell_priors = build_load_cell_priors(prepare(relaxation_test(made), machine=bench.machine))
    planned = bench.prior_sd(PAPER)
    assert planned == pytest.approx(
        [load_cell_priors.offset.sd, load_cell_priors.drift.sd, load_cell_priors.delay.sd], rel=0.2
    )
    held = replace(bench, method="hold").prior_sd(PAPER)
    assert held == pytest.approx(
        [load_cell_priors.offset.sd, load_cell_priors.limit_drift.sd], rel=0.2
    )
    assert load_cell_priors.limit_drift.sd > 1.05 * load_cell_priors.drift.sd
    sheet = Bench(8e-3, 1.0, 20.0, 1000.0, 4.5e-3, "full", 1.5, Machine(drift=0.2e-3))
    assert sheet.prior_sd(PAPER)[1] < 0.2e-3  # of a baseline and a data sheet together
    assert sheet.prior_sd(PAPER)[2] == pytest.approx(5e-3)
    long = Bench(8e-3, 1.0, 20.0, 1000.0, 4.5e-3, "full", 60.0, Machine())
    assert long.prior_sd(PAPER)[1] < 1.05e-3 * 1.57 / 21


def test_the_bound_with_its_priors_is_the_scatter_of_a_posterior_mode() -> None:
    """A linear estimate from simulated data and drawn nuisances scatters by the bound."""
    model = PAPER + GeneralizedMaxwell(0.0, (33.0,), (0.0125,))
    bench = Bench(8e-3, 0.2, 5.0, 200.0, 5e-3, "full", 1.0, Machine(sync=1e-3, drift=1e-3))
    J, sd = bench.sensitivity(model), bench.prior_sd(model)
    random = np.random.default_rng(5)
    rows = np.vstack((J / bench.noise, np.eye(J.shape[1])[-3:] / sd[:, None]))
    estimate = np.linalg.pinv(rows)
    drawn = sd * random.standard_normal((2000, 3))
    data = drawn @ J[:, -3:].T + bench.noise * random.standard_normal((2000, len(J)))
    result = np.hstack((data / bench.noise, np.zeros((2000, 3)))) @ estimate.T
    message = expected_error(model, bench, 12.71, 0)
    assert message.arm_sd is not None
    assert result[:, 1].std() / 33.0 == pytest.approx(message.arm_sd, rel=0.06)


def test_the_bound_is_what_a_fit_finds() -> None:
    """The standard error of an actual fit of the same design, an independent road."""
    arm = (50.0, 0.05)
    truth = PAPER + GeneralizedMaxwell(0.0, (arm[0],), (arm[1],))
    t = np.arange(0, 21.0, 0.002)
    x = 8e-3 * np.clip(t / 0.2, 0, 1)
    force = truth.force(t, x) + 1e-3 * np.random.default_rng(4).standard_normal(len(t))
    held = RampHold(t, x, force, 0.0, 0.2, float(t[-1]), 8e-3)
    result = restrict_to_noise(fit(held, arms=3, nuisance=()))
    message = expected_force_error(
        arm, ramp_time=0.2, hold_time=20.8, rate=500.0, noise=1e-3, at=3.0
    )
    assert message.arm_sd is not None
    assert result.standard_error["k"][0] / arm[0] == pytest.approx(message.arm_sd, rel=0.1)


@settings(max_examples=15, deadline=None)
@given(factor=st.floats(1.5, 10), at=st.floats(0.5, 30))
def test_noise_scales_the_bound_and_samples_its_root(factor: float, at: float) -> None:
    options = {"hold_time": 10.0, "rate": 200.0, "at": at, "arm": (30.0, 0.02)}
    item = expected_force_error(**options)
    louder = expected_force_error(**options, noise=5e-3 * factor)
    assert louder.loss_factor_sd == pytest.approx(factor * item.loss_factor_sd, rel=1e-6)
    denser = expected_force_error(**(options | {"rate": 800.0}))
    assert denser.loss_factor_sd == pytest.approx(item.loss_factor_sd / 2, rel=0.15)


def test_what_the_fit_must_find_costs_something() -> None:
    arm = (0.1 * PAPER.k_0, 1 / (2 * np.pi * 12.71))
    assert (
        make_bench_plan().expected.loss_factor_sd > 1.5 * expected_force_error(arm).loss_factor_sd
    )
    late = make_bench_plan(sync=8e-3).expected
    assert late.loss_factor_sd > make_bench_plan().expected.loss_factor_sd
    lost, usual, message = (
        make_bench_plan(**of).arms[1].half_tau for of in ({"drift": 5e-3}, {}, {"drift": 1e-5})
    )
    assert lost > usual > 2 * message


def test_plan_with_a_hammer_test_determines_the_arm() -> None:
    """Vibration reference 4b: jointly the 10 % arm is known to 1.1 %, the loss factor to 0.92 %."""
    plan = make_bench_plan(
        noise=LSB, method="hold", arm=(0.10 * PAPER.k_0, 0.0125), force_alone=True
    )
    joint = plan.alternatives[-1]
    assert joint.method == "joint"
    assert joint.arm_sd == pytest.approx(0.011, rel=0.1)
    assert joint.loss_factor_sd == pytest.approx(0.0092, rel=0.1)
    assert "dd a hammer test" in plan.advice[0]
    assert "0.951 %" in plan.advice[0]


def test_the_hammers_sensitivities_are_slopes_of_the_response() -> None:
    model = PAPER + GeneralizedMaxwell(0.0, (33.0,), (0.0125,))
    lines = np.array([5.0, 12.0, 13.0, 30.0])
    rows = hammer_rows(model, 0.11, seals=2, lines=lines, relative_sd=1.0)

    def log_response(p: np.ndarray) -> np.ndarray:
        solid = GeneralizedMaxwell(p[0], tuple(p[1:4]), tuple(np.exp(p[4:7])))
        value = np.log(predict_frf(2 * solid, mass=float(np.exp(p[7])), frequency=lines).value)
        return np.concatenate((value.real, value.imag))

    at = np.array([model.k_inf, *model.k, *np.log(model.tau), np.log(0.11)])
    for i in range(len(at)):
        step = np.zeros(len(at))
        step[i] = 1e-5 * max(1.0, abs(at[i]))
        numeric = (log_response(at + step) - log_response(at - step)) / (2 * step[i])
        assert rows[:, i] == pytest.approx(numeric, rel=1e-5, abs=1e-8)


def test_a_model_with_an_arm_there_needs_no_other() -> None:
    plan = make_bench_plan(model=PAPER + GeneralizedMaxwell(0.0, (20.0,), (0.016,)))
    assert plan.arm is None
    assert plan.expected.arm_sd is None
    assert make_bench_plan().arm == pytest.approx((0.1 * PAPER.k_0, 1 / (2 * np.pi * 12.71)))


# -- the hammer -------------------------------------------------------------------------------


def test_the_record_for_table_1() -> None:
    """Row C3: at least 44 s for five lines, 17 s for six time constants; 1/sigma = 2.82 s."""
    need = record_need(2 * PAPER, mass_for_peak(2 * PAPER, 12.71), None)
    assert need.for_lines == pytest.approx(44.35, abs=0.05)
    assert need.for_decay == pytest.approx(16.94, abs=0.02)
    assert need.time_constant == pytest.approx(2.82, abs=0.01)
    assert need.half_power_width == pytest.approx(0.1127, abs=1e-4)
    assert need.damping_ratio == pytest.approx(0.004435, abs=1e-6)


def test_the_record_is_for_the_solid_that_is_supposed() -> None:
    """An arm that is supposed damps, so the mass rings for less long."""
    plan = make_bench_plan()
    assert plan.record.for_lines == pytest.approx(6.86, abs=0.01)
    assert (
        "Record each hit for 6.86 s (44.4 s if no arm of the seal adds damping there)"
        in plan.advice[1]
    )
    assert make_bench_plan(model=plan.model).record.for_lines == pytest.approx(6.86, abs=0.01)


def test_short_records_hide_the_peak() -> None:
    """Vibration reference 4c, worst half bin: -67, -43, -23, -8.5 % for 2, 5, 10, 20 s."""
    errors = [record_need(PAPER, 0.0520213, T).peak_error for T in (2, 5, 10, 20)]
    assert errors == pytest.approx([-0.67, -0.43, -0.23, -0.085], abs=0.012)


def test_the_mass_puts_the_peak_there() -> None:
    mass = mass_for_peak(2 * PAPER, 12.71)
    assert mass == pytest.approx(0.1040426, abs=1e-7)
    f = np.linspace(12.6, 12.8, 20001)
    height = np.abs(predict_frf(2 * PAPER, mass=mass, frequency=f).value)
    assert f[np.argmax(height)] == pytest.approx(12.71, abs=1e-5)


def test_soft_tips() -> None:
    """Row I1: 10 ms is -0.131 dB at 12.71 Hz with a zero at 150 Hz; 20 ms -0.529 dB, 75 Hz."""
    fast, slow = half_sine(0.010, 12.71), half_sine(0.020, 12.71)
    assert fast.level_db == pytest.approx(-0.131, abs=5e-4)
    assert fast.first_zero == pytest.approx(150)
    assert slow.level_db == pytest.approx(-0.529, abs=5e-4)
    assert slow.first_zero == pytest.approx(75)
    assert half_sine(0.010, 50.0).level_db == pytest.approx(20 * np.log10(np.pi / 4))


@settings(max_examples=20, deadline=None)
@given(duration=st.floats(1e-3, 0.1), part=st.floats(0.05, 1.4))
def test_the_spectrum_of_a_half_sine(duration: float, part: float) -> None:
    """Against the transform of the pulse itself, by quadrature."""
    f = part / duration
    nodes, weights = np.polynomial.legendre.leggauss(200)
    t = duration * (nodes + 1) / 2
    pulse = np.sin(np.pi * t / duration) * weights
    ratio = abs(np.sum(pulse * np.exp(-2j * np.pi * f * t))) / np.sum(pulse)
    result = half_sine(duration, f)
    assert 10 ** (result.level_db / 20) == pytest.approx(ratio, rel=1e-6, abs=1e-9)
    assert half_sine(duration, result.band_10db).level_db == pytest.approx(-10, abs=1e-6)
    assert half_sine(duration, result.band_20db).level_db == pytest.approx(-20, abs=1e-6)


# -- advice -----------------------------------------------------------------------------------


def test_user_story_4() -> None:
    """ "I need the loss factor at 12.71 Hz to 10 %": ramp in 0.1 s or hit a block."""
    plan = make_bench_plan(record=4.0, pulse=0.015)
    words = " ".join(plan.advice)
    assert "Ramp in 30.0 ms" in words  # a time that is set at a machine
    assert "fit both together" in words
    assert "6.86 s (44.4 s if no arm of the seal adds damping there) instead of 4 s" in words
    assert {c.name: c.passed for c in plan.checks} == {
        "loss_factor_determined": False,
        "inside_valid_band": False,
        "record_long_enough": False,
        "tip_excites": True,
    }
    text = str(plan)
    assert "expected standard deviation at 12.71 Hz" in text
    assert "121 %" in text


def test_plan_gives_no_advice_for_a_good_test() -> None:
    plan = make_bench_plan(ramp_time=0.03, record=60.0, pulse=0.01, noise=1e-3)
    assert plan.expected.loss_factor_sd < 0.1
    assert len(plan.advice) == 1
    assert plan.advice[0].startswith("This test determines the loss factor")


def test_fit_the_ramp_too() -> None:
    plan = make_bench_plan(ramp_time=0.1, method="hold")
    assert "fit ramp and hold together" in plan.advice[0]


def test_plan_states_the_gain_of_naming_the_machine() -> None:
    """A baseline of 10 s, and a machine whose give and creep are known."""
    plan = make_bench_plan()
    assert plan.end.time == 40.0
    assert plan.end.stiffness == pytest.approx(float(plan.model.relaxation(40.0)))
    assert plan.end.if_machine_named < 0.5 * plan.end.half_width
    assert plan.end.message in str(plan)
    assert "Record a baseline of 10 s" in plan.end.message
    end = make_bench_plan(baseline=10.0, compliance=0.0, creep=0.0).end
    assert end.half_width == pytest.approx(plan.end.if_machine_named)
    assert end.message == (
        f"At the end of the hold the stiffness k(40.0 s) would be known to about "
        f"{100 * end.half_width:#.2g} %."
    )
    # each alone gives a part of it
    for item in ({"baseline": 10.0}, {"compliance": 0.0}, {"creep": 0.0}, {"drift": 1e-5}):
        assert end.half_width < make_bench_plan(**item).end.half_width < plan.end.half_width
    # by eq. 5 as by ramp and hold: what hides the end is in both
    assert make_bench_plan(method="hold").end == plan.end


@pytest.mark.parametrize(
    ("baseline", "machine"), [(1.0, {}), (10.0, {"compliance": 0.0, "creep": 0.0})]
)
def test_planned_end_of_hold_error_agrees_with_a_fit(
    baseline: float, machine: dict[str, float]
) -> None:
    """A record of another rig: its limits over every spectrum are as wide within a half."""
    end = fit(prepare(a_foreign_record(baseline), machine=Machine(**machine))).evidence.end_of_hold
    assert end is not None
    half = (end.k_end[1] - end.k_end[0]) / sum(end.k_end)
    foretold = make_bench_plan(rate=250.0, noise=2e-3, baseline=baseline, **machine).end.half_width
    assert foretold == pytest.approx(half, rel=0.5)


@pytest.mark.parametrize("method", ["full", "hold"])
@pytest.mark.parametrize(
    ("baseline", "machine"),
    [(1.0, {}), (1.0, {"drift": 2e-5}), (10.0, {"compliance": 0.0, "creep": 0.0, "sync": 0.0})],
)
def test_planned_arm_errors_agree_with_a_fit(
    method: Method, baseline: float, machine: dict[str, float]
) -> None:
    """A record of another rig: what its fit prints of every arm is what was foretold."""
    record = prepare(a_foreign_record(baseline), machine=Machine(**machine))
    result = fit(record, arms=2, method=method)
    foretold = make_bench_plan(
        rate=250.0, noise=2e-3, baseline=baseline, method=method, **machine
    ).arms
    facts = {fact.name: fact for fact in list_model_values(result)}
    for j, arm in enumerate(foretold, start=1):
        for name in ("k", "tau", "b"):
            fact = facts[f"{name}_{j}"]
            half = np.log(fact.high / fact.low) / 2
            assert getattr(arm, f"half_{name}") == pytest.approx(half, rel=0.25)


def test_naming_the_machine_narrows_each_arm() -> None:
    """By the drift the slow arm, by the compliance the size of both; both sides of what is said."""
    usual, named = (
        make_bench_plan(),
        make_bench_plan(baseline=10.0, compliance=0.0, creep=0.0, sync=0.0),
    )
    for arm, other in zip(usual.arms, named.arms, strict=True):
        for name in ("k", "tau", "b"):
            residual = getattr(arm, f"named_{name}")
            assert residual == pytest.approx(getattr(other, f"half_{name}"))
            # what is left of a fast arm's time is the room's doing
            assert residual < 0.95 * getattr(arm, f"half_{name}")
    assert make_bench_plan(drift=2e-5).arms[1].half_tau < 0.4 * usual.arms[1].half_tau
    assert make_bench_plan(compliance=0.0).arms[0].half_k < 0.2 * usual.arms[0].half_k
    lines = str(usual).splitlines()
    (head,) = [i for i, line in enumerate(lines) if line.startswith("half width of the 95 %")]
    assert "after a baseline of 10 s" in lines[head + 2 + len(usual.arms)]
    assert lines[head + 2].split() == ["0.502", *_percents(usual.arms[0])]


def _percents(arm: ExpectedArm) -> list[str]:
    item = [getattr(arm, f"{w}_{n}") for w in ("half", "named") for n in ("k", "tau", "b")]
    return [part for half in item for part in format_percent(half).split()]


def test_no_ramp_will_do() -> None:
    plan = make_bench_plan(noise=1.0)
    assert "No faster ramp that was tried gives ±10 %" in plan.advice[0]


def test_a_tip_that_is_too_soft() -> None:
    plan = make_bench_plan(pulse=0.2)
    assert any("Use a harder tip" in line and "80.2 ms" in line for line in plan.advice)


def test_the_band_is_that_of_hold_and_ramp() -> None:
    assert make_bench_plan().band == pytest.approx((1 / (2 * np.pi * 40), 1 / np.pi))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"ramp_time": 0.0}, "ramp_time = 0.0"),
        ({"noise": float("nan")}, "noise = nan"),
        ({"record": -2.0}, "record = -2.0"),
        ({"coherence": 1.0}, "coherence = 1.0"),
        ({"hits": 0}, "hits = 0"),
        ({"method": "half"}, "expected one of full, hold"),
    ],
)
def test_what_cannot_be_is_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(DataError, match=words):
        make_bench_plan(**changes)
