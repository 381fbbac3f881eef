"""Tests of one part on a bench: the solid behind them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import dashpot as dp
from dashpot import workflow
from dashpot.base.choices import FamilyAsked, Method
from dashpot.base.errors import FitError
from dashpot.cli._command_io import CommandResult, format_command, write
from dashpot.cli.fit_handlers._request import FitRequest
from dashpot.text_output import results as text_of


def run(given: FitRequest) -> CommandResult:
    """Fit a solid to relaxation tests, creep, sweeps or a modulus."""
    given.check_output_suffix(".json", what="a fit")
    elastic = given["elastic"]
    found, records = workflow.fit_files(
        given.files,
        depth_law=elastic == "by-depth",
        law="auto" if elastic == "by-depth" else elastic,
        family=given.model(FamilyAsked, "maxwell"),
        options=given.reading,
        **given.some("arms", "method", "thorough", "filter", "cuts", "machine", "specimen",
                     "temperatures", "shifting"),
    )  # fmt: skip
    given.draw(lambda: _figure(found, records))
    if given["save_shifts"]:
        write(given["save_shifts"], shift_table(found))
    given.keep(found, **_figures(found, records))
    return CommandResult(
        found,
        text_of.fit(found, asked=given["arms"]),
        found.checks,
        verdict=found.verdict,
        follow=_follow(given, found),
    )


def shift_table(found: dp.Fit) -> str:
    """Return the shift factors of a fit of several temperatures as CSV."""
    from dashpot.reading.write import write_shifts

    if found.temperatures is None:
        raise FitError("one temperature has no shift factors; leave out --save-shifts")
    stamp = ["simulated"] if any(source.simulated for source in found.source) else []
    return write_shifts(found.temperatures, comments=stamp)


def _follow(given: FitRequest, found: dp.Fit) -> str:
    if not given.output or given.page:
        why = "keeps it for predict, compare, export"
        return format_command(
            "fit", *given.files, *given.get_option_words(), "-o", "fit.json", why=why
        )
    if not given.result_path:
        return ""
    if found.unit == "Pa":  # no mass rests on a material
        deck = (
            "export",
            given.result_path,
            "--to",
            "abaqus",
            "--form",
            "prony",
            "--unit-system",
            "mm-t-s",
        )
        missing = ("--temperature", "TEMPERATURE") if found.specimen.temperature is None else ()
        return format_command(*deck, *missing)
    return format_command("predict", given.result_path, "--mass", "MASS", "--seals", 2)


def _figures(found: dp.Fit, records: tuple[Any, ...]) -> dict[str, Callable[[], Any]]:
    """What a page of the fit shows: the answer, with what the test leaves open, and the test."""
    first = records[0]
    drawn = partial(_figure, found, records)
    if found.temperatures is not None and not isinstance(first, dp.RampHold):
        return {"lead": drawn, "beside": lambda: (found.plot(),)}
    return {
        "lead": lambda: workflow.over_frequency(found, records),
        "beside": lambda: (drawn(),),
    }


def _figure(found: dp.Fit, records: tuple[Any, ...]) -> dp.plot.Picture:
    others: list[dp.Fit] = []
    if len(records) == 1 and isinstance(records[0], dp.RampHold):
        method: Method = "hold" if found.method == "hold" else "full"
        others = [workflow.fit_fixed_order(records[0], n, method=method) for n in (1, 2)]  # Fig. 4
    return dp.plot.bench(found, records, alternatives=others)
