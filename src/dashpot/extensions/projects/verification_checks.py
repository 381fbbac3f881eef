"""Criteria on the history and files of a project."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dashpot.base.checks import Finding, Remedy, criterion

SAME_NUMBER_TOLERANCE = 1e-6
"""Relative difference up to which a number that was computed again is the same."""
MAX_LISTED = 20
"""Largest number of files named in a sentence."""


@criterion("lines of history", ">=", 1, "by definition", grade="stop")
def history_present(lines: int) -> Finding:
    """The project has a history; without it nothing can be verified."""
    return Finding(
        f"The history has {lines} lines",
        lines,
        failure=f"The history has {lines} lines: it is empty or missing, so nothing is proven",
        remedy="Restore history.jsonl from a copy.",
    )


@criterion(source="a note: an interrupted step is not counted", grade="note")
def history_complete(lines: int, *, has_incomplete_line: bool) -> Finding:
    """The last line of the history is complete."""
    return Finding(
        f"The history ends with line {lines}, whole",
        failure=f"A line after line {lines} of the history was cut short. That operation did not "
        "happen",
        remedy="Repeat that operation.",
        always_fails=has_incomplete_line,
    )


@criterion("lines that differ", "<=", 0, "the count and the hash in history.head", grade="stop")
def history_whole(
    lines: int, written_lines: int, *, is_truncated: bool, has_matching_head: bool
) -> Finding:
    """No line is missing from the end of the history."""
    if not lines and not written_lines:
        return Finding("The history has no line that its head could be of")
    state_text = (
        "is missing" if not written_lines else f"is older: it is of line {written_lines} of {lines}"
    )
    reason = f"history.head {state_text}, so lines cut off the end would not be seen"
    if is_truncated:
        reason = f"The history has {lines} of {written_lines} lines"
        if lines >= written_lines:
            reason = (
                f"Line {written_lines} of the history is another than history.head was written for"
            )
    return Finding(
        "No line is missing at the end of the history",
        max(written_lines - lines, 1) if is_truncated else int(not has_matching_head),
        failure=reason,
        remedy="Restore history.jsonl from a copy."
        if is_truncated
        else "Restore history.head from a copy, and compare the last hash with one that you noted.",
    )


@criterion(source="the hash that was noted when that line was the last", grade="stop")
def history_expected(expected: str, line_index: int | None, lines: int) -> Finding:
    """The history contains the line whose hash was noted."""
    added_text = "" if line_index is None else f"; {lines - 1 - line_index} lines were added since"
    return Finding(
        f"The history has the line {expected[:16]}... that is expected{added_text}",
        failure=f"The history has no line {expected[:16]}... It was shortened or rewritten, or the "
        "hash is of another project",
        remedy=Remedy("Check the hash, or restore history.jsonl from a copy.", "expect"),
        always_fails=line_index is None,
    )


@criterion(source="SHA-256 of the line, and of the line before it", grade="stop")
def history_unchanged(number: int, *, is_unchanged: bool) -> Finding:
    """No line of the history was changed."""
    line = f"Line {number} of history.jsonl is "
    return Finding(
        line + "as it was written",
        failure=line + "not as it was written, or out of place",
        remedy="Restore history.jsonl from a copy.",
        always_fails=not is_unchanged,
    )


@criterion(source="by definition", grade="stop")
def file_present(file: str, number: int) -> Finding:
    """Every recorded file exists."""
    return Finding(
        f"{file} (line {number}) is missing", remedy="Restore it from a copy.", always_fails=True
    )


@criterion(source="by definition", grade="stop")
def inputs_listed(files: Sequence[str], number: int) -> Finding:
    """Every file that a job reads is recorded with its hash."""
    return Finding(
        f"Line {number} reads {', '.join(files)}, of which it records no hash",
        remedy="Make that result again.",
        always_fails=True,
    )


@criterion("files", "<=", 0, "a note: a run that was killed leaves some", grade="note")
def files_listed(unlisted_files: Sequence[str]) -> Finding:
    """Every file in the project's folder is in its history."""
    more_text = (
        "" if len(unlisted_files) <= MAX_LISTED else f" and {len(unlisted_files) - MAX_LISTED} more"
    )
    return Finding(
        "Every file is in the history",
        len(unlisted_files),
        failure=f"The history does not list {', '.join(unlisted_files[:MAX_LISTED])}{more_text}",
        remedy="Move them out of the project, if they do not belong there.",
    )


