r"""ATI force/torque transducers: six gauge voltages to force and torque, by their ``.cal`` file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from dashpot.base import units
from dashpot.base.arrays import ByValue, FloatArray, frozen
from dashpot.base.errors import ReadError

AXES = ("Fx", "Fy", "Fz", "Tx", "Ty", "Tz")
_NEAR = 0.9
_LARGEST = 1 << 20


@dataclass(frozen=True, eq=False)
class Calibration(ByValue):
    r"""A transducer's calibration: :math:`[F; T] = C\,(v - v_0)`.

    Attributes
    ----------
    serial, part, date : str
    matrix : array, shape (6, 6)
        C, N/V for the forces and N m/V for the torques.
    limit : array, shape (6,)
        Range of each axis, N and N m.
    """

    serial: str
    part: str
    date: str
    matrix: FloatArray
    limit: FloatArray

    def load(self, volts: FloatArray, bias: FloatArray | None = None) -> FloatArray:
        """Return force and torque, shape (6, n), of gauge voltages, shape (6, n).

        The bias, six voltages of the unloaded transducer, is subtracted in volts.
        """
        unloaded = np.zeros(6) if bias is None else np.asarray(bias, dtype=float)
        return np.asarray(self.matrix @ (np.asarray(volts, dtype=float) - unloaded[:, None]))

    def overload(self, load: FloatArray) -> list[str]:
        """Say which axes pass 90 % of their range."""
        share = np.abs(load).max(axis=1) / self.limit
        return [
            f"{axis} reaches {100 * part:.0f} % of its range {limit:g} "
            f"{'N' if axis[0] == 'F' else 'N m'}: a transducer may saturate before its limit"
            for axis, part, limit in zip(AXES, share, self.limit, strict=True)
            if part > _NEAR
        ]


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
    name = Path(path).name
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise ReadError(f"{path}: cannot be read: {error.strerror}") from None
    if len(content) > _LARGEST or b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise ReadError(f"{name}: not an ATI calibration file")
    try:
        root = ET.fromstring(content)  # noqa: S314 - entities are refused above
    except (ET.ParseError, ValueError, LookupError) as error:
        raise ReadError(f"{name}: not an ATI calibration file: {error}") from None
    said = root.find("Calibration")
    if root.tag != "FTSensor" or said is None:
        raise ReadError(f"{name}: not an ATI calibration file: no FTSensor/Calibration in it")
    force = _factor(name, said.get("ForceUnits"), "force")
    torque = _factor(name, said.get("TorqueUnits"), "torque")
    rows, limits, scaled = _rows(name, said)
    matrix = rows * np.repeat([force, torque], 3)[:, None]
    if scaled:
        matrix = _moved(name, said, matrix)
    return Calibration(
        serial=root.get("Serial", ""),
        part=said.get("PartNumber", ""),
        date=said.get("CalDate", ""),
        matrix=frozen(matrix),
        limit=frozen(limits * np.repeat([force, torque], 3)),
    )


def _factor(name: str, word: str | None, dimension: units.Dimension) -> float:
    unit = units.find(word or "", dimension)
    if unit is None:
        raise ReadError(f"{name}: '{word}' is no unit of {dimension} that dashpot knows")
    return unit.factor


def _rows(name: str, said: ET.Element) -> tuple[FloatArray, FloatArray, bool]:
    """The matrix in the file's units, the ranges, and whether it is the scaled form."""
    users = {entry.get("Name"): entry for entry in said.findall("UserAxis")}
    plain = {entry.get("Name"): entry for entry in said.findall("Axis")}
    scaled = not users
    found = plain if scaled else users
    matrix, limits = np.empty((6, 6)), np.empty(6)
    for i, axis in enumerate(AXES):
        entry = found.get(axis)
        if entry is None:
            raise ReadError(f"{name}: axis {axis} is missing")
        try:
            row = [float(text) for text in entry.get("values", "").split()]
            scale = float(entry.get("scale", "nan")) if scaled else 1.0
            limits[i] = float(entry.get("max", "nan"))
            matrix[i] = np.array(row) / scale
        except ValueError:
            raise ReadError(f"{name}: axis {axis} does not hold six numbers") from None
    if not (np.isfinite(matrix).all() and (limits > 0).all()):
        raise ReadError(f"{name}: an axis lacks its scale or its range")
    return matrix, limits, scaled


def _moved(name: str, said: ET.Element, matrix: FloatArray) -> FloatArray:
    """Torques about the tool face, from those about the transducer's origin."""
    entry = said.find("BasicTransform")
    if entry is None:
        return matrix
    try:
        shift = np.array([float(entry.get(key, "0")) for key in ("Dx", "Dy", "Dz")])
        turn = [float(entry.get(key, "0")) for key in ("Rx", "Ry", "Rz")]
    except ValueError:
        raise ReadError(f"{name}: BasicTransform does not hold numbers") from None
    if any(turn):
        raise ReadError(
            f"{name}: BasicTransform turns the axes ({turn}), which a version 1.0 file does not "
            "define beyond doubt; ask for a calibration file of version 1.1"
        )
    shift = shift * _factor(name, said.get("DistUnits"), "length")
    moved = matrix.copy()
    moved[3:] -= np.cross(shift, matrix[:3], axisb=0, axisc=0)
    return moved
