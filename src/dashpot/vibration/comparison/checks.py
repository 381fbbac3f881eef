"""The questions put to a comparison, and the sentence that matters.

Where both peaks agree, the hammer has tested what the relaxation test could not: the prediction was
extrapolated, or both tests compress the seal differently, and it held all the same.
"""

from __future__ import annotations

import numpy as np

from dashpot.base import numbers
from dashpot.base.checks import Check, Finding, Grade, criterion
from dashpot.base.units import GRAVITY, written
from dashpot.records.fit import Fit
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.vibration.modal.peaks import Peak
from dashpot.vibration.systems.operating_point import OperatingPoint

# limits of the verdict: a frequency within 5 % is stiffness within 10 %
FREQUENCY_LIMIT = 0.05
HEIGHT_LIMIT = 3.0
DAMPING_LIMIT = 1.25
DEPTH_LIMIT = 0.25
# so many limits off, a prediction is of no use
USELESS = 4.0
# measured, n = 21: from here on the parabola reads the peak to 1 %, with a third of it to 17 %
FEWEST_LINES = 1.5

_ASTRAY = ": check mass, number of seals, length and preload"


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
    found = [stiffness, peak, damping, no_unit_slip(c), lines_resolve_the_peak(measured, predicted)]
    stiff, damped = not stiffness.failed, not (peak.failed or damping.failed)
    if fit is not None:
        found.append(inside_identified_band(c, fit, borne_out=stiff and damped))
        found.append(damping_tested(c, fit, borne_out=damped))
    if point is not None and np.isfinite(point.compression):
        found.append(operating_point(point, borne_out=stiff))
    return tuple(found)


def _no_peak(c: Comparison) -> bool:
    """The prediction is highest at an end of the lines: its peak lies elsewhere."""
    return int(np.argmax(np.abs(c.predicted.value))) in {0, len(c.predicted.value) - 1}


def _grade(limits: float) -> Grade | None:
    """What missing the measurement by so many limits means for the prediction."""
    return "stop" if limits > USELESS else None


@criterion(
    "frequency ratio - 1",
    "<=",
    FREQUENCY_LIMIT,
    "our choice: stiffness within 10 %",
    otherwise="stop beyond 0.2",
)
def stiffness_agrees(c: Comparison) -> Finding:
    """The peaks are at one frequency."""
    error = c.frequency_error
    if _no_peak(c):
        f = c.predicted.frequency
        return Finding(
            f"the prediction has no peak from {f[0]:.3g} to {f[-1]:.3g} Hz, where the measured one "
            f"is at {c.measured_hz:.4g} Hz",
            abs(error),
            _ASTRAY,
            grade=_grade(abs(error) / FREQUENCY_LIMIT),
        )
    return Finding(
        f"the predicted peak is at {c.predicted_hz:.3f} Hz, the measured one at "
        f"{c.measured_hz:.3f} Hz ({100 * error:+z.2f} %), so the storage stiffness there is "
        f"{100 * ((1 + error) ** 2 - 1):+z.1f} % off",
        abs(error),
        _ASTRAY,
        grade=_grade(abs(error) / FREQUENCY_LIMIT),
    )


@criterion(
    "predicted / measured height, dB",
    "|x| <=",
    HEIGHT_LIMIT,
    "our choice: a factor 1.4",
    otherwise="stop beyond 12 dB",
)
def peak_agrees(c: Comparison) -> Finding:
    """The peaks are as high as one another."""
    if _no_peak(c):
        return Finding(
            f"no predicted line is higher than {10 ** (c.ratio_db / 20):.3g} times the measured "
            f"peak ({c.ratio_db:+z.1f} dB)",
            c.ratio_db,
            grade=_grade(abs(c.ratio_db) / HEIGHT_LIMIT),
        )
    return Finding(
        f"the predicted peak is {10 ** (c.ratio_db / 20):.3g} times the measured one "
        f"({c.ratio_db:+z.1f} dB)",
        c.ratio_db,
        f": damping is {'under' if c.ratio_db > 0 else 'over'}estimated",
        grade=_grade(abs(c.ratio_db) / HEIGHT_LIMIT),
    )


