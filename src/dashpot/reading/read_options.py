"""Reading options, given by the user and kept as TOML: columns, units, marks, encoding."""

from __future__ import annotations

import codecs
from collections.abc import Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any

from dashpot.base import dataclass, fields, replace
from dashpot.base.errors import DataError, ReadError
from dashpot.base.option_fields import (
    get_option_flag,
    get_option_key,
    iterate_option_fields,
    option,
)
from dashpot.base.units import Dimension, parse_quantity, si_fields

DELIMITERS = {
    "tab": "\t", "\\t": "\t", "comma": ",", "semicolon": ";", "space": " ", "spaces": " ",
    "pipe": "|", "colon": ":", "fixed": "fixed",
}  # fmt: skip
_SHORTEST = 1e-6
"""s; no window decays faster."""
_PROFILE = 1 << 20
"""Bytes of the largest profile."""
_NO_TEXT = {"idna", "punycode", "unicode-escape", "raw-unicode-escape"}
"""Codecs from text to text: of names of machines, of programs."""
_DECIMALS = {"point": ".", "dot": ".", "comma": ","}


def parse_units(text: str) -> dict[str, str]:
    """Return ``{"force": "N", "displacement": "mm"}`` from ``"force=N, displacement=mm"``."""
    units = {}
    for part in text.split(","):
        name, equals, unit = part.rpartition("=")
        if not (equals and name.strip() and unit.strip()):
            raise DataError(
                f"--units \"{text}\": '{part.strip()}' is not 'role=unit'; "
                'write for example --units "force=N,displacement=mm"'
            )
        units[name.strip()] = unit.strip()
    return units


def all_units(texts: Sequence[str]) -> dict[str, str]:
    """Return the units of several such texts; the last word wins."""
    return {name: unit for text in texts for name, unit in parse_units(text).items()}


def _unit_words(units: Sequence[tuple[str, str]]) -> list[str]:
    return [f"{name}={unit}" for name, unit in units]


def _mark_words(delimiter: str) -> list[str]:
    return [{"\t": "tab", " ": "space"}.get(delimiter, delimiter)]


def _column(message: str, **field_options: Any) -> Any:
    """Return the field that names the column of a role: ``--column ROLE=NAME``."""
    return option(
        () if "multiple" in field_options else None,
        message,
        keyed_flag="column",
        section="columns",
        **field_options,
    )


