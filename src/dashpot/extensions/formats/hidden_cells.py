"""Hidden rows and columns of a workbook, which are read with a note.

Detected in xlsx and ods alone, whose parts are XML, not in the older xls and in xlsb.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from typing import BinaryIO
from xml.sax.saxutils import unescape

_CHUNK = 1 << 20
_TAG = 1 << 12
"""Bytes of a tag, at most."""
_MAX_LISTED = 8
_LISTED = re.compile(rb"<(?:\w{1,20}:)?(Relationship|sheet)\b([^<>]{0,4000})>")
"""Tags that name the parts of a workbook."""
_TAGS = re.compile(
    rb"<(?:\w{1,20}:)?(row|col|table-row|table-column|table)(?=[\s/>])([^<>]{0,4000})>"
)
_WORD = re.compile(rb"(?<![\w:-])([\w:-]{1,60}+)\s*+=\s*+\"([^\"]{0,1000})\"")
_HIDING_ATTRIBUTES = {b"1", b"true", b"collapse", b"filter"}


def list_hidden_cells(stream: BinaryIO) -> dict[str, str]:
    """Return the hidden rows and columns of each sheet, such as "rows 3, 4 and column D"."""
    stream.seek(0)
    if not zipfile.is_zipfile(stream):
        return {}
    tables: dict[str, str] = {}
    with zipfile.ZipFile(stream) as archive:
        names = set(archive.namelist())
        parts = list_sheet_parts(archive)
        for name, part in parts.items():
            text = _format_hidden_cells(*_scan_xlsx_sheet(_iterate_tags(archive, part)))
            if text:
                tables[name] = text
        if not parts and "content.xml" in names:
            tables = _scan_ods_tables(_iterate_tags(archive, "content.xml"))
    return tables


def list_sheet_parts(archive: zipfile.ZipFile) -> dict[str, str]:
    """Return the archive member of each sheet of an xlsx file; empty for other files."""
    names = set(archive.namelist())
    if "xl/workbook.xml" not in names:
        return {}
    links = dict(
        _iterate_attributes(archive, "xl/_rels/workbook.xml.rels", b"Relationship", "Id", "Target")
    )
    sheet_attributes = _iterate_attributes(archive, "xl/workbook.xml", b"sheet", "name", "id")
    parts = {name: links.get(link, "").removeprefix("/xl/") for name, link in sheet_attributes}
    return {name: f"xl/{part}" for name, part in parts.items() if f"xl/{part}" in names}


def _iterate_attributes(
    archive: zipfile.ZipFile, part: str, tag: bytes, first: str, second: str
) -> Iterator[tuple[str, str]]:
    """Two attributes of every tag of a small part."""
    if part not in archive.namelist():
        return
    with archive.open(part) as stream:
        text = stream.read(_CHUNK)
    for match in _LISTED.finditer(text):
        words = _parse_attributes(match[2])
        if match[1] == tag and first in words and second in words:
            yield unescape(words[first], {"&quot;": '"'}), words[second]


def _parse_attributes(text: bytes) -> dict[str, str]:
    """Return the attributes of a tag, without the prefixes of their names."""
    return {
        word.rpartition(b":")[2].decode(): value.decode("utf-8", "replace")
        for word, value in _WORD.findall(text)
    }


def _iterate_tags(archive: zipfile.ZipFile, part: str) -> Iterator[tuple[str, dict[str, str]]]:
    """The tags of rows, columns and tables of a part, block by block."""
    rest = b""
    with archive.open(part) as stream:
        while block := stream.read(_CHUNK):
            text = rest + block
            tag_start = text.rfind(b"<")  # a tag may go on in the next block
            rest = text[tag_start:][:_TAG] if tag_start >= 0 else b""
            for match in _TAGS.finditer(text[:tag_start] if tag_start >= 0 else text):
                yield match[1].decode(), _parse_attributes(match[2])
        for match in _TAGS.finditer(rest):
            yield match[1].decode(), _parse_attributes(match[2])


def _scan_xlsx_sheet(tags: Iterator[tuple[str, dict[str, str]]]) -> tuple[list[int], list[int]]:
    """Return the hidden rows and columns of one sheet of an xlsx file, counted from 1."""
    rows: list[int] = []
    columns: list[int] = []
    row = 0
    for tag, words in tags:
        is_hidden = words.get("hidden", "").encode() in _HIDING_ATTRIBUTES
        if tag == "row":
            row = _parse_whole_number(words.get("r", "")) or row + 1
            rows += [row] if is_hidden else []
        elif tag == "col" and is_hidden:
            first = _parse_whole_number(words.get("min", "")) or 1
            last = min(_parse_whole_number(words.get("max", "")) or first, first + _MAX_LISTED)
            columns += range(first, last + 1)
    return rows, columns


def _scan_ods_tables(tags: Iterator[tuple[str, dict[str, str]]]) -> dict[str, str]:
    """Return the hidden rows and columns of every table of an ods file."""
    entries: dict[str, tuple[list[int], list[int]]] = {}
    name, positions = "", {"table-row": 0, "table-column": 0}
    for tag, words in tags:
        if tag == "table":
            name, positions = unescape(words.get("name", "")), dict.fromkeys(positions, 0)
            entries[name] = [], []
        elif tag in positions and name in entries:
            is_hidden = words.get("visibility", "").encode() in _HIDING_ATTRIBUTES
            count = max(
                _parse_whole_number(words.get("number-rows-repeated", "")),
                _parse_whole_number(words.get("number-columns-repeated", "")), 1,
            )  # fmt: skip
            if is_hidden:
                first = positions[tag] + 1
                entries[name][tag == "table-column"].extend(
                    range(first, first + min(count, _MAX_LISTED))
                )
            positions[tag] += count
    return {name: text for name, entry in entries.items() if (text := _format_hidden_cells(*entry))}


def _parse_whole_number(text: str) -> int:
    return int(text) if text.isascii() and text.isdigit() and len(text) < 9 else 0


def _format_hidden_cells(rows: list[int], columns: list[int]) -> str:
    """Return the hidden cells as text; "" if there are none."""
    parts = [
        _format_places("row", [str(row) for row in rows]),
        _format_places("column", [_get_column_letters(column) for column in columns]),
    ]
    return " and ".join(filter(None, parts))


def _format_places(noun: str, names: list[str]) -> str:
    if not names:
        return ""
    more_text = f" and {len(names) - _MAX_LISTED} more" if len(names) > _MAX_LISTED else ""
    return f"{noun}{'s' * (len(names) > 1)} {', '.join(names[:_MAX_LISTED])}{more_text}"


def _get_column_letters(column: int) -> str:
    """Return the letters over a column of a sheet."""
    letters = ""
    while column > 0:
        column, letter_index = divmod(column - 1, 26)
        letters = chr(65 + letter_index) + letters
    return letters
