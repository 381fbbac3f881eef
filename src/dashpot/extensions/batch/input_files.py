"""Files of a batch, with seal, lot and conditions of each."""

from __future__ import annotations

import csv
import glob
import hashlib
import json
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from string import Formatter
from typing import Any

from dashpot.base.errors import DashpotError, DataError, ReadError
from dashpot.base.file_writing import validate_path
from dashpot.base.option_fields import get_option_key, iterate_option_fields
from dashpot.base.serialisation import to_plain_value
from dashpot.base.units import Dimension, parse_quantity
from dashpot.base.version import is_ours, is_record
from dashpot.datamodel.machine import Machine
from dashpot.reading.raw_file import missing, open_raw
from dashpot.reading.toml import Section, parsed_toml
from dashpot.registry import require_handler

LABELS = ("lot", "seal", "repeat", "operator", "date")
_QUANTITIES: dict[str, Dimension] = {
    "temperature": "temperature", "mass": "mass", "hammer_temperature": "temperature",
}  # fmt: skip
_MANIFEST_COLUMNS = (
    "file",
    *LABELS,
    "temperature",
    "mass",
    "hammer",
    "hammer_temperature",
    "machine",
)
_COLUMN_SYNONYMS: Mapping[str, str] = {
    "filename": "file", "file_name": "file", "path": "file", "batch": "lot",
    **dict.fromkeys(
        ("part", "part_no", "part_number", "specimen", "sample", "serial", "serial_number"), "seal"
    ),
    "test_date": "date", "temp": "temperature", "tester": "operator",
}  # fmt: skip
"""Column of a manifest by its synonyms, in lower case with underscores."""
_DELIMITERS = ",;\t"
_DECIMAL_COMMA = re.compile(r"(\s*[-+]?\d+),(\d+\s*[^\d\s,].*)")
_MAX_MANIFEST_BYTES = 1 << 26
"""Bytes of the largest manifest."""
_HEAD_BYTES = 1 << 12
LOG = "batch.log"
_LOG_LINE = re.compile(rb"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00 ")
_PART_NAME = re.compile(r"part-[0-9a-f]{16}\.parquet")
NO_TABLE = "it is no table of numbers"
"""Why a text or picture of a folder is not read."""
_DOCUMENT_SUFFIXES = frozenset((
    ".avif", ".bat", ".bmp", ".c", ".cfg", ".cpp", ".dll", ".doc", ".docx", ".exe", ".gif",
    ".h", ".htm", ".html", ".ini", ".ipynb", ".jl", ".jpeg", ".jpg", ".lnk", ".m", ".md",
    ".odt", ".pdf", ".png", ".ppt", ".pptx", ".ps1", ".py", ".pyc", ".r", ".rst", ".sh", ".svg",
    ".tex", ".tif", ".tiff", ".webp", ".yaml", ".yml",
))  # fmt: skip
"""Suffixes of files of text, pictures or programs."""
_TEXT_SUFFIXES = frozenset(("", ".log", ".text", ".txt"))
"""Suffixes of files of text or tables."""
_NUMBER = re.compile(r"[-+]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eEdD][-+]?\d+)?")


@dataclass(frozen=True, slots=True)
class Entry:
    """Test of a batch with its files.

    Attributes
    ----------
    file : str
        The path of its record.
    lot, seal, repeat : str
        Lot, seal of the lot, and test of the seal; empty if not stated.
    temperature, mass : float or None
        Temperature of the test, K; mass of the block on the seal, kg.
    hammer : tuple of str
        The hammer's files, or an FRF, of the block on such seals.
    operator : str
        Operator or rig; empty if not stated.
    hammer_temperature : float or None
        Temperature of the seals under the hammer, K; None if it is the same as the test's.
    date : str
        Date of the test as stated; empty if not stated.
    machine : str
        Machine of the test, as JSON; empty if not stated.
    aside : str
        Why the file is not read; empty if it is read.
    """

    file: str
    lot: str = ""
    seal: str = ""
    repeat: str = ""
    temperature: float | None = None
    mass: float | None = None
    hammer: tuple[str, ...] = ()
    operator: str = ""
    hammer_temperature: float | None = None
    aside: str = ""
    date: str = ""
    machine: str = ""

    @staticmethod
    def from_plain(values: dict[str, Any]) -> Entry:
        """Return the entry from plain values of JSON."""
        return Entry(**{**values, "hammer": tuple(values["hammer"])})

    def hashes(self, by: Callable[[str], str] | None = None) -> tuple[str, ...]:
        """SHA-256 of its file and of its hammer's; empty for files that are not read."""
        return (
            ("",) if self.aside else tuple(map(by or compute_file_hash, (self.file, *self.hammer)))
        )


