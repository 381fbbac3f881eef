"""Reader of a door from a TOML file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError, ReadError
from dashpot.base.provenance import Source
from dashpot.base.units import Dimension
from dashpot.base.value_ranges import SIZES
from dashpot.datamodel.seal_line import LineFriction, Shear
from dashpot.extensions.systems.door.door_model import (
    Door,
    DoorPoint,
    ModesChoice,
    RigidPart,
    SealChoice,
    ShearChoice,
    Support,
)
from dashpot.extensions.systems.door.named_columns import convert_column_to_si, read_named_columns
from dashpot.extensions.systems.door.read_closing import read_closing, require_keys
from dashpot.extensions.systems.door.read_leak import read_leak_setup
from dashpot.extensions.systems.door.seal_line import Joint, SealLine
from dashpot.reading.readers import channels
from dashpot.reading.toml import Section, Vector, read_tables

MAX_SIZE = SIZES["door"].hard[1]
"""m; no door lies further from the origin of its car's axes, and no seal line is longer."""
LIGHTEST, HEAVIEST = 0.05, 500.0
"""kg, of a door: from a glove box lid to a gate."""
_Z = (0.0, 0.0, 1.0)


def read_door(path: str | Path) -> Door:
    """Return the door that a TOML file describes.

    Each table is read by its own function; an unknown key is refused. Other files that it names lie
    beside it.

    Raises
    ------
    ReadError
        If the file is not TOML, or a table lacks a key, has an unknown one, or an impossible value.
    """
    raw, tables = read_tables(path)
    for name in tables:
        if name not in {*_TABLES, "closing", "leak"}:
            text = ", ".join(f"[{table}]" for table in (*_TABLES, "closing", "leak"))
            raise ReadError(f"{raw.name}: [{name}] is unknown; known are {text}")
    if "door" not in tables:
        raise ReadError(f"{raw.name}: no [door] is in it; expected its mass and its hinges")
    folder = Path(path).parent
    results: dict[str, Any] = {"source": Source(raw.name, raw.sha256, "TOML")}
    for name, entries in tables.items():
        location = _TableLocation(f"{raw.name}, [{name}]", folder)
        try:
            if name == "closing":
                size = Section(location.where, tables["door"], tuple(tables["door"]))
                sizes = (size.quantity(word, "length") for word in ("width", "height"))
                results["closing"] = read_closing(location.where, entries, *sizes)
            elif name == "leak":
                results["leak"] = read_leak_setup(location.where, entries, location.path)
            else:
                results |= _TABLES[name](location, entries)
        except DataError as error:
            raise ReadError(f"{location.where}: {error}") from None
    return Door(**results)


_MAX_PARTS = 200
"""Hinges, bumpers, joints or points of one kind: no door has more."""
_MAX_POINTS = 20_000
"""Largest number of points and stations of a seal line: one each millimetre of the longest."""


@dataclass(frozen=True)
class _TableLocation:
    """Location of a table, and the folder of the files that it names."""

    where: str
    folder: Path

    def section(self, entries: Any, *known_keys: str) -> Section:
        return Section(self.where, entries, known_keys)

    def parse_tables(self, entries: Any, *known_keys: str) -> list[Section]:
        """Return the tables of an array of them; a single table is one."""
        rows = [entries] if isinstance(entries, Mapping) else entries
        if not isinstance(rows, list):
            raise ReadError(f"{self.where}: expected tables, such as [[{self.where[:-1]}]]")
        if len(rows) > _MAX_PARTS:
            raise ReadError(f"{self.where}: {len(rows)} tables; expected at most {_MAX_PARTS}")
        return [
            Section(f"{self.where} {i}", row, known_keys) for i, row in enumerate(rows, start=1)
        ]

    def path(self, word: str | None) -> str:
        """Return the path of a file in the folder of the door or below; refuse any other."""
        if not word:
            return ""
        path = self.folder / word
        if not path.resolve().is_relative_to(self.folder.resolve()):
            raise ReadError(
                f"{self.where}: '{word}' lies outside the folder of the door's file; copy it there"
            )
        return str(path)