@criterion(
    "predicted / measured damping ratio",
    "x/",
    DAMPING_LIMIT,
    otherwise="stop beyond a factor 2.4",
)
def damping_agrees(c: Comparison, measured: Peak) -> Finding:
    """The damping ratios are the same."""
    if c.measured_damping is None or c.predicted_damping is None:
        which = "measured" if c.measured_damping is None else "predicted"
        return Finding(
            f"the {which} lines do not support a damping ratio: {measured.half_power_lines:.1f} "
            "lines lie in the half-power band, and at the end of the record "
            f"{100 * measured.decay:.0f} % of the response is left; record longer, or with "
            "more lines about the peak",
        )
    ratio = c.predicted_damping / c.measured_damping
    return Finding(
        f"predicted damping ratio {100 * c.predicted_damping:.3g} %, measured "
        f"{100 * c.measured_damping:.3g} %: {ratio:.3g} times",
        ratio,
        grade=_grade(abs(float(np.log(ratio))) / np.log(DAMPING_LIMIT)),
    )


@criterion(
    "measured / predicted",
    grade="stop",
    source="not near sqrt(1000) in frequency, 9.81 or 1000 in height",
)
def no_unit_slip(c: Comparison) -> Finding:
    """No unit slip left its mark: sqrt(1000) on a frequency, 9.81 or 1000 on a height."""
    frequency = c.measured_hz / c.predicted_hz
    height = float(np.median(np.abs(c.measured.value) / np.abs(c.predicted.value)))
    for ratio, factor, words in (
        (frequency, np.sqrt(1000), "a factor 1000 in mass or stiffness (g for kg, N/mm for N/m)"),
        (height, GRAVITY, "acceleration in g where m/s^2 was meant"),
        (height, 1000.0, "mm for m, or mN for N"),
    ):
        if abs(abs(np.log(ratio)) - np.log(factor)) < np.log(1.1):
            says = f"measured over predicted is {ratio:.3g}, close to {factor:.4g} or its inverse: "
            return Finding(says + f"it looks like {words}", ratio, limit=factor, faulted=True)
    return Finding("neither frequency nor height is off by the factor of a unit slip", frequency)


@criterion(
    "lines in the half-power band",
    ">=",
    FEWEST_LINES,
    "measured: the height is read to 1 %, with a third of the lines to 17 %",
)
def lines_resolve_the_peak(measured: Peak, predicted: Peak) -> Finding:
    """The lines resolve both peaks."""
    lines = min(measured.half_power_lines, predicted.half_power_lines)
    which = "measured" if measured.half_power_lines <= predicted.half_power_lines else "predicted"
    return Finding(
        f"{lines:.1f} lines lie in the half-power band of the {which} peak",
        lines,
        ": the lines step over the peak, and the parabola of the inverse response cannot tell "
        "its height; record longer",
    )


@criterion("distance from the band, a factor", "<=", 1.0, "the band of the fit")
def inside_identified_band(c: Comparison, fit: Fit, *, borne_out: bool = False) -> Finding:
    """The measured peak lies where the fit informs the solid, or bears out the prediction."""
    low, high = fit.band
    if not high > 0:
        return Finding("the fit does not say what it informs, so this is not judged")
    factor = max(c.measured_hz / high, low / c.measured_hz)
    peak, band = f"the measured peak at {c.measured_hz:.4g} Hz", f"{low:.2g} to {high:.2g} Hz"
    says = f"{peak} lies inside the band that the fit can inform, {band}"
    if factor > 1:
        says = (
            f"{peak} is outside the band that the fit can inform, {band}: the prediction is "
            f"extrapolated x{factor:.3g}"
        )
    return Finding(
        says + ("; the measurement bears it out" if factor > 1 and borne_out else ""),
        factor,
        excused=borne_out,
    )


