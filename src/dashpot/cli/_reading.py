"""The options that answer what a file leaves open."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

from dashpot.cli._shell import Quantity

if TYPE_CHECKING:
    from dashpot.io.options import ReadOptions

T = TypeVar("T")

_OPTIONS = (
    click.option("--time", "time", metavar="COLUMN", help="Column of time."),
    click.option("--displacement", metavar="COLUMN", help="Column of displacement."),
    click.option("--force", metavar="COLUMN", help="Column of force (hammer or bench)."),
    click.option("--acceleration", metavar="COLUMN", multiple=True, help="Column of acceleration."),
    click.option("--units", metavar="ROLE=UNIT", multiple=True, help='E.g. "force=N,time=s".'),
    click.option("--rate", type=Quantity("frequency"), help="Sampling rate, if there is no time."),
    click.option("--delimiter", help="tab, space, comma, ';', fixed, ..."),
    click.option("--decimal", help="point or comma."),
    click.option("--encoding", help="E.g. utf-8, cp1250, gb18030."),
    click.option("--skip-rows", type=click.IntRange(0), default=0, help="Lines to pass over."),
    click.option("--segment", type=click.IntRange(1), help="Which segment of the file."),
    click.option("--sheet", help="Sheet of a workbook, group of TDMS or HDF5."),
    click.option("--calibration", metavar="FILE", help="ATI .cal file: gauge volts to force."),
    click.option("--axis", default="Fz", help="Axis of the calibrated transducer."),
    click.option("--profile", metavar="FILE", help="Saved answers, TOML; options win over it."),
)  # fmt: skip
_NAMES = (
    "time", "displacement", "force", "acceleration", "units", "rate", "delimiter", "decimal",
    "encoding", "skip_rows", "segment", "sheet", "calibration", "axis", "profile",
)  # fmt: skip


def reading(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the reading options; it receives them as one ``options``."""

    @functools.wraps(function)
    def command(**arguments: Any) -> T:
        said = {name: arguments.pop(name) for name in _NAMES}
        return function(options=_options(**said), **arguments)

    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def _options(
    *, units: tuple[str, ...], profile: str | None, acceleration: tuple[str, ...], **said: Any
) -> ReadOptions:
    from dashpot.io.options import ReadOptions, parse_units

    named = {role: unit for text in units for role, unit in parse_units(text).items()}
    options = ReadOptions(units=named, acceleration=acceleration, **said)
    if not profile:
        return options
    from dashpot.io.reading_profile import load_profile

    return options.over(load_profile(profile))
