"""Strokes in a record of compression and load: sample ranges between turning points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray, distinct
from dashpot.base.errors import DataError

MIN_STROKE = 0.05
"""A stroke shorter than this part of the whole travel is no stroke."""
_LEVELS = 8
"""Steps of a least stroke in which turning points are sought."""


class Stroke(NamedTuple):
    """Samples between two turning points, without the rests at either end.

    Attributes
    ----------
    first, last : int
        Its first and last sample.
    inward : bool
    """

    first: int
    last: int
    inward: bool

    @property
    def samples(self) -> slice:
        """Samples of the stroke in the record."""
        return slice(self.first, self.last + 1)


def get_inward_signs(displacement: FloatArray, force: FloatArray) -> tuple[int, int]:
    """Return the signs that make compression and its force positive.

    Force and compression grow from their first values.

    Raises
    ------
    DataError
        If force or displacement never change.
    """
    if not (np.ptp(displacement) > 0 and np.ptp(force) > 0):
        constant_signal = "displacement" if np.ptp(displacement) == 0 else "force"
        raise DataError(f"the {constant_signal} never changes: no seal was pressed")
    force_change = force - np.median(force[: max(5, len(force) // 50)])
    push = 1 if float(force_change.max()) >= -float(force_change.min()) else -1
    covariance = float(np.cov(displacement, push * force)[0, 1])
    return (1 if covariance >= 0 else -1), push


def find_strokes(x: FloatArray, *, resolution: float) -> tuple[Stroke, ...]:
    """Return the strokes of a compression x, m, of which readings differ by `resolution` at rest.

    A turning point is one from which the compression goes back by a twentieth of the whole
    travel, or four times the resolution. A plate that waits at it belongs to neither stroke.
    """
    min_stroke = max(MIN_STROKE * float(np.ptp(x)), 4 * resolution)
    turns = _find_turning_points(x, min_stroke)
    strokes = []
    for first, last in zip(turns[:-1].tolist(), turns[1:].tolist(), strict=True):
        is_rising = bool(x[last] > x[first])
        part = x[first : last + 1]
        low, high = sorted((float(x[first]), float(x[last])))
        margin = max(resolution, 2e-3 * (high - low))
        begins, end_level = (low, high) if is_rising else (high, low)
        indices = np.flatnonzero(np.abs(part - begins) <= margin)
        last_rest_index = int(indices[-1]) if indices.size else 0
        end_indices = np.flatnonzero(np.abs(part[last_rest_index:] - end_level) <= margin)
        strokes.append(
            Stroke(
                first + last_rest_index, first + last_rest_index + int(end_indices[0]), is_rising
            )
        )
    return tuple(strokes)


def _find_turning_points(x: FloatArray, min_stroke: float) -> IndexArray:
    """Return the first and last sample, and the extremes between, `min_stroke` or more apart."""
    level = np.floor(x / (min_stroke / _LEVELS))
    # few of many samples change the level: the walk below visits those alone
    change_samples = np.union1d(np.flatnonzero(np.diff(level)) + 1, [0, len(x) - 1])
    values = x[change_samples]
    turns, low, high, direction = [], 0, 0, 0
    for i, value in enumerate(values):
        if value > values[high]:
            high = i
        if value < values[low]:
            low = i
        if direction >= 0 and value <= values[high] - min_stroke:
            turns.append(high)
            direction, low = -1, i
        elif direction <= 0 and value >= values[low] + min_stroke:
            turns.append(low)
            direction, high = 1, i
    turns.append(high if direction > 0 else low)
    coarse_indices = change_samples[distinct(np.array(turns))]
    return _refine_turning_points(x, coarse_indices)


def _refine_turning_points(x: FloatArray, coarse_indices: IndexArray) -> IndexArray:
    """Return each turning point at the extreme sample between its neighbours."""
    indices = []
    for i, rough_index in enumerate(coarse_indices):
        first = int(coarse_indices[i - 1]) if i else 0
        last = int(coarse_indices[i + 1]) if i + 1 < len(coarse_indices) else len(x) - 1
        parallel = (
            x[coarse_indices[i - 1] if i else coarse_indices[i + 1]]
            if len(coarse_indices) > 1
            else x[rough_index]
        )
        part = x[first : last + 1]
        indices.append(
            first + int(np.argmax(part) if x[rough_index] >= parallel else np.argmin(part))
        )
    return distinct(np.array(indices))
