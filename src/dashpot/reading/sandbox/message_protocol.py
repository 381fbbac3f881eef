"""Messages between parent and child process: a JSON head and binary arrays.

The child is not trusted: no pickle, no object but text and numbers, every size bounded before it is
read, every word of the head checked for its type.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable, Iterator
from typing import Any, BinaryIO, TypeAlias, get_args

from dashpot.base.provenance import Caution
from dashpot.reading.sandbox.limits import MAX_SIZE, check_value_count
from dashpot.reading.table import Column, Content, FileTable, Question, make_loader

Reply: TypeAlias = FileTable | dict[str, bytes]
"""A table whose numbers are in memory, or the texts of a file by name."""

_HEAD = 1 << 22
_BLOCK = 1 << 16
"""Numbers that are handed over at a time, or one column of more."""
_CONTENTS = get_args(Content)
_LENGTH = struct.Struct("<Q")


class ProtocolError(Exception):
    """Error of a message that violates the protocol: its sender died or was compromised."""


def send(stream: BinaryIO, head: dict[str, Any], parts: Iterable[bytes | memoryview] = ()) -> None:
    """Write a head and its bytes."""
    text = json.dumps(head).encode()
    stream.write(_LENGTH.pack(len(text)))
    stream.write(text)
    for part in parts:
        stream.write(part)
    stream.flush()


def receive(stream: BinaryIO) -> dict[str, Any]:
    """Read a head.

    Raises
    ------
    Garbled
        If there is none.
    """
    size = _LENGTH.unpack(read_exactly(stream, _LENGTH.size))[0]
    if size > _HEAD:
        raise ProtocolError
    try:
        head = json.loads(read_exactly(stream, size))
    except (ValueError, RecursionError):
        raise ProtocolError from None
    return dict(_validate_type(head, dict))


def read_exactly(stream: BinaryIO, size: int) -> bytes:
    """Read `size` bytes, or raise `ProtocolError`."""
    content = stream.read(size)
    if len(content) < size:
        raise ProtocolError
    return content


def send_reply(stream: BinaryIO, table: Reply) -> None:
    """Write an answer, a table some columns at a time.

    Raises
    ------
    ReadError
        Before anything is written, if it is more than a test can be.
    """
    if isinstance(table, dict):
        check_value_count(sum(map(len, table.values())) // 8, "the sheets hold as much text as")
        send(stream, {"texts": [[k, len(v)] for k, v in table.items()]}, table.values())
        return
    import numpy as np

    width = len(table.columns)
    first = table.load([0])
    rows = len(first.values)
    check_value_count(rows * width, "the file holds")
    head = {
        "format": table.format, "rows": rows, "starts": first.starts, "segments": first.segments,
        "columns": [[c.name, c.unit, c.content, c.factor] for c in table.columns],
        "questions": [[d.message, d.option] for d in table.questions], "simulated": table.simulated,
        "notes": table.notes, "header": table.header, "hints": table.hints,
        "cautions": [i for i, note in enumerate(table.notes) if isinstance(note, Caution)],
    }  # fmt: skip
    blocks = (table.load(range(*columns)).values.T for columns in _blocks(rows, width))
    send(stream, head, (np.ascontiguousarray(block, float).data.cast("B") for block in blocks))


def receive_answer(stream: BinaryIO, head: dict[str, Any]) -> Reply:
    """Read the answer that a head announces.

    Raises
    ------
    Garbled
        If it is none.
    """
    try:
        if "texts" in head:
            sizes = {_validate_type(name, str): _count(size) for name, size in head["texts"]}
            _validate_size(sum(sizes.values()))
            return {name: read_exactly(stream, size) for name, size in sizes.items()}
        return _table(stream, head)
    except (KeyError, TypeError, ValueError):
        raise ProtocolError from None


def _table(stream: BinaryIO, head: dict[str, Any]) -> FileTable:
    import numpy as np

    rows, starts = _count(head["rows"]), tuple(_count(start) for start in head["starts"])
    columns = tuple(
        Column(
            _validate_type(name, str),
            unit if unit is None else _validate_type(unit, str),
            _content(content),
            _validate_type(factor, str),
        )
        for name, unit, content, factor in head["columns"]
    )
    segments = _strings(head["segments"])
    if len(segments) != len(starts) or starts[:1] != (0,) or max(starts) > rows:
        raise ProtocolError
    _validate_size(8 * rows * len(columns))
    values = np.empty((rows, len(columns)))
    for first, stop in _blocks(rows, len(columns)):
        block_values = np.frombuffer(read_exactly(stream, 8 * rows * (stop - first)))
        values[:, first:stop] = block_values.reshape(stop - first, rows).T
    return FileTable(
        format=_validate_type(head["format"], str),
        columns=columns,
        load=make_loader(values, starts, segments),
        simulated=_validate_type(head["simulated"], bool),
        questions=tuple(
            Question(_validate_type(a, str), _validate_type(b, str)) for a, b in head["questions"]
        ),
        notes=_notes(_strings(head["notes"]), head["cautions"]),
        header=_strings(head["header"]),
        hints=_strings(head["hints"]),
    )


def _blocks(rows: int, width: int) -> Iterator[tuple[int, int]]:
    """Yield the first and last column of each block: one column, or thousands of short ones."""
    block_width = max(1, _BLOCK // max(1, rows))
    return ((first, min(first + block_width, width)) for first in range(0, width, block_width))


def _validate_type(value: Any, kind: type) -> Any:
    if not isinstance(value, kind):
        raise ProtocolError
    return value


def _strings(values: Any) -> tuple[str, ...]:
    return tuple(_validate_type(value, str) for value in _validate_type(values, list))


def _notes(notes: tuple[str, ...], cautions: Any) -> tuple[str, ...]:
    """Return the notes, with those at the given positions as cautions."""
    caution_indices = {_count(index) for index in _validate_type(cautions, list)}
    return tuple(Caution(note) if i in caution_indices else note for i, note in enumerate(notes))


def _count(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise ProtocolError
    return value


def _content(value: Any) -> Content:
    if value not in _CONTENTS:
        raise ProtocolError
    content: Content = value
    return content


def _validate_size(size: int) -> None:
    if size > MAX_SIZE:
        raise ProtocolError
