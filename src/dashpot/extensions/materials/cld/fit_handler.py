"""Seals that are pressed and released: force, hysteresis, set, and what scatters."""

from __future__ import annotations

from dashpot import workflow
from dashpot.cli._command_io import Outcome, typed
from dashpot.cli.fit_handlers._request import Given


def run(given: Given) -> Outcome:
    """Find force, slope, hysteresis, energy and set of pieces, or the memory of several speeds."""
    given.kept_as(".json", what="load deflection")
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
    if given.kept and found.fit is not None:
        follow = typed("predict", given.kept, "--mass", "MASS", "--seals", 2)
    return given.told(found, follow=follow)
