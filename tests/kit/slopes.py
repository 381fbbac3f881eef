"""Comparison of derivatives with finite differences."""

from __future__ import annotations

import numpy as np

from dashpot.numerics.least_squares import Problem


def hold_slopes(
    problem: Problem, theta: np.ndarray, beta: np.ndarray, *, rtol: float = 1e-5, step: float = 1e-4
) -> None:
    """Assert that the slope of a problem's rows is that of its model, by Richardson's differences.

    To `rtol` of the largest value in each column. `step` is a part of each parameter's scale: a
    smooth model is best served by 1e-3, as the errors h^4 and eps / h meet near eps^(1/5); one
    with corners needs a shorter step.
    """
    rows = problem.model(theta)
    assert rows.slope is not None

    def differentiate(i: int, h: float) -> np.ndarray:
        ends = []
        for sign in (-1, 1):
            at = theta.copy()
            at[i] += sign * h
            y, A, _ = problem.model(at)
            ends.append(A @ beta - y)
        return (ends[1] - ends[0]) / (2 * h)

    for i, (item, column) in enumerate(zip(problem.parameters, rows.slope(beta).T, strict=True)):
        h = step * item.scale
        expected = (4 * differentiate(i, h) - differentiate(i, 2 * h)) / 3
        size = np.abs(expected).max() or 1.0
        np.testing.assert_allclose(column, expected, atol=rtol * size, rtol=0, err_msg=f"theta {i}")
