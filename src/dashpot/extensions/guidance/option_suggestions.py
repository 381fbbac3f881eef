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

_COMMANDS_AS_OPTIONS = {"help": "--help", "version": "--version"}
"""Commands of other programs that are options here."""
_MIN_SIMILARITY = 0.6
"""Least ratio of `difflib` of a misspelt option and the one that is suggested, of 1."""
_SIMILARITY_BESIDE_OTHERS = 0.85
"""The same, where another command has the very option: ``--seal`` for ``--seals``."""


def suggest_command(name: str, other_words: Sequence[str]) -> str:
    """Return the command that is nearest to an unknown word."""
    if name in _COMMANDS_AS_OPTIONS:
        names = [word for word in other_words[:1] if word in COMMANDS]
        return f"Type: {shlex.join(['dashpot', *names, _COMMANDS_AS_OPTIONS[name]])}"
    if Path(name).exists():
        return f"To see what it is: dashpot inspect {shlex.quote(name)}"
    synonym = COMMAND_SYNONYMS.get(name.lower(), "")
    return (
        f"Did you mean '{synonym}'?" if synonym in COMMANDS else format_suggestion(name, COMMANDS)
    )


def suggest_option(command: click.Command, parent: click.Context | None, option: str) -> str:
    """Return the option that is nearest to an unknown one; "" if there is none.

    A word of other programs comes first, then the nearest option of this command, then the
    commands that have the very option.

    Parameters
    ----------
    command : click.Command
        The one that was typed.
    parent : click.Context or None
        Parent of the group of all commands.
    option : str
        As it was typed, with its dashes.
    """
    spellings = {
        spelling.lstrip("-"): item.flag
        for item in _list_options(command)
        for spelling in item.list_spellings()
        if spelling.startswith("--")
    }
    name = option.lstrip("-").lower()
    synonyms = [spellings[word] for word in OPTION_SYNONYMS.get(name, ()) if word in spellings][:1]
    other_commands = _find_commands_with(parent, option)
    similarity = _SIMILARITY_BESIDE_OTHERS if other_commands else _MIN_SIMILARITY
    matches = get_close_matches(name, spellings, 1, similarity)
    suggestions = synonyms or [spellings[match] for match in matches]
    if suggestions:
        return f"Did you mean {suggestions[0]}?"
    if other_commands:
        return f"{option} is an option of dashpot {', '.join(other_commands)}. Leave it out here."
    return ""


def _list_options(command: click.Command) -> Iterator[CommandOption]:
    """Iterate over the options of a command, without its arguments."""
    return (item for item in command.params if isinstance(item, CommandOption))


def _find_commands_with(parent: click.Context | None, option: str) -> list[str]:
    """Return the commands that have an option."""
    if parent is None or not isinstance(parent.command, click.Group):
        return []
    commands = {name: parent.command.get_command(parent, name) for name in COMMANDS}
    return [
        name
        for name, command in commands.items()
        if command and any(option in item.list_spellings() for item in _list_options(command))
    ]
