"""Handler of ``dashpot fit`` for slam tests."""

from __future__ import annotations

from dashpot import workflow
from dashpot.cli._command_io import CommandResult, format_command, grams
from dashpot.cli.fit_handlers import FitRequest
from dashpot.extensions.materials.slam.fit_files import slam_files


def run(request: FitRequest) -> CommandResult:
    """Find loss factor and arms from slams, with a fit of the piece where one is given."""
    request.check_output_suffix(".json", what="this fit")
    slam_fit = slam_files(
        request.files,
        mass=request.mass,
        slam=request["slam"],
        memory=[workflow.read_fit(path) for path in request["memory"]],
        specimen=request.specimen,
        options=request.reading,
    )
    follow = ""
    if request.result_path:
        how = ("--drop", "1m/s", "--mass", grams(slam_fit.mass))
        follow = format_command("predict", request.result_path, *how)
    return request.write_output(slam_fit, follow=follow)
