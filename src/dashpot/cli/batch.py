"""dashpot batch: many tests, one table."""

from __future__ import annotations

from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any, Literal

import click

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.cli import _options as options
from dashpot.cli._options import over_profile
from dashpot.cli._shell import File, Folder, Outcome, reports, write
from dashpot.cli._terminal import Text
from dashpot.io.options import OF_HAMMER, OF_HAMMER_ALONE, ReadOptions
from dashpot.lots.statistics.scatter import Component


@click.command("batch")
@click.argument("paths", type=File(), nargs=-1, metavar="PATH...")
@click.option("-o", "--output", type=Folder(), metavar="LOT", required=True, help="Folder to fill.")
@options.arms
@options.method
@click.option("--quick", is_flag=True, help="The optimum alone; needs a number of --arms.")
@click.option("--mass", type=options.Quantity("mass"), help="Block mass: adds its frequency.")
@options.seals
@click.option(
    "--at", type=options.Quantity("frequency"), multiple=True,
    help="Adds stiffness and loss factor there, e.g. 12.7Hz; repeat it for more.",
)  # fmt: skip
@click.option(
    "--compression", type=options.Quantity("length"), multiple=True,
    help="Of the seals, for these [default: as tested]; repeat it for more.",
)  # fmt: skip
@click.option(
    "--by", metavar="REGEX", help=r"Lot, seal, repeat from the path: 'lot(\w+)_seal(\d+)_rep(\d+)'."
)
@click.option(
    "--manifest", type=File(), metavar="FILE",
    help="CSV or TOML: file, lot, seal, repeat, operator, temperature, mass, hammer.",
)  # fmt: skip
@click.option(
    "--pair",
    metavar="PATTERN",
    help="Hammer files of a test: '{stem}_hammer*.csv', '{seal}_*.uff'.",
)
@click.option("--joint", is_flag=True, help="One solid for a ramp and hold and its hammer.")
@click.option(
    "--impact-profile", type=File(), metavar="FILE", help="Saved answers for the hammer files."
)
@click.option("--jobs", type=click.IntRange(1), help="Processes [default: one per processor].")
@click.option(
    "--scheduler", metavar="ADDRESS", help="A dask.distributed cluster instead: tcp://host:8786."
)
@click.option("--dry-run", is_flag=True, help="Say what would be done, and how long it takes.")
@reports
@options.reading
def command(
    *,
    paths: tuple[str, ...],
    output: str,
    arms: int | Literal["auto"],
    method: Literal["full", "hold"],
    quick: bool,
    mass: float | None,
    seals: float,
    at: tuple[float, ...],
    compression: tuple[float, ...],
    by: str | None,
    manifest: str | None,
    pair: str | None,
    joint: bool,
    impact_profile: str | None,
    jobs: int | None,
    scheduler: str | None,
    dry_run: bool,
    options: ReadOptions,
) -> Outcome:
    r"""Fit every test in PATH (files, folders, patterns), one row of a table each.

    LOT gets the table as Parquet parts and lot.csv, the page lot.html, and a log. A file that has
    no fit, or cannot be read, is a row that says why. Stopped or killed, the same command
    goes on where it was.

    \b
    dashpot batch tests/ -o lot
    dashpot batch tests/ -o lot --by 'lot(\w+)_seal(\d+)_rep(\d+)' --mass 104g --seals 2
    dashpot batch --manifest tests.csv -o lot --arms 2 --quick --jobs 8
    dashpot batch tests/ -o lot --pair '{stem}_hammer*.csv' --mass 104g --seals 2
    dashpot batch tests/ -o lot --scheduler tcp://host:8786
    dashpot batch tests/ -o lot --dry-run
    """
    if not paths and manifest is None:
        raise click.UsageError("give files, folders or patterns, or --manifest FILE")
    from dashpot.lots.page import html  # jinja and figures are not needed to list options

    # columns named for one kind of file need not exist in the other's; units do no harm
    of_impact = over_profile(options.only(("units", *OF_HAMMER)), impact_profile)
    options = options.without(OF_HAMMER_ALONE)
    if dry_run:
        from dashpot.lots.choices import BatchChoices
        from dashpot.lots.lot import plan_batch

        planned = plan_batch(
            paths, output=output, by=by, manifest=manifest, pair=pair, jobs=jobs,
            scheduler=scheduler,
            choices=BatchChoices(
                arms, method, quick, mass, seals, options, of_impact, joint, at, compression
            ),
        )  # fmt: skip
        document = {"schema": "dashpot/batch-plan@1", **asdict(planned)}
        return Outcome(document, Text(_planned(asdict(planned))))
    lot = dp.batch(
        paths, output=output, arms=arms, method=method, quick=quick, mass=mass, seals=seals,
        at=at, compression=compression, by=by, manifest=manifest, pair=pair, joint=joint,
        jobs=jobs, scheduler=scheduler, options=options, impact_options=of_impact,
    )  # fmt: skip
    write(f"{output}/lot.csv", lot.csv())
    write(f"{output}/lot.html", html(lot, title=Path(output).resolve().name))
    scatter = _scatter(lot)
    document = {
        "schema": "dashpot/batch@1",
        "folder": output,
        "files": lot.table.height,
        "computed": lot.computed,
        "outcomes": lot.outcomes,
        "verdicts": lot.verdicts,
        "agreements": lot.agreements,
        "components": [asdict(one) for one in scatter],
        "outliers": [
            {"file": file, "robust_deviations": away if isfinite(away) else None}
            for file, away in lot.outliers()
        ],
        "short_holds": list(lot.short_holds),
    }
    return Outcome(
        document, Text([*_told(document), *_shares(scatter), *_out(lot)], _others(lot)), lot.checks
    )


def _planned(plan: dict[str, Any]) -> list[str]:
    left, chunks, jobs = plan["files"] - plan["done"], plan["chunks"], plan["jobs"]
    return [
        f"files       {plan['files']}, {plan['done']} of them done",
        f"to do       {left} in {chunks} chunks by {jobs} processes, {plan['seconds']:.3g} s",
    ]


def _told(document: dict[str, Any]) -> list[str]:
    def counted(counts: dict[str, int]) -> str:
        return ", ".join(f"{count} {name}" for name, count in counts.items())

    there = document["files"] - document["computed"]
    lines = [
        f"files       {document['files']}: {counted(document['outcomes'])}",
        f"computed    {document['computed']} now, {there} were there",
    ]
    judged = {"verdicts": document["verdicts"], "hammers": document["agreements"]}
    return [*lines, *(f"{name:<12}{counted(found)}" for name, found in judged.items() if found)]


def _others(lot: dp.Lot) -> list[str]:
    """Every file that was not fitted, with its sentence."""
    columns = lot.table.select("file", "outcome", "reason").iter_rows()
    return [f"  {file}: {reason}" for file, outcome, reason in columns if outcome != "fitted"]


def _scatter(lot: dp.Lot) -> tuple[Component, ...]:
    """The components of the relaxed stiffness, where lots or seals were named."""
    try:
        return lot.components()
    except DataError:
        return ()


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


def _out(lot: dp.Lot) -> list[str]:
    """The tests to look at."""
    away = [
        f"  stands out  {file}: {one:+.1f} robust deviations from its lot"
        for file, one in lot.outliers()
    ]
    return [*away, *(f"  short hold  {file}" for file in lot.short_holds)]
