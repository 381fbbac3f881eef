"""Loops, amplitude sweeps, and FRFs or hits at several levels: what amplitude does."""

from __future__ import annotations

from dashpot import workflow
from dashpot.base.choices import AmplitudeLawAsked
from dashpot.cli._command_io import CommandResult
from dashpot.cli.fit_handlers._request import FitRequest


def run(given: FitRequest) -> CommandResult:
    """Find how far stiffness and damping depend on how far the seal is moved."""
    given.refuse_polarity()
    given.check_output_suffix(".json", what="a fit over amplitude")
    found = workflow.level_files(
        given.files,
        levels=given["levels"],
        mass=given.mass,
        at=given["at"],
        law=given.model(AmplitudeLawAsked),
        motion=given.hammer.motion,
        options=given.reading,
        **given.some("seals", "band"),
        **(given.some("machine") if "--machine" in given.get_option_words() else {}),
    )
    return given.told(found)
