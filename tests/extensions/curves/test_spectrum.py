"""Dense spectra of master curves, and the fewest arms behind a relaxation modulus."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.base.errors import DataError, FitError, Status
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.extensions.curves.modulus.fit import fit_modulus
from dashpot.extensions.curves.relaxation_spectrum import dynamic_master_curve, master_curve
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.workflow.json_archive import from_json, to_json

GLASS = GeneralizedMaxwell(
    5.0, k=tuple(np.geomspace(900, 10, 12)), tau=tuple(np.geomspace(1e-6, 1e6, 12))
)
LIQUID = GeneralizedMaxwell(0.0, k=(1.0, 1.0, 1.0, 1.0), tau=(0.05, 0.5, 5.0, 50.0))


def sweep(model: GeneralizedMaxwell, frequency: np.ndarray) -> DynamicTest:
    value = model.complex_stiffness(omega=2 * np.pi * frequency)
    return DynamicTest(frequency, value.real, value.imag, units="SI")


def solids() -> st.SearchStrategy[GeneralizedMaxwell]:
    """Up to three arms between 1e-2 s and 1e2 s."""
    arms = st.lists(st.tuples(st.floats(0.2, 5.0), st.floats(-2.0, 2.0)), min_size=1, max_size=3)
    return st.builds(
        lambda k_inf, pairs: GeneralizedMaxwell(
            k_inf, tuple(k for k, _ in pairs), tuple(10**t for _, t in pairs)
        ),
        st.floats(0.1, 5.0),
        arms,
    )


# -- laws -----------------------------------------------------------------------------------------


@given(solids(), st.floats(1e-3, 1e9))
@settings(max_examples=25, deadline=None)
def test_a_dense_spectrum_scales_with_the_unit(model: GeneralizedMaxwell, unit: float) -> None:
    t = np.geomspace(1e-3, 1e3, 60)
    fit, scaled = (master_curve(t, factor * model.relaxation(t)) for factor in (1.0, unit))
    assert scaled.rms == pytest.approx(fit.rms, rel=1e-3, abs=1e-7)
    np.testing.assert_allclose(
        scaled.model.relaxation(t), unit * fit.model.relaxation(t), rtol=1e-5
    )


@given(solids(), st.floats(-6.0, 6.0))
@settings(max_examples=25, deadline=None)
def test_a_dense_spectrum_moves_with_the_clock(model: GeneralizedMaxwell, decades: float) -> None:
    f = np.geomspace(1e-3, 1e2, 50)
    shift = 10.0**decades
    slow = GeneralizedMaxwell(model.k_inf, model.k, tuple(tau / shift for tau in model.tau))
    item, variant = (
        dynamic_master_curve(sweep(model, f)),
        dynamic_master_curve(sweep(slow, shift * f)),
    )
    assert variant.rms == pytest.approx(item.rms, rel=1e-3, abs=1e-7)
    np.testing.assert_allclose(np.array(variant.grid) * shift, item.grid, rtol=1e-9)


@given(
    st.lists(st.tuples(st.floats(0.2, 5.0), st.integers(2, 18)), min_size=1, max_size=4),
    st.sampled_from([0.0, 1.0]),
)
@settings(max_examples=25, deadline=None)
def test_arms_that_stand_on_the_grid_are_followed_exactly(
    pairs: list[tuple[float, int]], k_inf: float
) -> None:
    """Over frequency a liquid too; over time the curve must not fall to nothing."""
    k, t, f = tuple(k for k, _ in pairs), np.geomspace(1e-3, 1e3, 60), np.geomspace(1e-3, 1e2, 50)
    grid = np.array(master_curve(t, GLASS.relaxation(t)).grid)
    model = GeneralizedMaxwell(k_inf or 0.1, k, tuple(grid[i] for _, i in pairs))
    assert master_curve(t, model.relaxation(t)).rms < 1e-4
    grid = np.array(dynamic_master_curve(sweep(GLASS, f)).grid)
    model = GeneralizedMaxwell(k_inf, k, tuple(grid[i] for _, i in pairs))
    assert dynamic_master_curve(sweep(model, f)).rms < 1e-4


def test_a_sharp_arm_between_two_of_the_grid_is_followed_to_five_per_cent() -> None:
    f = np.geomspace(1e-3, 1e2, 50)
    grid = np.array(dynamic_master_curve(sweep(GLASS, f)).grid)
    between = GeneralizedMaxwell(0.0, (1.0,), (float(np.sqrt(grid[9] * grid[10])),))
    errors = [dynamic_master_curve(sweep(between, f), per_decade=n).rms for n in (2, 4, 8)]
    assert errors[1] < 0.05
    assert errors[2] < 0.5 * errors[1]
    assert errors[1] < 0.5 * errors[0]


@given(st.permutations(range(30)))
@settings(max_examples=10, deadline=None)
def test_the_order_of_a_sweep_does_not_matter(order: list[int]) -> None:
    f = np.geomspace(1e-3, 1e3, 30)
    item, mixed = (
        dynamic_master_curve(sweep(GLASS, f)),
        dynamic_master_curve(sweep(GLASS, f[order])),
    )
    assert mixed.rms == pytest.approx(item.rms, rel=1e-6)


# -- what it is for -------------------------------------------------------------------------------


def test_a_curve_over_many_decades_is_followed_closely() -> None:
    t = np.geomspace(1e-7, 1e8, 400)
    result = master_curve(t, GLASS.relaxation(t), per_decade=6)
    assert result.max_error < 0.005
    assert result.model.k_inf == pytest.approx(5.0, rel=1e-3)
    assert result.band == pytest.approx((1 / (2 * np.pi * 1e8), 1 / (2 * np.pi * 1e-7)))


def test_reported_misfit_is_that_of_the_returned_model() -> None:
    t = np.geomspace(1e-7, 1e8, 100)
    noise = 1 + 0.02 * np.random.default_rng(0).standard_normal(len(t))
    modulus = GLASS.relaxation(t) * noise
    result = master_curve(t, modulus)
    error = result.model.relaxation(t) / modulus - 1
    assert result.rms == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-9)
    assert result.max_error == pytest.approx(np.abs(error).max(), rel=1e-9)
    assert result.misfit[0].at == t[np.argmax(np.abs(error))]

    f = np.geomspace(1e-7, 1e5, 80)
    exact = sweep(GLASS, f)
    data = DynamicTest(f, exact.storage * noise[:80], exact.loss * noise[20:], units="SI")
    both = dynamic_master_curve(data)
    for misfit, fitted, measured in (
        (both.misfit[0], both.model.storage(omega=data.omega), data.storage),
        (both.misfit[1], both.model.loss(omega=data.omega), data.loss),
    ):
        assert misfit.rms == pytest.approx(np.sqrt(np.mean((fitted / measured - 1) ** 2)), rel=1e-9)


def test_dense_spectrum_equals_scipy_nnls() -> None:
    """Against scipy's NNLS on the same columns."""
    from scipy.optimize import nnls

    t = np.geomspace(1e-5, 1e5, 150)
    modulus = GLASS.relaxation(t) * (1 + 0.01 * np.random.default_rng(1).standard_normal(len(t)))
    result = master_curve(t, modulus)
    columns = np.column_stack((np.ones(len(t)), np.exp(-t[:, None] / np.array(result.grid))))
    _, rest = nnls(columns / modulus[:, None], np.ones(len(t)))
    assert result.rms * np.sqrt(len(t)) == pytest.approx(rest, rel=1e-6)


