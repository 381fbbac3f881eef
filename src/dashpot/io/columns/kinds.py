"""What kind of record a table is: a test, a curve derived from one, or no test at all."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dashpot.io.columns import vocabulary
from dashpot.io.columns.roles import accelerations, score
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.table import Table

if TYPE_CHECKING:
    from dashpot.io.inspection import FileKind


def kind_of(table: Table, options: ReadOptions) -> tuple[FileKind, str]:
    """Return the kind of record and the reason, from the names and units alone."""
    peaks = cycle_peaks(table)
    if peaks:
        return "not-a-test", peaks

    def has(role: Role, least: float = 1.5) -> bool:
        if getattr(options, role, None):
            return True
        return any(score(column, role, options) >= least for column in table.columns)

    if has("frequency") and (
        (has("real") and has("imaginary")) or (has("magnitude") and has("phase"))
    ):
        return "frf", "it has frequency, and a complex value"
    if has("storage") and (has("loss") or has("loss_factor")) and has("frequency"):
        return "dma", "it has frequency, storage and loss"
    if any(
        "spectral density" in c.name.casefold() or "psd" in vocabulary.tokens(c.name)
        for c in table.columns
    ):
        return "not-a-test", "it is a power spectral density, which has no phase"
    timed = has("time") or options.rate is not None
    if timed and accelerations(table, (), options) and not has("displacement", 2.5):
        return "impact", "it has time and an acceleration"
    if timed and has("force", 1.0) and has("displacement", 1.0):
        return "relaxation", "it has time, displacement and force"
    if has("modulus") and timed:
        return "not-a-test", (
            "it is a relaxation modulus over time, a curve derived from a test, with no "
            "displacement and force; dashpot fit --modulus COLUMN fits the curve itself"
        )
    if has("viscosity") or (has("shear_rate") and not timed):
        return "not-a-test", "it is a flow curve of a rheometer (viscosity, shear rate)"
    if has("stress") and has("strain") and timed:
        return "not-a-test", (
            "it has stress and strain, not force and displacement; multiply by the area and the "
            "height of the specimen first"
        )
    return "unclear", "no set of columns that makes a test was recognised"


def cycle_peaks(table: Table) -> str | None:
    """Return why a table is one row per cycle (trends, peaks), or None."""
    extremes = [
        column.name
        for column in table.columns
        if column.name
        and vocabulary.has_word(column.name, vocabulary.EXTREMES)
        and set(vocabulary.matches(column.name)) & {"force", "displacement", "stress", "strain"}
    ]
    signals = [
        column.name
        for column in table.columns
        if column.name not in extremes
        and not vocabulary.has_word(column.name, vocabulary.DERIVED)
        and vocabulary.matches(column.name).get("force", 0.0) >= 2.5
    ]
    counted = any("cycle" in vocabulary.matches(c.name) for c in table.columns if c.name)
    if (len(extremes) >= 2 and not signals) or (counted and len(extremes) >= 2):
        listed = ", ".join(f"'{name}'" for name in extremes[:3])
        return (
            f"it is a summary with one row per cycle ({listed}), not the recorded signals; "
            "export the raw time, displacement and force instead"
        )
    return None
