"""From a file to a compression load deflection test: displacement and force, a clock or none."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.io.columns.roles import Assigned, assign
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels, checks
from dashpot.io.readers.channels import Channel, Opened
from dashpot.io.readers.relaxation import recorded
from dashpot.io.readers.stated import recorded_temperature, stated_specimen
from dashpot.records.cld import CompressionTest
from dashpot.records.specimen import Specimen

_SIGNALS: tuple[Role, Role] = ("displacement", "force")


def read_cld(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> CompressionTest:
    """Return the compression load deflection test in a file, in SI units; ``-`` is stdin.

    Parameters
    ----------
    path : path
        Displacement and force of a seal that is pressed and released, once or in cycles; with a
        column of time, or evenly sampled at ``options.rate``, or without a clock.
    options : ReadOptions
        Answers to what the file leaves open.
    specimen : Specimen or None
        What was tested; its length makes forces those of 100 mm.

    Raises
    ------
    ReadError
        If the file cannot be read, or leaves open which column is what or in which unit.
    """
    with channels.opened(path, options) as file:
        return cld_in(file, specimen or Specimen())


def cld_in(file: Opened, specimen: Specimen) -> CompressionTest:
    """Return the compression load deflection test in an opened file."""
    channels.refuse_summary(file)
    channels.expect(
        file,
        ["relaxation", "cld"],
        "a compression load deflection (CLD) record is",
        named=_SIGNALS,
    )
    clocked = file.options.rate is not None or isinstance(
        assign(file.table, "time", file.options), Assigned
    )
    counted = clocked and file.options.rate is None
    chosen = channels.choose(file, ["time", *_SIGNALS] if counted else _SIGNALS)
    values, notes = recorded(file, chosen) if clocked else _unclocked(file, chosen)
    _refuse_sizes(file, chosen, values)
    specimen, said = stated_specimen(file, specimen, recorded_temperature(file, chosen))
    source = channels.source(file, [one.says for one in chosen], [*notes, *said])
    return CompressionTest(
        values["displacement"], values["force"], values.get("time"), specimen, source
    )


def _unclocked(file: Opened, chosen: list[Channel]) -> tuple[dict[str, FloatArray], list[str]]:
    """The signals row by row, rows that lack a number left out."""
    rows, gaps = channels.whole_rows(channels.load_test(file, chosen))
    values: dict[str, FloatArray] = {
        one.role: channels.si(rows[:, j].copy(), one.unit) for j, one in enumerate(chosen)
    }
    notes = [*file.table.notes, *channels.rivals(file, chosen), *gaps]
    return values, [*notes, "the file has no clock: nothing is known of the speed"]


def _refuse_sizes(file: Opened, chosen: list[Channel], values: dict[str, FloatArray]) -> None:
    """Ask for the units again that make a size no test of a seal has."""
    travel, rise = (float(np.ptp(values[role])) for role in _SIGNALS)
    unit = {one.role: one.unit.word for one in chosen}
    asked = {
        "displacement": lambda word: [
            checks.travel_of_a_seal(travel, word),
            checks.travel_of_a_bench(travel, word, force=rise),
        ],
        "force": lambda word: [
            checks.force_of_a_seal(rise, word),
            checks.force_of_a_bench(rise, word, travel=travel),
        ],
        "time": lambda word: [checks.time_of_a_test(float(np.ptp(values["time"])), word)],
    }
    channels.refuse_sizes(file, [(one, asked[one.role](unit[one.role])) for one in chosen])
