"""Criteria on creep tests and their fits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.number_format import round_to_error
from dashpot.extensions.curves.checks import MAX_MISFIT
from dashpot.fitting.checks.relaxation import find_largest_rms
from dashpot.fitting.checks.solid import format_arm_count
from dashpot.preprocessing.checks import MAX_FROZEN_SHARE, MAX_PRELOAD
from dashpot.preprocessing.contact import MIN_BASELINE
from dashpot.signals.stuck_channel import find_stuck_runs

if TYPE_CHECKING:
    from dashpot.extensions.curves.datamodel.creep import LoadHold
    from dashpot.solids.interconversion import CreepSpectrum


# Largest motion before the load, relative to the travel; the relative error of k_inf is about
# half of it.
MAX_STIR = 0.01
# largest relative change of a held load
MAX_LOAD_CHANGE = 0.02
# largest share of the final displacement after the end of the hold
MAX_TO_COME = 0.05
# a difference of BIC below which two solids are as good
MIN_BIC_DIFFERENCE = 10.0
# ratios of residual and noise above which the fit does not follow the displacement
MAX_MISFIT_RATIO, GROSS_MISFIT_RATIO = 2.0, 10.0
# share of the displacement at the end of the hold below which flow may be slow retardation
MIN_FLOW_SHARE = 0.5
# ratio to the usual drift of a channel
MAX_DRIFT_RATIO = 2.0
# of the travel: a misfit below it does not matter
NEGLIGIBLE_MISFIT = 1e-3
# a departure from proportion at the highest level that matters, and how surely
MAX_NONLINEARITY, SIGNIFICANT_SE = 0.03, 3.0


@criterion("samples", ">=", MIN_BASELINE, "our choice: the fewest that give a scatter")
def load_begins_at_rest(test: LoadHold) -> Finding:
    """The record shows the part at rest before the load: the zero of the displacement."""
    samples_before = int(np.searchsorted(test.time, test.onset))
    count = f"{samples_before} sample{'s' * (samples_before != 1)}"
    zero = f"{samples_before} samples before the load give the zero of the displacement"
    third_length = samples_before // 3
    # under a load that is on record the part may move
    unloaded_samples = (
        samples_before and float(np.ptp(test.load[:samples_before])) < MAX_PRELOAD * test.level
    )
    if samples_before >= MIN_BASELINE and unloaded_samples:
        first, last = (
            test.displacement[:third_length],
            test.displacement[samples_before - third_length : samples_before],
        )
        travel = float(np.ptp(test.displacement))
        ratio = abs(median(last) - median(first)) / travel
        chance = 4 * test.displacement_noise * np.sqrt(2 / third_length)
        return Finding(
            f"{zero}, and move by {100 * ratio:.2g} % of the travel",
            float(samples_before),
            "The part still moves under an earlier load",
            "Let it rest, or record that load too.",
            always_fails=ratio > max(MAX_STIR, chance / travel),
        )
    return Finding(
        zero,
        float(samples_before),
        failure=f"The record has {count} before the load; at least {MIN_BASELINE:.0f} are needed. "
        "The file's own zero is taken for that of the unloaded part",
        remedy="Start the record a second before the load.",
    )


@criterion(
    "part of the hold", "<=", MAX_FROZEN_SHARE, "our choice: a shorter stretch changes no stiffness"
)
def displacement_samples_not_repeated(test: LoadHold, displacement: FloatArray) -> Finding:
    """The displacement is a new reading in each row while the load is held.

    A held load is expected to be constant. `displacement` is of the same samples as it stands in
    the file.
    """
    x, time = displacement[test.hold], test.time[test.hold]
    sign = 1.0 if (x - x.mean()) @ test.displacement[test.hold] >= 0 else -1.0
    # what creeps rises; it is turned, for what relaxes falls
    runs = find_stuck_runs(-sign * x, time_since_ramp=time - test.ramp_end)
    if not len(runs):
        return Finding("The displacement stands at no value while it should scatter or change", 0.0)
    first, last = runs[np.argmax(np.diff(runs)[:, 0])]
    ratio = float(np.sum(np.diff(runs) + 1)) / len(x)
    return Finding(
        f"The displacement has one and the same value for {last - first + 1} samples, from "
        f"{time[first]:.4g} to {time[last]:.4g} s",
        ratio,
        f"Its other samples rule that out: it was not read for {100 * ratio:.2g} % of the hold",
        "Repeat the test.",
    )


@criterion("change in the hold / load", "<=", MAX_LOAD_CHANGE, grade="note")
def load_held(test: LoadHold) -> Finding:
    """The load is constant during the hold, or the fit follows it."""
    held_load = test.load[test.hold]
    settled_load = held_load[len(held_load) // 10 :]
    change = float(np.ptp(settled_load)) / test.level
    return Finding(
        f"The load changes by {100 * change:.2g} % while it is held",
        change,
        "The fit uses the recorded force, so the result is valid. A curve of displacement over "
        "load is not",
        "Hold the load more evenly.",
    )


@criterion("last third / first third", ">=", 0.8, "our choice: scatter", grade="stop")
def compliance_rises(compliance: FloatArray) -> Finding:
    """The creep compliance rises with time."""
    third_length = max(len(compliance) // 3, 1)
    first, last = float(compliance[:third_length].mean()), float(compliance[-third_length:].mean())
    return Finding(
        "The compliance rises with time",
        last / first if first > 0 else None,
        failure=f"The compliance falls with time, from {first:.3g} in its first third to "
        f"{last:.3g} in its last",
        remedy="Check whether it is a modulus, or has a recovery.",
    )


@criterion("creep still to come / final compliance", "<=", MAX_TO_COME, grade="limit")
def creep_finished(creep: CreepSpectrum, hold: float) -> Finding:
    """The displacement has come to rest, or the part flows.

    `hold` is in s.
    """
    if creep.flow > 0:
        return Finding(
            "The part flows, so the displacement never comes to rest and k_inf = 0",
            always_passes=True,
        )
    remainder = 1 - float(creep.compliance(hold)) / creep.equilibrium
    return Finding(
        f"When the hold ended, after {round_to_error(hold)} s, {100 * remainder:.2g} % of the "
        "displacement at "
        "rest was still to come",
        remainder,
        "So k_inf is extrapolated, with no lower limit",
        "Hold longer.",
    )


@criterion("difference of BIC", ">=", MIN_BIC_DIFFERENCE, "our choice: 1 to 150 in likelihood")
def flow_distinguished(has_flow: bool, difference: float, se_of_flow: float | None) -> Finding:
    """The data distinguish a part that comes to rest from one that flows."""
    description, alternative = (
        ("flows", "comes to rest") if has_flow else ("comes to rest", "flows")
    )
    error_text = (
        "" if se_of_flow is None else f" (its fluidity is known to {100 * se_of_flow:.2g} %)"
    )
    if np.isinf(difference):
        return Finding(
            f"A part that {alternative} explains no more than one that {description}",
            always_passes=True,
        )
    return Finding(
        f"A part that {description} explains the record better than one that {alternative}, by "
        f"{difference:.3g} in BIC{error_text}",
        difference,
        failure=f"The record hardly separates a part that comes to rest from one that flows "
        f"(BIC {difference:.3g}). One that {description} was taken; k_inf may be 0",
        remedy="Hold longer, or record a recovery.",
    )


@criterion(
    "flow / displacement at the end",
    ">=",
    MIN_FLOW_SHARE,
    "our choice: a slow retardation shows less",
)
def flow_exceeds_slow_retardation(creep: CreepSpectrum, hold: float) -> Finding:
    """The fitted flow moved the part by more than slow retardation would have.

    `hold` is in s.
    """
    ratio = creep.flow * hold / float(creep.compliance(hold))
    return Finding(
        f"{100 * ratio:.2g} % of the displacement at the end is flow",
        ratio,
        "A part that comes to rest after the record ends looks the same, so k_inf may be above 0",
        "Hold longer, or record a recovery.",
    )


@criterion(
    "drift / usual drift of a channel", "<=", MAX_DRIFT_RATIO, "our choice; two standard deviations"
)
def drift_distinguished_from_flow(
    drift: float, usual_drift: float, *, is_reported: bool
) -> Finding:
    """The fitted drift of the displacement is too small to be flow of the part.

    Both in m/s; `is_reported` if the samples before the load show the drift.
    """
    return Finding(
        f"The displacement drifts {drift / usual_drift:.2g} times as far as load cell and encoder "
        "usually do",
        abs(drift) / usual_drift,
        "A part that flows slowly, or is not at rest yet, looks the same; k_inf is then too high",
        "Record longer before the load.",
        always_passes=is_reported,
    )


@criterion(
    "smooth misfit / noise",
    "<=",
    MAX_MISFIT_RATIO,
    "our choice",
    other_grade=f"stop beyond {GROSS_MISFIT_RATIO:g}",
)
def displacement_residual_small(test: LoadHold, residual: FloatArray) -> Finding:
    """The model fits the displacement to within its noise.

    `residual` is of the last samples of the record.
    """
    misfit, location_text = _find_worst_part(test, residual)
    travel = float(np.ptp(test.displacement))
    noise = max(test.displacement_noise, NEGLIGIBLE_MISFIT * travel)
    ratio = misfit / noise if noise > 0 else 1.0
    return Finding(
        f"The model misses the displacement by {100 * misfit / travel:.2g} % of the travel rms "
        f"{location_text}; {100 * noise / travel:.2g} % would be noise",
        ratio,
        "Stiffening, slip, lost contact or another temperature may cause this. The arms mean "
        "nothing then",
        "Check the fixture, and repeat the test.",
        grade="stop" if ratio > GROSS_MISFIT_RATIO else None,
    )


@criterion("rms error of the fit", "<=", MAX_MISFIT)
def compliance_residual_small(relative_misfit: float, arms: int) -> Finding:
    """The model fits the creep compliance."""
    return Finding(
        f"{format_arm_count(arms)} leave{'s' * (arms < 2)} {100 * relative_misfit:.2g} % rms of "
        "the compliance",
        relative_misfit,
        "They do not follow the curve",
        Remedy("Cut off where the instrument's inertia oscillates, or use more arms.", "arms"),
    )


@criterion(
    "deviation at the highest load",
    "<=",
    MAX_NONLINEARITY,
    "our choice; or less than 3 standard errors",
)
def levels_agree(compliance_difference: float | None, error: float | None) -> Finding:
    """The displacement is proportional to the load: the part is linear."""
    if compliance_difference is None or error is None:
        return Finding("The record has one load, so proportion is not checked")
    return Finding(
        f"At the highest load the displacement departs from proportion by "
        f"{100 * compliance_difference:+.2g} % ± {100 * error:.2g} %",
        abs(compliance_difference),
        "One linear model is not valid for all loads",
        "Fit the loads one by one.",
        always_passes=abs(compliance_difference) <= SIGNIFICANT_SE * error,
    )


def _find_worst_part(test: LoadHold, residual: FloatArray) -> tuple[float, str]:
    """The largest rms of load ramp, what follows it, hold and recovery; and where, in words."""
    time = test.time[-len(residual) :]
    settled_time = test.ramp_end + test.ramp_time
    parts = (
        ("while the load rises", (time > test.onset) & (time <= test.ramp_end)),
        ("right after it", (time > test.ramp_end) & (time <= settled_time)),
        ("in the hold", (time > settled_time) & (time <= test.hold_end)),
        ("after the hold", time > test.hold_end),
    )
    return find_largest_rms(residual, parts)
