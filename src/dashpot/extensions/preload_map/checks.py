"""Criteria on a preload map."""

from __future__ import annotations

import math
from collections.abc import Sequence

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.number_format import format_count
from dashpot.extensions.preload_map.separability import SIGNIFICANCE_LEVEL, PairTest

_SEPARABILITY_REMEDIES = {
    "compression and frequency": "Fit each compression alone.",
    "amplitude and frequency": "Fit each amplitude alone.",
    "compression and amplitude": "Make a map of each compression alone.",
}


def _find_separability(test: PairTest) -> Finding:
    if test.is_separable is None:
        return Finding(f"No combination of sweeps shows whether {test.pair} are separable")
    size = f"{100 * (test.departure or 0):.2g} %"
    angle_text = f"{test.angle or 0:.2g} rad"
    reason = "too little to matter" if test.is_negligible else "no more than chance"
    message = f"{test.pair.capitalize()} are separable but for {size} and {angle_text}"
    return Finding(
        f"{message}, {reason}",
        test.chance,
        failure=f"{test.pair.capitalize()} are not separable: the stiffness departs by up to "
        f"{size} and {angle_text} (probability {test.shown_chance})",
        remedy=_SEPARABILITY_REMEDIES[test.pair],
        always_passes=test.is_negligible,
    )


@criterion(
    "probability by chance", ">=", SIGNIFICANCE_LEVEL, "F tests at 1 %; or within 1 % and 0.01 rad"
)
def compression_and_frequency_separable(test: PairTest) -> Finding:
    """Every compression has the same dependence on frequency, up to a real factor."""
    return _find_separability(test)


@criterion(
    "probability by chance", ">=", SIGNIFICANCE_LEVEL, "F tests at 1 %; or within 1 % and 0.01 rad"
)
def amplitude_and_frequency_separable(test: PairTest) -> Finding:
    """Every amplitude has the same dependence on frequency, up to a complex factor."""
    return _find_separability(test)


@criterion(
    "probability by chance", ">=", SIGNIFICANCE_LEVEL, "F tests at 1 %; or within 1 % and 0.01 rad"
)
def compression_and_amplitude_separable(test: PairTest) -> Finding:
    """The stiffness falls with amplitude alike at every compression."""
    return _find_separability(test)


@criterion("pairs of variables without a test", "<=", 0, "by definition")
def every_pair_tested(untested: Sequence[str]) -> Finding:
    """The sweeps test the separability of every pair of variables."""
    return Finding(
        "Sweeps of several combinations test every pair",
        len(untested),
        "The map assumes it",
        "Add a sweep at another amplitude to another compression.",
        failure=f"No sweeps show whether {' or '.join(untested)} are separable",
    )


@criterion("departure that is not excluded, over the tolerance", "<=", 1.0,
           "our choice: 5 % of the stiffness, 0.02 of the loss angle in rad")  # fmt: skip
def departure_excluded(excluded_departure: float, angle: float) -> Finding:
    """The sweeps exclude a departure from separability of 5 % and of 0.02 rad."""
    return Finding(
        f"Departures above {100 * excluded_departure:.2g} % and {angle:.2g} rad are excluded at 95 "
        "%",
        max(excluded_departure / 0.05, angle / 0.02),
        "A smaller departure would stay unseen",
        "Measure more frequencies, or lower the noise.",
        failure=f"A departure of {100 * excluded_departure:.2g} % or {angle:.2g} rad from a "
        "separable stiffness is not excluded",
    )


@criterion("rms residual of the worst sweep", "<=", 0.1, "our choice", grade="stop")
def sweeps_followed(residual: float, *, sweep_text: str) -> Finding:
    """The map follows every sweep to 10 %."""
    return Finding(
        f"The map follows every sweep to {100 * residual:.2g} %",
        residual,
        "The stiffness is not the product of three laws",
        "Check the compression and amplitude of every file. Fit them one by one.",
        failure=f"The map misses the sweep at {sweep_text} by {100 * residual:.2g} %",
    )


