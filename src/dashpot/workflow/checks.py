"""What the whole story shows, and what a project's history proves, as criteria with a sentence."""

from __future__ import annotations

import math
from collections.abc import Sequence

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.number_format import seals as numbered
from dashpot.base.sentences import sentence
from dashpot.datamodel.frf import Mode

LISTED = 20
"""Files that a sentence names before it counts the rest."""


@criterion(source="the paper's eq. (5) needs one ideal ramp", grade="note")
def hold_fit_possible(obstacle: str) -> Finding:
    """The paper's eq. (5) can be fitted to the record."""
    return Finding(
        f"The fit of the hold alone (eq. 5) is not possible. {sentence(obstacle)}",
        remedy="Use the fit of ramp and hold.",
        faulted=True,
    )


@criterion("distance from the band, a factor", "<=", 1.0, "the band of the fit")
def prediction_informed(peak: float, band: tuple[float, float]) -> Finding:
    """The predicted peak lies where a test informs the solid."""
    low, high = band
    factor = max(peak / high, low / peak) if high > 0 else math.inf
    side = "higher" if peak > high else "lower"
    if not high > 0:
        return Finding(
            f"The predicted peak ({peak:.4g} Hz) lies in no valid band; the fit has none",
            factor,
            remedy="Add a hammer test.",
        )
    return Finding(
        f"The predicted peak ({peak:.4g} Hz) lies in the valid band of the test",
        factor,
        instead=f"The damping at {peak:.3g} Hz is not known. The test covers {low:.2g} to "
        f"{high:.2g} Hz; the peak lies {factor:.3g} times {side}",
        remedy="Measure it with a hammer.",
    )


@criterion("files that were fitted", "<=", 0, "by definition", grade="note")
def fit_is_tested(fitted: int) -> Finding:
    """The measurement is one that the fit was not made from."""
    return Finding(
        "The fit was not made from this measurement",
        fitted,
        instead=f"The fit was made from this measurement ({fitted} files)",
        because="Its agreement tests nothing",
        remedy="Compare it with other hits, or leave a hit out.",
    )


@criterion(source="the stiffness of one seal is that of all over their number", grade="note")
def seals_counted(seals: float) -> Finding:
    """The number of seals under the block was given."""
    return Finding(
        f"The number of seals is not given, so {numbered(seals)} is assumed",
        because="The stiffness of one seal goes with it",
        remedy=Remedy("Count the seals under the block.", "seals"),
        faulted=True,
    )


@criterion("distance from the band, a factor", "<=", 1.0, "the band of the fit", grade="note")
def base_band_informed(
    requested: tuple[float, float], peak: float, band: tuple[float, float]
) -> Finding:
    """All that is asked of a base that moves lies where a test informs the solid.

    Below a quarter of the `peak`, Hz, the mass follows its base whatever carries it.
    """
    low, high = max(requested[0], min(peak / 4, requested[1])), requested[1]
    factor = max(high / band[1], band[0] / low) if band[1] > 0 else math.inf
    says = f"From {low:.3g} to {high:.3g} Hz the transmissibility"
    return Finding(
        f"{says} depends on what the test covers",
        factor,
        instead=f"{says} is extrapolated by a factor of {factor:.3g}. The test covers "
        f"{band[0]:.2g} to {band[1]:.2g} Hz",
        remedy=Remedy("Narrow the band, or measure on a shaker.", "band"),
    )


@criterion("ratio of damping ratios", "x/", 1.1, "10 % of damping; and 1 % of frequency")
def families_predict_alike(mode: Mode | None, other: Mode | None) -> Finding:
    """Another family of solids that explains the test predicts the same resonance.

    `mode` and `other` are the first modes of the mass on either solid.
    """
    if mode is None or other is None or not mode.damping_ratio > 0:
        return Finding("No other family of models that explains the test predicts a resonance")
    ratio, shift = other.damping_ratio / mode.damping_ratio, other.frequency / mode.frequency - 1
    return Finding(
        f"Another model that explains the test resonates at {other.frequency:.4g} Hz with a "
        f"damping ratio of {100 * other.damping_ratio:.3g} %. This one does at "
        f"{mode.frequency:.4g} Hz with {100 * mode.damping_ratio:.3g} %",
        ratio,
        "The test cannot separate the two",
        "Add a hammer test or a colder test, or ramp faster.",
        faulted=abs(shift) > 0.01,
    )


@criterion("lines of history", ">=", 1, "by definition", grade="stop")
def history_present(lines: int) -> Finding:
    """There is a history, without which nothing is proven."""
    return Finding(
        f"The history has {lines} lines",
        lines,
        instead=f"The history has {lines} lines: it is empty or missing, so nothing is proven",
        remedy="Restore history.jsonl from a copy.",
    )


@criterion(source="a note: what was cut short did not happen", grade="note")
def history_complete(lines: int, *, torn: bool) -> Finding:
    """The history ends with a whole line."""
    return Finding(
        f"The history ends with line {lines}, whole",
        instead=f"A line after line {lines} of the history was cut short. That operation did not "
        "happen",
        remedy="Repeat that operation.",
        faulted=torn,
    )


