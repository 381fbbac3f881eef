"""Handler of ``dashpot fit`` for stress-strain tests: the law of a rubber or foam."""

from __future__ import annotations

import click

from dashpot import workflow
from dashpot.cli._command_files import format_command
from dashpot.cli._command_result import CommandResult
from dashpot.cli.fit_handlers import FitRequest
from dashpot.extensions.materials.hyperelastic.fit_files import hyperelastic_files
from dashpot.extensions.materials.hyperelastic.law_choices import ElasticKindOption


def run(request: FitRequest) -> CommandResult:
    """Fit a hyperelastic law to stress over strain in one mode of test or several."""
    request.check_output_suffix(".json", result_name="a hyperelastic law")
    relaxation = request["relaxation"]
    if len(relaxation) > 1:
        raise click.UsageError("--relaxation takes one fit. Give it once.")
    hyperelastic_fit = hyperelastic_files(
        _group_files_by_mode(request),
        relaxation=workflow.read_fit(relaxation[0]) if relaxation else None,
        law=request.model(ElasticKindOption),
        terms=request["terms"] or "auto",
        specimen=request.specimen,
        options=request.reading,
        **request.select_options("poisson", "stretches", "measures"),
    )
    next_command = ""
    if request.result_path:
        bulk = () if hyperelastic_fit.law.bulk_modulus else ("--bulk-modulus", "2000MPa")
        temperature_options = () if hyperelastic_fit.temperature else ("--temperature", "23degC")
        deck = ("export", request.result_path, "--to", "abaqus", "--unit-system", "mm-t-s")
        next_command = format_command(*deck, *temperature_options, *bulk)
    return request.write_output(hyperelastic_fit, next_command=next_command)


def _group_files_by_mode(request: FitRequest) -> dict[str, list[str]]:
    """Return the files of each mode of test, in the order in which both were given."""
    modes, files = request["test"] or ("auto",), request.files
    if len(modes) not in {1, len(files)}:
        raise click.UsageError(
            f"--test was given {len(modes)} times for {len(files)} files; give it once, or once "
            "for each file, in their order."
        )
    names = modes * len(files) if len(modes) == 1 else modes
    entries: dict[str, list[str]] = {}
    for mode, path in zip(names, files, strict=True):
        entries.setdefault(mode, []).append(path)
    return entries
