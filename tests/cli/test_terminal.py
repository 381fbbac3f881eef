"""What a terminal shows: the verdict first, within a screen, in colour only where it may be."""

from __future__ import annotations

import io
import os
import sys
from dataclasses import replace
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st
from kit import handmade
from kit.fits import a_fit, replace_fields
from kit.shell import ran

import dashpot as dp
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.progress import send_progress
from dashpot.cli import _command_files, _command_result, _terminal
from dashpot.cli._command import verb
from dashpot.cli._command_result import CommandResult
from dashpot.cli._options import result_options
from dashpot.datamodel.fit_diagnostics import DepthStiffness
from dashpot.datamodel.frf import Hit
from dashpot.export import TARGETS
from dashpot.text_output import layout, results
from dashpot.text_output.layout import (
    COLUMNS,
    LINES,
    ScreenSize,
    Text,
    format_for_screen,
    wrap_line,
)
from dashpot.workflow.example_files import FILES, MASS
from dashpot.workflow.json_archive import from_json, to_json

STOP = Check("a_stop", False, "a stop; do that", grade="stop")
LONG = Check("long_winded", False, "So much is to be said of it that it goes on. " * 12)
NOTE = Check("a_note", False, "A note.", grade="note")


NARROW = ScreenSize(80, 20)


def strip_styles(lines):
    return [click.unstyle(line) for line in lines]


# -- a result on a screen --------------------------------------------------------------------------


@given(
    st.lists(st.text(st.characters(exclude_categories=["Cs"]), max_size=400), max_size=60),
    st.lists(st.sampled_from([STOP, LONG, NOTE, replace(NOTE, passed=True)]), max_size=60),
)
def test_screen_output_fits_and_begins_with_the_verdict(lines, checks):
    result = verdict(checks)
    printed = strip_styles(format_for_screen(Text(lines, ["more"]), result, checks, verbose=False))
    assert len(printed) <= LINES
    assert printed[0].startswith(f"{result.use.capitalize()}:")
    assert all(len(line) <= COLUMNS or " " not in line.strip() for line in printed)
    assert printed[-1] == "  more with -v"


@pytest.mark.parametrize(("rows", "more"), [(LINES - 1, False), (LINES, True)])
def test_screen_output_states_that_lines_were_cut(rows, more):
    printed = format_for_screen(Text([f"row {i}" for i in range(rows)]), None, (), verbose=False)
    assert (printed[-1] == "  more with -v") is more
    assert len(printed) <= LINES


def test_screen_output_never_cuts_requested_lines():
    body, wanted = [f"line {i}" for i in range(80)], [f"share {i}" for i in range(50)]
    text = format_for_screen(Text(body, requested_lines=wanted), None, [Check("one", True, "")])
    assert [line for line in text if line.startswith("share")] == wanted
    assert text[-2:] == ["  checks      1 passed", "  more with -v"]
    assert len(text) == LINES + len(wanted)


def test_what_an_inspection_asks_stands_above_the_columns(tmp_path):
    names = ",".join(f"channel {i}" for i in range(60))
    rows = "\n".join(",".join(f"{i * j % 7}.5" for j in range(60)) for i in range(40))
    (tmp_path / "wide.csv").write_text(f"{names}\n{rows}\n")
    printed = ran("inspect", tmp_path / "wide.csv").stdout.splitlines()
    assert len(printed) <= LINES
    assert printed[-1] == "  more with -v"
    requested = [i for i, line in enumerate(printed) if line.startswith("  ASK")]
    assert requested
    assert max(requested) < next(i for i, line in enumerate(printed) if line.startswith("  format"))
    # of several files each is reported
    printed = ran("inspect", *[tmp_path / "wide.csv"] * 3).stdout.splitlines()
    assert sum(line.startswith("wide.csv: ") for line in printed) == 3


