"""Handler of ``dashpot fit`` for blank tests."""

from __future__ import annotations

from dashpot.cli._command_files import format_command
from dashpot.cli._command_result import CommandResult, write_output
from dashpot.cli.fit_handlers import FitRequest
from dashpot.extensions.blank_tests.fit_files import fit_blank_files
from dashpot.extensions.blank_tests.machine_file import render_machine_file


def run(request: FitRequest) -> CommandResult:
    """Fit a testing machine to its blank tests, and write the machine file."""
    suffix = request.check_output_suffix(".toml", ".json", result_name="a machine")
    fit = fit_blank_files(
        request.files, options=request.reading,
        **request.select_options("spring_stiffness", "spring_error", "roles"),
    )  # fmt: skip
    if suffix == ".toml":
        request.draw(fit.plot)
        write_output(request.output or "", render_machine_file(fit, date=request.specimen.date))
        next_command = format_command("fit", "SEAL", "--machine", request.output)
        return CommandResult.from_result(fit, next_command=next_command)
    json_options = request.get_option_words("as_json")
    next_command = format_command(
        "fit", *request.files, *json_options, "-o", "rig.toml", remark="writes it"
    )
    return request.write_output(fit, next_command=next_command)
