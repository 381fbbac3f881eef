"""Criteria on amplitude sweeps and on FRFs at several amplitudes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.units import convert_to_unit, get_display_unit
from dashpot.vibration.impact.amplitude_trend import Trend
from dashpot.vibration.impact.checks import MIN_HITS, MIN_SOFTENING

SIGNIFICANT_DEVIANCE = 20.0
FAR_ENOUGH = 2.0
MAX_HIDDEN_CUBIC = 0.1
MAX_RESIDUAL_SHARE = 0.1
"""Relative residual of F/X above which the fit explains nothing."""


@criterion(
    "2 ln likelihood ratio",
    ">",
    SIGNIFICANT_DEVIANCE,
    "simulation: linear seals at most 12 in 40; seals with friction at least 199",
    grade="note",
)
def amplitude_dependence_detected(
    gain: float,
    amplitudes: tuple[float, float],
    subject: str,
    law_name: str,
    *,
    is_explained: bool = True,
) -> Finding:
    """Stiffness or loss changes with amplitude, as with friction or a cubic spring."""
    low, high = amplitudes
    linear = (
        f"The part is linear from {low:.3g} to {high:.3g} {subject}: no change with amplitude is "
        "seen "
        f"(2 ln L = {gain:.3g}). Larger amplitudes are not known"
    )
    return Finding(
        f"{law_name} explains what arms alone do not (2 ln L = {gain:.3g})",
        gain,
        failure=linear
        if is_explained
        else "Neither friction nor a cubic spring nor arms alone explain the tests "
        f"(2 ln L = {gain:.3g})",
        remedy="Test at larger amplitudes, if the part moves farther in use.",
    )


@criterion("range of amplitudes", ">=", 3.0, "sweeps at one amplitude: others 7 % wrong")
def amplitudes_spread(ratio: float, subject: str) -> Finding:
    """The tested amplitudes span a range wide enough to show their effect."""
    return Finding(
        f"The amplitudes ({subject}) span a factor of {ratio:.3g}; at least 3 is needed",
        ratio,
        "Each friction slider looks like a spring and a loss",
        "Test at a second amplitude.",
    )


@criterion(
    "largest amplitude / X_c", ">=", FAR_ENOUGH, "below it, exponent and share are correlated"
)
def softening_seen(amplitude_ratio: float) -> Finding:
    """The sweep goes beyond the amplitude X_c, where half of the softening is reached."""
    return Finding(
        f"The largest amplitude is {amplitude_ratio:.3g} times that at which half is lost",
        amplitude_ratio,
        "The exponent was set to 0.5, and the share that is lost is extrapolated",
        "Sweep to larger amplitudes.",
    )


@criterion(
    "2 ln L of a term of X^4", "<=", SIGNIFICANT_DEVIANCE, "as for any dependence on amplitude"
)
def spring_cubic(gain: float) -> Finding:
    """The spring stiffens with the square of the amplitude."""
    return Finding(
        "The spring stiffens as a cubic one",
        gain,
        failure=f"The spring is not cubic alone (2 ln L = {gain:.3g}), or its friction is not "
        "Kraus's",
        reason="The constant k3 is valid in this range of amplitudes",
        remedy="Use k3 in this range only.",
    )


@criterion(
    "0.75 k3 X^2 / K', 95 %", "<=", MAX_HIDDEN_CUBIC,
    "simulation: half of it fails 7 of 16 faultless sweeps; without it 2 springs are missed",
)  # fmt: skip
def no_hidden_cubic_spring(part: float) -> Finding:
    """The data exclude a cubic spring that is large enough to matter."""
    return Finding(
        "The data cannot exclude a cubic spring of up to "
        f"{100 * part:.2g} % of the stiffness at the largest amplitude",
        part,
        "Other friction with a parallel spring would give the same data",
        "Sweep to larger amplitudes, or with less scatter.",
    )


@criterion(
    "time at an end beyond that of a sine / cycle", "<=", 0.1,
    "a sine that is cut so far loses 0.7 % of its size", grade="stop",
)  # fmt: skip
def loops_not_clipped(part: float, force_name: str) -> Finding:
    """The force or stress of recorded loops is not clipped at its ends."""
    message = f"The {force_name} stays at its end {100 * part:.2g} % of a cycle longer than a sine"
    return Finding(
        message,
        part,
        "It is clipped, so stiffness and loss of large loops are wrong",
        "Use a larger range of the sensor, or smaller amplitudes.",
    )


@criterion("residual / modulus", "<=", 0.03, "real sweeps of filled rubbers leave 0.3 to 3 %")
def law_residual_small(residual: float) -> Finding:
    """The model fits the sweep."""
    return Finding(
        f"The law misses the modulus by {100 * residual:.2g} %",
        residual,
        "This rubber softens in another way",
        "Use its numbers only where they were measured.",
    )


@criterion("change of modulus, downward sweep", "<=", 0.03, "the residual that a model may leave")
def up_and_down_sweeps_agree(change: float) -> Finding:
    """The downward sweep of the amplitude gives the same modulus as the upward sweep."""
    comparative = "softer" if change < 0 else "stiffer"
    return Finding(
        f"At the same amplitude the way down is {100 * abs(change):.2g} % {comparative} than the "
        "way up",
        abs(change),
        "The rubber softened (Mullins) or warmed, and the law is a mean of both",
        "Write the way that counts to a file of its own.",
    )


@criterion(
    "residual loss / loss, worst third of ln X",
    "<=",
    0.12,
    "simulation: 58 of 61 faultless sweeps pass",
)
def loss_residual_small(remainder: float) -> Finding:
    """The model fits the loss at small, medium and large amplitudes separately."""
    return Finding(
        f"In one third of the amplitudes the law misses the loss by {100 * remainder:.2g} %",
        remainder,
        "A damping from the law is as much off",
        "Use the loss where it was measured.",
    )


@criterion("stated / measured amplitude", "x/", 2.0, "hits of one intended force differ by less")
def levels_as_stated(
    stated_amplitudes: Sequence[float], hammer_amplitudes: Sequence[float]
) -> Finding:
    """The stated amplitudes agree with the force of the recorded hits."""
    log_ratios = np.log(np.divide(stated_amplitudes, hammer_amplitudes))
    forces, names = (
        ", ".join(f"{value:.3g}" for value in values)
        for values in (hammer_amplitudes, stated_amplitudes)
    )
    tolerance = np.log(2)
    if (
        np.abs(np.log(np.divide(np.sort(stated_amplitudes), np.sort(hammer_amplitudes)))).max()
        <= tolerance
    ):
        explanation = "The amplitudes belong to each other's files."
    elif (
        np.abs(np.abs(log_ratios) - np.log(1e3)).max() <= tolerance
        and abs(log_ratios.sum()) > np.abs(log_ratios).max()
    ):
        explanation = "A factor of 1000 looks like mN or kN."
    else:
        explanation = "Unit or sensitivity of the force may be wrong."
    message = f"The median hit of each file has {forces} N"
    return Finding(
        f"{message}; {names} N was given",
        float(np.exp(log_ratios[np.abs(log_ratios).argmax()])),
        reason=f"{explanation} The hits themselves count here",
        remedy=Remedy("Give the peak force of each file, in their order.", "amplitude"),
    )


@criterion("FRFs of hits", "<=", 0.0, "the lines of hits have no single amplitude")
def levels_controlled(hammer_files: Sequence[str]) -> Finding:
    """Every FRF was measured at a constant amplitude, not with a hammer."""
    return Finding(
        "No FRF is of hits",
        len(hammer_files),
        failure=f"{', '.join(hammer_files)}: an FRF of hits has no single amplitude, as motion "
        f"dies away ({len(hammer_files)} such)",
        remedy="Give the hammer's records, or FRFs of a shaker.",
    )


@criterion(
    "residual / noise",
    "<=",
    1.4,
    "1 degree of phase: 1.5; faultless records: 0.9 to 1.1",
    other_grade="stop where a tenth of F/X is left",
)
def levels_residual_small(residual: float, noise: float | None) -> Finding:
    """One model with friction fits the FRFs of every amplitude."""
    message = f"The model misses F/X by {100 * residual:.2g} %"
    if noise is None:
        return Finding(f"{message}. The lines are too few to show how much of it is noise")
    return Finding(
        f"{message}; the noise is {100 * noise:.2g} %",
        residual / noise,
        "No arms, sliders and cubic spring explain every amplitude",
        Remedy("Check the mass, the order of the amplitudes, and the phase.", "amplitude"),
        grade="stop" if residual > MAX_RESIDUAL_SHARE else "limit",
    )


@criterion("distance from the range, a factor", "<=", 1.0, "the amplitudes of the tests")
def amplitude_in_tested_range(
    amplitude: float, tested_range: tuple[float, float], *, location: str, subject: str = "m"
) -> Finding:
    """At the requested amplitude the seal moves within the tested range."""
    unit, (low, high) = get_display_unit(subject), tested_range
    amplitude_text, low_text, high_text = (
        f"{convert_to_unit(value, unit):.3g}" for value in (amplitude, low, high)
    )
    factor = max(amplitude / high, low / amplitude)
    motion = "moves" if subject == "m" else "is moved by"
    message = f"At {location} the seal {motion} {amplitude_text} {unit}"
    range_ = f"{low_text} to {high_text} {unit} of the tests"
    return Finding(
        f"{message}, within the {range_}",
        factor,
        failure=f"{message}, {factor:.3g} times outside the {range_}",
        reason="Friction there was not measured",
        remedy="Test at that amplitude.",
    )


@criterion(
    "change of stiffness per doubling that 4 of 5 such tests find",
    "<=",
    MIN_SOFTENING,
    "a change that matters",
)
def softening_detectable(trend: Trend | None) -> Finding:
    """The hits differ enough in force to detect a change of stiffness that matters."""
    if trend is None:
        return Finding(
            f"A change with amplitude needs more than {MIN_HITS} hits of different height"
        )
    return Finding(
        f"A change of {100 * trend.detectable_stiffness_change:.2g} % of stiffness or "
        f"{100 * trend.detectable_damping_change:.2g} % of damping per doubling is found in four "
        "of five tests",
        trend.detectable_stiffness_change,
        "A smaller change is not detected",
        "Hit from soft to hard.",
    )
