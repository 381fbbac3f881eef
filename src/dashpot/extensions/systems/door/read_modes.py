"""Reader of the modes of a structure: frequencies and shapes at points."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.errors import ReadError
from dashpot.base.units import Dimension, Quantity, convert_to_si, parse_unit
from dashpot.extensions.systems.door.named_columns import convert_column_to_si, read_named_columns
from dashpot.extensions.systems.free_modes import FreeModes
from dashpot.reading.readers import channels
from dashpot.reading.table import Column

_REQUIRED_COLUMNS = ("mode", "frequency", "x", "y", "z")
_SHAPE = ("ux", "uy", "uz")
_OPTIONAL_COLUMNS = ("damping ratio", "modal mass")


def read_modes(
    path: str | Path,
    *,
    unit: str | None = None,
    modal_mass: Quantity | None = None,
    damping: float | None = None,
) -> FreeModes:
    """Return the modes in a file: dataset 55 of UFF with its nodes, or a table.

    A table has a row for each point of each mode, with columns mode, frequency [Hz], x, y, z [mm],
    some of ux, uy, uz (0 where they are missing), and perhaps damping ratio and modal mass [t].
    Shapes are of that modal mass.

    Parameters
    ----------
    path : path
    unit : str, optional
        Unit of the coordinates, where the file does not say.
    modal_mass : str or float, optional
        Modal mass of every mode, where the file does not say: 1 t for shapes that a code in mm, t
        and s has normalised, kg.
    damping : float, optional
        Damping ratio of every mode, in place of the value in the file.

    Raises
    ------
    ReadError
        If a column or a unit is missing, or the modes do not share their points.
    """
    with channels.open_file(path, None) as file:
        resolved_columns, loaded_columns = read_named_columns(
            file,
            (*_REQUIRED_COLUMNS, *_SHAPE, *_OPTIONAL_COLUMNS),
            required=[*((name,) for name in _REQUIRED_COLUMNS), _SHAPE],
            hint=f"modes are a table of {', '.join(_REQUIRED_COLUMNS)} and ux, uy, uz, or a UFF "
            "file with dataset 55",
        )
        columns = dict(zip(resolved_columns, loaded_columns.values.T, strict=True))

        def convert_column(name: str, dimension: Dimension, unit: str | None = None) -> FloatArray:
            advice = 'say it: unit = "mm" in [modes] (Python: unit=)'
            return convert_column_to_si(
                resolved_columns[name], columns[name], dimension, unit, advice
            )

        mass = _get_modal_masses(resolved_columns, columns, convert_to_si(modal_mass, "mass"))
        frequency = convert_column("frequency", "frequency", "Hz")
        positions = np.stack(
            [convert_column(axis, "length", unit) for axis in ("x", "y", "z")], axis=1
        )
        zeros = np.zeros(len(positions))
        shape = np.stack([columns.get(axis, zeros) for axis in _SHAPE], axis=1)
        shape = shape / np.sqrt(mass)[:, None]
        zeta = columns.get("damping ratio", zeros) if damping is None else zeros + damping
        number = columns["mode"]
        gaps = ~np.isfinite(np.column_stack((number, frequency, positions, shape, zeta))).all(
            axis=1
        )
        if gaps.any():
            raise ReadError(
                f"{loaded_columns.format_row_position(int(gaps.argmax()))} lacks a number"
            )
        order = _sort_rows_by_mode(number, positions, frequency)
        column_labels = [
            f"{name} [{column.unit or '-'}]" for name, column in resolved_columns.items()
        ]
        return FreeModes(
            frequency[order[:, 0]],
            positions[order[0]],
            shape[order],
            zeta[order[:, 0]],
            channels.make_source(file, column_labels, file.table.notes),
        )


def _sort_rows_by_mode(
    number: FloatArray, positions: FloatArray, frequency: FloatArray
) -> IndexArray:
    """Return the rows of each mode, all at the same points, shape (modes, points)."""
    counts = np.unique(number, return_counts=True)[1]
    if np.ptp(counts):
        raise ReadError(
            f"the modes have {counts.min()} to {counts.max()} points; expected the same points "
            "in every mode"
        )
    order = np.argsort(number, kind="stable").reshape(len(counts), -1)
    if (positions[order] != positions[order[0]]).any() or np.ptp(frequency[order], axis=1).any():
        raise ReadError(
            "the modes differ in their points, or one mode has two frequencies; write the "
            "same points in the same order for every mode"
        )
    return order


def _get_modal_masses(
    resolved_columns: dict[str, Column], columns: dict[str, FloatArray], stated_mass: float | None
) -> FloatArray:
    """Return the modal mass of each row, kg: as stated, as in the file, or 1 kg."""
    rows = len(columns["mode"])
    if stated_mass is not None or "modal mass" not in columns:
        mass = np.full(rows, 1.0 if stated_mass is None else stated_mass)
    else:
        masses = columns["modal mass"]
        if np.isnan(masses).all():
            return np.ones(rows)
        unit = resolved_columns["modal mass"].unit
        if unit is None:
            raise ReadError(
                'the modal masses have no unit; say it: modal_mass = "1kg" in [modes] (Python: '
                "modal_mass=)"
            )
        mass = channels.scale_to_si(masses.copy(), parse_unit(unit, "mass"))
    if not (mass > 0).all():
        raise ReadError(f"a modal mass is {np.min(mass):g} kg; expected numbers > 0")
    return mass
