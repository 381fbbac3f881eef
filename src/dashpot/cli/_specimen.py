"""What the user knows of the specimen."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar

import click

from dashpot.cli._shell import Quantity

T = TypeVar("T")


def specimen(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the options that describe the specimen; it receives one ``specimen``."""

    @click.option(
        "--length", type=Quantity("length"), help="Contact length of the seal, e.g. 50mm."
    )
    @click.option("--height", type=Quantity("length"), help="Free height of the section.")
    @click.option(
        "--temperature", type=Quantity("temperature"), help="Test temperature, e.g. 23degC."
    )
    @click.option("--notes", default="", help="Material, fixing, load history.")
    @functools.wraps(function)
    def command(
        *,
        length: float | None,
        height: float | None,
        temperature: float | None,
        notes: str,
        **arguments: Any,
    ) -> T:
        from dashpot.records.specimen import Specimen

        described = Specimen(length=length, height=height, temperature=temperature, notes=notes)
        return function(specimen=described, **arguments)

    return command
