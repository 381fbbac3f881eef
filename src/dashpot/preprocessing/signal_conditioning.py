"""Signal conditioning of a record: filters, hum removal, averaging."""

from __future__ import annotations

from typing import Literal

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    FloatArray,
    block_means,
    compute_single_dft,
    find_fast_length,
    make_cosine_sequence,
    median,
)
from dashpot.base.errors import DataError
from dashpot.base.provenance import Step
from dashpot.base.units import format_quantity, parse_quantity
from dashpot.datamodel.relaxation import Hum, RampHold
from dashpot.signals.clock import is_evenly_sampled
from dashpot.signals.noise import scatter

# Filters.


FILTER_STEP = "filter"
_EXPECTED_FILTER = (
    "expected 'lowpass:10Hz', 'lowpass:10Hz:causal', 'notch:50Hz', 'notch:50Hz:causal' or "
    "'median:5'"
)


@dataclass(frozen=True)
class Filter:
    """Filter of both channels of a record.

    Attributes
    ----------
    kind : str
        ``"lowpass"`` (Butterworth, 2nd order), ``"notch"`` (Q = 10) or ``"median"``.
    cutoff : float
        Hz; 0 for a median.
    window : int
        Samples of a median.
    causal : bool
        Run once, forwards, as a filter in an instrument does; else forwards and backwards,
        which shifts nothing in time.
    """

    kind: Literal["lowpass", "notch", "median"]
    cutoff: float = 0.0
    window: int = 0
    causal: bool = False

    @property
    def linear(self) -> bool:
        """The same linear filter on force and displacement does not change their relation."""
        return self.kind != "median"

    def __str__(self) -> str:
        """Return the filter as the user writes it."""
        if self.kind == "median":
            return f"median:{self.window}"
        return f"{self.kind}:{self.cutoff:g}Hz" + (":causal" if self.causal else "")

    def __call__(self, time: FloatArray, values: FloatArray) -> FloatArray:
        """Return filtered `values`.

        Raises
        ------
        DataError
            If a linear filter meets uneven sampling, or a cut-off above half the rate.
        """
        from scipy import signal

        if self.kind == "median":
            from scipy.ndimage import median_filter

            return np.asarray(median_filter(values, size=self.window, mode="nearest"))
        rate = _require_even_rate(time, self)
        if self.kind == "lowpass":
            sections = signal.butter(2, self.cutoff, fs=rate, output="sos")
        else:
            sections = signal.tf2sos(*signal.iirnotch(self.cutoff, 10.0, fs=rate))
        if not self.causal:
            return np.asarray(signal.sosfiltfilt(sections, values))
        filter_state = signal.sosfilt_zi(sections) * values[0]
        return np.asarray(signal.sosfilt(sections, values, zi=filter_state)[0])


def parse_filter(text: str) -> Filter:
    """Return the filter that `text` names, such as ``"lowpass:10Hz"``.

    >>> str(parse_filter("lowpass:10 Hz"))
    'lowpass:10Hz'

    Raises
    ------
    DataError
        If it names none.
    """
    kind, _, arguments = text.strip().partition(":")
    value, _, mode = arguments.partition(":")
    if (
        kind == "median"
        and not mode
        and value.strip().isdigit()
        and int(value) % 2
        and value != "1"
    ):
        return Filter("median", window=int(value))
    if kind == "lowpass" and mode in {"", "causal"}:
        return Filter("lowpass", cutoff=_cutoff(text, value), causal=bool(mode))
    if kind == "notch" and mode in {"", "causal"}:
        return Filter("notch", cutoff=_cutoff(text, value), causal=bool(mode))
    raise DataError(f"filter '{text}' is not known; {_EXPECTED_FILTER} (a median of odd length)")


def filter_record(test: RampHold, chosen_filter: Filter) -> RampHold:
    """Return the record with both channels filtered; it keeps the unfiltered record, too."""
    step = Step(
        FILTER_STEP,
        (("filter", str(chosen_filter)),),
        f"both channels are filtered by {chosen_filter}",
    )
    return replace(
        test,
        force=chosen_filter(test.time, test.force),
        displacement=chosen_filter(test.time, test.displacement),
        machine_deflection=None
        if test.machine_deflection is None
        else chosen_filter(test.time, test.machine_deflection),
        unfiltered=test,
        steps=(*test.steps, step),
    )


