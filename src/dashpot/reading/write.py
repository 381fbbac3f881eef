"""Writers of records, as text or UFF, which the readers read back."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.file_writing import write_atomic
from dashpot.base.plain_text import escape_formula, format_csv_comment
from dashpot.base.provenance import Source, find_origins
from dashpot.base.units import convert_to_unit
from dashpot.base.version import byline
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import Trajectory
from dashpot.datamodel.specimen import Specimen
from dashpot.datamodel.vibration_tests import ImpactTest


class ForceTest(Protocol):
    """Interface of a test with displacement and force over time."""

    @property
    def time(self) -> FloatArray:
        """Time in s."""

    @property
    def displacement(self) -> FloatArray:
        """Displacement in m."""

    @property
    def force(self) -> FloatArray:
        """Force in N."""

    @property
    def specimen(self) -> Specimen:
        """Specimen of the test."""

    @property
    def source(self) -> Source | None:
        """The file that it is of."""


def write_relaxation(
    test: ForceTest,
    path: str | Path | None = None,
    *,
    comments: Sequence[str] = (),
) -> str:
    """Return a relaxation or a creep test of a part as text, and write it to `path` if given.

    The columns are ``time [s], displacement [mm], force [N]``. Every number has
    all its digits. Each comment stands on a line of its own, after ``#``, and so does the
    temperature of the specimen, if it is known.
    """
    header = ["time [s]", "displacement [mm]", "force [N]"]
    columns = [test.time, convert_to_unit(test.displacement, "mm"), test.force]
    source = () if test.source is None else (test.source,)
    comment_lines = [*_add_simulated_stamp(source, comments), *describe_temperature(test.specimen)]
    return save_text(format_table(comment_lines, header, columns), path)


def write_trajectory(
    motion: Trajectory, path: str | Path | None = None, *, comments: Sequence[str] = ()
) -> str:
    """Return a motion as text that `read_trajectory` takes back, and write it to `path` if given.

    The columns are ``time [s], displacement [mm]`` and, where it is known in space,
    ``x [mm], y [mm], z [mm]``, to the picometre.
    """
    header, columns = ["time [s]", "displacement [mm]"], [motion.displacement]
    if motion.position is not None:
        header += ["x [mm]", "y [mm]", "z [mm]"]
        columns += list(motion.position.T)
    changes = [
        np.round(convert_to_unit(column, "mm"), 9) + 0.0 for column in columns
    ]  # no zero is negative
    return save_text(format_table(comments, header, [motion.time, *changes]), path)


def temperature_line(kelvin: float) -> str:
    """Return the header line of a file on the temperature of its test, K.

    >>> temperature_line(273.15)
    'temperature: 0 degC'
    """
    return f"temperature: {round(convert_to_unit(kelvin, 'degC'), 9):.12g} degC"


def write_impact(
    test: ImpactTest, path: str | Path | None = None, *, comments: Sequence[str] = ()
) -> str:
    """Return a hammer test as text, and write it to `path` if one is given.

    The columns are ``time [s], hammer [N], acceleration 1 [m/s^2], ...``, or the channels' own
    names where they have them. The records follow one another; a line with the names stands
    again before each further one.
    """
    header = [
        "time [s]",
        "hammer [N]",
        *(f"{_format_channel_name(name)} [m/s^2]" for name in test.channels),
    ]
    parts = []
    for number, record in enumerate(test.records()):
        notes = [f"record: {number + 1}"] if number else _add_simulated_stamp(test.source, comments)
        columns = [test.time[record], test.force[record], *test.acceleration[:, record]]
        parts.append(format_table(notes, header, columns))
    return save_text("".join(parts), path)


def write_frf(frf: FRF, path: str | Path | None = None, *, comments: Sequence[str] = ()) -> str:
    """Return an FRF as text that `read_frf` takes back whole, and write it to `path`.

    Comment lines hold the kind, the window's shift, the record length and the number of
    averages; the columns are frequency, real and imaginary part, magnitude, phase, and the
    coherence and standard deviation where the FRF has them.
    """
    comment_lines = [
        byline("frequency response function"),
        *_add_simulated_stamp(frf.source, comments),
        f"kind: {frf.quantity.value}",
        f"shift [1/s]: {float(frf.shift)!r}",
        *([f"shift sd [1/s]: {float(frf.shift_sd)!r}"] if frf.shift_sd else []),
        *([] if frf.record is None else [f"record [s]: {float(frf.record)!r}"]),
        f"averages: {frf.averages}",
        *(f"made from: sha256 {origin}" for origin in sorted(find_origins(frf.source))),
    ]
    unit = frf.unit
    named_columns: list[tuple[str, FloatArray]] = [
        ("frequency [Hz]", frf.frequency),
        (f"real [{unit}]", frf.value.real),
        (f"imaginary [{unit}]", frf.value.imag),
        (f"magnitude [{unit}]", np.abs(frf.value)),
        ("phase [deg]", np.degrees(np.angle(frf.value))),
    ]
    if frf.coherence is not None:
        named_columns.append(("coherence [1]", frf.coherence))
    if frf.sd is not None:
        named_columns.append((f"sd [{unit}]", frf.sd))
    text = format_table(
        comment_lines, [name for name, _ in named_columns], [values for _, values in named_columns]
    )
    return save_text(text, path)


def _format_channel_name(name: str) -> str:
    """Return a channel's name as a header cell: no delimiter, no bracket, no formula."""
    return escape_formula(name.translate(str.maketrans(',;\t"[]()', "        "))) or "acceleration"


def _add_simulated_stamp(sources: Iterable[Source], comments: Sequence[str]) -> list[str]:
    """Return the comments, under the stamp of what was simulated unless one carries it already."""
    origin_word = "simulated" if any(source.simulated for source in sources) else ""
    is_stated = any(origin_word in comment.casefold() for comment in comments)
    return [*([] if is_stated or not origin_word else [origin_word]), *comments]


def describe_temperature(specimen: Specimen) -> list[str]:
    """Return the line of the temperature of a test, if it is known."""
    return [] if specimen.temperature is None else [temperature_line(specimen.temperature)]


def format_table(
    comment_lines: Sequence[str], head: Sequence[str], columns: Sequence[FloatArray]
) -> str:
    """Return comments, names and columns as the text of a table."""
    lines = [f"# {format_csv_comment(line)}" for line in comment_lines]
    lines.append(",".join(head))
    # repr is the shortest text that reads back as the same number
    cells = [map(repr, np.asarray(column, dtype=float).tolist()) for column in columns]
    lines.extend(map(",".join, zip(*cells, strict=True)))
    return "\n".join(lines) + "\n"


def save_text(text: str, path: str | Path | None) -> str:
    """Return a text, and write it to `path` if one is given."""
    if path is not None:
        write_atomic(path, text.encode())
    return text
