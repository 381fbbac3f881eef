"""Channels that were sampled at several rates, on one clock."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.provenance import Caution
from dashpot.reading.columns import vocabulary

_TEST_ROLES = {"force", "displacement", "acceleration", "velocity", "stress", "strain"}
_TIME_TOLERANCE = 1e-6
"""Difference below which instants count as equal, in steps."""


class SampledChannel(NamedTuple):
    """Channel with the instants of its samples, s."""

    name: str
    time: FloatArray
    values: FloatArray

    @property
    def step(self) -> float:
        """Mean time between its samples, s."""
        return float((self.time[-1] - self.time[0]) / max(len(self.time) - 1, 1))


def interpolate_to_slowest(channels: Sequence[SampledChannel], notes: list[str]) -> FloatArray:
    """Return channels of several rates as rows at the instants of the slowest one of the test.

    The first column is the time. The instants of a faster channel are not used: linear
    interpolation of the slow one would add samples that were not recorded. Channels of the test are
    those named for a load or a motion.

    Raises
    ------
    ReadError
        If no channel is named so, or they do not overlap in time.
    """
    steps_text = ", ".join(f"'{channel.name}' {channel.step:.6g} s" for channel in channels[:6])
    test_channels = [c for c in channels if not _TEST_ROLES.isdisjoint(vocabulary.matches(c.name))]
    if not test_channels:
        raise ReadError(
            f"channels are sampled at different steps ({steps_text}); export them at one rate"
        )
    slowest = max(test_channels, key=lambda channel: channel.step)
    margin = _TIME_TOLERANCE * slowest.step
    start = max(float(c.time[0]) for c in test_channels) - margin
    end = min(float(c.time[-1]) for c in test_channels) + margin
    time = slowest.time[(slowest.time >= start) & (slowest.time <= end)]
    if len(time) < 2:
        raise ReadError("the channels do not overlap in time, by their start times and steps")
    message = (
        f"the channels are sampled at different steps ({steps_text}): they were interpolated to "
        f"the {len(time)} common instants of '{slowest.name}'"
    )
    # linear interpolation attenuates frequencies near half the sampling rate
    has_acceleration = any(
        vocabulary.matches(c.name).get("acceleration", 0.0) >= vocabulary.MIN_SCORE
        for c in channels
    )
    notes.append(Caution(message) if has_acceleration else message)
    columns = [np.interp(time, c.time, c.values, left=np.nan, right=np.nan) for c in channels]
    return np.array([time, *columns]).T
