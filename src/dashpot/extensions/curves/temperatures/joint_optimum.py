"""Optimum of one solid and its shifts over tests at several temperatures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.extensions.curves.temperatures.joint_problem import JointTests, ShiftedSolid
from dashpot.extensions.curves.temperatures.marginalised_data import SingleTemperatureTest
from dashpot.extensions.curves.temperatures.starting_points import (
    OrderCandidate,
    candidates,
    first_shifts,
    refine_candidates,
)
from dashpot.fitting.fit_options import FitOptions
from dashpot.fitting.input_tests import list_temperatures
from dashpot.numerics.inference.model_order import DECISIVE_BIC, OrderChoice, select_model_order

# Prior of the change of the shift with the relaxation time: two temperatures hardly determine it,
# three do.
_SLOPE_OF_TWO, _SLOPE = 0.03, 0.3
# arms that are tried beside those of one test, for each decade by which the tests are shifted
_ARMS_PER_DECADE = 3


class ThermalOptimum(NamedTuple):
    """Optimum of one solid at several temperatures.

    Attributes
    ----------
    tests : tuple of SingleTemperatureTest
        With the columns of a seal that warms.
    joint : JointTests
    candidates : tuple of OrderCandidate
    choice : OrderChoice or None
        None if the number of arms was requested.
    point : ShiftedSolid
        Relaxation times ascending.
    thorough : bool
        With quasi-random starts.
    """

    tests: tuple[SingleTemperatureTest, ...]
    joint: JointTests
    candidates: tuple[OrderCandidate, ...]
    choice: OrderChoice | None
    point: ShiftedSolid
    thorough: bool


def optimum(
    tests: Sequence[SingleTemperatureTest],
    options: FitOptions,
    reference: int,
) -> ThermalOptimum:
    """Return the optimum over all tests, the number of arms chosen if none is requested.

    Parameters are those of
    :func:`~dashpot.extensions.curves.temperatures.fit_temperatures.fit_thermal`.
    """
    temperatures = list_temperatures([test.record for test in tests])
    temperature_index = np.array(
        [int(np.argmin(np.abs(temperatures - test.temperature))) for test in tests]
    )
    slope = _SLOPE_OF_TWO if len(temperatures) == 2 else _SLOPE

    def joint_of(tests_in_fit: Sequence[SingleTemperatureTest]) -> JointTests:
        blocks = [test.marginal for test in tests_in_fit]
        return JointTests(
            blocks, temperature_index, temperatures, reference, options.vertical, slope
        )

    effective = sum(test.effective for test in tests)
    joint = joint_of(tests)
    arms, log_a = options.count, first_shifts(joint)
    max_arm_count = arms
    if max_arm_count is None:
        decades = float(np.ptp(log_a)) / np.log(10.0)
        max_arm_count = options.max_arms + int(np.ceil(_ARMS_PER_DECADE * decades))
    order_candidates = candidates(
        joint, log_a, max_arm_count, effective=effective, thorough=options.thorough
    )
    choice = _choice(
        joint, order_candidates, is_exhausted=len(order_candidates) - 1 < max_arm_count
    )
    # the columns of a warming seal are those of the solid found without them, then with them
    for _ in range(2):
        point = _select_candidate(order_candidates, choice, arms).point
        tests = tuple(
            _add_warming(test, point, int(i), temperatures)
            for test, i in zip(tests, temperature_index, strict=True)
        )
        joint = joint_of(tests)
        order_candidates = refine_candidates(joint, order_candidates, effective)
        choice = _choice(
            joint, order_candidates, is_exhausted=len(order_candidates) - 1 < max_arm_count
        )
    best = _ascending(_select_candidate(order_candidates, choice, arms).point)
    return ThermalOptimum(
        tuple(tests),
        joint,
        order_candidates,
        choice if arms is None else None,
        best,
        options.thorough,
    )


def _add_warming(
    test: SingleTemperatureTest, point: ShiftedSolid, i: int, temperatures: FloatArray
) -> SingleTemperatureTest:
    by_a, by_b = (np.gradient(values, temperatures)[i] for values in (point.log_a, point.log_b))
    return test.add_warming_column(point.solid_at(i), by_a=float(by_a), by_b=float(by_b))


def _ascending(point: ShiftedSolid) -> ShiftedSolid:
    order = np.argsort(point.log_tau)
    return replace(point, k=point.k[order], log_tau=point.log_tau[order])


def _choice(
    joint: JointTests, candidates: Sequence[OrderCandidate], *, is_exhausted: bool
) -> OrderChoice:
    numbers = [candidate.point.order for candidate in candidates]
    significance = [joint.has_significant_arms(candidate.point) for candidate in candidates]
    bics = [candidate.bic for candidate in candidates]
    return select_model_order(
        numbers, bics, significance, is_exhausted=is_exhausted, decisive=DECISIVE_BIC
    )


def _select_candidate(
    candidates: Sequence[OrderCandidate], choice: OrderChoice, requested_arms: int | None
) -> OrderCandidate:
    max_arm_count = choice.arms if requested_arms is None else requested_arms
    return [candidate for candidate in candidates if candidate.point.order <= max_arm_count][-1]
