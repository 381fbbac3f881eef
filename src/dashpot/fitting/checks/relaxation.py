"""Criteria on a fit of relaxation tests and on their records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, median, slow_periodogram
from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.errors import Status
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.datamodel.bounds import EndOfHold
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.shift_factors import SAME_TEMPERATURE
from dashpot.fitting.checks.solid import ROUNDING, format_arm_count
from dashpot.fitting.input_tests import DEPTH_TOLERANCE, EndStiffness
from dashpot.preprocessing.signal_conditioning import Filter
from dashpot.solids.maxwell import GeneralizedMaxwell

# per factor e of time
MAX_END_SLOPE = 0.03
MAX_DRIFT_CORRELATION = 0.9
MAX_METHOD_DIFFERENCE = 0.10
MAX_DEVIATION = 3.0
# repeats on one seal differ by as much
SAME_STIFFNESS = 0.02
# a force followed to so many times its noise is; beyond the second the solid is another
MAX_NOISE_RATIO = 1.75
GROSS_NOISE_RATIO = 10.0
# a k known to this part of it is known, however fast its arm
MAX_K_ERROR = 0.01
# a plate that has moved by less of the depth is at rest
REST_TOLERANCE = 1e-3
# a wander of this part of the peak is noise that the limits count
SLIGHT_WANDER = 0.005
# a misfit below this part of the peak force matters to no use of the solid
NEGLIGIBLE_MISFIT = 1e-3
# shapes that differ by less are the same for every use of them
NEGLIGIBLE_DIFFERENCE = 1e-3
# an interval of k_inf wider than this part of the stiffness left says little of it
MAX_K_INF_WIDTH = 0.5


# -- several tests --------------------------------------------------------------------------------


@criterion(
    "difference / its error", "<=", MAX_DEVIATION, "3 standard errors, and 2 % of it", grade="stop"
)
def same_specimen(stiffnesses: Sequence[EndStiffness]) -> Finding:
    """Tests at one compression and temperature have the same stiffness."""
    pairs = [
        (abs(a.value - b.value) / max(float(np.hypot(a.sd, b.sd)), 1e-300), i, j)
        for (i, a), (j, b) in combinations(enumerate(stiffnesses), 2)
        if _is_same_condition(a, b)
    ]
    if not pairs:
        return Finding("No two tests have one depth and temperature, so they are not compared")
    difference, i, j = max(pairs)
    first, second = stiffnesses[i], stiffnesses[j]
    text = ", ".join(
        f"{convert_to_unit(item.value, 'N/mm'):.4g} +- {convert_to_unit(item.sd, 'N/mm'):.1g}"
        for item in stiffnesses
    )
    return Finding(
        f"At the end of the hold the tests give {text} N/mm",
        difference,
        failure=f"Tests {i + 1} and {j + 1} are not of one seal. They differ by "
        f"{100 * (second.value / first.value - 1):+.2g} % at one depth, or {difference:.3g} "
        f"standard errors. At the end of the hold the tests give {text} N/mm",
        remedy="Fit each alone, or all in a batch.",
        always_passes=abs(second.value / first.value - 1) <= SAME_STIFFNESS,
    )


def _is_same_condition(first: EndStiffness, second: EndStiffness) -> bool:
    """True of two tests of one depth at one temperature, as far as it is known."""
    if abs(first.depth / second.depth - 1) > DEPTH_TOLERANCE:
        return False
    if first.temperature is None or second.temperature is None:
        return True
    return abs(first.temperature - second.temperature) <= SAME_TEMPERATURE


@criterion("probability by chance", ">=", 0.01, "Wald's test at 1 %; or alike within 0.1 %")
def depth_and_time_separable(chance: float | None, deviation: float | None) -> Finding:
    """The relative relaxation is the same at every compression.

    A `deviation` of None is a spring's, a `chance` of None that of an arm that is not known.
    """
    if deviation is None:
        return Finding("A spring does not relax at any depth")
    if chance is None:
        return Finding("An arm of one depth is not identified, so the shapes cannot be compared")
    message = f"The shape of relaxation differs between depths by up to {100 * deviation:.2g} %"
    reason = "too little to matter" if deviation < NEGLIGIBLE_DIFFERENCE else "no more than chance"
    return Finding(
        f"{message}, {reason}. One quasi-linear model serves every depth",
        chance,
        failure=f"{message}, more than chance (probability {chance:.1g}). One quasi-linear model "
        "does not serve every depth",
        remedy="Use the stiffnesses of each depth.",
        always_passes=deviation < NEGLIGIBLE_DIFFERENCE,
    )


# -- Equilibrium stiffness ------------------------------------------------------------------------


@criterion(
    "fall per factor e of time",
    "<=",
    MAX_END_SLOPE,
    "our choice: k_inf is extrapolated by as much",
    grade="note",
)
def hold_long_enough(end: EndOfHold | None) -> Finding:
    """At the end of the hold, no spectrum that fits the record still falls much."""
    if end is None:
        return Finding("Each depth has its own stiffnesses, so the end of the hold is not checked")
    slope_ratio = end.slope_limit / max(end.k_end[1], 1e-300)
    return Finding(
        f"When the hold ends, after {end.end_time:.4g} s, the stiffness still falls by up to "
        f"{100 * slope_ratio:.2g} % per factor of 2.7 in time",
        slope_ratio,
        "So k_inf is extrapolated, with no lower limit. The test gives the stiffness at the end "
        "of the hold",
        Remedy("Hold longer, or give the drift of the load cell.", "machine", "drift=..."),
    )


@criterion(
    "k_inf, N/m",
    ">",
    source="3 standard errors",
    other_grade="note where the end of a hold is known",
    fit_status=Status.NOT_IDENTIFIED,
)
def k_inf_positive(model: GeneralizedMaxwell, se: float, end: EndOfHold | None = None) -> Finding:
    """The equilibrium stiffness is above zero."""
    return Finding(
        f"k_inf is {format_quantity(model.k_inf, 'N/mm')}; noise alone would hide "
        f"{format_quantity(3.0 * se, 'N/mm', '.2g')}",
        model.k_inf,
        "It may be zero: the hold ended before the force levelled off, or the seal flows",
        "Hold longer.",
        limit=3.0 * se,
        grade=None if end is None else "note",
    )


@criterion(
    "width of the 95 % interval of k(T) / k(T)",
    "<=",
    MAX_K_INF_WIDTH,
    "our choice; of k_inf where no hold ends",
    other_grade="stop beyond 1",
)
def k_end_determined(
    model: GeneralizedMaxwell,
    se: float,
    tests: Sequence[RampHold],
    end: EndOfHold | None = None,
) -> Finding:
    """The interval of the stiffness at the end of the hold is less than half of it wide."""
    remainder = float(model.relaxation(max(test.hold_time for test in tests)))
    if end is not None:
        (low, high), reference, reference_name = end.k_end, max(remainder, 1e-300), "this stiffness"
        message = (
            f"When the hold ends the stiffness is {convert_to_unit(low, 'N/mm'):.3g} to "
            f"{format_quantity(high, 'N/mm', '.3g')}"
        )
    else:
        low = max(model.k_inf - 2 * se, 0.0)
        high = model.k_inf + 2 * se
        reference = remainder
        reference_name = "k_inf"
        message = (
            f"Noise leaves {format_quantity(high - low, 'N/mm', '.3g')} of k_inf open, of "
            f"{format_quantity(remainder, 'N/mm', '.3g')} at the end of the hold"
        )
    if not (np.isfinite(high) and reference > 0):
        return Finding(
            "The record sets no limit to k_inf",
            np.inf,
            remedy="Hold longer.",
            always_fails=True,
            grade="stop",
        )
    return Finding(
        message,
        (high - low) / reference,
        f"The record does not determine {reference_name}",
        Remedy(
            "Record a baseline of 10 s, or give drift and compliance.",
            "machine",
            "drift=...,compliance=...",
        ),
        grade="stop" if high - low > reference else None,
    )


# -- Arms -----------------------------------------------------------------------------------------


@criterion("fall in the hold / peak", "<=", 0.02, "our choice; or 7 standard errors", grade="stop")
def arms_where_force_relaxes(model: GeneralizedMaxwell, test: RampHold) -> Finding:
    """If the force relaxes, the model has an arm."""
    force = test.force[test.hold]
    if len(force) < 20:
        return Finding("The hold is too short to judge how the force relaxes")
    tenth = max(len(force) // 10, 1)
    peak = max(float(np.abs(test.force).max()), 1e-300)
    force_fall = float(force[:tenth].mean() - force[-tenth:].mean())
    return Finding(
        f"The force falls by {100 * force_fall / peak:.2g} % of its peak in the hold",
        force_fall / peak,
        "The model has no arm to follow it",
        Remedy("Use at least one arm.", "arms"),
        always_passes=bool(model.arms) or force_fall <= 7 * test.force_noise * np.sqrt(2 / tenth),
    )


@criterion("change of k", source="no limit", grade="note")
def ramp_accounted_for(model: GeneralizedMaxwell, tests: Sequence[RampHold]) -> Finding:
    r"""The ramp is part of the fit; the message says what a step would have changed.

    :math:`(\tau/c)(1 - e^{-c/\tau}) - 1`, the worst arm.
    """
    if not model.arms:
        return Finding("A spring does not change with the ramp")
    c = max(test.ramp_time for test in tests)
    bias = [tau / c * -np.expm1(-c / tau) - 1.0 for tau in model.tau]
    biases_text = ", ".join(f"k_{j} by {100 * b:.2g} %" for j, b in enumerate(bias, start=1))
    return Finding(
        f"The ramp of {c:.3g} s is included in the fit. A step in its place would change "
        f"{biases_text}",
        float(min(bias)),
    )


@criterion(
    "fastest tau / ramp",
    ">=",
    0.1,
    f"our choice; or k known to {100 * MAX_K_ERROR:g} %",
    grade="note",
)
def fast_arm_visible(
    model: GeneralizedMaxwell, tests: Sequence[RampHold], *, error: float = np.inf
) -> Finding:
    """The fastest arm still relaxes after the ramp, or its k is known otherwise.

    `error` is the relative standard error of its k.
    """
    if not model.arms:
        return Finding("There is no arm")
    ratio = model.tau[0] / min(test.ramp_time for test in tests)
    return Finding(
        f"The fastest arm ({model.tau[0]:.3g} s) has {ratio:.2g} of the shortest ramp time",
        ratio,
        "It relaxes during the ramp. Only the product b = k tau is known, not k",
        "Ramp faster, or add a hammer test.",
        always_passes=error < MAX_K_ERROR,
    )


@criterion(
    "SE(ln tau), slowest arm",
    "<=",
    0.1,
    "our choice; or correlated with drift < 0.9",
    grade="note",
)
def drift_distinguished_from_arm(
    model: GeneralizedMaxwell, correlation: float | None, se_ln_tau: float
) -> Finding:
    """The data distinguish the slowest arm from drift of the load cell."""
    if not model.arms:
        return Finding("There is no slow arm that drift could imitate")
    if correlation is None:
        return Finding(
            "No drift is fitted, so a drift of the sensor would change the slowest arm. The fit of "
            "ramp and hold includes it"
        )
    return Finding(
        f"The slowest tau is known to ±{100 * se_ln_tau:.2g} %, and is correlated by "
        f"{correlation:.2f} with the drift of the sensor",
        se_ln_tau,
        "The record cannot separate the arm from drift",
        "Record a longer baseline before contact, and hold longer.",
        always_passes=correlation < MAX_DRIFT_CORRELATION,
    )


# -- Residuals ------------------------------------------------------------------------------------


@criterion(
    "misfit / noise",
    "<=",
    MAX_NOISE_RATIO,
    "our choice; noise of at least 0.1 % of the peak",
    other_grade=f"stop beyond {GROSS_NOISE_RATIO:g}",
)
def force_residual_small(test: RampHold, residual: FloatArray) -> Finding:
    """The model fits the force to within its noise.

    `residual` is of the last samples up to the end of the hold, N. What wanders slowly counts as
    noise, which the limits hold; a model that misses the noise of each sample by so much is none.
    """
    misfit, location_text = find_worst_misfit(test, residual)
    peak = float(np.abs(test.force).max())
    of_samples = max(estimate_force_noise(test), NEGLIGIBLE_MISFIT * peak)
    noise = max(of_samples, estimate_slow_noise(residual, peak))
    ratio = misfit / noise if noise > 0 else 1.0
    return Finding(
        f"The model misses the force by {format_quantity(misfit, 'mN', '.3g')} rms "
        f"{location_text}; {format_quantity(noise, 'mN', '.3g')} would be noise",
        ratio,
        "Stiffening, friction, slip, or a late force may cause this. The arms mean nothing then",
        "Check the motion and the clocks, and repeat the test.",
        grade="stop" if misfit > GROSS_NOISE_RATIO * of_samples else None,
    )


@criterion(
    "slow / medium power",
    "<=",
    4.0,
    "our choice: white residuals give 1",
    other_grade=f"note up to {100 * SLIGHT_WANDER:g} % of the peak",
)
def residuals_steady(
    residuals: Sequence[FloatArray], *, rounding: float = 0.0, peak: float = 0.0
) -> Finding:
    """The residuals do not wander slowly, as drift or a missing slow arm would make them.

    Those of an rms below `rounding`, N, are no measurement; up to `SLIGHT_WANDER` of the `peak`, N,
    the limits of every stiffness count their power.
    """
    noisy_residuals = [residual for residual in residuals if _rms(residual) > rounding]
    ratios = [compute_wander(residual) for residual in noisy_residuals if len(residual) >= 800]
    if not ratios:
        return Finding("The residuals are too few, or only rounding, to judge slow wandering")
    return Finding(
        "The power of the residuals at low and middle frequencies differs by a factor of "
        f"{max(ratios):.2g}",
        max(ratios),
        "The force wanders slowly: drift, temperature, or a missed arm. The interval of the "
        "slowest arm is too narrow. Other limits count this as noise",
        "Let the load cell warm up, and repeat the test.",
        grade="note" if max(map(_rms, noisy_residuals)) <= SLIGHT_WANDER * peak else None,
    )


# -- Alternative fits -----------------------------------------------------------------------------


@criterion(
    "change of a parameter",
    "<=",
    MAX_METHOD_DIFFERENCE,
    "our choice; or 3 SE",
    grade="note",
    other_grade=f"limit if k(T) is {100 * SAME_STIFFNESS:g} % outside its limits",
)
def hold_and_full_agree(
    full_model: GeneralizedMaxwell,
    hold: GeneralizedMaxwell | None,
    error: FloatArray,
    *,
    end: EndOfHold | None = None,
) -> Finding:
    """A fit of the hold alone gives the same parameters as the whole record.

    `error` holds the standard errors of the full fit: k_inf, every k, every ln tau. A
    difference within three of them is noise. Where the numbers of arms differ k_inf alone is
    compared.
    """
    if hold is None:
        return Finding("Eq. 5 does not apply to this history, so the two methods are not compared")
    n, same_order = full_model.arms, hold.arms == full_model.arms
    full_values, hold_values = np.array([full_model.k_inf]), np.array([hold.k_inf])
    labels, sigma = ["k_inf"], error[:1]
    if same_order:
        full_values = np.array((full_model.k_inf, *full_model.k, *full_model.tau))
        hold_values = np.array((hold.k_inf, *hold.k, *hold.tau))
        labels += [f"{kind}_{j}" for kind in ("k", "tau") for j in range(1, n + 1)]
        # an error of ln tau is relative as it stands
        sigma = np.concatenate(
            (error[: 1 + n], np.array(full_model.tau) * error[1 + n : 1 + 2 * n])
        )
    # a plateau of nothing has no relative change: it is measured by the whole stiffness
    scale = np.where(
        full_values > ROUNDING * full_model.k_0, full_values, max(full_model.k_0, 1e-300)
    )
    difference = (hold_values - full_values) / scale
    magnitude = np.abs(difference)
    excess = np.abs(hold_values - full_values) > 3.0 * sigma
    failed = excess & (magnitude > MAX_METHOD_DIFFERENCE)
    worst_index = int(np.argmax(np.where(failed, 1e9, 0.0) + magnitude))
    orders = "" if same_order else f" with {format_arm_count(hold.arms)}"
    return Finding(
        f"The fit of the hold alone (eq. 5){orders} changes {labels[worst_index]} by "
        f"{100 * difference[worst_index]:+.2g} %, "
        f"{'more' if excess[worst_index] else 'not more'} than noise explains",
        float(magnitude[worst_index]),
        remedy="Use the fit of ramp and hold.",
        always_passes=not failed.any(),
        # eq. 5 knows an ideal ramp alone: that its arms differ is no fault of the recorded motion,
        # and k_inf is an extrapolation of both
        grade="limit"
        if (failed[0] if end is None else _is_outside_limits(full_model, hold, end))
        else None,
    )


@criterion("change of a parameter", "<=", 0.01, "our choice; cut-off >= 5/tau_1, not causal")
def filter_bias(
    applied_filter: Filter | None,
    changes: Mapping[str, Mapping[str, float]] | str = "",
    fastest: float = np.inf,
) -> Finding:
    """The filter changes the parameters by little.

    `changes` holds that of each parameter by method, or says why there is none; `fastest` is the
    shortest relaxation time, s.
    """
    if applied_filter is None:
        return Finding("The record is not filtered")
    if isinstance(changes, str):
        return Finding(
            f"The error that {applied_filter} makes is not known. The raw record has no fit: "
            f"{changes}",
            remedy=Remedy("Leave the filter out.", "filter"),
            always_fails=True,
        )
    is_slow_filter = applied_filter.kind == "lowpass" and applied_filter.cutoff < 5 / fastest
    message = (
        f"{applied_filter} changes, by eq. 5 on the hold, {_format_changes(changes['hold'])}. With "
        "the whole record "
    )
    if applied_filter.linear:
        largest_change = max(changes["full"].values(), key=abs)
        message += (
            f"it changes at most {100 * largest_change:+.3g} %, because the displacement is "
            "filtered too"
        )
    else:
        message += f"it changes {_format_changes(changes['full'])}"
    if is_slow_filter:
        message += f". The cut-off is below 5/tau_1 = {5 / fastest:.3g} Hz"
    if applied_filter.causal:
        message += ". A causal filter delays the force"
    return Finding(
        message,
        max(abs(change) for entry in changes.values() for change in entry.values()),
        remedy=Remedy("Fit the raw record.", "filter"),
        always_fails=is_slow_filter or applied_filter.causal,
    )


def _is_outside_limits(
    full_model: GeneralizedMaxwell, hold: GeneralizedMaxwell, end: EndOfHold
) -> bool:
    """Return whether eq. 5 has another stiffness at the end of the hold than the records allow."""
    full_k, hold_k = (float(model.relaxation(end.end_time)) for model in (full_model, hold))
    low, high = end.k_end
    return max(low - hold_k, hold_k - high) > SAME_STIFFNESS * full_k


# -- measures -------------------------------------------------------------------------------------


def record_window(tests: Sequence[RampHold]) -> tuple[float, float]:
    """Return the relaxation times that records could show, s: two samples to the hold."""
    return (
        min(2.0 * float(np.diff(test.time).min()) for test in tests),
        max(test.hold_time for test in tests),
    )


def compute_wander(residual: FloatArray) -> float:
    """Return the mean power at 6 to 24 cycles per record over that at 60 to 240."""
    cycles, power = slow_periodogram(residual, 240)
    slow_power, medium = (
        float(power[(cycles >= low) & (cycles <= high)].mean())
        for low, high in ((6, 24), (60, 240))
    )
    return slow_power / medium if medium > 0 else 1.0


def find_worst_misfit(test: RampHold, residual: FloatArray) -> tuple[float, str]:
    """Return the largest rms of ramp, a ramp after it, and the rest; and where, in words."""
    time = test.time[: test.hold.stop][-len(residual) :]
    located_residuals = (
        ("in the ramp", (time > test.onset) & (time <= test.ramp_end)),
        ("after the ramp", (time > test.ramp_end) & (time <= test.ramp_end + test.ramp_time)),
        ("in the hold", time > test.ramp_end + test.ramp_time),
    )
    return find_largest_rms(residual, located_residuals)


def find_largest_rms(
    residual: FloatArray, parts: Sequence[tuple[str, BoolArray]]
) -> tuple[float, str]:
    """Return the largest rms of some parts of a residual, and the words for that part."""
    pairs = [
        (float(np.sqrt(np.mean(residual[mask] ** 2))), location)
        for location, mask in parts
        if np.count_nonzero(mask) >= 5
    ]
    return max(pairs, default=(0.0, "in the record"))


def estimate_slow_noise(residual: FloatArray, peak: float) -> float:
    """Return the median rms of eight stretches of a residual, N, up to a limit.

    The limit is `SLIGHT_WANDER` of the peak.

    Slow noise does not scatter between samples, and a misfit of the ramp is in few stretches.
    """
    pieces = np.array_split(residual, 8)
    return min(
        median(np.array([_rms(piece) for piece in pieces if len(piece)])), SLIGHT_WANDER * peak
    )


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values * values)))


def estimate_force_noise(test: RampHold) -> float:
    """Return the noise of the force, N: the scatter between samples, and about the baseline."""
    if test.loading_start is None:
        unloaded_force = test.force[
            (test.time < test.onset) & (test.displacement < REST_TOLERANCE * test.depth)
        ]
    else:
        unloaded_force = test.force[test.baseline_samples]
    return max(test.force_noise, float(unloaded_force.std()) if len(unloaded_force) >= 20 else 0.0)


def _format_changes(changes: Mapping[str, float]) -> str:
    return ", ".join(
        f"{name} by {100 * change:+.3g} %" if change > -1 else f"{name} to nothing"
        for name, change in changes.items()
    )
