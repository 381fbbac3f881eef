"""The binary file of the lab's own machine: a head of JSON, then float32 rows."""

import json
import struct

API = 1
MAGIC = b"LABKIT1\n"


def read(raw: bytes, *, name: str) -> dict:
    """Return the columns in the bytes of a file; dashpot judges units and roles."""
    if not raw.startswith(MAGIC):
        raise ValueError(f"{name} begins with {raw[:8]!r}; a file of the lab begins with LABKIT1")
    line, _, body = raw[len(MAGIC) :].partition(b"\n")
    head = json.loads(line)
    width = len(head["channels"])
    rows = list(struct.iter_unpack(f"<{width}f", body))
    columns = [
        {"name": channel, "unit": unit, "values": [row[i] for row in rows]}
        for i, (channel, unit) in enumerate(head["channels"])
    ]
    return {"columns": columns, "header": [f"operator: {head['operator']}"], "notes": []}
