"""Handler of ``dashpot fit`` for a rod under a mass."""

from __future__ import annotations

import click

from dashpot.base.errors import ReadError
from dashpot.base.option_fields import FamilyOption
from dashpot.cli._command_files import format_command, format_grams
from dashpot.cli._command_result import CommandResult
from dashpot.cli.fit_handlers import FitRequest
from dashpot.extensions.materials.rod.fit_files import Rod, rod_files


def run(request: FitRequest) -> CommandResult:
    """Find the modulus and the loss factor of a rod's material from the motion of a mass on it."""
    request.check_output_suffix(".json", result_name="the fit of a rod")
    options = {
        "--shape disc:20mm,20mm": request["rod"].disc or request["rod"].block,
        "--density 1000": request["density"],
        "--mass 31.4g": request.mass,
    }
    missing = [words for words, option in options.items() if option is None]
    if missing:
        raise click.UsageError(
            "A rod is known by its shape, its density and the mass on it. Give what is missing: "
            f"{' '.join(missing)}"
        )
    assert request.mass is not None  # noqa: S101
    rod = rod_files(
        request.files,
        mass=request.mass,
        family=request.model(FamilyOption, "maxwell"),
        specimen=request.specimen,
        options=request.reading,
        mass_sd=request["rig"].mass_sd,
        **request.select_options("density", "rod", "arms", "band", "hammer", "poisson"),
    )
    if request.output and not request.page and rod.fit is None:
        raise ReadError(f"-o writes a fit, and there is none: {rod.reason}")
    return request.write_output(rod, next_command=_format_next_command(rod, request))


def _format_next_command(rod: Rod, request: FitRequest) -> str:
    if rod.fit is None or not request.result_path:
        return ""
    part = ("--shape", "disc:20mm,10mm", "--mass", format_grams(rod.mass), "--base")
    return format_command("predict", request.result_path, *part)
