"""The questions put to a comparison, and the sentence that matters."""

from __future__ import annotations

import numpy as np

from dashpot.base.checks import Check
from dashpot.records.fit import Fit
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.vibration.modal.peaks import Peak

GRAVITY = 9.80665
# limits of the verdict: a frequency within 5 % is stiffness within 10 %
FREQUENCY_LIMIT = 0.05
PEAK_LIMIT_DB = 3.0
DAMPING_LIMIT = 1.25


def checks(
    c: Comparison,
    *,
    seen: Peak,
    told: Peak,
    model: GeneralizedMaxwell | None,
    fit: Fit | None,
    mass: float | None,
    depth: float | None,
) -> tuple[Check, ...]:
    """Every question that can be put to this comparison, answered."""
    found = [_frequency(c), _height(c), _damping(c, seen), _units(c), _resolution(seen, told)]
    if fit is not None:
        found += [_extrapolation(c, fit), _tested(c, fit)]
    if model is not None and mass is not None and model.k_inf > 0:
        found.append(_operating_point(model, mass, depth))
    return tuple(found)


def _frequency(c: Comparison) -> Check:
    error = c.frequency_error
    passed = abs(error) <= FREQUENCY_LIMIT
    says = (
        f"the predicted peak is at {c.predicted_hz:.3f} Hz, the measured one at "
        f"{c.measured_hz:.3f} Hz ({100 * error:+z.2f} %), so the storage stiffness there is "
        f"{100 * ((1 + error) ** 2 - 1):+z.1f} % off"
    )
    advice = "" if passed else ": check mass, number of seals, length and preload"
    return Check("stiffness_agrees", passed, says + advice, abs(error), FREQUENCY_LIMIT)


def _height(c: Comparison) -> Check:
    passed = abs(c.ratio_db) <= PEAK_LIMIT_DB
    says = (
        f"the predicted peak is {10 ** (c.ratio_db / 20):.3g} times the measured one "
        f"({c.ratio_db:+z.1f} dB)"
    )
    cause = "damping is underestimated" if c.ratio_db > 0 else "damping is overestimated"
    return Check(
        "peak_agrees", passed, says + ("" if passed else f": {cause}"), c.ratio_db, PEAK_LIMIT_DB
    )


def _damping(c: Comparison, seen: Peak) -> Check:
    if c.measured_damping is None or c.predicted_damping is None:
        which = "measured" if c.measured_damping is None else "predicted"
        says = (
            f"the {which} lines do not support a damping ratio: {seen.half_power_lines:.1f} lines "
            f"lie in the half-power band, and at the end of the record {100 * seen.decay:.0f} % of "
            "the response is left; record longer, or with more lines about the peak"
        )
        return Check("damping_agrees", False, says)
    ratio = c.predicted_damping / c.measured_damping
    passed = 1 / DAMPING_LIMIT <= ratio <= DAMPING_LIMIT
    says = (
        f"predicted damping ratio {100 * c.predicted_damping:.3g} %, measured "
        f"{100 * c.measured_damping:.3g} %: {ratio:.3g} times"
    )
    return Check("damping_agrees", passed, says, ratio, DAMPING_LIMIT)


def _units(c: Comparison) -> Check:
    """Unit slips leave their mark: sqrt(1000) on a frequency, 9.81 or 1000 on a height."""
    frequency = c.measured_hz / c.predicted_hz
    height = float(np.median(np.abs(c.measured.value) / np.abs(c.predicted.value)))
    for ratio, factor, words in (
        (frequency, np.sqrt(1000), "a factor 1000 in mass or stiffness (g for kg, N/mm for N/m)"),
        (height, GRAVITY, "acceleration in g where m/s^2 was meant"),
        (height, 1000.0, "mm for m, or mN for N"),
    ):
        if abs(abs(np.log(ratio)) - np.log(factor)) < np.log(1.1):
            says = f"measured over predicted is {ratio:.3g}, close to {factor:.4g} or its inverse: "
            return Check("no_unit_slip", False, says + f"it looks like {words}", ratio, factor)
    says = "neither frequency nor height is off by the factor of a unit slip"
    return Check("no_unit_slip", True, says, frequency)


def _resolution(seen: Peak, told: Peak) -> Check:
    lines = min(seen.half_power_lines, told.half_power_lines)
    which = "measured" if seen.half_power_lines <= told.half_power_lines else "predicted"
    passed = lines >= 5
    says = f"{lines:.1f} lines lie in the half-power band of the {which} peak"
    if not passed:
        says += (
            ": the lines themselves step over the peak; its height is read off the parabola of "
            "the inverse response, so record longer for a peak you can see"
        )
    return Check("lines_resolve_the_peak", passed, says, lines, 5.0)


