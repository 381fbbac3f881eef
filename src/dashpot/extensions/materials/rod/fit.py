r"""Fit of a viscoelastic model to the modulus of a rod's material.

The lines of the usable band are fitted as a dynamic test is. What spoils all lines alike, such as a
gain, is no scatter that the fit could see. What each such error of one standard deviation moves is
added to the covariance, and to the errors of the modulus in the band,

.. math:: C = C_{\text{scatter}} + \sum_i \delta_i \delta_i^T, \qquad
    \delta_i = J^+ \sigma_i\,\partial E^*/\partial p_i
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import FitError
from dashpot.base.option_fields import FamilyOption
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.rod.checks import ROD_LINES
from dashpot.extensions.materials.rod.datamodel import RodModulus
from dashpot.fitting.prediction_bounds import get_parameter_values
from dashpot.registry import require_handler
from dashpot.solids.fractional import FractionalZener

FitModulus: TypeAlias = Callable[..., Fit]
"""Step from a complex modulus to a model."""
_PER_OCTAVE = 24
# errors of a loss are relative to no less than this part of the storage
_LEAST_LOSS_FACTOR = 1e-3


def fit_rod(
    rod_modulus: RodModulus,
    *,
    arms: int | Literal["auto"] = "auto",
    family: FamilyOption = "maxwell",
    specimen: Specimen | None = None,
) -> Fit:
    """Fit a viscoelastic model to the usable band of a rod's modulus, Pa.

    Parameters
    ----------
    rod_modulus : RodModulus
    arms, family
        As of a dynamic test.
    specimen
        Of the rod.

    Raises
    ------
    FitError
        If fewer than eight lines are usable, or a fit of them is not possible.
    """
    lines = rod_modulus.only(rod_modulus.usable)
    if len(lines.frequency) < ROD_LINES:
        raise FitError(
            f"{len(lines.frequency)} lines of the rod are usable; expected {ROD_LINES} or more "
            "for a fit: measure more lines about the resonance"
        )
    frequency, modulus = _average_lines(lines, lines.modulus)
    changes = [
        _average_lines(lines, lines.modulus * (1 + relative))[1] - modulus
        for relative in lines.error_contributions
    ]
    fit_modulus: FitModulus = require_handler("fit complex modulus", "dma")
    fit = fit_modulus(
        frequency,
        modulus,
        arms=arms,
        family=family,
        specimen=specimen,
        common_errors=[change / modulus for change in changes],
    )
    if get_parameter_values(fit) is None:  # a dense spectrum has no errors of its own
        return fit
    shifts = _compute_parameter_shifts(fit, 2 * np.pi * frequency, changes)
    added_covariance = shifts @ shifts.T
    scatter = np.diag(fit.covariance)
    # a profile knows the scatter alone
    profiles = [
        profile
        for profile in fit.estimate.profiles
        if profile.parameter in fit.estimate.parameters
        and added_covariance[(i := fit.estimate.parameters.index(profile.parameter)), i]
        < scatter[i]
    ]
    estimate = replace(
        fit.estimate, covariance=fit.covariance + added_covariance, profiles=tuple(profiles)
    )
    return replace(fit, estimate=estimate)


def _compute_parameter_shifts(
    fit: Fit, omega: FloatArray, changes: Sequence[ComplexArray]
) -> FloatArray:
    """Return how changes of the modulus move the parameters, to first order; shape (p, changes).

    A refit would leave the range where the errors of badly determined arms are linear.
    """
    slopes = fit.model.arm_slopes(1j * omega)[0]
    if isinstance(fit.solid, FractionalZener):
        slopes = slopes @ fit.solid.arm_gradient()
    K = fit.solid.complex_stiffness(omega=omega)
    weight = 1 / np.concatenate((K.real, np.maximum(K.imag, _LEAST_LOSS_FACTOR * K.real)))

    def stack_parts(values: ComplexArray) -> FloatArray:
        return np.concatenate((values.real, values.imag)) * weight[:, None]

    return np.asarray(
        np.linalg.lstsq(
            stack_parts(slopes),
            stack_parts(np.array(changes, dtype=complex).reshape(-1, len(omega)).T),
            rcond=None,
        )[0]
    )


def _average_lines(lines: RodModulus, modulus: ComplexArray) -> tuple[FloatArray, ComplexArray]:
    """Return weighted means over a twenty-fourth of an octave."""
    part = np.floor(_PER_OCTAVE * np.log2(lines.frequency / lines.frequency[0]))
    first = np.flatnonzero(np.diff(part, prepend=-1.0))
    # scatter and all lines' common errors together: a line of greater error says less
    weights = (
        (lines.storage / lines.storage_sd) ** 2 if lines.storage_sd.all() else np.ones_like(part)
    )
    total = np.add.reduceat(weights, first)
    frequency = np.add.reduceat(weights * lines.frequency, first) / total
    mean = np.add.reduceat(np.asarray(weights * modulus, dtype=complex), first) / total
    return frequency, np.asarray(mean, dtype=complex)
