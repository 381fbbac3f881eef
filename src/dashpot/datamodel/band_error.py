"""How well stiffness and loss factor are known at some frequencies, over all that a test allows."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dashpot.base.serialisation import Serialisable
from dashpot.solids.maxwell import Solid

#: a loss factor that is known no better than this part of itself is not known
WELL_KNOWN = 0.3


@dataclass(frozen=True)
class BandError(Serialisable):
    r"""Relative 95 % errors of stiffness and loss factor at lines of the valid band.

    Of :math:`|K^*|` and :math:`\eta = K''/K'`, over every non-negative spectrum that the test does
    not reject, about the solid that was fitted: with limits :math:`v_l \le v \le v_u`,

    .. math:: e = \max(v_u/v,\; v/v_l) - 1

    so that the true value lies within e of the fitted one, relative to either.

    Attributes
    ----------
    frequency : tuple of float
        Hz, increasing.
    stiffness, loss_factor : tuple of float
        One a line; infinite where nothing limits it.
    misfit : (float, float)
        The largest relative errors of stiffness and of loss factor at the record's own lines in
        the band; 0 of a record that has none.
    """

    keys = ("frequency", "stiffness", "loss_factor", "misfit")

    frequency: tuple[float, ...]
    stiffness: tuple[float, ...]
    loss_factor: tuple[float, ...]
    misfit: tuple[float, float] = (0.0, 0.0)

    @property
    def largest(self) -> tuple[float, float]:
        """Largest error of stiffness and of loss factor, neither below what the lines show."""
        stiffness, loss_factor = self.misfit
        return max(*self.stiffness, stiffness), max(*self.loss_factor, loss_factor)

    def shifted(self, a_t: float) -> BandError:
        """Return the errors at another temperature, whose relaxation times are `a_t` as long."""
        return replace(self, frequency=tuple(line / a_t for line in self.frequency))

    def about(self, other: Solid, fitted: Solid) -> BandError:
        """Return the errors about another solid than the one that they were found about."""
        omega = 2 * np.pi * np.array(self.frequency)
        K, K_other = (solid.complex_stiffness(omega=omega) for solid in (fitted, other))
        return replace(
            self,
            stiffness=_increase_errors(self.stiffness, np.abs(K), np.abs(K_other)),
            loss_factor=_increase_errors(
                self.loss_factor, K.imag / K.real, K_other.imag / K_other.real
            ),
        )


def _increase_errors(
    errors: tuple[float, ...], value: np.ndarray, other: np.ndarray
) -> tuple[float, ...]:
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.maximum(value / other, other / value)
    change = (1 + np.array(errors)) * np.where(np.isfinite(factor), factor, np.inf) - 1
    return tuple(change.tolist())