@criterion("1 / (2 pi peak), s", source="what the relaxation test informs")
def damping_tested(c: Comparison, fit: Fit, *, borne_out: bool = False) -> Finding:
    """The relaxation test can see the arms behind the loss, or the hammer bears them out."""
    low, high = fit.band
    if not high > 0:
        return Finding("the fit does not say what it informs, so this is not judged")
    tau = 1 / (2 * np.pi * c.measured_hz)
    if low <= c.measured_hz <= high:
        return Finding(
            f"an arm that matters for damping at {c.measured_hz:.4g} Hz relaxes in about "
            f"{_time(tau)}, which the test behind the fit can see",
            tau,
        )
    fastest = min([1 / (2 * np.pi * high), *(arm.tau for arm in c.arms if arm.seen_by_relaxation)])
    says = (
        f"damping at {c.measured_hz:.4g} Hz comes from arms that relax in about {_time(tau)}; the "
        f"relaxation test sees {_time(fastest)} to {_time(1 / (2 * np.pi * low))}"
    )
    lead = max(c.arms, key=lambda arm: arm.loss_share, default=None)
    if lead is not None:
        distant = lead.tau > 5 * tau
        says += (
            f", and {100 * lead.loss_share:.1f} % of the predicted loss is the "
            f"{'far ' if distant else ''}tail of the arm at tau = {lead.tau:.4g} s"
            + (", which acts as a spring here" if distant else "")
        )
    return Finding(
        says + ("; the hammer bears it out" if borne_out else ""),
        tau,
        "; a faster ramp or a joint fit with this FRF (dashpot identify) tests it",
        limit=1 / (2 * np.pi * high),
        faulted=not borne_out,
    )


@criterion("compression under the mass, m", source="our choice: within 25 % of the tested depth")
def operating_point(point: OperatingPoint, *, borne_out: bool = False) -> Finding:
    """The prediction is for the compression that the mass gives the seals."""
    at, depth = point.compression, point.depth
    says = (
        f"the seals are compressed by {written(at, 'mm', '.2f')}, as given"
        if point.given
        else f"under its own weight the mass sinks {written(at, 'mm', '.2f')} into the seals"
    )
    if depth is None:
        return Finding(says + "; at what depth the seals were tested is not known")
    if not point.linear:
        return Finding(
            f"{says}; the prediction takes the tangent stiffness there, "
            f"{numbers.with_error(point.factor, point.factor_se or np.nan)} times the secant at "
            f"{written(depth, 'mm', '.3g')}",
            at,
            f": the relaxation test went to {written(depth, 'mm', '.3g')} only, and the last "
            "tangent was taken on from there; test deeper",
            limit=depth,
            faulted=point.beyond,
        )
    near = abs(at - depth) <= DEPTH_LIMIT * depth
    tested = f"the {written(depth, 'mm', '.3g')} of the relaxation test"
    return Finding(
        f"{says}, close to {tested}"
        if near
        else f"{says}, not to {tested}; the frequency agrees all the same",
        at,
        instead=f"{says}, but the relaxation test was at {written(depth, 'mm', '.3g')}: unless the "
        "seals were pre-compressed the two tests are at different operating points, and a "
        "stiffness that depends on depth makes them differ",
        limit=depth,
        faulted=not (near or borne_out),
        # a ramp that a straight law follows went through every lesser compression
        grade="limit" if point.beyond else "note",
    )


def conclusion(c: Comparison) -> str:
    """What agrees, what does not, and why, in one sentence."""
    found = {check.name: check for check in c.checks}
    slip, tested = found["no_unit_slip"], found.get("damping_tested")
    if slip.failed:
        return f"A unit slip is likely before anything else: {slip.says}."
    agrees = {True: "agrees", False: "does not agree"}
    stiffness = agrees[not found["stiffness_agrees"].failed]
    first = f"Stiffness {stiffness} (peak frequency {100 * c.frequency_error:+z.1f} %)"
    damped = not (found["peak_agrees"].failed or found["damping_agrees"].failed)
    size = f"peak {c.ratio_db:+z.1f} dB"
    if c.damping_ratio_error is not None:
        size += f", damping ratio {100 * c.damping_ratio_error:+z.0f} %"
    if tested is None or not tested.failed:
        return f"{first}; damping {agrees[damped]} ({size})."
    return f"{first}, but damping is not tested by the relaxation test ({size}): {tested.says}."


def _time(value: float) -> str:
    return written(value, "ms", ".3g") if value < 1 else f"{value:.3g} s"
