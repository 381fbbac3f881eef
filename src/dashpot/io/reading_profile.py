"""Reading options kept in a file: TOML, written once and read with ``--profile``."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

from dashpot.base.errors import DataError, ReadError
from dashpot.base.units import parse_quantity
from dashpot.io.options import ROLES, ReadOptions

_SECTIONS = {
    "columns": ROLES,
    "text": ("delimiter", "decimal", "encoding", "skip_rows"),
    "part": ("segment", "sheet"),
    "transducer": ("calibration", "axis"),
}


def dump_profile(options: ReadOptions) -> str:
    """Return the options as a profile: TOML that :func:`load_profile` reads back."""
    default = ReadOptions()
    lines = ["# dashpot reading profile"]
    if options.rate is not None:
        lines.append(f'rate = "{options.rate!r} Hz"')
    for section, names in _SECTIONS.items():
        said = [
            f"{name} = {_toml(getattr(options, name))}"
            for name in names
            if getattr(options, name) != getattr(default, name)
        ]
        lines += ["", f"[{section}]", *said] if said else []
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
    said: dict[str, Any] = {}
    for section, entries in content.items():
        if section == "rate":
            given = isinstance(entries, str)
            said["rate"] = parse_quantity(entries, "frequency") if given else float(entries)
        elif section == "units":
            said["units"] = {str(name): str(unit) for name, unit in entries.items()}
        elif section in _SECTIONS:
            said |= {name: _option(section, name, value) for name, value in entries.items()}
        else:
            known = ", ".join(["rate", "units", *_SECTIONS])
            raise DataError(f"'{section}' is unknown in a profile; known are {known}")
    return ReadOptions(**said)


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
    return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007F")
