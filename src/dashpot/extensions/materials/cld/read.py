"""Reader of compression load deflection tests: displacement and force, with or without time."""

from __future__ import annotations

from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.cld.datamodel import CLDTest
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels, size_checks
from dashpot.reading.readers.channels import Channel, OpenedFile
from dashpot.reading.readers.header_metadata import add_specimen_temperature
from dashpot.reading.readers.relaxation import signals

_SIGNALS: tuple[Role, Role] = ("displacement", "force")


def read_cld(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> CLDTest:
    """Return the compression load deflection test in a file, in SI units; ``-`` is stdin.

    Parameters
    ----------
    path : path
        Displacement and force of a seal that is pressed and released, once or in cycles; with a
        column of time, or evenly sampled at ``options.rate``, or without a clock.
    options : ReadOptions
        Reading options of the file.
    specimen : Specimen or None
        Tested specimen; its length makes forces those of 100 mm.

    Raises
    ------
    ReadError
        If the file cannot be read, or does not determine its columns and units.
    """
    with channels.open_file(path, options) as file:
        return read_cld_in(file, specimen or Specimen())


def read_cld_in(file: OpenedFile, specimen: Specimen) -> CLDTest:
    """Return the compression load deflection test in an opened file."""
    channels.refuse_summary(file)
    channels.refuse_other_kinds(
        file,
        ["relaxation", "cld"],
        "a compression load deflection (CLD) record is",
        stated_columns=_SIGNALS,
    )
    channels_chosen, values, notes = signals(file, *_SIGNALS)
    if "time" not in values:
        notes.append("the file has no clock: nothing is known of the speed")
    notes += _refuse_sizes(file, channels_chosen, values)
    specimen, sentences = add_specimen_temperature(file, specimen, channels_chosen)
    source = channels.make_source(
        file, [channel.message for channel in channels_chosen], [*notes, *sentences]
    )
    return CLDTest(
        values["displacement"],
        values["force"],
        values.get("time"),
        specimen,
        source,
        units="SI",
    )


def _refuse_sizes(
    file: OpenedFile, channels_chosen: list[Channel], values: dict[Role, FloatArray]
) -> list[str]:
    """Ask for the units again that make a size no test of a seal has; notes on unusual ones."""
    travel, force_range = (float(np.ptp(values[role])) for role in _SIGNALS)
    lasted = float(np.ptp(values["time"])) if "time" in values else 0.0

    def check_sizes(
        times: Mapping[Role, float], unit: Mapping[Role, str], _: AbstractSet[Role]
    ) -> list[tuple[Role, list[Check]]]:
        motion_range, push = travel * times["displacement"], force_range * times["force"]
        motion_unit, pushes, ticks = unit["displacement"], unit["force"], unit.get("time", "s")
        answers: dict[Role, list[Check]] = {
            "time": [size_checks.time_of_a_test(lasted * times.get("time", 1.0), ticks)],
            "displacement": [
                size_checks.size_possible("travel", motion_range, motion_unit, role="displacement"),
                size_checks.travel_of_a_seal(motion_range, motion_unit),
                size_checks.travel_of_a_bench(motion_range, motion_unit, force=push),
            ],
            "force": [
                size_checks.size_possible("force", push, pushes, role="force"),
                size_checks.force_of_a_seal(push, pushes),
                size_checks.force_of_a_bench(push, pushes, travel=motion_range),
            ],
        }
        return [(role, answers[role]) for role in answers if role in unit]

    return channels.refuse_all_sizes(file, channels_chosen, check_sizes)
