"""One command, one file: read, call, write."""

from __future__ import annotations

import atexit
import gc
import os
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

import click

from dashpot.base.version import __version__

# the matrices are small: threads of BLAS beside the one that works wait for it at full load. Named
# before NumPy is loaded; who names another number is heeded
for _name in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_name}_NUM_THREADS", "1")

# the end of the process frees everything; the interpreter need not search every module for
# cycles on the way out, which takes as long as reading a short file
atexit.register(gc.freeze)

COMMANDS = {
    "inspect": "What is in a file: columns, units, sampling, segments.",
    "fit": "The solid behind a relaxation test, and how well it is known.",
    "predict": "The FRF of a mass on the fitted seal.",
    "impact": "Hammer hits to an FRF, natural frequency and damping.",
    "modes": "Natural frequencies, damping and residues of a measured FRF.",
    "level": "What stiffness and damping do with amplitude.",
    "cld": "Compression load deflection: force at nominal, hysteresis, scatter.",
    "hyperelastic": "The law of a rubber or foam under large strain.",
    "indent": "Stiffness, damping and modulus from an indenter's hit.",
    "rod": "Modulus and loss factor of a rod that shakes under a mass.",
    "door": "A door on its seal line: modes, damping, who holds the energy.",
    "compare": "The predicted FRF against a measured one.",
    "identify": "Maxwell parameters from vibration, alone or jointly.",
    "app": "The same in a browser: drop a file, drag a handle.",
    "batch": "Many tests at once: a folder in, one table out.",
    "watch": "The same, while a rig writes the tests.",
    "record": "Force and displacement as an instrument sends them; reads, never moves.",
    "report": "The main job: both tests in, one report out.",
    "export": "The solid as a deck that a solver reads.",
    "simulate": "The virtual rig and hammer, stamped 'simulated'.",
    "plan": "What a test can and cannot tell, before it is run.",
    "verify": "Check a project's hashes and recompute its results.",
    "example": "Two simulated tests to learn on.",
    "demo": "The whole story on two simulated seals.",
}


class _Lazy(click.Group):
    """A group whose commands are imported when they are asked for, and not to be listed."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(f"dashpot.cli.{cmd_name}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def main(self, *given: Any, **how: Any) -> Any:
        """Run a command; whatever goes wrong ends in a sentence and an exit code."""
        run: Callable[..., Any] = super().main
        if not how.pop("standalone_mode", True):
            return run(*given, standalone_mode=False, **how)
        words = given[0] if given else how.get("args")
        try:
            sys.exit(run(*given, standalone_mode=False, **how))
        except Exception as error:  # noqa: BLE001 -- the last net: no one is shown a raw traceback
            from dashpot.cli._failure import leave

            sys.exit(leave(error, sys.argv[1:] if words is None else list(words)))


@click.group(cls=_Lazy, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="dashpot")
@click.option("--traceback", is_flag=True, expose_value=False, help="Show where a fault happened.")
def main() -> None:
    """From the relaxation test of a seal to a validated vibration model.

    \b
    dashpot example                                    two simulated tests to learn on
    dashpot inspect seal.csv                           what is in a file
    dashpot fit seal.csv                               the solid, and how well it is known
    dashpot report seal.csv --impact hammer.csv --mass 104g --seals 2 -o report.html

    Quantities carry their unit: 104g, 8mm, 12.71Hz, 1:50Hz. Every command that reports takes
    --json. Exit codes: 0 done, 1 a check failed under --strict, 2 bad input or usage,
    3 a fault of dashpot's own.
    """
