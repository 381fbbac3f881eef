"""Criteria on a comparison of FRFs.

Where both peaks agree, the hammer has tested what the relaxation test could not: the prediction was
extrapolated, or both tests compress the seal differently, and it held all the same.
"""

from __future__ import annotations

import numpy as np

from dashpot.base import number_format
from dashpot.base.checks import (
    MAX_MESSAGE_WORDS,
    Check,
    Finding,
    Grade,
    Remedy,
    criterion,
    format_short_message,
)
from dashpot.base.plain_text import clip_sentences
from dashpot.base.units import GRAVITY, format_quantity
from dashpot.datamodel.fit import Fit
from dashpot.vibration.comparison.comparison_result import Comparison
from dashpot.vibration.mass_on_seals import OperatingPoint
from dashpot.vibration.modal.peaks import Peak

# limits of the verdict: a frequency within 5 % is stiffness within 10 %
FREQUENCY_LIMIT = 0.05
HEIGHT_LIMIT = 3.0
DAMPING_LIMIT = 1.25
DEPTH_LIMIT = 0.25
# deviation, in limits, above which a prediction is useless
MAX_LIMIT_RATIO = 4.0
# measured, n = 21: from here on the parabola reads the peak to 1 %, with a third of it to 17 %
MIN_LINES = 1.5

JOINT_FIT_REMEDY = "Fit both tests together, or ramp faster."
_MASS_REMEDY = "Check the mass, the number of seals, their length and the preload."


def checks(
    c: Comparison,
    *,
    measured: Peak,
    predicted: Peak,
    fit: Fit | None,
    point: OperatingPoint | None,
) -> tuple[Check, ...]:
    """Every question that can be put to this comparison, answered."""
    stiffness, peak = stiffness_agrees(c), peak_agrees(c)
    damping = damping_agrees(c, measured)
    checks = [
        stiffness,
        peak,
        damping,
        no_unit_error(c),
        lines_resolve_the_peak(measured, predicted),
    ]
    stiffness_passed, damped = not stiffness.failed, not (peak.failed or damping.failed)
    if fit is not None:
        checks.append(inside_valid_band(c, fit, is_confirmed=stiffness_passed and damped))
        checks.append(damping_tested(c, fit, is_confirmed=damped))
    if point is not None and np.isfinite(point.compression):
        checks.append(operating_point(point, is_confirmed=stiffness_passed))
    return tuple(checks)


def _explain_no_peak(c: Comparison) -> bool:
    """The prediction is highest at an end of the lines: its peak lies elsewhere."""
    return int(np.argmax(np.abs(c.predicted.value))) in {0, len(c.predicted.value) - 1}


def _get_grade(limits: float) -> Grade | None:
    """Return the grade of a prediction that misses the measurement by so many limits."""
    return "stop" if limits > MAX_LIMIT_RATIO else None


@criterion(
    "frequency ratio - 1",
    "<=",
    FREQUENCY_LIMIT,
    "our choice: stiffness within 10 %",
    other_grade="stop beyond 0.2",
)
def stiffness_agrees(c: Comparison) -> Finding:
    """The predicted and the measured peak have the same frequency."""
    error = c.frequency_error
    if _explain_no_peak(c):
        f = c.predicted.frequency
        return Finding(
            f"The prediction has no peak from {f[0]:.3g} to {f[-1]:.3g} Hz. The measured one is at "
            f"{c.measured_hz:.4g} Hz",
            abs(error),
            remedy=_MASS_REMEDY,
            grade=_get_grade(abs(error) / FREQUENCY_LIMIT),
        )
    return Finding(
        f"The predicted peak is at {c.predicted_hz:.3f} Hz, the measured one at "
        f"{c.measured_hz:.3f} Hz ({100 * error:+z.2f} %). The storage stiffness there differs by "
        f"{100 * ((1 + error) ** 2 - 1):+z.1f} %",
        abs(error),
        remedy=_MASS_REMEDY,
        grade=_get_grade(abs(error) / FREQUENCY_LIMIT),
    )


@criterion(
    "predicted / measured height, dB",
    "|x| <=",
    HEIGHT_LIMIT,
    "our choice: a factor 1.4",
    other_grade="stop beyond 12 dB",
)
def peak_agrees(c: Comparison) -> Finding:
    """The predicted and the measured peak have the same height."""
    if _explain_no_peak(c):
        return Finding(
            f"No predicted line is higher than {10 ** (c.ratio_db / 20):.3g} times the measured "
            f"peak ({c.ratio_db:+z.1f} dB)",
            c.ratio_db,
            remedy=_MASS_REMEDY,
            grade=_get_grade(abs(c.ratio_db) / HEIGHT_LIMIT),
        )
    return Finding(
        f"The predicted peak is {10 ** (c.ratio_db / 20):.3g} times as high as the measured one "
        f"({c.ratio_db:+z.1f} dB)",
        c.ratio_db,
        f"The model has too {'little' if c.ratio_db > 0 else 'much'} damping there",
        JOINT_FIT_REMEDY,
        grade=_get_grade(abs(c.ratio_db) / HEIGHT_LIMIT),
    )


