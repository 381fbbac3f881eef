"""What a reader cannot know and a user can say: columns, units, marks, encoding; kept as TOML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from dashpot.base.errors import DataError, ReadError
from dashpot.base.options import option
from dashpot.base.units import parse_quantity

ROLES = (
    "time", "displacement", "force", "acceleration",
    "frequency", "storage", "loss", "temperature", "modulus",
)  # fmt: skip
"""Every role that a column can be given by name."""

_DELIMITERS = {
    "tab": "\t", "\\t": "\t", "comma": ",", "semicolon": ";", "space": " ", "spaces": " ",
    "pipe": "|", "colon": ":", "fixed": "fixed",
}  # fmt: skip
_DECIMALS = {"point": ".", "dot": ".", "comma": ","}

_SECTIONS = {
    "columns": ROLES,
    "text": ("delimiter", "decimal", "encoding", "skip_rows"),
    "part": ("segment", "sheet"),
    "transducer": ("calibration", "axis"),
}


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


@dataclass(frozen=True)
class ReadOptions:
    """Answers to what a file leaves open; everything None is found in the file.

    Fields that are options are the command line's.

    Attributes
    ----------
    time, displacement, force, frequency, storage, loss, temperature, modulus : str or None
        The column that plays this role: its name in the file, or its number counted from 1.
        In an impact test `force` is the hammer.
    acceleration : tuple of str
        The acceleration columns of an impact test, in the order wanted.
    units : mapping or tuple of (str, str)
        Unit by role or by column name: ``{"force": "N"}``. Wins over what the file says.
    rate : float or None
        Sampling rate, Hz, of a file without a (good) time column; replaces the time column.
    delimiter, decimal, encoding : str or None
        ``"tab"``, ``"space"``, ``"fixed"`` or the character; ``"."`` or ``","``; a codec name.
    skip_rows : int
        Lines to pass over before anything is looked at.
    segment : int or None
        The segment to read, counted from 1, where a file has several.
    sheet : str or None
        The sheet of a workbook, group of a TDMS file or HDF5 file, by name.
    calibration : str or None
        Path of an ATI ``.cal`` file that turns six gauge voltages into the force.
    axis : str
        The axis of the calibrated transducer that is the force.
    """

    time: str | None = option(None, "Column of time.", metavar="COLUMN")
    displacement: str | None = option(None, "Column of displacement.", metavar="COLUMN")
    force: str | None = option(None, "Column of force (hammer or bench).", metavar="COLUMN")
    acceleration: tuple[str, ...] = option(
        (), "Column of acceleration.", metavar="COLUMN", multiple=True
    )
    frequency: str | None = None
    storage: str | None = None
    loss: str | None = None
    temperature: str | None = None
    modulus: str | None = None
    units: Mapping[str, str] | tuple[tuple[str, str], ...] = option(
        (), 'E.g. "force=N,time=s".', metavar="ROLE=UNIT", multiple=True, parse=all_units
    )
    rate: float | None = option(None, "Sampling rate, if there is no time.", unit="frequency")
    delimiter: str | None = option(None, "tab, space, comma, ';', fixed, ...")
    decimal: str | None = option(None, "point or comma.")
    encoding: str | None = option(None, "E.g. utf-8, cp1250, gb18030.")
    skip_rows: int = option(0, "Lines to pass over.", least=0)
    segment: int | None = option(None, "Which segment of the file.", least=1)
    sheet: str | None = option(None, "Sheet of a workbook, group of TDMS or HDF5.")
    calibration: str | None = option(None, "ATI .cal file: gauge volts to force.", metavar="FILE")
    axis: str = option("Fz", "Axis of the calibrated transducer.")

    def __post_init__(self) -> None:
        pairs = self.units.items() if isinstance(self.units, Mapping) else self.units
        object.__setattr__(self, "units", tuple((str(name), str(unit)) for name, unit in pairs))
        object.__setattr__(self, "acceleration", tuple(self.acceleration))
        if self.rate is not None and not self.rate > 0:
            raise DataError(f"rate = {self.rate!r} Hz; expected a sampling rate > 0")
        if self.skip_rows < 0:
            raise DataError(f"skip_rows = {self.skip_rows}; expected a number of lines >= 0")
        if self.segment is not None and self.segment < 1:
            raise DataError(f"segment = {self.segment}; segments are counted from 1")
        object.__setattr__(self, "delimiter", _delimiter(self.delimiter))
        object.__setattr__(self, "decimal", _decimal(self.decimal))

    def unit_of(self, role: str, column: str) -> str | None:
        """The unit given for a column, by its name or by its role, or None."""
        given = self.by_name()
        return given.get(column.strip().casefold(), given.get(role))

    def by_name(self) -> dict[str, str]:
        """The units given, by role or column name in lower case."""
        return {name.strip().casefold(): unit for name, unit in dict(self.units).items()}

    def over(self, profile: ReadOptions) -> ReadOptions:
        """These options, and the profile's wherever these say nothing."""
        default = ReadOptions()
        stated = {
            one.name: getattr(self, one.name)
            for one in fields(self)
            if getattr(self, one.name) != getattr(default, one.name)
        }
        stated["units"] = {**dict(profile.units), **dict(self.units)}
        return replace(profile, **stated)


