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


def run(request: FitRequest) -> CommandResult:
    """Fit a solid to relaxation tests, creep, sweeps or a modulus."""
    request.check_output_suffix(".json", what="a fit")
    elastic = request["elastic"]
    fit, records = workflow.fit_files(
        request.files,
        depth_law=elastic == "by-depth",
        law="auto" if elastic == "by-depth" else elastic,
        family=request.model(FamilyAsked, "maxwell"),
        options=request.reading,
        **request.some("arms", "method", "thorough", "filter", "cuts", "machine", "specimen",
                     "temperatures", "shifting"),
    )  # fmt: skip
    request.draw(lambda: _figure(fit, records))
    if request["save_shifts"]:
        write(request["save_shifts"], shift_table(fit))
    request.keep(fit, **_figures(fit, records))
    return CommandResult(
        fit,
        text_of.fit(fit, asked=request["arms"]),
        fit.checks,
        verdict=fit.verdict,
        follow=_follow(request, fit),
    )


def shift_table(fit: dp.Fit) -> str:
    """Return the shift factors of a fit of several temperatures as CSV."""
    from dashpot.reading.write import write_shifts

    if fit.temperatures is None:
        raise FitError("one temperature has no shift factors; leave out --save-shifts")
    stamp = ["simulated"] if any(source.simulated for source in fit.source) else []
    return write_shifts(fit.temperatures, comments=stamp)


def _follow(request: FitRequest, fit: dp.Fit) -> str:
    if not request.output or request.page:
        why = "keeps it for predict, compare, export"
        return format_command(
            "fit", *request.files, *request.get_option_words(), "-o", "fit.json", why=why
        )
    if not request.result_path:
        return ""
    if fit.unit == "Pa":  # no mass rests on a material
        deck = (
            "export",
            request.result_path,
            "--to",
            "abaqus",
            "--form",
            "prony",
            "--unit-system",
            "mm-t-s",
        )
        missing = ("--temperature", "TEMPERATURE") if fit.specimen.temperature is None else ()
        return format_command(*deck, *missing)
    return format_command("predict", request.result_path, "--mass", "MASS", "--seals", 2)


def _figures(fit: dp.Fit, records: tuple[Any, ...]) -> dict[str, Callable[[], Any]]:
    """What a page of the fit shows: the answer, with what the test leaves open, and the test."""
    first = records[0]
    drawn = partial(_figure, fit, records)
    if fit.temperatures is not None and not isinstance(first, dp.RampHold):
        return {"lead": drawn, "beside": lambda: (fit.plot(),)}
    return {
        "lead": lambda: workflow.over_frequency(fit, records),
        "beside": lambda: (drawn(),),
    }


def _figure(fit: dp.Fit, records: tuple[Any, ...]) -> dp.plot.Picture:
    others: list[dp.Fit] = []
    if len(records) == 1 and isinstance(records[0], dp.RampHold):
        method: Method = "hold" if fit.method == "hold" else "full"
        others = [workflow.fit_fixed_order(records[0], n, method=method) for n in (1, 2)]  # Fig. 4
    return dp.plot.bench(fit, records, alternatives=others)
