"""The paper's own equations, typed as printed, and every number that follows from its Table 1."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.mass_on_seals import moving_mass, predict_frf

# Table 1, in the paper's units: N/mm and N s/mm
K_INF, K1, K2, B1, B2 = 0.1965, 0.1175, 0.0178, 0.0590, 0.2922
TAU1, TAU2 = B1 / K1, B2 / K2
MASS = 0.1040426  # kg: what puts the peak of two such seals at 12.71 Hz; the paper gives none


def eq5(t, A, c):
    """Eq. (5) as printed, for t > c; N, with A in mm/s."""
    return A * (
        K_INF * c
        - B1 * np.exp(-t / TAU1) * (1 - np.exp(c / TAU1))
        - B2 * np.exp(-t / TAU2) * (1 - np.exp(c / TAU2))
    )


def eq7(omega, m):
    """Eq. (7) as printed but for the sign of a magnitude; m in tonnes, N/mm: result in 1/t."""
    numerator = omega**2 * np.sqrt(
        (1 - TAU1 * TAU2 * omega**2) ** 2 + (TAU1 + TAU2) ** 2 * omega**2
    )
    real = (
        m * TAU1 * TAU2 * omega**4
        - (m + K_INF * TAU1 * TAU2 + TAU1 * TAU2 * K1 + TAU1 * TAU2 * K2) * omega**2
        + K_INF
    )
    imaginary = (K_INF * (TAU1 + TAU2) + B1 + B2) * omega - m * (TAU1 + TAU2) * omega**3
    return numerator / np.sqrt(real**2 + imaginary**2)


def eq6(s, m):
    """Eq. (6) as printed; m in tonnes, N/mm: result in mm/N."""
    numerator = (B1 * s + K1) * (B2 * s + K2)
    denominator = (
        m * B1 * B2 * s**4
        + (m * B1 * K2 + m * B2 * K1) * s**3
        + (m * K1 * K2 + K_INF * B1 * B2 + B1 * B2 * K1 + B1 * B2 * K2) * s**2
        + (K_INF * (B1 * K2 + B2 * K1) + B1 * K1 * K2 + B2 * K1 * K2) * s
        + K_INF * K1 * K2
    )
    return numerator / denominator


def test_relaxation_times_of_table_1(paper_seal):
    assert paper_seal.tau == pytest.approx((0.502127660, 16.415730337), rel=1e-9)
    assert paper_seal.k_0 == pytest.approx(331.8)


def test_hold_force_is_eq_5_as_printed(paper_seal):
    t = np.linspace(1.0, 41.0, 4001)
    force = paper_seal.ramp_hold_force(t, depth=8e-3, ramp_time=1.0)
    np.testing.assert_allclose(force, eq5(t, 8.0, 1.0), rtol=1e-12)


def test_eq_5_as_printed_overflows_where_ours_does_not():
    fast = GeneralizedMaxwell(196.5, (117.5,), (1e-3,))
    with np.errstate(over="ignore"):
        assert np.isinf(np.exp(1.0 / 1e-3))
    force = fast.ramp_hold_force([1.0, 2.0], depth=8e-3, ramp_time=1.0)
    np.testing.assert_allclose(force, [8e-3 * (196.5 + 0.1175), 8e-3 * 196.5], rtol=1e-12)


@pytest.mark.parametrize(
    ("t", "expected"),
    [
        (0.25, 0.613441), (0.5, 1.153750), (1.0, 2.117728), (1.5, 1.856581), (2.0, 1.757614),
        (3.0, 1.701896), (5.0, 1.680416), (10.0, 1.651845), (20.0, 1.615420), (41.0, 1.584081),
        (1e4, 1.572000),
    ],
)  # fmt: skip
def test_force_of_the_paper_test(paper_seal, t, expected):
    force = paper_seal.ramp_hold_force([t], depth=8e-3, ramp_time=1.0)
    assert force[0] == pytest.approx(expected, abs=5e-7)


def test_hold_amplitudes_and_step_force(paper_seal):
    amplitudes = [
        8e-3 * b * -np.expm1(-1 / tau)
        for b, tau in zip(paper_seal.arm_b, paper_seal.tau, strict=True)
    ]
    assert amplitudes == pytest.approx([0.407578, 0.138149], abs=5e-7)
    assert 8e-3 * paper_seal.k_0 == pytest.approx(2.6544)


@pytest.mark.parametrize(
    ("hz", "storage", "loss", "loss_factor"),
    [
        (0.1, 224.771, 35.4246, 0.157603),
        (1.0, 321.071, 34.0155, 0.105944),
        (12.71, 331.727, 2.94196, 0.00886863),
    ],
)
def test_complex_stiffness(paper_seal, hz, storage, loss, loss_factor):
    omega = 2 * np.pi * hz
    assert paper_seal.storage(omega=omega) == pytest.approx(storage, rel=5e-6)
    assert paper_seal.loss(omega=omega) == pytest.approx(loss, rel=5e-6)
    assert paper_seal.loss_factor(omega=omega) == pytest.approx(loss_factor, rel=5e-6)


def test_equivalent_viscous_damping_at_the_peak(paper_seal):
    omega = 2 * np.pi * 12.71
    assert paper_seal.loss(omega=omega) / omega == pytest.approx(3.68393e-2, rel=2e-6)


def test_largest_loss_factor(paper_seal):
    hz = np.linspace(0.2, 0.3, 100_001)
    loss_factor = paper_seal.loss_factor(omega=2 * np.pi * hz)
    assert loss_factor.max() == pytest.approx(0.222966, rel=3e-6)
    assert hz[loss_factor.argmax()] == pytest.approx(0.25099, abs=2e-5)


@pytest.mark.parametrize("seals", [1, 2])
def test_frf_is_eq_7_with_its_sign_mended(paper_seal, seals):
    mass = MASS * seals / 2
    f = np.linspace(0.5, 60, 2000)
    predicted = predict_frf(seals * paper_seal, mass=mass, frequency=f)
    # eq. (7) is for one seal: n seals carrying n times the mass move alike, 1/n as much
    printed = eq7(2 * np.pi * f, mass / seals * 1e-3) * 1e-3 / seals
    np.testing.assert_allclose(np.abs(predicted.value), printed, rtol=1e-9)


def test_receptance_is_eq_6_phase_included(paper_seal):
    f = np.linspace(0.5, 60, 2000)
    predicted = predict_frf(paper_seal, mass=0.052, frequency=f, kind="receptance")
    printed = eq6(2j * np.pi * f, 0.052e-3) * 1e-3
    np.testing.assert_allclose(predicted.value, printed, rtol=1e-9)
    assert (predicted.value.imag < 0).all()


@pytest.mark.parametrize(("seals", "peak"), [(1, 2167.58), (2, 1083.79)])
def test_peak_of_the_accelerance(paper_seal, seals, peak):
    f = np.linspace(12.4, 13.0, 60_001)
    height = np.abs(predict_frf(seals * paper_seal, mass=MASS * seals / 2, frequency=f).value)
    top = height.argmax()
    assert f[top] == pytest.approx(12.71, abs=2e-4)
    assert height[top] == pytest.approx(peak, rel=1e-5)
    wide = f[height >= height[top] / np.sqrt(2)]
    assert wide[-1] - wide[0] == pytest.approx(0.112747, abs=3e-5)


def test_poles(paper_seal):
    """The roots of eq. (6)'s denominator, as printed, are the poles of the mass on the seals."""
    m = MASS / 2 * 1e-3
    roots = np.roots([
        m * B1 * B2,
        m * B1 * K2 + m * B2 * K1,
        m * K1 * K2 + K_INF * B1 * B2 + B1 * B2 * K1 + B1 * B2 * K2,
        K_INF * (B1 * K2 + B2 * K1) + B1 * K1 * K2 + B2 * K1 * K2,
        K_INF * K1 * K2,
    ])  # fmt: skip
    oscillating = roots[roots.imag > 0][0]
    assert oscillating == pytest.approx(-0.354171 + 79.85693j, rel=1e-7)
    assert sorted(roots[roots.imag == 0].real) == pytest.approx([-1.288324, -0.055776], rel=1e-5)
    assert abs(oscillating) / (2 * np.pi) == pytest.approx(12.70975, abs=1e-5)
    assert -oscillating.real / abs(oscillating) == pytest.approx(0.00443503, rel=1e-6)
    solid = 2 * paper_seal
    for pole in roots:
        inertia = MASS * pole**2
        assert abs(inertia + solid.stiffness_at(pole)) < 1e-9 * solid.k_0


