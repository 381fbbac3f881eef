"""Contacts in a record: runs of samples in which the indenter is pushed back."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.base.errors import DataError
from dashpot.extensions.materials.indentation.datamodel import IndentationTest

_DERIVATIVES = {"acceleration": 0, "force": 0, "velocity": 1, "displacement": 2}
"""Number of differentiations that turn a record into the push."""
_CONTACT_RATIO = 25.0
"""Smallest ratio of peak to scatter of a contact."""
_OTHER_CONTACT_SHARE = 0.1
"""Part of the largest push that makes another contact."""
_WIDTH_LEVEL = 0.25
"""Part of the push at which its width is taken."""
_FOOT_WIDTH = 0.84
"""Width of a half sine at that height, over its whole width."""
_MIN_COUNT = 6


class ContactInterval(NamedTuple):
    """Approximate interval of the largest contact of a record.

    Attributes
    ----------
    sign : float
        Sign that makes a push from the surface positive.
    start, duration : float
        s.
    contacts_before, contacts_after : int
        Numbers of earlier and later contacts.
    """

    sign: float
    start: float
    duration: float
    contacts_before: int
    contacts_after: int


def largest_contact(test: IndentationTest) -> ContactInterval:
    """Return the contact with the largest push.

    Raises
    ------
    DataError
        If no pulse exceeds the noise.
    """
    push, width = _compute_push(test)
    # a record may be cut so close that most of it is contact, or begin in one
    tenth = max(len(push) // 10, 1)
    rest_level = min((median(push), median(push[:tenth]), median(push[-tenth:])), key=abs)
    sign = 1.0 if push.max() - rest_level >= rest_level - push.min() else -1.0
    push = sign * (push - rest_level)
    peak_index = int(push.argmax())
    scatter = 1.4826 * median(np.abs(push))
    if not push[peak_index] > 5 * scatter:
        raise DataError(
            f"no contact stands out of the scatter of the {test.quantity}: its largest change is "
            f"{push[peak_index]:.3g}, its scatter {scatter:.3g}; cut the record about the contact, "
            "or record it with less noise"
        )
    runs = _find_runs(push > _WIDTH_LEVEL * push[peak_index])
    start, end = next(run for run in runs if run[0] <= peak_index < run[1])
    width_ratio = max((end - start) - 0.5 * width, 2.0) * test.step / _FOOT_WIDTH
    if end - start < _MIN_COUNT:
        raise DataError(
            f"the contact has {end - start} samples above a quarter of its peak; expected "
            f"{_MIN_COUNT} or more: sample {8 * _MIN_COUNT / max(end - start, 1):.0f} times as fast"
        )
    middle = test.time[0] + 0.5 * (start + end - 1) * test.step
    level = max(_OTHER_CONTACT_SHARE * push[peak_index], 8 * scatter)
    other_runs = [run for run in _find_runs(push > level) if run[1] - run[0] >= 3]
    gap = 0.5 * width_ratio / test.step
    return ContactInterval(
        sign,
        middle - 0.5 * width_ratio,
        width_ratio,
        sum(run[1] < start - gap for run in other_runs),
        sum(run[0] > end + gap for run in other_runs),
    )


def _compute_push(test: IndentationTest) -> tuple[FloatArray, int]:
    """The record, or its derivative, smoothed over the fewest samples that show the contact."""
    best, clearest = (test.signal, 1), 0.0
    for power in range(max(int(np.log2(len(test.time) / 8)), 1)):
        width = 2**power
        push = test.signal.astype(float)
        for _ in range(_DERIVATIVES[test.quantity]):
            push = np.gradient(_apply_moving_average(push, width))
        push = _apply_moving_average(push, width)
        # beyond its ends a record is not known
        edge = min(width * (_DERIVATIVES[test.quantity] + 1), len(push) // 4) if width > 1 else 0
        push[:edge], push[len(push) - edge :] = push[edge], push[-edge - 1]
        deviation = np.abs(push - median(push))
        peak_over_noise = float(deviation.max()) / max(
            1.4826 * median(deviation), 1e-12 * float(deviation.max()), 1e-300
        )
        if peak_over_noise > clearest:
            best, clearest = (push, width), peak_over_noise
        if peak_over_noise > _CONTACT_RATIO:
            break
    return best


def _apply_moving_average(values: FloatArray, width: int) -> FloatArray:
    if width < 2:
        return values
    padded_values = np.pad(values, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded_values, np.full(width, 1 / width), mode="valid")


def _find_runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """First and one past the last of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(int)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
