"""Criteria on a transfer stiffness."""

from __future__ import annotations

import math

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.number_format import format_count
from dashpot.extensions.transfer_stiffness.third_octaves import MIN_LINES

MIN_BLOCKED_DIFFERENCE = 20.0
"""Level difference of input and output motion above which the output counts as blocked, dB."""


@criterion("level difference, dB", ">=", MIN_BLOCKED_DIFFERENCE, "ISO 10846-2, ISO 10846-3")
def output_blocked(difference: float | None, *, valid_from: float | None) -> Finding:
    """The output of the mount moves at least 20 dB less than its input at every line."""
    if difference is None:
        return Finding("The motion of the output was not given, so it is not known to be blocked")
    range_text = (
        "No line is valid" if valid_from is None else f"Lines are valid from {valid_from:.3g} Hz on"
    )
    return Finding(
        f"The output moves at least {difference:.3g} dB less than the input",
        difference,
        range_text,
        Remedy("Narrow the band, or use a heavier mass.", "exact"),
        failure=f"Input over output is only {difference:.3g} dB at its worst line, and "
        f"{MIN_BLOCKED_DIFFERENCE:g} dB are needed",
    )


@criterion("magnification of errors", "<=", 2.0, "our choice: below, half as well known")
def errors_not_magnified(factor: float) -> Finding:
    """The exact formula does not magnify the errors of the sensors more than twice."""
    return Finding(
        f"The exact formula multiplies the errors of the sensors by {factor:.3g} at most",
        factor,
        "Mount and mass move as one where the transmissibility is near 1",
        Remedy("Narrow the band, or use a heavier mass.", "band"),
    )


@criterion("inertia of the flange over the force", "<=", 0.06, "ISO 10846-2")
def flange_inertia_negligible(part: float | None) -> Finding:
    """The mass between mount and force transducers takes at most 6 % of the force."""
    if part is None:
        return Finding("The inertia of the flange is not known: neither its mass nor its motion is")
    return Finding(
        f"The flange takes {100 * part:.3g} % of the force at most",
        part,
        remedy=Remedy("Use a lighter flange, or take the exact formula.", "exact"),
    )


@criterion("highest frequency over the limit", "<=", 1.0, "stated by the user")
def blocking_mass_rigid(highest: float, rigid_to: float | None) -> Finding:
    """The blocking mass, or the foundation, is rigid up to the highest line."""
    if rigid_to is None:
        return Finding("Up to which frequency mass or foundation are rigid was not stated")
    return Finding(
        f"Mass and foundation are rigid to {rigid_to:.4g} Hz, and the lines end at "
        f"{highest:.4g} Hz",
        highest / rigid_to,
        remedy=Remedy("Narrow the band.", "band"),
    )


@criterion("lines in a third octave", ">=", MIN_LINES, "ISO 10846-2, ISO 10846-3")
def third_octaves_resolved(fewest_lines: int, *, centre: float) -> Finding:
    """Every third octave has at least five lines."""
    return Finding(
        f"Every third octave has {fewest_lines} lines or more",
        fewest_lines,
        failure=f"The third octave at {centre:g} Hz has {format_count(fewest_lines, 'line')}, of "
        "which no mean is taken",
        remedy="Measure with a finer frequency resolution.",
    )


@criterion("half width of the 95 % interval, dB", "<=", 1.5, "linearity in ISO 10846-2")
def level_determined(half_width: float, *, centre: float) -> Finding:
    """The level of every third octave is known to 1.5 dB."""
    if not math.isfinite(half_width):
        return Finding(
            "The level of the transfer stiffness is not limited",
            always_fails=True,
            remedy="Measure more averages.",
        )
    return Finding(
        f"The level is known to {half_width:.2g} dB or better",
        half_width,
        failure=f"The level in the third octave at {centre:g} Hz is known to {half_width:.2g} dB "
        "only",
        remedy="Measure more averages, or state smaller errors of sensors and mass.",
    )


@criterion("upper limit of the loss factor", ">=", 0.0, "passivity", grade="stop")
def mount_dissipates(highest: float, *, centre: float) -> Finding:
    """The loss factor of every third octave may be above zero."""
    return Finding(
        "The loss factor is above zero, or may be, in every third octave",
        highest,
        failure=f"The loss factor in the third octave at {centre:g} Hz is below zero: at most "
        f"{highest:.2g}",
        remedy="Check polarity, order and delay of the two channels.",
    )


@criterion(
    "storage over size of the stiffness", ">", 0.0, "the storage stiffness of a spring is positive"
)
def mount_acts_as_spring(min_cosine: float, *, frequency: float) -> Finding:
    """Force and input displacement are in phase at every line, as those of a spring."""
    return Finding(
        "The storage stiffness is above zero at every line",
        min_cosine,
        failure=f"The storage stiffness is below zero at {frequency:.4g} Hz: a mass, or a "
        "resonance of the mount, is in the path",
        remedy=Remedy("Narrow the band. Check the polarity of the channels.", "band"),
    )


@criterion("distance from the valid band, a factor", "<=", 1.0, "the valid band of the fit")
def third_octaves_in_valid_band(
    lines: tuple[float, float], band: tuple[float, float], *, has_record: bool
) -> Finding:
    """The third octaves lie in the valid band of the fit, or limits include unresolved arms."""
    (first, last), (low, high) = lines, band
    extrapolation = max(last / high, low / first) if high > 0 else math.inf
    return Finding(
        f"The lines lie in the valid band of the fit, {low:.2g} to {high:.2g} Hz"
        if extrapolation <= 1
        else "The intervals include every arm that the record does not exclude",
        extrapolation,
        "Its intervals contain standard errors alone there",
        Remedy("Narrow the band, or give the record behind the fit.", "record"),
        failure=f"The fit covers {low:.2g} to {high:.2g} Hz, and the table reaches "
        f"{extrapolation:.3g} times further",
        always_passes=has_record,
    )


@criterion(source="by definition", grade="note")
def line_noise_stated(estimated: float) -> Finding:
    """The FRF states the scatter of its lines."""
    return Finding(
        f"The FRF states no scatter. That of neighbouring lines is {100 * estimated:.2g} %",
        remedy="Export the coherence and the number of averages with it.",
        always_fails=True,
    )