# -- the fewest arms ------------------------------------------------------------------------------


def test_exact_modes_come_back_exactly_without_a_junk_arm() -> None:
    t = np.geomspace(1e-3, 100, 100)
    fit = fit_modulus(t, LIQUID.relaxation(t))
    assert fit.status is Status.CONVERGED
    assert fit.model.k == pytest.approx(LIQUID.k, rel=1e-6)
    assert fit.model.tau == pytest.approx(LIQUID.tau, rel=1e-6)
    assert fit.model.k_inf == pytest.approx(0.0, abs=1e-7)
    assert fit.evidence.certificate is not None
    assert fit.evidence.certificate.optimal
    assert (fit.method, fit.unit) == ("modulus", "Pa")


@given(solids(), st.sampled_from([1.0, 1e6]))
@settings(max_examples=15, deadline=None)
def test_fit_modulus_recovers_arms_spaced_by_a_decade(
    model: GeneralizedMaxwell, unit: float
) -> None:
    spread = GeneralizedMaxwell(
        model.k_inf, model.k, tuple(10.0 ** (i - 1) for i in range(model.arms))
    )
    t = np.geomspace(1e-3, 100, 120)
    fit = fit_modulus(t, unit * spread.relaxation(t))
    assert fit.model.arms == spread.arms
    assert fit.model.tau == pytest.approx(spread.tau, rel=1e-5)
    assert np.array(fit.model.k) / unit == pytest.approx(spread.k, rel=1e-5)