@dataclass(frozen=True)
class ReadOptions:
    """Options for reading a file; those that are None are determined from the file.

    Every field is an option of the command line and a line of a profile.

    Attributes
    ----------
    time, displacement, force : str or None
        The column of this role: its name in the file, or its number counted from 1.
    stress, strain, creep_compliance : str or None
        So too, in a test of a material, or a creep curve.
    stretch : str or None
        Length over length at rest, in place of a strain; of a volumetric test, volume over volume.
    frequency, storage, loss, loss_factor, modulus, temperature : str or None
        So too, in a dynamic test or a relaxation modulus.
    real, imaginary, magnitude, phase, coherence : str or None
        So too, in an FRF; in a dynamic test `magnitude` is the size of K*, `phase` its angle.
    hammer : str or None
        The force of a hammer test; by default `force`.
    velocity : str or None
        Velocity of an indenter.
    acceleration : tuple of str
        The acceleration columns of a hammer test, in the order wanted.
    base_acceleration : str or None
        The acceleration of a base that is shaken, in place of a hammer.
    units : mapping or tuple of (str, str)
        Unit by role or by column name: ``{"force": "N"}``. Has priority over the file.
    rate : float or None
        Sampling rate, Hz, of a file without a (good) time column; replaces the time column.
    window_decay : float or None
        Time constant, s, of an exponential window that hits or an FRF were multiplied by before
        they were written; 0 if there was none.
    delimiter, decimal, encoding : str or None
        ``"tab"``, ``"space"``, ``"fixed"`` or the character; ``"."`` or ``","``; a codec name.
    skip_rows : int
        Lines to pass over before anything is looked at.
    segment : int or None
        The segment to read, counted from 1, where a file has several.
    cycle : int or None
        The loading to use, counted from 1, where a relaxation test has several.
    sheet : str or None
        The sheet of a workbook, group of a TDMS file or HDF5 file, by name.
    format : str or None
        The plug-in that reads the file, in place of the detected format.
    kind : str or None
        Kind of the file, in place of the detected one: ``"relaxation"``, ``"cld"``.
    calibration : str or None
        Path of an ATI ``.cal`` file that turns six gauge voltages into the force.
    axis : str
        The axis of the calibrated transducer that is the force.
    file_options : tuple of (str, ReadOptions)
        Options for files whose name matches a pattern: ``"hammer*.csv"``.
    """

    time: str | None = _column("Column of time, by name or number.")
    displacement: str | None = _column("Column of displacement.")
    force: str | None = _column("Column of force.")
    stress: str | None = _column("Column of stress, in a test of a material.")
    strain: str | None = _column("Column of strain.")
    stretch: str | None = _column("Column of stretch, length over length at rest.")
    creep_compliance: str | None = _column("Column of a creep compliance over time.")
    acceleration: tuple[str, ...] = _column(
        "Column of acceleration; repeat for more.", multiple=True
    )
    hammer: str | None = _column("Column of the hammer's force.")
    base_acceleration: str | None = _column("Column of a shaken base's acceleration: no hammer.")
    velocity: str | None = _column("Column of an indenter's velocity.")
    frequency: str | None = _column("Column of frequency.")
    storage: str | None = _column("Column of storage modulus or stiffness.")
    loss: str | None = _column("Column of loss modulus or stiffness.")
    loss_factor: str | None = _column("Column of the loss factor (tan delta).")
    modulus: str | None = _column("Column of a relaxation modulus over time.")
    temperature: str | None = _column("Column of temperature.")
    real: str | None = _column("Column of the real part of an FRF.")
    imaginary: str | None = _column("Column of its imaginary part.")
    magnitude: str | None = _column("Column of the magnitude of an FRF, or of the size of K*.")
    phase: str | None = _column("Column of its phase, or of the loss angle.")
    coherence: str | None = _column("Column of its coherence.")
    units: Mapping[str, str] | tuple[tuple[str, str], ...] = option(
        (), 'E.g. "force=N,time=s".', metavar="ROLE=UNIT", section="units", multiple=True,
        parse=all_units, unparse=_unit_words,
    )  # fmt: skip
    rate: float | None = option(
        None, "Sampling rate of a file without time.", section="", unit="frequency"
    )
    window_decay: float | None = option(
        None, "Time constant of an exponential window; 0s: none.", section="", unit="time"
    )
    delimiter: str | None = option(
        None, "tab, space, comma, semicolon or fixed.", section="text", keyed_flag="text-format",
        hidden_alias="text", unparse=_mark_words,
    )  # fmt: skip
    decimal: str | None = option(
        None, "point or comma.", section="text", keyed_flag="text-format", hidden_alias="text"
    )
    encoding: str | None = option(
        None,
        "E.g. utf-8, cp1250, gb18030.",
        section="text",
        keyed_flag="text-format",
        hidden_alias="text",
    )
    skip_rows: int = option(
        0,
        "Lines to pass over.",
        section="text",
        minimum=0,
        keyed_flag="text-format",
        hidden_alias="text",
        key="skip",
    )
    segment: int | None = option(
        None,
        "Which segment of the file.",
        section="part",
        minimum=1,
        keyed_flag="file-part",
        hidden_alias="part",
    )
    cycle: int | None = option(
        None,
        "Which loading of several.",
        section="part",
        minimum=1,
        keyed_flag="file-part",
        hidden_alias="part",
    )
    sheet: str | None = option(
        None,
        "Sheet of a workbook, group of TDMS or HDF5.",
        section="part",
        keyed_flag="file-part",
        hidden_alias="part",
    )
    format: str | None = option(
        None, "A plug-in's, by name.", section="part", keyed_flag="file-part", hidden_alias="part"
    )
    kind: str | None = option(
        None,
        "What the file is, if not what it seems.",
        section="part",
        flag="kind",
        hidden_alias="as",
        metavar="KIND",
    )
    calibration: str | None = option(
        None, "ATI .cal file: gauge volts to force.", section="transducer", metavar="FILE"
    )
    axis: str = option(
        "Fz", "Axis of the calibrated transducer.", section="transducer", keyed_flag="calibration"
    )
    file_options: tuple[tuple[str, Any], ...] = ()

    def __post_init__(self) -> None:
        scoped = tuple(
            (str(glob), options if isinstance(options, ReadOptions) else ReadOptions(**options))
            for glob, options in self.file_options
        )
        object.__setattr__(self, "file_options", scoped)
        si_fields(self)
        pairs = self.units.items() if isinstance(self.units, Mapping) else self.units
        object.__setattr__(self, "units", tuple((str(name), str(unit)) for name, unit in pairs))
        object.__setattr__(self, "acceleration", tuple(self.acceleration))
        if self.rate is not None and not self.rate > 0:
            raise DataError(f"rate = {self.rate!r} Hz; expected a sampling rate > 0")
        decay = self.window_decay
        if decay is not None and not (decay == 0 or _SHORTEST <= decay < inf):
            raise DataError(
                f"window_decay = {self.window_decay!r} s; expected 1 us or more, or 0 for none"
            )
        if self.skip_rows < 0:
            raise DataError(f"skip_rows = {self.skip_rows}; expected a number of lines >= 0")
        for name in ("segment", "cycle"):
            number = getattr(self, name)
            if number is not None and number < 1:
                raise DataError(f"{name} = {number}; {name}s are counted from 1")
        if self.encoding is not None:
            _validate_encoding(self.encoding)
        object.__setattr__(self, "delimiter", _delimiter(self.delimiter))
        object.__setattr__(self, "decimal", _decimal(self.decimal))

    def unit_of(self, role: str, column: str) -> str | None:
        """Return the unit given for a column, by its name or by its role, or None."""
        options, name = self.get_units_by_name(), column.strip().casefold()
        by_role = options.get(role, options.get(_ROLE_SYNONYMS.get(role, "")))
        # "force=N" concerns the force, whichever column is it and whatever another is called
        return by_role if by_role and name in _FLAGS else options.get(name, by_role)

    def for_file(self, path: str | Path) -> ReadOptions:
        """Return the options of one file: options for its name take precedence.

        >>> hammer = ReadOptions(force="hammer")
        >>> options = ReadOptions(force="F", file_options=(("h*.csv", hammer),))
        >>> options.for_file("rig/hit.csv").force, options.for_file("seal.csv").force
        ('hammer', 'F')
        """
        options = replace(self, file_options=()) if self.file_options else self
        for glob, own_options in self.file_options:
            if Path(path).match(glob) or str(path) == glob:
                options = own_options.with_defaults(options)
        return options

    @property
    def bench_fields(self) -> tuple[str, ...]:
        """Fields that concern a relaxation test beside a file of vibration.

        The displacement does, but where a base was shaken: there it is that of the mass.
        """
        return OF_BENCH if self.base_acceleration is None else ("cycle",)

    def get_units_by_name(self) -> dict[str, str]:
        """Return the units given, by role or column name in lower case."""
        return {name.strip().casefold(): unit for name, unit in dict(self.units).items()}

    def with_defaults(self, profile: ReadOptions) -> ReadOptions:
        """Return these options, with those of a profile where they are None."""
        default = ReadOptions()
        given_fields = {
            field.name: getattr(self, field.name)
            for field in fields(self)
            if getattr(self, field.name) != getattr(default, field.name)
        }
        given_fields["units"] = {**dict(profile.units), **dict(self.units)}
        given_fields["file_options"] = (*profile.file_options, *self.file_options)
        return replace(profile, **given_fields)

    def select_fields(self, names: Sequence[str]) -> ReadOptions:
        """Return only these fields of the options for all files."""
        selected_fields = {name: getattr(self, name) for name in names if name != "file_options"}
        return ReadOptions(**selected_fields, file_options=self.file_options)

    def drop_fields(self, names: Sequence[str]) -> ReadOptions:
        """Return all but these fields."""
        return self.select_fields([field.name for field in fields(self) if field.name not in names])


