"""Simulated device that replays the record of a file or of the virtual rig in real time."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from dashpot.base.errors import DataError
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.extensions.acquisition.recorder import COLUMNS, Block, Description
from dashpot.solids.maxwell import GeneralizedMaxwell

BLOCK_PERIOD = 0.05
"""Seconds between two blocks."""


class PacedReplay:
    """Test replayed in real time.

    Parameters
    ----------
    test : RelaxationTest
    device : str
        Stated origin of the record.
    speed : float
        Seconds of the record in a second; infinity for all of it at once.
    """

    def __init__(self, test: RelaxationTest, device: str, *, speed: float = 1.0) -> None:
        if not speed > 0:
            raise DataError(f"speed = {speed!r}; expected a number > 0, such as 10")
        self._time = test.time
        self._values = np.column_stack([convert_to_unit(test.displacement, "mm"), test.force])
        # a flag: a signal's handler must not wait for a lock that its own thread holds
        self._device, self._speed, self._is_stopped = device, speed, False

    def describe(self) -> Description:
        """Return what is played."""
        return Description(self._device, COLUMNS[1:])

    def blocks(self) -> Iterator[Block]:
        """Yield the record's samples when their time has come."""
        start_time, sent_count = time.monotonic(), 0
        while sent_count < len(self._time):
            record_time = self._time[0] + (time.monotonic() - start_time) * self._speed
            sent_end = int(np.searchsorted(self._time, record_time, side="right"))
            yield self._time[sent_count:sent_end], self._values[sent_count:sent_end]
            sent_count = sent_end
            if sent_count < len(self._time):
                time.sleep(BLOCK_PERIOD)
            if self._is_stopped:
                return

    def stop(self) -> None:
        """End the playing within a beat."""
        self._is_stopped = True


def replay(path: str | Path, *, speed: float = 1.0) -> PacedReplay:
    """Return the relaxation test in a file as a device.

    Raises
    ------
    ReadError
        If the file cannot be read.
    """
    from dashpot.reading.readers.relaxation import read_relaxation

    test = read_relaxation(path)
    origin_prefix = "simulated; " if test.source is not None and test.source.simulated else ""
    return PacedReplay(test, f"{origin_prefix}replayed from {Path(path).name}", speed=speed)


def create_simulated_device(
    seal: GeneralizedMaxwell | None = None, *, speed: float = 1.0, seed: int = 0
) -> PacedReplay:
    """Return the virtual rig as a device, at work on a seal: the paper's if none is given."""
    from dashpot.simulation.relaxation import simulate_relaxation
    from dashpot.solids.demo_seals import PAPER

    record = simulate_relaxation(PAPER if seal is None else seal, seed=seed)
    return PacedReplay(
        record.test, "simulated; a virtual indentation rig, not a measurement", speed=speed
    )