@criterion("files", "<=", 0, "a note: they hold nothing that was finished", grade="note")
def nothing_half_written(partial_files: Sequence[str]) -> Finding:
    """No incomplete file of an interrupted run is left."""
    more_text = (
        "" if len(partial_files) <= MAX_LISTED else f" and {len(partial_files) - MAX_LISTED} more"
    )
    return Finding(
        "Runs that were killed left no half-written file",
        len(partial_files),
        failure=f"Runs that were killed left {', '.join(partial_files[:MAX_LISTED])}{more_text}",
        remedy=Remedy("Clear them.", "overwrite"),
    )


@criterion(source="SHA-256 of its bytes", grade="stop")
def file_unchanged(file: str, number: int, *, is_same: bool) -> Finding:
    """No recorded file was changed."""
    return Finding(
        f"{file} (line {number}) is as it was",
        failure=f"{file} (line {number}) has changed since it was recorded",
        remedy="Restore it from a copy.",
        always_fails=not is_same,
    )


@criterion(
    "relative difference",
    "<=",
    SAME_NUMBER_TOLERANCE,
    "our choice: below what is printed",
    grade="stop",
)
def result_recomputed(largest_difference: float, location: str, number: int) -> Finding:
    """Every result can be recomputed from its raw files."""
    result = f"The result of line {number}, computed again from its raw files, "
    return Finding(
        f"{result}is the same (largest relative difference {largest_difference:.2g})",
        largest_difference,
        failure=f"{result}differs: {location}",
        remedy="Make the result again, and compare the versions.",
    )


@criterion(
    "relative difference", "<=", SAME_NUMBER_TOLERANCE, "as of `result_recomputed`", grade="limit"
)
def earlier_result_reproduced(
    largest_difference: float, location: str, number: int, version: str
) -> Finding:
    """The model of an earlier version can be recomputed from the raw files of its result."""
    result = (
        f"The result of line {number}, made by dashpot {version} and computed again by this "
        "version,"
    )
    return Finding(
        f"{result} has the same model (largest relative difference {largest_difference:.2g})",
        largest_difference,
        failure=f"{result} has another number: {location}. Either this version computes it "
        "otherwise, or result and history were changed together",
        remedy="Make the result again, and use the new one.",
    )


@criterion("kinds of numbers", "<=", 0, "our choice: errors and limits alone", grade="note")
def uncertainty_unrevised(reasons: Mapping[str, str], number: int, version: str) -> Finding:
    """Errors, limits and band of an earlier result agree with those of this version."""
    changes = "; ".join(dict.fromkeys("; ".join(reasons.values()).split("; ")))
    return Finding(
        f"Errors and limits of line {number} are the same as by dashpot {version}",
        len(reasons),
        failure=f"Errors and limits of line {number} are other than by dashpot {version} "
        f"({', '.join(reasons)}): {changes}",
        remedy="Make the result again, and quote its errors.",
    )


@criterion("parts that differ", "<=", 0, "by definition", grade="stop")
def page_redrawn(number: int, *, is_same_page: bool, is_same: bool) -> Finding:
    """Every report agrees with its result."""
    page = f"The report of line {number}"
    if not is_same:
        return Finding(f"{page} was made by other versions, so its words are not checked")
    return Finding(
        f"{page}, drawn again, is the same",
        0 if is_same_page else 1,
        failure=f"{page} does not show what its result shows: it was changed",
        remedy="Make the report again.",
    )
