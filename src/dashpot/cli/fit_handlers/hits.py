"""Hits, or a base that is shaken: an FRF that one can trust, and its modes."""

from __future__ import annotations

import dashpot as dp
from dashpot import workflow
from dashpot.cli._command_io import CommandResult, format_command, format_json, grams, write
from dashpot.cli._echo import to_stderr
from dashpot.cli.fit_handlers._request import FitRequest

FRF = (".csv", ".uff", ".unv")


def run(value: FitRequest) -> CommandResult:
    """Cut records into hits, judge each, and average them into an FRF."""
    value.check_output_suffix(*FRF, ".json", what="the FRF of hits")
    mass = value.mass
    result, reason = workflow.impact_files(
        value.files, file=value.output, hammer=value.hammer, options=value.reading, mass=mass,
        band=value["band"],
    )  # fmt: skip
    if reason:
        to_stderr(f"no mode: {reason}")
    if value.page:
        value.keep(result)
    elif value.output:
        keep(result, result.frf, value.output)
    value.draw(
        lambda: dp.plot.frf(
            result.frf, labels=("measured",), stamp=dp.plot.stamp(result.frf.source, mass=mass)
        )
    )
    block = "MASS" if mass is None else grams(mass)
    return CommandResult.from_result(
        result,
        follow=format_command("compare", "FIT", *value.files, "--mass", block, "--seals", 2,
                     *value.get_option_words("mass", "seals"), why="tests the fit of a relaxation "
                                                                   "test"),
    )  # fmt: skip


def keep(result: workflow.ImpactResult, frf: dp.FRF, path: str) -> None:
    """Write the result as JSON, or its FRF as CSV or UFF 58, by how the file's name ends."""
    from dashpot.reading.write import frf_uff, write_frf

    ends = path.lower()
    if ends.endswith(".json"):
        write(path, format_json(result) + "\n")
    else:
        write(path, frf_uff(frf) if ends.endswith((".uff", ".unv")) else write_frf(frf))
