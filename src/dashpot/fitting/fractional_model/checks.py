"""Criteria on a fractional solid: known, adequate, and distinct from arms."""

from __future__ import annotations

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.errors import Status
from dashpot.datamodel.fit_diagnostics import Alternative

#: upper end of the usual frequencies of structure-borne vibration, Hz
MAX_HEARD_FREQUENCY = 100.0
#: a part of the stiffness, and of the loss factor, that is worth telling
MIN_STIFFNESS_DIFFERENCE, MIN_LOSS_DIFFERENCE = 0.02, 0.1


@criterion(
    "SE(alpha)",
    "<=",
    0.05,
    "our choice: 0.05 turns the loss by 12 % per decade",
    fit_status=Status.NOT_IDENTIFIED,
)
def fractional_slope_determined(error: float, *, edge: bool) -> Finding:
    """The exponent and the relaxation time of the fractional model are known.

    `edge` where one of them stands at an end of what is sought.
    """
    return Finding(
        f"The slope alpha is known to ±{error:.2g}",
        error,
        "The record shows too few decades of the spectrum",
        failure="The slope alpha or the relaxation time is at the end of its range. The spectrum "
        "is no bent power law that this record shows"
        if edge
        else "",
        remedy=Remedy("Fit arms.", "model", "maxwell") if edge else "Hold longer, or ramp faster.",
        always_fails=edge,
    )


@criterion(
    "residual / that of arms",
    "<=",
    1.02,
    "our choice: white residuals of 1000 samples scatter by 2 %",
    other_grade="stop beyond 1.1",
)
def fractional_model_suffices(ratio: float, arms: int) -> Finding:
    """The fractional model fits as well as a model with arms."""
    return Finding(
        f"The fractional model leaves {ratio:.4g} times the residual of {arms} arms",
        ratio,
        "The spectrum is no bent power law",
        Remedy("Fit arms.", "model", "maxwell"),
        grade="stop" if ratio > 1.1 else None,
    )


@criterion(
    "frequency from which they differ, Hz",
    ">",
    MAX_HEARD_FREQUENCY,
    "2 % of stiffness, 10 % of loss factor",
)
def model_families_distinguished(alternative: Alternative | None) -> Finding:
    """No other family of models fits the data and predicts another response."""
    if alternative is None or not alternative.is_sufficient:
        return Finding("No other family of models explains the data as well", always_passes=True)
    return Finding(
        alternative.message,
        alternative.differs_from_hz,
        remedy="Add a hammer test.",
        always_passes=alternative.differs_from_hz is None,
    )