OF_HAMMER = (
    "acceleration", "hammer", "base_acceleration", "frequency", "real", "imaginary", "magnitude",
    "phase", "coherence", "window_decay",
)  # fmt: skip
"""Fields that concern a hammer test, whatever other file a command reads."""
OF_BENCH = ("displacement", "cycle")
"""Fields that concern a relaxation test, whatever other file a command reads."""


def _sections() -> dict[str, tuple[str, ...]]:
    """The fields of a profile by section; "" is its head. A field without one is an error."""
    entries: dict[str, tuple[str, ...]] = {}
    for field in iterate_option_fields(ReadOptions):
        section = field.metadata["section"]
        entries[section] = (*entries.get(section, ()), field.name)
    return entries


_SECTIONS = _sections()
_HEAD: Mapping[str, tuple[Dimension, str]] = {
    "rate": ("frequency", "Hz"), "window_decay": ("time", "s"),
}  # fmt: skip
"""Quantities at the head of a profile: their dimension and SI unit."""
PROFILE = frozenset({*_HEAD, "units", *filter(None, _SECTIONS)})
"""Keys of a profile: its tables, and the quantities at its head."""
_OPTION_FIELDS = {field.name: field.metadata for field in iterate_option_fields(ReadOptions)}
_ROLE_SYNONYMS = {"hammer": "force", "complex_modulus": "magnitude", "loss_angle": "phase"}
"""Roles whose unit may be given by another's name."""
_FLAGS = {
    field.name: f"{get_option_flag(field)} {get_option_key(field)}"
    if "keyed_flag" in field.metadata
    else get_option_flag(field)
    for field in iterate_option_fields(ReadOptions)
}


