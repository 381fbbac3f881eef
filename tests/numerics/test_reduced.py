"""A block of many rows as one of a hundred."""

from __future__ import annotations

import time as clock
from dataclasses import replace

import numpy as np
import pytest

from dashpot.datamodel.fit import Fit
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.prediction_bounds import unresolved_arm_band
from dashpot.numerics.design_matrices.data_compression import reduced_block
from dashpot.numerics.design_matrices.recorded_motion import recursion_block
from dashpot.solids.demo_seals import BROAD


def test_it_is_the_block_in_other_coordinates() -> None:
    draw = np.random.default_rng(1)
    t = np.sort(draw.uniform(0, 20, 3000))
    x = 8e-3 * np.clip(t - 0.5, 0, 1)
    force = BROAD.force(t - t[0], x) + 1e-3 * draw.standard_normal(len(t))
    fixed = {"k_inf": x, "offset": np.ones(len(t))}
    whole = recursion_block(t, x, force, window=slice(0, len(t)), fixed=fixed)
    few = reduced_block(whole, tau_range=(1e-5, 1e3))
    assert len(few.target) < 140
    assert few.samples == 3000
    log_tau = np.log([3e-5, 2e-3, 0.0137, 0.31, 5.0, 270.0])
    a, b = whole.evaluate(log_tau), few.evaluate(log_tau)
    for rows_a, rows_b in ((a.arms, b.arms), (a.d_arms, b.d_arms)):
        size = np.abs(rows_a.T @ rows_a).max()
        assert rows_b.T @ rows_b == pytest.approx(rows_a.T @ rows_a, abs=1e-6 * size)
        assert rows_b.T @ b.target == pytest.approx(rows_a.T @ a.target, rel=1e-5, abs=1e-9)
    k = np.array([0.0, 20.0, 15.0, 40.0, 20.0, 10.0])
    misfit_a = a.target - a.fixed @ [196.0, 0.0] - a.arms @ k
    misfit_b = b.target - b.fixed @ [196.0, 0.0] - b.arms @ k
    assert misfit_b @ misfit_b + few.floor == pytest.approx(misfit_a @ misfit_a, rel=1e-6)


def test_the_band_on_an_uneven_clock(broad_fit: Fit, broad_test: RampHold) -> None:
    """The same record with its clock shaken by less than its samples: the same band, soon."""
    step = np.diff(broad_test.time)[0]
    shake = 0.1 * step * np.random.default_rng(3).uniform(-1, 1, len(broad_test.time))
    # on a machine that is known: unknown clocks leave the highest storage to the noise alone
    expected = replace(broad_test, machine=Machine(sync="1ms", compliance=0.0, drift="20uN/s"))
    shaken = replace(expected, time=expected.time + shake)
    even = unresolved_arm_band(broad_fit, expected, [1.0, 12.71])
    start = clock.process_time()
    noise_gain_differs = unresolved_arm_band(broad_fit, shaken, [1.0, 12.71])
    assert clock.process_time() - start < 20
    assert noise_gain_differs.storage == pytest.approx(even.storage, rel=0.02)
    assert noise_gain_differs.loss[:, 0] == pytest.approx(even.loss[:, 0], rel=0.05)
