"""The fractional Zener solid: closed forms, identities of its relaxation, the arms for it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import erfcx

from dashpot.base.errors import DataError
from dashpot.solids.fractional import FractionalZener, compute_arm_weights
from dashpot.solids.maxwell import GeneralizedMaxwell, Parallel, Solid
from dashpot.vibration.mass_on_seals import model_modes
from dashpot.workflow.json_archive import from_json, to_json

PARK = FractionalZener(k_0=1.0, k_inf=10.0, tau=0.01, alpha=0.5)
OMEGA = 2 * np.pi * np.geomspace(1e-6, 1e6, 121)
ALPHAS = (0.1, 0.3, 0.5, 0.65, 0.7, 0.8, 0.87, 0.9, 0.95, 0.99, 0.999)


def test_its_numbers_are_those_of_park() -> None:
    at = PARK.complex_stiffness(omega=100.0)
    assert (at.real, at.imag) == pytest.approx((5.5, 1.863961), abs=5e-7)
    assert PARK.loss_factor(omega=10.0) == pytest.approx(0.451257, abs=5e-7)
    t = [1e-4, 0.01, 1.0, 40.0]
    relaxation = PARK.relaxation(t)
    assert relaxation == pytest.approx([9.06811282, 4.84825219, 1.50526893, 1.08027555], abs=6e-9)
    held = PARK.ramp_hold_force([0.5, 1, 2, 10, 41], depth=1.0, ramp_time=1.0)
    expected = [1.13520731, 1.93059394, 1.41917984, 1.16471294, 1.07978013]
    assert held == pytest.approx(expected, abs=6e-9)
    ramps = [float(PARK.ramp_hold_force([c], depth=1.0, ramp_time=c)[0]) for c in t]
    assert ramps == pytest.approx([9.36540701, 6.00366469, 1.93059394, 1.15834124], abs=6e-9)


def test_a_mass_rings_on_it_at_its_pole() -> None:
    (mode,) = model_modes(FractionalZener(200.0, 800.0, 0.01, 0.5), 0.1)
    assert (mode.pole.real, mode.pole.imag) == pytest.approx((-9.8094058, 69.0759088), abs=6e-8)
    assert mode.frequency == pytest.approx(11.1040724, abs=6e-8)
    assert mode.damping_ratio == pytest.approx(0.140598455, abs=6e-10)


def test_with_a_half_it_is_the_error_function() -> None:
    t = np.geomspace(1e-6, 1e5, 89)
    x = np.sqrt(t / PARK.tau)
    np.testing.assert_allclose(PARK.relaxation(t), 1 + 9 * erfcx(x), rtol=2e-11)
    for value in t[[0, 40, 88]]:
        x = np.sqrt(value / PARK.tau)
        mean = (erfcx(x) - 1 + 2 * x / np.sqrt(np.pi)) / x**2
        ramp = PARK.ramp_hold_force([value], depth=1.0, ramp_time=value)
        assert ramp[0] == pytest.approx(1 + 9 * mean, rel=1e-10 + 1e-15 / x**2)


@pytest.mark.parametrize("alpha", ALPHAS)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-7])
def test_fractional_arms_keep_the_requested_tolerance(alpha: float, tolerance: float) -> None:
    solid = FractionalZener(1.0, 0.0, 1.0, alpha)
    arms = solid.arms(tolerance)
    assert (
        np.abs(arms.complex_stiffness(omega=OMEGA) - solid.complex_stiffness(omega=OMEGA)).max()
        <= tolerance
    )
    assert np.abs(arms.relaxation(1 / OMEGA) - solid.relaxation(1 / OMEGA)).max() <= tolerance
    assert arms.k_0 == pytest.approx(1.0, abs=tolerance)


def test_a_band_takes_fewer_arms_and_a_steeper_slope_more() -> None:
    solid = FractionalZener(3.0, 1.0, 0.05, 0.5)
    inside = 2 * np.pi * np.geomspace(0.01, 100.0, 81)
    few = solid.arms(1e-3, (0.01, 100.0))
    error = np.abs(
        few.complex_stiffness(omega=inside) - solid.complex_stiffness(omega=inside)
    ).max()
    assert error <= 1e-3 * 2.0
    assert few.arms < 30 < solid.arms(1e-3).arms
    assert few.k_inf == 1.0
    assert few.k_0 == pytest.approx(3.0, rel=1e-4)
    counts = [
        FractionalZener(1.0, 0.0, 1.0, alpha).arms(1e-4, (0.01, 100.0)).arms for alpha in ALPHAS
    ]
    # up to two thirds the kernel alone sets the step; then the peak of the spectrum does
    assert counts[0] == counts[3] < counts[5] < counts[-1] < 5 * counts[0]


def test_fractional_arms_far_outside_the_band_reduce_to_a_single_arm() -> None:
    solid = FractionalZener(3.0, 1.0, 1e-6, 0.5)
    low = solid.arms(1e-3, (1e-6, 1e-5))
    K = low.complex_stiffness(omega=2 * np.pi * 1e-5)
    assert abs(K - solid.complex_stiffness(omega=2 * np.pi * 1e-5)) <= 2e-3


@pytest.mark.parametrize("solid", [PARK, FractionalZener(4.0, 1.0, 0.3, 0.8)])
def test_fractional_creep_agrees_with_its_arms(solid: FractionalZener) -> None:
    t = np.geomspace(1e-3, 1e3, 13)
    arms = solid.arms(1e-9)
    np.testing.assert_allclose(solid.creep(t), arms.creep(t), rtol=1e-7)


def test_a_fractional_maxwell_solid_creeps_as_a_power() -> None:
    flows = FractionalZener(5.0, 0.0, 0.2, 0.5)
    t = np.array([0.1, 10.0])
    power = np.sqrt(t / 0.2) / (np.sqrt(np.pi) / 2)
    np.testing.assert_allclose(flows.creep(t), (1 + power) / 5.0, rtol=1e-14)
    s = 3.0j
    half = np.sqrt(0.2 * s)
    assert flows.stiffness_at(s) == pytest.approx(5.0 * half / (1 + half))


def test_fractional_slope_of_one_is_a_zener_model() -> None:
    zener = FractionalZener(3.0, 1.0, 0.2, 1.0)
    assert zener.maxwell == GeneralizedMaxwell(1.0, (2.0,), (0.2,))
    np.testing.assert_allclose(
        zener.complex_stiffness(omega=OMEGA),
        zener.maxwell.complex_stiffness(omega=OMEGA),
        rtol=1e-12,
    )


def test_the_ends_are_taken_in_either_order() -> None:
    fractional_zener, other = (
        FractionalZener(200.0, 500.0, 0.05, 0.5),
        FractionalZener(500.0, 200.0, 0.05, 0.5),
    )
    assert fractional_zener == other
    assert (fractional_zener.k_inf, fractional_zener.k_0) == (200.0, 500.0)


def test_solids_stand_side_by_side() -> None:
    spring, dashpot = GeneralizedMaxwell(2.0), GeneralizedMaxwell(0.0, b=0.3)
    joined = PARK + spring + dashpot
    assert joined == FractionalZener(3.0, 12.0, 0.01, 0.5, 0.3) == spring + PARK + dashpot
    assert PARK + PARK == 2 * PARK == FractionalZener(2.0, 20.0, 0.01, 0.5)
    arm = GeneralizedMaxwell(1.0, (4.0,), (3.0,))
    solid: Solid = arm + FractionalZener(5.0, 1.0, 0.1, 0.3) + PARK
    assert isinstance(solid, Parallel)
    assert len(solid.parts) == 3
    K = arm.complex_stiffness(omega=OMEGA) + PARK.complex_stiffness(omega=OMEGA)
    K = K + FractionalZener(5.0, 1.0, 0.1, 0.3).complex_stiffness(omega=OMEGA)
    np.testing.assert_allclose((2 * solid).complex_stiffness(omega=OMEGA), 2 * K, rtol=1e-13)
    np.testing.assert_allclose(solid.maxwell.complex_stiffness(omega=OMEGA), K, atol=2e-3)
    assert (solid.k_inf, solid.k_0) == pytest.approx((3.0, 20.0))
    t, x = np.linspace(0, 2, 40), np.linspace(0, 1, 40)
    parts = sum(part.force(t, x) for part in solid.parts)
    np.testing.assert_allclose(solid.force(t, x), parts, rtol=1e-12)


def test_fractional_model_includes_a_parallel_dashpot() -> None:
    damped = FractionalZener(10.0, 1.0, 0.01, 0.5, b=0.4)
    separate = PARK.complex_stiffness(omega=OMEGA) + 0.4j * OMEGA
    np.testing.assert_allclose(damped.complex_stiffness(omega=OMEGA), separate, rtol=1e-13)
    assert damped.maxwell.b == 0.4
    ramp = damped.ramp_hold_force([0.5], depth=1.0, ramp_time=1.0)
    assert ramp[0] == pytest.approx(1.13520731 + 0.4, abs=6e-9)


@pytest.mark.parametrize("alpha", [0.3, 0.6, 0.9])
def test_weights_are_differentiated(alpha: float) -> None:
    u, step = np.arange(-12.0, 9.0, 0.2), 1e-6
    weights = compute_arm_weights(u, alpha)
    by_alpha = (
        compute_arm_weights(u, alpha + step).value - compute_arm_weights(u, alpha - step).value
    )
    by_log_tau = (
        compute_arm_weights(u - step, alpha).value - compute_arm_weights(u + step, alpha).value
    )
    np.testing.assert_allclose(weights.by_alpha, by_alpha / (2 * step), atol=1e-8)
    np.testing.assert_allclose(weights.by_log_tau, by_log_tau / (2 * step), atol=1e-8)


@pytest.mark.parametrize("solid", [PARK, Parallel((PARK, GeneralizedMaxwell(1.0, (2.0,), (0.5,))))])
def test_it_is_archived_whole(solid: Solid) -> None:
    assert from_json(to_json(solid)) == solid


@pytest.mark.parametrize(
    "wrong",
    [
        {"k_0": -1.0},
        {"k_inf": np.inf},
        {"tau": 0.0},
        {"alpha": 0.0},
        {"alpha": 1.01},
        {"b": -1.0},
    ],
)
def test_what_is_not_passive_is_refused(wrong: dict[str, float]) -> None:
    right = {"k_0": 2.0, "k_inf": 1.0, "tau": 0.1, "alpha": 0.5}
    FractionalZener(**right)
    with pytest.raises(DataError, match=next(iter(wrong)).split("_")[0]):
        FractionalZener(**{**right, **wrong})


def test_a_tolerance_or_a_band_that_is_none_is_refused() -> None:
    with pytest.raises(DataError, match="tolerance"):
        PARK.arms(0.0)
    with pytest.raises(DataError, match="band"):
        PARK.arms(1e-3, (10.0, 1.0))
    with pytest.raises(DataError, match="parts"):
        Parallel(())
