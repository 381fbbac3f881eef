"""Handler of ``dashpot fit`` for compression load deflection: force, hysteresis and set."""

from __future__ import annotations

from dashpot import workflow
from dashpot.cli._command_files import format_command
from dashpot.cli._command_result import CommandResult
from dashpot.cli.fit_handlers import FitRequest
from dashpot.extensions.materials.cld.fit_files import cld_files


def run(request: FitRequest) -> CommandResult:
    """Evaluate load deflection of specimens, or fit a model to several speeds."""
    request.check_output_suffix(".json", result_name="load deflection")
    result = cld_files(
        request.files,
        at=request["compression"],
        compression_limits=request["compression_limits"],
        limits=request["force_limits"],
        relaxation=[workflow.read_fit(path) for path in request["relaxation"]],
        specimen=request.specimen,
        options=request.reading,
        **request.select_options("machine"),
    )
    next_command = ""
    if request.result_path and result.fit is not None:
        next_command = format_command(
            "predict", request.result_path, "--mass", "MASS", "--seals", 2
        )
    return request.write_output(result, next_command=next_command)
