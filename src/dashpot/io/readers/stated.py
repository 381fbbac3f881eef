"""What the header of a file states of the specimen."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import accumulate

import numpy as np

from dashpot.base import units
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.io.columns import vocabulary
from dashpot.io.columns.names import part_unit
from dashpot.io.readers.channels import Opened
from dashpot.io.table import Loaded
from dashpot.records.specimen import Specimen

_NUMBER = re.compile(r"[-+]?\d++(?:[.,]\d++)?+(?![.,]?\d)")
_LONGEST = 120
_BESIDES = {
    "test", "testing", "specimen", "sample", "chamber", "oven", "ambient", "room", "air", "mean",
    "prüf", "proben", "prüfraum", "kammer", "raum",
}  # fmt: skip
"""Words beside which a temperature is that of the test; a set-point or a limit has others."""


def stated_specimen(file: Opened, specimen: Specimen) -> tuple[Specimen, list[str]]:
    """Return the specimen with the temperature of the header, if the user gave none, and notes.

    A line such as ``# temperature: 0 degC`` or ``Prüftemperatur [°C]; 23,0``; without a unit, with
    a range, or beside another that differs it says nothing.
    """
    found = dict(_temperatures(file.table.header))
    if not found:
        return specimen, []
    said = " and ".join(f"'{line}'" for line in list(found.values())[:2])
    if specimen.temperature is not None:
        if all(abs(kelvin - specimen.temperature) < 0.5 for kelvin in found):
            return specimen, []
        given = f"{specimen.temperature - 273.15:.4g} degC"
        return specimen, [f"the header says {said}; the temperature is {given}, as given"]
    if len(found) > 1:
        return specimen, [f"the header says {said}; no temperature is taken from it"]
    kelvin = next(iter(found))
    try:
        known = replace(specimen, temperature=kelvin)
    except DataError as error:
        return specimen, [f"the header says {said}, which is not taken: {error}"]
    return known, [f"temperature {kelvin - 273.15:.4g} degC: the header says {said}"]


def temperatures_of_segments(file: Opened, loaded: Loaded) -> FloatArray | None:
    """Return the temperature of each row, K, if the lines over its segments state several.

    A segment over which nothing is stated is as warm as the one before it.
    """
    stated = [
        {kelvin for kelvin, _ in _temperatures(lines)}
        for lines in (file.table.header, *loaded.above[1:])
    ]
    several = len(set().union(*stated)) > 1
    if not several or not stated[0] or any(len(kelvin) > 1 for kelvin in stated):
        return None
    lengths = np.diff((*loaded.starts, len(loaded.values)))
    each = accumulate((max(k, default=np.nan) for k in stated), _or_before)
    return np.repeat(list(each), lengths)


def _or_before(before: float, stated: float) -> float:
    return before if np.isnan(stated) else stated


def _temperatures(header: tuple[str, ...]) -> Iterator[tuple[float, str]]:
    """Each temperature of a line of its own, K, and the line."""
    for line in header:
        text = " ".join(line[:_LONGEST].replace('"', " ").strip(" \t#%$!/*;'").split())
        number = _NUMBER.search(text)
        if number is None:
            continue
        name, inner = part_unit(text[: number.start()].rstrip(" :=;,|"))
        behind = text[number.end() :].lstrip(" ;,|[(").split()
        word = inner or (behind[0].rstrip(";,|])") if behind else "")
        unit = units.find(word, "temperature")
        if unit is not None and _of_the_test(name) and (not inner or not behind):
            yield float(number[0].replace(",", ".")) * unit.factor + unit.offset, text


def _of_the_test(name: str) -> bool:
    """Whether a name is a temperature and no more than that of the test."""
    words = vocabulary.tokens(name)
    heads = [word for word in words if word not in _BESIDES]
    return len(heads) == 1 and any(
        "temperature" in vocabulary.FIRST.get(spelling, ())
        for spelling in (heads[0], *(heads[0].removeprefix(word) for word in _BESIDES))
    )
