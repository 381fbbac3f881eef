"""From a file to a motion: the columns of time and displacement, whatever else it holds."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.datamodel.trajectory import Trajectory
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels


def read_trajectory(path: str | Path, *, options: ReadOptions | None = None) -> Trajectory:
    """Return the motion in a record or in a list of set-points; ``-`` is stdin.

    Rows without a number are left out, and said in the notes of its source.

    Raises
    ------
    ReadError
        If the file cannot be read, or leaves open which column is what or in which unit.
    """
    with channels.open_file(path, options) as file:
        channels.refuse_other_rate(file)
        rate = file.options.rate
        chosen = channels.choose(file, channels.add_time_role(file, "displacement"))
        rows, sentences = channels.select_complete_rows(channels.load_test(file, chosen, 2))
        values = channels.convert_signals_to_si(rows, chosen)
        time = np.arange(len(rows)) / rate if rate else values["time"]
        notes = [*file.table.notes, *sentences]
        source = channels.source(file, [c.says for c in chosen], notes)
        return Trajectory(time, values["displacement"], source=source)
