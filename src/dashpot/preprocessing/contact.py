"""First contact of plate and seal: load-cell baseline, where the force begins, and its delay."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray, distinct, median
from dashpot.base.errors import DataError
from dashpot.base.provenance import Step
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.numerics.inference.correlated_noise import white
from dashpot.numerics.nonnegative_least_squares import solve_linear
from dashpot.solids.maxwell import arm_response

# Load-cell baseline: zero, noise and drift; onset of force.


# Smallest number of samples for an estimate of noise.
MIN_BASELINE = 5.0
# readings of which all trials are one array
READINGS_PER_BATCH = 1 << 12


class Baseline(NamedTuple):
    """Baseline of the load cell before contact.

    Attributes
    ----------
    samples : int
    duration : float
        s.
    level, noise : float
        Mean, and standard deviation about a straight line, N.
    slope, slope_error : float
        Slope of that line, N/s; the error is infinite where the baseline is too short.
    mean_time : float
        Its mean time, s.
    """

    samples: int
    duration: float
    level: float
    noise: float
    slope: float
    slope_error: float
    mean_time: float

    @property
    def long_enough(self) -> bool:
        """Whether there are enough samples for a mean."""
        return self.samples >= MIN_BASELINE


def estimate_baseline(time: FloatArray, force: FloatArray) -> Baseline:
    """Return the baseline of the force from samples before contact, at least one."""
    mean_time, mean_force = float(time.mean()), float(force.mean())
    t = time - mean_time
    power = float(t @ t)
    sloped = len(force) >= MIN_BASELINE and power > 0
    slope = float(t @ force) / power if sloped else 0.0
    free = len(force) - 2 * sloped
    noise = float(np.sqrt(np.sum((force - mean_force - slope * t) ** 2) / free))
    error = noise / power**0.5 if sloped else np.inf
    return Baseline(len(force), float(np.ptp(time)), mean_force, noise, slope, error, mean_time)


def subtract_tare(
    time: FloatArray,
    force: FloatArray,
    baseline: Baseline,
    *,
    drift: float | str | None,
    location: str,
) -> tuple[FloatArray, Step]:
    """Subtract the tare, and the drift if requested.

    Raises
    ------
    DataError
        If the drift is requested, but the baseline is too short for it.
    """
    if drift == "baseline" and not baseline.long_enough:
        raise DataError(
            f"{location}: drift='baseline' was asked for, but {baseline.samples} samples lie "
            f"before contact; expected at least {MIN_BASELINE:.0f}: record a baseline, or give the "
            "drift in N/s"
        )
    rate = baseline.slope if drift == "baseline" else float(drift or 0.0)
    tare = baseline.level if baseline.long_enough else 0.0
    message = (
        f"tare of {format_quantity(tare, 'mN')} from {baseline.samples} samples before contact"
        if baseline.long_enough
        else "no tare: the record starts on the ramp"
    )
    if np.isfinite(baseline.slope_error):
        message += (
            f"; the baseline drifts by {convert_to_unit(baseline.slope, 'mN/s'):.2g} +- "
            f"{convert_to_unit(baseline.slope_error, 'mN/s'):.1g} mN/s"
        )
    message += (
        f"; {format_quantity(rate, 'mN/s', '.3g')} taken off" if rate else "; no drift taken off"
    )
    parameters = (("tare_n", repr(tare)), ("drift_n_per_s", repr(rate)))
    return force - tare - rate * (time - baseline.mean_time), Step("tare", parameters, message)


class Contact(NamedTuple):
    """First contact of the plate with the seal.

    Attributes
    ----------
    displacement : float
        m, on the scale of the record.
    standard_error : float
        m.
    sample : int
        The first sample whose force stands 5 sigma above the baseline.
    """

    displacement: float
    standard_error: float
    sample: int


def find_contact(displacement: FloatArray, force: FloatArray, *, noise: float) -> Contact | None:
    r"""Return the displacement at which the force begins to rise.

    The force must leave the baseline by 5 sigma and stay; then

    .. math:: F = F_0 + a\,(x - x_c)_+ + b\,(x - x_c)_+^2

    is fitted around that place, up to a tenth of the peak or 20 sigma: `a`, `b` and the tare
    linearly, the contact :math:`x_c` by search. The square bends with a seal that relaxes or
    stiffens, so that the straight line of a later force does not shift the contact.

    Parameters
    ----------
    displacement, force : array, shape (n,)
        From the start of the record to the peak, m and N; both rise.
    noise : float
        Standard deviation of the force before contact, N.

    Returns
    -------
    Contact or None
        None if the force already stands above its first values, or never rises.
    """
    x, f = displacement, force
    peak = float(f.max())
    quiet_indices = np.flatnonzero(f <= 5 * noise)
    if not quiet_indices.size or quiet_indices[-1] + 1 >= len(f) or peak <= 10 * noise:
        return None
    first = int(quiet_indices[-1]) + 1
    loaded_indices = np.flatnonzero(f >= max(20 * noise, 0.1 * peak))
    stop = int(loaded_indices[0]) + 1 if loaded_indices.size else len(f)
    stop = min(max(stop, first + 4), len(f))
    # as much air as contact: enough to hold the tare, not so much as to feel its waves
    span = max(x[stop - 1] - x[first], 1e-300)
    start = int(np.argmax(x > x[first] - 2 * span)) if x[0] <= x[first] - 2 * span else 0
    start = min(start, max(first - 3, 0))
    near_x, near_f = x[start:stop], f[start:stop]
    if len(near_x) < 6:
        return None
    return _search_contact(near_x, near_f, first)


def _search_contact(x: FloatArray, f: FloatArray, first: int) -> Contact:
    # the samples of one reading are one row: while the plate rests, nearly all of them
    reading, reading_index, count = np.unique(x, return_inverse=True, return_counts=True)
    mean = np.bincount(reading_index, f) / count
    within_sse = float(np.square(f - mean[reading_index]).sum())
    low, high = float(reading[0]), float(reading[-1])
    best = low
    for _ in range(3):
        trials = np.linspace(low, high, 41)
        trial_groups = np.array_split(
            trials, min(1 + len(reading) // READINGS_PER_BATCH, len(trials))
        )
        sums = np.concatenate(
            [_compute_misfits(reading, mean, count, values, within_sse) for values in trial_groups]
        )
        i = int(np.argmin(sums))
        best = float(trials[i])
        low, high = float(trials[max(i - 2, 0)]), float(trials[min(i + 2, 40)])
    return Contact(best, _estimate_contact_error(x, f, best), first)


def _build_contact_columns(x: FloatArray, contact: FloatArray) -> FloatArray:
    """Return the design matrices for the force, shape (trials, n, 3)."""
    compression = np.maximum(x - contact[:, None], 0.0)
    relative_compression = compression / np.maximum(compression.max(axis=1, keepdims=True), 1e-300)
    return np.stack(
        (np.ones_like(relative_compression), relative_compression, relative_compression**2), axis=2
    )


def _compute_misfits(
    displacement: FloatArray,
    mean: FloatArray,
    count: IndexArray,
    contact: FloatArray,
    within_sse: float,
) -> FloatArray:
    """Return the sum of squares for each trial contact, by singular values of all at once."""
    weight = np.sqrt(count)
    columns, force = weight[:, None] * _build_contact_columns(displacement, contact), weight * mean
    basis, singular_values, right_vectors = np.linalg.svd(columns, full_matrices=False)
    is_determined = singular_values > 1e-10 * singular_values[:, :1]
    coefficients = np.where(is_determined, force @ basis, 0.0)
    r = force - np.squeeze(basis @ coefficients[:, :, None], axis=2)
    linear_part = np.sum(
        coefficients / np.where(is_determined, singular_values, 1.0) * right_vectors[:, :, 1],
        axis=1,
    )
    # a force that falls at first contact is no contact
    return np.asarray((np.sum(r**2, axis=1) + within_sse) * np.where(linear_part >= 0, 1.0, 4.0))


def _estimate_contact_error(x: FloatArray, f: FloatArray, contact: float) -> float:
    """Return standard error of the contact: in the Jacobian its column is the slope of the rise.

    Where the force starts as a square, a straight part and a shift are one: the straight
    part is then omitted.
    """
    (columns,) = _build_contact_columns(x, np.array([contact]))
    solution = np.linalg.lstsq(columns, f, rcond=1e-10)[0]
    r = f - columns @ solution
    compression = columns[:, 1]
    slope = -(solution[1] + 2 * solution[2] * compression) * (compression > 0)
    used_columns = columns if solution[1] > 0.2 * solution[1:].sum() else columns[:, [0, 2]]
    jacobian = np.column_stack((used_columns, slope))
    variance = float(r @ r) / max(len(x) - jacobian.shape[1], 1)
    scale = float(np.maximum(x - contact, 0.0).max())
    return scale * float(np.sqrt(white(jacobian, variance)[-1, -1]))


# samples in air, at least, that show it where a record starts on the ramp
MIN_AIR_SAMPLES = 5


class Touch(NamedTuple):
    """Candidate for the first contact.

    Attributes
    ----------
    displacement : float
        m, on the scale of the record.
    gap : float
        Its distance from where the plate rested, m; 0 if no air shows.
    standard_error : float
        m; 0 if contact was given or no air shows.
    """

    displacement: float
    gap: float
    standard_error: float = 0.0


def find_first_contact(
    displacement: FloatArray,
    force: FloatArray,
    *,
    noise: float,
    rest_position: float,
    level: float,
    least_gap: float,
    is_rested: bool,
) -> Touch:
    """Return the first contact: behind an air gap, or where the plate rested.

    Parameters
    ----------
    displacement, force : array, shape (n,)
        Up to the peak, m and N above the baseline.
    noise : float
        N.
    rest_position, level : float
        Displacement before the ramp and in the hold, m.
    least_gap : float
        Smallest gap that is detected, m.
    is_rested : bool
        False if the record starts on the ramp: :data:`MIN_AIR_SAMPLES` must show the air then,
        for there is no other baseline.
    """
    contact = find_contact(displacement, force, noise=noise)
    if contact is None or (not is_rested and contact.sample < MIN_AIR_SAMPLES):
        return Touch(rest_position, 0.0)
    air_gap = contact.displacement - rest_position
    if not max(least_gap, 3 * contact.standard_error) < air_gap < 0.9 * (level - rest_position):
        return Touch(rest_position, 0.0)
    return Touch(contact.displacement, air_gap, contact.standard_error)


# Delay of the force: by an air gap or by its clock.
#
# A force that lags its displacement by :math:`\delta` begins to rise when the plate has moved on by
# :math:`v\delta`, as behind so much air. But it also lags at the end of the ramp, where air is long
# crossed. So ramp and first relaxation are fitted with each delay that the clocks may have, from
# where the plate rested and from where the force begins.


# Number of trial delays, and their range in standard deviations of the clocks.
TRIAL_DELAY_COUNT, MAX_DELAY_SD = 13, 4.0
# number of successive worse delays after which the search ends
MAX_WORSE_DELAYS = 2
# arms, from this part of the ramp to so many times it, and no faster than so many samples
DELAY_ARMS, FASTEST_ARM, SLOWEST_ARM, SAMPLES_PER_ARM = 6, 0.02, 3.0, 2.0
# rows near either corner of the ramp, and over all of it
CORNER_ROWS = 100
# rows that could show a delay beside its arms
MIN_DELAY_ROWS = 4 * DELAY_ARMS
# span after the ramp that is fitted, over its duration
SPAN_AFTER_RAMP = 0.5


class DelayEstimate(NamedTuple):
    """Delay of the force, s, from a first contact that fits best, with its deviance."""

    delay: float
    deviance: float


def estimate_contact_delay(
    time: FloatArray,
    compression: FloatArray,
    force: FloatArray,
    *,
    corners: tuple[float, float],
    delay_sd: float,
) -> DelayEstimate:
    """Return the delay with which arms of positive stiffness follow a force best.

    Parameters
    ----------
    time, compression, force : array, shape (n,)
        From the rest before a ramp to `SPAN_AFTER_RAMP` of it later: s, the compression from the
        trial contact, m, and N.
    corners : (float, float)
        Begin and end of the ramp, s.
    delay_sd : float
        Standard deviation of the delay between the clocks, s.

    Returns
    -------
    DelayEstimate
        No delay, with a deviance of 0, where the ramp has too few rows to show one.
    """
    rows = _select_delay_rows(time, corners, MAX_DELAY_SD * delay_sd)
    if len(rows) < MIN_DELAY_ROWS:
        return DelayEstimate(0.0, 0.0)
    ramp, step = corners[1] - corners[0], median(np.diff(time[rows]))
    fastest = max(FASTEST_ARM * ramp, SAMPLES_PER_ARM * step)
    tau = np.geomspace(fastest, max(SLOWEST_ARM * ramp, 2 * fastest), DELAY_ARMS)
    responses = [compression, *arm_response(time, compression, tau).T]
    target, is_nonnegative = force[rows], np.append(False, np.ones(len(responses), dtype=bool))
    best, failures = DelayEstimate(0.0, np.inf), 0
    for delay in np.linspace(0.0, MAX_DELAY_SD * delay_sd, TRIAL_DELAY_COUNT).tolist():
        columns = [np.interp(time[rows] - delay, time, response) for response in responses]
        design = np.column_stack((np.ones(len(rows)), *columns))
        residual = target - design @ solve_linear(design, target, is_nonnegative)[0]
        misfit = len(rows) * float(np.log(max(float(residual @ residual), 1e-300)))
        trial = DelayEstimate(delay, misfit + (delay / delay_sd) ** 2)
        best, failures = (trial, 0) if trial.deviance < best.deviance else (best, failures + 1)
        if failures == MAX_WORSE_DELAYS:
            break
    return best


def _select_delay_rows(
    time: FloatArray, corners: tuple[float, float], near_time: float
) -> IndexArray:
    """Return rows of a fit of the delay: near the corners of the ramp, and fewer elsewhere."""
    ramp_start, end = corners
    chosen_rows = []
    for low, high in (
        (ramp_start - near_time, ramp_start + 3 * near_time),
        (ramp_start, time[-1]),
        (end - near_time, end + near_time),
    ):
        first, stop = np.searchsorted(time, (low, high))
        chosen_rows.append(np.arange(first, stop, max(1, (stop - first) // CORNER_ROWS)))
    return distinct(np.concatenate(chosen_rows))
