"""Reader of the power spectral density of base acceleration, from a file or by a name."""

from __future__ import annotations

import re
from pathlib import Path

from dashpot.base import dataclass, units
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError, ReadError
from dashpot.base.provenance import Source
from dashpot.reading.columns.role_assignment import assign_role, list_columns
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels

_WORDS = "g^2/Hz or (m/s^2)^2/Hz"
_POWER_UNITS = {"m2/s3": 1.0, "m^2/s^3": 1.0, "m²/s³": 1.0, "m**2/s**3": 1.0}
_POWERS = ("**2", "^2", "²", "2")
_TYPED = re.compile(r"\A\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*(\D.*)\Z", re.IGNORECASE)


@dataclass(frozen=True)
class BasePSD:
    """One-sided density of a base's acceleration, (m/s^2)^2/Hz.

    Attributes
    ----------
    density : array, shape (n,), or float
        A number is white noise.
    frequency : array, shape (n,), or None
        Hz.
    source : tuple of Source
    """

    density: FloatArray | float
    frequency: FloatArray | None = None
    source: tuple[Source, ...] = ()


def read_psd(text: str | Path, *, options: ReadOptions | None = None) -> BasePSD:
    """Return the density in a file of frequency and density, or that of a word as ``0.01g^2/Hz``.

    Raises
    ------
    ReadError
        If neither a file nor a density is meant, a column is not found, or its unit is none of a
        squared acceleration per Hz.
    """
    matched_text = _TYPED.match(str(text))
    if matched_text and not Path(text).is_file():
        return BasePSD(float(matched_text[1]) * _get_unit_factor(matched_text[2], f"'{text}'"))
    with channels.open_file(text, options) as file:
        (lines,) = channels.require_answers(
            file, [assign_role(file.table, "frequency", file.options)]
        )
        other_columns = [
            i
            for i, column in enumerate(file.table.columns)
            if column.content == "number" and i != lines.index
        ]
        if len(other_columns) != 1:
            raise ReadError(
                f"{len(other_columns)} columns beside the frequency; expected one, the density of "
                f"the base's acceleration in {_WORDS}; the columns are "
                f"{list_columns(file.table.columns)}"
            )
        column = file.table.columns[other_columns[0]]
        factor = _get_unit_factor(column.unit or "", f"'{column.label(other_columns[0] + 1)}'")
        hertz = file.unit(lines.index, "frequency")
        loaded_columns = channels.load(
            file.table, [lines.index, other_columns[0]], file.options.segment
        )
        rows, notes = channels.select_complete_rows(loaded_columns)
        if (rows[:, 1] < 0).any():
            raise ReadError("a density falls below 0; expected one that is not in dB")
        names = [file.table.columns[lines.index].name, column.name]
        return BasePSD(
            rows[:, 1] * factor,
            rows[:, 0] * hertz.factor,
            (channels.make_source(file, names, (*file.table.notes, *notes)),),
        )


def _get_unit_factor(word: str, source: str) -> float:
    """Return the factor of a unit to (m/s^2)^2/Hz."""
    unit_text = word.strip()
    if unit_text in _POWER_UNITS:
        return _POWER_UNITS[unit_text]
    squared, _, denominator = unit_text.rpartition("/")
    power = next((power for power in _POWERS if squared.rstrip().endswith(power)), None)
    unit = None
    if power and denominator.strip().lower() == "hz":
        root = squared.rstrip().removesuffix(power).rstrip()
        unit = units.find_unit(root.removeprefix("(").removesuffix(")"), "acceleration")
    if unit is None:
        text = f"the unit '{unit_text}'" if unit_text else "no unit"
        raise DataError(f"{source} has {text}; expected a density in {_WORDS}")
    return unit.factor**2
