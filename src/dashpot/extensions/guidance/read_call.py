"""Call of `dashpot.read` that does what the options in a message do on the command line."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from dashpot.base.errors import ReadError

_UNITS_OPTION = re.compile(r'--units "?([^"\s();]+=[^"\s();]+)')
_COLUMN_OPTION = re.compile(r'--column ([\w-]+)="([^"]+)"')
_FILE_PART_OPTION = re.compile(r'--file-part (\w+)="?([^"\s;,()]+)')
_RATE_OPTION = re.compile(r"--rate (\d\w+)")
"""Options of the command line as shown in messages, with their values."""
_EXAMPLE = 'columns={"force": "F"}, units={"force": "N"}'


def add_read_call(error: Exception, path: Any) -> None:
    """Raise the error of a file with the Python call in place of the options that it names.

    Raises
    ------
    ReadError
    """
    text = str(error)
    names_option = "--" in text and "(Python: " not in text
    if names_option and isinstance(error, ReadError) and isinstance(path, str | Path):
        raise ReadError(f"{text} (Python: {format_read_call(text, str(path))})") from None


def format_read_call(text: str, path: str) -> str:
    """Return the call of `read` with the options in a message.

    >>> format_read_call('add --units "strain=%,stress=MPa"', "a.csv")
    'dp.read("a.csv", units={"strain": "%", "stress": "MPa"})'
    """
    units = [
        pair.split("=", 1) for pair in ",".join(_UNITS_OPTION.findall(text)).split(",") if pair
    ]
    rates = _RATE_OPTION.findall(text)[:1]
    columns = [pair for pair in _COLUMN_OPTION.findall(text) if not rates or pair[0] != "time"]
    parts = [(key, int(v) if v.isdigit() else v) for key, v in _FILE_PART_OPTION.findall(text)]
    keywords = {"columns": columns, "units": units, "part": parts}
    arguments = [
        f"{name}={json.dumps(dict(pairs), ensure_ascii=False)}"
        for name, pairs in keywords.items()
        if pairs
    ]
    arguments += [f'rate="{rate}"' for rate in rates]
    return f'dp.read("{path}", {", ".join(arguments) or _EXAMPLE})'
