"""A kind whose fit takes what its row of the register says, and no more."""

from __future__ import annotations

from dashpot.cli._command_io import CommandResult, format_command
from dashpot.cli.fit_handlers._request import FitRequest
from dashpot.registry import KINDS, load_object


def run(request: FitRequest) -> CommandResult:
    """Fit the files as the row of their kind says."""
    row = KINDS[request.kinds[request.files[0]]]
    request.check_output_suffix(".json", what="this fit")
    result = load_object(row.fit)(
        request.files, options=request.reading, **request.some(*row.takes)
    )
    follow = (request.result_path if part == "FILE" else part for part in row.follow.split())
    return request.told(
        result, follow=format_command(*follow) if request.result_path and row.follow else ""
    )
