"""Failures of commands: a sentence and an exit code, with escape sequences removed."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from unicodedata import category

import click
import pytest
from hypothesis import given
from hypothesis import strategies as st
from kit.kinds import bench, ramp_and_hold
from kit.shell import ran

from dashpot import workflow
from dashpot.base.plain_text import escape_terminal_text, escaped_json
from dashpot.cli import COMMANDS, main
from dashpot.cli._param_types import Output
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER

HIDDEN = "\x1b[2J\x1b]0;title\x07\x9b31m\u202e"


@pytest.fixture
def broken(monkeypatch, tmp_path):
    """A dashpot with a fault, and a file to meet it with."""

    def fit_files(*_, **__):
        raise IndexError("index 3 is out of bounds\nfor axis 0")

    monkeypatch.setattr(workflow, "fit_files", fit_files, raising=False)
    (tmp_path / "seal.csv").write_text(bench(ramp_and_hold()))
    return tmp_path / "seal.csv"


def test_a_fault_is_a_sentence_and_exit_code_3(broken):
    result = ran("fit", broken)
    assert result.exit_code == 3
    assert result.stdout == ""
    assert result.stderr.count("\n") == 2  # what was recognised, and one sentence
    assert "IndexError: index 3 is out of bounds. Please report" in result.stderr
    assert "SECURITY.md" in result.stderr
    assert "Traceback" not in result.output


@pytest.mark.parametrize("words", [("--traceback", "fit"), ("fit", "--traceback")])
def test_a_fault_is_shown_to_who_asks(broken, words):
    result = ran(*words, broken)
    assert result.exit_code == 3
    assert "Traceback" in result.stderr
    assert "fit_files" in result.stderr


@pytest.mark.parametrize(
    ("words", "kind", "code"),
    [
        (("fit", "{file}"), "InternalError", 3),
        (("fit", "--nope"), "UsageError", 2),
        (("fit",), "UsageError", 2),
        (("nope",), "UsageError", 2),
        (("predict", "{file}", "--mass", "104"), "UsageError", 2),
        (("inspect", "none.csv"), "ReadError", 2),
        (("verify", "{file}"), "ReadError", 2),
        (("fit", "{file}", "-o", "."), "ExportError", 2),
    ],
)
def test_under_json_every_error_is_a_document(broken, words, kind, code):
    if kind == "OSError":
        broken.write_text("")
    result = ran(*(word.format(file=broken) for word in words), "--json")
    document = json.loads(result.stdout)
    assert document["schema"] == "dashpot/error@2"
    assert (document["kind"], document["exit_code"], result.exit_code) == (kind, code, code)
    assert document["message"] in result.stderr.replace("\n", " ")


def test_a_file_called_json_asks_for_no_document(broken):
    result = ran("inspect", "--", "--json")
    assert result.exit_code == 2
    assert result.stdout == ""


def test_interrupted_is_no_failed_check(broken, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(workflow, "fit_files", interrupt)
    result = ran("fit", broken)
    assert result.exit_code == 130
    assert "interrupted" in result.stderr


@given(st.text())
def test_escaped_text_holds_nothing_that_a_terminal_obeys(text):
    shown = escape_terminal_text(text)
    assert not {sign for sign in shown if category(sign) in {"Cc", "Cs"}} - {"\t", "\n"}
    assert not set(HIDDEN[-1:]) & set(shown)
    shown.encode()


@given(st.text())
def test_an_escaped_document_holds_the_same(text):
    document = json.dumps({"a": text}, ensure_ascii=False, indent=2)
    assert json.loads(escaped_json(document)) == {"a": text}
    escaped_json(document).encode()


def test_colours_stay_and_nothing_else():
    red = click.style("bad", fg="red", bold=True)
    assert escape_terminal_text(red, colours=True) == red
    assert "\x1b" not in escape_terminal_text("\x1b[8mhidden\x1b[2J\x1b[1A", colours=True)


@pytest.mark.parametrize("option", [(), ("--json",)])
def test_the_name_of_a_file_is_not_obeyed(tmp_path, option):
    path = tmp_path / f"seal{HIDDEN}.csv"
    for text in (None, "time [s],displacement [mm],force [N]\n0,0,0\n", f"a{HIDDEN},b\n1,2\n"):
        if text is not None:
            path.write_text(text)
        result = ran("inspect", path, *option)
        assert not set(HIDDEN[:1] + "\x07\x9b\u202e") & set(result.stdout + result.stderr)


@pytest.mark.skipif(os.name == "nt", reason="names are text there")
def test_a_name_that_is_no_text_is_printed(tmp_path):
    path = tmp_path / os.fsdecode(b"seal\xff.csv")
    path.write_text("time [s],displacement [mm],force [N]\n0,0,0\n")
    for option in ("--json", "--strict"):
        result = ran("inspect", path, option)
        assert r"\udcff" in result.stdout
        assert "Traceback" not in result.output
        assert result.exit_code < 2


def outputs(name):
    command = main.get_command(click.Context(main), name)
    return command, [
        parameter for parameter in command.params if isinstance(parameter.type, Output)
    ]


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_that_writes_has_an_overwrite_option(name):
    command, written = outputs(name)
    parameters = {option for parameter in command.params for option in parameter.opts}
    # demo writes a folder; verify clears what killed runs left
    assert ("--overwrite" in parameters) == bool(written or name in {"demo", "verify"})
    # no option names a file to write without saying so
    assert {"-o", "--plot", "--save", "--stiffness-table", "--save-shifts"} & parameters <= {
        option for item in written for option in item.opts
    } | ({"-o"} if name in {"demo", "batch"} else set())  # a folder


def test_the_measurement_is_not_written_over(tmp_path):
    path = tmp_path / "seal"
    ran("simulate", "relaxation", "--hold", "3s", "-o", path)
    before = path.read_bytes()
    for words in (("fit", path), ("report", path), ("inspect", path)):
        option = "--save" if words[0] == "inspect" else "-o"
        result = ran(*words, option, path, "--overwrite")
        assert result.exit_code == 2
        assert "is never written over" in result.stderr
    assert path.read_bytes() == before


def test_stdout_holds_one_document_even_where_the_output_is_stdout(tmp_path):
    fit = tmp_path / "fit.json"
    fit.write_text(
        '{"schema": "dashpot/fit@2", "model": {"k_inf": 200.0, "arms": [{"k": 100.0, "tau": 0.5}]}}'
    )
    deck = json.loads(
        ran("export", fit, "--to", "csv", "--unit-system", "SI", "--allow", "all", "--json").stdout
    )
    assert deck["deck"].startswith("# dashpot ")
    words = ("predict", fit, "--mass", "104g", "-o", "-", "--json")
    assert json.loads(ran(*words).stdout)["schema"] == "dashpot/prediction@2"
    words = ("simulate", "relaxation", "--hold", "3s", "-o", "-", "--json")
    assert "time [s]" in json.loads(ran(*words).stdout)["text"]


def test_nothing_follows_a_document_that_goes_to_stdout(tmp_path):
    path = tmp_path / "tension.csv"
    path.write_text(workflow.EXAMPLES["tension.csv"](), encoding="utf-8")
    document = json.loads(ran("fit", path, "-o", "-").stdout)
    assert document["schema"].startswith("dashpot/")


def test_columns_in_each_others_place_end_in_a_sentence(tmp_path):
    """A force taken for a displacement knows of no stiffness, nor of a ratio of two."""
    made = simulate_relaxation(PAPER, hold_time=6.0, rig=Rig(rate=200.0)).test
    swapped = replace(made, displacement=1e-3 * made.force, force=1e3 * made.displacement)
    path = tmp_path / "seal.csv"
    path.write_text(write_relaxation(swapped))
    result = ran("report", path, "--mass", "104g", "-o", tmp_path / "report.html")
    assert result.exit_code in {0, 2}, result.output
