"""Options made from the fields of a dataclass, and the value made from the options."""

from __future__ import annotations

import re
from dataclasses import dataclass

import click
import pytest
from click.testing import CliRunner
from kit.shell import ran

from dashpot.base.option_fields import (
    get_option_flag,
    get_option_key,
    iterate_option_fields,
    option,
)
from dashpot.cli import COMMANDS, main
from dashpot.cli._command import KEYED_OPTIONS, build_options, verb
from dashpot.cli._failure import _classify_error
from dashpot.cli._options import get_typed_options, specimen_options
from dashpot.cli._param_types import Keyed
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.reading.read_options import ReadOptions
from dashpot.workflow.job import HammerChoices, TimeLimits


@dataclass(frozen=True)
class Tea:
    """Something with one field of each kind."""

    kind: str = option("green", "What leaves.", choices=("green", "black"))
    water: float | None = option(None, "How hot.", unit="temperature")
    infusions: int = option(1, "How often.", minimum=1)
    with_: tuple[str, ...] = option((), "What else.", metavar="WHAT", multiple=True)
    cups: tuple[int, ...] | None = option(
        None, "How large.", multiple=True, parse=lambda texts: tuple(map(int, texts)) or None
    )
    steep: float | None = option(None, "How long.", unit="time", keyed_flag="pot", key="time")
    leaf: str | None = option(None, "Whose.", keyed_flag="pot")
    hidden: str = "not asked for"


@pytest.fixture(autouse=True)
def _pot(monkeypatch):
    monkeypatch.setitem(KEYED_OPTIONS, "--pot", ("KEY=VALUE", "time or leaf."))


def run_brew(*words):
    got = []

    @verb("brew", "Brew it.", build_options(Tea, argument="tea"))
    def command(*, tea):
        got.append(tea)

    result = CliRunner().invoke(command, words)
    return result, got


def test_options_of_no_field_make_the_default_value():
    assert run_brew()[1] == [Tea()]


def test_every_kind_of_option_fills_its_field():
    words = "--kind black --water 80degC --infusions 3 --with- milk --with- sugar --cups 2 --cups 3"
    _, (tea,) = run_brew(*words.split(), "--pot", "time=180s,leaf=whole")
    assert tea == Tea("black", pytest.approx(353.15), 3, ("milk", "sugar"), (2, 3), 180.0, "whole")


def test_key_value_option_may_be_repeated():
    _, (tea,) = run_brew("--pot", "leaf=whole, with stalks", "--pot", "time=3min")
    assert (tea.steep, tea.leaf) == (180.0, "whole, with stalks")


def test_help_tells_what_the_field_says():
    text = run_brew("--help")[0].output
    assert "What leaves (green)." in text
    assert "--kind green|black" in text
    assert "--pot KEY=VALUE" in text
    assert "--hidden" not in text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--kind", "gren"), "'gren' is unknown. Did you mean 'green'?"),
        (("--kind", "mud"), "Known are green and black."),
        (("--water", "80"), "no unit"),
        (("--infusions", "0"), "0"),
        (("--pot", "leave=whole"), "'leave' is unknown. Did you mean 'leaf'?"),
        (("--pot", "whole"), "write --pot time=VALUE"),
        (("--pot", "time=3mm"), "expected a unit of time"),
    ],
)
def test_what_cannot_be_is_refused(words, message):
    result, got = run_brew(*words)
    assert result.exit_code == 2
    assert message in " ".join(result.output.split())
    assert not got


@pytest.mark.parametrize(
    ("command", "nouns"),
    [
        ("fit", (ReadOptions, Specimen, Machine, TimeLimits, HammerChoices)),
        ("predict", (Machine, ReadOptions)),
        ("inspect", (ReadOptions,)),
        ("compare", (ReadOptions, HammerChoices)),
        ("report", (ReadOptions, Specimen, HammerChoices, Machine, TimeLimits)),
        ("batch", (ReadOptions,)),
        ("export", (Specimen,)),
    ],
)
def test_commands_offer_every_field_of_their_nouns(command, nouns):
    text = ran(command, "--help-all").output
    result = main.get_command(click.Context(main), command)
    assert result is not None
    for value in nouns:
        for field in iterate_option_fields(value):
            assert f"{get_option_flag(field)} " in text
            (requested,) = [
                parameter for parameter in result.params if get_option_flag(field) in parameter.opts
            ]
            if "keyed_flag" in field.metadata:
                assert isinstance(requested.type, Keyed)
                assert requested.type.fields[get_option_key(field)] == field


