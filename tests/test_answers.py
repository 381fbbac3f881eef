"""The commands by whose answers a change is judged, and what their answers may move by."""

from __future__ import annotations

import importlib.util
import shlex
from pathlib import Path

import click
import pytest

from dashpot.cli import COMMANDS, main

ANSWERS = Path(__file__).resolve().parents[1] / "benchmarks" / "answers.txt"
LINES = [
    line
    for line in ANSWERS.read_text(encoding="utf-8").splitlines()
    if line and not line.startswith("#")
]
NOT_COMPARED = {"app", "record", "demo"}
"""Two have no end, one is report on files of its own, or writes the files for all."""


@pytest.mark.parametrize("line", LINES)
def test_every_line_is_a_command_with_options_that_it_has(line):
    program, name, *words = shlex.split(line)
    assert program == "dashpot"
    command = main.get_command(click.Context(main), name)
    assert command is not None
    command.make_context(name, words)


def test_every_command_has_a_line():
    assert {line.split()[1] for line in LINES} == set(COMMANDS) - NOT_COMPARED


def agree(before, after):
    """Whether benchmarks/answers.py takes two documents for the same."""
    spec = importlib.util.spec_from_file_location("answers", ANSWERS.with_suffix(".py"))
    assert spec is not None
    assert spec.loader is not None
    answers = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(answers)
    return all(size <= 1 for size, *_ in answers.differences(before, after, 1e-3))


FIT = {"model": {"arms": [{"k": 20.0}]}, "standard_error": {"arms": [{"k": 2.0}]}}


@pytest.mark.parametrize(
    ("before", "inside", "outside"),
    [
        (FIT, FIT | {"model": {"arms": [{"k": 20.0199}]}},
         FIT | {"model": {"arms": [{"k": 20.0201}]}}),
        (FIT, FIT | {"standard_error": {"arms": [{"k": 2.0199}]}},
         FIT | {"standard_error": {"arms": [{"k": 2.0201}]}}),
        ({"loss": 5.0, "loss_se": 1.0}, {"loss": 5.0099, "loss_se": 1.0},
         {"loss": 5.0101, "loss_se": 1.0}),
        ({"interval_95": {"k": [0.0, 4.0]}}, {"interval_95": {"k": [0.0, 4.0099]}},
         {"interval_95": {"k": [0.0, 4.0101]}}),
        ({"k": 3.0, "intervals": {"k": [1, 5]}}, {"k": 3.0099, "intervals": {"k": [1, 5]}},
         {"k": 3.0101, "intervals": {"k": [1, 5]}}),
        ({"bic": 10.0}, {"bic": 10.099}, {"bic": 10.101}),
        ({"covariance": [[4.0, 1.0]]}, {"covariance": [[4.0, 1.079]]},
         {"covariance": [[4.0, 1.081]]}),
        ({"real": [100.0, 1.0]}, {"real": [100.0, 1.099]}, {"real": [100.0, 1.101]}),
        ({"value": 1e-16}, {"value": 1.01e-14}, {"value": 1.03e-14}),
        ({"deck": "a\nPBUSH .1763197"}, {"deck": "a\nPBUSH .1764"}, {"deck": "a\nPBUSH .1766"}),
        ({"tare": "tare of 50.3 mN"}, {"tare": "tare of 50.4 mN"}, {"tare": "tare of 50.5 mN"}),
        ({"message": "use"}, {"message": "use"}, {"message": "do not use"}),
        ({"k": 1.0}, {"k": 1.0}, {"k": 1.0, "tau": 1.0}),
        ({"k": None}, {"k": None}, {"k": 0.0}),
        ({"ok": True}, {"ok": True}, {"ok": False}),
    ],
)  # fmt: skip
def test_agree_uses_the_tolerance_of_a_quantity(before, inside, outside):
    assert agree(before, inside)
    assert not agree(before, outside)
