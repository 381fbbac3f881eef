"""What a small error of a test does to storage and loss factor."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray


def compute_stiffness_change(
    slope: ComplexArray, loss_factor: FloatArray
) -> tuple[FloatArray, FloatArray]:
    r"""Relative change of the storage, and change of the loss factor, by a small :math:`d\ln K^*`.

    .. math::

        \frac{dK'}{K'} = \mathrm{Re}\,d\ln K^* - \eta\,\mathrm{Im}\,d\ln K^*, \qquad
        d\eta = (1 + \eta^2)\,\mathrm{Im}\,d\ln K^*

    Parameters
    ----------
    slope : complex array, shape (n,)
        :math:`d\ln K^*`.
    loss_factor : array, shape (n,)
    """
    return (
        np.asarray(slope.real - loss_factor * slope.imag),
        np.asarray(slope.imag * (1 + loss_factor**2)),
    )