def test_a_fit_in_pascal_survives_the_archive() -> None:
    t = np.geomspace(1e-3, 100, 50)
    fit = fit_modulus(t, 1e6 * LIQUID.relaxation(t), arms=2)
    assert from_json(to_json(fit)) == fit
    assert from_json(to_json(fit)).unit == "Pa"


def test_noise_that_crosses_zero_is_fitted_with_uniform_weights() -> None:
    t = np.linspace(0.1, 300, 200)
    modulus = GeneralizedMaxwell(0.0, (1.0, 1.0), (5.0, 50.0)).relaxation(t)
    modulus = modulus + 0.01 * np.random.default_rng(3).standard_normal(len(t))
    with pytest.raises(DataError, match=r"relative weights need values > 0.*weights='uniform'"):
        fit_modulus(t, modulus)
    tau = fit_modulus(t, modulus, weights="uniform").intervals(level=0.99)["tau"]
    assert len(tau) == 2
    assert tau[0][0] < 5.0 < tau[0][1]
    assert tau[1][0] < 50.0 < tau[1][1]


def test_large_noise_brings_no_bias() -> None:
    """Weights by the size of the data themselves would lower every stiffness by 2 %."""
    t, solid = np.geomspace(1e-3, 10, 60), GeneralizedMaxwell(1.0, (2.0,), (0.1,))
    noise = 1 + 0.1 * np.random.default_rng(0).standard_normal((40, len(t)))
    result = [fit_modulus(t, row * solid.relaxation(t), arms=1).model.k_0 for row in noise]
    assert np.mean(result) == pytest.approx(solid.k_0, rel=0.008)


# -- what is refused ------------------------------------------------------------------------------


def test_a_master_curve_needs_positive_times_and_moduli() -> None:
    with pytest.raises(DataError, match=r"time\[0\] = 0; expected > 0"):
        master_curve([0.0, 1.0, 2.0], [3.0, 2.0, 1.0])
    with pytest.raises(DataError, match=r"modulus\[2\] = -1; .*drowns in noise"):
        master_curve([1.0, 2.0, 3.0], [3.0, 2.0, -1.0])
    with pytest.raises(DataError, match="time must increase strictly"):
        master_curve([1.0, 1.0, 3.0], [3.0, 2.0, 1.0])
    with pytest.raises(DataError, match=r"storage\[1\] = -2; expected > 0"):
        dynamic_master_curve(
            DynamicTest(np.array([1.0, 2.0]), np.array([2.0, -2.0]), np.ones(2), units="SI")
        )


@pytest.mark.parametrize("per_decade", [0, -1, 25, float("nan")])
def test_a_senseless_grid_is_refused(per_decade: float) -> None:
    with pytest.raises(FitError, match="expected a number of relaxation times per decade"):
        master_curve([1.0, 2.0, 3.0], [3.0, 2.0, 1.0], per_decade=per_decade)


def test_senseless_options_of_a_modulus_fit_are_refused() -> None:
    t, modulus = np.arange(1.0, 9.0), np.linspace(2.0, 1.0, 8)
    with pytest.raises(FitError, match="unit = 'MPa'; expected 'Pa' or 'N/m'"):
        fit_modulus(t, modulus, unit="MPa")
    with pytest.raises(FitError, match="weights = 'none'; expected 'relative' or 'uniform'"):
        fit_modulus(t, modulus, weights="none")  # type: ignore[arg-type]
    with pytest.raises(FitError, match='arms = -1; expected "auto" or a whole number'):
        fit_modulus(t, modulus, arms=-1)
    with pytest.raises(FitError, match="8 samples cannot determine 11 parameters"):
        fit_modulus(t, modulus, arms=5)
    with pytest.raises(DataError, match="time begins at -1 s; expected the time since the step"):
        fit_modulus(t - 2, modulus)