def test_limits_of_the_frf(paper_seal):
    static = predict_frf(paper_seal, mass=0.052, frequency=[1e-6], kind="receptance")
    assert static.value[0].real == pytest.approx(1 / paper_seal.k_inf, rel=1e-6)
    high = predict_frf(paper_seal, mass=0.052, frequency=[1e6])
    assert abs(high.value[0]) == pytest.approx(1 / 0.052, rel=1e-6)
    assert np.sqrt(2 * paper_seal.k_inf / MASS) / (2 * np.pi) == pytest.approx(9.7816, abs=1e-4)


def test_creep_of_table_1(paper_seal):
    t = np.array([0.0, 1.0, 10.0, 100.0])
    expected = (
        3.013864 + 1.638841 * -np.expm1(-t / 0.776312) + 0.436354 * -np.expm1(-t / 17.928823)
    ) * 1e-3
    np.testing.assert_allclose(paper_seal.creep(t), expected, rtol=1e-6)
    assert paper_seal.creep([1e6])[0] == pytest.approx(5.089059e-3, rel=1e-6)


def test_prony_terms_for_the_decks(paper_seal):
    g, tau = paper_seal.to_prony()
    assert g == pytest.approx((0.354129, 0.053647), abs=5e-7)
    assert [1 / value for value in tau] == pytest.approx([1.991525, 0.0609172], rel=1e-6)


