"""Errors along the axes of a covariance, whatever signs a library gives to eigenvectors."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.fitting.prediction_bounds import compute_covariance_axes, compute_covariance_root

RNG = np.random.default_rng(5)
MIXED = RNG.standard_normal((4, 4)) * [1.0, 30.0, 0.1, 2.0]
COVARIANCES = [
    np.array([[1.0, 0.5], [0.5, 1.0]]),  # its axes have two parts of one size
    np.diag([4.0, 0.0, 1.0]),
    MIXED.T @ MIXED,
]


@pytest.mark.parametrize("of", [compute_covariance_axes, compute_covariance_root])
@pytest.mark.parametrize("covariance", COVARIANCES, ids=["even", "one is known", "mixed"])
def test_no_library_chooses_the_sign(of, covariance, monkeypatch):
    here = of(covariance)
    np.testing.assert_allclose(here.T @ here, covariance, atol=1e-12 * covariance.max())
    plain = np.linalg.eigh

    def flip_eigenvectors(matrix):
        size, turn = plain(matrix)
        return size, turn * np.where(np.arange(len(size)) % 2, 1, -1)

    monkeypatch.setattr(np.linalg, "eigh", flip_eigenvectors)
    np.testing.assert_array_equal(of(covariance), here)


def test_a_root_is_the_same_however_equal_axes_are_turned(monkeypatch):
    turn = np.linalg.qr(RNG.standard_normal((3, 3)))[0]
    monkeypatch.setattr(np.linalg, "eigh", lambda _: (np.full(3, 4.0), turn))
    np.testing.assert_allclose(
        compute_covariance_root(np.diag([4.0, 4.0, 4.0])), 2 * np.eye(3), atol=1e-15
    )
