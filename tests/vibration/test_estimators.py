"""Estimators against a known FRF with known noise."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.vibration.impact.spectral_estimators import (
    Estimator,
    Spectra,
    coherence,
    estimate,
    leave_one_out,
    random_error,
)

LINES = 400
FREQUENCY = np.linspace(1, 40, LINES)
TRUE = -(FREQUENCY**2) / (12.7**2 - FREQUENCY**2 + 0.6j * FREQUENCY)


def spectra(hits=10, force_noise=0.0, response_noise=0.0, seed=0, gains=(1.0, 1.0)):
    random = np.random.default_rng(seed)

    def noise(size):
        return size * (
            random.standard_normal((hits, LINES)) + 1j * random.standard_normal((hits, LINES))
        )

    force = random.uniform(1, 3, (hits, 1)) * np.exp(-1j * FREQUENCY * 0.01)
    return Spectra(
        FREQUENCY,
        gains[0] * (force + noise(force_noise)),
        gains[1] * (TRUE * force + noise(response_noise)),
        (gains[0] * force_noise, gains[1] * response_noise),
    )


@pytest.mark.parametrize("estimator", Estimator)
def test_without_noise_every_estimator_is_right(estimator):
    np.testing.assert_allclose(estimate(spectra(), estimator), TRUE, rtol=1e-10)


@pytest.mark.parametrize(
    ("estimator", "force", "response"), [("H1", 0.0, 0.1), ("H2", 0.1, 0.0), ("Hs", 0.1, 0.1)]
)
def test_each_estimator_is_unbiased_for_its_noise(estimator, force, response):
    many = spectra(hits=4000, force_noise=force, response_noise=response)
    near = np.abs(TRUE) > 0.3
    np.testing.assert_allclose(np.abs(estimate(many, estimator) / TRUE)[near], 1, atol=0.02)


def test_the_other_noise_biases_h1_down_and_h2_up():
    many = spectra(hits=4000, force_noise=0.3, response_noise=0.0)
    assert np.median(np.abs(estimate(many, "H1") / TRUE)) < 0.98
    many = spectra(hits=4000, force_noise=0.0, response_noise=0.3)
    low = np.abs(TRUE) < 0.5
    assert np.median(np.abs(estimate(many, "H2") / TRUE)[low]) > 1.1


@settings(deadline=None)
@given(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3), st.sampled_from(list(Estimator)))
def test_no_estimator_depends_on_the_channels_units(force_unit, response_unit, estimator):
    plain = spectra(hits=4, force_noise=0.1, response_noise=0.2)
    scaled = spectra(hits=4, force_noise=0.1, response_noise=0.2, gains=(force_unit, response_unit))
    np.testing.assert_allclose(
        estimate(scaled, estimator), estimate(plain, estimator) * response_unit / force_unit,
        rtol=1e-9,
    )  # fmt: skip
    np.testing.assert_allclose(coherence(scaled), coherence(plain), rtol=1e-9)


def test_hv_and_hs_lie_between_h1_and_h2():
    noisy = spectra(hits=5, force_noise=0.2, response_noise=0.2)
    low, high = np.abs(estimate(noisy, "H1")), np.abs(estimate(noisy, "H2"))
    for estimator in ("Hv", "Hs"):
        size = np.abs(estimate(noisy, estimator))
        assert (size >= low * (1 - 1e-12)).all()
        assert (size <= high * (1 + 1e-12)).all()


def test_hs_is_h1_without_force_noise_and_h2_without_response_noise():
    some = spectra(hits=5, force_noise=0.1, response_noise=0.1)
    quiet_force = Spectra(FREQUENCY, some.force, some.response, (0.0, 0.1))
    quiet_response = Spectra(FREQUENCY, some.force, some.response, (0.1, 0.0))
    np.testing.assert_allclose(estimate(quiet_force, "Hs"), estimate(some, "H1"), rtol=1e-12)
    np.testing.assert_allclose(estimate(quiet_response, "Hs"), estimate(some, "H2"), rtol=1e-12)


def test_coherence_of_a_single_hit_is_none():
    item = spectra(hits=1, response_noise=1.0)
    assert coherence(item) is None
    assert random_error(item, estimate(item)) is None


def test_the_random_error_agrees_with_the_coherence_formula():
    """ISO 7626-2, annex A: eps = sqrt((1 - g2) / (2 n g2))."""
    many = spectra(hits=10, response_noise=0.2)
    value, gamma2 = estimate(many), coherence(many)
    formula = np.abs(value) * np.sqrt((1 - gamma2) / (2 * 10 * gamma2))
    ratio = random_error(many, value) / formula
    # one degree of freedom of ten went into the FRF
    assert np.sqrt(np.median(ratio**2)) == pytest.approx(np.sqrt(10 / 9), rel=0.05)


@pytest.mark.parametrize("hits", [2, 3, 10])
def test_the_random_error_is_the_true_scatter(hits):
    z = []
    for seed in range(60):
        some = spectra(hits=hits, response_noise=0.2, seed=seed)
        value = estimate(some)
        z.append((value - TRUE).real / random_error(some, value))
    assert np.std(z) == pytest.approx(1, abs=0.06)


def test_leave_out_estimates_equal_those_of_the_other_hits():
    some = spectra(hits=4, response_noise=0.2)
    without = leave_one_out(some, "H2")
    rest = Spectra(FREQUENCY, some.force[1:], some.response[1:])
    np.testing.assert_allclose(without[0], estimate(rest, "H2"), rtol=1e-12)
    assert without.shape == (4, LINES)
