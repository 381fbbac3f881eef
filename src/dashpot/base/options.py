"""A field that the command line offers as an option: declared once, in the noun it fills."""

from __future__ import annotations

from dataclasses import Field, field
from typing import Any


def option(default: Any, help: str | None = None, **how: Any) -> Any:
    """Return a dataclass's field that says how users are asked for it.

    `how` holds ``metavar`` and ``multiple`` as click knows them; ``unit``, the dimension of a
    quantity; ``choices``; ``least``, of a whole number; ``above``, of any; ``parse``, from what
    click passes on to what the noun takes; ``flag``, the option's name where it is not the field's.
    """
    return field(default=default, metadata={"help": help, **how})


def flag_of(one: Field[Any]) -> str:
    """Return the option that a field declares, as it is typed: ``--loss-factor``."""
    return "--" + str(one.metadata.get("flag", one.name)).replace("_", "-")
