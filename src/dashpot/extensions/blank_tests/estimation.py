r"""Estimation of a testing machine's properties from one blank record.

A part of stiffness k, pressed by a machine of compliance C whose crosshead settles by s in a factor
e of time after its stop, and whose force is read as g times itself and later by :math:`\delta`,
gives once it is in contact

.. math:: F(t) = a + \dot F t + K\,[x(t-\delta) - x_c + s \ln(1 + (t - t_e)/t_r)],
          \qquad 1/K = 1/(g k) + C

with the end of the ramp :math:`t_e` and its time since contact :math:`t_r`. A rigid stop has
:math:`1/k = 0`. All but :math:`\delta` is linear; :math:`\delta` is found by repeated shift of the
motion.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray, block_means, median
from dashpot.base.errors import DataError
from dashpot.extensions.blank_tests.datamodel import BlankTest
from dashpot.numerics.inference.correlated_noise import Noise, estimate_noise
from dashpot.preprocessing.signal_conditioning import hum_lines
from dashpot.signals.disturbances import MAINS_FREQUENCIES
from dashpot.signals.noise import remove_spikes, scatter
from dashpot.signals.segments import find_segments

MIN_LOADED_SHARE = 0.05
"""Part of the largest force from which a part is in contact all over."""
_CONTACT_SHARE = 0.01
"""Part of the largest force that a contact begins with."""
_MAX_SHIFTS, _DELAY_TOLERANCE = 8, 1e-7
"""Largest number of shifts of the motion, and the step of the delay that ends them, s."""
_MIN_COUNT = 20
"""Samples of a baseline or of a press that an estimate needs."""
_PEAK_SHARE = 0.05
"""Fraction of the samples, those with the largest load, that give the peak force."""
_REST_SPEED, _TRAVEL_SPEED = 0.05, 0.5
"""Parts of the largest speed: below the first a plate rests, above the second it travels."""
_MIN_SPAN, _LARGEST_SPAN, _SPEED_OVER_NOISE = 0.01, 0.25, 50.0
"""Parts of a ramp over which a speed is taken, at least and at most, and how many times its noise
it is to be."""
_MIN_EIGENVALUE = 1e-13
"""Least eigenvalue of a Gram matrix of columns of size 1."""
_MISFIT_BLOCKS = 32
"""Number of block means of the residuals for the misfit."""
_CHANCE_ERRORS = 3.5
"""Largest deviation of such a mean by chance, standard errors."""
_DELAY_COLUMN, _OFFSET_COLUMN = 4, 5
"""Columns of delay and offset; before them line, stiffness, creep and drift."""
_GAP_ERRORS = 3.0
"""Standard errors by which a contact is off the rest of the plate."""
_MOTION_OVER_NOISE = 20.0
"""Range of a displacement over its noise above which the plate moved."""
_SLOW_BLOCKS = 20
"""Number of block means of an empty run for its slow changes beside a steady drift."""
_MAINS_SEARCH = 0.5
"""Hz either way of the mains at which a weak line is looked for."""


class RigEstimate(NamedTuple):
    """Estimated quantity with its standard error, SI."""

    value: float
    error: float


class Press(NamedTuple):
    """Result of one press of a stop or a spring.

    Attributes
    ----------
    stiffness, creep, delay, drift : RigEstimate
        K, N/m; s, m; s; N/s.
    peak : float
        Largest force, N.
    ramp_time : float
        From contact to the end of the ramp, s.
    hold : float
        Time of the hold, s.
    noise : float
        Standard deviation of a residual, N.
    misfit : float
        Largest mean of neighbouring residuals beyond chance, over `peak`.
    curvature : RigEstimate
        Departure of the force from a straight line at half the load, over `peak`.
    hysteresis : float
        Force on the way back less that on the way in, at half the load, over `peak`; nan of a
        record that ends loaded.
    fitted : array, shape (n,)
        The force by the model, N; nan where none applies.
    force : array, shape (n,)
        The force as it was fitted, N.
    """

    stiffness: RigEstimate
    creep: RigEstimate
    delay: RigEstimate
    drift: RigEstimate
    peak: float
    ramp_time: float
    hold: float
    noise: float
    misfit: float
    curvature: RigEstimate
    hysteresis: float
    fitted: FloatArray
    force: FloatArray


class EmptyRun(NamedTuple):
    """Result of an empty run.

    Attributes
    ----------
    noise, drift : RigEstimate
        Standard deviation of a reading, N; N/s.
    hum : RigEstimate
        Amplitude of the strongest line, N.
    hum_frequency : float
        Hz; nan if no line is significant.
    motion_force : float
        Largest force that is correlated with the motion of the plate, N.
    motion_error : float
        Its standard error, N.
    unsteady_share : float
        Fraction of the record in which the plate neither rests nor moves steadily; 0 if it rests.
    slow_noise : float
        Standard deviation of means over a twentieth of the record, N.
    fitted : array, shape (n,)
        N.
    force : array, shape (n,)
        N.
    """

    noise: RigEstimate
    drift: RigEstimate
    hum: RigEstimate
    hum_frequency: float
    motion_force: float
    motion_error: float
    unsteady_share: float
    slow_noise: float
    fitted: FloatArray
    force: FloatArray


class Blanks(NamedTuple):
    """Estimates of all records by their roles, and the series of each record in its order."""

    stop_presses: tuple[Press, ...]
    spring_presses: tuple[Press, ...]
    empty_runs: tuple[EmptyRun, ...]

    in_record_order: tuple[Press | EmptyRun, ...]

    @property
    def presses(self) -> tuple[Press, ...]:
        """Stops and springs."""
        return self.stop_presses + self.spring_presses


class Regression(NamedTuple):
    """Linear fit with errors valid for correlated noise."""

    values: FloatArray
    errors: FloatArray
    residual: FloatArray
    noise: Noise


def solve_regression(
    columns: FloatArray,
    values: FloatArray,
    weights: FloatArray | None = None,
    *,
    noisy: int | None = None,
    noise: float = 0.0,
) -> Regression:
    r"""Return the least-squares fit of `values`, shape (n,), by `columns`, shape (n, p).

    With `weights`, shape (n,), the rows of both are multiplied by them, and the residual is.

    A column that is itself read with `noise` of variance :math:`\sigma_x^2` in m of its samples
    pulls its coefficient towards zero. Its Gram matrix is freed of that (W. A. Fuller, *Measurement
    Error Models*, 1987, section 2.2):

    .. math:: \hat\beta = (A^T A - m\,\sigma_x^2\, e e^T)^{-1} A^T y, \qquad
              C = \sigma^2 \kappa\,(A^T A - m\,\sigma_x^2\, e e^T)^{-1}

    with :math:`\sigma^2 \kappa` the power of the residuals by
    :func:`~dashpot.numerics.inference.correlated_noise.estimate_noise`.

    Parameters
    ----------
    columns : array, shape (n, p)
        The coefficient of one that is 0 is 0.
    values : array, shape (n,)
    weights : array, shape (n,), optional
    noisy : int, optional
        Index of the column that is read with noise, in its rows that are not 0.
    noise : float
        Standard deviation of that.

    Raises
    ------
    DataError
        If the columns cannot be distinguished.
    """
    variance = 0.0 if noisy is None else float(noise) ** 2
    weight = 0.0
    if noisy is not None:
        rows = columns[:, noisy] != 0
        weight = float(np.count_nonzero(rows) if weights is None else (weights[rows] ** 2).sum())
    if weights is not None:
        columns, values = columns * weights[:, None], values * weights
    scale = np.sqrt((columns**2).sum(axis=0))
    scale[scale == 0] = 1.0
    scaled_columns = columns / scale
    basis, triangle = np.linalg.qr(scaled_columns)
    gram = triangle.T @ triangle
    if noisy is not None:
        gram[noisy, noisy] -= weight * variance / scale[noisy] ** 2
    is_empty = ~columns.any(axis=0)
    gram[is_empty, is_empty] = 1.0
    if np.linalg.eigvalsh(gram)[0] < _MIN_EIGENVALUE:
        raise DataError(
            "a blank test does not determine the machine: its motion and its time cannot be "
            "distinguished. Record a rest, a ramp and a hold"
        )
    inverse = np.linalg.inv(gram)
    scaled_values = inverse @ (scaled_columns.T @ values)
    residual = values - scaled_columns @ scaled_values
    residual_noise = estimate_noise(residual, basis)
    errors = np.sqrt(residual_noise.power * np.diag(inverse))
    return Regression(scaled_values / scale, errors / scale, residual, residual_noise)


def estimate_press(record: BlankTest, *, spring: bool = False) -> Press:
    """Return the estimates from a press against a stop or a spring.

    Parameters
    ----------
    record : BlankTest
        A plate that comes from a rest, presses in one ramp, and holds.
    spring : bool
        A spring may be held from the first sample on: where the contact that the ramp shows is at
        the rest, within its error, it is, and the rest determines the delay as well.

    Raises
    ------
    DataError
        If there is no ramp and hold, or nothing was pressed.
    """
    history = read_press_history(record)
    fit, shift, ramp_time, columns, weights = _solve_press(history)
    has_offset = len(fit.values) > _OFFSET_COLUMN
    if spring and has_offset and abs(fit.values[0]) <= _GAP_ERRORS * fit.errors[0]:
        history, rest_error = _measure_from_rest(history)
        fit, shift, ramp_time, columns, weights = _solve_press(history, rests_at_contact=True)
        contact = (columns[:, 1] != 0).astype(float)
        effect = fit.values[1] * solve_regression(columns, contact, weights).values
        fit = fit._replace(errors=np.hypot(fit.errors, effect * rest_error))
    n, stiffness = len(history.time), float(fit.values[1])
    motion = _shift_motion(history, shift)
    response = fit.values[0] + stiffness * motion
    response += fit.values[2] * _compute_settlement(history, ramp_time, shift)
    model = fit.values[3] * history.time + np.maximum(response, 0.0)
    model += fit.values[_OFFSET_COLUMN] if len(fit.values) > _OFFSET_COLUMN else 0.0
    fitted_force, samples = (
        np.full(n, np.nan),
        np.concatenate((history.samples_before_contact, history.samples_under_load)),
    )
    fitted_force[samples] = model[samples]
    curvature = _estimate_curvature(history, columns, response, weights)
    relative_errors = fit.errors / stiffness
    return Press(
        RigEstimate(stiffness, float(fit.errors[1])),
        RigEstimate(float(fit.values[2]) / stiffness, float(relative_errors[2])),
        RigEstimate(shift, float(relative_errors[_DELAY_COLUMN])),
        RigEstimate(float(fit.values[3]), float(fit.errors[3])),
        history.peak,
        ramp_time,
        float(history.time[history.hold_end - 1]) - history.ramp_end,
        float(np.sqrt(fit.noise.autocovariance[0])) / float(weights[-1]),
        _measure_misfit(fit.residual, fit.noise) / float(weights[-1]) / history.peak,
        RigEstimate(curvature.value / history.peak, curvature.error / history.peak),
        _measure_hysteresis(history, model),
        fitted_force,
        history.force,
    )


class PressHistory(NamedTuple):
    """One press, its channels rising as the plate presses.

    Attributes
    ----------
    time, displacement, speed, force : array, shape (n,)
        s from the first sample, m, m/s, and N from its rest.
    samples_before_contact, samples_under_load : array of int
        Samples before contact, and samples under load to the end of the hold.
    last_free_sample, hold_end : int
        Last sample before contact, and the one after the hold.
    ramp_end, peak : float
        End of the ramp, s, and the largest force, N.
    noise, displacement_noise : float
        Scatter of the readings, N and m.
    """

    time: FloatArray
    displacement: FloatArray
    speed: FloatArray
    force: FloatArray
    samples_before_contact: IndexArray
    samples_under_load: IndexArray
    last_free_sample: int
    hold_end: int
    ramp_end: float
    peak: float
    noise: float
    displacement_noise: float


def read_press_history(record: BlankTest) -> PressHistory:
    """Return the samples of rest, contact, ramp and hold of a record.

    Raises
    ------
    DataError
        If there is no ramp and hold, or nothing was pressed.
    """
    time = record.time - record.time[0]
    x, force = orient_channels(record)
    ramp, end = _find_ramp_and_hold(record, time, x)
    noise, hold = scatter(time, force), slice(ramp, end)
    force = force - hum_lines(time, force[hold], hold, noise=noise)[1]
    peak = float(np.quantile(force[:end], 1 - _PEAK_SHARE))
    first = _find_contact(force[:end], noise, peak)
    guard = 0.02 * float(time[first])
    samples_before_contact = np.flatnonzero(time < time[first] - guard)
    loaded_indices = np.flatnonzero(force[:end] > MIN_LOADED_SHARE * peak)
    loaded_indices = loaded_indices[loaded_indices > first]
    if len(loaded_indices) < _MIN_COUNT:
        raise DataError(
            f"{name_record(record)}: {len(loaded_indices)} samples are loaded; expected "
            f"{_MIN_COUNT} or more. Press further, or sample faster"
        )
    speed = compute_speed(time, x, _choose_speed_span(time, x, first, ramp))
    return PressHistory(
        time, x, speed, force, samples_before_contact, loaded_indices, first, end,
        float(time[ramp]), peak, max(noise, 1e-12), scatter(time, x),
    )  # fmt: skip


def name_record(record: BlankTest) -> str:
    """Return the name of a record: its file."""
    return record.source.file if record.source is not None else "the record"


def orient_channels(record: BlankTest) -> tuple[FloatArray, FloatArray]:
    """Return displacement and force, both rising as the plate presses, from their rest."""
    count = max(len(record.time) // 50, 1)
    force = remove_spikes(record.time, record.force)
    force = force - median(force[:count])
    force = force if force[np.argmax(np.abs(force))] >= 0 else -force
    x = record.displacement - median(record.displacement[:count])
    is_loaded = force > 0.5 * force.max()
    if is_loaded.all() or not is_loaded.any():
        return x, force
    return (x if float(x[is_loaded].mean()) >= float(x[~is_loaded].mean()) else -x), force


def _find_ramp_and_hold(record: BlankTest, time: FloatArray, x: FloatArray) -> tuple[int, int]:
    """Return the sample at which the plate stops, and that after its hold."""
    segments = find_segments(time, x)
    hold_segments = [
        part
        for i, part in enumerate(segments)
        if part.kind == "hold" and i and segments[i - 1].kind == "load"
    ]
    if not hold_segments:
        raise DataError(
            f"{name_record(record)}: found no ramp with a hold after it. Press the stop or the "
            "spring in one ramp, and hold"
        )
    hold = max(hold_segments, key=lambda part: (part.level, part.duration))
    return hold.first, hold.last if hold.last < len(time) - 1 else len(time)


def _find_contact(force: FloatArray, noise: float, peak: float) -> int:
    """Return the last sample before the force leaves its baseline for good."""
    loaded_index = int(np.argmax(force > 0.5 * peak))
    unloaded_indices = np.flatnonzero(force[:loaded_index] < max(8 * noise, _CONTACT_SHARE * peak))
    return int(unloaded_indices[-1]) if len(unloaded_indices) else 0


def _choose_speed_span(time: FloatArray, x: FloatArray, first: int, ramp: int) -> int:
    """Return over how many samples either way the speed of a ramp stands out of its noise."""
    samples, travel = max(ramp - first, 1), abs(float(x[ramp] - x[first]))
    min_samples = _SPEED_OVER_NOISE * scatter(time, x) / np.sqrt(2) * samples / max(travel, 1e-12)
    return int(np.clip(max(min_samples, _MIN_SPAN * samples), 1, max(_LARGEST_SPAN * samples, 1)))


def compute_speed(time: FloatArray, x: FloatArray, half_span: int) -> FloatArray:
    """Return the speed over `half_span` samples either way, m/s; 0 where it is within noise."""
    padded_values = np.pad(x, half_span, mode="edge")
    clock = np.pad(time, half_span, mode="reflect", reflect_type="odd")
    span = clock[2 * half_span :] - clock[: -2 * half_span]
    speed = (padded_values[2 * half_span :] - padded_values[: -2 * half_span]) / span
    noise = 5 * np.sqrt(2) * scatter(time, x) / span
    return np.where(np.abs(speed) > noise, speed, 0.0)


def _shift_motion(history: PressHistory, delay: float) -> FloatArray:
    """Return the displacement at the time of each sample less the delay, s, in m."""
    return np.interp(history.time - delay, history.time, history.displacement)


def _measure_from_rest(history: PressHistory) -> tuple[PressHistory, float]:
    r"""Return the history with its displacement from the rest, and the standard error of that, m.

    The rest is the median of the n samples before contact: :math:`\sigma_x \sqrt{\pi/2n}`.
    """
    rest_position = median(history.displacement[history.samples_before_contact])
    error = history.displacement_noise * np.sqrt(np.pi / (2 * len(history.samples_before_contact)))
    return history._replace(displacement=history.displacement - rest_position), float(error)


def _compute_noise_share(history: PressHistory, delay: float) -> float:
    """Return the noise of a displacement interpolated at a delay, relative to that of a reading."""
    delay_fraction = delay / float(np.median(np.diff(history.time))) % 1.0
    return float(np.hypot(delay_fraction, 1 - delay_fraction))


def _compute_settlement(history: PressHistory, ramp_time: float, delay: float) -> FloatArray:
    """Return how far the crosshead has settled, for 1 m in a factor e of time."""
    time_since_stop = np.maximum(history.time - delay - history.ramp_end, 0.0)
    return np.log1p(time_since_stop / ramp_time)


class _PressFit(NamedTuple):
    """Fit at its delay, s, with its ramp time since contact, s, columns and weights."""

    fit: Regression
    delay: float
    ramp_time: float
    columns: FloatArray
    weights: FloatArray


def _solve_press(history: PressHistory, *, rests_at_contact: bool = False) -> _PressFit:
    """Return the fit at the delay that it finds.

    Samples under load also have the noise of the displacement times K. With `rests_at_contact`
    the contact is held at the rest of the plate, and its column is zero.
    """
    samples, baseline_count = (
        np.concatenate((history.samples_before_contact, history.samples_under_load)),
        len(history.samples_before_contact),
    )
    contact = np.ones(len(samples))
    contact[:baseline_count] = 0.0
    offset = [np.ones(len(samples))] if baseline_count >= _MIN_COUNT else []
    shift, ramp_time = (
        0.0,
        max(history.ramp_end - float(history.time[history.last_free_sample]), 1e-6),
    )
    loaded_span = slice(history.last_free_sample, int(history.samples_under_load[-1]) + 1)
    stiffness = history.peak / max(float(np.ptp(history.displacement[loaded_span])), 1e-12)
    for i in range(_MAX_SHIFTS):
        speed = np.interp(history.time - shift, history.time, history.speed)
        columns = np.column_stack((
            0.0 * contact if rests_at_contact else contact,
            contact * _shift_motion(history, shift)[samples],
            contact * _compute_settlement(history, ramp_time, shift)[samples],
            history.time[samples],
            contact * speed[samples],
            *offset,
        ))  # fmt: skip
        noise = history.displacement_noise * _compute_noise_share(history, shift)
        loaded_noise = np.hypot(history.noise, stiffness * noise)
        weights = np.where(contact > 0, 1 / loaded_noise, 1 / history.noise)
        fit = solve_regression(columns, history.force[samples], weights, noisy=1, noise=noise)
        stiffness = float(fit.values[1])
        if not stiffness > 0:
            raise DataError(
                "the force does not rise with the displacement. Check the columns of the blank "
                "tests, and their signs"
            )
        step = -float(fit.values[_DELAY_COLUMN]) / stiffness
        if abs(step) < _DELAY_TOLERANCE and i:
            break
        shift += step
        ramp_time = _measure_ramp_time(history, -float(fit.values[0]) / stiffness, ramp_time)
    return _PressFit(fit, shift, ramp_time, columns, weights)


def _measure_ramp_time(history: PressHistory, contact: float, previous: float) -> float:
    """Return the time from the contact at a displacement, m, to the end of the ramp, s."""
    ramp = slice(0, int(np.searchsorted(history.time, history.ramp_end)) + 1)
    unloaded_indices = np.flatnonzero(history.displacement[ramp] < contact)
    if not len(unloaded_indices):
        return previous
    return max(history.ramp_end - float(history.time[unloaded_indices[-1]]), 1e-6)


def _estimate_curvature(
    history: PressHistory, columns: FloatArray, force: FloatArray, weights: FloatArray
) -> RigEstimate:
    """Return by how much the force at half the load lies off the straight line, N."""
    samples = np.concatenate((history.samples_before_contact, history.samples_under_load))
    load = np.clip(force[samples] / history.peak, 0.0, 1.5) * (columns[:, 1] != 0)
    fit = solve_regression(
        np.column_stack((columns, 4 * load * (1 - load))), history.force[samples], weights, noisy=1,
        noise=history.displacement_noise,
    )  # fmt: skip
    return RigEstimate(float(fit.values[-1]), float(fit.errors[-1]))


def _measure_misfit(residual: FloatArray, noise: Noise) -> float:
    """Return the largest mean of neighbouring residuals beyond chance, N."""
    count = max(len(residual) // _MISFIT_BLOCKS, 1)
    means = np.abs(block_means(residual, count))
    return max(float(means.max()) - _CHANCE_ERRORS * float(np.sqrt(noise.power / count)), 0.0)


def _measure_hysteresis(history: PressHistory, model: FloatArray) -> float:
    """Return the unloading force less that of the model at half the load, over the peak."""
    is_return = np.arange(len(model)) >= history.hold_end
    is_half_loaded = is_return & (model > 0.3 * history.peak) & (model < 0.7 * history.peak)
    if np.count_nonzero(is_half_loaded) < 5:
        return float("nan")
    return float((history.force[is_half_loaded] - model[is_half_loaded]).mean()) / history.peak


def estimate_empty_run(record: BlankTest) -> EmptyRun:
    """Return noise, drift, hum and motion force from a run without a specimen."""
    time = record.time - record.time[0]
    force = remove_spikes(record.time, record.force)
    force = force - median(force)
    x = record.displacement - median(record.displacement)
    columns = [np.ones(len(time)), time]
    is_moving = float(np.ptp(x)) > _MOTION_OVER_NOISE * max(scatter(time, x), 1e-12)
    half_span = max(len(time) // 500, 1)
    speed = compute_speed(time, x, half_span) if is_moving else np.zeros(len(time))
    motions = []
    if is_moving:
        acceleration = np.gradient(speed, time)
        motions = [column for column in (x, speed, acceleration) if np.ptp(column) > 0]
    first_fit = solve_regression(np.column_stack((*columns, *motions)), force)
    lines, _, _ = hum_lines(
        time, first_fit.residual, slice(0, len(time)), noise=scatter(time, first_fit.residual)
    )
    frequency = lines[0].frequency if lines else _find_mains(time, first_fit.residual)
    phase = 2 * np.pi * frequency * time
    other_hum = [
        line(2 * np.pi * hum.frequency * time) for hum in lines[1:] for line in (np.cos, np.sin)
    ]
    fit = solve_regression(
        np.column_stack((*columns, *motions, np.cos(phase), np.sin(phase), *other_hum)), force
    )
    hum_column = len(columns) + len(motions)
    hum = float(np.hypot(*fit.values[hum_column : hum_column + 2]))
    by_motion = np.zeros(len(time))
    if motions:
        by_motion = np.column_stack(motions) @ fit.values[2 : 2 + len(motions)]
    errors = [
        float(np.abs(column).max()) * float(error)
        for column, error in zip(motions, fit.errors[2:], strict=False)
    ]
    noise = float(np.sqrt(fit.noise.autocovariance[0]))
    if not noise > 0:
        raise DataError(
            "the force is the same in every row, so neither noise nor drift shows: its resolution "
            "is coarser than both. Leave the file out, or record the force with more digits"
        )
    return EmptyRun(
        RigEstimate(noise, noise * _compute_relative_error(fit.noise)),
        RigEstimate(float(fit.values[1]), float(fit.errors[1])),
        RigEstimate(hum, float(fit.errors[hum_column : hum_column + 2].max())),
        frequency if lines else float("nan"),
        float(np.abs(by_motion - median(by_motion)).max()),
        float(np.linalg.norm(errors)),
        _measure_wander(speed) if is_moving else 0.0,
        float(block_means(fit.residual, max(len(time) // _SLOW_BLOCKS, 1)).std()),
        np.column_stack((*columns, *motions)) @ fit.values[:hum_column],
        force,
    )


def _find_mains(time: FloatArray, residual: FloatArray) -> float:
    """Return the frequency near the mains at which the residual has most, Hz."""
    step = float(time[-1] - time[0]) / (len(time) - 1)
    padded = 4 * len(time)
    power = np.abs(np.fft.rfft(residual, padded)) ** 2
    frequency = np.fft.rfftfreq(padded, step)
    bands = [np.abs(frequency - mains) <= _MAINS_SEARCH for mains in MAINS_FREQUENCIES]
    mask = np.logical_or.reduce(bands)
    if not mask.any():
        return float(frequency[len(frequency) // 2])
    return float(frequency[mask][np.argmax(power[mask])])


def _compute_relative_error(noise: Noise) -> float:
    r"""Return the relative standard error of a standard deviation.

    That of n samples with autocorrelations :math:`\rho_l` is
    :math:`\sqrt{(1 + 2\sum\rho_l^2)/2n}` (Bartlett).
    """
    rho = noise.autocovariance[1:] / noise.autocovariance[0]
    return float(np.sqrt((1 + 2 * float(rho @ rho)) / (2 * noise.samples)))


def _measure_wander(speed: FloatArray) -> float:
    """Return the fraction of a record in which the plate neither rests nor moves steadily."""
    ratio = np.abs(speed) / max(float(np.abs(speed).max()), 1e-300)
    return float(np.mean((ratio > _REST_SPEED) & (ratio < _TRAVEL_SPEED)))