def test_a_rig_without_a_test_is_refused(tmp_path):
    fit = tmp_path / "fit.json"
    fit.write_text('{"schema": "dashpot/fit@2", "model": {"k_inf": 200.0, "arms": []}}')
    result = ran("predict", fit, "--mass", "104g", "--machine", "compliance=50um/N")
    assert result.exit_code == 2
    assert "--record" in result.output


def test_the_list_of_commands_needs_none_of_them():
    text = ran("--help").output
    for name, message in COMMANDS.items():
        assert f"  {name} " in text
        assert message in " ".join(text.split())


def test_the_next_command_says_each_of_several_temperatures() -> None:
    @verb("asked", "Say it again.", specimen_options(per_file=True))
    def print_typed_options(**_: object) -> None:
        click.echo(" ".join(get_typed_options()))

    message = ["--temperature", "23degC", "--temperature", "0degC", "--length", "50mm"]
    done = CliRunner().invoke(print_typed_options, message)
    assert done.output.split() == message


DEPRECATED_OPTIONS = {
    "fit": {
        "--text": "--text-format", "--part": "--file-part", "--as": "--kind",
        "--known": "--prior", "--only": "--at-temperature", "--cuts": "--time-limits",
        "--level": "--amplitude", "--resonance-at": "--resonance-amplitude",
        "--memory": "--relaxation", "--slam": "--drop", "--between": "--compression-limits",
    },
    "predict": {
        "--text": "--text-format", "--part": "--file-part", "--as": "--kind",
        "--until": "--end", "--new": "--unaged-fit", "--level": "--amplitude",
        "--fitted-at": "--reference-strain", "--resonance-level": "--resonance-amplitude",
        "--slam": "--drop",
    },
    "batch": {
        "--text": "--text-format", "--part": "--file-part", "--as": "--kind",
        "--by": "--label-pattern",
    },
    "plan": {"--wanted": "--target-sd"},
}  # fmt: skip
"""Names of options in the edition before, with those of now."""


@pytest.mark.parametrize("name", DEPRECATED_OPTIONS)
def test_option_takes_its_earlier_spelling_and_hides_it(name):
    command = main.get_command(click.Context(main), name)
    help_text = ran(name, "--help-all").output
    parser = command.make_parser(click.Context(command))
    declared = {
        f"--{option.hidden_alias}": option.flag
        for option in command.options
        if option.hidden_alias and option.hidden_alias not in {"text", "part", "as"}
    }
    assert declared.items() <= DEPRECATED_OPTIONS[name].items()
    for previous, flag in DEPRECATED_OPTIONS[name].items():
        assert f" {previous} " not in help_text
        assert f" {flag} " in help_text
        taken, _, _ = parser.parse_args(["file", previous, "5"])
        assert taken == parser.parse_args(["file", flag, "5"])[0] != {}


def test_predict_takes_kind_for_frf_type(tmp_path):
    fit = tmp_path / "fit.json"
    fit.write_text('{"schema": "dashpot/fit@1", "model": {"k_inf": 200.0, "arms": []}}')
    words = ("predict", fit, "--mass", "104g", "--json")
    outputs = [ran(*words, flag, "mobility").output for flag in ("--kind", "--frf-type")]
    assert outputs[0] == outputs[1]
    assert "mobility" in outputs[0]


@pytest.mark.parametrize(
    ("words", "shown"),
    [
        ("fit FILE --betwen 5", "--compression-limits"),
        ("fit FILE --levl 1N", "--amplitude"),
        ("fit FILE --memor x", "--relaxation"),
        ("compare a b --level 0.1N", "is an option of dashpot fit, predict"),
        ("report FILE --known k_inf=1", "is an option of dashpot fit"),
    ],
)
def test_suggestion_shows_the_present_spelling(words, shown):
    exception = CliRunner().invoke(main, words.split(), standalone_mode=False).exception
    assert isinstance(exception, click.NoSuchOption)
    text = _classify_error(exception).message
    assert shown in text
    assert not re.search(r"Did you mean.*--(between|level|memory|known)\b", text)
