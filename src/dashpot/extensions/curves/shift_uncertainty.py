r"""Errors of a solid of a master curve by the errors of its shifts.

A sample of a test at temperature T lies at :math:`\omega a_T`. An error of :math:`\lg a_T` moves it
along the frequencies, so that the solid is off by

.. math:: |\ln K^*(\omega\,10^{\pm e}) - \ln K^*(\omega)|, \qquad e = 1.96\,\sigma_{\lg a_T}

and its loss factor likewise; an error of b_T moves every stiffness of that test.
"""

from __future__ import annotations

from functools import cached_property, partial

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.reported_values import NORMAL
from dashpot.datamodel.bounds import BandError
from dashpot.extensions.curves.curve_uncertainty import find_valid_band
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.superposition import Superposition, UnshiftedCurve
from dashpot.fitting.admissible_spectra import AdmissibleSpectra
from dashpot.fitting.valid_band import ErrorFunction
from dashpot.solids.maxwell import Solid

NEIGHBOURHOOD_DECADES = 0.25
"""Samples so near to a frequency say with which error it was shifted."""


@dataclass(frozen=True, eq=False)
class MasterCurveErrors:
    """Relative errors of a solid at a frequency, those by the shifts included.

    Attributes
    ----------
    superposition : Superposition
    solid : Solid
        At the reference temperature.
    errors : callable
        Relative errors of stiffness and loss factor at a frequency, Hz, were the shifts exact.
    """

    superposition: Superposition
    solid: Solid
    errors: ErrorFunction

    def __call__(self, frequency: float) -> tuple[float, float]:
        """Return the relative errors of stiffness and loss factor at a frequency, Hz."""
        stiffness, loss_factor = self.errors(frequency)
        shift_sd, vertical_sd = self._find_shift_errors(frequency)
        ends = frequency * 10.0 ** (NORMAL * shift_sd * np.array([-1.0, 0.0, 1.0]))
        K = self.solid.complex_stiffness(omega=2 * np.pi * ends)
        with np.errstate(divide="ignore", invalid="ignore"):
            log_size, log_factor = np.log(np.abs(K)), np.log(K.imag / K.real)
        size_change = float(np.abs(log_size - log_size[1]).max()) + NORMAL * vertical_sd
        factor_change = float(np.abs(log_factor - log_factor[1]).max())
        return (
            (1 + stiffness) * float(np.exp(size_change)) - 1,
            (1 + loss_factor) * float(np.exp(factor_change)) - 1,
        )

    def _find_shift_errors(self, frequency: float) -> tuple[float, float]:
        """Return the errors of log10 a_T and ln b_T of the samples that decide at a frequency.

        Where tests overlap, those of the test with the smallest error.
        """
        log_frequency, shift_sd, vertical_sd = self._sample_errors
        distance = np.abs(log_frequency - np.log10(frequency))
        near = distance <= max(NEIGHBOURHOOD_DECADES, float(distance.min()))
        return float(shift_sd[near].min()), float(vertical_sd[near].min())

    @cached_property
    def _sample_errors(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Decadic logarithm of the frequency of every sample, and the errors of its shifts."""
        curve, shifts = self.superposition.curve, self.superposition.temperatures.shifts
        frequency = (
            curve.frequency
            if isinstance(curve, DynamicTest)
            else 1 / (2 * np.pi * np.maximum(curve.time, np.finfo(float).tiny))
        )
        temperatures = np.array([shift.temperature for shift in shifts])
        distance = np.abs(self.superposition.temperature[:, None] - temperatures)
        nearest = np.argmin(distance, axis=1)
        shift_sd = np.array([shift.se for shift in shifts])[nearest]
        vertical_sd = np.array([shift.b_t_se / shift.b_t for shift in shifts])[nearest]
        return np.log10(frequency), shift_sd, vertical_sd


def find_band_with_shift_errors(
    spectra: AdmissibleSpectra,
    solid: Solid,
    band: tuple[float, float],
    *,
    origin: Superposition | UnshiftedCurve | None,
    creep: bool = False,
) -> tuple[tuple[float, float], BandError | None]:
    """Return the valid band of a curve as `find_valid_band`, with the errors of its shifts."""
    add_errors = partial(MasterCurveErrors, origin) if isinstance(origin, Superposition) else None
    return find_valid_band(spectra, solid, band, creep=creep, add_errors=add_errors)
