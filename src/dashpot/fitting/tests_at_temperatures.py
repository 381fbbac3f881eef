"""The temperatures of some tests, and which of them the solid is given at."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import FitError
from dashpot.base.units import celsius
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.shift_factors import SAME_TEMPERATURE

# the standard temperature of rubber laboratories, K: the solid is that of the test nearest to it
STANDARD = 296.15


def temperatures_of(records: Sequence[RampHold]) -> FloatArray:
    """Return the temperatures of tests, K, rising; those of one temperature as their mean.

    Empty unless every test has one.
    """
    found = sorted(
        record.specimen.temperature for record in records if record.specimen.temperature is not None
    )
    if len(found) < len(records):
        return np.zeros(0)
    groups: list[list[float]] = []
    for one in found:
        if groups and one - groups[-1][0] <= SAME_TEMPERATURE:
            groups[-1].append(one)
        else:
            groups.append([one])
    return np.array([float(np.mean(group)) for group in groups])


def checked_temperatures(records: Sequence[RampHold], *, shared: bool) -> FloatArray:
    """Return the temperatures of the tests, K; one or none if they are of one as far as is known.

    `shared` is True where tests of several may be fitted: by the recorded motion, one solid.

    Raises
    ------
    FitError
        If only some tests have one, or they are to be fitted in a way that knows of none.
    """
    given = [record.specimen.temperature for record in records]
    known = [record for record in records if record.specimen.temperature]
    if known and None in given:
        first = known[0].specimen.temperature or 0.0
        raise FitError(
            f"test {given.index(None) + 1} of {len(given)} has no temperature, where test "
            f"{given.index(first) + 1} is of {celsius(first)}: give one for every file, in their "
            "order, such as --temperature 23degC --temperature 0degC, or one for all of them "
            "(Python: Specimen(temperature=...))"
        )
    found = temperatures_of(records)
    if len(found) < 2:
        return found
    if not shared:
        raise FitError(
            "tests at several temperatures are fitted by the recorded motion, and share their "
            "stiffnesses: leave out --method hold and --elastic by-depth"
        )
    return found


def reference_temperature(temperatures: FloatArray, asked: float | None) -> int:
    """Return which temperature, K, is the reference: the one asked for, or nearest to 23 degC.

    Raises
    ------
    FitError
        If no test is of the temperature asked for.
    """
    apart = np.abs(temperatures - (STANDARD if asked is None else asked))
    if asked is not None and apart.min() > SAME_TEMPERATURE:
        listed = ", ".join(celsius(float(one)) for one in temperatures)
        raise FitError(
            f"no test is of the reference temperature {celsius(asked)}; expected one of {listed}"
        )
    return int(np.argmin(apart))
