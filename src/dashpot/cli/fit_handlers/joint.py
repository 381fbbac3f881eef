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
from dashpot.workflow.fit_bench_tests import BenchFitOptions

_A_DECK = ("--to", "nastran", "--unit-system", "mm-t-s", "-o", "seal.bdf")
VIBRATION = ("impact", "frf", "transmissibility")


def run(request: FitRequest) -> CommandResult:
    """Identify the solid under a mass from hits or FRFs, and from tests of it on a bench."""
    request.check_output_suffix(".json", *hits.FRF, what="a fit")
    if request.mass is None:
        raise click.UsageError(
            "A test and a hammer file are fitted together under a mass. "
            "Give the mass of the block: --mass 104g"
        )
    measured = request.select_files(*VIBRATION)
    extras = [path for path in request.files if path not in measured]
    fits = [path for path in extras if is_json(path)]
    reading = request.reading
    if request["elastic"] == "by-depth":
        raise click.UsageError(
            "--elastic by-depth is for relaxation tests of several depths without a hammer. Fit "
            "them first, then the fit with the hammer."
        )
    result = workflow.identify_files(
        measured,
        fits=[workflow.read_fit(path) for path in fits],
        tests=[path for path in extras if path not in fits],
        options=reading.without(reading.of_bench),
        options_with=reading.only(("units", *reading.of_bench)),
        mass=request.mass,
        family=request.model(FamilyAsked, "maxwell"),
        seals_assumed="--seals" not in request.get_option_words(),
        bench=BenchFitOptions(
            law=request["elastic"],
            **request.some("method", "cuts", "filter", "thorough", "shifting", "machine",
                         "specimen"),
        ),
        **request.some("rig", "seal_mass", "seals", "compression", "impact_temperature", "arms",
                     "known", "band", "temperatures", "hammer"),
    )  # fmt: skip
    request.draw(lambda: dp.plot.stiffness(result.fit))
    if request["save_shifts"]:
        write(request["save_shifts"], shift_table(result.fit))
    if request["stiffness_table"]:
        write(request["stiffness_table"], result.direct.table)
    if request.output and request.output.lower().endswith(hits.FRF):
        if result.vibration is None:
            raise click.UsageError(
                f"-o {request.output}: of tests and a hammer together a fit is written."
            )
        hits.keep(result.vibration, result.vibration.frf, request.output)
    else:
        request.keep(result)
    return CommandResult.from_result(result, follow=_follow(request, result.fit))


def _follow(request: FitRequest, fit: dp.Fit) -> str:
    output = None if request.page else request.output
    if output == "-":
        return ""
    if output:
        return format_command("export", output, *_deck(fit)) if output.endswith(".json") else ""
    again = request.get_option_words("stiffness_table")
    return format_command(
        "fit", *request.files, *again, "-o", "joint.json", why="keeps it for export"
    )


def _deck(fit: dp.Fit) -> list[str]:
    """The options of a deck in the valid band, with what the fit does not know to be filled in."""
    piece = fit.specimen
    requested: tuple[tuple[str, Any], ...] = (
        ("--temperature", piece.temperature), ("--length", piece.length),
    )  # fmt: skip
    missing = [name for name, item in requested if item is None]
    low, high = max(1, ceil(fit.band[0])), floor(fit.band[1])
    rows = ("--band", f"{low}:{high}Hz") if low < high else ()
    return [*_A_DECK, *rows, *(word for name in missing for word in (name, name[2:].upper()))]
