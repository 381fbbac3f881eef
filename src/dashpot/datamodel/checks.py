"""What the files behind a result leave open, as a criterion."""

from __future__ import annotations

from collections.abc import Iterable

from dashpot.base.checks import Check, Finding, Remedy, criterion
from dashpot.base.provenance import Source

_SHOWN = 3
"""Cautions that are told one by one."""


@criterion(
    "notes that can change a number",
    "<=",
    0.0,
    "our choice: one is enough for another number than was measured",
)
def numbers_unambiguous(cautions: tuple[str, ...]) -> Finding:
    """Nothing that the files say casts doubt on what their numbers are."""
    shown = list(dict.fromkeys(cautions))
    more = len(shown) - _SHOWN
    told = [*shown[:_SHOWN], *([f"{more} more such notes"] if more > 0 else [])]
    return Finding(
        "No file says that its numbers may be others than those read",
        float(len(shown)),
        instead=". ".join(one.rstrip(".") for one in told),
        remedy=Remedy("Correct the file, or state the units of its columns.", "units"),
    )


def caution_checks(sources: Iterable[Source]) -> tuple[Check, ...]:
    """Return what the notes of readers hold against their numbers; nothing where none does."""
    files = [one for one in dict.fromkeys(sources) if one.cautions]
    several = len({one.file for one in files}) > 1
    said = [f"{one.file}: {note}" if several else note for one in files for note in one.cautions]
    return (numbers_unambiguous(tuple(said)),) if said else ()
