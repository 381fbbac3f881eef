"""What the commands of many tests share: their options, the files they write, what they print."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import click

import dashpot as dp
from dashpot.base.documents import Documented
from dashpot.base.errors import DataError
from dashpot.base.numbers import counted
from dashpot.base.options import offered
from dashpot.base.progress import doing
from dashpot.cli import _options as options
from dashpot.cli._options import over_profile
from dashpot.cli._shell import File, Folder, Outcome, write
from dashpot.cli._terminal import Text
from dashpot.io.options import OF_HAMMER, OF_HAMMER_ALONE, ReadOptions
from dashpot.lots.choices import BatchChoices

if TYPE_CHECKING:
    from dashpot.lots.batches import BatchJob
    from dashpot.lots.statistics.scatter import Component
    from dashpot.lots.summary import Summary

T = TypeVar("T")

_DECLARED: tuple[Callable[..., Any], ...] = (
    click.option("-o", "--output", type=Folder(), metavar="LOT", help="Folder to fill."),
    options.of(BatchChoices),
    click.option(
        "--by",
        metavar="REGEX",
        help=r"Lot, seal, repeat from the path: 'lot(\w+)_seal(\d+)_rep(\d+)'.",
    ),
    click.option(
        "--manifest",
        type=File(),
        metavar="FILE",
        help="CSV or TOML: file, lot, seal, repeat, operator, temperature, mass, hammer, "
        "hammer_temperature.",
    ),
    click.option(
        "--pair",
        metavar="PATTERN",
        help="Hammer files of a test: '{stem}_hammer*.csv', '{seal}_*.uff'.",
    ),
    click.option(
        "--impact-profile", type=File(), metavar="FILE", help="Saved answers for the hammer files."
    ),
    click.option(
        "--quantity",
        "quantities",
        metavar="NAME",
        multiple=True,
        help="What the page is of [default: k_end; of load deflection cld_per_100mm]: k_0, ...",
    ),
    click.option("--limits", type=File(), metavar="FILE", help="TOML of acceptance limits."),
    click.option("--jobs", type=click.IntRange(1), help="Processes [default: one per processor]."),
    click.option(
        "--scheduler",
        metavar="ADDRESS",
        help="A dask.distributed cluster instead: tcp://host:8786.",
    ),
    options.reading,
)


def of_many(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command of many tests its options; it receives `job`, which asks for its paths."""

    @functools.wraps(function)
    def command(
        *,
        output: str | None,
        by: str | None,
        manifest: str | None,
        pair: str | None,
        jobs: int | None,
        scheduler: str | None,
        impact_profile: str | None,
        quantities: tuple[str, ...],
        limits: str | None,
        options: ReadOptions,
        **given: Any,
    ) -> T:
        own = {one.name: given.pop(one.name) for one in offered(BatchChoices)}

        def job(*paths: str) -> BatchJob:
            from dashpot.lots.batches import BatchJob  # polars and all are not needed for --help
            from dashpot.lots.columns import number_columns
            from dashpot.lots.limits import read_limits
            from dashpot.lots.quantities import quantity

            if output is None:
                raise click.UsageError("say which folder to fill: -o LOT")
            # columns named for one kind of file need not exist in the other's; units do no harm
            of_impact = over_profile(options.only(("units", *OF_HAMMER)), impact_profile)
            bench = options.without(OF_HAMMER_ALONE)
            choices = BatchChoices(reading=bench, reading_impact=of_impact, **own)
            columns = number_columns(choices)
            main = quantity(quantities[-1], columns).name if quantities else ""
            asked = () if limits is None else read_limits(limits, columns)
            return BatchJob(
                paths, Path(output), choices, by, manifest, pair, jobs, scheduler, main, asked
            )

        return function(job=job, quantities=quantities, **given)

    for declare in reversed(_DECLARED):
        command = declare(command)
    return command


def summarised(job: BatchJob, lot: dp.Lot) -> Summary:
    """Return what a lot says of what was asked for."""
    from dashpot.lots.summary import summary

    return summary(lot, quantity=job.quantity or lot.main, limits=job.limits)