@criterion("levels", ">=", 3, "two levels show no curvature")
def levels_enough(levels: int, *, axis: str) -> Finding:
    """Three compressions or more, and no amplitudes or three, show the curvature of the laws."""
    return Finding(
        f"At least {levels} levels of compression and of amplitude show the curvature of the laws",
        levels,
        "Between them the bend of its law is not known, nor is the error of the map",
        f"Measure at a third {axis}.",
        failure=f"The sweeps have {levels} levels of {axis} only",
    )


@criterion("error of the interpolation", "<=", 0.05, "our choice")
def levels_dense(error: float, *, axis: str) -> Finding:
    """Between levels the interpolation is known to 5 %."""
    return Finding(
        f"Between levels the map is interpolated to {100 * error:.2g} % or better",
        error,
        remedy=f"Measure at more levels of {axis}.",
        failure=f"Between levels of {axis} the map is known to {100 * error:.2g} % only",
    )


@criterion("misfit over the noise of the master curve", "<=", 2.0, "our choice")
def solid_follows_master_curve(ratio: float, *, misfit: float) -> Finding:
    """The Maxwell model follows the common dependence on frequency."""
    return Finding(
        f"The Maxwell model follows the common curve over frequency to {100 * misfit:.2g} %",
        ratio,
        "Inertia, a resonance of the rig or a wrong phase may cause this",
        Remedy("Narrow the band. Check polarity and delay of the channels.", "band"),
        failure=f"The Maxwell model misses the common curve over frequency by "
        f"{100 * misfit:.2g} %, {ratio:.2g} times its noise",
        always_passes=misfit < 1e-3,
    )


@criterion("upper limit of the loss factor", ">=", 0.0, "passivity", grade="stop")
def part_dissipates(largest_loss_factor: float, *, frequency: float) -> Finding:
    """The loss factor of every sweep may be above zero."""
    return Finding(
        "The loss factor is above zero, or may be, at every frequency",
        largest_loss_factor,
        failure=f"The loss factor at {frequency:.4g} Hz is below zero",
        remedy="Check polarity, order and delay of the two channels.",
    )


@criterion("half width of the 95 % interval, relative", "<=", 0.1, "our choice")
def stiffness_determined(half_width: float) -> Finding:
    """The stiffness is known to 10 % at every setting."""
    if not math.isfinite(half_width):
        return Finding("The stiffness is not limited", always_fails=True, remedy="Repeat sweeps.")
    return Finding(
        f"The stiffness is known to {100 * half_width:.2g} % or better",
        half_width,
        remedy="State smaller errors of the sensors, or repeat the sweeps.",
        failure=f"The stiffness is known to {100 * half_width:.2g} % only",
    )


@criterion("half width of the 95 % interval over the loss factor", "<=", 0.5, "our choice")
def loss_factor_determined(half_width: float, *, loss_factor: float) -> Finding:
    """The loss factor is known to half of itself at every setting."""
    return Finding(
        f"The loss factor is known to {half_width * loss_factor:.2g} or better",
        half_width,
        "The error of the phase between the sensors decides that",
        "Measure that phase error on a steel spring, and state it.",
        failure=f"The loss factor is as small as {loss_factor:.2g} and is known only to "
        f"±{half_width * loss_factor:.2g}",
    )


@criterion(source="by definition", grade="note")
def repeatability_determined(repeats: int, *, is_stated: bool) -> Finding:
    """Repeated sweeps, or the user, say how well a setting is repeated."""
    if repeats:
        text = f"{format_count(repeats, 'repeated sweep')} show the scatter between sweeps"
        return Finding(text, always_passes=True)
    if is_stated:
        return Finding("The scatter between sweeps was stated", always_passes=True)
    return Finding(
        "No sweep was repeated. Scatter between sweeps would count as a departure",
        remedy="Repeat a sweep at one setting, or state the scatter.",
        always_fails=True,
    )