def compute_file_hash(path: str) -> str:
    """Return the SHA-256 of a file's contents; empty if they cannot be read."""
    try:
        if not Path(path).is_file():
            return ""
        with Path(path).open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except (OSError, ValueError):
        return ""


def find_entries(
    paths: Sequence[str | Path],
    *,
    manifest: str | Path | None = None,
    label_pattern: str | None = None,
    pair: str | None = None,
    output_folder: Path,
    allow_none: bool = False,
) -> tuple[Entry, ...]:
    """Return the tests that paths, folders and patterns name, each once, sorted by path.

    Parameters
    ----------
    paths : sequence of path
        Files; from a folder every file is taken, at any depth, but for hidden ones and for results
        that dashpot wrote. A link that leads out of it, a device, a pipe is an entry that is not
        read: it is read if named explicitly.
    manifest : path, optional
        CSV or TOML; the files it lists are added to the paths, and its labels win over
        `label_pattern`.
    label_pattern : str, optional
        A regular expression whose groups, named or in this order, are lot, seal, repeat, operator
        and date.
    pair : str, optional
        The pattern of a test's hammer files, seen from its folder: ``"{stem}_hammer*.csv"``; it may
        hold {stem}, the name of the test's file without its suffix, {lot}, {seal} and {repeat}.
    output_folder : Path
        The folder of the results.
    allow_none : bool
        More files will arrive: a pattern without a file so far is no error.

    Raises
    ------
    ReadError
        If a path names nothing, or the manifest is not one.
    DataError
        If the expression is none, or fits no file, or a pattern pairs nothing.
    """
    manifest_entries = _read_manifest(manifest)
    paths_found = (names for path in paths for names in _expand_path(str(path), output_folder))
    entries = _build_entries_by_path((*paths_found, *((path, "") for path in manifest_entries)))
    if manifest is not None:
        entries.pop(os.path.realpath(manifest), None)
    if not entries and not allow_none:
        raise ReadError(
            f"{', '.join(map(str, paths)) or manifest}: no file is there; give files, folders, "
            "patterns such as 'tests/*.csv', or --manifest FILE"
        )
    function = _parse_labels(
        label_pattern, [entry.file for entry in entries.values()], allow_none=allow_none
    )
    for path_key, item in entries.items():
        entries[path_key] = replace(item, **function(item.file))
    for path, record in manifest_entries.items():
        path_key = os.path.realpath(path)
        entries[path_key] = replace(entries[path_key], **record)
    sorted_entries = sorted(entries.values(), key=lambda entry: entry.file)
    return _select_tests(_add_hammer_files(sorted_entries, pair, allow_none=allow_none))


def _build_entries_by_path(paths: Iterable[tuple[str, str]]) -> dict[str, Entry]:
    """Return each file once, by its real path; files that are not read with the reason."""
    entries: dict[str, Entry] = {}
    for path, reason in paths:
        path_key = path if reason else os.path.realpath(validate_path(path))
        # one text where both are the same: there may be many files
        entries.setdefault(
            path if path == path_key else path_key,
            Entry(_validate_path_encoding(path), aside=reason),
        )
    return entries


def _validate_path_encoding(path: str) -> str:
    """Return the path, which a table holds as text."""
    try:
        path.encode()
    except UnicodeEncodeError:
        printable = path.encode(errors="backslashreplace").decode()
        raise ReadError(
            f"{printable}: the name is not UTF-8, as in a table; rename the file"
        ) from None
    return path


def refuse_invalid_patterns(label_pattern: str | None, pair: str | None) -> None:
    """Refuse an invalid regular expression or pattern before files are searched.

    Raises
    ------
    DataError
    """
    if label_pattern is not None:
        _parse_label_pattern(label_pattern)
    if pair is not None:
        _expand_braces(pair)


