"""Loops, amplitude sweeps, and FRFs or hits at several levels: what amplitude does."""

from __future__ import annotations

import dashpot as dp
from dashpot import workflow
from dashpot.base.choices import AmplitudeLawAsked
from dashpot.cli._shell import Outcome, printed, write
from dashpot.cli.fits._given import PAGE, Given
from dashpot.told import text as text_of


def run(given: Given) -> Outcome:
    """Find how far stiffness and damping depend on how far the seal is moved."""
    kept = given.kept_as(".json", *PAGE, what="a fit over amplitude")
    found = workflow.level_files(
        given.files,
        levels=given["levels"],
        mass=given.mass,
        at=given["at"],
        law=given.model(AmplitudeLawAsked),
        motion=given.hammer.motion,
        options=given.reading,
        **given.some("seals", "band"),
    )
    given.draw(lambda: dp.plot.level(found.fit, found.records))
    if given.output:
        write(given.output, workflow.html(found) if kept in PAGE else printed(found) + "\n")
    return Outcome(found, text_of.levels(found), found.checks, verdict=found.verdict)
