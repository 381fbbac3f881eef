"""A rod under a mass: the modulus of its material."""

from __future__ import annotations

import click

from dashpot import workflow
from dashpot.base.choices import FamilyAsked
from dashpot.base.errors import ReadError
from dashpot.cli._command_io import CommandResult, format_command, grams
from dashpot.cli.fit_handlers._request import FitRequest


def run(given: FitRequest) -> CommandResult:
    """Find the modulus and the loss factor of a rod's material from the motion of a mass on it."""
    given.check_output_suffix(".json", what="the fit of a rod")
    asked = {
        "--shape disc:20mm,20mm": given["rod"].disc or given["rod"].block,
        "--density 1000": given["density"],
        "--mass 31.4g": given.mass,
    }
    missing = [words for words, said in asked.items() if said is None]
    if missing:
        raise click.UsageError(
            "A rod is known by its shape, its density and the mass on it. Give what is missing: "
            f"{' '.join(missing)}"
        )
    assert given.mass is not None  # noqa: S101
    found = workflow.rod_files(
        given.files,
        mass=given.mass,
        family=given.model(FamilyAsked, "maxwell"),
        specimen=given.specimen,
        options=given.reading,
        mass_sd=given["rig"].mass_sd,
        **given.some("density", "rod", "arms", "band", "hammer", "poisson"),
    )
    if given.output and not given.page and found.fit is None:
        raise ReadError(f"-o writes a fit, and there is none: {found.reason}")
    return given.told(found, follow=_follow(found, given))


def _follow(found: workflow.Rod, given: FitRequest) -> str:
    if found.fit is None or not given.result_path:
        return ""
    part = ("--shape", "disc:20mm,10mm", "--mass", grams(found.mass), "--base")
    return format_command("predict", given.result_path, *part)
