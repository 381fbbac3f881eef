"""Criteria on hits and on their FRF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.checks import Check, Finding, Remedy, criterion
from dashpot.base.number_format import with_error
from dashpot.base.units import GRAVITY, format_quantity
from dashpot.datamodel.frf import FRF, Kind, Mode
from dashpot.numerics.inference.covariance_estimate import estimate as estimate_optimum
from dashpot.numerics.inference.covariance_estimate import white_noise
from dashpot.numerics.least_squares import solve_ordinary, stack_real_rows
from dashpot.vibration.impact.amplitude_trend import Trend, fit_amplitude_trend
from dashpot.vibration.impact.exponential_window import ExponentialWindow
from dashpot.vibration.impact.hit_faults import HitQuality
from dashpot.vibration.impact.rocking import Combination
from dashpot.vibration.impact.spectral_estimators import Estimator, Spectra, estimate, leave_one_out

MAX_PEAK_POSITION = 0.95
"""Part of the lines beyond which the highest is where they end, and no peak."""
MIN_HITS = 3  # good hits
MIN_COHERENCE = 0.9
# lines on either side of a resonance from which a single hit shows it
MIN_RESONANCE_LINES = 1.5  # in the half-power band
MIN_TIME_CONSTANTS = 6  # of decay that a record should hold: FRF errors below 0.5 %
OUTLIER_RATIO = 5.0  # times the usual disagreement between a hit and the others
MAX_DISAGREEMENT = 0.1
MASS_TOLERANCE = 0.05
GROSS_MASS_RATIO = 1.5  # so far off it is a unit, a sign or another body
MASS_LINE_FACTOR = 2.5  # times the natural frequency the mass line begins
# of its level, the largest error of a line; steps of its fit
MAX_MASS_LINE_ERROR, MASS_LINE_STEPS = 0.3, 5
MIN_SOFTENING, MIN_BANDWIDTH_CHANGE = 0.01, 0.2  # of the stiffness; of the half-power band


def agreement(
    spectra: Spectra,
    qualities: Sequence[HitQuality],
    accepted: BoolArray,
    accept: Sequence[str],
) -> tuple[list[HitQuality], BoolArray]:
    """Hold each hit against the others; leave out one that the others contradict.

    With fewer than four hits nobody can say who is wrong, so none is omitted.
    """
    qualities, accepted = list(qualities), accepted.copy()
    differences = compute_disagreement(spectra.only(accepted))
    if differences is None:
        return qualities, accepted
    typical = float(np.median(differences))
    for i, value in zip(np.flatnonzero(accepted), differences, strict=True):
        if value < max(OUTLIER_RATIO * typical, MAX_DISAGREEMENT):
            continue
        message = (
            f"incoherent: its response differs by {100 * value:.0f} % from that of the other "
            f"hits, where {100 * typical:.1f} % is usual"
        )
        if np.count_nonzero(accepted) > MIN_HITS:
            qualities[i] = replace(qualities[i], faults=(*qualities[i].faults, message))
            accepted[i] = str(i + 1) in accept
        else:
            qualities[i] = replace(qualities[i], doubts=(*qualities[i].doubts, message))
    return qualities, accepted


def compute_disagreement(spectra: Spectra) -> FloatArray | None:
    """Return the relative difference of each response from the FRF of the other hits.

    The median over the other hits, so that one bad hit does not discredit the good ones.
    """
    if spectra.averages < MIN_HITS:
        return None
    force, response = spectra.force, spectra.response
    ratio = response / force
    response_norm = np.linalg.norm(response, axis=1)
    separate = [
        np.linalg.norm(response[i] - np.delete(ratio, i, axis=0) * force[i], axis=1)
        / response_norm[i]
        for i in range(spectra.averages)
    ]
    return np.asarray(np.median(separate, axis=1))


def run_frf_checks(
    frf: FRF,
    spectra: Spectra,
    estimator: Estimator,
    main: Mode | None,
    *,
    combination: Combination | None = None,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
) -> tuple[Check, ...]:
    """Every named question to a measured FRF, about its resonance `main` in `band`, Hz."""
    band_frf = frf if band is None else frf.band(*band)
    main_line = resonant_line(band_frf, main)
    checks = [hits_enough(frf), coherence(band_frf, main_line), resonance(band_frf, main)]
    if main is not None:
        checks += [
            record_long_enough(frf, main),
            lines_in_half_power_band(frf, main),
            hammer_excites(frf, spectra, main),
        ]
    if spectra.averages >= MIN_HITS and main is not None:
        checks += [
            hits_agree(frf, spectra, estimator, main),
            amplitude_linear(fit_amplitude_trend(frf.hits), main),
        ]
    if combination is not None:
        checks += [rocking_cancelled(frf, combination), hits_centred(frf, combination)]
    if mass is not None:
        checks.append(mass_shown(frf, main, mass))
    return tuple(checks)


def mass_shown(frf: FRF, main: Mode | None, mass: float) -> Check:
    """Return whether the mass line above the resonance `main` shows a mass, kg."""
    apparent = (
        None
        if main is None
        else estimate_apparent_mass(
            frf.frequency, frf.value, natural_frequency=main.frequency, shift=frf.shift, sd=frf.sd
        )
    )
    return high_frequency_mass_agrees(apparent, mass)


@criterion("hits", ">=", MIN_HITS, "our choice: the fewest that show an outlier")
def hits_enough(frf: FRF) -> Finding:
    """Enough hits are averaged."""
    return Finding(
        f"{frf.averages} of {len(frf.hits)} hits are used; at least {MIN_HITS} are needed",
        frf.averages,
        "So few give neither an average nor its error",
        "Hit more often, five times or more.",
    )


def resonant_line(frf: FRF, main: Mode | None) -> int:
    """Index of the line nearest to a mode, or of the highest if there is none."""
    if main is None:
        return int(np.argmax(np.abs(frf.value)))
    return int(np.argmin(np.abs(frf.frequency - main.frequency)))


@criterion("least coherence about the peak", ">=", MIN_COHERENCE, "common practice")
def coherence(frf: FRF, line: int) -> Finding:
    """The coherence is high at the resonance and at the lines beside it."""
    if frf.coherence is None:
        return Finding(
            "A single hit has no coherence; it would be 1 whatever was measured. More hits would "
            "give one"
        )
    first = max(line - 1, 0)
    lowest_line = first + int(np.argmin(frf.coherence[first : line + 2]))
    value = float(frf.coherence[lowest_line])
    location = "at" if lowest_line == line else "beside"
    return Finding(
        f"The coherence {location} the resonance ({frf.frequency[lowest_line]:.4g} Hz) is "
        f"{value:.4f}; at least {MIN_COHERENCE:g} is expected",
        value,
        "The hits differ there",
        Remedy("Strike the same place squarely, and record longer.", "hit-length"),
    )


@criterion("Im A / |A| at the peak", ">=", -0.3, "0 or more, apart from noise", grade="stop")
def frf_dissipates(value: complex, peak: float) -> Finding:
    """The part dissipates energy: the accelerance leads the force at the peak."""
    part = value.imag / abs(value)
    return Finding(
        f"At {peak:.4g} Hz the accelerance leads the force",
        part,
        failure=f"At {peak:.4g} Hz the accelerance lags behind the force, as if the part gave "
        "energy. A sign or a polarity is wrong",
        remedy=Remedy("Turn the sign of the phase, or the polarity of one channel.", "polarity"),
    )


@criterion(
    "(1 - 1/T) (resonance / frequency)^2",
    "x/",
    3.0,
    "1 for a mass on a spring; no passive part is below 0",
    grade="stop",
)
def mass_over_base(frf: FRF) -> Finding:
    """The transmissibility is of mass over base: 1 at rest, falling above the resonance."""
    lines = frf.only(frf.usable)
    T, f = lines.to(Kind.TRANSMISSIBILITY).value, lines.frequency
    peak = _find_peak_line(np.abs(lines.value))
    low = (
        np.zeros(len(f), dtype=bool) if peak is None else (f >= f[peak] / 4) & (f <= 0.6 * f[peak])
    )
    if peak is None or np.count_nonzero(low) < MIN_HITS:
        return Finding(
            f"Fewer than {MIN_HITS} lines lie from 0.25 to 0.6 of a resonance, so the "
            "transmissibility at rest is not checked"
        )
    r2 = (f[low] / f[peak]) ** 2
    if frf.quantity is Kind.RELATIVE_TRANSMISSIBILITY:
        # (1 - 1/T) / r^2 of a mass on a spring, linear in the gain of the one sensor
        part = float(np.median((T[low] - 1).real * (1 - r2) / r2))
        cause, remedy = _explain_relative(
            part, complex(np.median(T[low].real) - 1, np.median(T[low].imag))
        )
    else:
        part = float(np.median((1 - 1 / T[low]).real / r2))
        cause, remedy = _explain_absolute(complex(np.median(T[low].real), np.median(T[low].imag)))
    return Finding(
        f"The transmissibility rises from 1 towards the resonance at {f[peak]:.4g} Hz",
        part,
        # one sentence: a verdict must not lose the cause where it is short of words
        failure=f"Below {f[peak]:.4g} Hz the transmissibility is not that of a mass over its "
        "base; " + cause,
        remedy=remedy,
    )


def _explain_absolute(magnitude: complex) -> tuple[str, Remedy]:
    """Return the likely cause of such a transmissibility below resonance, and a remedy."""
    if 0.5 < abs(magnitude) < 2:
        if magnitude.real > 0:
            return "it looks like the base over the mass", Remedy("Take mass over base.")
        return (
            f"it is {magnitude.real:.3g}, as if one sensor had the opposite polarity",
            Remedy("Turn its sign."),
        )
    return (
        f"it is {abs(magnitude):.3g}, not about 1",
        Remedy("Check units, or read it as relative to the base.", "relative"),
    )


def _explain_relative(part: float, magnitude: complex) -> tuple[str, Remedy]:
    """Return the likely cause of such a relative motion, and a remedy.

    Below its resonance; over the motion of the base it is `size` there.
    """
    if abs(magnitude.imag) > abs(magnitude.real):
        return (
            "it is a quarter turn off, as a velocity is from a displacement",
            Remedy("Check its unit."),
        )
    if part < 0:
        return "the relative motion has the opposite sign", Remedy("Take mass less base.")
    if 0.5 < magnitude.real < 2:
        return "the motion looks absolute, not relative", Remedy("Read it as absolute.")
    return f"it is {part:.3g} times that of a mass on a spring", Remedy("Check its unit.")


def _find_peak_line(magnitude: FloatArray) -> int | None:
    """Return the line at which a ratio of motions peaks, or is least if inverted."""
    highest_index, lowest_index, last_index = (
        int(magnitude.argmax()),
        int(magnitude.argmin()),
        len(magnitude) - 1,
    )
    if 0 < highest_index < MAX_PEAK_POSITION * last_index:
        return highest_index
    return lowest_index if highest_index > 0 and lowest_index > 0 else None


@criterion(source="by definition")
def line_errors_stated() -> Finding:
    """The FRF states the scatter of each of its lines."""
    return Finding(
        "The FRF has neither coherence nor scatter, so every line counts alike",
        remedy="Export the coherence with it.",
        always_fails=True,
    )


@criterion("natural frequency, Hz", source="no limit: a mode is identified or not", grade="stop")
def resonance(frf: FRF, main: Mode | None) -> Finding:
    """The FRF has a clear resonance."""
    if main is None:
        return Finding(
            f"No resonance was found between {frf.frequency[0]:.3g} and {frf.frequency[-1]:.3g} Hz",
            reason="A channel may be wrong, or the damping too high",
            remedy=Remedy("Check the channels, and widen the band.", "band"),
            always_fails=True,
        )
    return Finding(
        f"The resonance lies at {main.frequency:.5g} Hz, with a damping ratio of "
        f"{100 * main.damping_ratio:.3g} %",
        main.frequency,
    )


@criterion("record, s", ">=", source=f"{MIN_TIME_CONSTANTS} time constants: FRF errors below 0.5 %")
def record_long_enough(frf: FRF, main: Mode) -> Finding:
    """The record contains the whole decay."""
    record_length = frf.record or 0.0
    needed_length = MIN_TIME_CONSTANTS / main.decay
    cut_percent = 100 * np.exp(-(main.decay + frf.shift) * record_length)
    return Finding(
        f"The record lasts {record_length:.3g} s after the hit; {MIN_TIME_CONSTANTS} time "
        f"constants of the decay are {needed_length:.3g} s",
        record_length,
        f"At its end {cut_percent:.2g} % of the response is left, which flattens the peak of the "
        "FRF. The modes allow for that",
        Remedy("Record longer after each hit.", "hit-length", f"{needed_length:.3g}s"),
        limit=needed_length,
    )


@criterion(
    "error of the window / decay of the mode",
    "<=",
    0.1,
    "our choice; a damping ratio is then known to 10 %",
)
def window_decay_determined(window: ExponentialWindow, main: Mode | None) -> Finding:
    """The time constant of an exponential window in the record is known."""
    if window.is_determined and not (window.stated or window.evident):
        return Finding(
            "No noise is seen behind the pulse, so that an exponential window would not be"
        )
    if not (window.is_determined or window.evident):
        return Finding(
            "The file states an exponential window and not its decay, and the noise shows none"
            if window.stated
            else "The numbers of the responses are coarser than their noise, so that an "
            "exponential window would not be seen",
            reason="Its decay would count as damping",
            remedy=Remedy("Give its time constant, or 0s if there is none.", "window-decay"),
            always_fails=True,
        )
    if not window.is_determined:
        decay_text = f"of {1 / window.rate:.3g} s" if window.rate > 0 else "that is none"
        return Finding(
            f"The noise decays as under an exponential window of {1 / window.seen_rate:.3g} s, and "
            f"a window {decay_text} was stated",
            reason="One of them is wrong, and the damping with it",
            remedy=Remedy("Check the setting of the analyser.", "window-decay"),
            always_fails=True,
        )
    if window.rate <= 0:
        return Finding("The record carries no exponential window, as stated")
    origin = "as stated" if window.stated and window.sd == 0 else "by its noise"
    message = f"The record carries a window of {1 / window.rate:.3g} s {origin}"
    if main is None:
        return Finding(f"{message}. No mode was found to judge it by")
    return Finding(
        f"{message}, known to {100 * window.sd / main.decay:.2g} % of the mode's decay",
        window.sd / main.decay if main.decay > 0 else np.inf,
        "The damping is known no better",
        Remedy("Give the time constant of the window.", "window-decay"),
    )


@criterion(
    "lines",
    ">=",
    MIN_RESONANCE_LINES,
    "measured: damping and height to 1 %; a third of them reads 17 % high",
)
def lines_in_half_power_band(frf: FRF, main: Mode) -> Finding:
    """The frequency resolution is fine enough for the peak."""
    spacing = float(np.median(np.diff(frf.frequency)))
    width = main.bandwidth + frf.shift / np.pi
    needed_length = max(MIN_RESONANCE_LINES / main.bandwidth, MIN_TIME_CONSTANTS / main.decay)
    return Finding(
        f"The half-power band of {width:.3g} Hz has {width / spacing:.1f} lines; at least "
        f"{MIN_RESONANCE_LINES:g} are needed. The frequency resolution is {spacing:.3g} Hz",
        width / spacing,
        "The peak lies between the lines",
        Remedy(
            f"Record {needed_length:.3g} s after each hit.", "hit-length", f"{needed_length:.3g}s"
        ),
    )


@criterion("level of the force at the peak, dB", ">=", -10.0)
def hammer_excites(frf: FRF, spectra: Spectra, main: Mode) -> Finding:
    """The force spectrum of the hammer has not fallen at the resonance."""
    power = (np.abs(spectra.force) ** 2).mean(axis=0)
    main_line = int(np.argmin(np.abs(frf.frequency - main.frequency)))
    level = 10 * float(np.log10(power[main_line] / power[:3].mean()))
    return Finding(
        f"At the resonance the force of the hammer is {max(-level, 0.0):.2g} dB below its plateau. "
        f"Lines up to {frf.frequency[-1]:.3g} Hz are used",
        level,
        "The hammer hardly excites the resonance",
        "Use a harder tip.",
    )


@criterion("largest change without one hit", "<=", MAX_DISAGREEMENT)
def hits_agree(frf: FRF, spectra: Spectra, estimator: Estimator, main: Mode) -> Finding:
    """No single hit determines the FRF near the resonance."""
    half_band = max(main.bandwidth, 2 * float(np.median(np.diff(frf.frequency))))
    near_resonance = np.abs(frf.frequency - main.frequency) <= half_band
    leave_one_out_frfs = leave_one_out(spectra, estimator)[:, near_resonance]
    average = estimate(spectra, estimator)[near_resonance]
    change = np.linalg.norm(leave_one_out_frfs - average, axis=1) / np.linalg.norm(average)
    worst_hit = int(np.argmax(change))
    name = [hit.name for hit in frf.hits if hit.accepted][worst_hit]
    value = float(change[worst_hit])
    return Finding(
        f"Without any one hit the FRF about the resonance changes by {100 * value:.2g} %",
        value,
        f"Hit {name} decides the result",
        Remedy("Hit more often and more alike, or leave that hit out.", "reject", name),
    )


@criterion(
    "change over the hits made, times what is sure and matters",
    "<=",
    1.0,
    "1 % of stiffness or a fifth of the half-power band; 10 % of damping",
)
def amplitude_linear(trend: Trend | None, main: Mode) -> Finding:
    """Frequency and damping are the same for weak and for strong hits."""
    if trend is None:
        return Finding(
            f"A change with amplitude needs more than {MIN_HITS} hits of different height"
        )
    doublings = float(np.log2(trend.range))
    notable_change = min(MIN_SOFTENING, 4 * MIN_BANDWIDTH_CHANGE * main.damping_ratio) / doublings
    stiffness = abs(trend.stiffness) / max(trend.stiffness_sure, notable_change)
    damping = abs(trend.damping) / max(trend.damping_sure, MAX_DISAGREEMENT / doublings)
    return Finding(
        f"Hits of 1 to {trend.range:.3g} in height change the stiffness by "
        f"{100 * trend.stiffness:+.2g} % per doubling, the damping by "
        f"{100 * trend.damping:+.2g} %. Scatter alone gives {100 * trend.stiffness_sure:.2g} and "
        f"{100 * trend.damping_sure:.2g} %; "
        f"{100 * trend.detectable_stiffness_change:.2g} and "
        f"{100 * trend.detectable_damping_change:.2g} % would be detected",
        max(stiffness, damping),
        "The seals are not linear at these amplitudes, so the average peak is too broad",
        "Hit alike, as hard as in use.",
    )


@criterion("rocking / bounce peak", "<=", 0.05)
def rocking_cancelled(frf: FRF, combination: Combination) -> Finding:
    """The mean of the accelerometers cancels the rocking of the block."""
    weighted = any(
        step.name == "combine" and len({value for _, value in step.parameters}) > 1
        for step in frf.steps
    )
    value = combination.ratio if weighted else combination.mean_ratio
    rocking, bounce = abs(combination.rocking) / (2 * np.pi), abs(combination.bounce) / (2 * np.pi)
    hint = "" if weighted else f". A weighted mean would leave {combination.ratio:.3f}"
    return Finding(
        f"Rocking at {rocking:.5g} Hz remains with {value:.3f} of the bounce peak at "
        f"{bounce:.5g} Hz{hint}",
        value,
        remedy="Strike closer to the centre."
        if weighted
        else Remedy(
            "Weight the accelerometers, or strike closer to the centre.", "combine", "weighted"
        ),
    )


@criterion("largest rocking / bounce of a hit", "<=", 0.25)
def hits_centred(frf: FRF, combination: Combination) -> Finding:
    """The hits strike the block near its centre."""
    names = [hit.name for hit in frf.hits if hit.accepted]
    worst_hit = int(np.argmax(np.abs(combination.eccentricity)))
    value = float(abs(combination.eccentricity[worst_hit]))
    scatter = float(np.std(combination.eccentricity))
    message = (
        f"Hit {names[worst_hit]} rocks the test mass by {100 * value:.0f} % of its bounce at the "
        f"accelerometers, the most of all ({100 * scatter:.0f} % scatter)"
    )
    if combination.reach is not None:
        half_distance = combination.reach
        # a slender block as long as the accelerometers are apart: rho^2 = x^2 / 3
        message += (
            f". On a slender mass {format_quantity(2 * half_distance, 'mm', '.0f')} long this is a "
            f"hit {format_quantity(value * half_distance / 3, 'mm', '.1f')} off centre"
        )
    return Finding(message, value, remedy="Strike closer to the centre.")


def estimate_apparent_mass(
    frequency: FloatArray,
    accelerance: ComplexArray,
    *,
    natural_frequency: float,
    shift: float = 0.0,
    sd: FloatArray | None = None,
) -> tuple[float, float] | None:
    r"""Mass that the FRF shows above its resonance, and its standard error, kg.

    .. math:: \frac1A = m + \frac{K' + jK''}{s^2} + m d s

    from 2.5 times the natural frequency up, with a delay d. It is fitted to A, whose errors do not
    depend on it: the mean of 1/A is not that of a noisy A, and a line that noise has raised would
    weigh more. None if fewer than 5 good lines lie there.
    """
    magnitude = np.abs(accelerance)
    error = 1e-3 * magnitude if sd is None else np.hypot(sd, 1e-3 * magnitude)
    keep: BoolArray = (frequency > MASS_LINE_FACTOR * natural_frequency) & (magnitude > 0)
    if not keep.any():
        return None
    level = float(np.average(magnitude[keep], weights=error[keep] ** -2.0))
    keep = keep & (error < MAX_MASS_LINE_ERROR * level)
    if np.count_nonzero(keep) < 5:
        return None
    s, value, error = 2j * np.pi * frequency[keep] + shift, accelerance[keep], error[keep]
    x, delayed = (np.abs(s).min() / s) ** 2, s / np.abs(s).max()
    columns = np.column_stack((np.ones_like(s), x, 1j * x, delayed))
    beta = np.array([1 / level, 0.0, 0.0, 0.0])
    for _ in range(MASS_LINE_STEPS):
        predicted = 1 / (columns @ beta)
        rows = stack_real_rows(columns * (-(predicted**2) / error)[:, None])
        best = solve_ordinary(stack_real_rows((value - predicted) / error) + rows @ beta, rows)
        beta = best.beta
    uncertainty = estimate_optimum(best, noises=[white_noise(best)])
    return float(beta[0]), float(uncertainty.standard_error[0])


@criterion(
    "apparent / weighed mass - 1",
    "|x| <=",
    MASS_TOLERANCE,
    "ISO 7626-2, 7.5.2",
    other_grade=f"stop beyond a factor {GROSS_MASS_RATIO:g}",
)
def high_frequency_mass_agrees(apparent: tuple[float, float] | None, mass: float) -> Finding:
    """Above the resonance the FRF shows the stated mass."""
    if apparent is None:
        return Finding(
            f"No good lines lie above {MASS_LINE_FACTOR:g} times the natural frequency, so the "
            "mass cannot check the calibration"
        )
    # a part, not a mass: that is the fit's to say
    factor, se = (value / mass for value in apparent)
    side_word = "above" if factor > 1 else "below"
    message = (
        f"Above the resonance the FRF shows a mass {with_error(100 * abs(factor - 1), 100 * se)} % "
        f"{side_word} the {format_quantity(mass, 'g')} given"
    )
    return Finding(
        f"{message}. The calibration is right within {100 * (abs(factor - 1) + 2 * se):.1f} %",
        factor - 1,
        failure=message,
        reason=_format_likely_cause(factor),
        remedy=Remedy("Check the mass, then sensitivities and units.", "mass"),
        grade="stop" if factor < 0 or abs(np.log(factor)) > np.log(GROSS_MASS_RATIO) else None,
    )


def _format_likely_cause(factor: float) -> str:
    if factor < 0:
        return "The polarity of the hammer or of the accelerometers is wrong"
    causes = (
        ("The acceleration looks like g, not m/s^2", GRAVITY),
        ("The acceleration looks like m/s^2, not g", 1 / GRAVITY),
        ("The mass looks like grams, or the force like mN", 1e-3),
        ("The mass looks like tonnes, or the force like kN", 1e3),
        ("A sensitivity looks ten times too large or small, such as 100 mV/g for 10 mV/g", 10.0),
        ("A sensitivity looks ten times too large or small, such as 10 mV/g for 100 mV/g", 0.1),
    )
    cause, ratio = min(causes, key=lambda item: abs(np.log(factor / item[1])))
    if abs(factor / ratio - 1) < 2 * MASS_TOLERANCE:
        return f"{cause} (factor {factor:.4g})"
    return f"If the mass is right, a sensor sensitivity is wrong by a factor of {1 / factor:.4g}"
