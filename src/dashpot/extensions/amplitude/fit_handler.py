"""Handlers of ``dashpot fit`` for loops, amplitude sweeps, and FRFs or hits by amplitude."""

from __future__ import annotations

from dashpot.base.option_fields import AmplitudeLawOption
from dashpot.cli._command_result import CommandResult
from dashpot.cli.fit_handlers import FitRequest
from dashpot.extensions.amplitude.fit_files import level_files


def run(request: FitRequest) -> CommandResult:
    """Find how far stiffness and damping depend on how far the seal is moved."""
    request.refuse_polarity()
    request.check_output_suffix(".json", result_name="a fit over amplitude")
    levels = level_files(
        request.files,
        levels=request["levels"],
        mass=request.mass,
        at=request["at"],
        law=request.model(AmplitudeLawOption),
        motion=request.hammer.motion,
        options=request.reading,
        **request.select_options("seals", "band"),
        **(request.select_options("machine") if "--machine" in request.get_option_words() else {}),
    )
    return request.write_output(levels)