def test_step_assumption_misjudges_the_stiffness(paper_seal):
    """Read as a step at the start of the hold, arm j looks k_j (tau/c)(1 - exp(-c/tau)) stiff."""
    expected = (-0.5664, -0.0298)
    for k, tau, error in zip(paper_seal.k, paper_seal.tau, expected, strict=True):
        arm = GeneralizedMaxwell(0.0, (k,), (tau,))
        seen = arm.ramp_hold_force([1.0], depth=1.0, ramp_time=1.0)[0]
        assert seen / k - 1 == pytest.approx(error, abs=5e-5)


def test_a_third_of_the_seals_mass_moves_along():
    """Kulik's rod at 10 : 1: with a third of it the stiffness is 0.021 % off, not 3.25 %."""
    mass, check = moving_mass(0.1, seal=0.005, seals=2)
    assert mass == pytest.approx(0.1 + 0.01 / 3)
    assert check.failed
    assert check.value == pytest.approx(0.1)
    assert moving_mass(0.1, seal=0.0005, seals=2)[1].passed
    # the first resonance of a rod of mass 1 under a block of mass 10 obeys x tan x = 1/10
    low, high = 0.1, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if middle * np.tan(middle) < 0.1 else (low, middle)
    exact = low**2  # of omega^2 m_rod / k_rod
    assert exact * 10 - 1 == pytest.approx(-0.0325, abs=5e-5)
    assert exact * (10 + 1 / 3) - 1 == pytest.approx(-0.00021, abs=5e-6)
    with pytest.raises(DataError, match="seal mass = -1"):
        moving_mass(0.1, seal=-1)
