"""Handler of ``dashpot export`` for a door file: its seal as stations."""

from __future__ import annotations

from dashpot.base.errors import ExportError
from dashpot.datamodel.seal_line import Shear, Stations
from dashpot.extensions.systems.door.analyse_file import get_shear
from dashpot.extensions.systems.door.read import read_door


def find_line_stations(
    path: str, pitch: float | None, normal: str | None, temperature: float | None
) -> tuple[Stations, Shear]:
    """Return the stations of a door's seal, with its own compression, joints and normals."""
    door = read_door(path)
    if door.line is None or door.seal is None or normal is not None:
        raise ExportError(
            f"{path}: --normal is for a file of points; the [seal] of a door says its own"
            if normal is not None
            else f"{path}: no [seal] is in it; add one with fit, points and normal"
        )
    requested_pitch = pitch or door.seal.pitch
    if requested_pitch is None:
        raise ExportError(f"{path}: [seal] says no pitch; add --pitch, e.g. 25mm")
    if door.seal.friction is not None:
        raise ExportError(
            f"{path}: no deck of a line holds friction; leave [seal.friction] out of a copy of the "
            "file, and add its ratios to those of [seal.shear] for a seal that sticks"
        )
    kelvin = door.seal.temperature if temperature is None else temperature
    return door.line.stations(requested_pitch), get_shear(door.seal, kelvin)
