"""What a lot prints and writes: counts, outliers, and the files lot.csv, lot.json and lot.xlsx."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import dashpot as dp
from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.number_format import ascii_only, format_count
from dashpot.base.progress import send_progress
from dashpot.base.serialisation import Key, Serialisable
from dashpot.cli._command_result import CommandResult, format_json, write_output
from dashpot.text_output.layout import Text

if TYPE_CHECKING:
    from dashpot.extensions.batch.batch_run import BatchJob
    from dashpot.extensions.batch.statistics.variance_components import Component
    from dashpot.extensions.batch.summary import Summary

MAX_NAMED = 5
"""Largest number of ignored files that are named."""


def write_lot(
    output: Path,
    summary: Summary,
    quantity: str = "",
    *,
    write: Callable[[str, str | bytes], None] = write_output,
) -> None:
    """Write table, workbook, document and page of a lot into its folder, beside the parts.

    `quantity` is that of the page; the main one of the lot if it is empty. `write`
    takes the name of a file and its content.
    """
    from dashpot.extensions.batch.page import (
        html,  # jinja and figures are not needed to list options
    )
    from dashpot.extensions.batch.workbook import workbook

    send_progress("writing table, workbook and page")
    write(f"{output}/lot.csv", summary.lot.csv())
    write(f"{output}/lot.xlsx", workbook(summary))
    document = LotOutput(str(output), summary, quantity or summary.lot.main)
    write(f"{output}/lot.json", format_json(document) + "\n")
    page = html(summary.lot, title=output.resolve().name, lot_summary=summary)
    write(f"{output}/lot.html", page)


@dataclass(frozen=True)
class LotOutput(Serialisable):
    """Output of a lot: its folder, and the statistics of a quantity.

    Attributes
    ----------
    folder : str
    summary : Summary or None
        None where no table was made.
    quantity : str
    """

    schema = "dashpot/batch@2"
    _keys = (
        "folder",
        "files",
        Key("computed", "summary.lot.computed", optional=True),
        Key("simulated", "summary.lot.simulated_count", optional=True),
        Key("outcomes", "summary.lot.outcomes", optional=True),
        Key("verdicts", "summary.lot.verdicts", optional=True),
        Key("agreements", "summary.lot.agreements", optional=True),
        Key("components", optional=True),
        Key("outliers", optional=True),
        Key("short_holds", "summary.lot.short_holds", optional=True),
        Key("summary", flatten=True),
    )

    folder: str
    summary: Summary | None = None
    quantity: str = ""

    @property
    def files(self) -> int:
        """Number of files."""
        return 0 if self.summary is None else self.summary.lot.table.height

    @property
    def components(self) -> tuple[Component, ...] | None:
        """The components of the relaxed stiffness, where lots or seals were named."""
        try:
            return None if self.summary is None else self.summary.lot.components()
        except DataError:
            return ()

    @property
    def outliers(self) -> tuple[Outlier, ...] | None:
        """Outliers."""
        if self.summary is None:
            return None
        outliers = self.summary.lot.outliers(self.quantity)
        return tuple(Outlier(file, value if isfinite(value) else None) for file, value in outliers)


class Outlier(NamedTuple):
    """Outlying test, and its distance from its lot."""

    file: str
    robust_deviations: float | None


def make_command_result(job: BatchJob, summary: Summary) -> CommandResult:
    """Return the printed result of a batch: the summary of its lot."""
    lot, quantity = summary.lot, job.quantity or summary.lot.main
    lot_output = LotOutput(str(job.output), summary, quantity)
    lines = [
        *(
            f"{light.label:<12}{_VERDICT_PREFIXES[light.mark]}{ascii_only(light.message)}"
            for light in summary.indicators
        ),
        *_format_lot_counts(lot),
        *summary.lines,
        *_format_outliers(lot, quantity),
    ]
    none_fitted = not lot.outcomes.get("fitted")
    reasons = _format_unfitted_files(lot)
    text = Text([*lines, *reasons]) if none_fitted else Text(lines, reasons)
    return CommandResult(
        lot_output, text, summary.checks, verdict=summary.verdict, nothing_done=none_fitted
    )


_VERDICT_PREFIXES = {"good": "", "note": "", "care": "! ", "bad": "!! "}
"""Prefix of a summary line by its mark, as of a failed check of that grade."""


def _format_lot_counts(lot: dp.Lot) -> list[str]:
    def format_counts(counts: dict[str, int]) -> str:
        return ", ".join(f"{count} {name}" for name, count in counts.items())

    files = lot.table.height
    lines = [
        f"files       {files}: {format_counts(lot.outcomes)}",
        f"computed    {lot.computed} now, {files - lot.computed} taken from an earlier run",
    ]
    verdicts = {"verdicts": lot.verdicts, "hammers": lot.agreements}
    if lot.simulated_count:
        lines.append(f"SIMULATED   {format_count(lot.simulated_count, 'file')}")
    if lot.ignored_files:
        shown_names = [Path(file).name for file in lot.ignored_files[:MAX_NAMED]]
        unlisted_count = len(lot.ignored_files) - len(shown_names)
        names = ", ".join(shown_names) + (f" and {unlisted_count} more" if unlisted_count else "")
        lines.append(f"ignored     {names}: no table of numbers")
    return [
        *lines,
        *(f"{name:<12}{format_counts(verdict)}" for name, verdict in verdicts.items() if verdict),
    ]


def _format_unfitted_files(lot: dp.Lot) -> list[str]:
    """Return every file that was not fitted, with its sentence."""
    columns = lot.table.select("file", "outcome", "reason").iter_rows()
    return [f"  {file}: {reason}" for file, outcome, reason in columns if outcome != "fitted"]


def _format_outliers(lot: dp.Lot, quantity: str) -> list[str]:
    """Return the outliers, and the holds that are shorter than those of the lot."""
    lines = [
        f"  outlier     {file}: {value:+.1f} robust deviations from its lot"
        for file, value in lot.outliers(quantity)
    ]
    return [*lines, *(f"  short hold  {file}" for file in lot.short_holds)]
