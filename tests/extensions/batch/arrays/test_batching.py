"""Thousands of records in one call: the single fit's result, and a status for each."""

from __future__ import annotations

import numpy as np
import pytest
from kit.fits import formal_errors, restrict_to_noise
from scipy.signal import lfilter

from dashpot.base.errors import DataError, FitError, Status
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.extensions.batch.arrays.fit_many import fit_many
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.solids.maxwell import GeneralizedMaxwell

TIME = np.arange(4101) / 100
X = 8e-3 * np.minimum(TIME, 1.0)
SEALS = [
    GeneralizedMaxwell(196.5 * s, k=(117.5, 17.8 * s), tau=(0.5021 * s, 16.416)) for s in (1, 1.3)
]


def forces(history: str) -> np.ndarray:
    generator = np.random.default_rng(4)
    clean = [
        seal.ramp_hold_force(TIME, depth=8e-3, ramp_time=1.0)
        if history == "ideal"
        else seal.force(TIME, X)
        for seal in SEALS
    ]
    return np.array(clean) + 1e-3 * generator.standard_normal((2, len(TIME)))


@pytest.mark.parametrize("method", ["full", "hold"])
@pytest.mark.parametrize("history", ["ideal", "recorded"])
def test_every_seal_comes_back(history: str, method: str) -> None:
    choice = {"ramp": (8e-3, 1.0)} if history == "ideal" else {"displacement": X}
    many = fit_many(TIME, forces(history), arms=2, method=method, **choice)
    assert len(many) == 2
    assert many.status == (Status.CONVERGED, Status.CONVERGED)
    for row, seal in enumerate(SEALS):
        np.testing.assert_allclose(many.k[row], seal.k, rtol=0.03)
        np.testing.assert_allclose(many.tau[row], seal.tau, rtol=0.03)
        assert many.k_inf[row] == pytest.approx(seal.k_inf, rel=2e-3)
        assert many.sse[row] == pytest.approx(1e-6 * len(TIME), rel=0.1)


def test_a_jittered_clock_goes_record_by_record() -> None:
    time = TIME + np.where(TIME > 0, 1e-3 * np.random.default_rng(0).uniform(-1, 1, len(TIME)), 0)
    x = 8e-3 * np.minimum(time, 1.0)
    data = np.array([SEALS[0].force(time, x)])[:, :2000]
    data = data + 1e-4 * np.random.default_rng(1).standard_normal(data.shape)
    many = fit_many(time[:2000], data, displacement=x[:2000], arms=1)
    assert many.status == (Status.CONVERGED,)


def test_each_failure_has_its_status() -> None:
    data = np.vstack([forces("recorded"), forces("recorded"), forces("recorded")])
    data[1, 3] = np.inf
    data[2] = 0.0
    data[3] = 100.0 * X
    data[4] = -data[4]
    many = fit_many(TIME, data, displacement=X, arms=2)
    assert [status.name for status in many.status] == [
        "CONVERGED",
        "NO_DATA",
        "FEWER_ARMS",
        "FEWER_ARMS",
        "FEWER_ARMS",
        "CONVERGED",
    ]
    assert np.isnan(many.k_inf[1])
    assert many.k_inf[3] == pytest.approx(100.0)
    assert np.isnan(many.k[3]).all()


@pytest.mark.parametrize(("arms", "status"), [(1, Status.TAU_AT_BOUND), (2, Status.FEWER_ARMS)])
def test_batched_fit_status_equals_single_fit_status(arms: int, status: Status) -> None:
    """A steady fall is one arm at the end of what the record can show, and no more."""
    record = 100.0 * X - 1e-4 * np.maximum(TIME - 1.0, 0.0)
    held = RampHold(TIME, X, record, 0.0, 1.0, TIME[-1], X[-1])
    single = fit(held, arms=arms, nuisance=(), intervals=False)
    many = fit_many(TIME, record, displacement=X, arms=arms)
    assert many.tau[0, 0] == pytest.approx(single.model.tau[0])
    assert many.status == (single.status,) == (status,)


@pytest.mark.parametrize("choice", [{"ramp": (8e-3, 1.0)}, {"displacement": X}])
@pytest.mark.parametrize("method", ["full", "hold"])
@pytest.mark.parametrize("memory", [0.0, 0.02])
def test_errors_are_the_scatter_of_the_estimates(
    choice: dict[str, object], method: str, memory: float
) -> None:
    """White noise, and noise that remembers 20 ms: two samples, where the record has 4101."""
    seal, count = SEALS[0], 200
    noise = np.random.default_rng(8).standard_normal((count, len(TIME)))
    if memory:
        decay = np.exp(-0.01 / memory)
        noise = lfilter([np.sqrt(1 - decay**2)], [1.0, -decay], noise, axis=1)
    data = seal.force(TIME, X) + 1e-3 * noise
    many = fit_many(TIME, data, arms=2, method=method, errors=True, **choice)
    assert many.errors is not None
    for value, error, truth in (
        (many.k_inf, many.errors.k_inf, seal.k_inf),
        *zip(many.k.T, many.errors.k.T, seal.k, strict=True),
        *zip(many.tau.T, many.errors.tau.T, seal.tau, strict=True),
    ):
        assert np.std((value - truth) / error) == pytest.approx(1.0, abs=0.2)


def test_errors_are_those_of_the_single_fit() -> None:
    data = forces("recorded")
    many = fit_many(TIME, data, displacement=X, arms=2, method="hold", errors=True)
    assert many.errors is not None
    for row in range(2):
        test = RelaxationTest(time=TIME, displacement=X, force=data[row], units="SI")
        single = formal_errors(
            restrict_to_noise(fit(prepare(test), arms=2, method="hold", nuisance=()))
        )
        assert many.errors.k_inf[row] == pytest.approx(single["k_inf"], rel=0.25)
        np.testing.assert_allclose(many.errors.k[row], single["k"], rtol=0.25)
        np.testing.assert_allclose(many.errors.tau[row], single["tau"], rtol=0.25)


def test_no_arm_no_error_and_no_knowledge_no_end() -> None:
    data = np.array([100.0 * X, np.full(len(TIME), np.nan)])
    many = fit_many(TIME, data, displacement=X, arms=1, errors=True)
    assert many.errors is not None
    assert np.isfinite(many.errors.k_inf[0])
    assert np.isnan(many.errors.tau[0]).all()
    assert np.isnan(many.errors.k_inf[1])
    assert fit_many(TIME, data, displacement=X, arms=1).errors is None


def test_refusals_say_what_was_expected() -> None:
    data = forces("ideal")
    with pytest.raises(DataError, match="one column per time"):
        fit_many(TIME[:-1], data, ramp=(8e-3, 1.0))
    with pytest.raises(DataError, match="the history must be given once"):
        fit_many(TIME, data)
    with pytest.raises(DataError, match="the history must be given once"):
        fit_many(TIME, data, displacement=X, ramp=(8e-3, 1.0))
    with pytest.raises(DataError, match="depth > 0"):
        fit_many(TIME, data, ramp=(0.0, 1.0))
    with pytest.raises(DataError, match="never positive"):
        fit_many(TIME, data, displacement=-X)
    with pytest.raises(DataError, match="displacement has"):
        fit_many(TIME, data, displacement=X[1:])
    with pytest.raises(FitError, match="at least one"):
        fit_many(TIME, data, displacement=X, arms=0)