_RIGID = ("mass", "inertia", "width", "height", "centre", "motions")


def _read_rigid_body(section: Section) -> RigidPart:
    """Mass and inertia, or those of a uniform plate of that width and height."""
    require_keys(section, "mass", "centre")
    mass = section.quantity("mass", "mass") or 0.0
    inertia = _read_vector(section, "inertia", "moment of inertia")
    if inertia is None:
        if "width" not in section or "height" not in section:
            raise ReadError(
                f"{section.location}: inertia is missing: three moments in kg*m^2, or width "
                "(along x) and height (along y) of an even plate"
            )
        w, h = (section.quantity(name, "length") or 0.0 for name in ("width", "height"))
        inertia = (mass * h**2 / 12, mass * w**2 / 12, mass * (w**2 + h**2) / 12)
    if not mass > 0 or min(inertia) < 0:
        raise ReadError(f"{section.location}: mass {mass:g} kg, inertia {inertia}; expected > 0")
    motions = section.words("motions") or RigidPart.motions
    return RigidPart(mass, inertia, _read_place(section, "centre"), motions)


def _read_door(location: _TableLocation, entries: Any) -> dict[str, Any]:
    section = location.section(entries, *_RIGID)
    sizes = {name: _read_size(section, name) for name in ("width", "height")}
    rigid = _read_rigid_body(section) if "mass" in section else None
    if rigid is not None and not LIGHTEST <= rigid.mass <= HEAVIEST:
        raise ReadError(
            f"{section.location}: mass {rigid.mass:g} kg; expected that of a door, {LIGHTEST:g} to "
            f"{HEAVIEST:g} kg: is its unit kg?"
        )
    for name, size in sizes.items():
        SIZES["door"].refuse(size or 0.0, f"{section.location}: {name} = {size or 0.0:g} m")
    return {"rigid": rigid, **sizes}


def _read_body(location: _TableLocation, entries: Any) -> dict[str, Any]:
    return {"body": _read_rigid_body(location.section(entries, *_RIGID))}


_SUPPORT = ("name", "at", "along", "stiffness", "damping", "fit", "compression")


def _read_supports(kind: str) -> Callable[[_TableLocation, Any], dict[str, Any]]:
    def read(location: _TableLocation, entries: Any) -> dict[str, Any]:
        rows = location.parse_tables(entries, *_SUPPORT)
        supports = tuple(
            _read_support(location, row, f"{kind} {i}" if len(rows) > 1 else kind)
            for i, row in enumerate(rows, start=1)
        )
        if kind == "latch":
            if len(supports) > 1:
                raise ReadError(f"{location.where}: {len(supports)} latches; a door has one")
            return {"latch": supports[0]}
        return {f"{kind}s": supports}

    return read


def _read_support(location: _TableLocation, section: Section, name: str) -> Support:
    require_keys(section, "at")
    direction, fit = section.direction("along"), location.path(section.word("fit"))
    direction_count = 1 if direction else 3
    stiffness = _read_directional_values(section, "stiffness", direction_count)
    damping = _read_directional_values(section, "damping", direction_count)
    if bool(stiffness) == bool(fit):
        raise ReadError(
            f"{section.location}: give its stiffness, or the fit of the part: one of both"
        )
    if fit and direction is None:
        raise ReadError(
            f"{section.location}: along is missing, the direction in which the part acts"
        )
    if len(stiffness) not in {0, direction_count} or len(damping) not in {0, direction_count}:
        raise ReadError(
            f"{section.location}: {len(stiffness)} stiffnesses and {len(damping)} dampings; "
            "expected "
            + ("one of each, along one direction" if direction else "one of each, or x, y and z")
        )
    return Support(
        section.word("name") or name,
        _read_place(section, "at"),
        stiffness,
        damping,
        direction,
        fit,
        section.quantity("compression", "length"),
    )


def _read_directional_values(
    section: Section, name: Literal["stiffness", "damping"], direction_count: int
) -> tuple[float, ...]:
    """Return stiffness or damping in each direction; one number applies to all."""
    values = section.quantities(name, name) or ()
    if any(not 0 <= value < 1e12 for value in values):
        raise ReadError(
            f"{section.location}: a stiffness or a damping is below 0 or beyond any part"
        )
    return values * direction_count if len(values) == 1 else values


