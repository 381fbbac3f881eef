"""Reader of base-excitation tests: a shaken base and the mass on it, in one file or several."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from dashpot.base.errors import ReadError
from dashpot.datamodel.vibration_tests import ShakenTest
from dashpot.reading.columns.role_assignment import RoleAssignment, find_column, format_column
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions, flag
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import Channel, OpenedFile, find_mass_motions
from dashpot.reading.readers.impact import (
    find_record_starts,
    join_record_starts,
    load_complete_columns,
    refuse_same,
)

_ORDERS: dict[Role, int] = {"displacement": 0, "velocity": 1, "acceleration": 2}
_SAME_RATE = 1e-3
"""Part of a sampling rate by which the files of one set-up may differ."""


def read_shaken(paths: Sequence[str | Path], options: ReadOptions) -> ShakenTest:
    """Return the base's acceleration and the mass's motion in files of one set-up, in SI units.

    The mass's may be an acceleration, a velocity or a displacement.

    Segments, jumps of the clock, and further files each start a new continuous record.

    Raises
    ------
    ReadError
        If a column is not found or has no unit, or the files have other rates.
    """
    tests = [_read_test(path, options) for path in paths]
    first = tests[0]
    for path, test in zip(paths, tests, strict=True):
        if abs(test.rate / first.rate - 1) > _SAME_RATE:
            raise ReadError(
                f"{path}: sampled at {test.rate:.6g} Hz, but {paths[0]} at {first.rate:.6g} Hz; "
                "give files of one set-up"
            )
        if test.order != first.order:
            raise ReadError(
                f"{path}: another motion of the mass than in {paths[0]}; give files of one set-up"
            )
    return ShakenTest(
        first.rate,
        np.concatenate([test.base for test in tests]),
        np.concatenate([test.mass for test in tests]),
        join_record_starts([(len(test.base), test.starts) for test in tests]),
        tuple(source for test in tests for source in test.source),
        first.order,
    )


def _read_test(path: str | Path, options: ReadOptions) -> ShakenTest:
    with channels.open_file(path, options) as file:
        channels.refuse_summary(file)
        channels_chosen = _choose_channels(file)
        loaded_columns, columns = load_complete_columns(file, channels_chosen)
        base, mass = columns[-2:]
        refuse_same(file, channels_chosen, [base, mass])
        starts, notes, rate = (
            loaded_columns.starts,
            [*file.table.notes, *loaded_columns.notes],
            options.rate,
        )
        if rate is None:
            starts, remarks = find_record_starts(columns[0], loaded_columns)
            notes += remarks
            first = columns[0][: (*starts, len(base))[1]]
            if not np.ptp(first) > 0:
                raise ReadError("the time stands still; give the rate, for example --rate 512Hz")
            rate = (len(first) - 1) / float(first[-1] - first[0])
        source = channels.make_source(file, [c.message for c in channels_chosen], notes)
        return ShakenTest(rate, base, mass, starts, (source,), _ORDERS[channels_chosen[-1].role])


def _choose_channels(file: OpenedFile) -> list[Channel]:
    """Return time unless a rate is given, the base, and the one other motion."""
    columns, base_flag = file.table.columns, flag("base_acceleration")
    base = find_column(columns, str(file.options.base_acceleration), base_flag)
    ticks = channels.select_columns(file, channels.add_time_role(file))
    used_columns = [base, *(tick.index for tick in ticks)]
    assignments = find_mass_motions(file, used_columns)
    if len(assignments) != 1:
        columns_text = (
            f": {', '.join(format_column(columns, assignment.index) for assignment in assignments)}"
            if assignments
            else ""
        )
        raise ReadError(
            f"{len(assignments)} motions beside that of the base, "
            f"{format_column(columns, base)}{columns_text}; "
            f"expected one, of the mass: name it with {flag('acceleration')}=NAME, "
            f"{flag('velocity')}=NAME or {flag('displacement')}=NAME"
        )
    return channels.add_units(
        file,
        [
            *ticks,
            RoleAssignment("acceleration", base, f"of the base, named by {base_flag}"),
            *assignments,
        ],
    )
