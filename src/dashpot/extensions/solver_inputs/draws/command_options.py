"""Options of ``dashpot export`` for draws; imports no NumPy, so that help is fast."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import click

from dashpot.cli._command import CommandOption, group, opt
from dashpot.cli._command_result import CommandResult
from dashpot.cli._param_types import File


def list_groups() -> list[list[CommandOption]]:
    """Return the options of draws from the uncertainty of a fit."""
    return [
        group(
            "Uncertainty",
            opt("--draws", type=click.IntRange(2, 999), metavar="N",
                help="Also N files drawn from the uncertainty; needs --mass."),
            opt("--seed", type=click.IntRange(0), metavar="N", help="Seed of the draws (0)."),
            opt("--record", type=File(), metavar="FILE",
                help="Record behind the fit: draws what it leaves open."),
        ),
    ]  # fmt: skip


def export_requested_draws(
    target: str, fit: object, output: str, choices: Mapping[str, Any]
) -> CommandResult | None:
    """Write the solver inputs of draws; return None if none are requested.

    Raises
    ------
    UsageError
        If options of draws are given without draws.
    """
    if choices["draws"] is None:
        for name in ("seed", "record"):
            if choices[name] is not None:
                raise click.UsageError(f"--{name} is for draws: add --draws 20")
        return None
    from dashpot.extensions.solver_inputs.draws.draw_files import export_draws

    return export_draws(target, fit, output, choices)
