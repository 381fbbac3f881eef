"""Mass that an FRF shows above its resonance."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.impact.checks import estimate_apparent_mass, high_frequency_mass_agrees
from dashpot.vibration.mass_on_seals import predict_frf

MASS, NATURAL_FREQUENCY = 0.15, 13.7
LINES = np.arange(2.0, 200.0, 0.25)
SEAL = GeneralizedMaxwell(500.0, (100.0, 80.0), (0.5, 0.01))


@pytest.mark.parametrize("delay", [0.0, 1e-4])
@pytest.mark.parametrize("noise", [0.003, 0.03, 0.2, 0.4])
def test_noise_of_the_acceleration_does_not_bias_the_mass(noise: float, delay: float) -> None:
    """Of lines with errors of up to 40 % of 1/m the mass is right within its standard error."""
    exact = predict_frf(2 * SEAL, mass=MASS, frequency=LINES).value
    exact = exact * np.exp(-2j * np.pi * LINES * delay)
    sd = np.full(len(LINES), noise / MASS / np.sqrt(2))
    result = []
    for seed in range(20):
        draw = np.random.default_rng(seed).standard_normal((2, len(LINES)))
        measured = exact + sd * (draw[0] + 1j * draw[1])
        apparent = estimate_apparent_mass(
            LINES, measured, natural_frequency=NATURAL_FREQUENCY, sd=sd
        )
        assert apparent is not None
        result.append(apparent)
    mass, se = np.array(result).T
    # what the arms do above the resonance is half a per cent
    assert abs(mass.mean() / MASS - 1) < 0.006 + 3 * se.mean() / MASS / np.sqrt(20)
    assert 0.6 < mass.std() / se.mean() < 1.5


def test_no_mass_line_without_good_lines() -> None:
    exact = predict_frf(2 * SEAL, mass=MASS, frequency=LINES).value
    sd = np.full(len(LINES), 1.0 / MASS)
    unknown = estimate_apparent_mass(LINES, exact, natural_frequency=NATURAL_FREQUENCY, sd=sd)
    assert unknown is None
    assert estimate_apparent_mass(LINES[:100], exact[:100], natural_frequency=20.0) is None


@pytest.mark.parametrize(("se", "text"), [(0.0, "within 1.0 %"), (0.02, "within 5.0 %")])
def test_high_frequency_mass_claims_no_more_than_its_standard_error(se: float, text: str) -> None:
    """A mass that is 1 ± 2 % off shows a calibration within 5 %, not within 1 %."""
    check = high_frequency_mass_agrees((0.99 * MASS, se * MASS), MASS)
    assert check.passed
    assert text in check.message
