"""Fits of real records: muscle at four ramp times, an AFM hold that creeps."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from dashpot.base.errors import FitError, Status
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.relaxation import fit

RAMPS = (0.1, 1.0, 10.0, 100.0)


def titin(folder: Path, ramp: float) -> RampHold:
    """Stretch from 0.95 to 1.175 in `ramp` seconds from t = 2 s; units not stated, taken as SI."""
    path = folder / "titin-ramp-hold" / f"AvgRelaxed_{ramp:g}s.csv"
    time, length, force = np.loadtxt(path, delimiter=",", skiprows=1, usecols=(0, 1, 2)).T
    stretch = length - length[0]
    end = 2.0 + ramp
    depth = float(stretch[time >= end].mean())
    return RampHold(time, stretch, force, 2.0, end, float(time[-1]), depth)


def test_fit_of_the_1_s_ramp_predicts_the_other_peaks(real_data: Path) -> None:
    tests = {ramp: titin(real_data, ramp) for ramp in RAMPS}
    result = fit(tests[1.0], method="hold")
    assert result.status is Status.CONVERGED
    assert result.model.arms == 2
    # the same hold read as if the stretch had been a step at the end of the ramp
    step = fit(replace(tests[1.0], onset=tests[1.0].ramp_end - 1e-6), arms=2, method="hold").model

    def miss(force: float, peak: float) -> float:
        return abs(float(np.log(force / peak)))

    with_ramp, as_step = [], []
    for ramp in (0.1, 10.0, 100.0):
        test, peak = tests[ramp], float(tests[ramp].force.max())
        forecast = result.model.ramp_hold_force(ramp, depth=test.depth, ramp_time=ramp)
        with_ramp.append(miss(float(forecast), peak))
        as_step.append(miss(step.k_0 * test.depth, peak))
    assert sum(with_ramp) < 0.65 * sum(as_step)


def test_four_ramp_times_share_relaxation_times(real_data: Path) -> None:
    tests = [titin(real_data, ramp) for ramp in RAMPS]
    result = fit(tests, arms=3, method="hold")
    assert result.model.arms == 3
    assert result.model.tau[0] < 1.0 < result.model.tau[-1]
    # each ramp time sees its own decade: together they reach further than the 1 s ramp alone
    single = fit(tests[1], arms=2, method="hold")
    assert result.model.tau[-1] / result.model.tau[0] > single.model.tau[-1] / single.model.tau[0]


def afm(folder: Path) -> RampHold:
    """Approach and pause of the AFM record, contact where the force leaves its baseline."""
    path = folder / "rheosafm-jpk-relaxation" / "AFM_relaxation.txt"
    with path.open() as lines:
        data = (line for line in lines if line.strip() and not line.startswith("#"))
        rows = np.array([line.split() for line in islice(data, 75_800)], dtype=float)
    position, force, time = -rows[:, 0], rows[:, 1], rows[:, 2]
    tare = force[:200].mean()
    scatter = float(np.diff(force[:200]).std() / np.sqrt(2))
    contact = int(np.flatnonzero(force - tare > 8 * scatter)[0])
    displacement = np.maximum(position - position[contact], 0.0)
    displacement[:contact] = 0.0
    ramp_end = float(time[799])
    depth = float(displacement[time >= ramp_end].mean())
    return RampHold(
        time, displacement, force - tare, float(time[contact]), ramp_end, float(time[-1]), depth,
        force_noise=scatter,
    )  # fmt: skip


@pytest.fixture(scope="module")
def afm_test(shared_data: Path) -> RampHold:
    return afm(shared_data)


def test_the_afm_hold_creeps_and_eq_5_is_refused(afm_test: RampHold) -> None:
    with pytest.raises(FitError, match="fit ramp and hold instead"):
        fit(afm_test, arms=1, method="hold")


def test_fit_of_the_afm_record_uses_its_recorded_motion(afm_test: RampHold) -> None:
    result = fit(afm_test, arms=2)
    still = replace(
        afm_test,
        displacement=np.minimum(afm_test.displacement, afm_test.displacement[afm_test.hold.start]),
    )
    stopped = fit(still, arms=2)
    # but for the samples before the tip may have moved
    assert 0.99 * len(afm_test.time) < result.estimate.residual.n < len(afm_test.time) == 75_800
    assert result.estimate.residual.rms < 0.02 * afm_test.force.max()
    # a plate taken to stand still turns its creep into relaxation that was not there
    assert stopped.model.k_inf != pytest.approx(result.model.k_inf, rel=0.02)
    check = next(check for check in result.checks if check.name == "hold_is_still")
    assert check.passed
    assert check.value is not None
    assert check.value > 0.01
    assert "recorded motion" in check.message


@pytest.mark.parametrize("ramp", [0.1, 1, 10, 100])
def test_muscle_keeps_the_stiffness_of_its_hold(real_data: Path, ramp: float) -> None:
    """A linear solid with a free offset put it 46 to 70 % off."""
    test = titin(real_data, ramp)
    result = fit(test)
    assert result.elastic_law is not None
    assert result.elastic_law.kind == "piecewise"
    assert result.stiffness_limits is not None
    low, high = result.stiffness_limits["k_end"]
    last = float(test.force[test.hold][-1]) / test.depth
    assert 0.95 * low < last < 1.05 * high
    assert abs(float(result.model.relaxation(test.hold_time)) / last - 1) < 0.05 or (
        result.verdict.use == "do not use"
    )


def test_the_afm_follows_a_bent_law(afm_test: RampHold) -> None:
    result = fit(afm_test)
    assert result.elastic_law is not None
    assert result.elastic_law.kind == "piecewise"
    assert result.verdict.use != "do not use"
    last = float(afm_test.force[afm_test.hold][-500:].mean()) / afm_test.depth
    assert float(result.model.relaxation(afm_test.hold_time)) == pytest.approx(last, rel=0.05)