def _delimiter(word: str | None) -> str | None:
    mark = word and _DELIMITERS.get(word.lower(), word)
    if mark is not None and len(mark) != 1 and mark != "fixed":
        words = ", ".join(_DELIMITERS)
        raise DataError(f"delimiter '{word}'; expected one character or {words}")
    return mark


def _decimal(word: str | None) -> str | None:
    mark = word and _DECIMALS.get(word.lower(), word)
    if mark not in {".", ",", None}:
        raise DataError(f"decimal mark '{word}'; expected '.' or ','")
    return mark


def dump_profile(options: ReadOptions) -> str:
    """Return the options as a profile: TOML that :func:`load_profile` reads back."""
    default = ReadOptions()
    lines = ["# dashpot reading profile"]
    if options.rate is not None:
        lines.append(f'rate = "{options.rate!r} Hz"')
    for section, names in _SECTIONS.items():
        stated = [
            f"{name} = {_toml(getattr(options, name))}"
            for name in names
            if getattr(options, name) != getattr(default, name)
        ]
        lines += ["", f"[{section}]", *stated] if stated else []
    if options.units:
        lines += [
            "",
            "[units]",
            *(f"{_toml(a)} = {_toml(b)}" for a, b in dict(options.units).items()),
        ]
    return "\n".join(lines) + "\n"


def load_profile(path: str | Path) -> ReadOptions:
    """Return the reading options of a profile, a TOML file.

    Raises
    ------
    ReadError
        If the file is missing, is not TOML, or holds a word that no reader knows.
    """
    import tomllib  # few need it, and it costs time to import

    path = Path(path)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise ReadError(f"{path}: cannot read the profile: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ReadError(f"{path}: not a profile: {error}; expected TOML in UTF-8") from None
    try:
        return _from_toml(content)
    except (DataError, TypeError, ValueError, AttributeError) as error:
        raise ReadError(f"{path}: {error}") from None


def _from_toml(content: dict[str, Any]) -> ReadOptions:
    stated: dict[str, Any] = {}
    for section, entries in content.items():
        if section == "rate":
            given = isinstance(entries, str)
            stated["rate"] = parse_quantity(entries, "frequency") if given else float(entries)
        elif section == "units":
            stated["units"] = {str(name): str(unit) for name, unit in entries.items()}
        elif section in _SECTIONS:
            stated |= {name: _option(section, name, value) for name, value in entries.items()}
        else:
            known = ", ".join(["rate", "units", *_SECTIONS])
            raise DataError(f"'{section}' is unknown in a profile; known are {known}")
    return ReadOptions(**stated)


def _option(section: str, name: str, value: Any) -> Any:
    if name not in _SECTIONS[section]:
        known = ", ".join(_SECTIONS[section])
        raise DataError(f"[{section}] {name} is unknown; known are {known}")
    if name == "acceleration":
        return (value,) if isinstance(value, str) else tuple(map(str, value))
    return int(value) if name in {"skip_rows", "segment"} else str(value)


def _toml(value: object) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_toml(entry) for entry in value) + "]"
    if isinstance(value, int):
        return str(value)
    import json  # few need it, as tomllib

    return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007F")
