"""Shapes of modes: how alike two of them are, and how nearly their points move in phase."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray


def mac(one: ComplexArray, other: ComplexArray) -> FloatArray:
    r"""Modal assurance criterion of every shape of `one` with every shape of `other`.

    .. math:: \mathrm{MAC}_{ij} = \frac{|\varphi_i^H \psi_j|^2}
              {(\varphi_i^H \varphi_i)(\psi_j^H \psi_j)}

    Parameters
    ----------
    one, other : complex array, shape (n, r)
        Residues or shapes at n points; their lengths and phases do not matter.

    Returns
    -------
    array, shape (r, r)
        0 to 1; 0 where a shape is nothing but zeros.

    Notes
    -----
    Allemang and Brown, *A correlation coefficient for modal vector analysis*, IMAC 1982.
    """
    cross = np.abs(one.conj().T @ other) ** 2
    size = np.outer((np.abs(one) ** 2).sum(axis=0), (np.abs(other) ** 2).sum(axis=0))
    return np.asarray(np.divide(cross, size, out=np.zeros_like(size), where=size > 0))


def phase_collinearity(shape: ComplexArray) -> float:
    r"""Modal phase collinearity: 1 where all points move in phase or against it, else less.

    .. math:: \mathrm{MPC} = \left(\frac{\lambda_1 - \lambda_2}{\lambda_1 + \lambda_2}\right)^2

    with the eigenvalues of the real and imaginary parts' matrix of products, so that the phase of
    the whole shape, shape (points,), does not matter (Juang and Pappa 1985).
    """
    parts = np.array([shape.real, shape.imag])
    small, large = np.linalg.eigvalsh(parts @ parts.T)
    return float(((large - small) / (large + small)) ** 2)


def phase_deviation(shape: ComplexArray) -> float:
    """Mean phase deviation, rad: how far the points are off the phase that fits them best.

    Each of shape (points,) counts by its magnitude; the best phase is that of the total least
    squares line through 0 (Heylen, Lammens and Sas, *Modal analysis theory and testing*).
    """
    parts = np.array([shape.real, shape.imag])
    along = np.linalg.eigh(parts @ parts.T)[1][:, 1]
    turned = shape * complex(along[0], -along[1])
    size = np.abs(shape)
    return float((size * np.arctan2(np.abs(turned.imag), np.abs(turned.real))).sum() / size.sum())