def test_an_inspection_numbers_segments_where_there_are_several(tmp_path):
    text = "\n".join(f"{i / 100},{i % 9},{i % 7}" for i in range(400))
    head = "time [s],force [N],displacement [mm]\n"
    (tmp_path / "one.csv").write_text(f"{head}{text}\n")
    (tmp_path / "two.csv").write_text(f"{head}{text}\n\n{head}{text}\n")
    printed = ran("inspect", tmp_path / "one.csv").stdout
    assert "  sampling  400 rows, 100 Hz, even over 3.99 s\n" in printed
    assert "segment" not in printed
    printed = ran("inspect", tmp_path / "two.csv", "--verbose").stdout
    assert "even over 3.99 s in each segment\n" in printed
    named = [line.split() for line in printed.splitlines() if line.startswith("  segment")]
    assert [line[1:] for line in named] == [[f"{i}:", "400", "rows"] for i in (1, 2)]


def test_an_inspection_says_nothing_of_the_rows_of_a_file_that_has_none(tmp_path):
    (tmp_path / "door.toml").write_text('[door]\nmass = "25kg"\n')
    printed = ran("inspect", tmp_path / "door.toml").stdout.splitlines()
    assert printed[0].startswith("door.toml: door ")
    assert [line.split()[0] for line in printed[1:]] == ["for", "format"]


def test_failed_checks_outlast_the_numbers_on_a_short_screen():
    checks = (STOP, *(replace(LONG, name=f"long_{i}") for i in range(4)), NOTE)
    numbers = [f"row {i}" for i in range(80)]
    short = strip_styles(format_for_screen(Text(numbers), verdict(checks), checks, verbose=False))
    assert sum(line.startswith("  ! ") for line in short) == 4
    assert sum(line.endswith(" ...") for line in short) == 5  # and where the numbers are cut
    assert "row 0" in short
    assert "row 79" not in short
    assert not any("a_note" in line for line in short)
    assert "  checks      5 failed, 1 note" in short
    long = strip_styles(format_for_screen(Text(numbers), verdict(checks), checks, verbose=True))
    assert "row 79" in long
    assert long[-1] == "  - A note. a_note"
    text = " ".join(line.strip() for line in long)
    assert text.count(LONG.message.strip()) == 4
    single = strip_styles(format_for_screen(Text(["row"]), None, checks, verbose=False))
    assert sum(line.startswith("  ! ") for line in single) == 4  # of weight, without a verdict, too
    assert not any("a_note" in line for line in single)