def _select_tests(entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """Return all but the files that are another's hammer."""
    hammers = {os.path.realpath(path) for entry in entries for path in entry.hammer}
    return tuple(entry for entry in entries if os.path.realpath(entry.file) not in hammers)


def _add_hammer_files(
    all_entries: Sequence[Entry], pair: str | None, *, allow_none: bool
) -> Sequence[Entry]:
    """Return the entries with their hammers, but for those whose manifest names some."""
    if pair is None:
        return all_entries
    names = _expand_braces(pair)
    entries = [
        entry if entry.hammer else replace(entry, hammer=_find_hammer_files(entry, pair))
        for entry in all_entries
    ]
    if not allow_none:
        _refuse_unpaired(entries, pair, names)
    if entries and not _select_tests(entries):
        raise DataError(
            f"--pair '{pair}' fits the tests themselves, so that all are hammers: name the "
            "hammer's files alone"
        )
    return entries


def _refuse_unpaired(entries: Sequence[Entry], pair: str, names: set[str]) -> None:
    if "stem" not in names and not any(getattr(entry, name) for entry in entries for name in names):
        raise DataError(
            f"--pair '{pair}': no test has a lot, seal or repeat: give --label-pattern too"
        )
    if not any(entry.hammer for entry in entries):
        example = Path(entries[0].file).parent / _format_pair_pattern(entries[0], pair)
        raise DataError(f"--pair '{pair}' finds no hammer file, such as {example}")


def _expand_braces(pair: str) -> set[str]:
    """Return the alternatives in braces of a pattern."""
    try:
        names = {name for _, name, _, _ in Formatter().parse(pair) if name is not None}
    except ValueError as error:
        raise DataError(f"--pair '{pair}' is no pattern: {error}") from None
    if not names or names - {"stem", *LABELS}:
        raise DataError(
            f"--pair '{pair}' holds {', '.join(sorted(names)) or 'no name'} in braces; expected "
            "some of {stem}, {lot}, {seal} and {repeat}, as in '{stem}_hammer*.csv'"
        )
    return names


def _format_pair_pattern(entry: Entry, pair: str) -> str:
    entries = {"stem": Path(entry.file).stem} | {name: getattr(entry, name) for name in LABELS}
    return pair.format(**{name: glob.escape(value) for name, value in entries.items()})


def _find_hammer_files(entry: Entry, pair: str) -> tuple[str, ...]:
    folder = Path(entry.file).parent
    pattern = Path(glob.escape(str(folder))) / _format_pair_pattern(entry, pair)
    names = glob.glob(str(pattern), recursive=True)  # noqa: PTH207 -- it may be absolute
    return tuple(sorted(path for path in names if Path(path).is_file()))


def _expand_path(path: str, output_folder: Path) -> Iterator[tuple[str, str]]:
    """The files of a path, each with the reason why it is not read, if there is one."""
    if Path(path).is_dir():
        yield from _scan_folder(Path(path), output_folder)
    elif Path(path).exists():
        yield path, NO_TABLE if Path(path).suffix.lower() in _DOCUMENT_SUFFIXES else ""
    elif glob.has_magic(path):
        matches = sorted(glob.glob(path, recursive=True))  # noqa: PTH207 -- it may be absolute
        if not matches:
            raise ReadError(f"{path}: the pattern fits no file; give another")
        for name in matches:
            for file, reason in _expand_path(name, output_folder):
                yield file, reason or (NO_TABLE if _is_prose(Path(file)) else "")
    else:
        raise ReadError(missing(path))


def _scan_folder(folder: Path, output_folder: Path) -> Iterator[tuple[str, str]]:
    results, root = output_folder.resolve(), folder.resolve()
    for parent, folders, files in os.walk(folder, onerror=_refuse_unreadable_folder):
        folders[:] = sorted(
            folder
            for folder in folders
            if not folder.startswith(".") and (Path(parent) / folder).resolve() != results
        )
        for file in sorted(files):
            path = Path(parent) / file
            ignored_reason = "" if file.startswith(".") else _get_skip_reason(path, root)
            if ignored_reason:
                yield str(path), ignored_reason
            elif not file.startswith(".") and path.is_file() and not _is_dashpot_result(path):
                yield str(path), NO_TABLE if _is_prose(path) else ""


def _get_skip_reason(path: Path, folder: Path) -> str:
    """Return why a file of a folder is not read; "" if it is, or if it has vanished."""
    if path.is_symlink() and not path.resolve().is_relative_to(folder):
        return "a link that leads out of the folder is not followed; name it to read it"
    if path.exists() and not path.is_file():
        return "a device, a pipe or a socket is no file of a folder; name it to read it"
    return ""


def _is_prose(path: Path) -> bool:
    """Return whether a file of a folder is a text or a picture, by its ending and its lines.

    A line of three cells, or one that is numbers for the most part, may be that of a table, which a
    reader then refuses for what it lacks. A file named explicitly is judged by its ending alone.
    """
    suffix = path.suffix.lower()
    if suffix in _DOCUMENT_SUFFIXES:
        return True
    if suffix not in _TEXT_SUFFIXES:
        return False
    try:
        with path.open("rb") as stream:
            head = stream.read(_HEAD_BYTES)
            is_complete = not stream.read(1)
    except OSError:
        return False
    if not is_complete or not head.strip() or b"\0" in head:
        return False
    return not any(map(_may_be_row, head.decode("utf-8", "replace").splitlines()))


def _may_be_row(line: str) -> bool:
    if len(re.findall(r"[\t;|]", line)) > 1:
        return True
    words = re.findall(r"[^\s;,]+", line)
    numbers = sum(_NUMBER.fullmatch(word) is not None for word in words)
    return numbers > 1 and 2 * numbers > len(words)


def _refuse_unreadable_folder(error: OSError) -> None:
    """Refuse a folder that cannot be read; ignore one that has vanished."""
    if not isinstance(error, FileNotFoundError):
        raise ReadError(
            f"{error.filename}: the folder cannot be read: {error.strerror}; allow it, or give the "
            "other folders and files"
        )


def _is_dashpot_result(path: Path) -> bool:
    """Return whether dashpot wrote it as a result, not as a simulated record.

    Parts and logs of a batch have no byline; tests may lie beside them.
    """
    if _PART_NAME.fullmatch(path.name):
        return True
    try:
        with path.open("rb") as stream:
            head = stream.read(_HEAD_BYTES)
    except OSError:
        return False
    if path.name == LOG:
        return _LOG_LINE.match(head) is not None
    return is_ours(head) and not is_record(head)


def _parse_labels(
    label_pattern: str | None, files: Sequence[str], *, allow_none: bool
) -> Callable[[str], dict[str, Any]]:
    """Return the labels of a file by a regular expression."""
    if label_pattern is None:
        return lambda _: {}
    pattern, group_names = _parse_label_pattern(label_pattern)

    def parse_labels(file: str) -> dict[str, Any]:
        match = pattern.search(Path(file).as_posix())
        return {} if match is None else {
            name: sys.intern(match[i] or "") for i, name in enumerate(group_names, start=1)
        }  # fmt: skip

    if not any(map(parse_labels, files)) and not allow_none:
        raise DataError(
            f"--label-pattern '{label_pattern}' fits none of {len(files)} paths, such as {files[0]}"
        )
    return parse_labels


def _parse_label_pattern(label_pattern: str) -> tuple[re.Pattern[str], tuple[str, ...]]:
    """Return a regular expression, and which label each of its groups is."""
    try:
        pattern = re.compile(label_pattern)
    except re.error as error:
        raise DataError(
            f"--label-pattern '{label_pattern}' is no regular expression: {error}"
        ) from None
    group_names = tuple(pattern.groupindex) or LABELS[: pattern.groups]
    if (
        not 1 <= pattern.groups <= len(LABELS)
        or len(group_names) != pattern.groups
        or set(group_names) - set(LABELS)
    ):
        raise DataError(
            f"--label-pattern '{label_pattern}' has {pattern.groups} groups "
            f"({', '.join(group_names) or 'none'}); "
            r"expected up to five, named or in the order of lot, seal, repeat, operator, date: "
            r"'lot(\w+)_seal(\d+)_rep(\d+)'"
        )
    return pattern, group_names


def _parse_rows(content: bytes, *, toml: bool) -> Any:
    """Return the rows of a manifest; numbers between semicolons have points for decimal commas."""
    from dashpot.reading.text.dialect import find_encoding  # needs NumPy, as --help does not

    if toml:
        return parsed_toml(content).get("test")
    # a degree sign alone is no text by which a code page is known
    signs_alone = {byte for byte in content if byte > 127} <= set("°µ".encode("cp1252"))
    encoding = "cp1252" if signs_alone else find_encoding(content)
    first, *rest = content.decode(encoding).splitlines() or [""]
    if first.lower().startswith("sep="):  # as Excel writes it
        first, *rest = rest or [""]
    delimiter = max(_DELIMITERS, key=first.count)
    rows = list(csv.DictReader([first, *rest], delimiter=delimiter))
    if delimiter == ",":
        return rows
    return [
        {
            name: _DECIMAL_COMMA.sub(r"\1.\2", cell) if isinstance(cell, str) else cell
            for name, cell in row.items()
        }
        for row in rows
    ]


def _name_columns(location: str, row: Any) -> Any:
    """Return a row of a manifest with the usual names of its columns.

    Raises
    ------
    ReadError
        If two columns mean the same.
    """
    if not isinstance(row, Mapping):
        return row
    names: dict[str, str] = {}
    for name in row:
        word = re.sub(r"[\s.-]+", "_", str(name).strip().lower()).strip("_")
        column_name = _COLUMN_SYNONYMS.get(word, word if word in _MANIFEST_COLUMNS else name)
        if column_name in names:
            raise ReadError(
                f"{location}: '{names[column_name]}' and '{name}' are both the {column_name}"
            )
        names[column_name] = name
    return {column_name: row[name] for column_name, name in names.items()}


def _read_manifest(text: str | Path | None) -> dict[str, dict[str, Any]]:
    """Return the entries of a manifest by path; a path in it starts from its own folder."""
    if text is None:
        return {}
    path = Path(text)
    raw = open_raw(path)
    try:
        rows = _parse_rows(raw.head(_MAX_MANIFEST_BYTES), toml=path.suffix.lower() == ".toml")
    except (ReadError, UnicodeDecodeError, csv.Error) as error:
        raise ReadError(f"{path}: not a manifest: {error}; expected CSV or TOML, UTF-8") from None
    if not isinstance(rows, list) or not rows:
        raise ReadError(
            f"{path}: the manifest lists no test; expected a CSV whose first line is "
            f"{','.join(_MANIFEST_COLUMNS)}, or a TOML with a [[test]] for each file"
        )
    entries: dict[str, dict[str, Any]] = {}
    for number, row in enumerate(rows, start=1):
        location = f"{path}, test {number}"
        file, values = _parse_manifest_row(location, row)
        if "machine" in values:
            values["machine"] = _parse_machine(location, values["machine"], path.parent)
        if str(path.parent / file) in entries:
            raise ReadError(f"{location}: {file} is listed twice; keep one")
        values["hammer"] = tuple(str(path.parent / value) for value in values.get("hammer", ()))
        entries[str(path.parent / file)] = values
    return entries


def _parse_manifest_row(location: str, row: Any) -> tuple[str, dict[str, Any]]:
    if isinstance(row, Mapping) and None in row:
        raise ReadError(
            f"{location}: more cells than the first line has names: {', '.join(row[None])}"
        )
    entries = Section(location, _name_columns(location, row), _MANIFEST_COLUMNS).entries
    values: dict[str, Any] = {
        name: str(value).strip() for name, value in entries.items() if value not in (None, "")
    }
    file = values.pop("file", "")
    if not file:
        raise ReadError(f"{location}: it names no file; fill the column 'file'")
    for name in [text for text in values if text in _QUANTITIES]:
        try:
            values[name] = parse_quantity(values[name], _QUANTITIES[name])
        except DataError as error:
            raise ReadError(f"{location}: {name}: {error}") from None
    values["hammer"] = _parse_text_list(entries.get("hammer"))
    return file, values


def _parse_machine(location: str, text: str, folder: Path) -> str:
    """Return a machine as JSON: of ``compliance=33um/N;sync=1ms``, or of a machine file."""
    try:
        if text.endswith(".toml"):
            machine = Machine(**require_handler("read option", "--machine")(str(folder / text)))
        else:
            machine = Machine(**_parse_machine_fields(text))
    except DashpotError as error:
        raise ReadError(f"{location}: machine: {error}") from None
    # one text for all tests of a machine: there may be many
    return sys.intern(json.dumps(to_plain_value(machine), sort_keys=True))


def _parse_machine_fields(text: str) -> dict[str, Any]:
    known = {get_option_key(field): field for field in iterate_option_fields(Machine)}
    fields: dict[str, Any] = {}
    for part in filter(None, map(str.strip, re.split(r"[;,](?=\s*[A-Za-z][\w -]*=)", text))):
        key, _, value = part.partition("=")
        field = known.get(re.sub(r"[ _]", "-", key.strip().lower()))
        if field is None or not value.strip():
            raise DataError(
                f"'{part}'; expected a machine file (.toml), or some of "
                f"{', '.join(f'{name}=' for name in known)} with a value, such as "
                "compliance=50um/N, and ';' between them"
            )
        fields[field.name] = parse_quantity(value.strip(), field.metadata["unit"])
    return fields


def _parse_text_list(value: object) -> list[str]:
    """Return the texts of a list, or between semicolons."""
    parts = value if isinstance(value, list) else str(value or "").split(";")
    return [text for name in parts if (text := str(name).strip())]