def get_record_filter(test: RampHold) -> Filter | None:
    """Return the filter that was applied to a record; None if there was none."""
    for step in test.steps:
        if step.name == FILTER_STEP:
            return parse_filter(dict(step.parameters)["filter"])
    return None


def _cutoff(text: str, value: str) -> float:
    try:
        cutoff = parse_quantity(value, "frequency")
    except DataError as error:
        raise DataError(f"filter '{text}': {error}; {_EXPECTED_FILTER}") from None
    if cutoff <= 0:
        raise DataError(f"filter '{text}': the cut-off must be above 0 Hz; {_EXPECTED_FILTER}")
    return cutoff


def _require_even_rate(time: FloatArray, chosen_filter: Filter) -> float:
    steps = np.diff(time)
    usual_step = median(steps)
    step_index = int(np.argmax(np.abs(steps - usual_step)))
    if abs(steps[step_index] - usual_step) > 0.2 * usual_step:
        raise DataError(
            f"{chosen_filter} needs even sampling, but the step after t = {time[step_index]:.6g} s "
            f"is {steps[step_index]:.4g} s where {usual_step:.4g} s is usual; fit the raw record, "
            "or use a median"
        )
    rate = (len(time) - 1) / (time[-1] - time[0])
    if chosen_filter.cutoff >= rate / 2:
        raise DataError(
            f"{chosen_filter} lies above half the sampling rate, {rate / 2:.4g} Hz; give a lower "
            "frequency, or no filter"
        )
    return float(rate)


# Averaging of neighbouring samples in long records.


# Number of samples above which a record is averaged.
MAX_FIT_SAMPLES = 200_000
# and of them at least so many on the ramp
MIN_RAMP_SAMPLES = 500