@criterion("lines that differ", "<=", 0, "the count and the hash in history.head", grade="stop")
def history_whole(lines: int, written: int, *, shortened: bool, headed: bool) -> Finding:
    """No line was cut off the end of the history, and its head says so."""
    if not lines and not written:
        return Finding("The history has no line that its head could be of")
    lost = "is missing" if not written else f"is older: it is of line {written} of {lines}"
    instead = f"history.head {lost}, so lines cut off the end would not be seen"
    if shortened:
        instead = f"The history has {lines} of {written} lines"
        if lines >= written:
            instead = f"Line {written} of the history is another than history.head was written for"
    return Finding(
        "No line is missing at the end of the history",
        max(written - lines, 1) if shortened else int(not headed),
        instead=instead,
        remedy="Restore history.jsonl from a copy."
        if shortened
        else "Restore history.head from a copy, and compare the last hash with one that you noted.",
    )


@criterion(source="the hash that was noted when that line was the last", grade="stop")
def history_expected(expected: str, place: int | None, lines: int) -> Finding:
    """The history holds the line whose hash was noted."""
    since = "" if place is None else f"; {lines - 1 - place} lines were added since"
    return Finding(
        f"The history has the line {expected[:16]}... that is expected{since}",
        instead=f"The history has no line {expected[:16]}... It was shortened or rewritten, or the "
        "hash is of another project",
        remedy=Remedy("Check the hash, or restore history.jsonl from a copy.", "expect"),
        faulted=place is None,
    )


@criterion(source="SHA-256 of the line, and of the line before it", grade="stop")
def history_unchanged(number: int, *, whole: bool) -> Finding:
    """Every line of the history is as it was written."""
    line = f"Line {number} of history.jsonl is "
    return Finding(
        line + "as it was written",
        instead=line + "not as it was written, or out of place",
        remedy="Restore history.jsonl from a copy.",
        faulted=not whole,
    )


@criterion(source="by definition", grade="stop")
def file_present(file: str, number: int) -> Finding:
    """Every recorded file is there."""
    return Finding(
        f"{file} (line {number}) is missing", remedy="Restore it from a copy.", faulted=True
    )


@criterion(source="by definition", grade="stop")
def inputs_listed(files: Sequence[str], number: int) -> Finding:
    """Every file that a job reads is recorded with its hash."""
    return Finding(
        f"Line {number} reads {', '.join(files)}, of which it records no hash",
        remedy="Make that result again.",
        faulted=True,
    )


@criterion("files", "<=", 0, "a note: a run that was killed leaves some", grade="note")
def files_listed(added: Sequence[str]) -> Finding:
    """Every file in the project's folder is in its history."""
    more = "" if len(added) <= LISTED else f" and {len(added) - LISTED} more"
    return Finding(
        "Every file is in the history",
        len(added),
        instead=f"The history does not list {', '.join(added[:LISTED])}{more}",
        remedy="Move them out of the project, if they do not belong there.",
    )


@criterion("files", "<=", 0, "a note: they hold nothing that was finished", grade="note")
def nothing_half_written(remaining: Sequence[str]) -> Finding:
    """Runs that were killed left no half-written file."""
    more = "" if len(remaining) <= LISTED else f" and {len(remaining) - LISTED} more"
    return Finding(
        "Runs that were killed left no half-written file",
        len(remaining),
        instead=f"Runs that were killed left {', '.join(remaining[:LISTED])}{more}",
        remedy=Remedy("Clear them.", "overwrite"),
    )


@criterion(source="SHA-256 of its bytes", grade="stop")
def file_unchanged(file: str, number: int, *, same: bool) -> Finding:
    """Every recorded file is as it was."""
    return Finding(
        f"{file} (line {number}) is as it was",
        instead=f"{file} (line {number}) has changed since it was recorded",
        remedy="Restore it from a copy.",
        faulted=not same,
    )


@criterion("relative difference", "<=", 1e-7, "our choice: below what is printed", grade="stop")
def result_recomputed(worst: float, where: str, number: int) -> Finding:
    """Every result follows again from its raw files."""
    result = f"The result of line {number}, computed again from its raw files, "
    return Finding(
        f"{result}is the same (largest relative difference {worst:.2g})",
        worst,
        instead=f"{result}differs: {where}",
        remedy="Make the result again, and compare the versions.",
    )


@criterion("parts that differ", "<=", 0, "by definition", grade="stop")
def page_redrawn(number: int, *, same: bool, alike: bool) -> Finding:
    """Every report says and shows what its result does."""
    page = f"The report of line {number}"
    if not alike:
        return Finding(f"{page} was made by other versions, so its words are not judged")
    return Finding(
        f"{page}, drawn again, is the same",
        0 if same else 1,
        instead=f"{page} does not show what its result shows: it was changed",
        remedy="Make the report again.",
    )
