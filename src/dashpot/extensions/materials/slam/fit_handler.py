"""Slams of a mass on a piece: its loss factor, and the arm that a ramp is too slow for."""

from __future__ import annotations

from dashpot import workflow
from dashpot.cli._command_io import CommandResult, format_command, grams
from dashpot.cli.fit_handlers._request import FitRequest


def run(given: FitRequest) -> CommandResult:
    """Find loss factor and arms from slams, with a fit of the piece where one is given."""
    given.check_output_suffix(".json", what="this fit")
    found = workflow.slam_files(
        given.files,
        mass=given.mass,
        slam=given["slam"],
        memory=[workflow.read_fit(one) for one in given["memory"]],
        specimen=given.specimen,
        options=given.reading,
    )
    follow = ""
    if given.result_path:
        how = ("--slam", "1m/s", "--mass", grams(found.mass))
        follow = format_command("predict", given.result_path, *how)
    return given.told(found, follow=follow)