def _read_seal(location: _TableLocation, entries: Any) -> dict[str, Any]:
    section = location.section(
        entries, "fit", "length", "temperature", "points", "unit", "closed", "normal",
        "tilt", "compression", "gap", "height", "pitch", "joint", "shear",
        "friction",
    )  # fmt: skip
    require_keys(section, "fit", "points")
    points, columns = _read_point_columns(location, section)
    normal_columns = [columns[name] for name in _NORMAL_KEYS if name in columns]
    normal = normal_columns if len(normal_columns) == 3 else section.direction("normal") or _Z
    normals = np.broadcast_to(np.transpose(normal), points.shape)
    compressions = _read_compression(section, columns, len(points))
    order = np.arange(len(points))
    if section.flag("closed") and not np.array_equal(points[0], points[-1]):
        order = np.append(order, 0)
    compressions = None if compressions is None else compressions[order]
    joints = _read_joints(location, section.entries.get("joint", []))
    normals = normals[order]
    tilt = section.quantity("tilt", "angle")
    if tilt is not None:
        normals = _tilt_normals(section, normals, points[order], tilt)
    line = SealLine(points[order], compressions, normal=normals, joints=joints)
    if line.length > MAX_SIZE:
        raise ReadError(
            f"{section.location}: the seal line is {line.length:.4g} m long; expected at most "
            f"{MAX_SIZE:g} m: is the unit of its points mm?"
        )
    choice = SealChoice(
        location.path(section.word("fit")),
        _read_size(section, "length"),
        section.quantity("temperature", "temperature"),
        _read_size(section, "pitch"),
        _read_shear(location, section.entries.get("shear", {})),
        _read_friction(location, section.entries.get("friction")),
    )
    if choice.pitch:
        _refuse_more(f"{section.location}: pitch", line.length / choice.pitch, "stations")
    return {"line": line, "seal": choice}


