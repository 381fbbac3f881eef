"""What a relaxation test cannot see: bands over all non-negative spectra."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.fits import altered

from dashpot.base.errors import DataError
from dashpot.fitting.relaxation import fit
from dashpot.fitting.relaxation_data import relaxation_data
from dashpot.fitting.uncertainty.admissible_spectra import Spectra
from dashpot.fitting.uncertainty.prediction_bounds import frf_band, parameter_band, unseen_arm_band
from dashpot.preparation.prepare import prepare
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF
from dashpot.records.relaxation import RampHold
from dashpot.simulation.relaxation import Rig, simulate_relaxation
from dashpot.solids.table_1 import BROAD, BROAD_MASS, PAPER

AT = np.array([0.05, 0.3, 1.0, 5.0, 12.71, 30.0])


def test_the_truth_lies_in_the_unseen_arm_band(broad_fit: Fit, broad_test: RampHold) -> None:
    band = unseen_arm_band(broad_fit, broad_test, AT, level=0.99)
    truth = BROAD.complex_stiffness(2 * np.pi * AT)
    for limits, value in (
        (band.storage, truth.real),
        (band.loss, truth.imag),
        (band.loss_factor, truth.imag / truth.real),
    ):
        assert (limits[0] <= value).all()
        assert (value <= limits[1]).all()


def test_the_band_opens_where_the_test_is_blind(broad_fit: Fit, broad_test: RampHold) -> None:
    band = unseen_arm_band(broad_fit, broad_test, AT)
    width = (band.loss[1] - band.loss[0]) / BROAD.loss(2 * np.pi * AT)
    assert width[1] < 0.05  # 0.3 Hz: the hold sees it
    assert width[4] > 1.0  # 12.71 Hz: it does not
    assert width[5] > width[4]


def test_the_formal_band_of_two_arms_is_absurdly_narrow() -> None:
    """Table 1 alone: 1e-5 of formal error where the true loss is six times as large."""
    test = prepare(simulate_relaxation(BROAD, seed=5).test)
    hold = fit(test, arms=2, method="hold")
    formal = parameter_band(hold, [12.71])
    unseen = unseen_arm_band(hold, test, [12.71])
    truth = BROAD.loss_factor(2 * np.pi * 12.71)
    assert formal.loss_factor[1, 0] < truth / 3
    assert np.ptp(formal.loss_factor) < 0.1 * truth
    assert unseen.loss_factor[0, 0] < truth < unseen.loss_factor[1, 0]


def test_the_measured_frf_lies_in_the_band(
    broad_fit: Fit, broad_test: RampHold, broad_frf: FRF
) -> None:
    lines = broad_frf.band(5, 30)
    band = frf_band(
        broad_fit, broad_test, mass=BROAD_MASS, seals=2, frequency=lines.frequency, level=0.99
    )
    measured = np.abs(lines.value)
    inside = (measured >= band.unseen[0]) & (measured <= band.unseen[1])
    formal = (measured >= band.parameter[0]) & (measured <= band.parameter[1])
    assert inside.mean() > 0.97
    assert formal.mean() < inside.mean()
    assert (band.unseen[0] <= band.magnitude * (1 + 1e-6)).all()
    assert (band.parameter[0] <= band.magnitude).all()


def test_a_faster_ramp_narrows_the_band() -> None:
    widths = []
    for ramp_time in (1.0, 0.1):
        # fast sampling: a delay of one sample is as uncertain as the fast arms
        t = np.arange(0, 20.0, 0.0002)
        x = 8e-3 * np.clip((t - 0.5) / ramp_time, 0, 1)
        noise = 2e-3 * np.random.default_rng(1).standard_normal(len(t))
        end = 0.5 + ramp_time
        held = RampHold(t, x, BROAD.force(t, x) + noise, 0.5, end, float(t[-1]), 8e-3)
        band = unseen_arm_band(fit(held), held, [12.71])
        widths.append(float(np.ptp(band.loss)))
    assert widths[1] < 0.5 * widths[0]


def test_the_edge_is_where_the_deviance_meets_its_limit(
    broad_fit: Fit, broad_test: RampHold
) -> None:
    """Against a slow obvious form: scan the target and profile it with NNLS."""
    from scipy.optimize import nnls

    spectra = Spectra([relaxation_data(broad_test, broad_fit)], fastest=80.0, limit=4.0)
    storage, loss = spectra.columns_at(2 * np.pi * 5.0)
    low, high = spectra.reach(loss)
    row = loss / spectra.scale

    def deviance(t: float) -> float:
        weight = 1e5 / t
        rows = np.vstack((spectra.rows, weight * row))
        k, _ = nnls(rows, np.append(spectra.target, weight * t), maxiter=100000)
        return float(np.sum((spectra.rows @ k - spectra.target) ** 2)) - spectra.least

    assert deviance(high) == pytest.approx(4.0, rel=0.02)
    assert deviance(low) == pytest.approx(4.0, rel=0.02)
    assert deviance(1.05 * high) > 4.0
    assert deviance(0.95 * low) > 4.0
    ratio = spectra.ratio_reach(loss, storage)
    best = spectra.value(loss) / spectra.value(storage)
    assert ratio[0] < best < ratio[1]


def test_a_higher_level_is_a_wider_band(broad_fit: Fit, broad_test: RampHold) -> None:
    narrow = unseen_arm_band(broad_fit, broad_test, [5.0], level=0.68)
    wide = unseen_arm_band(broad_fit, broad_test, [5.0], level=0.99)
    assert wide.loss[0] < narrow.loss[0]
    assert wide.loss[1] > narrow.loss[1]


def test_many_frequencies_are_laid_through_smoothly(broad_fit: Fit, broad_test: RampHold) -> None:
    many = np.geomspace(0.1, 40, 200)
    band = unseen_arm_band(broad_fit, broad_test, many)
    some = unseen_arm_band(broad_fit, broad_test, many[::40])
    assert band.loss[1, ::40] == pytest.approx(some.loss[1], rel=0.1)
    assert band.storage[:, ::40] == pytest.approx(some.storage, rel=0.02)


@pytest.mark.slow
def test_the_bands_cover_over_seeds() -> None:
    omega = 2 * np.pi * AT
    K = BROAD.complex_stiffness(omega)
    hits = np.zeros((3, len(AT)))
    for seed in range(20):
        rig = (Rig(), replace(Rig(), encoder=0.013e-3), replace(Rig(), position_noise=3e-6))[
            seed % 3
        ]
        test = prepare(simulate_relaxation(BROAD, seed=seed, rig=rig).test)
        band = unseen_arm_band(fit(test), test, AT, level=0.95)
        for i, (limits, value) in enumerate(
            ((band.storage, K.real), (band.loss, K.imag), (band.loss_factor, K.imag / K.real))
        ):
            hits[i] += (limits[0] <= value) & (value <= limits[1])
    assert (hits >= 17).all()


def test_what_cannot_be_is_refused(broad_fit: Fit, broad_test: RampHold) -> None:
    with pytest.raises(DataError, match="a band needs frequencies > 0"):
        unseen_arm_band(broad_fit, broad_test, [0.0, 1.0])
    with pytest.raises(DataError, match="expected a coverage between 0 and 1"):
        parameter_band(broad_fit, [1.0], level=95)
    with pytest.raises(DataError, match="the fit of that test"):
        unseen_arm_band(altered(broad_fit, method="joint"), broad_test, [1.0])
    with pytest.raises(DataError, match="no relaxation test"):
        unseen_arm_band(broad_fit, [], [1.0])
    with pytest.raises(DataError, match="mass = 0"):
        frf_band(broad_fit, broad_test, mass=0, frequency=[1.0, 2.0])


def test_a_seal_without_fast_arms_keeps_its_loss_within_the_band() -> None:
    test = prepare(simulate_relaxation(PAPER, seed=2).test)
    band = unseen_arm_band(fit(test), test, [12.71], level=0.99)
    truth = PAPER.loss(2 * np.pi * 12.71)
    assert band.loss[0, 0] <= truth <= band.loss[1, 0]
