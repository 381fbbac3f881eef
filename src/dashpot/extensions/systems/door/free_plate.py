"""Modes of a free uniform plate as a virtual door."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre

from dashpot.base.arrays import FloatArray
from dashpot.extensions.systems.free_modes import FreeModes

_DEGREE = 14
"""Polynomials along either side: two dozen elastic modes to a thousandth."""


def free_plate(
    place: npt.ArrayLike,
    *,
    width: float,
    height: float,
    mass: float,
    rigidity: float,
    poisson: float = 0.3,
    elastic: int = 8,
) -> FreeModes:
    r"""Return the modes of a thin plate that moves across its plane, by Ritz's method.

    .. math:: U = \tfrac{D}{2} \iint w_{xx}^2 + w_{yy}^2 + 2\nu w_{xx} w_{yy}
        + 2 (1-\nu) w_{xy}^2, \qquad T = \tfrac{m}{2 A} \iint \dot w^2

    over products of Legendre polynomials. Three of the modes are rigid motions.

    Parameters
    ----------
    place : array_like, shape (p, 3)
        Where the shapes are wanted, m; the plate reaches from 0 to its width along x and to its
        height along y.
    width, height, mass, rigidity : float
        m, kg, and D in N m.
    poisson : float
    elastic : int
        Modes besides the rigid ones.
    """
    p = np.asarray(place, dtype=float)
    nodes, weights = legendre.leggauss(_DEGREE + 2)

    def evaluate_derivatives(side_length: float, order: int, x: FloatArray) -> FloatArray:
        """Return derivatives of every polynomial, shape (degree, x)."""
        rows = [legendre.legder(row, order) for row in np.eye(_DEGREE)]
        return (2 / side_length) ** order * np.array([legendre.legval(x, row) for row in rows])

    def inner(a: FloatArray, b: FloatArray) -> FloatArray:
        return (a * weights) @ b.T

    X, Y = (
        [evaluate_derivatives(side_length, order, nodes) for order in range(3)]
        for side_length in (width, height)
    )
    area = width * height
    M = mass / 4 * np.kron(inner(X[0], X[0]), inner(Y[0], Y[0]))
    mixed = np.kron(inner(X[2], X[0]), inner(Y[0], Y[2]))
    K = rigidity * area / 4 * (
        np.kron(inner(X[2], X[2]), inner(Y[0], Y[0]))
        + np.kron(inner(X[0], X[0]), inner(Y[2], Y[2]))
        + poisson * (mixed + mixed.T)
        + 2 * (1 - poisson) * np.kron(inner(X[1], X[1]), inner(Y[1], Y[1]))
    )  # fmt: skip
    root = np.sqrt(np.diag(M))  # Legendre polynomials are orthogonal
    squared, vectors = np.linalg.eigh(K / root / root[:, None])
    mode_count = 3 + elastic
    x, y = 2 * p[:, 0] / width - 1, 2 * p[:, 1] / height - 1
    product = evaluate_derivatives(width, 0, x)[:, None] * evaluate_derivatives(height, 0, y)[None]
    displacement = (vectors[:, :mode_count] / root[:, None]).T @ product.reshape(-1, len(p))
    shape = np.zeros((mode_count, len(p), 3))
    shape[:, :, 2] = displacement
    frequency = np.sqrt(np.maximum(squared[:mode_count], 0.0)) / (2 * np.pi)
    frequency[:3] = 0.0
    return FreeModes(frequency, p, shape)
