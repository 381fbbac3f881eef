"""Criteria on stiffness at a frequency."""

from __future__ import annotations

import math

from dashpot.base.checks import Finding, criterion
from dashpot.base.number_format import format_band
from dashpot.datamodel.bounds import MAX_LOSS_FACTOR_ERROR


@criterion("distance from the valid band, as a factor", "<=", 1.0, "the valid band of the fit")
def frequencies_in_valid_band(frequencies: tuple[float, ...], band: tuple[float, float]) -> Finding:
    """The requested frequencies lie in the valid band of the fit."""
    low, high = band
    if not high > 0:
        return Finding(
            f"{frequencies[0]:.4g} Hz is asked, and the model has no valid band",
            math.inf,
            "Nothing says how well the answer is known",
            "Fit a test.",
        )

    def distance(frequency: float) -> float:
        return max(frequency / high, low / frequency)

    farthest_frequency = max(frequencies, key=distance)
    return Finding(
        f"{farthest_frequency:.4g} Hz is asked, and the model is valid {format_band(band)}",
        distance(farthest_frequency),
        "Stiffness and loss factor there are extrapolated",
        "Add a hammer test, or ramp faster.",
    )


@criterion(
    "error of the loss factor", "<=", MAX_LOSS_FACTOR_ERROR, "our choice, as in the valid band"
)
def loss_factor_determined_at(error: float | None, *, with_hammer: bool) -> Finding:
    """The loss factor at the requested frequencies is known."""
    if error is None:
        return Finding("How well the loss factor is known was not computed")
    size = f"±{100 * error:.2g} %" if error < 1 else "a factor of two or worse"
    return Finding(
        f"The loss factor at the frequencies asked is known to {size}",
        error,
        "Cables, table and added mass, and arms that the data cannot show, leave it open"
        if with_hammer
        else "Arms that the data cannot show leave it open",
        "Use the stiffness alone, or fit a hammer test whose cables hang free, and say so."
        if with_hammer
        else "Use the stiffness alone, or add a hammer test.",
    )