def write_lot(job: BatchJob, found: Summary) -> None:
    """Write table, workbook and page beside the parts."""
    from dashpot.lots.page import html  # jinja and figures are not needed to list options
    from dashpot.lots.workbook import workbook

    doing("writing table, workbook and page")
    write(f"{job.output}/lot.csv", found.lot.csv())
    write(f"{job.output}/lot.xlsx", workbook(found))
    write(f"{job.output}/lot.html", html(found.lot, title=job.output.resolve().name, found=found))


@dataclass(frozen=True)
class Filled(Documented):
    """The folder of a lot, and what the lot says of a quantity.

    Attributes
    ----------
    folder : str
    found : Summary or None
        None where no table was made.
    quantity : str
    """

    schema = "dashpot/batch@1"
    keys = (
        "folder", "files", "found.lot.computed?", "found.lot.simulated?", "found.lot.outcomes?",
        "found.lot.verdicts?", "found.lot.agreements?", "components?", "outliers?",
        "found.lot.short_holds?", "*found",
    )  # fmt: skip

    folder: str
    found: Summary | None = None
    quantity: str = ""

    @property
    def files(self) -> int:
        """How many."""
        return 0 if self.found is None else self.found.lot.table.height

    @property
    def components(self) -> tuple[Component, ...] | None:
        """The components of the relaxed stiffness, where lots or seals were named."""
        try:
            return None if self.found is None else self.found.lot.components()
        except DataError:
            return ()

    @property
    def outliers(self) -> tuple[Outlier, ...] | None:
        """The tests that stand out."""
        if self.found is None:
            return None
        away = self.found.lot.outliers(self.quantity)
        return tuple(Outlier(file, one if isfinite(one) else None) for file, one in away)


class Outlier(NamedTuple):
    """A test, and by how much it stands out of its lot."""

    file: str
    robust_deviations: float | None


def outcome(job: BatchJob, found: Summary) -> Outcome:
    """Return what is printed of a lot."""
    lot, quantity = found.lot, job.quantity or found.lot.main
    filled = Filled(str(job.output), found, quantity)
    lines = [
        *_told(lot),
        *found.lines,
        *_shares(filled.components or ()),
        *_out(lot, quantity),
    ]
    return Outcome(filled, Text(lines, _others(lot)), found.checks)


def _told(lot: dp.Lot) -> list[str]:
    def tallied(counts: dict[str, int]) -> str:
        return ", ".join(f"{count} {name}" for name, count in counts.items())

    files = lot.table.height
    lines = [
        f"files       {files}: {tallied(lot.outcomes)}",
        f"computed    {lot.computed} now, {files - lot.computed} were there",
    ]
    judged = {"verdicts": lot.verdicts, "hammers": lot.agreements}
    if lot.simulated:
        lines.append(f"SIMULATED   {counted(lot.simulated, 'file')}, by the virtual rig")
    return [*lines, *(f"{name:<12}{tallied(found)}" for name, found in judged.items() if found)]


def _others(lot: dp.Lot) -> list[str]:
    """Every file that was not fitted, with its sentence."""
    columns = lot.table.select("file", "outcome", "reason").iter_rows()
    return [f"  {file}: {reason}" for file, outcome, reason in columns if outcome != "fitted"]


def _shares(scatter: tuple[Component, ...]) -> list[str]:
    lines = []
    for one in scatter:
        low, high = one.interval or (one.variance, one.variance)
        between = f" ({low**0.5:.3g} to {high**0.5:.3g})" if one.interval else ""
        lines.append(
            f"  {one.source:<9} {one.variance**0.5:.3g}{between} N/m, {100 * one.share:.3g} % of "
            "the variance"
        )
    return ["scatter of k_inf, standard deviations:", *lines] if lines else []


def _out(lot: dp.Lot, quantity: str) -> list[str]:
    """The tests to look at."""
    away = [
        f"  stands out  {file}: {one:+.1f} robust deviations from its lot"
        for file, one in lot.outliers(quantity)
    ]
    return [*away, *(f"  short hold  {file}" for file in lot.short_holds)]
