"""Mode shapes: phase collinearity of their points."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import ComplexArray


def phase_collinearity(shape: ComplexArray) -> float:
    r"""Modal phase collinearity: 1 where all points move in phase or against it, else less.

    .. math:: \mathrm{MPC} = \left(\frac{\lambda_1 - \lambda_2}{\lambda_1 + \lambda_2}\right)^2

    with the eigenvalues of the real and imaginary parts' matrix of products, so that the phase of
    the whole shape, shape (points,), does not matter (Juang and Pappa 1985).
    """
    parts = np.array([shape.real, shape.imag])
    smaller_eigenvalue, larger_eigenvalue = np.linalg.eigvalsh(parts @ parts.T)
    return float(
        ((larger_eigenvalue - smaller_eigenvalue) / (larger_eigenvalue + smaller_eigenvalue)) ** 2
    )


def phase_deviation(shape: ComplexArray) -> float:
    """Return mean phase deviation, rad: how far the points are off the phase that fits them best.

    Each of shape (points,) counts by its magnitude; the best phase is that of the total least
    squares line through 0 (Heylen, Lammens and Sas, *Modal analysis theory and testing*).
    """
    parts = np.array([shape.real, shape.imag])
    principal_axis = np.linalg.eigh(parts @ parts.T)[1][:, 1]
    rotated = shape * complex(principal_axis[0], -principal_axis[1])
    magnitude = np.abs(shape)
    return float(
        (magnitude * np.arctan2(np.abs(rotated.imag), np.abs(rotated.real))).sum() / magnitude.sum()
    )
