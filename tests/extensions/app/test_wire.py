"""Messages between page, server and workers."""

import json
import struct

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from dashpot.extensions.app import wire_format


@given(
    st.dictionaries(st.text(max_size=8), st.integers() | st.text() | st.none(), max_size=4),
    st.lists(st.lists(st.floats(width=32, allow_nan=False), max_size=9), max_size=3),
)
def test_a_message_comes_back_as_it_was(head, rows):
    head.pop("arrays", None)
    arrays = {f"{i}": np.array(row) for i, row in enumerate(rows)}
    text, numbers = wire_format.decode_message(wire_format.encode_message(head, arrays))
    assert text == head
    assert {name: row.tolist() for name, row in numbers.items()} == {
        name: row.tolist() for name, row in arrays.items()
    }


def test_numbers_begin_where_a_browser_can_read_them():
    message = wire_format.encode_message({"words": "é"}, {"x": np.array([1.0])})
    (length,) = struct.unpack_from("<I", message)
    assert length % 4 == 0
    assert json.loads(message[4 : 4 + length])["words"] == "é"


def test_a_frame_says_its_kind_and_length():
    frame = wire_format.encode_frame("d", b"12345")
    assert wire_format.parse_frame_head(frame[: wire_format.FRAME_HEAD]) == ("d", 5)
    assert frame[wire_format.FRAME_HEAD :] == b"12345"