@criterion(
    "predicted / measured damping ratio",
    "x/",
    DAMPING_LIMIT,
    other_grade="stop beyond a factor 2.4",
)
def damping_agrees(c: Comparison, measured: Peak) -> Finding:
    """The predicted and the measured damping ratio are the same."""
    if c.measured_damping is None or c.predicted_damping is None:
        source = "measured" if c.measured_damping is None else "predicted"
        return Finding(
            f"The {source} FRF gives no damping ratio. Its half-power band has "
            f"{measured.half_power_lines:.1f} lines, and {100 * measured.decay:.0f} % of the "
            "response is left at the end of the record. A longer record would give one",
        )
    ratio = c.predicted_damping / c.measured_damping
    return Finding(
        f"The predicted damping ratio is {100 * c.predicted_damping:.3g} %, the measured one "
        f"{100 * c.measured_damping:.3g} % (ratio {ratio:.3g})",
        ratio,
        remedy=JOINT_FIT_REMEDY,
        grade=_get_grade(abs(float(np.log(ratio))) / np.log(DAMPING_LIMIT)),
    )


@criterion(
    "measured / predicted",
    grade="stop",
    source="not near sqrt(1000) in frequency, 9.81 or 1000 in height",
)
def no_unit_error(c: Comparison) -> Finding:
    """No unit error shows: sqrt(1000) in frequency, 9.81 or 1000 in height."""
    frequency = c.measured_hz / c.predicted_hz
    height = float(np.median(np.abs(c.measured.value) / np.abs(c.predicted.value)))
    for ratio, factor, explanation in (
        (frequency, np.sqrt(1000), "mass or stiffness by a factor 1000 (g for kg, N/mm for N/m)"),
        (
            height,
            GRAVITY,
            "an acceleration in g where m/s^2 was meant, or a sensitivity 10 times off",
        ),
        (height, 1000.0, "mm for m, or mN for N"),
    ):
        if abs(abs(np.log(ratio)) - np.log(factor)) < np.log(1.1):
            return Finding(
                f"A unit looks wrong: {explanation}. Measured over predicted is {ratio:.3g}, close "
                f"to {factor:.4g} or its inverse",
                ratio,
                remedy=Remedy("Check the units of mass, force and acceleration.", "units"),
                limit=factor,
                always_fails=True,
            )
    return Finding(
        "The factor between prediction and measurement is not that of a wrong unit", frequency
    )


@criterion(
    "lines in the half-power band",
    ">=",
    MIN_LINES,
    "measured: the height is read to 1 %, with a third of the lines to 17 %",
)
def lines_resolve_the_peak(measured: Peak, predicted: Peak) -> Finding:
    """The frequency resolution is fine enough for both peaks."""
    lines = min(measured.half_power_lines, predicted.half_power_lines)
    source = "measured" if measured.half_power_lines <= predicted.half_power_lines else "predicted"
    return Finding(
        f"The half-power band of the {source} peak has {lines:.1f} lines; at least "
        f"{MIN_LINES:g} are needed",
        lines,
        "The frequency resolution is too coarse to give the height of this peak",
        Remedy("Record longer after each hit.", "hit-length"),
    )


@criterion("distance from the valid band, a factor", "<=", 1.0, "the valid band of the fit")
def inside_valid_band(c: Comparison, fit: Fit, *, is_confirmed: bool = False) -> Finding:
    """The measured peak lies in the valid band of the fit, or confirms the prediction."""
    low, high = fit.band
    if not high > 0:
        return Finding("The fit has no valid band, so this check does not apply")
    factor = max(c.measured_hz / high, low / c.measured_hz)
    peak = f"The measured peak ({c.measured_hz:.4g} Hz) lies"
    band = f"the valid band of the fit ({low:.2g} to {high:.2g} Hz)"
    message = f"{peak} in {band}"
    if factor > 1:
        side_word = "above" if c.measured_hz > high else "below"
        message = f"{peak} a factor of {factor:.3g} {side_word} {band}"
        message += ". Yet the measurement agrees" if is_confirmed else ""
    return Finding(message, factor, remedy=JOINT_FIT_REMEDY, always_passes=is_confirmed)


@criterion("1 / (2 pi peak), s", source="the valid band of the relaxation test")
def damping_tested(c: Comparison, fit: Fit, *, is_confirmed: bool = False) -> Finding:
    """The relaxation test covers the arms behind the loss, or the hammer confirms them."""
    low, high = fit.band
    if not high > 0:
        return Finding("The fit has no valid band, so this check does not apply")
    tau = 1 / (2 * np.pi * c.measured_hz)
    if low <= c.measured_hz <= high:
        return Finding(
            f"Damping at {c.measured_hz:.4g} Hz comes from relaxation in about "
            f"{_format_time(tau)}, "
            "which the test behind the fit can see",
            tau,
        )
    fastest = min([1 / (2 * np.pi * high), *(arm.tau for arm in c.arms if arm.seen_by_relaxation)])
    message = (
        f"Damping at {c.measured_hz:.4g} Hz comes from relaxation in about {_format_time(tau)}. "
        f"The relaxation test covers {_format_time(fastest)} to "
        f"{_format_time(1 / (2 * np.pi * low))}"
    )
    leading_arm = max(c.arms, key=lambda arm: arm.loss_share, default=None)
    if leading_arm is not None:
        message += (
            f". The arm at tau = {leading_arm.tau:.4g} s gives {100 * leading_arm.loss_share:.1f} "
            "% of the predicted loss"
            + (", although it is much slower" if leading_arm.tau > 5 * tau else "")
        )
    return Finding(
        message + (". Yet the hammer test agrees" if is_confirmed else ""),
        tau,
        remedy=JOINT_FIT_REMEDY,
        limit=1 / (2 * np.pi * high),
        always_fails=not is_confirmed,
    )


