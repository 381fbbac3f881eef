"""Whether a fractional solid is known, explains the data, and is told apart from arms."""

from __future__ import annotations

from dashpot.base.checks import Finding, criterion
from dashpot.base.status import Status
from dashpot.records.alternative import Alternative

#: frequencies at which parts of a car or a machine vibrate and are heard end about here, Hz
HEARD = 100.0
#: a part of the stiffness, and of the loss factor, that is worth telling
STIFFNESS_MATTERS, LOSS_MATTERS = 0.02, 0.1


@criterion(
    "SE(alpha)",
    "<=",
    0.05,
    "our choice: 0.05 turns the loss by 12 % per decade",
    ends=Status.NOT_IDENTIFIED,
)
def slope_known(error: float, *, edge: bool) -> Finding:
    """The slope of the fractional solid and its relaxation time are known.

    `edge` where one of them stands at an end of what is sought.
    """
    return Finding(
        f"the slope alpha is known to +- {error:.2g}",
        error,
        ": the record shows too few decades of the spectrum; hold longer or ramp faster",
        instead="the slope alpha or the relaxation time stands at the end of what is sought, so "
        "the spectrum is no bent power law that this record shows: fit arms"
        if edge
        else "",
        faulted=edge,
    )


@criterion(
    "residual / that of arms",
    "<=",
    1.02,
    "our choice: white residuals of 1000 samples scatter by 2 %",
    otherwise="stop beyond 1.1",
)
def element_explains(ratio: float, arms: int) -> Finding:
    """The fractional solid leaves no more than arms do."""
    return Finding(
        f"the fractional solid leaves {ratio:.4g} times the residual of {arms} arms",
        ratio,
        ": the spectrum is no bent power law; fit arms (family maxwell)",
        grade="stop" if ratio > 1.1 else None,
    )


@criterion(
    "frequency from which they part, Hz", ">", HEARD, "2 % of stiffness, 10 % of loss factor"
)
def families_told_apart(other: Alternative | None) -> Finding:
    """No other family of solids explains the data and predicts something else."""
    if other is None or not other.explains:
        return Finding("no other family of solids explains the data as well", excused=True)
    return Finding(other.says, other.parts_at, excused=other.parts_at is None)
