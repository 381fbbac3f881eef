"""Layout of text: lines, tables of cells, and results with a verdict."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from dashpot.base.number_format import ascii_only
from dashpot.base.plain_text import decapitalise_sentence, escape_terminal_text, sentences

if TYPE_CHECKING:
    from dashpot.base.checks import Check, Verdict
    from dashpot.base.reported_values import ReportedValue


# Lines, tables of cells, tables of named values.


class Text(NamedTuple):
    """Text of a command: the part always printed, and the part printed on request.

    Attributes
    ----------
    lines
        Shortened to the length of a screen.
    details
        For ``-v`` alone.
    requested_lines
        Lines that an option requested: never cut.
    """

    lines: Sequence[str] = ()
    details: Sequence[str] = ()
    requested_lines: Sequence[str] = ()


def table(rows: Sequence[Sequence[str]], *, align_left: bool = False) -> list[str]:
    """Return rows of cells as lines of aligned columns: the first, or all, to the left."""
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    alignments = ["-" if align_left or i == 0 else "" for i in range(len(widths))]
    row_format = "".join(
        f"  %{alignment}{width}s" for alignment, width in zip(alignments, widths, strict=True)
    )
    return [(row_format % tuple(row)).rstrip() for row in rows]


def format_values(reported_values: Sequence[ReportedValue]) -> list[str]:
    """Return named numbers as a table: value, error, interval and unit, if any has one."""
    heading = ("", "value", "± SE", "95 % interval", "unit")
    rows = [value.cells.ascii for value in reported_values]
    filled_columns = [i for i in range(len(heading)) if any(row[i] for row in rows)]
    return table([[row[i] for i in filled_columns] for row in (heading, *rows)])


# Result: its verdict, its values, and the failed checks.


Style: TypeAlias = Callable[..., str]
"""Function that makes a word bold, dim or coloured, as ``click.style`` does."""


def apply_no_style(word: str, **_: Any) -> str:
    """Return a word as it is."""
    return word


COLUMNS = 100
"""A line is not longer, unless one word is, such as a path."""

LINES = 36
"""Lines of a result unless all is requested; 40 with files written and the next step."""


class ScreenSize(NamedTuple):
    """Size of a screen: most characters per line, and most lines."""

    columns: int
    lines: int


DEFAULT_SIZE = ScreenSize(COLUMNS, LINES)
"""Size without a terminal, and the largest size of one."""


CHECK_LINES = 3
"""Lines of one check on a screen."""

MARKS = {"stop": ("!!", "red"), "limit": ("!", "yellow"), "note": ("-", None)}
"""Mark and colour of a failed check, by its grade."""

VERDICT_COLOURS = {
    "use": "green",
    "use with care": "yellow",
    "do not use": "red",
    "no test": "blue",
}
"""The colours of a verdict."""


def format_for_screen(
    text: Text,
    verdict: Verdict | None,
    checks: Sequence[Check],
    *,
    verbose: bool = False,
    style: Style = apply_no_style,
    size: ScreenSize = DEFAULT_SIZE,
) -> list[str]:
    """Return a result line by line: its verdict, its numbers, and the checks that failed.

    Those are all that failed if all is requested; else those that made the verdict or, without one,
    those of weight. If that is longer than a screen, numbers are omitted, except requested ones.
    `style` colours; `size` is that of the screen.
    """
    columns, lines = size
    verdict_lines = [] if verdict is None else format_verdict(verdict, style, columns)
    # of a table of thousands no more is put into lines than can be shown, and one to be cut
    shown_lines = text.lines if verbose else text.lines[: lines + 1]
    value_lines = _wrap_paragraphs(shown_lines, columns)
    requested_lines = _wrap_paragraphs(text.requested_lines, columns)
    count_lines = [f"  checks      {_format_check_counts(checks)}"] if checks else []
    failed = [
        _format_check(check, verdict, style, columns)
        for check in _select_failed_checks(verdict, checks, show_all=verbose)
    ]
    if verbose:
        return [
            *verdict_lines,
            *value_lines,
            *requested_lines,
            *_wrap_paragraphs(text.details, columns),
            *count_lines,
            *(shown_lines for names in failed for shown_lines in names),
        ]
    last_lines = count_lines + [
        shown_lines for names in failed for shown_lines in _shorten_check_lines(names, columns)
    ]
    remaining = max(lines - 1 - len(verdict_lines) - len(last_lines), 0)
    if len(value_lines) > remaining:
        value_lines, line_count = [*value_lines[: max(remaining - 1, 0)], "  ..."], len(value_lines)
    else:
        line_count = len(value_lines)
    verdict_lines += value_lines
    kept_lines = [*verdict_lines, *last_lines][: lines - 1]
    is_cut = len(kept_lines) < len(verdict_lines) - len(value_lines) + line_count + sum(
        map(len, failed)
    ) + len(count_lines)
    kept_lines[len(verdict_lines) : len(verdict_lines)] = requested_lines
    return [*kept_lines, "  more with -v"] if is_cut or text.details else kept_lines


def _wrap_paragraphs(paragraphs: Sequence[str], columns: int) -> list[str]:
    texts = (line for text in paragraphs for line in text.split("\n"))
    return [part for line in texts for part in wrap_line(line, columns=columns)]


def format_verdict(
    verdict: Verdict, style: Style = apply_no_style, columns: int = COLUMNS
) -> list[str]:
    """Return a verdict and why, as the first lines of a result."""
    mark_text, _, message = str(verdict).partition(": ")
    return _format_marked_sentence(
        f"{mark_text}:",
        message,
        VERDICT_COLOURS[verdict.use],
        style,
        hanging_indent=2,
        columns=columns,
    )


def wrap_line(line: str, *, hanging_indent: int | None = None, columns: int = COLUMNS) -> list[str]:
    """Return a line as lines of the terminal's width, the later ones under the text of the first.

    In a row of columns that is the last one that begins in the left half.
    """
    line = escape_terminal_text(line)
    if len(line) <= columns:
        return [line]
    if hanging_indent is None:
        starts = [match.end() for match in re.finditer(r"(?:^|\S) {2,}(?=\S)", line)]
        hanging_indent = max((start for start in starts if start <= columns // 2), default=2)
    return textwrap.wrap(
        line,
        columns,
        subsequent_indent=" " * hanging_indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _format_marked_sentence(
    mark_text: str,
    sentence: str,
    colour: str | None,
    style: Style,
    *,
    hanging_indent: int,
    columns: int,
) -> list[str]:
    """Return a sentence in lines, its mark in colour."""
    first, *other_lines = wrap_line(
        ascii_only(f"{mark_text} {sentence}"), hanging_indent=hanging_indent, columns=columns
    )
    return [style(mark_text, fg=colour, bold=True) + first[len(mark_text) :], *other_lines]


def _select_failed_checks(
    verdict: Verdict | None, checks: Sequence[Check], *, show_all: bool
) -> Sequence[Check]:
    """Return the failed checks to list, the gravest first."""
    if verdict is not None and not show_all:
        return verdict.failed_checks
    grades = ("stop", "limit", "note") if show_all else ("stop", "limit")
    return [check for grade in grades for check in checks if check.failed and check.grade == grade]


def _format_check(check: Check, verdict: Verdict | None, style: Style, columns: int) -> list[str]:
    mark_text, colour = MARKS[check.grade]
    message = check.message_with_option
    verdict_sentences = (
        set()
        if verdict is None
        else {decapitalise_sentence(sentence) for sentence in sentences(verdict.message)}
    )
    new = [
        sentence
        for sentence in sentences(check.message_with_remedy)
        if decapitalise_sentence(sentence) not in verdict_sentences
    ]
    if decapitalise_sentence(sentences(check.message_with_remedy)[0]) in verdict_sentences:
        message = message.replace(check.message_with_remedy, " ".join(["(see line 1)", *new]))
    first, *other_lines = _format_marked_sentence(
        f"  {mark_text}",
        f"{message} {check.name}",
        colour,
        style,
        hanging_indent=5,
        columns=columns,
    )
    lines = [first, *other_lines]
    # the name is for searching, not for reading
    lines[-1] = f"{lines[-1][: -len(check.name)]}{style(check.name, dim=True)}"
    return lines


def _shorten_check_lines(check: list[str], columns: int) -> list[str]:
    """Return a check's first lines, and a sign where there are more."""
    kept_lines = check[:CHECK_LINES]
    return (
        kept_lines
        if len(check) == len(kept_lines)
        else [*kept_lines[:-1], f"{kept_lines[-1][: columns - 4]} ..."]
    )


def _format_check_counts(checks: Sequence[Check]) -> str:
    """Return the numbers of checks that passed, failed, are notes, or do not apply."""
    each_once = dict.fromkeys(checks)  # several tests may give one and the same answer
    states = [
        "note" if check.failed and check.grade == "note" else check.passed for check in each_once
    ]
    words = ((True, "passed"), (False, "failed"), ("note", "note"), (None, "not applicable"))
    group = [(states.count(state), word) for state, word in words]
    return ", ".join(
        f"{count} {word}{'s' * (word == 'note' and count > 1)}" for count, word in group if count
    )
