"""Fits made by hand, laid out flat: a test names what matters, the rest is usual; what failed."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from typing import Any

import numpy as np

from dashpot.base.errors import Status
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence, Provenance
from dashpot.datamodel.parameter_estimate import (
    ELEMENT_PARAMETERS,
    ParameterEstimate,
    Residual,
    parameter_names,
)
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import Solid

PARTS = {"estimate": ParameterEstimate, "evidence": Evidence, "provenance": Provenance}


def list_failed_checks(result: Any) -> set[str]:
    """The names of its checks that failed, notes too."""
    return {check.name for check in result.checks if check.failed}


def a_fit(solid: Solid, *, relative: float = 0.01, **inputs: object) -> Fit:
    """A fit of `solid` with equal relative errors of every parameter, or as said."""
    model = solid.maxwell
    if isinstance(solid, FractionalZener):
        names, sizes = ELEMENT_PARAMETERS, relative * np.array([solid.k_inf, solid.k_0, 1.0, 1.0])
    else:
        names = parameter_names(model.arms)
        sizes = relative * np.array([model.k_inf, *model.k, *np.ones(model.arms)])
    usual = Fit(
        solid,
        Status.CONVERGED,
        ParameterEstimate(names, np.diag(sizes**2), 100.0, Residual(1000, 1.0, 0.03)),
        Evidence((0.004, 0.32)),
        Provenance("full"),
    )
    return replace_fields(usual, **inputs)


def restrict_to_noise(fit: Fit) -> Fit:
    """The fit with the errors of its residuals alone, as if its rig had done nothing unseen."""
    return replace(fit, estimate=fit.estimate.noise_only)


def replace_fields(fit: Fit, **inputs: object) -> Fit:
    """The fit with some fields of its own or of its parts replaced."""
    for part, kind in PARTS.items():
        individual = {
            field.name: inputs.pop(field.name) for field in fields(kind) if field.name in inputs
        }
        if individual:
            inputs[part] = replace(getattr(fit, part), **individual)
    return replace(fit, **inputs)


def formal_errors(fit):
    """Standard errors as `Fit.standard_error`, with that which the covariance has for k_inf."""
    return {**fit.standard_error, "k_inf": float(fit.covariance[0, 0] ** 0.5)}


def solid_errors(fit: Fit) -> dict[str, float]:
    """Return the standard errors of the model's own parameters; nan where there is none."""
    return {
        value.name: math.nan if value.error is None else value.error
        for value in fit.facts
        if not value.name.startswith("b")
    }


def solid_intervals(fit: Fit) -> dict[str, tuple[float, float]]:
    """Return the 95 % intervals of the model's own parameters; nothing bounds k_inf from below."""
    return {
        value.name: (0.0 if math.isnan(value.low) else value.low, value.high)
        for value in fit.facts
        if not value.name.startswith("b")
    }
