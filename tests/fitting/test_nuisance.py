"""Offset, drift and delay: bound by what is known of them, and what that is worth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.fits import restrict_to_noise

import dashpot as dp
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.nuisance_priors import (
    NuisanceTerms,
    Prior,
    build_load_cell_priors,
    build_nuisance_terms,
)
from dashpot.fitting.relaxation import fit
from dashpot.numerics.design_matrices.block import design_block
from dashpot.numerics.inference.correlated_noise import marginalise
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER
from dashpot.workflow.json_archive import from_json, to_json


def late(samples: int, seed: int = 1) -> RampHold:
    test = simulate_relaxation(PAPER, seed=seed).test
    force = np.concatenate((np.repeat(test.force[:1], samples), test.force[: -samples or None]))
    return prepare(replace(test, force=force))


def nuisance(result: dp.Fit, name: str) -> tuple[float, float]:
    return next(
        (quantity.value, quantity.standard_error)
        for quantity in result.estimate.nuisance
        if quantity.name == name
    )


def test_priors_have_the_stated_means_and_errors() -> None:
    load_cell_priors = build_load_cell_priors(late(0))
    assert load_cell_priors.offset.mean == pytest.approx(0.0, abs=2e-4)
    assert load_cell_priors.offset.sd == pytest.approx(4e-3 / np.sqrt(1500), rel=0.2)
    # what a cell of which nothing is known may drift: half a per cent of 1.57 N in 41 s, and
    # what the second and a half before contact say of it
    usual, final = 3.5e-3 * 1.573 / 41, 1.573
    assert 0.8 * usual < load_cell_priors.drift.sd < usual
    # a limit bears more: of the force and of the scatter, while the cell warms up
    doubt = np.hypot(2.4e-4 * final, 0.1 * 4.06e-3) / np.sqrt(1 + 41 / 120)
    assert 0.4 * doubt < load_cell_priors.limit_drift.sd < doubt
    # a data sheet takes the place of what is usual, and the baseline says the same as before
    stated = build_load_cell_priors(replace(late(0), machine=dp.Machine(drift=1e-4)))
    of_baseline = 1 / load_cell_priors.drift.sd**2 - 1 / usual**2
    assert stated.drift.sd == pytest.approx((1 / 1e-4**2 + of_baseline) ** -0.5, rel=0.02)
    assert load_cell_priors.delay == (0.0, pytest.approx(5e-3))
    assert 1400 < load_cell_priors.first_sample < 1530


def test_nuisance_terms_as_parameters_or_as_noise_agree() -> None:
    """Least squares with rows of what is known, and whitened for it, leave the same of a solid."""
    random = np.random.default_rng(3)
    spread, terms = (
        0.7,
        NuisanceTerms({"offset": Prior(2.0, 0.5), "drift": Prior(-1.0, 0.2)}, drift_start=-3.0),
    )
    names = ("k_inf", "offset@1", "drift@1", "bump")
    fixed, target = random.standard_normal((40, 4)), random.standard_normal(40)
    block = design_block(
        target=target, fixed=fixed, fixed_names=names,
        columns=lambda tau, _: (np.zeros((40, len(tau))),) * 2, window=(0.1, 1.0),
    )  # fmt: skip
    prior = terms.build_rows(block, spread)
    assert prior.fixed_names == names[1:3]
    assert prior.variance == spread**2
    expected = prior.evaluate(np.zeros(0), False)
    neighbour = np.zeros((2, 4))
    neighbour[:, 1:3] = expected.fixed
    both = np.concatenate((fixed, neighbour)), np.concatenate((target, expected.target))
    wanted, residual, *_ = np.linalg.lstsq(*both, rcond=None)
    doubts, mean = terms.build_prior_columns(fixed, names)
    white = marginalise(fixed[:, [3]], doubts / spread)
    result, rest, *_ = np.linalg.lstsq(white(fixed[:, :1]), white(target - mean), rcond=None)
    assert result == pytest.approx(wanted[:1], rel=1e-12)
    assert rest == pytest.approx(residual, rel=1e-12)


def test_prior_of_nuisance_terms_is_limited_by_rounding() -> None:
    record = replace(late(0), machine=dp.Machine(drift=0.0))
    nuisance_terms = build_nuisance_terms(record)
    assert nuisance_terms.priors["drift"].sd == 0.0
    assert nuisance_terms.least_error == 1e-9 * np.abs(record.force).max()
    block = design_block(
        target=np.zeros(3), fixed=np.ones((3, 2)), fixed_names=("offset", "drift"),
        columns=lambda tau, _: (np.zeros((3, len(tau))),) * 2, window=(0.1, 1.0),
    )  # fmt: skip
    for spread, tightest in ((4e-3, 4e-8), (1e-5, nuisance_terms.least_error)):
        rows = nuisance_terms.build_rows(block, spread).evaluate(np.zeros(0), False).fixed
        assert rows[1] == pytest.approx([0.0, spread / tightest])
        # the offset is known in the middle of what was recorded before contact
        assert rows[0, 1] / rows[0, 0] == pytest.approx(build_load_cell_priors(record).offset_time)


def test_a_data_sheet_or_a_long_baseline_tells_the_drift() -> None:
    sheet = replace(late(0), machine=dp.Machine(drift=1e-5, sync=3e-3))
    assert build_load_cell_priors(sheet).drift.sd == pytest.approx(1e-5, rel=1e-3)
    assert build_load_cell_priors(sheet).limit_drift == build_load_cell_priors(sheet).drift
    assert build_load_cell_priors(sheet).delay.sd == 3e-3
    long = simulate_relaxation(PAPER, seed=3, rig=Rig(baseline=60.0, rate=200.0)).test
    load_cell_priors = build_load_cell_priors(prepare(long))
    assert load_cell_priors.drift.sd < 0.5 * build_load_cell_priors(late(0)).drift.sd
    assert load_cell_priors.drift.mean == pytest.approx(0.2e-3, abs=4 * load_cell_priors.drift.sd)


def test_a_single_reading_before_contact_counts() -> None:
    raw = simulate_relaxation(PAPER, seed=4, rig=Rig(encoder=0.0)).test
    moves = int(np.argmax(raw.displacement > 1e-7)) - 1
    test = prepare(
        replace(
            raw,
            time=raw.time[moves:],
            displacement=raw.displacement[moves:],
            force=raw.force[moves:],
        )
    )
    load_cell_priors = build_load_cell_priors(test)
    assert load_cell_priors.offset.sd == pytest.approx(test.force_noise, rel=0.2)
    assert load_cell_priors.offset.mean == pytest.approx(0.05, abs=5 * test.force_noise)
    result = fit(test, arms=2)
    assert abs(result.model.k_inf - PAPER.k_inf) < 3.5 * np.sqrt(result.covariance[0, 0])


@pytest.mark.parametrize("hertz", [None, 10.0, 2.0])
def test_single_reading_error_includes_slow_noise(hertz: float | None) -> None:
    """Neighbours behind a filter differ by a hundredth of it: k_inf was off by twice its error."""
    t, size = np.arange(41_001) / 1000, 0.01
    seal, random = 8e-3 * PAPER, np.random.default_rng(2)
    noise = random.standard_normal(2 * len(t))
    if hertz is not None:
        gain = 1 / (1 + (np.fft.rfftfreq(len(noise), 1e-3) / hertz) ** 4)
        noise = np.fft.irfft(gain * np.fft.rfft(noise), len(noise))
    noise = size * (noise / noise.std())[: len(t)]
    clean = seal.ramp_hold_force(t, depth=1.0, ramp_time=1.0)
    x = 8e-3 * np.clip(t, 0, 1)
    test = RampHold(t, x, clean + noise, 0.0, 1.0, 41.0, 8e-3, machine=dp.Machine(drift=0.0))
    assert build_load_cell_priors(test).offset.sd == pytest.approx(size, rel=0.25)
    result = restrict_to_noise(fit(test, arms=2))
    assert abs(result.model.k_inf - PAPER.k_inf) < 3 * np.sqrt(result.covariance[0, 0])


@pytest.mark.parametrize("samples", [1, 3])
def test_fit_recovers_a_force_delay_without_bias(samples: int) -> None:
    on_time, result = fit(late(0), arms=2), fit(late(samples), arms=2)
    (value, error), (zero, _) = nuisance(result, "delay"), nuisance(on_time, "delay")
    assert value - zero == pytest.approx(1e-3 * samples, rel=0.05)
    assert abs(value - 1e-3 * samples) < 3 * error
    np.testing.assert_allclose(result.model.k, on_time.model.k, rtol=2e-3)
    # ignored, the same lag moves the fast arm by its share of tau
    blind = fit(late(samples), arms=2, nuisance=("offset", "drift"))
    assert blind.model.k[0] / on_time.model.k[0] - 1 < -1.5e-3 * samples


def test_stated_drift_narrows_k_inf_as_a_longer_hold_does() -> None:
    test = prepare(simulate_relaxation(PAPER, seed=5, rig=Rig(drift=0.0)).test)
    unknown, expected = fit(test), fit(replace(test, machine=dp.Machine(drift=1e-6)))
    assert np.sqrt(expected.covariance[0, 0]) < np.sqrt(unknown.covariance[0, 0])
    unknown, expected = restrict_to_noise(unknown), restrict_to_noise(expected)
    assert np.sqrt(expected.covariance[0, 0]) < 0.9 * np.sqrt(unknown.covariance[0, 0])
    assert abs(expected.model.k_inf - PAPER.k_inf) < 3 * np.sqrt(expected.covariance[0, 0]) + 0.3


def test_an_offset_cannot_take_what_a_wrong_law_leaves() -> None:
    """Free, it took four fifths of the equilibrium stiffness of a real tape."""
    rig = Rig(stiffening=4843.7, bias=0.0)
    test = prepare(simulate_relaxation(PAPER * 0.7634, seed=6, rig=rig).test)
    bound = fit(test, law="linear")
    assert bound.model.k_inf == pytest.approx(196.5, rel=0.01)
    assert abs(nuisance(bound, "offset")[0]) < 1e-3


@pytest.mark.parametrize("method", ["full", "hold"])
def test_fit_without_intervals_has_the_same_optimum(method: str) -> None:
    test = late(0)
    whole, single = (fit(test, arms=2, method=method, intervals=way) for way in (True, False))
    assert single.model == whole.model
    assert [n.value for n in single.estimate.nuisance] == [n.value for n in whole.estimate.nuisance]
    assert single.verdict.use == "use with care"
    # neither a band nor an error is reported where none was asked for
    assert single.verdict.message == (
        "This fit has neither intervals nor checks. Fit with intervals before use."
    )
    assert single.intervals()["k_inf"] == (0.0, np.inf)
    assert from_json(to_json(single)).model == single.model


@pytest.mark.slow
def test_intervals_hold_the_truth_on_the_default_rig() -> None:
    """100 seeds, hum, drift, counts and all: 0.91 to 1.00 measured."""
    truth = np.array((PAPER.k_inf, *PAPER.k, *PAPER.tau))
    inside = []
    for seed in range(100):
        result = fit(prepare(simulate_relaxation(PAPER, seed=seed).test), arms=2)
        intervals = result.intervals()
        ends = np.array((intervals["k_inf"], *intervals["k"], *intervals["tau"]))
        inside.append((ends[:, 0] <= truth) & (truth <= ends[:, 1]))
    assert np.mean(inside, axis=0).min() > 0.88
