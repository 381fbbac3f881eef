"""Messages between page, server and workers: a JSON head and binary arrays.

::

    uint32  length of the head, little endian
    head    JSON in UTF-8; "arrays" says of each array its name, first number and count
    rest    every array as float32, one after the other
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray

_LENGTH = struct.Struct("<I")


def encode_message(
    head: Mapping[str, Any], arrays: Mapping[str, FloatArray] | None = None
) -> bytes:
    """Return a message; non-finite numbers are null in the head and NaN in an array.

    >>> decode_message(encode_message({"a": 1}, {"x": np.array([1.0, 2.0])}))[1]["x"].tolist()
    [1.0, 2.0]
    """
    positions, parts, position = {}, [], 0
    for name, values in (arrays or {}).items():
        part = np.asarray(values, dtype="<f4")
        positions[name] = [position, part.size]
        parts.append(part.tobytes())
        position += part.size
    text = json.dumps({**head, "arrays": positions}, ensure_ascii=False, allow_nan=False).encode()
    # the numbers begin at a multiple of their own size
    text += b" " * (-len(text) % 4)
    return b"".join((_LENGTH.pack(len(text)), text, *parts))


def decode_message(message: bytes) -> tuple[dict[str, Any], dict[str, FloatArray]]:
    """Return head and arrays of a message."""
    (length,) = _LENGTH.unpack_from(message)
    head = json.loads(message[_LENGTH.size : _LENGTH.size + length])
    array_data = np.frombuffer(message, dtype="<f4", offset=_LENGTH.size + length)
    array_places = head.pop("arrays")
    return head, {name: array_data[at : at + count] for name, (at, count) in array_places.items()}


def encode_frame(kind: str, body: bytes) -> bytes:
    """Return a body as one frame of a pipe: its kind, of one letter, its length, itself."""
    return kind.encode() + _LENGTH.pack(len(body)) + body


FRAME_HEAD = 1 + _LENGTH.size
"""Bytes before the body of a frame."""


def parse_frame_head(head: bytes) -> tuple[str, int]:
    """Return kind and length of the frame that begins so."""
    return head[:1].decode(), _LENGTH.unpack(head[1:])[0]
