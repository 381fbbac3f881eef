"""What hostile or broken files are made of: strategies for whole families of mutants."""

from __future__ import annotations

import io
import json
import os
import zipfile
from copy import deepcopy

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

TIMES = float(os.environ.get("DASHPOT_FUZZ", "0.1"))
"""Mutants over those of a night, of which the gate tries a tenth; above 1 they differ each time."""


def tries(count: int) -> settings:
    """So many mutants, or many times more."""
    return settings(
        max_examples=max(1, round(count * TIMES)), deadline=None, derandomize=TIMES <= 1,
        database=None,
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip


CELL = st.one_of(
    st.floats().map(repr),
    st.integers(-(10**6), 10**6).map(str),
    st.sampled_from([
        "", "NaN", "OVER", "1,234", "1.234,5", "-", '"', '"1,5"', "1_0", "0x1", "1e999", "=1", "٣",
        "12:30:01", "2024-01-02", "s", "[N]", "time", "Kraft", "#", "\x00",
    ]),
    st.text(max_size=4),
)  # fmt: skip
LINES = st.lists(st.lists(CELL, max_size=5), max_size=40)
STRANGE = st.sampled_from([
    None, True, 0, -1, 1e308, -1e308, 10**400, 1 << 63, "", "NaN", "Infinity", "x", [], {}, [[]],
    {"a": 1}, [None], [1e308, "x"], "\ud800", "\x1b[31m",
])  # fmt: skip


class Mutant(bytes):
    """Bytes of which a failing test prints the first."""

    def __repr__(self) -> str:
        return repr(bytes(self[:2000]))


@st.composite
def texts(draw: st.DrawFn) -> bytes:
    """Tables with faults, in some delimiter, line end and encoding."""
    sign = draw(st.sampled_from([",", ";", "\t", " ", "|", ", ", ":"]))
    end = draw(st.sampled_from(["\n", "\r\n", "\r", "\r\r\n"]))
    lines = [sign.join(cells) for cells in draw(LINES)]
    if draw(st.booleans()):
        steady = sign.join(draw(st.lists(CELL, min_size=3, max_size=4)))
        lines += [steady] * draw(st.integers(1, 30))
    code = draw(st.sampled_from(["utf-8", "utf-16", "cp1252", "gb18030", "utf-32"]))
    return end.join(lines).encode(code, "replace")


@st.composite
def draw_damaged_bytes(draw: st.DrawFn, content: bytes) -> bytes:
    """A good file with bytes changed, cut out or doubled."""
    out = bytearray(content)
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, max(0, len(out) - 1)))
        kind = draw(st.sampled_from(["set", "cut", "double", "flip", "flip", "number", "end"]))
        length = draw(st.integers(1, 64))
        if kind == "set":
            out[at : at + 1] = draw(st.binary(min_size=1, max_size=4))
        elif kind == "cut":
            del out[at : at + length]
        elif kind == "double":
            out[at:at] = out[at : at + length]
        elif kind == "flip" and out:
            out[at] ^= 1 << (length % 8)
        elif kind == "number":
            size = draw(st.sampled_from([1, 2, 4, 8]))
            out[at : at + size] = draw(st.sampled_from([b"\xff", b"\x00", b"\x7f"])) * size
        elif kind == "end":
            del out[at:]
        if not out:
            break
    return Mutant(out)


@st.composite
def draw_damaged_zip(draw: st.DrawFn, content: bytes) -> bytes:
    """A zip file whose parts are wounded before they are packed."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(out, "w") as new:
        names = old.namelist()
        chosen = draw(st.sampled_from(names))
        for name in names:
            part = old.read(name)
            new.writestr(name, draw(draw_damaged_bytes(part)) if name == chosen else part)
    return Mutant(out.getvalue())


@st.composite
def draw_damaged_json(draw: st.DrawFn, document: object) -> bytes:
    """A JSON document of which some parts are other ones, gone or doubled."""
    whole = json.loads(json.dumps({"root": document}))
    for _ in range(draw(st.integers(1, 3))):
        node, key = whole, "root"
        while isinstance(node[key], dict | list) and node[key] and draw(st.integers(0, 5)):
            node = node[key]
            keys = list(node) if isinstance(node, dict) else range(len(node))
            key = draw(st.sampled_from(keys))
        kind = draw(st.sampled_from(["put", "put", "drop", "double", "wrap"]))
        if kind == "put" or key == "root":
            node[key] = deepcopy(draw(STRANGE))
        elif kind == "drop":
            del node[key]
        elif kind == "wrap":
            node[key] = [node[key]]
        elif isinstance(node, list):
            node.append(node[key])
        else:
            node[f"{key} "] = node[key]
    return Mutant(json.dumps(whole["root"]).encode())
