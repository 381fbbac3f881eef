"""Vibration under a known mass, alone or with tests on a bench: one solid for all."""

from __future__ import annotations

from math import ceil, floor
from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.choices import FamilyAsked
from dashpot.cli._command_io import CommandResult, format_command, is_json, write
from dashpot.cli.fit_handlers import hits
from dashpot.cli.fit_handlers._request import FitRequest
from dashpot.cli.fit_handlers.bench_tests import shift_table

_A_DECK = ("--to", "nastran", "--unit-system", "mm-t-s", "-o", "seal.bdf")
VIBRATION = ("impact", "frf", "transmissibility")


def run(given: FitRequest) -> CommandResult:
    """Identify the solid under a mass from hits or FRFs, and from tests of it on a bench."""
    given.check_output_suffix(".json", *hits.FRF, what="a fit")
    if given.mass is None:
        raise click.UsageError(
            "A test and a hammer file are fitted together under a mass. "
            "Give the mass of the block: --mass 104g"
        )
    measured = given.select_files(*VIBRATION)
    beside = [path for path in given.files if path not in measured]
    fits = [path for path in beside if is_json(path)]
    reading = given.reading
    if given["elastic"] == "by-depth":
        raise click.UsageError(
            "--elastic by-depth is for relaxation tests of several depths without a hammer. Fit "
            "them first, then the fit with the hammer."
        )
    found = workflow.identify_files(
        measured,
        fits=[workflow.read_fit(path) for path in fits],
        tests=[path for path in beside if path not in fits],
        options=reading.without(reading.of_bench),
        options_with=reading.only(("units", *reading.of_bench)),
        mass=given.mass,
        family=given.model(FamilyAsked, "maxwell"),
        seals_assumed="--seals" not in given.get_option_words(),
        law=given["elastic"],
        **given.some("method", "cuts", "filter", "thorough", "shifting"),
        **given.some("rig", "seal_mass", "seals", "compression", "impact_temperature", "arms",
                     "known", "band", "machine", "temperatures", "specimen", "hammer"),
    )  # fmt: skip
    given.draw(lambda: dp.plot.stiffness(found.fit))
    if given["save_shifts"]:
        write(given["save_shifts"], shift_table(found.fit))
    if given["stiffness_table"]:
        write(given["stiffness_table"], found.direct.table)
    if given.output and given.output.lower().endswith(hits.FRF):
        if found.vibration is None:
            raise click.UsageError(
                f"-o {given.output}: of tests and a hammer together a fit is written."
            )
        hits.keep(found.vibration, found.vibration.frf, given.output)
    else:
        given.keep(found)
    return CommandResult.from_result(found, follow=_follow(given, found.fit))


def _follow(given: FitRequest, found: dp.Fit) -> str:
    output = None if given.page else given.output
    if output == "-":
        return ""
    if output:
        return format_command("export", output, *_deck(found)) if output.endswith(".json") else ""
    again = given.get_option_words("stiffness_table")
    return format_command(
        "fit", *given.files, *again, "-o", "joint.json", why="keeps it for export"
    )


def _deck(found: dp.Fit) -> list[str]:
    """The options of a deck in the valid band, with what the fit does not know to be filled in."""
    piece = found.specimen
    asked: tuple[tuple[str, Any], ...] = (
        ("--temperature", piece.temperature), ("--length", piece.length),
    )  # fmt: skip
    missing = [name for name, known in asked if known is None]
    low, high = max(1, ceil(found.band[0])), floor(found.band[1])
    rows = ("--band", f"{low}:{high}Hz") if low < high else ()
    return [*_A_DECK, *rows, *(word for name in missing for word in (name, name[2:].upper()))]
