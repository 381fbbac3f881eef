"""Roles of blank tests: rigid stop, steel spring or empty run, by the record or as stated."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import block_means
from dashpot.base.errors import DataError
from dashpot.base.number_format import format_count
from dashpot.base.units import format_quantity
from dashpot.extensions.blank_tests.datamodel import ROLE_LABELS, BlankTest
from dashpot.extensions.blank_tests.estimation import name_record, orient_channels
from dashpot.signals.noise import scatter

STOP_RATIO = 4.0
"""Times a spring's stiffness from which a part is a rigid stop."""
SPRING_RATIOS = (0.6, 1.5)
"""Stiffness of a spring in its machine, over its stated one."""
_EMPTY_SHARE, _LOADED_SHARE = 0.02, 0.1
"""Parts of the largest force of all records: below the first a run is empty, above the second
something was pressed."""
_NOISE_SPAN = 12.0
"""Scatter of a force that a run without a specimen may span."""
_BLOCKS = 400


class AssignedRole(NamedTuple):
    """Role of a record, and the reason for it."""

    role: str
    reason: str


class Load(NamedTuple):
    """Largest force of a record, N, its scatter, N, and force over displacement, N/m."""

    force: float
    noise: float
    stiffness: float


def measure_load(record: BlankTest) -> Load:
    """Return the largest force of a record, its scatter, and the stiffness under the plate."""
    x, force = orient_channels(record)
    count = max(len(force) // _BLOCKS, 1)
    means, motion = block_means(force, count), block_means(x, count)
    peak = float(means.max())
    is_loaded = means > 0.2 * peak
    span = float(np.ptp(motion[is_loaded])) if is_loaded.any() else 0.0
    stiffness = float(np.ptp(means[is_loaded])) / span if span > 0 else float("inf")
    return Load(float(np.abs(means).max()), scatter(record.time, record.force), stiffness)


def assign_roles(
    records: Sequence[BlankTest], spring_stiffness: float | None = None
) -> tuple[AssignedRole, ...]:
    """Return the role of each record, with the reason.

    A run is empty whose force is below 2 % of the largest of all, or within its own noise. A part
    is the spring if its stiffness is .6 to 1.5 of the one stated, and a rigid stop from 4 times
    that; without a stated one the stiffest is the stop if another is 4 times softer.

    Raises
    ------
    DataError
        If a record does not show it: the sentence says what to state.
    """
    loads = [measure_load(record) for record in records]
    largest = max(load.force for load in loads)
    seal_stiffnesses = [
        load.stiffness
        for record, load in zip(records, loads, strict=True)
        if not record.role and _is_loaded(record, load, largest)
    ]
    return tuple(
        AssignedRole(record.role, "as stated")
        if record.role
        else _assign_role(record, load, largest, spring_stiffness, seal_stiffnesses)
        for record, load in zip(records, loads, strict=True)
    )


def _is_loaded(record: BlankTest, load: Load, largest: float) -> bool:
    """Return whether something was pressed.

    Raises
    ------
    DataError
        If that is open.
    """
    ratio = load.force / largest if largest > 0 else 0.0
    if load.force <= _NOISE_SPAN * load.noise or ratio < _EMPTY_SHARE:
        return False
    if ratio > _LOADED_SHARE:
        return True
    raise DataError(
        f"{name_record(record)} rises to {format_quantity(load.force, 'N', '.3g')}, "
        f"{100 * ratio:.2g} % of the largest force of these tests: neither an empty run nor a "
        f"press for certain. {_format_role_request(record)}"
    )


def _assign_role(
    record: BlankTest,
    load: Load,
    largest: float,
    spring_stiffness: float | None,
    stiffnesses: Sequence[float],
) -> AssignedRole:
    if not _is_loaded(record, load, largest):
        return AssignedRole("empty", f"its force stays within {_format_force(load.force)}")
    text = f"{format_quantity(load.stiffness, 'N/mm', '.3g')}"
    if spring_stiffness is not None:
        ratio = load.stiffness / spring_stiffness
        if ratio >= STOP_RATIO:
            return AssignedRole("stop", f"{text}, {ratio:.3g} times the stated spring")
        if SPRING_RATIOS[0] <= ratio <= SPRING_RATIOS[1]:
            return AssignedRole("spring", f"{text}, near the stated spring")
        raise DataError(
            f"{name_record(record)} has {text}, {ratio:.2g} times the stated spring: neither that "
            "spring nor a rigid stop for certain. Check the spring's stiffness. "
            f"{_format_role_request(record)}"
        )
    softest, stiffest = min(stiffnesses), max(stiffnesses)
    if stiffest < STOP_RATIO * softest:
        raise DataError(
            f"{name_record(record)} has {text}, and {format_count(len(stiffnesses), 'record')} of "
            "these press a part: nothing shows whether it is a rigid stop or a spring. State the "
            f"spring's stiffness (--spring-stiffness 1N/mm). {_format_role_request(record)}"
        )
    if load.stiffness * STOP_RATIO > stiffest * np.sqrt(STOP_RATIO):
        return AssignedRole("stop", f"{text}, the stiffest")
    if load.stiffness <= softest * np.sqrt(STOP_RATIO):
        return AssignedRole("spring", f"{text}, the softest")
    raise DataError(
        f"{name_record(record)} has {text}, between two others. {_format_role_request(record)}"
    )


def _format_force(force: float) -> str:
    return format_quantity(force, "mN", ".2g")


def _format_role_request(record: BlankTest) -> str:
    roles = [role for role in ROLE_LABELS if role]
    name = name_record(record)
    return (
        f"State its role: --role {name}:{roles[0]}, or {' or '.join(roles[1:])} "
        '(Python: dp.read(FILE, kind="blank", role="stop"))'
    )
