"""ATI force/torque transducers: gauge voltages to force and torque, by their ``.cal`` file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from dashpot.base import dataclass, replace, units
from dashpot.base.arrays import EqualByValue, FloatArray, make_readonly_copy
from dashpot.base.errors import ReadError
from dashpot.reading.raw_file import RawFile, add_name_to_errors, open_raw
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import Column, FileTable, LoadedColumns

AXES = ("Fx", "Fy", "Fz", "Tx", "Ty", "Tz")
_NEAR_RANGE_SHARE = 0.9
_LOW_RANGE_SHARE = 0.05
"""Part of a range of which its maker's error, a hundredth of the range, is a fifth and more."""
_MAX_SIZE = 1 << 20
_GAUGE = re.compile(r"(?:\b|_)(?:sg|g|gauge|gage|ch|ai|v|volt|voltage)[\s_]{0,9}(\d)\b", re.I)
_UNLOADED_SHARE = 0.02
"""Fraction of the record, from its start, whose median is the unloaded voltages."""


@dataclass(frozen=True, eq=False)
class Calibration(EqualByValue):
    r"""Calibration of a transducer: :math:`[F; T] = C\,(v - v_0)`.

    Attributes
    ----------
    serial, part, date : str
    matrix : array, shape (6, 6)
        C, N/V for the forces and N m/V for the torques.
    axis_range : array, shape (6,)
        Range of each axis, N and N m.
    """

    serial: str
    part: str
    date: str
    matrix: FloatArray
    axis_range: FloatArray

    def compute_load(self, volts: FloatArray, bias: FloatArray | None = None) -> FloatArray:
        """Return force and torque, shape (6, n), of gauge voltages, shape (6, n).

        The bias, six voltages of the unloaded transducer, is subtracted in volts.
        """
        bias_voltages = np.zeros(6) if bias is None else np.asarray(bias, dtype=float)
        return np.asarray(self.matrix @ (np.asarray(volts, dtype=float) - bias_voltages[:, None]))

    def note_overloads(self, load: FloatArray) -> list[str]:
        """Return a note on axes that pass 90 % of their range."""
        ratio = np.abs(load).max(axis=1) / self.axis_range
        return [
            f"{axis} reaches {100 * part:.0f} % of its range {limit:g} "
            f"{'N' if axis[0] == 'F' else 'N m'}: a transducer may saturate before its limit"
            for axis, part, limit in zip(AXES, ratio, self.axis_range, strict=True)
            if part > _NEAR_RANGE_SHARE
        ]

    def note_small_loads(self, load: FloatArray, axis: str) -> list[str]:
        """Return a note on axes that use little of their range."""
        axis_index = AXES.index(axis)
        limit, max_load = float(self.axis_range[axis_index]), float(np.abs(load[axis_index]).max())
        if not 0 < max_load < _LOW_RANGE_SHARE * limit:
            return []
        unit = "N" if axis[0] == "F" else "N m"
        range_text = f"{axis} reaches {100 * max_load / limit:.2g} % of its range {limit:g} {unit}"
        times = f"{limit / max_load:.0f} times that part of this load"
        return [f"{range_text}: what its maker states as a part of the range is {times}"]


def read_calibration(path: str | Path) -> Calibration:
    r"""Return the calibration in an ATI ``.cal`` file of either version.

    Version 1.1 holds the matrix in use, ``UserAxis``. Version 1.0 holds scaled rows, ``Axis``,
    about the transducer's own origin: with :math:`U = A/\mathrm{scale}` row by row and
    :math:`d` from ``BasicTransform``, the torques about the tool face are
    :math:`T' = T - d \times F`.

    Raises
    ------
    ReadError
        If the file is no calibration, lacks an axis or a unit, or its transform turns the axes.
    """
    content = open_raw(path).head(_MAX_SIZE + 1)
    with add_name_to_errors(Path(path).name):
        root, sensor = _parse_calibration(content)
        force = _get_factor(sensor.get("ForceUnits"), "force")
        torque = _get_factor(sensor.get("TorqueUnits"), "torque")
        si = np.repeat([force, torque], 3)
        rows, limits, scaled = _read_matrix(sensor)
        matrix = rows * si[:, None]
        return Calibration(
            serial=root.get("Serial", ""),
            part=sensor.get("PartNumber", ""),
            date=sensor.get("CalDate", ""),
            matrix=make_readonly_copy(
                _transform_to_tool_face(sensor, matrix) if scaled else matrix
            ),
            axis_range=make_readonly_copy(limits * si),
        )


def _parse_calibration(content: bytes) -> tuple[ET.Element, ET.Element]:
    """Return the root of a calibration file and its calibration."""
    no = "not an ATI calibration file"
    if len(content) > _MAX_SIZE or b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise ReadError(no)
    try:
        root = ET.fromstring(content)  # noqa: S314 - entities are refused above
    except (ET.ParseError, ValueError, LookupError) as error:
        raise ReadError(f"{no}: {error}") from None
    sensor = root.find("Calibration")
    if root.tag != "FTSensor" or sensor is None:
        raise ReadError(f"{no}: no FTSensor/Calibration in it")
    return root, sensor


def _get_factor(word: str | None, dimension: units.Dimension) -> float:
    unit = units.find_unit(word or "", dimension)
    if unit is None:
        raise ReadError(f"'{word}' is no unit of {dimension} that dashpot knows")
    return unit.factor


