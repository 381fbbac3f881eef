"""A noun's fields make the options of a command, and the options make the noun."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import click
import pytest
from click.testing import CliRunner

from dashpot.base.options import flag_of, option
from dashpot.cli import COMMANDS, main
from dashpot.cli._options import filled, given, specimens
from dashpot.io.options import ReadOptions
from dashpot.records.machine import Machine
from dashpot.records.specimen import Specimen
from dashpot.workflow.job import HammerChoices


@dataclass(frozen=True)
class Tea:
    """Something with one field of each kind."""

    kind: str = option("green", "What leaves.", choices=("green", "black"))
    water: float | None = option(None, "How hot.", unit="temperature")
    infusions: int = option(1, least=1)
    with_: tuple[str, ...] = option((), metavar="WHAT", multiple=True)
    cups: tuple[int, ...] | None = option(
        None, multiple=True, parse=lambda texts: tuple(map(int, texts)) or None
    )
    hidden: str = "not asked for"


def brewed(*words):
    got = []

    @click.command()
    @filled(Tea, "tea", show_default=True)
    def command(*, tea):
        got.append(tea)

    result = CliRunner().invoke(command, words)
    return result, got


def test_no_option_is_the_noun_itself():
    assert brewed()[1] == [Tea()]


def test_every_kind_of_option_fills_its_field():
    words = "--kind black --water 80degC --infusions 3 --with- milk --with- sugar --cups 2 --cups 3"
    _, (tea,) = brewed(*words.split())
    assert tea == Tea("black", pytest.approx(353.15), 3, ("milk", "sugar"), (2, 3))


def test_help_tells_what_the_field_says():
    text = brewed("--help")[0].output
    assert "What leaves.  [default: green]" in text
    assert "--hidden" not in text


@pytest.mark.parametrize(
    ("words", "says"),
    [(("--kind", "mud"), "mud"), (("--water", "80"), "no unit"), (("--infusions", "0"), "0")],
)
def test_what_cannot_be_is_refused(words, says):
    result, got = brewed(*words)
    assert result.exit_code == 2
    assert says in result.output
    assert not got


@pytest.mark.parametrize(
    ("command", "nouns"),
    [
        ("fit", (ReadOptions, Specimen, Machine)),
        ("predict", (Machine, ReadOptions)),
        ("inspect", (ReadOptions,)),
        ("impact", (ReadOptions, HammerChoices)),
        ("modes", (ReadOptions,)),
        ("compare", (ReadOptions, HammerChoices)),
        ("identify", (ReadOptions, HammerChoices, Machine)),
        ("report", (ReadOptions, Specimen, HammerChoices, Machine)),
        ("export", (Specimen,)),
    ],
)
def test_commands_offer_every_field_of_their_nouns(command, nouns):
    text = CliRunner().invoke(main, [command, "--help"]).output
    for noun in nouns:
        for one in fields(noun):
            if one.metadata:
                assert f"{flag_of(one)} " in text


def test_a_rig_without_a_test_is_refused(tmp_path):
    fit = tmp_path / "fit.json"
    fit.write_text('{"schema": "dashpot/fit@1", "model": {"k_inf": 200.0, "arms": []}}')
    words = ["predict", str(fit), "--mass", "104g", "--compliance", "50um/N"]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 2
    assert "add the record (--with)" in result.output


def test_the_list_of_commands_needs_none_of_them():
    text = CliRunner().invoke(main, ["--help"]).output
    for name, says in COMMANDS.items():
        assert f"  {name} " in text
        assert says in " ".join(text.split())


def test_the_next_command_says_each_of_several_temperatures() -> None:
    @click.command()
    @specimens
    def asked(**_: Any) -> None:
        click.echo(" ".join(given()))

    said = ["--temperature", "23degC", "--temperature", "0degC", "--length", "50mm"]
    done = CliRunner().invoke(asked, said)
    assert done.output.split() == said
