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
    values = sorted(
        record.specimen.temperature for record in records if record.specimen.temperature is not None
    )
    if len(values) < len(records):
        return np.zeros(0)
    groups: list[list[float]] = []
    for value in values:
        if groups and value - groups[-1][0] <= SAME_TEMPERATURE:
            groups[-1].append(value)
        else:
            groups.append([value])
    return np.array([float(np.mean(group)) for group in groups])


def checked_temperatures(records: Sequence[RampHold], *, shared: bool) -> FloatArray:
    """Return the temperatures of the tests, K; one or none if they are of one as far as is known.

    `shared` is True where tests of several may be fitted: by the recorded motion, one solid.

    Raises
    ------
    FitError
        If only some tests have one, or they are to be fitted in a way that knows of none.
    """
    values = [record.specimen.temperature for record in records]
    ramp_holds = [record for record in records if record.specimen.temperature]
    if ramp_holds and None in values:
        first = ramp_holds[0].specimen.temperature or 0.0
        raise FitError(
            f"test {values.index(None) + 1} of {len(values)} has no temperature, where test "
            f"{values.index(first) + 1} is of {celsius(first)}: give one for every file, in their "
            "order, such as --temperature 23degC --temperature 0degC, or one for all of them "
            "(Python: Specimen(temperature=...))"
        )
    temperatures = temperatures_of(records)
    if len(temperatures) < 2:
        return temperatures
    if not shared:
        raise FitError(
            "tests at several temperatures are fitted by the recorded motion, and share their "
            "stiffnesses: leave out --method hold and --elastic by-depth"
        )
    return temperatures


def find_reference_index(temperatures: FloatArray, target: float | None) -> int:
    """Return which temperature, K, is the reference: the one asked for, or nearest to 23 degC.

    Raises
    ------
    FitError
        If no test is of the temperature asked for.
    """
    magnitude = np.abs(temperatures - (STANDARD if target is None else target))
    if target is not None and magnitude.min() > SAME_TEMPERATURE:
        listed = ", ".join(celsius(float(value)) for value in temperatures)
        raise FitError(
            f"no test is of the reference temperature {celsius(target)}; expected one of {listed}"
        )
    return int(np.argmin(magnitude))
