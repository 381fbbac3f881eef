"""Handler of ``dashpot fit`` for compression load deflection: force, hysteresis and set."""

from __future__ import annotations

from dashpot import workflow
from dashpot.cli._command_io import CommandResult, format_command
from dashpot.cli.fit_handlers import FitRequest
from dashpot.extensions.materials.cld.fit_files import cld_files


def run(request: FitRequest) -> CommandResult:
    """Find force, slope, hysteresis, energy and set of pieces, or the memory of several speeds."""
    request.check_output_suffix(".json", what="load deflection")
    pieces = cld_files(
        request.files,
        at=request["compression"],
        between=request["between"],
        limits=request["force_limits"],
        memory=[workflow.read_fit(path) for path in request["memory"]],
        specimen=request.specimen,
        options=request.reading,
        **request.some("machine"),
    )
    follow = ""
    if request.result_path and pieces.fit is not None:
        follow = format_command("predict", request.result_path, "--mass", "MASS", "--seals", 2)
    return request.write_output(pieces, follow=follow)