def decimate(record: RampHold) -> RampHold:
    r"""Average neighbouring samples of a record that is longer than any fit needs.

    A mean over m samples is a filter that commutes with every linear solid,
    :math:`\bar F = K * \bar x`, so the same solid answers the averaged motion with the averaged
    force. Displacement in counts is read at the middle sample instead, where it stays in counts:
    the mean differs from it by :math:`(m h)^2 \ddot x / 24`, h the sampling interval. Arms faster
    than m h are out of reach; no ramp of 500 m samples or more shows them.
    """
    count = _count_neighbours(record)
    if count == 1:
        return record
    time, force = block_means(record.time, count), block_means(record.force, count)
    displacement = record.displacement[count // 2 : count * len(time) : count]
    noise = record.displacement_noise
    late_samples = slice(int(np.searchsorted(time, record.ramp_end + record.hold_time / 10)), None)
    if not record.encoder_step > 0:
        displacement = block_means(record.displacement, count)
        noise = scatter(time[late_samples], displacement[late_samples])
    message = (
        f"averaged each {count} of {len(record.time)} samples, force and displacement alike: "
        "more than a fit needs, and any linear solid answers a mean with a mean"
    )
    return replace(
        record,
        time=time,
        displacement=displacement,
        force=force,
        hold_end=min(record.hold_end, float(time[-1])),
        force_noise=scatter(time[late_samples], force[late_samples]),
        displacement_noise=noise,
        machine_deflection=None
        if record.machine_deflection is None
        else block_means(record.machine_deflection, count),
        plate=None if record.plate is None else block_means(record.plate, count),
        steps=(*record.steps, Step("average", (("samples", str(count)),), message)),
    )


def _count_neighbours(record: RampHold) -> int:
    """Return how many samples to average, an odd number; 1 where averaging does not help."""
    step = float(record.time[-1] - record.time[0]) / (len(record.time) - 1)
    max_neighbours = int(record.ramp_time / step / MIN_RAMP_SAMPLES)
    count = min(len(record.time) // MAX_FIT_SAMPLES, max_neighbours)
    in_counts_of_force = record.machine_deflection is not None and record.encoder_step > 0
    if count < 2 or in_counts_of_force or not is_evenly_sampled(record.time):
        return 1
    return count - 1 + count % 2


# Hum: lines of one frequency in the force, from the mains or the machine, and their aliases.
#
# A line is no noise: it repeats, so it can be known. Over the hold, where the force is smooth, the
# spectrum of the windowed force shows each as a peak far above its neighbourhood, and
#
# .. math:: F_h(t) = a\cos 2\pi f t + b\sin 2\pi f t
#
# follows from the windowed transform at its frequency; the frequency from the turn of its phase
# between the two halves.
#
# A line that the plate has, too, is the answer of the seal to a servo that hunts: it stays, where a
# stiffness explains its size. The mains that both channels pick up are larger than that.


# Ratio of the power of a line and of its neighbourhood; white noise exceeds it once in 1e8.
_MIN_POWER_RATIO = 40.0
# bins of the neighbourhood on either side
_NEIGHBOUR_BINS = 40
# cycles per hold below which a line cannot be distinguished from relaxation
_MIN_CYCLES = 20.0
_MAX_LINES = 8
_MIN_SAMPLES = 400
# a line of the plate, looked for at one frequency, stands out by so much: by chance once in 1e5
_MIN_PLATE_POWER_RATIO = 12.0
# largest ratio of dynamic stiffness and stiffness in the hold
_MAX_STIFFNESS_RATIO = 10.0
# share of the scatter below which a line is negligible
_MIN_LINE_SHARE = 0.02


def hum_lines(
    time: FloatArray,
    force: FloatArray,
    hold_samples: slice,
    *,
    noise: float,
    displacement: FloatArray | None = None,
) -> tuple[tuple[Hum, ...], FloatArray, bool]:
    """Return the lines of a force, the strongest first, and their sum at all times, N.

    And whether the force has lines that are its response to the plate.

    Parameters
    ----------
    time : array, shape (m,)
        s, of the whole record.
    force : array, shape (n,)
        N, over the hold, whose clock is uniform.
    hold_samples : slice
        The hold.
    noise : float
        Scatter of the force from sample to sample, N.
    displacement : array, shape (n,), optional
        m, of the same samples: lines of the force that are its response are no hum.
    """
    n, everywhere, time = len(force), time, time[hold_samples]
    if n < _MIN_SAMPLES or noise == 0:
        return (), np.zeros(len(everywhere)), False
    step = (time[-1] - time[0]) / (n - 1)
    window = _hann(n)
    # a prime number of them takes ten times as long
    bins = find_fast_length(n)
    detrended = _remove_trend(time, force)
    stiffest = 0.0
    if displacement is not None:
        stiffest = _MAX_STIFFNESS_RATIO * abs(force.mean() / (displacement.mean() or np.inf))
    del force  # of a long record each array weighs beside the transform
    hums: list[Hum] = []
    responds = False
    for _ in range(_MAX_LINES):
        windowed = window * detrended
        strongest = _find_strongest_line(
            np.abs(np.fft.rfft(windowed, bins)) ** 2, int(np.ceil(_MIN_CYCLES))
        )
        if strongest is None:
            break
        frequency = _refine_frequency(detrended, step, strongest / (bins * step))
        c = _compute_transform(windowed, step, frequency) * 2 / window.sum()
        line = Hum(frequency, float(c.real), float(-c.imag), float(time[0]))
        if line.amplitude < _MIN_LINE_SHARE * noise:
            break
        if displacement is None or line.amplitude > stiffest * _compute_plate_amplitude(
            _remove_trend(time, displacement), window, step, frequency
        ):
            hums.append(line)
        else:
            responds = True
        detrended -= line.force(time)
    total = np.zeros(len(everywhere))
    for line in hums:
        total += line.force(everywhere)
    return tuple(hums), total, responds


def white_noise(time: FloatArray, values: FloatArray) -> float:
    r"""Return the standard deviation of the white noise of a channel over a hold, lines omitted.

    The median of the power of a windowed spectrum is :math:`\ln 2\,\sigma^2 \sum w^2`, whatever
    lines stand in it.

    Parameters
    ----------
    time, values : array, shape (n,)
        On a uniform clock.
    """
    window = _hann(len(values))
    windowed = window * _remove_trend(time, values)
    power = np.abs(np.fft.rfft(windowed, find_fast_length(len(values)))) ** 2
    return float(np.sqrt(median(power) / np.log(2) / (window @ window)))


def _remove_trend(time: FloatArray, values: FloatArray) -> FloatArray:
    """Return a channel less the straight line between its ends, which leaks most."""
    end_means = [values[:20].mean(), values[-20:].mean()]
    return np.asarray(values - np.interp(time, time[[0, -1]], end_means))


def _compute_plate_amplitude(
    change: FloatArray, window: FloatArray, step: float, frequency: float
) -> float:
    """Return the amplitude of a line of the plate's motion, m; 0 if it is not significant."""
    windowed = window * change
    bins = find_fast_length(len(change))
    power = np.abs(np.fft.rfft(windowed, bins)) ** 2
    peak_bin = round(frequency * bins * step)
    low, high = max(peak_bin - _NEIGHBOUR_BINS, 1), peak_bin + _NEIGHBOUR_BINS + 1
    level = median(power[low:high]) / np.log(2)
    magnitude = abs(_compute_transform(windowed, step, frequency))
    # a motion without noise has lines of rounding alone
    rounding = 1e-12 * float(np.abs(change).max(initial=0.0)) * window.sum()
    is_prominent = magnitude**2 > _MIN_PLATE_POWER_RATIO * level and magnitude > rounding
    return float(2 * magnitude / window.sum()) if is_prominent else 0.0


def hum_step(lines: tuple[Hum, ...]) -> tuple[Step, ...]:
    """Return the processing step that removed hum; None if none was removed."""
    if not lines:
        return ()
    lines_text = ", ".join(
        f"{format_quantity(line.amplitude, 'mN', '.3g')} at {line.frequency:.5g} Hz"
        for line in lines
    )
    parameters = tuple((f"{line.frequency:.6g} Hz", f"{line.amplitude:.6g} N") for line in lines)
    return (Step("hum", parameters, f"hum taken off the force: {lines_text}"),)


def _find_strongest_line(power: FloatArray, first: int) -> int | None:
    """Return the bin that exceeds its neighbourhood most, if it is significant."""
    if len(power) <= first + 2 * _NEIGHBOUR_BINS:
        return None
    blocks = len(power) // _NEIGHBOUR_BINS
    ordered = np.sort(power[: blocks * _NEIGHBOUR_BINS].reshape(blocks, _NEIGHBOUR_BINS), axis=1)
    level = ordered[:, _NEIGHBOUR_BINS // 2]
    # the median of the power of white noise is ln 2 of its mean
    local_level = np.interp(
        np.arange(len(power)), _NEIGHBOUR_BINS * (np.arange(blocks) + 0.5), level / np.log(2)
    )
    power_ratio = power / np.maximum(local_level, 1e-300)
    power_ratio[:first] = 0.0
    power_ratio[-2:] = 0.0
    strongest = int(np.argmax(power_ratio))
    return strongest if power_ratio[strongest] > _MIN_POWER_RATIO else None


def _refine_frequency(remainder: FloatArray, step: float, frequency: float) -> float:
    """Return the frequency at which both halves have the same phase."""
    half_length = len(remainder) // 2
    taper = _hann(half_length)
    for _ in range(3):
        first_half = _compute_transform(taper * remainder[:half_length], step, frequency)
        second_half = _compute_transform(
            taper * remainder[half_length : 2 * half_length], step, frequency
        )
        phase_advance = np.angle(
            second_half * np.conj(first_half) * np.exp(-2j * np.pi * frequency * half_length * step)
        )
        frequency += float(phase_advance) / (2 * np.pi * half_length * step)
    return float(frequency)


def _compute_transform(values: FloatArray, step: float, frequency: float) -> complex:
    return compute_single_dft(values, -2 * np.pi * frequency * step)


def _hann(count: int) -> FloatArray:
    """Hann's window, as numpy.hanning makes it with a cosine for each sample."""
    return 0.5 - make_cosine_sequence(count, 2 * np.pi / (count - 1), 0.5)
