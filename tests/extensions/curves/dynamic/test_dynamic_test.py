"""Dynamic (DMA) tests as values."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.solids.maxwell import GeneralizedMaxwell


def test_a_solid_measured_is_the_solid(paper_seal: GeneralizedMaxwell) -> None:
    frequency = np.geomspace(0.01, 10, 20)
    value = paper_seal.complex_stiffness(omega=2 * np.pi * frequency)
    test = DynamicTest(frequency, value.real, value.imag, unit="N/m", units="SI")
    np.testing.assert_array_equal(test.value, value)
    np.testing.assert_allclose(test.loss_factor, paper_seal.loss_factor(omega=test.omega))
    assert (test.loss > 0).all()


def test_a_sweep_may_be_repeated_at_each_temperature() -> None:
    frequency = np.array([1.0, 10.0, 1.0, 10.0])
    test = DynamicTest(
        frequency, frequency, frequency, np.array([250.0, 250.0, 300.0, 300.0]), units="SI"
    )
    assert test == DynamicTest(frequency, frequency, frequency, test.temperature, units="SI")
    assert test.unit == "Pa"
    with pytest.raises(ValueError, match="read-only"):
        test.storage[0] = 1.0


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"frequency": [1.0, 0.0]}, "frequency\\[1\\] = 0 Hz; expected > 0"),
        ({"storage": [1.0]}, "one value per sample"),
        ({"loss": [1.0, float("nan")]}, "loss\\[1\\] is nan"),
        ({"unit": "psi"}, "expected 'Pa' or 'N/m'"),
    ],
)
def test_bad_dynamic_tests(changed: dict, words: str) -> None:
    good = {"frequency": [1.0, 2.0], "storage": [1.0, 2.0], "loss": [1.0, 2.0]}
    with pytest.raises(DataError, match=words):
        DynamicTest(**{**good, **changed}, units="SI")