def _extrapolation(c: Comparison, fit: Fit) -> Check:
    low, high = fit.band
    factor = max(c.measured_hz / high, low / c.measured_hz)
    passed = factor <= 1
    says = (
        f"the measured peak at {c.measured_hz:.4g} Hz lies inside the band that the fit can "
        f"inform, {low:.2g} to {high:.2g} Hz"
        if passed
        else f"the measured peak at {c.measured_hz:.4g} Hz is outside the band that the fit can "
        f"inform, {low:.2g} to {high:.2g} Hz: the prediction is extrapolated "
        f"x{factor:.3g}"
    )
    return Check("inside_identified_band", passed, says, factor, 1.0)


def _tested(c: Comparison, fit: Fit) -> Check:
    """Whether the loss that the hammer saw is of arms that the relaxation test can see."""
    low, high = fit.band
    tau = 1 / (2 * np.pi * c.measured_hz)
    inside = low <= c.measured_hz <= high
    lead = max(c.arms, key=lambda arm: arm.loss_share, default=None)
    if inside:
        says = (
            f"an arm that matters for damping at {c.measured_hz:.4g} Hz relaxes in about "
            f"{_time(tau)}, which the test behind the fit can see"
        )
        return Check("damping_tested", True, says, tau)
    fastest = min([1 / (2 * np.pi * high), *(arm.tau for arm in c.arms if arm.seen_by_relaxation)])
    says = (
        f"damping at {c.measured_hz:.4g} Hz comes from arms that relax in about {_time(tau)}; the "
        f"relaxation test sees {_time(fastest)} to {_time(1 / (2 * np.pi * low))}"
    )
    if lead is not None:
        distant = lead.tau > 5 * tau
        says += (
            f", and {100 * lead.loss_share:.1f} % of the predicted loss is the "
            f"{'far ' if distant else ''}tail of the arm at tau = {lead.tau:.4g} s"
            + (", which acts as a spring here" if distant else "")
        )
    says += "; a faster ramp or a joint fit with this FRF (identify) tests it"
    return Check("damping_tested", False, says, tau, 1 / (2 * np.pi * high))


def _operating_point(model: GeneralizedMaxwell, mass: float, depth: float | None) -> Check:
    sag = mass * GRAVITY / model.k_inf
    says = f"under its own weight the mass sinks {1e3 * sag:.2f} mm into the seals"
    if depth is None:
        return Check("operating_point", True, says, sag)
    passed = abs(sag - depth) <= 0.25 * depth
    if passed:
        says += f", close to the {1e3 * depth:.3g} mm of the relaxation test"
    else:
        says += (
            f", but the relaxation test was at {1e3 * depth:.3g} mm: unless the seals were "
            "pre-compressed the two tests are at different operating points, and a stiffness that "
            "depends on depth makes them differ"
        )
    return Check("operating_point", passed, says, sag, depth)


def verdict(c: Comparison, fit: Fit | None) -> str:
    """What agrees, what does not, and why, in one sentence."""
    passed = {check.name: check.passed for check in c.checks}
    slip = next(check for check in c.checks if check.name == "no_unit_slip")
    if not slip.passed:
        return f"A unit slip is likely before anything else: {slip.says}."
    stiffness = "agrees" if passed["stiffness_agrees"] else "does not agree"
    first = f"Stiffness {stiffness} (peak frequency {100 * c.frequency_error:+z.1f} %)"
    damped = passed["peak_agrees"] and passed["damping_agrees"]
    size = f"peak {c.ratio_db:+z.1f} dB"
    if c.damping_ratio_error is not None:
        size += f", damping ratio {100 * c.damping_ratio_error:+z.0f} %"
    if fit is None:
        second = f"damping {'agrees' if damped else 'does not agree'} ({size})"
        return f"{first}; {second}."
    tested = next(check for check in c.checks if check.name == "damping_tested")
    if tested.passed:
        return f"{first}; damping {'agrees' if damped else 'does not agree'} ({size})."
    second = "and damping happens to agree, though it" if damped else "but damping"
    return f"{first}, {second} is not tested by the relaxation test ({size}): {tested.says}."


def _time(value: float) -> str:
    return f"{1e3 * value:.3g} ms" if value < 1 else f"{value:.3g} s"
