"""Metadata of the fields of an Arrow schema, as Parquet and Arrow files keep it."""

from __future__ import annotations

import base64
import struct

_SCHEMA_HEADER, _FIELDS, _TABLE_METADATA, _NAME, _METADATA = 2, 1, 2, 0, 6
"""Places of a message's header, a schema's fields and metadata, a field's name and metadata."""
_MAX_MEMBERS = 10_000
_CONTINUATION_MARK = b"\xff\xff\xff\xff"


def read_schema_metadata(message: bytes) -> tuple[dict[str, str], dict[str, dict[str, str]]]:
    """Return the metadata of table and fields in the schema of an encapsulated message.

    References
    ----------
    Apache Arrow columnar format, Message.fbs and Schema.fbs.
    """
    start = 8 if message.startswith(_CONTINUATION_MARK) else 4
    data = message[start:]
    try:
        root = struct.unpack_from("<I", data, 0)[0]
        schema = _follow_offset(data, _find_member(data, root, _SCHEMA_HEADER))
        fields = {
            _read_text(data, _find_member(data, field, _NAME)): _read_metadata_pairs(
                data, _find_member(data, field, _METADATA)
            )
            for field in _list_vector_offsets(data, _find_member(data, schema, _FIELDS))
        }
        return _read_metadata_pairs(data, _find_member(data, schema, _TABLE_METADATA)), fields
    except (struct.error, IndexError):
        return {}, {}


def decode_parquet_schema(text: str) -> bytes:
    """Return the message stored as base64 under ARROW:schema in a Parquet file."""
    return base64.b64decode(text)


def _find_member(data: bytes, table: int, member_index: int) -> int:
    """Return the position of a member of a table, 0 if it is omitted."""
    members = table - struct.unpack_from("<i", data, table)[0]
    size = struct.unpack_from("<H", data, members)[0]
    entry = 4 + 2 * member_index
    offset = struct.unpack_from("<H", data, members + entry)[0] if entry < size else 0
    return table + offset if offset else 0


def _follow_offset(data: bytes, offset: int) -> int:
    return offset + int(struct.unpack_from("<I", data, offset)[0])


def _list_vector_offsets(data: bytes, offset: int) -> list[int]:
    """Return the positions of the tables of a vector."""
    if not offset:
        return []
    start = _follow_offset(data, offset)
    count = min(struct.unpack_from("<I", data, start)[0], _MAX_MEMBERS)
    return [_follow_offset(data, start + 4 + 4 * i) for i in range(count)]


def _read_metadata_pairs(data: bytes, offset: int) -> dict[str, str]:
    """Return the keys and values of metadata."""
    return {
        _read_text(data, _find_member(data, pair, 0)): _read_text(data, _find_member(data, pair, 1))
        for pair in _list_vector_offsets(data, offset)
    }


def _read_text(data: bytes, offset: int) -> str:
    if not offset:
        return ""
    start = _follow_offset(data, offset)
    size = struct.unpack_from("<I", data, start)[0]
    return data[start + 4 : start + 4 + size].decode("utf-8", "replace")
