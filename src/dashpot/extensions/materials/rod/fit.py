r"""Fit of a viscoelastic model to the modulus of a rod's material.

The lines of the usable band are fitted as a dynamic test is. What spoils all lines alike, such as a
gain, is no scatter that the fit could see: the fit is repeated with each such error, and what it
moves is added to the covariance,

.. math:: C = C_{\text{scatter}} + \sum_i \delta_i \delta_i^T, \qquad
    \delta_i = \hat\theta(E^* + \sigma_i\,\partial E^*/\partial p_i) - \hat\theta(E^*)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
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

FitModulus: TypeAlias = Callable[..., Fit]
"""Step from a complex modulus to a model."""
_PER_OCTAVE = 24


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
    fit_modulus: FitModulus = partial(
        require_handler("fit complex modulus", "dma"), frequency, specimen=specimen
    )
    fit = fit_modulus(modulus, arms=arms, family=family)
    parameters = get_parameter_values(fit)
    if parameters is None:  # a dense spectrum has no errors of its own
        return fit
    added_covariance = np.zeros_like(fit.covariance)
    for relative in lines.error_contributions:
        _, change = _average_lines(lines, lines.modulus * (1 + relative))
        changed_fit = _fit_same_solid(fit, fit_modulus, change)
        shift = np.zeros(len(parameters)) if changed_fit is None else changed_fit - parameters
        added_covariance += np.outer(shift, shift)
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


def _fit_same_solid(fit: Fit, fit_modulus: FitModulus, modulus: ComplexArray) -> FloatArray | None:
    """Return the parameters of the same model under another test; None if no fit is found."""
    try:
        other_fit = fit_modulus(modulus, arms=_order(fit), family=fit.family)
    except FitError:
        return None
    return (
        get_parameter_values(other_fit)
        if other_fit.estimate.parameters == fit.estimate.parameters
        else None
    )


def _order(fit: Fit) -> int | Literal["auto"]:
    return "auto" if fit.family == "fractional" else fit.model.arms


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
