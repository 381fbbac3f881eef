"""Impacts in a record: runs of samples in which the mass is pushed back."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, find_true_runs, median
from dashpot.base.errors import DataError
from dashpot.extensions.materials.drop.datamodel import DropTest

_MIN_IMPACT_FORCE, _FOOT_FORCE = 0.05, 0.15
"""Over the largest force: of another impact, and below which a flank is replaced by a line."""
_MIN_SIGNAL_TO_NOISE = 6.0
"""Ratio of force to noise below which no force is an impact."""
_MIN_SAMPLES = 12
"""Least number of samples of an impact."""
_MARGIN = 0.6
"""Fitted time before and after a contact, in contact times."""
_INTEGRATION_ERROR = 1e-4
"""Error of an integrated motion, over the largest force."""
_THIRD_DIFFERENCE_GAIN = 20**0.5
"""Rms of third differences of unit white noise."""


class RecordedImpact(NamedTuple):
    """One impact of a record.

    Attributes
    ----------
    name : str
    time, force : array, shape (n,)
        Time and force of the samples around it, s from the start of the record; N, positive where
        the mass is pushed back, without the estimated zero.
    contact_start, contact_duration : float
        Estimated time of first contact and contact time, s.
    noise : float
        Noise of the force, N, at least the accuracy of a computed motion.
    time_since_impact : float or None
        Time since the end of the impact before, s.
    impulse_ratio : float or None
        Impulse of the force over mass times that of the acceleration, where both were recorded.
    """

    name: str
    time: FloatArray
    force: FloatArray
    contact_start: float
    contact_duration: float
    noise: float
    time_since_impact: float | None
    impulse_ratio: float | None


def find_impacts(test: DropTest, mass: float, name: str) -> list[RecordedImpact]:
    """Return the impacts of a record in their order.

    Raises
    ------
    DataError
        If none stands out of the noise.
    """
    time, signal = test.time, test.force
    if signal is None:
        assert test.acceleration is not None  # noqa: S101
        signal = mass * test.acceleration
    force = _compute_contact_force(signal)
    noise = _estimate_noise(force)
    peak = float(force.max())
    if not peak > 2 * _MIN_SIGNAL_TO_NOISE * noise:
        raise DataError(
            f"{name}: no impact stands out of the scatter: the largest force is {peak:.3g} N, the "
            f"scatter {noise:.3g} N. Cut the record about the impacts, or use a stiffer sensor"
        )
    impacts: list[RecordedImpact] = []
    contacts = _find_contacts(
        force,
        max(_MIN_IMPACT_FORCE * peak, _MIN_SIGNAL_TO_NOISE * noise),
        _MIN_SIGNAL_TO_NOISE * noise,
    )
    if not contacts:
        raise DataError(
            f"{name}: the longest push has fewer than {_MIN_SAMPLES} samples. Sample faster"
        )
    acceleration = (
        None
        if test.force is None or test.acceleration is None
        else _compute_contact_force(test.acceleration)
    )
    for number, (first, last) in enumerate(contacts):
        length = last - first + 1
        margin = int(_MARGIN * length)
        start = max(first - margin, (contacts[number - 1][1] + first) // 2 if number else 0)
        end = len(force) - 1
        if number + 1 < len(contacts):
            end = min(end, (last + contacts[number + 1][0]) // 2)
        rows = slice(start, min(last + margin, end) + 1)
        contact = slice(first, last + 1)
        impacts.append(
            RecordedImpact(
                f"{name}, impact {number + 1}" if len(contacts) > 1 else name,
                time[rows],
                force[rows],
                float(time[first]),
                length * test.step,
                max(_estimate_noise(force[rows]), _INTEGRATION_ERROR * peak),
                float(time[first] - time[contacts[number - 1][1]]) if number else None,
                None
                if acceleration is None
                else float(force[contact].sum() / (mass * acceleration[contact].sum())),
            )
        )
    return impacts


def _estimate_noise(force: FloatArray) -> float:
    return float(np.std(np.diff(force, 3))) / _THIRD_DIFFERENCE_GAIN


def _compute_contact_force(signal: FloatArray) -> FloatArray:
    """Return the signal less its zero, positive where the specimen pushes the mass back."""
    tenth = max(len(signal) // 20, 1)
    # a record may be cut so close that most of it is contact
    rest_level = min((median(signal), median(signal[:tenth]), median(signal[-tenth:])), key=abs)
    sign = 1.0 if signal.max() - rest_level >= rest_level - signal.min() else -1.0
    return np.asarray(sign * (signal - rest_level))


def _find_contacts(force: FloatArray, threshold: float, least_foot: float) -> list[tuple[int, int]]:
    """Return the first and last sample of each impact, from zero force to zero force."""
    runs: list[tuple[int, int]] = []
    for first, last in find_true_runs(force > threshold).tolist():
        # noise about the threshold breaks a run in two
        if runs and first - runs[-1][1] < max(0.2 * (last - runs[-1][0]), 3):
            runs[-1] = (runs[-1][0], last)
        else:
            runs.append((first, last))
    long_runs = [run for run in runs if run[1] - run[0] + 1 >= _MIN_SAMPLES]
    return [_extend_to_zero_force(force, first, last, least_foot) for first, last in long_runs]


def _extend_to_zero_force(
    force: FloatArray, first: int, last: int, least_foot: float
) -> tuple[int, int]:
    """Return first and last sample of a contact: its flanks are extended by their slope to zero."""
    foot_force = max(_FOOT_FORCE * float(force[first : last + 1].max()), least_foot)
    peak = first + int(force[first : last + 1].argmax())
    unloaded_indices = np.flatnonzero(force <= foot_force)
    first = int(unloaded_indices[unloaded_indices < peak].max(initial=-1)) + 1
    last = int(unloaded_indices[unloaded_indices > peak].min(initial=len(force))) - 1
    span = max((last - first) // 12, 2)
    rising_slope = max((force[first + span] - force[first]) / span, 1e-300)
    falling_slope = max((force[last - span] - force[last]) / span, 1e-300)
    longest = (last - first) // 3
    start = first - min(int(foot_force / rising_slope), longest)
    end = last + min(int(foot_force / falling_slope), longest)
    return max(start, 0), min(end, len(force) - 1)
