"""Criteria on the ramp of a fit, its load cell and its clocks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.fitting.nonlinear_ramp.linearity import LinearFitQuality
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

# a hold that leaves so many times more beside others than alone is not of the same seal
_CONTRADICTED = 2.0
_MATTERS = 0.005
# an equilibrium stiffness this far from the end force is not one
_BEYOND_BELIEF = 0.25
# a delay so many times what was thought possible is another fault: 25 ms, unless said. Limits of
# one test hold behind delays and filters of 2 to 20 ms that nobody named; several together have
# none, and are doubted from 8.5 ms on
TOO_LATE, TOO_LATE_TOGETHER = 5.0, 1.7
# rows of the ramp that count with so many times the noise of the hold follow another law
_ANOTHER = 1.5
# a fit beyond the limits by this part of their width is no solid that the record allows
BEYOND = 0.25


@criterion(
    "ramp residual / peak",
    "<=",
    0.01,
    f"our choice; or 1.5 times the noise, and that {_ANOTHER} times the hold's if no law bends",
)
def ramp_residual_small(missed: float, noise: float, discrepancy: float, kind: str) -> Finding:
    """The model fits the ramp.

    `missed` and `noise` are parts of the largest force, `discrepancy` what one independent
    residual of the ramp is worth over one of the hold, `kind` that of the elastic law.
    """
    return Finding(
        f"The model misses the ramp by {100 * missed:.2g} % of the peak, with a {kind} elastic "
        f"law. Its rows count with {discrepancy:.3g} times the noise of the hold",
        missed,
        "No elastic law follows the ramp. So k_inf and slow arms come from the hold; fast arms and "
        "tangent are uncertain",
        "Record the motion at the seal, without slip.",
        always_passes=missed <= 1.5 * noise,
        # no linear solid explained ramp and hold, and no law was found that does
        always_fails=kind == "linear" and discrepancy > _ANOTHER,
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
        return Finding("The record is not one ramp and one hold, so it is not judged")
    return Finding(
        f"A linear model leaves {quality.ramp:.3g} times the noise on the ramp",
        quality.ramp,
        "No nonlinear law explains it better: two faults may hide each other, such as a seal that "
        "stiffens a little and one that warms. Fast arms, and their loss, are uncertain",
        "Press at a second speed, or strike the seal with a hammer.",
        always_passes=quality.sound,
    )


@criterion("hold residual / hold alone", "<=", 1.25, "our choice; or 0.5 % of the peak")
def hold_residual_small(rho: Sequence[float], missed: Sequence[float]) -> Finding:
    """The model fits each hold as well as a fit of that hold alone does.

    `missed` is the residual in each hold as a part of the largest force: below 0.5 % it matters
    to no use.
    """
    worst = int(np.argmax(np.where(np.array(missed) > _MATTERS, rho, 0.0) + 1e-9 * np.array(rho)))
    of = f" of test {worst + 1}" if len(rho) > 1 else ""
    return Finding(
        f"The residual of the hold{of} is {rho[worst]:.3g} times that of its own fit",
        float(rho[worst]),
        "The tests contradict each other: another specimen, temperature, or shape of relaxation"
        if len(rho) > 1
        else "The ramp changes what the hold gives",
        "Fit each test alone." if len(rho) > 1 else Remedy("Fit the hold alone.", "method", "hold"),
        always_passes=missed[worst] <= _MATTERS,
        grade="stop" if rho[worst] > _CONTRADICTED else "limit",
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

    One ramp tells the tangent within 5 % if all arms share one elastic law. A law of its own for
    each arm, friction or a motion commanded and not measured puts it 11 to 46 % off though the
    ramp is followed to the noise.
    """
    if law.kind == "linear":
        return Finding("The elastic law is linear: its tangent is its secant")
    many = f"{ramps} ramps of different rate or depth" if ramps > 1 else "one ramp"
    return Finding(
        f"The tangent stiffness comes from {many}; two are needed",
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
    off = abs(model.k_inf - (end - float(total)))
    share = off / max(abs(end), 1e-300)
    # a plateau that does not differ significantly from zero claims nothing
    wrong = share > _BEYOND_BELIEF and model.k_inf > 3.0 * se
    return Finding(
        f"k_inf and the rest of the arms miss the stiffness at the end of the hold by "
        f"{100 * share:.2g} %. They are {format_quantity(model.k_inf, 'N/mm')} and "
        f"{convert_to_unit(total, 'N/mm'):.2g}, and {format_quantity(end, 'N/mm')} was measured",
        share,
        "Offset or drift of the load cell took what is stiffness, or the other way round",
        Remedy("Record a baseline before contact, or give the drift.", "machine", "drift=..."),
        always_passes=off <= 3.0 * se,
        grade="stop" if wrong else "limit",
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
    return _believable(results, "offset", 1e3, "mN", "the force at rest")


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

    `results` as for the offset, N/s. Limits know of the drift what is known: while they hold the
    fit, but for a part `excess` of their width, a drift that went far does no harm.
    """
    answer = _believable(results, "drift", 1e3, "mN/s", "what is known of the cell")
    return answer if excess > BEYOND else answer._replace(grade=None)


@criterion(
    "slope of the baseline / 3 SD",
    "<=",
    1.0,
    "Box 1980: beyond it the two contradict each other",
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
        "The seal still moved before its ramp, or the cell drifts otherwise. Neither is taken off",
        "Let seal and amplifier rest, or state the drift (--machine drift=...).",
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
    late = [abs(value) / error if error > 0 else 0.0 for value, error, _ in results]
    worst = int(np.argmax(late))
    value, error, prior = results[worst]
    of, far = (f" of test {worst + 1}", TOO_LATE_TOGETHER) if len(results) > 1 else ("", TOO_LATE)
    return Finding(
        f"The force{of} lags the displacement by {convert_to_unit(value, 'ms'):.3g} ± "
        f"{format_quantity(error, 'ms', '.2g')}",
        late[worst],
        "The fit corrects for this, but a late force looks like less damping",
        Remedy(
            "Read both channels at one time, or give the delay of the force.", "machine", "sync=..."
        ),
        grade="limit" if abs(value) > far * prior else None,
    )


def _believable(
    results: Sequence[tuple[float, float, float, float]],
    what: str,
    scale: float,
    unit: str,
    name: str,
) -> Finding:
    if not results:
        return Finding(f"No {what} is fitted")
    away = [abs(value - mean) / sd if sd > 0 else 0.0 for value, mean, sd, _ in results]
    worst = int(np.argmax(away))
    value, mean, *_ = results[worst]
    matters = any(
        abs(value - mean) > max(3 * sd, departure) for value, mean, sd, departure in results
    )
    of = f" of test {worst + 1}" if len(results) > 1 else ""
    return Finding(
        f"The fitted {what}{of} ({scale * value:.3g} {unit}) differs from {name} "
        f"({scale * mean:.3g} {unit}) by {away[worst]:.2g} standard deviations",
        away[worst],
        "It hides a misfit",
        "Record a longer baseline, or let the load cell warm up.",
        grade="limit" if matters else None,
    )