def _read_point_columns(
    location: _TableLocation, section: Section
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Points, m, and the other columns of their file."""
    points = section.entries["points"]
    if isinstance(points, str):
        return _read_line_file(location.path(points), section.word("unit"))
    if not isinstance(points, list):
        raise ReadError(
            f"{section.location}: points = {points!r}; expected a file of x, y, z, or a list "
            'such as ["0, 0, 0 mm", "1100, 0, 0 mm"]'
        )
    _refuse_more(section.location, len(points), "points")
    rows = [Section(section.location, {"points": row}, ("points",)) for row in points]
    return np.array([_read_vector(row, "points", "length") for row in rows], dtype=float), {}


_POSITION_KEYS, _COMPRESSION_KEYS, _NORMAL_KEYS = (
    ("x", "y", "z"),
    ("gap", "compression"),
    ("nx", "ny", "nz"),
)


def _read_line_file(path: str, unit: str | None) -> tuple[FloatArray, dict[str, FloatArray]]:
    """The columns of a text file; lengths in the unit of their header, or in the one stated."""
    with channels.open_file(path, None) as file:
        resolved_columns, loaded_columns = read_named_columns(
            file,
            (*_POSITION_KEYS, *_COMPRESSION_KEYS, *_NORMAL_KEYS),
            required=[(axis,) for axis in _POSITION_KEYS],
            hint="expected x, y, z and perhaps gap, compression, nx, ny, nz",
        )
        missing_indices = np.flatnonzero(~np.isfinite(loaded_columns.values).all(axis=1))
        if missing_indices.size:
            raise ReadError(
                "a seal line has no gaps, and a number is missing at "
                f"{loaded_columns.format_row_position(missing_indices[0])}; "
                "expected one in every row. Write it, or take the row out"
            )
        columns = dict(zip(resolved_columns, loaded_columns.values.T, strict=True))
        for name in resolved_columns.keys() - {*_NORMAL_KEYS}:
            advice = "add unit to [seal] of the door"
            columns[name] = convert_column_to_si(
                resolved_columns[name], columns[name], "length", unit, advice
            )
    points = np.stack([columns.pop(axis) for axis in _POSITION_KEYS], axis=1)
    _refuse_more(Path(path).name, len(points), "points")
    return points, columns


def _refuse_more(location: str, count: float, noun: str) -> None:
    """Refuse more of a seal line than any door has."""
    if count > _MAX_POINTS:
        raise ReadError(f"{location}: {count:.0f} {noun}; expected at most {_MAX_POINTS}")


def _read_compression(
    section: Section, columns: Mapping[str, FloatArray], count: int
) -> FloatArray | None:
    """Return how far the seal is pressed at each point: as stated, or its height less the gap."""
    given_keys = [name for name in ("compression", "gap") if name in section.entries]
    if len(given_keys) > 1:
        raise ReadError(f"{section.location}: compression and gap say the same; keep one")
    names = [*filter(columns.__contains__, _COMPRESSION_KEYS), *given_keys]
    if len(names) > 1:
        raise ReadError(f"{section.location}: compression or gap stands there twice; keep one")
    if not names:
        return None
    (name,) = names
    values = np.array(columns[name] if name in columns else section.quantities(name, "length"))
    if len(values) not in {1, count}:
        raise ReadError(f"{section.location}: {len(values)} of {name} for {count} points")
    if name == "gap":
        height = _read_size(section, "height")
        if height is None:
            raise ReadError(
                f"{section.location}: height is missing: what the free seal stands tall, of which "
                "the compression in the gap follows"
            )
        values = height - values
    max_depth = float(np.abs(values).max())
    if max_depth > MAX_SIZE / 100:
        raise ReadError(
            f"{section.location}: {name} makes a compression of {max_depth:g} m: in mm?"
        )
    return np.broadcast_to(values, count)


def _read_shear(location: _TableLocation, entries: Any) -> ShearChoice:
    """Ratios, or fits of their own, across the line and along it."""
    row = Section(f"{location.where[:-1]}.shear]", entries, ("across", "along", "length"))

    def way(name: str) -> float | str:
        if isinstance(row.entries.get(name), str):
            return location.path(row.word(name))
        return row.number(name) or 0.0

    shear_across, shear_along = way("across"), way("along")
    # a ratio that cannot be is refused before any fit is opened
    Shear(
        0.0 if isinstance(shear_across, str) else shear_across,
        0.0 if isinstance(shear_along, str) else shear_along,
    )
    return ShearChoice(shear_across, shear_along, _read_size(row, "length"))


def _read_friction(location: _TableLocation, entries: Any) -> LineFriction | None:
    """Return the sideways friction of the seal."""
    if entries is None:
        return None
    row = Section(f"{location.where[:-1]}.friction]", entries, ("mu", "across", "along"))
    require_keys(row, "mu")
    mu, friction_across, friction_along = (
        row.number(name) or 0.0 for name in ("mu", "across", "along")
    )
    return LineFriction(mu, friction_across, friction_along)


_MAX_NORMAL_ANGLE = np.radians(80.0)
"""Beyond it a seal is pressed along its door, not on it."""


def _tilt_normals(
    section: Section, normals: FloatArray, points: FloatArray, tilt: float
) -> FloatArray:
    """Normals of the pieces, leant outwards of the line by an angle, rad."""
    if not abs(tilt) <= _MAX_NORMAL_ANGLE:
        raise ReadError(
            f"{section.location}: tilt = {np.degrees(tilt):.4g} deg; expected at most "
            f"{np.degrees(_MAX_NORMAL_ANGLE):.0f} deg either way"
        )
    runs = np.diff(points, axis=0)
    mean_normals = normals[1:] + normals[:-1]
    mean_normals /= np.linalg.norm(mean_normals, axis=1)[:, None]
    outwards = np.cross(runs, mean_normals)
    outwards /= np.maximum(np.linalg.norm(outwards, axis=1), 1e-300)[:, None]
    # a line that runs the other way round has its outside on the other hand
    middles = (points[1:] + points[:-1]) / 2 - points.mean(axis=0)
    area = float((np.cross(middles, runs) * mean_normals).sum())
    return np.asarray(np.cos(tilt) * mean_normals + np.sign(area) * np.sin(tilt) * outwards)


def _read_joints(location: _TableLocation, rows: Any) -> tuple[Joint, ...]:
    joints = []
    for row in location.parse_tables(rows, "name", "at", "length", "factor"):
        require_keys(row, "at", "length", "factor")
        position, length = (row.quantity(name, "length") or 0.0 for name in ("at", "length"))
        joints.append(
            Joint(position, length, row.number("factor") or 0.0, row.word("name") or "joint")
        )
    return tuple(joints)


def _read_modes(location: _TableLocation, entries: Any) -> dict[str, Any]:
    section = location.section(entries, "file", "unit", "modal_mass", "damping", "most", "held")
    require_keys(section, "file")
    max_hz = section.quantity("most", "frequency")
    return {
        "modes": ModesChoice(
            location.path(section.word("file")),
            section.word("unit"),
            section.quantity("modal_mass", "mass"),
            section.number("damping"),
            float("inf") if max_hz is None else max_hz,
            section.flag("held"),
        )
    }


def _read_points(location: _TableLocation, entries: Any) -> dict[str, Any]:
    points = []
    for i, row in enumerate(location.parse_tables(entries, "name", "at", "along", "on"), start=1):
        require_keys(row, "at")
        body = row.word("on") or "door"
        if body not in {"door", "body"}:
            raise ReadError(f"{row.location}: on = '{body}'; expected door or body")
        name = row.word("name") or f"point {i}"
        points.append(DoorPoint(name, _read_place(row, "at"), row.direction("along") or _Z, body))
    names = [point.name for point in points]
    repeated_names = [name for name in names if names.count(name) > 1]
    if repeated_names:
        raise ReadError(f"{location.where}: two points are called '{repeated_names[0]}'")
    return {"points": tuple(points)}


def _read_base(location: _TableLocation, entries: Any) -> dict[str, Any]:
    section = location.section(entries, "psd", "along")
    require_keys(section, "psd")
    word = section.word("psd") or ""
    direction = section.direction("along") or _Z
    path = location.folder / word
    return {"base": location.path(word) if path.is_file() else word, "base_along": direction}


def _read_vector(section: Section, name: str, dimension: Dimension) -> Vector | None:
    """Return three quantities, along x, y and z: ``"0, 300, 0 mm"``."""
    values = section.quantities(name, dimension)
    if values is None:
        return None
    if len(values) != 3:
        raise ReadError(
            f"{section.location}: {name} has {len(values)} numbers; expected three, of x, y and z"
        )
    return values[0], values[1], values[2]


def _read_place(section: Section, name: str) -> Vector:
    values = _read_vector(section, name, "length") or (0.0, 0.0, 0.0)
    return _refuse_implausible(section, name, values)


def _read_size(section: Section, name: str) -> float | None:
    value = section.quantity(name, "length")
    if value is None:
        return None
    if not value > 0:
        raise ReadError(f"{section.location}: {name} = {value:g} m; expected a length > 0")
    return _refuse_implausible(section, name, (value, 0.0, 0.0))[0]


def _refuse_implausible(section: Section, name: str, lengths: Vector) -> Vector:
    """Refuse lengths that no door has: most often millimetres that are called metres."""
    max_length = max(map(abs, lengths))
    if max_length > MAX_SIZE:
        raise ReadError(
            f"{section.location}: {name} reaches {max_length:g} m; expected at most {MAX_SIZE:g} "
            "m: is the unit mm?"
        )
    return lengths


_TABLES: Mapping[str, Callable[[_TableLocation, Any], dict[str, Any]]] = MappingProxyType(
    {
        "door": _read_door,
        "hinge": _read_supports("hinge"),
        "latch": _read_supports("latch"),
        "bumper": _read_supports("bumper"),
        "seal": _read_seal,
        "modes": _read_modes,
        "point": _read_points,
        "body": _read_body,
        "base": _read_base,
    }
)
"""Reader of each table; arrays of tables, such as [[hinge]], have the same name."""
