"""Keys that a section of the file of a door must have."""

from __future__ import annotations

from dashpot.base.errors import ReadError
from dashpot.reading.toml import Section


def require_keys(section: Section, *names: str) -> None:
    """Raise a :class:`ReadError` for the first of the keys that is missing."""
    for name in names:
        if name not in section.entries:
            raise ReadError(f"{section.location}: {name} is missing")