def _read_matrix(sensor: ET.Element) -> tuple[FloatArray, FloatArray, bool]:
    """Return the matrix in the file's units, the ranges, and whether it is the scaled form."""
    users = {entry.get("Name"): entry for entry in sensor.findall("UserAxis")}
    elements = users or {entry.get("Name"): entry for entry in sensor.findall("Axis")}
    matrix, limits = np.empty((6, 6)), np.empty(6)
    for i, axis in enumerate(AXES):
        entry = elements.get(axis)
        if entry is None:
            raise ReadError(f"axis {axis} is missing")
        try:
            row = np.array(entry.get("values", "").split(), dtype=float)
            scale = 1.0 if users else float(entry.get("scale", "nan"))
            limits[i] = float(entry.get("max", "nan"))
            matrix[i] = row / scale
        except ValueError:
            raise ReadError(f"axis {axis} does not hold six numbers") from None
    if not (np.isfinite(matrix).all() and (limits > 0).all()):
        raise ReadError("an axis lacks its scale or its range")
    return matrix, limits, not users


def _transform_to_tool_face(sensor: ET.Element, matrix: FloatArray) -> FloatArray:
    """Torques about the tool face, from those about the transducer's origin."""
    entry = sensor.find("BasicTransform")
    if entry is None:
        return matrix
    try:
        shift = np.array([float(entry.get(key, "0")) for key in ("Dx", "Dy", "Dz")])
        turn = [float(entry.get(key, "0")) for key in ("Rx", "Ry", "Rz")]
    except ValueError:
        raise ReadError("BasicTransform does not hold numbers") from None
    if any(turn):
        raise ReadError(
            f"BasicTransform turns the axes ({turn}), which a version 1.0 file does not "
            "define clearly; ask for a calibration file of version 1.1"
        )
    shift = shift * _get_factor(sensor.get("DistUnits"), "length")
    change = matrix.copy()
    change[3:] -= np.cross(shift, matrix[:3], axisb=0, axisc=0)
    return change


def add_calibrated_force(table: FileTable, raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the table with the axis of the calibrated transducer as one more column, the force.

    The bias is the median of the first rows, subtracted in volts.

    Raises
    ------
    ReadError
        If the table has not six columns of gauge voltages, in order.
    """
    axis = options.axis
    if axis not in AXES:
        raise ReadError(f"--calibration ...,axis={axis}: expected one of {', '.join(AXES)}")
    calibration = read_calibration(str(options.calibration))
    with add_name_to_errors(raw.name):
        gauges, factor = _find_gauge_columns(table)
    row, force_column = AXES.index(axis), len(table.columns)

    def load(indexes: Sequence[int]) -> LoadedColumns:
        if force_column not in indexes:
            return table.load(indexes)
        plain_columns = [i for i in indexes if i != force_column]
        loaded_columns = table.load([*plain_columns, *gauges])
        loads, notes = _compute_loads(
            calibration, factor * loaded_columns.values[:, len(plain_columns) :].T, axis
        )
        column = dict(zip(plain_columns, loaded_columns.values.T, strict=False)) | {
            force_column: loads[row]
        }
        values = np.column_stack([column[i] for i in indexes])
        return replace(loaded_columns, values=values, notes=(*loaded_columns.notes, *notes))

    hidden = [replace(c, content="text") if i in gauges else c for i, c in enumerate(table.columns)]
    column = Column(axis, "N" if row < 3 else "N*m")
    return replace(table, columns=(*hidden, column), load=load)


def _compute_loads(
    calibration: Calibration, volts: FloatArray, axis: str
) -> tuple[FloatArray, list[str]]:
    """Force and torque of gauge voltages, the first of which are of the unloaded transducer."""
    unloaded_samples = max(1, int(_UNLOADED_SHARE * volts.shape[1]))
    loads = calibration.compute_load(volts, np.nanmedian(volts[:, :unloaded_samples], axis=1))
    values = np.isfinite(loads).all(axis=0)
    message = (
        f"{axis} from six gauge voltages by the calibration of {calibration.serial} "
        f"({calibration.part}, {calibration.date}); the median of the first {unloaded_samples} "
        "rows is taken as unloaded and subtracted in volts"
    )
    if not values.any():
        return loads, [message]
    loads_selected = loads[:, values]
    return loads, [
        message,
        *calibration.note_overloads(loads_selected),
        *calibration.note_small_loads(loads_selected, axis),
    ]


def _find_gauge_columns(table: FileTable) -> tuple[list[int], float]:
    """Return the six gauge columns in the order of their numbers, and the factor to volts."""
    new_units = [units.find_unit(column.unit or "", "voltage") for column in table.columns]
    volts = {i: unit.factor for i, unit in enumerate(new_units) if unit is not None}
    gauges = _find_numbered_gauges(table) or list(volts)
    if len(gauges) != 6:
        raise ReadError(
            f"--calibration needs six columns of gauge voltages, found {len(gauges)}; name "
            "them G0 [V] ... G5 [V] in the header"
        )
    factors = {volts[i] for i in gauges if i in volts}
    if len(factors) != 1:
        raise ReadError(
            "the gauge columns need one unit of voltage; write it as 'G0 [V]' in the header"
        )
    return gauges, factors.pop()


def _find_numbered_gauges(table: FileTable) -> list[int]:
    """Return the six columns that are called gauges by number, in that order; none if not six."""
    entries: dict[int, int] = {}
    for i, column in enumerate(table.columns):
        numbers = _GAUGE.findall(column.name)
        if numbers and column.content == "number":
            entries.setdefault(int(numbers[-1]), i)
    return [entries[number] for number in sorted(entries)] if len(entries) == 6 else []