# -- real data ------------------------------------------------------------------------------------


def columns_of(file: Path, **options: object) -> tuple[np.ndarray, ...]:
    return tuple(np.loadtxt(file, unpack=True, **options))  # type: ignore[call-overload]


def test_a_relaxation_master_curve_over_31_decades(real_data: Path) -> None:
    t, modulus = columns_of(
        real_data / "pyvisco-master-curves" / "time_user_master.csv", delimiter=",", skiprows=2
    )
    result = master_curve(t, 1e6 * modulus)
    assert result.max_error < 0.005
    g, tau = columns_of(
        real_data / "pyvisco-master-curves" / "ansys-reference" / "prony_terms_KPf_MD.csv",
        delimiter=",",
    )[:2]
    theirs = 1739.03 * (1 - g.sum() + np.exp(-t[:, None] / tau) @ g) / modulus - 1
    assert result.rms < 0.5 * np.sqrt(np.mean(theirs**2))
    assert result.max_error < 0.5 * np.abs(theirs).max()


def test_a_dynamic_master_curve_over_26_decades(real_data: Path) -> None:
    """pyvisco's 26 terms miss E'' by up to 333 % and fall to 27 of 88.8 MPa at the lowest f."""
    data = read_dynamic(real_data / "pyvisco-master-curves" / "freq_user_master.csv")
    result = dynamic_master_curve(data)
    storage, loss = result.misfit
    assert loss.largest < 0.31
    assert storage.largest < 0.55
    assert result.rms < 0.18
    assert result.model.storage(omega=data.omega[0]) > 40e6
    terms = ansys_terms(
        real_data / "pyvisco-master-curves" / "ansys-reference" / "freq_master.prony_terms.MPL"
    )
    x = data.omega[:, None] * terms[:, 1]
    relative = np.concatenate(
        (
            (1 - terms[:, 0].sum() + (x * x / (1 + x * x)) @ terms[:, 0]) / data.storage,
            (x / (1 + x * x)) @ terms[:, 0] / data.loss,
        )
    )
    # the instantaneous modulus that serves these terms best on the same norm
    best = relative * relative.sum() / (relative @ relative) - 1
    assert result.rms < 0.6 * np.sqrt(np.mean(best**2))


def ansys_terms(file: Path) -> np.ndarray:
    """Pairs of relative modulus and relaxation time out of TBDATA lines."""
    values = [
        float(word)
        for line in file.read_text().splitlines()
        if line.startswith("TBDATA")
        for word in line.split(",")[2:]
    ]
    return np.array(values).reshape(-1, 2)


def test_fit_modulus_reproduces_pyrespect_results(real_data: Path) -> None:
    folder = real_data / "pyrespect-time-tests"
    noisy = fit_modulus(*columns_of(folder / "test1.dat"))
    assert noisy.status is Status.CONVERGED
    assert noisy.model.arms == 2
    (low, high), slow = noisy.intervals(level=0.99)["tau"]
    assert low < 5.0 < high
    assert slow[0] < 50.0 < slow[1]

    exact = fit_modulus(*columns_of(folder / "test2.dat"))
    assert exact.status is Status.CONVERGED
    assert exact.model.tau == pytest.approx((0.05, 0.5, 5.0, 50.0), rel=1e-6)
    assert exact.model.k == pytest.approx((1.0, 1.0, 1.0, 1.0), rel=2e-6)
    assert exact.model.k_inf == pytest.approx(0.0, abs=1e-6)

    assert master_curve(*columns_of(folder / "test3.dat")).model.k_inf < 0.02
    assert master_curve(*columns_of(folder / "test7.dat")).model.k_inf == pytest.approx(
        10.0, abs=0.05
    )
