"""Seals that are pressed and released: force, hysteresis, set, and what scatters."""

from __future__ import annotations

import dashpot as dp
from dashpot import workflow
from dashpot.cli._shell import Outcome, printed, typed, write
from dashpot.cli.fits._given import Given
from dashpot.told.cld import cld


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
    )
    given.draw(lambda: dp.plot.cld(found.pieces))
    if given.output:
        write(given.output, printed(found.fit or found) + "\n")
    follow = ""
    if given.output and given.output != "-" and found.fit is not None:
        follow = typed("predict", given.output, "--mass", "MASS", "--seals", 2)
    return Outcome(found, cld(found), found.checks, verdict=found.verdict, follow=follow)
