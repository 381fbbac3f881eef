"""Stress over strain: the law of a rubber or a foam."""

from __future__ import annotations

import click

from dashpot import workflow
from dashpot.base.choices import ElasticKindAsked
from dashpot.cli._command_io import CommandResult, format_command
from dashpot.cli.fit_handlers._request import FitRequest


def run(given: FitRequest) -> CommandResult:
    """Fit a hyperelastic law to stress over strain in one mode of test or several."""
    given.check_output_suffix(".json", what="a hyperelastic law")
    memory = given["memory"]
    if len(memory) > 1:
        raise click.UsageError("--memory takes one fit. Give it once.")
    found = workflow.hyperelastic_files(
        _group_files_by_mode(given),
        memory=workflow.read_fit(memory[0]) if memory else None,
        law=given.model(ElasticKindAsked),
        terms=given["terms"] or "auto",
        specimen=given.specimen,
        options=given.reading,
        **given.some("poisson", "stretches", "measures"),
    )
    follow = ""
    if given.result_path:
        bulk = () if found.law.bulk_modulus else ("--bulk-modulus", "2000MPa")
        warm = () if found.temperature else ("--temperature", "23degC")
        deck = ("export", given.result_path, "--to", "abaqus", "--unit-system", "mm-t-s")
        follow = format_command(*deck, *warm, *bulk)
    return given.told(found, follow=follow)


def _group_files_by_mode(given: FitRequest) -> dict[str, list[str]]:
    """Return the files of each mode of test, in the order in which both were given."""
    modes, files = given["test"] or ("uniaxial",), given.files
    if len(modes) not in {1, len(files)}:
        raise click.UsageError(
            f"--test was given {len(modes)} times for {len(files)} files; give it once, or once "
            "for each file, in their order."
        )
    each = modes * len(files) if len(modes) == 1 else modes
    found: dict[str, list[str]] = {}
    for mode, path in zip(each, files, strict=True):
        found.setdefault(mode, []).append(path)
    return found
