"""Suggestions for an option or a command that there is not."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType

import click

from dashpot.cli import COMMANDS
from dashpot.cli._command import CommandOption
from dashpot.cli._param_types import format_suggestion

OPTION_SYNONYMS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "arm": ("arms",), "branches": ("arms",), "n": ("arms",),
        "n-arms": ("arms",), "n-terms": ("arms",), "num-arms": ("arms",), "nterms": ("arms",),
        "order": ("arms",), "prony": ("arms",), "terms": ("arms", "terms"),
        "type": ("kind", "frf-type"), "test-type": ("kind",), "as": ("kind",),
        "at": ("frequency", "temperature"), "freq": ("frequency", "band"),
        "f": ("frequency",), "fmin": ("band",), "fmax": ("band",), "range": ("band",),
        "frequencies": ("band",), "frequency-range": ("band",), "hz": ("frequency",),
        "format": ("to", "form"), "solver": ("to",), "target": ("to",),
        "unit": ("unit-system", "units"), "units": ("unit-system",), "system": ("unit-system",),
        "weight": ("mass",), "block": ("mass",), "m": ("mass",), "count": ("seals",),
        "specimens": ("seals",), "nseals": ("seals",), "n-seals": ("seals",),
        "temp": ("temperature",), "t": ("temperature",), "depth": ("compression",),
        "out": ("output",), "outfile": ("output",),
        "output-file": ("output",), "out-dir": ("output",), "dir": ("output",),
        "save": ("output",), "figure": ("plot",), "fig": ("plot",), "graph": ("plot",),
        "force": ("overwrite", "column"), "replace": ("overwrite",), "yes": ("overwrite",),
        "sample-rate": ("rate",), "fs": ("rate",), "sampling-rate": ("rate",),
        "columns": ("column",),
        "workers": ("jobs",), "threads": ("jobs",), "cores": ("jobs",),
    }
)  # fmt: skip
"""Words of other programs, and the options that they may mean here, the likeliest first."""

COMMAND_SYNONYMS: Mapping[str, str] = MappingProxyType(
    {
        "browser": "app", "gui": "app", "serve": "app", "server": "app", "ui": "app", "web": "app",
        "check": "inspect", "describe": "inspect", "info": "inspect", "open": "inspect",
        "read": "inspect", "show": "inspect", "view": "inspect",
        "creep": "fit", "estimate": "fit", "identify": "fit",
        "impact": "fit", "modal": "fit", "prony": "fit", "relaxation": "fit",
        "frf": "predict", "transmissibility": "predict", "validate": "compare",
        "convert": "export", "deck": "export", "write": "export",
        "directory": "batch", "folder": "batch", "lot": "batch", "lots": "batch", "watch": "batch",
        "design": "plan", "example": "demo", "examples": "demo", "tutorial": "demo",
        "acquire": "record", "log": "record", "generate": "simulate", "synthesize": "simulate",
    }
)  # fmt: skip
"""Words of other programs for a command."""

_ASKED_AS_OPTIONS = {"help": "--help", "version": "--version"}
"""Words that other programs take for a command."""
_NEAR = 0.6
"""Least likeness, of 1, of an option that is meant by a misspelt one."""
_ONE_LETTER = 0.85
"""The same, where another command has the very option: ``--seal`` for ``--seals``."""


def suggest_command(name: str, rest: Sequence[str]) -> str:
    """Return what to type in place of a word that is no command."""
    if name in _ASKED_AS_OPTIONS:
        names = [word for word in rest[:1] if word in COMMANDS]
        return f"Type: {shlex.join(['dashpot', *names, _ASKED_AS_OPTIONS[name]])}"
    if Path(name).exists():
        return f"To see what it is: dashpot inspect {shlex.quote(name)}"
    meant = COMMAND_SYNONYMS.get(name.lower(), "")
    return f"Did you mean '{meant}'?" if meant in COMMANDS else format_suggestion(name, COMMANDS)


def suggest_option(command: click.Command, parent: click.Context | None, option: str) -> str:
    """Return what to type in place of an option that a command lacks; empty where nothing is near.

    A word of other programs comes first, then the nearest option of this command, then the
    commands that have the very option.

    Parameters
    ----------
    command : click.Command
        The one that was typed.
    parent : click.Context or None
        Of the group of all commands.
    option : str
        As it was typed, with its dashes.
    """
    spellings = {
        spelling.lstrip("-"): item.flag
        for item in _options(command)
        for spelling in item.list_spellings()
        if spelling.startswith("--")
    }
    typed = option.lstrip("-").lower()
    meant = [spellings[word] for word in OPTION_SYNONYMS.get(typed, ()) if word in spellings][:1]
    elsewhere = _find_commands_with(parent, option)
    near = get_close_matches(typed, spellings, 1, _ONE_LETTER if elsewhere else _NEAR)
    found = meant or [spellings[name] for name in near]
    if found:
        return f"Did you mean {found[0]}?"
    if elsewhere:
        return f"{option} is an option of dashpot {', '.join(elsewhere)}. Leave it out here."
    return ""


def _options(command: click.Command) -> Iterator[CommandOption]:
    return (item for item in command.params if isinstance(item, CommandOption))


def _find_commands_with(parent: click.Context | None, option: str) -> list[str]:
    """Return the commands that have an option."""
    if parent is None or not isinstance(parent.command, click.Group):
        return []
    every = {name: parent.command.get_command(parent, name) for name in COMMANDS}
    return [
        name
        for name, command in every.items()
        if command and any(option in item.list_spellings() for item in _options(command))
    ]
