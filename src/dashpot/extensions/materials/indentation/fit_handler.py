"""An indenter's hit: what it says of a surface."""

from __future__ import annotations

from dataclasses import replace

import click

from dashpot import workflow
from dashpot.base.choices import ImpactLawAsked
from dashpot.cli._command_io import CommandResult
from dashpot.cli.fit_handlers._request import FitRequest


def run(given: FitRequest) -> CommandResult:
    """Find stiffness, damping, modulus and restitution from the motion of an indenter."""
    given.check_output_suffix(".json", what="an indenter's hit")
    if len(given.files) > 1:
        raise click.UsageError(
            f"one hit of an indenter is fitted at a time, and there are {len(given.files)} files. "
            "For a table of all: dashpot batch"
        )
    found = workflow.indent_file(
        given.files[0],
        indenter=replace(given["indenter"], mass=given.mass),
        law=given.model(ImpactLawAsked),
        options=given.reading,
    )
    return given.told(found)
