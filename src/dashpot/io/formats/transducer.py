"""A table of six gauge voltages, given a calibration, gains its forces and torques."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.base import units
from dashpot.base.errors import ReadError
from dashpot.io.formats import ati
from dashpot.io.table import Column, Loaded, Table

_GAUGE = re.compile(r"(?:.*\b|.*_|)(?:sg|g|gauge|gage|ch|ai|v|volt|voltage)[\s_]*(\d)\b.*", re.I)
_REST = 0.02
"""Share of the record, from its start, whose median is taken as the unloaded voltages."""


def calibrated(table: Table, calibration_file: str, *, axis: str, file: str) -> Table:
    """Return the table with the transducer's axis as one more column, the force.

    The bias is the median of the first rows, subtracted in volts.

    Raises
    ------
    ReadError
        If the table has not six columns of gauge voltages, in order.
    """
    if axis not in ati.AXES:
        raise ReadError(f"--axis {axis}: expected one of {', '.join(ati.AXES)}")
    calibration = ati.read_calibration(calibration_file)
    gauges, factor = _gauges(table, file)
    row = ati.AXES.index(axis)
    place = len(table.columns)
    column = Column(axis, "N" if row < 3 else "N*m")

    def load(indexes: Sequence[int]) -> Loaded:
        plain = [i for i in indexes if i != place]
        if place not in indexes:
            return table.load(indexes)
        loaded = table.load([*plain, *gauges])
        volts = factor * loaded.values[:, len(plain) :].T
        rest = max(1, int(_REST * volts.shape[1]))
        bias = np.nanmedian(volts[:, :rest], axis=1)
        loads = calibration.load(volts, bias)
        known = np.isfinite(loads).all(axis=0)
        says = (
            f"{axis} from six gauge voltages by the calibration of {calibration.serial} "
            f"({calibration.part}, {calibration.date}); the median of the first {rest} rows is "
            "taken as unloaded and subtracted in volts"
        )
        notes = [
            says,
            *(calibration.overload(loads[:, known]) if known.any() else []),
        ]
        values = np.column_stack(
            [loads[row] if i == place else loaded.values[:, plain.index(i)] for i in indexes]
        )
        return replace(loaded, values=values, notes=(*loaded.notes, *notes))

    hidden = [replace(c, content="text") if i in gauges else c for i, c in enumerate(table.columns)]
    return replace(table, columns=(*hidden, column), load=load)


def _gauges(table: Table, file: str) -> tuple[list[int], float]:
    """The six gauge columns in the order of their numbers, and the factor to volts."""
    numbered: dict[int, int] = {}
    for i, column in enumerate(table.columns):
        match = _GAUGE.fullmatch(column.name)
        if match and column.content == "number":
            numbered.setdefault(int(match[1]), i)
    volts = [
        i
        for i, column in enumerate(table.columns)
        if column.unit is not None and units.find(column.unit, "voltage") is not None
    ]
    gauges = [numbered[key] for key in sorted(numbered)] if len(numbered) == 6 else volts
    if len(gauges) != 6:
        raise ReadError(
            f"{file}: --calibration needs six columns of gauge voltages, found {len(gauges)}; name "
            "them G0 [V] ... G5 [V] in the header"
        )
    factors = {
        unit.factor
        for i in gauges
        if (unit := units.find(table.columns[i].unit or "", "voltage")) is not None
    }
    if len(factors) != 1:
        raise ReadError(
            f"{file}: the gauge columns need one unit of voltage; write it as 'G0 [V]' in the "
            "header"
        )
    return gauges, factors.pop()
