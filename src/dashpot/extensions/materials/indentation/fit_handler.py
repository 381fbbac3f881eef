"""Handler of ``dashpot fit`` for indentation tests."""

from __future__ import annotations

from dataclasses import replace

import click

from dashpot.cli._command_result import CommandResult
from dashpot.cli.fit_handlers import FitRequest
from dashpot.extensions.materials.indentation.fit_files import indent_file
from dashpot.extensions.materials.indentation.indenter import ImpactLawOption


def run(value: FitRequest) -> CommandResult:
    """Find stiffness, damping, modulus and restitution from the motion of an indenter."""
    value.check_output_suffix(".json", result_name="an indenter's hit")
    if len(value.files) > 1:
        raise click.UsageError(
            f"one hit of an indenter is fitted at a time, and there are {len(value.files)} files. "
            "For a table of all: dashpot batch"
        )
    indentation_fit = indent_file(
        value.files[0],
        indenter=replace(value["indenter"], mass=value.mass),
        law=value.model(ImpactLawOption),
        options=value.reading,
    )
    return value.write_output(indentation_fit)
