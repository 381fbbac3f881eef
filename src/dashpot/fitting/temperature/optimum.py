"""The temperatures of some tests, and the optimum of one solid and its shifts over all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import FitError
from dashpot.engine.inference.order import DECISIVE, Choice, choose
from dashpot.fitting.temperature.joint import JointTests, ShiftedSolid, Vertical
from dashpot.fitting.temperature.reduced import Own
from dashpot.fitting.temperature.search import OrderCandidate, again, candidates, first_shifts
from dashpot.records.relaxation import RampHold
from dashpot.records.temperature import SAME_TEMPERATURE, celsius

# the standard temperature of rubber laboratories, K: the solid is that of the test nearest to it
STANDARD = 296.15
# what is known of how arms shift apart: two temperatures hardly tell, three do
_SLOPE_OF_TWO, _SLOPE = 0.03, 0.3


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
            "stiffnesses: leave out --method hold and --depth-law"
        )
    return found


def reference_of(temperatures: FloatArray, asked: float | None) -> int:
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


class ThermalOptimum(NamedTuple):
    """One solid at several temperatures, found.

    Attributes
    ----------
    tests : tuple of Own
        With the columns of a seal that warms.
    joint : JointTests
    tried : tuple of OrderCandidate
    choice : Choice or None
        None if the number of arms was asked for.
    point : ShiftedSolid
        Relaxation times ascending.
    thorough : bool
        With quasi-random starts.
    """

    tests: tuple[Own, ...]
    joint: JointTests
    tried: tuple[OrderCandidate, ...]
    choice: Choice | None
    point: ShiftedSolid
    thorough: bool


def optimum(
    tests: Sequence[Own],
    reference: int,
    *,
    arms: int | None,
    max_arms: int,
    vertical: Vertical,
    thorough: bool,
) -> ThermalOptimum:
    """Return the optimum over all tests, the number of arms chosen if none is asked for.

    Parameters are those of :func:`~dashpot.fitting.temperature.thermal_fit.fit_thermal`.
    """
    temperatures = temperatures_of([test.record for test in tests])
    at = np.array([int(np.argmin(np.abs(temperatures - test.temperature))) for test in tests])
    slope = _SLOPE_OF_TWO if len(temperatures) == 2 else _SLOPE

    def joint_of(every: Sequence[Own]) -> JointTests:
        blocks = [test.marginal for test in every]
        return JointTests(blocks, at, temperatures, reference, vertical, slope)

    effective = sum(test.effective for test in tests)
    joint = joint_of(tests)
    most = max_arms if arms is None else arms
    tried = candidates(joint, first_shifts(joint), most, effective=effective, thorough=thorough)
    choice = _choice(joint, tried, exhausted=len(tried) - 1 < most)
    # the columns of a warming seal are those of the solid found without them, then with them
    for _ in range(2):
        point = _taken(tried, choice, arms).point
        tests = tuple(
            _warmed(test, point, int(i), temperatures) for test, i in zip(tests, at, strict=True)
        )
        joint = joint_of(tests)
        tried = again(joint, tried, effective)
        choice = _choice(joint, tried, exhausted=len(tried) - 1 < most)
    best = _ascending(_taken(tried, choice, arms).point)
    return ThermalOptimum(
        tuple(tests), joint, tried, choice if arms is None else None, best, thorough
    )


def _warmed(test: Own, point: ShiftedSolid, i: int, temperatures: FloatArray) -> Own:
    by_a, by_b = (np.gradient(one, temperatures)[i] for one in (point.log_a, point.log_b))
    return test.warmed(point.solid_at(i), by_a=float(by_a), by_b=float(by_b))


def _ascending(point: ShiftedSolid) -> ShiftedSolid:
    order = np.argsort(point.log_tau)
    return replace(point, k=point.k[order], log_tau=point.log_tau[order])


def _choice(joint: JointTests, tried: Sequence[OrderCandidate], *, exhausted: bool) -> Choice:
    numbers = [one.point.order for one in tried]
    clear = [joint.clear(one.point) for one in tried]
    bics = [one.bic for one in tried]
    return choose(numbers, bics, clear, exhausted=exhausted, decisive=DECISIVE)


def _taken(tried: Sequence[OrderCandidate], choice: Choice, asked: int | None) -> OrderCandidate:
    most = choice.arms if asked is None else asked
    return [one for one in tried if one.point.order <= most][-1]
