"""Seals that are pressed and released: force, hysteresis, set, and what scatters."""

from __future__ import annotations

from dashpot import workflow
from dashpot.cli._command_io import CommandResult, format_command
from dashpot.cli.fit_handlers._request import FitRequest


def run(given: FitRequest) -> CommandResult:
    """Find force, slope, hysteresis, energy and set of pieces, or the memory of several speeds."""
    given.check_output_suffix(".json", what="load deflection")
    found = workflow.cld_files(
        given.files,
        at=given["compression"],
        between=given["between"],
        limits=given["force_limits"],
        memory=[workflow.read_fit(one) for one in given["memory"]],
        specimen=given.specimen,
        options=given.reading,
        **given.some("machine"),
    )
    follow = ""
    if given.result_path and found.fit is not None:
        follow = format_command("predict", given.result_path, "--mass", "MASS", "--seals", 2)
    return given.told(found, follow=follow)
