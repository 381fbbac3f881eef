"""Handler of ``dashpot predict`` for a door: vibration on its seal, and closing."""

from __future__ import annotations

from typing import Any

import click

from dashpot.base import dataclass
from dashpot.base.checks import verdict
from dashpot.base.serialisation import Key, Serialisable
from dashpot.cli._command_result import CommandResult, format_json, write_figure, write_output
from dashpot.cli.predict import is_page_output
from dashpot.extensions.systems.door.analyse_file import door_file
from dashpot.extensions.systems.door.closing_from_file import close_file
from dashpot.extensions.systems.door.closing_result import ClosingResult
from dashpot.extensions.systems.door.closing_text import closing_text
from dashpot.extensions.systems.door.leak_from_file import find_leak_speeds
from dashpot.extensions.systems.door.leak_result import LeakResult
from dashpot.extensions.systems.door.page import door_html
from dashpot.extensions.systems.door.population import DoorPopulation, predict_population
from dashpot.extensions.systems.door.result import DoorResult
from dashpot.extensions.systems.door.text import door
from dashpot.report import html
from dashpot.text_output.layout import Text


@dataclass(frozen=True)
class DoorPrediction(Serialisable):
    """Prediction of a door: vibration and closing."""

    _keys = (Key("door", flatten=True), "closing")

    door: DoorResult
    closing: ClosingResult


def _refuse_beside_leak(*leak_exclusive_options: object) -> None:
    if any(other not in (None, False, ()) for other in leak_exclusive_options):
        raise click.UsageError(
            "--leak is asked by itself: leave out --modes, --close, --band, --lot, --spread "
            "and --limit"
        )


def _write_population(
    cars: DoorPopulation, picture: str | None, output: str | None
) -> CommandResult:
    if picture:
        write_figure(picture, cars.plot())
    if output:
        content = html(cars) if is_page_output(output) else format_json(cars) + "\n"
        write_output(output, content)
    return CommandResult.from_result(cars)


def run(
    path: str,
    *,
    every: bool,
    speed: float | None,
    leak: bool,
    lot: str | None,
    spread: float | None,
    limits: tuple[str, ...],
    picture: str | None,
    output: str | None,
    band: tuple[float, float] | None,
    temperature: float | None,
) -> CommandResult:
    """Predict how a door vibrates on its seal, how it closes, or at which speed its seal lifts.

    Of a lot it is doors of many cars.
    """
    if leak:
        _refuse_beside_leak(every, speed, band, lot, spread, limits)
        return _write_leak(find_leak_speeds(path, temperature=temperature), picture, output)
    if picture and every and speed is not None:
        raise click.UsageError(
            "--plot draws the modes or the closing: leave out --modes or --close"
        )
    if lot is not None or spread is not None or limits:
        if every or speed is not None:
            raise click.UsageError(
                "--modes and --close are of one door, --lot, --spread and --limit of many cars: "
                "leave out one of both"
            )
        cars = predict_population(
            path, lot=lot, spread=spread, limits=limits, band=band, temperature=temperature
        )
        return _write_population(cars, picture, output)
    page = is_page_output(output)
    result = closed = None
    if speed is None or every or page:
        result = door_file(path, band=band, temperature=temperature)
    if speed is not None:
        closed = close_file(path, speed, temperature=temperature)
    outcome = _merge_door_results(result, closed, is_verbose=every)
    if picture:
        shown_result: Any = result if closed is None else closed
        write_figure(picture, shown_result.plot())
    if output:
        results = [item for item in (result, closed) if item is not None]
        write_output(output, door_html(*results) if page else format_json(outcome.result) + "\n")
    return outcome


def _write_leak(result: LeakResult, picture: str | None, output: str | None) -> CommandResult:
    """Write picture and page, document or table of stations."""
    if picture:
        write_figure(picture, result.plot())
    if output and output.lower().endswith(".csv"):
        write_output(output, result.csv())
    elif output:
        write_output(output, html(result) if is_page_output(output) else format_json(result) + "\n")
    return CommandResult.from_result(result)


def _merge_door_results(
    result: DoorResult | None, closing_result: ClosingResult | None, *, is_verbose: bool
) -> CommandResult:
    """Return how it vibrates, how it closes, or both."""
    if closing_result is None:
        assert result is not None  # noqa: S101
        return CommandResult(
            result, door(result, every=is_verbose), result.checks, verdict=result.verdict
        )
    if result is None:
        return CommandResult.from_result(closing_result)
    stated_text, shuts = door(result, every=is_verbose), closing_text(closing_result.closing)
    checks = tuple(dict.fromkeys((*result.checks, *closing_result.checks)))
    text = Text(
        [*stated_text.lines, *shuts.lines],
        [*stated_text.details, *shuts.details],
        stated_text.requested_lines,
    )
    return CommandResult(
        DoorPrediction(result, closing_result),
        text,
        checks,
        verdict=verdict(checks, headline=closing_result._headline),
    )
