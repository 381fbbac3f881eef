"""Input tests of a fit: prepared, distinct, with their depths and temperatures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray, median
from dashpot.base.errors import FitError
from dashpot.base.provenance import Step
from dashpot.base.units import celsius
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.shift_factors import SAME_TEMPERATURE
from dashpot.fitting.nuisance_priors import build_load_cell_priors
from dashpot.preprocessing.checks import earlier_loading_negligible
from dashpot.preprocessing.prepare import prepare

# Ramps and holds of the given tests.


Tests: TypeAlias = RampHold | RelaxationTest | Sequence[RampHold | RelaxationTest]
"""One or several tests, prepared or as they were read."""

DEPTH_TOLERANCE = 0.02
"""Depths that differ by less, relative, are one."""
DEFAULT_STEP = Step("by_default", (), "prepared by default: the fit was given the record as read")


def ramp_holds(tests: Tests) -> tuple[RampHold, ...]:
    """Return one or several tests, prepared; the changes of a record as read are in its steps.

    Raises
    ------
    FitError
        If one of them is no relaxation test.
    DataError
        If one cannot be prepared as it is.
    """
    if isinstance(tests, RampHold | RelaxationTest):
        tests = (tests,)
    return tuple(_prepare_test(test) for test in tests)


def split_depths(test: RelaxationTest, **options: Any) -> tuple[RampHold, ...]:
    """Return the loadings of one record that hold, one to a depth, each as a record of its own.

    Of several to one depth the one with the longest hold. The effect of earlier loadings on later
    ones is neglected, and a check states its size.

    Parameters
    ----------
    test : RelaxationTest
    options
        As :func:`~dashpot.preprocessing.prepare.prepare` takes it, without a cycle.
    """
    chosen_record = prepare(test, **options)
    parameters = next(
        dict(step.parameters) for step in chosen_record.steps if step.name == "segments"
    )
    cycle_count = int(parameters["cycle"].partition(" of ")[2])
    cycle_records = (
        [prepare(test, **options, cycle=number) for number in range(1, cycle_count + 1)]
        if cycle_count > 1
        else []
    )
    records: list[RampHold] = []
    for ramp_hold in sorted(cycle_records, key=lambda record: -record.hold_time):
        if all(
            abs(ramp_hold.depth / earlier_record.depth - 1) > DEPTH_TOLERANCE
            for earlier_record in records
        ):
            records.append(ramp_hold)
    if len(records) < 2:
        return (chosen_record,)
    return tuple(
        map(_isolate_loading, sorted(records, key=lambda record: record.time[record.start]))
    )


def _isolate_loading(record: RampHold) -> RampHold:
    """Return a loading without its history, and the check of the error by this.

    Of a seal that has not recovered the way from where it was met is taken for that from first
    contact: as long, in proportion.
    """
    if record.loading_start is None:
        return record
    contact_index = int(np.searchsorted(record.time, record.onset))
    last_loading = record.last_loading
    if last_loading.plate is None:
        ratio = float(record.force[max(contact_index - 1, 0)]) / float(record.force.max())
    else:
        contact_displacement = float(record.displacement[max(contact_index - 1, 0)])
        ratio = contact_displacement / record.depth
        compression = np.maximum(last_loading.plate - contact_displacement, 0.0) / (1 - ratio)
        last_loading = replace(last_loading, displacement=compression, plate=None)
    return replace(last_loading, checks=(*record.checks, earlier_loading_negligible(ratio)))


def _prepare_test(test: object) -> RampHold:
    if isinstance(test, RampHold):
        return test
    if not isinstance(test, RelaxationTest):
        raise FitError(
            f"a fit takes relaxation tests, prepared or as read, found a {type(test).__name__}"
        )
    prepared = prepare(test)
    return replace(prepared, steps=(DEFAULT_STEP, *prepared.steps))


# Temperatures of tests, and the reference temperature.


# Standard laboratory temperature of rubber tests, K; the test nearest to it is the reference.
STANDARD_TEMPERATURE = 296.15


def list_temperatures(records: Sequence[RampHold]) -> FloatArray:
    """Return the temperatures of tests, K, rising; those of one temperature as their mean.

    Empty unless every test has one.
    """
    values = sorted(
        record.specimen.temperature for record in records if record.specimen.temperature is not None
    )
    if len(values) < len(records):
        return np.zeros(0)
    groups: list[list[float]] = []
    for value in values:
        if groups and value - groups[-1][0] <= SAME_TEMPERATURE:
            groups[-1].append(value)
        else:
            groups.append([value])
    return np.array([float(np.mean(group)) for group in groups])


def checked_temperatures(records: Sequence[RampHold], *, shared: bool) -> FloatArray:
    """Return the temperatures of the tests, K; at most one if all have the same.

    `shared` is True where tests of several may be fitted: by the recorded motion, one solid.

    Raises
    ------
    FitError
        If only some tests have one, or they are to be fitted in a way that knows of none.
    """
    values = [record.specimen.temperature for record in records]
    ramp_holds = [record for record in records if record.specimen.temperature]
    if ramp_holds and None in values:
        kelvin = ramp_holds[0].specimen.temperature or 0.0
        raise FitError(
            f"test {values.index(None) + 1} of {len(values)} has no temperature, where test "
            f"{values.index(kelvin) + 1} is of {celsius(kelvin)}: give one for every file, in "
            "their order, such as --temperature 23degC --temperature 0degC, or one for all of them "
            "(Python: Specimen(temperature=...))"
        )
    temperatures = list_temperatures(records)
    if len(temperatures) < 2:
        return temperatures
    if not shared:
        raise FitError(
            "tests at several temperatures are fitted by the recorded motion, and share their "
            "stiffnesses: leave out --method hold and --elastic by-depth"
        )
    return temperatures


def find_reference_index(temperatures: FloatArray, target: float | None) -> int:
    """Return which temperature, K, is the reference: the one requested, or nearest to 23 degC.

    Raises
    ------
    FitError
        If no test is of the temperature requested.
    """
    magnitude = np.abs(temperatures - (STANDARD_TEMPERATURE if target is None else target))
    if target is not None and magnitude.min() > SAME_TEMPERATURE:
        temperatures_text = ", ".join(celsius(float(value)) for value in temperatures)
        raise FitError(
            f"no test is of the reference temperature {celsius(target)}; expected one of "
            f"{temperatures_text}"
        )
    return int(np.argmin(magnitude))


# Distinct records of one seal.
#
# A record given twice makes every standard error smaller by :math:`\sqrt 2` and adds nothing; two
# lots fitted as one seal give a seal that does not exist.


# Correlation of the noise of two records above which one is a copy: independent noise has
# 1/sqrt(n), a copy of every fourth sample 0.5.
COPY_CORRELATION = 0.3
_MIN_SAMPLES = 400
# samples to a mean: enough to outlive interpolation between other samples
_SAMPLES_PER_MEAN = 4
_SMOOTHING_MEANS = 9
# a line of hum counts for no more than this many times the usual amplitude
_MAX_LINE_RATIO = 3.0
_MAX_LAG = 3
# what is left of a record without noise is its course, which two tests of one seal share
_MIN_COURSE_RATIO = 3.0


class EndStiffness(NamedTuple):
    """Stiffness of one test at one time after its ramp, N/m, and its standard error."""

    value: float
    sd: float
    depth: float
    temperature: float | None


def refuse_copies(records: Sequence[RampHold]) -> None:
    """Refuse a record given twice, unchanged or resampled.

    Raises
    ------
    FitError
        If two records are of one part of one file, hold equal samples, or scatter alike: the
        noise of two tests is not correlated, whatever the seal.
    """
    for (i, record), (j, other_record) in combinations(enumerate(records, start=1), 2):
        reason = _describe_copy(record, other_record)
        if reason:
            raise FitError(
                f"tests {i} and {j} are one record, {reason}: counted twice it would make every "
                "error look smaller by a factor 1.4; give each record once"
            )


def _describe_copy(first: RampHold, second: RampHold) -> str:
    if first.source is not None and second.source is not None:
        change = max(abs(first.onset - second.onset), abs(first.hold_end - second.hold_end))
        if first.source.sha256 == second.source.sha256 and change < 0.1 * first.ramp_time:
            return f"the same part of {first.source.file}"
    if np.array_equal(first.force, second.force):
        return "sample for sample"
    if abs(first.depth / second.depth - 1) > DEPTH_TOLERANCE:
        return ""
    correlation = noise_correlation(first, second)
    return (
        f"resampled (their noise correlates by {correlation:.2f})"
        if correlation > COPY_CORRELATION
        else ""
    )


def noise_correlation(ramp_hold: RampHold, other_hold: RampHold) -> float:
    """Return the correlation of what two holds scatter about their smooth course, -1 to 1.

    Means over a few samples at equal times after the onset, less their running mean; lines of hum,
    which correlate by their phases alone, are clipped to the usual amplitude. The largest within
    three means of each other's clock; 0 where fewer than 400 means are common, or what is left is
    no noise.
    """
    step = _SAMPLES_PER_MEAN * max(ramp_hold.step, other_hold.step)
    start = max(record.ramp_time for record in (ramp_hold, other_hold)) + _SMOOTHING_MEANS * step
    stop = min(record.hold_end - record.onset for record in (ramp_hold, other_hold))
    if (stop - start) / step < _MIN_SAMPLES:
        return 0.0
    edges = np.arange(start, stop, step)
    residuals = [_compute_means_off_course(record, edges) for record in (ramp_hold, other_hold)]
    if any(
        residual.std() > _MIN_COURSE_RATIO * record.force_noise
        for residual, record in zip(residuals, (ramp_hold, other_hold), strict=True)
    ):
        return 0.0
    first, second = (_compute_clipped_spectrum(residual) for residual in residuals)
    products = np.array([first * second.conj(), np.abs(first) ** 2, np.abs(second) ** 2])
    cross_correlation, pair, other_pairs = np.fft.irfft(products)
    power = float(np.sqrt(pair[0] * other_pairs[0]))
    near_zero_lag = np.concatenate(
        (cross_correlation[: _MAX_LAG + 1], cross_correlation[-_MAX_LAG:])
    )
    return float(near_zero_lag.max()) / power if power > 0 else 0.0


def _compute_means_off_course(record: RampHold, edges: FloatArray) -> FloatArray:
    """Return means of the force between edges, s after the onset, less their running mean."""
    sums = np.concatenate(([0.0], np.cumsum(record.force)))
    edge_indices = np.searchsorted(record.time - record.onset, edges)
    means = np.diff(sums[edge_indices]) / np.maximum(np.diff(edge_indices), 1)
    course = np.convolve(means, np.full(_SMOOTHING_MEANS, 1 / _SMOOTHING_MEANS), mode="same")
    inner = slice(_SMOOTHING_MEANS, -_SMOOTHING_MEANS)
    return np.asarray(means[inner] - course[inner])


def _compute_clipped_spectrum(values: FloatArray) -> ComplexArray:
    # tapered, so that a line of hum stays within a few lines
    spectrum = np.fft.rfft(values * np.hanning(len(values)))
    magnitude = np.abs(spectrum)
    ceiling = _MAX_LINE_RATIO * median(magnitude)
    return np.asarray(spectrum * np.minimum(1.0, ceiling / np.maximum(magnitude, 1e-300)))


def end_stiffnesses(records: Sequence[RampHold]) -> tuple[EndStiffness, ...]:
    r"""Return the stiffness of each test where the shortest hold ends.

    .. math:: k = \frac{F - F_0 - \dot F t}{x_h}

    over the last twentieth of that time, with what offset, drift, depth and noise leave open
    (:func:`~dashpot.fitting.nuisance_priors.build_load_cell_priors`).
    """
    shortest_hold = min(record.hold_time for record in records)
    return tuple(_estimate_end_stiffness(record, shortest_hold) for record in records)


def _estimate_end_stiffness(record: RampHold, time: float) -> EndStiffness:
    time_since_ramp = record.time - record.ramp_end
    is_last = (time_since_ramp >= 0.95 * time) & (time_since_ramp <= time)
    is_last[int(np.searchsorted(time_since_ramp, time)) - 1] = True
    cell_priors = build_load_cell_priors(record)
    time_to_end = record.ramp_end + 0.975 * time - record.time[0] - cell_priors.offset_time
    force = (
        float(record.force[is_last].mean())
        - cell_priors.offset.mean
        - cell_priors.drift.mean * time_to_end
    )
    relative_error = (
        cell_priors.offset.sd,
        cell_priors.drift.sd * time_to_end,
        record.force_noise / np.sqrt(is_last.sum()),
    )
    depth = float(np.hypot(record.depth_error, record.contact_error / record.depth))
    value = force / record.depth
    sd = float(np.hypot(np.linalg.norm(relative_error) / record.depth, value * depth))
    return EndStiffness(value, sd, record.depth, record.specimen.temperature)
