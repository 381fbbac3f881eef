"""The mass that the place of a peak implies."""

from __future__ import annotations

import numpy as np

from dashpot.base.errors import DataError
from dashpot.records.frf import FRF
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.modal.peaks import find_peak


def mass_for_peak(model: GeneralizedMaxwell, frequency: float) -> float:
    r"""Mass that puts the peak of the accelerance at `frequency` Hz, kg.

    The peak of :math:`|s^2/(ms^2 + K)|` is where :math:`|m - u|^2`, with
    :math:`u = K(j\omega)/\omega^2`, has a zero slope, which is linear in m:

    .. math:: m = \frac{\mathrm{Re}(\bar u' u)}{\mathrm{Re}\,u'}

    It is not positive, or not finite, where the model has no stiffness to balance a mass.
    """
    w = 2 * np.pi * frequency * (1 + np.array([-1e-5, 0.0, 1e-5]))
    u = model.complex_stiffness(w) / w**2
    slope = u[2] - u[0]
    return float((np.conj(slope) * u[1]).real / slope.real) if slope.real != 0 else 0.0


def infer_mass(model: GeneralizedMaxwell, frf: FRF) -> tuple[float, float]:
    r"""Mass that puts the predicted peak of the accelerance on the measured one.

    A frequency predicted with this mass proves nothing: it was put there
    (:func:`mass_for_peak`).

    Parameters
    ----------
    model : GeneralizedMaxwell
        All the seals together.
    frf : FRF
        Measured, any kind.

    Returns
    -------
    mass, standard_error : float
        kg. The error is that of the measured frequency alone, :math:`2 m\,\sigma_f/f`; an error
        of the model's stiffness goes into the mass in full.

    Raises
    ------
    DataError
        If the model has no stiffness to balance a mass at the measured peak.
    """
    peak = find_peak(frf)
    mass = mass_for_peak(model, peak.frequency)
    if not (np.isfinite(mass) and mass > 0):
        raise DataError(f"no mass puts a peak of this model at {peak.frequency:.4g} Hz; give mass=")
    return mass, float(2 * mass * peak.frequency_se / peak.frequency)
