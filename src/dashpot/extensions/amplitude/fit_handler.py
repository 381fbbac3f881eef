"""Loops, amplitude sweeps, and FRFs or hits at several levels: what amplitude does."""

from __future__ import annotations

from dashpot import workflow
from dashpot.base.choices import AmplitudeLawAsked
from dashpot.cli._command_io import Outcome
from dashpot.cli.fit_handlers._request import Given


def run(given: Given) -> Outcome:
    """Find how far stiffness and damping depend on how far the seal is moved."""
    given.refuse_polarity()
    given.kept_as(".json", what="a fit over amplitude")
    found = workflow.level_files(
        given.files,
        levels=given["levels"],
        mass=given.mass,
        at=given["at"],
        law=given.model(AmplitudeLawAsked),
        motion=given.hammer.motion,
        options=given.reading,
        **given.some("seals", "band"),
        **(given.some("machine") if "--machine" in given.again() else {}),
    )
    return given.told(found)
