"""Handler of ``dashpot fit`` for drop tests."""

from __future__ import annotations

from dashpot import workflow
from dashpot.cli._command_files import format_command, format_grams
from dashpot.cli._command_result import CommandResult
from dashpot.cli.fit_handlers import FitRequest
from dashpot.extensions.materials.drop.fit_files import fit_drop_files


def run(request: FitRequest) -> CommandResult:
    """Fit loss factor and arms to drop tests, with a relaxation test where one is given."""
    request.check_output_suffix(".json", result_name="this fit")
    drop_fit = fit_drop_files(
        request.files,
        mass=request.mass,
        drop=request["drop"],
        relaxation=[workflow.read_fit(path) for path in request["relaxation"]],
        specimen=request.specimen,
        options=request.reading,
    )
    next_command = ""
    if request.result_path:
        options = ("--drop", "1m/s", "--mass", format_grams(drop_fit.mass))
        next_command = format_command("predict", request.result_path, *options)
    return request.write_output(drop_fit, next_command=next_command)
