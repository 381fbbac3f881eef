"""Command line: each command reads its files, calls one function and writes the result."""

from __future__ import annotations

import atexit
import gc
import os
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

import click

from dashpot.base.errors import DashpotError
from dashpot.base.version import __version__

try:
    from dashpot.registry import COMMANDS as ROWS
    from dashpot.registry import call_handler
except DashpotError as _error:
    # no command is known without the rows
    if "--traceback" in sys.argv:
        raise
    sys.stderr.write(f"dashpot: {_error}\n")
    sys.exit(3)

# The matrices are small: further threads of BLAS would only wait, at full load. Set before NumPy
# is loaded; a number that the user sets takes precedence.
for _name in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_name}_NUM_THREADS", "1")

# Most objects of a command live to its end: garbage collection after every 700 of them finds
# almost nothing. Arrays are freed without it: the peak of memory changes by less than 1 %.
gc.set_threshold(100_000)

# The operating system frees the memory at the end of the process; a last garbage collection would
# take as long as reading a short file.
atexit.register(gc.freeze)

COMMANDS = {command.name: command.help for command in ROWS.values()}


class _LazyGroup(click.Group):
    """A group whose verbs are imported when they are requested, and not to be listed."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(ROWS[cmd_name].module).command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        commands = ROWS.values()
        for title in dict.fromkeys(command.group for command in commands):
            with formatter.section(title):
                formatter.write_dl(
                    [
                        (f"{command.name:<8}", command.help)
                        for command in commands
                        if command.group == title
                    ]
                )

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Answer a word that is no verb with the line that is meant."""
        name, *arguments = args
        if name not in COMMANDS and not name.startswith("-"):
            suggestion = call_handler("suggest", "command", name, arguments, default="")
            ctx.fail(f"There is no command '{name}'. {suggestion}")
        return super().resolve_command(ctx, args)

    def main(self, *arguments: Any, **settings: Any) -> Any:
        """Run a command; every error ends in a sentence and an exit code."""
        run: Callable[..., Any] = super().main
        if not settings.pop("standalone_mode", True):
            return run(*arguments, standalone_mode=False, **settings)
        words = arguments[0] if arguments else settings.get("args")
        try:
            sys.exit(run(*arguments, standalone_mode=False, **settings))
        except Exception as error:  # noqa: BLE001 -- the last net: no one is shown a raw traceback
            from dashpot.cli._failure import report_error

            sys.exit(report_error(error, sys.argv[1:] if words is None else list(words)))


@click.group("dashpot", cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="dashpot")
@click.option("--traceback", is_flag=True, expose_value=False, help="Show where a fault happened.")
def main() -> None:
    """From the relaxation test of a seal to a validated vibration model.

    \b
    dashpot demo --files                     two simulated files to learn on
    dashpot inspect seal_8mm.csv             what is in a file
    dashpot fit seal_8mm.csv -o fit.json     the model, and how well it is known
    dashpot report seal_8mm.csv hammer.csv --mass 114.8g --seals 2

    Quantities carry their unit: 104g, 8mm, 12.71Hz, 1:50Hz. Exit codes: 0 done,
    1 a check failed (--strict), 2 bad input, 3 a fault in dashpot.
    """
