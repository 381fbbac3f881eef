"""What is typed instead of an option or a command that there is not."""

import pytest
from kit.shell import ran

from dashpot.cli import COMMANDS
from dashpot.cli import main as command_line
from dashpot.cli._command import CommandOption
from dashpot.extensions.guidance.option_suggestions import COMMAND_SYNONYMS, OPTION_SYNONYMS


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("predict fit.json --seal 2", "Did you mean --seals?"),
        ("fit a.csv --order 3", "Did you mean --arms?"),
        ("fit a.csv --nterms 3", "Did you mean --arms?"),
        ("export a.json --units SI", "Did you mean --unit-system?"),
        ("export a.json --solver nastran", "Did you mean --to?"),
        ("plan --freq 3Hz", "Did you mean --frequency?"),
        ("fit a.csv --arsm 3", "Did you mean --arms?"),
        (
            "compare a b --amplitude 0.1N",
            "is an option of dashpot fit, predict, map. Leave it out here.",
        ),
        ("gui", "Did you mean 'app'?"),
        ("convert a.json", "Did you mean 'export'?"),
    ],
)
def test_suggestion_names_the_option_or_command_that_is_meant(typed, meant):
    result = ran(*typed.split())
    assert result.exit_code == 2
    assert meant in " ".join(result.stderr.split())


def test_every_synonym_is_of_an_option_or_command_that_exists():
    flags = {
        flag.lstrip("-")
        for name in COMMANDS
        for option in command_line.get_command(None, name).params
        if isinstance(option, CommandOption)
        for flag in option.opts
    }
    assert {word for words in OPTION_SYNONYMS.values() for word in words} <= flags
    assert set(COMMAND_SYNONYMS.values()) <= set(COMMANDS)
    assert not COMMAND_SYNONYMS.keys() & set(COMMANDS)
