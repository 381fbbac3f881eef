"""A kind whose fit takes what its row of the register says, and no more."""

from __future__ import annotations

from dashpot.cli._command_io import CommandResult, format_command
from dashpot.cli.fit_handlers._request import FitRequest
from dashpot.registry import KINDS, load_object


def run(given: FitRequest) -> CommandResult:
    """Fit the files as the row of their kind says."""
    row = KINDS[given.kinds[given.files[0]]]
    given.check_output_suffix(".json", what="this fit")
    found = load_object(row.fit)(given.files, options=given.reading, **given.some(*row.takes))
    follow = (given.result_path if one == "FILE" else one for one in row.follow.split())
    return given.told(
        found, follow=format_command(*follow) if given.result_path and row.follow else ""
    )
