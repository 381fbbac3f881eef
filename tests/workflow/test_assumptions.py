"""The list of assumptions: every name in it exists, and the page is the list."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import click
import pytest

import dashpot
from dashpot.base.checks import REGISTER, Check
from dashpot.cli import COMMANDS, main
from dashpot.cli._param_types import Keyed
from dashpot.workflow.assumptions import ASSUMPTIONS, Assumption

ROOT = Path(__file__).parents[2]
SOURCES = Path(dashpot.__file__).parent


@pytest.mark.parametrize("assumption", ASSUMPTIONS, ids=lambda item: item.name)
def test_every_check_and_option_named_exists(assumption: Assumption) -> None:
    for file in (*SOURCES.rglob("checks.py"), *SOURCES.rglob("checks/*.py")):
        import_module("dashpot." + ".".join(file.relative_to(SOURCES).with_suffix("").parts))
    context = click.Context(main)
    commands = [main.get_command(context, name) for name in COMMANDS]
    options = {
        way
        for command in commands
        if command
        for parameter in command.params
        for way in iterate_spellings(parameter)
    }
    assert set(assumption.checks) <= {name for _, name in REGISTER}
    assert set(assumption.options) <= options
    assert assumption.checks


def iterate_spellings(option: click.Parameter) -> Iterator[str]:
    """An option as it may be named: alone, with a word that it takes, or with a key."""
    for word in option.opts:
        yield word
        if isinstance(option.type, Keyed):
            yield from (f"{word} {key}{option.type.sign}" for key in option.type.fields)
        elif isinstance(option.type, click.Choice):
            yield from (f"{word} {choice}" for choice in option.type.choices)


def test_the_page_is_the_list() -> None:
    spec = spec_from_file_location("assumptions_page", ROOT / "docs" / "assumptions.py")
    assert spec is not None
    assert spec.loader is not None
    written = module_from_spec(spec)
    spec.loader.exec_module(written)
    text = written.PAGE.read_text(encoding="utf-8")
    assert written.page() == text, "run `python docs/assumptions.py`"


def test_what_checks_say_of_an_assumption() -> None:
    clocks = next(
        assumption for assumption in ASSUMPTIONS if assumption.name == "synchronous clocks"
    )
    good, bad, silent = (Check("delay_plausible", passed, "") for passed in (True, False, None))
    assert clocks.state([good, silent]) == "not contradicted"
    assert clocks.state([good, bad]) == "contradicted"
    assert clocks.state([silent, Check("strain_small", False, "")]) == "not tested"
