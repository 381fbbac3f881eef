"""Reader of blank tests: a stop, a spring or an empty run as a testing machine records them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dashpot.extensions.blank_tests.datamodel import BlankTest, Role
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.relaxation import load_signals, moving_columns


def read_blank_test(
    path: str | Path, *, options: ReadOptions | None = None, role: Role = ""
) -> BlankTest:
    """Return the blank test in a file, in SI units.

    Parameters
    ----------
    path : path
        Time, displacement and force, as of a relaxation test.
    options : ReadOptions, optional
        Reading options of the file.
    role : "stop", "spring", "empty" or ""
        Pressed object; by default the record shows it.

    Raises
    ------
    ReadError
        If the file cannot be read, or does not determine its columns and units.
    """
    with channels.open_file(path, options) as file:
        channels.refuse_summary(file)
        channels_chosen, clocks = moving_columns(file)
        # sizes are those of no seal: the reader of its tests would doubt the units
        values, notes = load_signals(file, channels_chosen, clocks)
        source = channels.make_source(file, [channel.message for channel in channels_chosen], notes)
    time, displacement, force = (values[name] for name in ("time", "displacement", "force"))
    return BlankTest(time, displacement, force, role, source, units="SI")


def read_stated_role(
    path: str | Path, options: dict[str, Any], choices: Mapping[str, Any]
) -> BlankTest:
    """Return a blank test whose role may be stated: ``dp.read(path, kind="blank", role=...)``."""
    return read_blank_test(path, role=choices.get("role", ""), **options)
