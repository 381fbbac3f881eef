"""A kind whose fit takes what its row of the register says, and no more."""

from __future__ import annotations

from dashpot.cli._command_io import Outcome, typed
from dashpot.cli.fit_handlers._request import Given
from dashpot.registry import KINDS, load


def run(given: Given) -> Outcome:
    """Fit the files as the row of their kind says."""
    row = KINDS[given.kinds[given.files[0]]]
    given.kept_as(".json", what="this fit")
    found = load(row.fit)(given.files, options=given.reading, **given.some(*row.takes))
    follow = (given.kept if one == "FILE" else one for one in row.follow.split())
    return given.told(found, follow=typed(*follow) if given.kept and row.follow else "")
