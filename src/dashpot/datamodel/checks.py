"""Criteria on a result's source files and temperature range."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from dashpot.base.checks import Check, Finding, Remedy, criterion
from dashpot.base.provenance import Source
from dashpot.base.units import celsius

if TYPE_CHECKING:
    from dashpot.datamodel.shift_factors import TemperatureShifts

_MAX_LISTED = 3
"""Number of cautions that are reported one by one."""


@criterion(
    "notes that can change a number",
    "<=",
    0.0,
    "our choice: one note can change a number",
)
def numbers_unambiguous(cautions: tuple[str, ...]) -> Finding:
    """Nothing in the files makes their numbers ambiguous."""
    unique_cautions = list(dict.fromkeys(cautions))
    unlisted_count = len(unique_cautions) - _MAX_LISTED
    sentences = [
        *unique_cautions[:_MAX_LISTED],
        *([f"{unlisted_count} more such notes"] if unlisted_count > 0 else []),
    ]
    return Finding(
        "No file says that its numbers may be others than those read",
        float(len(unique_cautions)),
        failure=". ".join(sentence.rstrip(".") for sentence in sentences),
        remedy=Remedy("Correct the file, or state the units of its columns.", "units"),
    )


def caution_checks(sources: Iterable[Source]) -> tuple[Check, ...]:
    """Return the checks of the notes that the reader of a file made about its numbers."""
    files = [source for source in dict.fromkeys(sources) if source.cautions]
    has_several_files = len({file.file for file in files}) > 1
    sentences = [
        f"{file.file}: {note}" if has_several_files else note
        for file in files
        for note in file.cautions
    ]
    return (numbers_unambiguous(tuple(sentences)),) if sentences else ()


@criterion("K beyond the tested range", "<=", 0.0, "by definition")
def temperature_tested(shifts: TemperatureShifts, temperature: float) -> Finding:
    """The requested temperature lies within the tested range."""
    low, high = shifts.tested_range
    return Finding(
        f"{celsius(temperature)} lies within the tested {celsius(low)} to {celsius(high)}",
        max(low - temperature, temperature - high, 0.0),
        failure=f"{celsius(temperature)} lies outside the tested {celsius(low)} to "
        f"{celsius(high)}. The {shifts.law.kind.upper()} law is extrapolated",
        remedy="Test at that temperature.",
    )
