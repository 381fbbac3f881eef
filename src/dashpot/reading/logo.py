"""A logo for the head of a report: an image file as a link that holds it."""

from __future__ import annotations

import base64
from pathlib import Path

from dashpot.base.errors import ReadError

LARGEST = 100_000
"""Bytes."""

KINDS = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}


def read_logo(path: str | Path) -> str:
    """Return an image as a data URI. As an image, an SVG runs nothing and loads nothing.

    Raises
    ------
    ReadError
        If the file is no PNG, JPEG or SVG, or too large.
    """
    with Path(path).open("rb") as file:
        content = file.read(LARGEST + 1)
    name = Path(path).name
    if len(content) > LARGEST:
        raise ReadError(
            f"{name} is larger than {LARGEST} bytes; expected a small image: shrink the logo"
        )
    kind = next((kind for head, kind in KINDS.items() if content.startswith(head)), "")
    head = content.removeprefix(b"\xef\xbb\xbf").lstrip()[:2000]
    if not kind and head.startswith((b"<?xml", b"<!", b"<svg")) and b"<svg" in head:
        kind = "image/svg+xml"
    if not kind:
        raise ReadError(f"{name} is no image that a page can hold; expected PNG, JPEG or SVG")
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"