@criterion("compression under the mass, m", source="our choice: within 25 % of the tested depth")
def operating_point(point: OperatingPoint, *, is_confirmed: bool = False) -> Finding:
    """The prediction is for the compression of the seals under the mass."""
    compression, depth = point.compression, point.depth
    message = (
        f"The seals are compressed by {format_quantity(compression, 'mm', '.2f')}, as given"
        if point.is_stated
        else f"The mass sinks {format_quantity(compression, 'mm', '.2f')} into the seals by its "
        "weight"
    )
    if depth is None:
        return Finding(f"{message}. The depth of their test is not known")
    if not point.linear:
        return Finding(
            f"{message}. Its tangent stiffness there is "
            f"{number_format.with_error(point.factor, point.factor_se or np.nan)} times the secant "
            f"at {format_quantity(depth, 'mm', '.3g')}",
            compression,
            f"The relaxation test went to {format_quantity(depth, 'mm', '.3g')} only. Beyond, its "
            "last tangent is used",
            "Test the seal deeper.",
            limit=depth,
            always_fails=point.is_extrapolated,
        )
    is_near = abs(compression - depth) <= DEPTH_LIMIT * depth
    tested_compression = f"the {format_quantity(depth, 'mm', '.3g')} of the relaxation test"
    return Finding(
        f"{message}, close to {tested_compression}"
        if is_near
        else f"{message}, not to {tested_compression}. Yet the frequency agrees",
        compression,
        failure=f"{message}; the relaxation test was at {format_quantity(depth, 'mm', '.3g')}. A "
        "stiffness that depends on depth makes the two tests differ",
        remedy=Remedy("Give the compression of the seals, if they were pressed.", "compression"),
        limit=depth,
        always_fails=not (is_near or is_confirmed),
        # a ramp that a straight law follows went through every lesser compression
        grade="limit" if point.is_extrapolated else "note",
    )


def format_conclusion(c: Comparison) -> str:
    """Return the conclusion of a comparison: agreement, differences, causes and remedy."""
    checks = {check.name: check for check in c.checks}
    unit_check, damping_check = checks["no_unit_error"], checks.get("damping_tested")
    if unit_check.failed:
        return format_short_message(unit_check)
    has_stiffness = not checks["stiffness_agrees"].failed
    damped = not (checks["peak_agrees"].failed or checks["damping_agrees"].failed)
    if has_stiffness and damped and (damping_check is None or not damping_check.failed):
        return f"The prediction matches the measurement: {c.resonance_match}."
    first = _format_frequency_error(c, agrees=has_stiffness)
    if damped:
        return f"{first} {_MASS_REMEDY}"
    damping_error = _format_damping_error(c)
    sentences = [damping_error, first] if has_stiffness else [first, damping_error]
    if damping_check is not None and damping_check.failed:
        unmeasured_time = _format_time(damping_check.value or 0.0)
        sentences.append(f"The relaxation test does not cover relaxation within {unmeasured_time}.")
        return clip_sentences(MAX_MESSAGE_WORDS, sentences, [JOINT_FIT_REMEDY])
    return clip_sentences(
        MAX_MESSAGE_WORDS, sentences, [JOINT_FIT_REMEDY if has_stiffness else _MASS_REMEDY]
    )


def _format_frequency_error(c: Comparison, *, agrees: bool) -> str:
    """Return the error of the peak frequency, in a sentence."""
    error_text = f"{100 * c.frequency_error:+z.1f} %"
    if agrees:
        return f"The frequency agrees ({error_text})."
    peaks_text = f"predicted at {c.predicted_hz:.4g} Hz and measured at {c.measured_hz:.4g} Hz"
    return f"The peak is {peaks_text} ({error_text})."


def _format_damping_error(c: Comparison) -> str:
    """Return the error of the damping in a sentence or, where it is not known, of the height."""
    if c.predicted_damping is None or c.measured_damping is None:
        return f"The peak is {c.ratio_db:+z.1f} dB off."
    predicted, measured = 100 * c.predicted_damping, 100 * c.measured_damping
    return f"Damping ratio {predicted:.3g} % predicted, {measured:.3g} % measured."


def _format_time(value: float) -> str:
    return format_quantity(value, "ms", ".3g") if value < 1 else f"{value:.3g} s"