def flag(name: str) -> str:
    """Return the text before ``=`` and the value of a field.

    >>> flag("temperature"), flag("skip_rows")
    ('--column temperature', '--text-format skip')
    """
    return _FLAGS[name]


def _validate_encoding(word: str) -> None:
    """Raise where an encoding does not turn bytes into text, as zlib and punycode do not."""
    try:
        is_ascii_like = "a;1,5".encode(word).decode(word) == "a;1,5"
    except (LookupError, ValueError):
        is_ascii_like = False
    if not is_ascii_like or codecs.lookup(word).name in _NO_TEXT:
        raise DataError(
            f"encoding '{word}' is unknown; give --text-format encoding=utf-8, utf-16, cp1252, "
            "cp1250 or gb18030"
        )


def _delimiter(word: str | None) -> str | None:
    delimiter = word and DELIMITERS.get(word.lower(), word)
    if delimiter is not None and len(delimiter) != 1 and delimiter != "fixed":
        words = ", ".join(DELIMITERS)
        raise DataError(f"delimiter '{word}'; expected one character or {words}")
    return delimiter


def _decimal(word: str | None) -> str | None:
    decimal_mark = word and _DECIMALS.get(word.lower(), word)
    if decimal_mark not in {".", ",", None}:
        raise DataError(f"decimal mark '{word}'; expected '.' or ','")
    return decimal_mark


def dump_profile(options: ReadOptions) -> str:
    """Return the options as a profile: TOML that :func:`load_profile` reads back.

    Raises
    ------
    DataError
        If some of them apply to some files only.
    """
    if options.file_options:
        globs = ", ".join(f"'{glob}:'" for glob, _ in options.file_options)
        raise DataError(
            f"A profile is of one kind of file; {globs} is of some files alone. Save one for each, "
            "without the pattern, and give it as --profile GLOB:lab.toml."
        )
    default = ReadOptions()
    lines = ["# dashpot reading profile"]
    for section, names in sorted(_SECTIONS.items()):
        toml_lines = [
            line
            for name in names
            if getattr(options, name) != getattr(default, name)
            for line in _lines(name, getattr(options, name))
        ]
        header = ["", f"[{section}]"] if section else []
        lines += [*header, *toml_lines] if toml_lines else []
    return "\n".join(lines) + "\n"


def _lines(name: str, value: Any) -> list[str]:
    """Return the lines of a profile that state one field."""
    if name == "units":
        return [f"{_toml(word)} = {_toml(unit)}" for word, unit in dict(value).items()]
    return [
        f'{name} = "{value!r} {_HEAD[name][1]}"' if name in _HEAD else f"{name} = {_toml(value)}"
    ]


def load_profile(path: str | Path) -> ReadOptions:
    """Return the reading options of a profile, a TOML file.

    Raises
    ------
    ReadError
        If the file is missing, is not TOML, or holds a word that no reader knows.
    """
    from dashpot.reading.raw_file import open_raw  # a page of help reads no file
    from dashpot.reading.toml import parsed_toml

    raw = open_raw(path)
    try:
        content = parsed_toml(raw.head(_PROFILE))
    except ReadError as error:
        raise ReadError(f"{path}: not a profile: {error}") from None
    try:
        return _from_toml(content)
    except (DataError, TypeError, ValueError, AttributeError) as error:
        raise ReadError(f"{path}: {error}") from None


def _from_toml(content: dict[str, Any]) -> ReadOptions:
    read_options: dict[str, Any] = {}
    for section, entries in content.items():
        if section in _HEAD:
            is_text = isinstance(entries, str)
            read_options[section] = (
                parse_quantity(entries, _HEAD[section][0]) if is_text else float(entries)
            )
        elif section == "units":
            read_options["units"] = {str(name): str(unit) for name, unit in entries.items()}
        elif section in _SECTIONS:
            read_options |= {name: _option(section, name, value) for name, value in entries.items()}
        else:
            text = ", ".join(sorted(PROFILE))
            raise DataError(f"'{section}' is unknown in a profile; known are {text}")
    return ReadOptions(**read_options)


def _option(section: str, name: str, value: Any) -> Any:
    if name not in _SECTIONS[section]:
        text = ", ".join(_SECTIONS[section])
        raise DataError(f"[{section}] {name} is unknown; known are {text}")
    options = _OPTION_FIELDS[name]
    if "multiple" in options:
        return tuple(map(str, value)) if isinstance(value, list) else (str(value),)
    return int(value) if "minimum" in options else str(value)


def _toml(value: object) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_toml(entry) for entry in value) + "]"
    if isinstance(value, int):
        return str(value)
    import json  # few need it, as tomllib

    return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007F")
