"""Reading options of a command line, merged with a profile and checked for contradictions."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import fields, replace
from pathlib import Path

import click

from dashpot import workflow
from dashpot.base import units
from dashpot.base.errors import DashpotError, ReadError
from dashpot.cli._command_files import is_json
from dashpot.cli._command_result import note_input
from dashpot.reading.columns.vocabulary import DIMENSION
from dashpot.reading.read_options import ReadOptions

_ROLE_DIMENSIONS = {
    role: DIMENSION[role]
    for role in ("time", "displacement", "force", "hammer", "acceleration", "velocity", "frequency")
}
"""Dimension of each role that is the same for tests of parts and of materials."""


def merge_profiles(
    ctx: click.Context, options: ReadOptions, profiles: Sequence[tuple[str, str]]
) -> ReadOptions:
    """Return the user's options, completed by those of profiles.

    Raises
    ------
    click.UsageError
        If a pattern matches no file that was given.
    ReadError
        If a unit is given to no role and to no column.
    """
    from dashpot.reading.read_options import load_profile

    profile_options, input_files = ReadOptions(), ctx.obj.inputs
    for glob, path in profiles:
        profile = load_profile(path)
        note_input(ctx, path)
        profile_options = (
            profile.with_defaults(profile_options)
            if not glob
            else replace(
                profile_options, file_options=(*profile_options.file_options, (glob, profile))
            )
        )
    options = options.with_defaults(profile_options)
    for file_options in (options, *(entry for _, entry in options.file_options)):
        if file_options.calibration:
            note_input(ctx, file_options.calibration)
    _refuse_unmatched_patterns(ctx, options)
    _refuse_unknown_units(input_files, options)
    return options


def _list_file_arguments(ctx: click.Context) -> list[str]:
    """Return the files among the arguments of a command."""
    argument_names = [
        param.name for param in ctx.command.params if isinstance(param, click.Argument)
    ]
    values = (ctx.params.get(name or "") for name in argument_names)
    words = [word for item in values for word in (item if isinstance(item, tuple) else (item,))]
    return [word for word in words if isinstance(word, str)]


def _refuse_unmatched_patterns(ctx: click.Context, options: ReadOptions) -> None:
    paths = [Path(record) for record in _list_file_arguments(ctx)]
    if any(path.is_dir() for path in paths) or any("*" in str(path) for path in paths):
        return
    for glob, _ in options.file_options:
        if not any(path.match(glob) for path in paths):
            file_names = ", ".join(path.name for path in paths)
            raise click.UsageError(f"'{glob}:' matches none of the files {file_names}.")


def _refuse_unknown_units(input_files: Sequence[str], options: ReadOptions) -> None:
    """Refuse a unit for a name that is neither a role nor a column of any file.

    Nor is one of another dimension that of a role; a signal is in volts before it is calibrated.
    """
    for name, word in options.get_units_by_name().items():
        expected_dimension, dimensions = _ROLE_DIMENSIONS.get(name), units.dimensions(word)
        if (
            expected_dimension
            and dimensions
            and not {expected_dimension, "voltage"} & set(dimensions)
        ):
            from dashpot.reading.columns.role_assignment import EXAMPLE

            raise ReadError(
                f"--units {name}={word}: '{word}' is a unit of {' or '.join(dimensions)}. Give one "
                f"of {expected_dimension}, such as --units {name}={EXAMPLE[name]}"
            )
    _refuse_unknown_columns(input_files, options)


def _refuse_unknown_columns(input_files: Sequence[str], options: ReadOptions) -> None:
    """Refuse a unit for a name that is neither a role nor a column of a file."""
    roles = {field.name for field in fields(ReadOptions)}
    names = options.get_units_by_name().keys() - roles
    inputs = [path for path in input_files if not is_json(path)] if names else []
    for path in inputs:
        with suppress(DashpotError):
            columns = workflow.inspect_file(path, options=options).columns
            names -= {column.name.strip().casefold() for column in columns}
    if names and inputs:
        wrong_name = next(name for name in dict(options.units) if name.strip().casefold() in names)
        raise ReadError(
            f"--units: '{wrong_name}' is no role (time, displacement, force, hammer, acceleration, "
            f"...) and no column of {', '.join(inputs)}. To see the columns: dashpot inspect "
            f"{inputs[0]}"
        )
