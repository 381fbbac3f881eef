"""The modal assurance criterion: how alike two shapes of modes are."""

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
