"""Criteria on the ramp of a fit, its load cell and its clocks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.fitting.nonlinear_ramp.linearity import LinearFitQuality
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

# Ratio of the hold residuals, joint fit over separate fit, that indicates another seal.
_CONTRADICTION = 2.0
_NEGLIGIBLE_RESIDUAL = 0.005
# relative distance of k_inf from the end force from which it is wrong
_IMPLAUSIBLE_SHARE = 0.25
# delay over its prior SD from which it is another fault: 25 ms by default. The limits of one test
# hold for unstated delays and filters of 2 to 20 ms; several tests together have no limits, so
# 8.5 ms counts
MAX_DELAY_SD, MAX_JOINT_DELAY_SD = 5.0, 1.7
# noise of the ramp over that of the hold from which the ramp follows another law
_MAX_NOISE_RATIO = 1.5
# distance of the fit outside its limits, over their width, that the record excludes
MAX_EXCESS = 0.25


@criterion(
    "ramp residual / peak",
    "<=",
    0.01,
    f"our choice; or 1.5 times the noise, and that {_MAX_NOISE_RATIO} times the hold's if no law "
    "bends",
)
def ramp_residual_small(residual: float, noise: float, discrepancy: float, kind: str) -> Finding:
    """The model fits the ramp.

    `residual` and `noise` are fractions of the largest force, `discrepancy` is the scatter of one
    independent sample of the ramp over that of the hold, `kind` that of the elastic law.
    """
    return Finding(
        f"The model misses the ramp by {100 * residual:.2g} % of the peak, with a {kind} elastic "
        f"law. Its rows count with {discrepancy:.3g} times the noise of the hold",
        residual,
        "No elastic law follows the ramp. So k_inf and slow arms come from the hold; fast arms and "
        "tangent are uncertain",
        "Record the motion at the seal, without slip.",
        always_passes=residual <= 1.5 * noise,
        # no linear solid explained ramp and hold, and no law was found that does
        always_fails=kind == "linear" and discrepancy > _MAX_NOISE_RATIO,
    )


@criterion(
    "ramp residual / noise",
    "<=",
    1.2,
    "simulation: beyond it 8 of 11 results were wrong; more if the ramp has few samples",
)
def ramp_explained(quality: LinearFitQuality | None) -> Finding:
    """A linear model fits ramp and hold to within their noise."""
    if quality is None:
        return Finding("The record is not one ramp and one hold, so this check does not apply")
    return Finding(
        f"A linear model leaves {quality.ramp_ratio:.3g} times the noise on the ramp",
        quality.ramp_ratio,
        "No nonlinear law explains it better: two faults may hide each other, such as a seal that "
        "stiffens a little and one that warms. Fast arms, and their loss, are uncertain",
        "Press at a second speed, or strike the seal with a hammer.",
        always_passes=quality.is_adequate,
    )


@criterion("hold residual / hold alone", "<=", 1.25, "our choice; or 0.5 % of the peak")
def hold_residual_small(rho: Sequence[float], residuals: Sequence[float]) -> Finding:
    """The model fits each hold as well as a fit of that hold alone does.

    `residuals` are those of each hold as fractions of the largest force; below 0.5 % they are
    negligible.
    """
    worst_index = int(
        np.argmax(
            np.where(np.array(residuals) > _NEGLIGIBLE_RESIDUAL, rho, 0.0) + 1e-9 * np.array(rho)
        )
    )
    test_label = f" of test {worst_index + 1}" if len(rho) > 1 else ""
    return Finding(
        f"The residual of the hold{test_label} is {rho[worst_index]:.3g} times that of its own fit",
        float(rho[worst_index]),
        "The tests contradict each other: another specimen, temperature, or shape of relaxation"
        if len(rho) > 1
        else "The ramp changes what the hold gives",
        "Fit each test alone." if len(rho) > 1 else Remedy("Fit the hold alone.", "method", "hold"),
        always_passes=residuals[worst_index] <= _NEGLIGIBLE_RESIDUAL,
        grade="stop" if rho[worst_index] > _CONTRADICTION else "limit",
    )


@criterion(
    "ramps of different rate or depth",
    ">=",
    2.0,
    "simulation",
    other_grade="note of a law that bends little and evenly",
)
def tangent_determined(law: ElasticLaw, ramps: int) -> Finding:
    """More than one ramp determines the tangent stiffness within the ramp.

    One ramp shows the tangent within 5 % if all arms share one elastic law. A law of its own for
    each arm, friction or a motion commanded and not measured puts it 11 to 46 % off though the
    ramp is followed to the noise.
    """
    if law.kind == "linear":
        return Finding("The elastic law is linear: its tangent is its secant")
    ramps_text = f"{ramps} ramps of different rate or depth" if ramps > 1 else "one ramp"
    return Finding(
        f"The tangent stiffness comes from {ramps_text}; two are needed",
        float(ramps),
        "It is right to 5 % if all arms share one elastic law and the motion is that of the "
        "seal. Otherwise it can be 11 to 46 % off. The secant at the depth stays right",
        "Test a second ramp rate or depth.",
        grade="note" if law.is_gentle else None,
    )


@criterion("difference of k_inf / (F_end/x)", "<=", 0.05, "our choice; or 3 SE")
def k_inf_plausible(model: GeneralizedMaxwell, se: float, end: float, hold: float) -> Finding:
    r"""The equilibrium stiffness agrees with the force at the end of the hold.

    Of the force at the end over the depth, `end` in N/m, the arms still carry
    :math:`\sum_j k_j e^{-T/\tau_j}` after a `hold` T, s; the rest is k_inf.
    """
    total = sum(k * np.exp(-hold / tau) for k, tau in zip(model.k, model.tau, strict=True))
    difference = abs(model.k_inf - (end - float(total)))
    relative_difference = difference / max(abs(end), 1e-300)
    # a plateau that does not differ significantly from zero is not compared
    is_implausible = relative_difference > _IMPLAUSIBLE_SHARE and model.k_inf > 3.0 * se
    return Finding(
        f"k_inf and the rest of the arms miss the stiffness at the end of the hold by "
        f"{100 * relative_difference:.2g} %. They are {format_quantity(model.k_inf, 'N/mm')} and "
        f"{convert_to_unit(total, 'N/mm'):.2g}, and {format_quantity(end, 'N/mm')} was measured",
        relative_difference,
        "Offset or drift of the load cell took what is stiffness, or the other way round",
        Remedy("Record a baseline before contact, or give the drift.", "machine", "drift=..."),
        always_passes=difference <= 3.0 * se,
        grade="stop" if is_implausible else "limit",
    )


@criterion(
    "offset less baseline, SE",
    "<=",
    3.0,
    grade="note",
    other_grade="limit from 1 % of the force on",
)
def offset_plausible(results: Sequence[tuple[float, float, float, float]]) -> Finding:
    """The fitted offset of the load cell agrees with the force before contact.

    `results` holds of each test the fitted offset, its mean and its standard deviation before the
    fit, and the departure that matters, N.
    """
    return _compare_with_prior(results, "offset", 1e3, "mN", "the force at rest")


@criterion(
    "drift less baseline, SE",
    "<=",
    3.0,
    grade="note",
    other_grade="limit from 1 % of the force over the record on, if k(T) is beyond its limits",
)
def drift_plausible(
    results: Sequence[tuple[float, float, float, float]], excess: float = np.inf
) -> Finding:
    """The fitted drift of the load cell agrees with its baseline or data sheet.

    `results` as for the offset, N/s. The limits include the prior of the drift: while the
    fit lies inside them, within `excess` of their width, a large drift is harmless.
    """
    finding = _compare_with_prior(results, "drift", 1e3, "mN/s", "what is known of the cell")
    return finding if excess > MAX_EXCESS else finding._replace(grade=None)


@criterion(
    "slope of the baseline / 3 SD", "<=", 1.0, "Box 1980: beyond it the two contradict each other"
)
def baseline_agrees(slopes: Sequence[tuple[float, float]]) -> Finding:
    """The slope of the baseline is within the drift that the load cell may have.

    Of every record the slope of its baseline, N/s, over what it may be, and that over 3 standard
    deviations of what both leave.
    """
    slope, value = max(slopes, key=lambda pair: pair[1], default=(0.0, 0.0))
    return Finding(
        f"The baseline drifts by {format_quantity(slope, 'mN/s', '.2g')}, "
        f"{3 * value:.2g} standard deviations of what is known of the load cell",
        value,
        "The seal had not recovered from earlier loadings, or the cell drifts otherwise. Limits "
        "allow for both, the errors of single arms do not",
        "Let the seal rest longer, or record its earlier loadings, too. State this slope as a "
        "drift only if the cell shows it without the seal.",
    )


@criterion(
    "delay / its error",
    "<=",
    3.0,
    "3 standard errors",
    grade="note",
    other_grade="limit where the delay is far beyond what was thought possible",
)
def clocks_agree(results: Sequence[tuple[float, float, float]]) -> Finding:
    """There is no significant delay between force and displacement.

    `results` holds the fitted delay of the force, its standard error and its standard deviation
    before the fit of each test, s. The fit takes the delay into account, and so do the limits of
    one test.
    """
    if not results:
        return Finding("No delay between force and displacement is fitted")
    delay_ratios = [abs(value) / error if error > 0 else 0.0 for value, error, _ in results]
    worst_index = int(np.argmax(delay_ratios))
    value, error, prior = results[worst_index]
    test_label, max_delay_sd = (
        (f" of test {worst_index + 1}", MAX_JOINT_DELAY_SD)
        if len(results) > 1
        else ("", MAX_DELAY_SD)
    )
    return Finding(
        f"The force{test_label} lags the displacement by {convert_to_unit(value, 'ms'):.3g} ± "
        f"{format_quantity(error, 'ms', '.2g')}",
        delay_ratios[worst_index],
        "The fit corrects for this, but a late force looks like less damping",
        Remedy(
            "Read both channels at one time, or give the delay of the force.", "machine", "sync=..."
        ),
        grade="limit" if abs(value) > max_delay_sd * prior else None,
    )


def _compare_with_prior(
    results: Sequence[tuple[float, float, float, float]],
    noun: str,
    scale: float,
    unit: str,
    name: str,
) -> Finding:
    if not results:
        return Finding(f"No {noun} is fitted")
    deviations = [abs(value - mean) / sd if sd > 0 else 0.0 for value, mean, sd, _ in results]
    worst_index = int(np.argmax(deviations))
    value, mean, *_ = results[worst_index]
    is_notable = any(abs(value - mean) > max(3 * sd, limit) for value, mean, sd, limit in results)
    test_label = f" of test {worst_index + 1}" if len(results) > 1 else ""
    return Finding(
        f"The fitted {noun}{test_label} ({scale * value:.3g} {unit}) differs from {name} "
        f"({scale * mean:.3g} {unit}) by {deviations[worst_index]:.2g} standard deviations",
        deviations[worst_index],
        "It hides a misfit",
        "Record a longer baseline, or let the load cell warm up.",
        grade="limit" if is_notable else None,
    )