def test_wrap_line_indents_under_the_text():
    label = "  left open   " + "word " * 40
    first, *others = wrap_line(label)
    assert len(first) <= COLUMNS
    assert all(line.startswith(" " * 14 + "word") for line in others)
    row = "  3  ch1 [N]   N   force   " + "because " * 20
    assert all(line.startswith(" " * 27 + "because") for line in wrap_line(row)[1:])
    for at, hang in ((COLUMNS // 2, COLUMNS // 2), (COLUMNS // 2 + 1, 2)):
        row = "  a".ljust(at) + "because " * 20
        assert all(line[:hang].isspace() and line[hang] == "b" for line in wrap_line(row)[1:])
    path = "wrote /" + "a" * 140
    assert any(path.split()[1] in line for line in wrap_line(path))


@pytest.mark.parametrize("name", ["a\x1b[31mred.csv", "a\x9b31mred.csv", "bell\x07.csv", "a\rb"])
def test_a_file_name_cannot_steer_the_terminal(name):
    printed = "".join(format_for_screen(Text([f"{name}: 2 arms"]), None, (), verbose=True))
    assert not any(ord(c) < 32 or 127 <= ord(c) < 160 for c in printed)
    result = ran("fit", name)
    assert not any(ord(c) < 32 or 127 <= ord(c) < 160 for c in result.output.replace("\n", ""))


def test_every_story_fits_a_screen():
    study = handmade.study()
    for text, result, checks in (
        (results.render_study(study), study.verdict, study.every_check),
        (results.render_fit(study.fit), study.fit.verdict, study.fit.checks),
        (results.render_fit(study.joint), study.joint.verdict, study.joint.checks),
    ):
        short = strip_styles(format_for_screen(text, result, checks, verbose=False))
        assert len(short) <= LINES
        assert max(map(len, short)) <= COLUMNS
        long = strip_styles(format_for_screen(text, result, checks, verbose=True))
        assert max(map(len, long)) <= COLUMNS
        assert any(line.split()[:1] == ["optimiser"] for line in long)
        assert not any(line.split()[:1] == ["optimiser"] for line in short)


def test_an_arm_that_is_not_identified_prints_no_interval():
    fit = handmade.two_arms()
    wide = fit.covariance.copy()
    for name in ("k_1", "ln_tau_1"):
        row = fit.estimate.parameters.index(name)
        wide[row, row] *= 1e8
    text = results.render_fit(replace_fields(fit, covariance=wide, profiles=()))
    rows = {line.split()[0]: line for line in text.lines if line.strip()}
    # an arm is a row, and what is not known of it stands in the place of its error
    assert rows["1"].count("not identified") == 3
    assert "not identified" not in rows["2"]
    assert "inf" not in rows["1"].split()
    # each with its interval, for who asks
    every = {line.split()[0]: line for line in text.details if line.strip()}
    assert "not identified" in every["tau_1"]
    assert " to " in every["k_2"]


def test_the_arms_of_a_study_stand_on_the_first_screen():
    """Of 24 lines of 80 columns: an arm is a row, beside what was predicted and measured."""
    study = handmade.study()
    lines = strip_styles(
        format_for_screen(results.render_study(study), study.verdict, study.checks, size=NARROW)
    )
    assert max(map(len, lines)) <= NARROW.columns
    assert len(lines) <= NARROW.lines
    solid = study.fit if study.joint is None else study.joint
    first = next(i for i, line in enumerate(lines) if line.startswith("  arm  "))
    rows = [line.split()[0] for line in lines[first + 1 :]]
    assert rows[: solid.model.arms] == [*map(str, range(1, solid.model.arms + 1))]


# -- colour ----------------------------------------------------------------------------------------


def invoke(*words, checks=(STOP,), **how):
    outcome = CommandResult(
        {}, Text(["text"]), checks, verdict=verdict(checks), next_command="dashpot x"
    )
    command = verb("story", "Tell a story.", result_options(plot=False))(lambda: outcome)
    return CliRunner().invoke(command, words, **how)


def test_colour_is_for_terminals_that_want_it(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    assert "\x1b" not in invoke().stdout  # a pipe
    assert "\x1b[31m" in invoke(color=True).stdout
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in invoke(color=True).stdout
    monkeypatch.setenv("NO_COLOR", "")  # an empty one says nothing (no-color.org)
    assert "\x1b" in invoke(color=True).stdout
    monkeypatch.setenv("TERM", "dumb")
    assert "\x1b" not in invoke(color=True).stdout


@pytest.mark.parametrize("use", ["use", "use with care", "do not use"])
def test_every_verdict_has_a_distinct_colour(use):
    (line,) = layout.format_verdict(Verdict(use, "because"))
    assert click.unstyle(line) == f"{use.capitalize()}: because"
    others = {layout.VERDICT_COLOURS[other] for other in layout.VERDICT_COLOURS if other != use}
    assert layout.VERDICT_COLOURS[use] not in others


# -- what comes last -------------------------------------------------------------------------------


def test_what_was_written_and_what_comes_next_stand_last(tmp_path):
    @verb("page", "Write a page.", result_options(plot=False))
    def command():
        _command_result.write_output(str(tmp_path / "page.html"), "x")
        return CommandResult({}, Text(["text"]), next_command="dashpot fit page.html")

    result = CliRunner().invoke(command, [])
    assert result.output.splitlines()[-2:] == [
        f"wrote {tmp_path / 'page.html'}", "next: dashpot fit page.html",
    ]  # fmt: skip
    assert result.stdout == "text\n"
    assert "next:" not in CliRunner().invoke(command, ["--json"]).output


def test_command_lists_written_files_when_it_fails(tmp_path):
    @verb("two", "Write two files.", result_options(plot=False))
    def command():
        _command_result.write_output(str(tmp_path / "first.csv"), "x")
        raise dp.DataError("no second")

    result = CliRunner().invoke(command, [])
    assert isinstance(result.exception, dp.DataError)
    assert f"wrote {tmp_path / 'first.csv'}" in result.stderr


def test_open_shows_the_page_or_says_why_not(tmp_path, monkeypatch):
    opened = []

    @verb("page", "Write a page.", click.Argument(["name"]), result_options(plot=False))
    def command(*, name):
        _command_result.write_output(str(tmp_path / "data.csv"), "")
        _command_result.write_output(str(tmp_path / name), "")
        return CommandResult({}, Text())

    monkeypatch.setattr(click, "launch", lambda path: opened.append(path) or 0)
    CliRunner().invoke(command, ["page.html", "--open"])
    CliRunner().invoke(command, ["page.html"])
    assert opened == [str(tmp_path / "page.html")]
    assert "nothing to open" in CliRunner().invoke(command, ["fit.json", "--open"]).stderr
    monkeypatch.setattr(click, "launch", lambda path: 1)
    assert "could not be opened" in CliRunner().invoke(command, ["a.png", "--open"]).stderr


def test_a_planned_test_is_rehearsed_as_it_was_planned():
    words = ["--frequency", "12Hz", "--depth", "4mm", "--hold", "5s", "--seal", "broad"]
    stderr = ran("plan", *words, "--noise", "2mN").stderr
    assert stderr.startswith(
        "next: dashpot simulate relaxation --depth 4mm --hold 5s --seal broad -o"
    )


def test_next_is_typed_as_the_shell_reads_it():
    assert (
        _command_files.format_command("fit", "my seal.csv", remark="again")
        == "dashpot fit 'my seal.csv'  # again"
    )


# -- progress --------------------------------------------------------------------------------------


class Terminal(io.StringIO):
    def isatty(self):
        return True


def draw_progress(monkeypatch, stream, *, patience):
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr(_terminal, "PROGRESS_DELAY", patience)
    monkeypatch.setattr(_terminal, "PROGRESS_PERIOD", 0.001)
    shown_once = stream.tell
    with _terminal.show_progress():
        send_progress("fitting")
        while patience == 0 and "fitting" not in stream.getvalue() and stream.isatty():
            shown_once()
    return stream.getvalue()


def test_progress_is_for_terminals_and_for_what_takes_long(monkeypatch):
    slow = draw_progress(monkeypatch, Terminal(), patience=0)
    assert "fitting ... " in slow
    assert slow.endswith("\r\x1b[K")  # wiped
    assert draw_progress(monkeypatch, Terminal(), patience=60) == ""
    assert draw_progress(monkeypatch, io.StringIO(), patience=0) == ""


def test_nobody_listens_by_default(capfd):
    send_progress("something")
    assert capfd.readouterr() == ("", "")


# -- what --strict heeds ---------------------------------------------------------------------------


@pytest.fixture(scope="module")
def fit_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("fit") / "fit.json"
    # a band that reaches the peak of 104 g on two of these seals, at about 12.7 Hz
    path.write_text(to_json(replace_fields(handmade.two_arms(), band=(0.004, 30.0), checks=())))
    return path


def strict(*words):
    return ran(*words, "--strict")


def write_narrow_band(path, band):
    fit = from_json(path.read_text())
    neighbour = path.with_name(f"narrow{band[1]:g}.json")
    neighbour.write_text(to_json(replace_fields(fit, band=band)))
    return neighbour


def test_strict_predict_heeds_extrapolation(fit_file):
    words = ("--mass", "104g", "--seals", 2)
    assert strict("predict", fit_file, *words).exit_code == 0
    outside = strict("predict", write_narrow_band(fit_file, (0.004, 0.32)), *words)
    assert outside.exit_code == 1
    assert outside.stdout.startswith("Use with care: the damping at 12.9 Hz is not known.")
    assert "prediction_in_valid_band" in outside.stdout


def test_strict_predict_heeds_the_fit_behind_it(fit_file):
    fit = from_json(fit_file.read_text())
    spoilt = fit_file.with_name("spoilt.json")
    spoilt.write_text(to_json(replace_fields(fit, checks=(STOP,))))
    result = strict("predict", spoilt, "--mass", "104g", "--seals", 2)
    assert result.exit_code == 1
    assert result.stdout.startswith("Do not use: a stop; do that.")


def test_strict_export_heeds_rows_that_the_test_does_not_inform(fit_file, tmp_path):
    words = ("--to", "nastran", "--unit-system", "mm-t-s", "--temperature", "23degC", "--length",
             "100mm", "-o", tmp_path / "deck.bdf")  # fmt: skip
    inside = strict("export", fit_file, *words, "--band", "1:30Hz")
    assert inside.exit_code == 0, inside.output
    deck = (tmp_path / "deck.bdf").read_text()
    assert deck.splitlines()[1].startswith("$ USE: ")
    outside = strict(
        "export", write_narrow_band(fit_file, (0.004, 0.32)), *words, "--band", "1:30Hz"
    )
    assert outside.exit_code == 1
    assert outside.stdout.startswith("Use with care: ")
    deck = (tmp_path / "deck.bdf").read_text()
    assert deck.splitlines()[1].startswith("$ USE WITH CARE: ")
    rows = int(deck.split(" of ")[1].split()[0])
    assert f"{rows} of {rows} rows, from 1 to 30 Hz, lie outside" in deck


def test_the_arms_of_a_spoilt_fit_say_so_in_their_deck(fit_file):
    spoilt = replace_fields(from_json(fit_file.read_text()), checks=(STOP,))
    specimen = dp.Specimen(temperature=296.15, length=0.1)
    deck = TARGETS["csv"](spoilt, units="mm-t-s", form="arms", specimen=specimen)
    assert deck.splitlines()[1] == "# DO NOT USE: A stop; do that."
    assert deck.verdict.use == "do not use"
    bare_solid = TARGETS["csv"](spoilt.model, units="mm-t-s", form="arms")
    assert bare_solid.verdict is None
    assert "USE" not in bare_solid.splitlines()[1]


def test_an_arm_that_only_a_lesser_depth_has_is_shown_there():
    """What is nothing at the deepest is no arm of the model, and an arm of the other depths."""
    solid = dp.GeneralizedMaxwell(200.0, (100.0,), (0.5,))
    depths = (
        DepthStiffness(8e-3, 200.0, 202.0, (100.0, 0.0), (1.0, 1.0)),
        DepthStiffness(4e-3, 150.0, 152.0, (80.0, 20.0), (1.0, 1.0)),
    )
    lines = "\n".join(results.render_fit(a_fit(solid, stiffness_by_depth=depths)).lines)
    assert "k_2" in lines
    assert "0.0200" in lines


def test_a_result_fits_the_terminal_that_shows_it(monkeypatch):
    """Of 80 columns and 24 lines; what goes to a file or a pipe is laid out as ever."""
    sentence = "The damping is not known, for the test is too slow to show it. " * 3
    text = Text([f"  row {i:<3} {'word ' * 17}".rstrip() for i in range(40)])
    check = Check("a_check", False, sentence)
    message = text, verdict([check]), [check]
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    small = os.terminal_size((80, 24))
    monkeypatch.setattr("shutil.get_terminal_size", lambda fallback=(80, 24): small)
    lines = format_for_screen(*message, size=_terminal.get_screen_size())
    assert max(map(len, lines)) <= 80
    assert len(lines) + _terminal.OTHER_LINES <= 24
    assert lines[-1].strip() == "more with -v"
    large = os.terminal_size((300, 90))
    monkeypatch.setattr("shutil.get_terminal_size", lambda fallback=(80, 24): large)
    assert _terminal.get_screen_size() == (COLUMNS, LINES)
    monkeypatch.setattr("sys.stdout.isatty", lambda: False, raising=False)
    assert _terminal.get_screen_size() == (COLUMNS, LINES)


def test_reason_of_several_hits_is_one_line_with_their_count():
    reasons = (("overload",), ("overload", "late"), ("overload",), ())
    hits = [Hit(str(i), 0.1, not own, own) for i, own in enumerate(reasons, start=1)]
    assert results._format_hits(hits)[-2:] == ["    3 hits, 1, 2, 3: overload", "    2: late"]


@pytest.mark.parametrize(("tests", "name"), [(("seal_8mm.csv",), "joint"), ((), "fit")])
def test_fit_of_a_hammer_names_a_joint_model_only_with_a_test(tmp_path, monkeypatch, tests, name):
    monkeypatch.chdir(tmp_path)
    for file in (*tests, "hammer.csv"):
        Path(file).write_text(FILES[file].write())
    text = ran("fit", *tests, "hammer.csv", "--mass", f"{MASS} kg", "--seals", "2").output
    assert f"-o {name}.json" in " ".join(text.split())
