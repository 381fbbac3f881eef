"""Hits, or a base that is shaken: an FRF that one can trust, and its modes."""

from __future__ import annotations

import dashpot as dp
from dashpot import workflow
from dashpot.cli._command_io import CommandResult, format_command, format_json, grams, write
from dashpot.cli._echo import to_stderr
from dashpot.cli.fit_handlers._request import FitRequest

FRF = (".csv", ".uff", ".unv")


def run(given: FitRequest) -> CommandResult:
    """Cut records into hits, judge each, and average them into an FRF."""
    given.check_output_suffix(*FRF, ".json", what="the FRF of hits")
    mass = given.mass
    found, reason = workflow.impact_files(
        given.files, file=given.output, hammer=given.hammer, options=given.reading, mass=mass,
        band=given["band"],
    )  # fmt: skip
    if reason:
        to_stderr(f"no mode: {reason}")
    if given.page:
        given.keep(found)
    elif given.output:
        keep(found, found.frf, given.output)
    given.draw(
        lambda: dp.plot.frf(
            found.frf, labels=("measured",), stamp=dp.plot.stamp(found.frf.source, mass=mass)
        )
    )
    block = "MASS" if mass is None else grams(mass)
    return CommandResult.from_result(
        found,
        follow=format_command("compare", "FIT", *given.files, "--mass", block, "--seals", 2,
                     *given.get_option_words("mass", "seals"), why="tests the fit of a relaxation "
                                                                   "test"),
    )  # fmt: skip


def keep(found: workflow.ImpactResult, frf: dp.FRF, path: str) -> None:
    """Write the result as JSON, or its FRF as CSV or UFF 58, by how the file's name ends."""
    from dashpot.reading.write import frf_uff, write_frf

    ends = path.lower()
    if ends.endswith(".json"):
        write(path, format_json(found) + "\n")
    else:
        write(path, frf_uff(frf) if ends.endswith((".uff", ".unv")) else write_frf(frf))
