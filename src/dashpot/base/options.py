"""A field that the command line offers as an option: declared once, in the noun it fills."""

from __future__ import annotations

from dataclasses import field
from typing import Any


def option(default: Any, help: str | None = None, **how: Any) -> Any:
    """Return a dataclass's field that says how users are asked for it.

    `how` holds ``metavar`` and ``multiple`` as click knows them; ``unit``, the dimension of a
    quantity; ``choices``; ``least``, of a whole number; ``parse``, from what click passes on to
    what the noun takes.
    """
    return field(default=default, metadata={"help": help, **how})
