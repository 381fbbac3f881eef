"""dashpot batch: many tests, one table."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from dashpot.cli._lots import of_many, outcome, summarised, write_lot
from dashpot.cli._shell import File, Folder, Outcome, reports
from dashpot.cli._terminal import Text

if TYPE_CHECKING:
    from dashpot.lots.batches import BatchPlan


@click.command("batch")
@click.argument("paths", type=File(), nargs=-1, metavar="PATH...")
@click.option("--dry-run", is_flag=True, help="Say what would be done, and how long it takes.")
@click.option(
    "--compare", type=Folder(), nargs=2, metavar="LOT LOT",
    help="Whether two lots differ; FOLDER:NAME is one lot of several.",
)  # fmt: skip
@reports
@of_many
def command(
    *,
    paths: tuple[str, ...],
    job: Callable[..., Any],
    quantities: tuple[str, ...],
    compare: tuple[str, str] | None,
    dry_run: bool,
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
    dashpot batch tests/ -o lot --limits limits.toml --strict
    dashpot batch tests/ -o lot --dry-run
    dashpot batch --compare may/lot june/lot
    """
    if compare is not None:
        return _comparison(compare, quantities)
    asked = job(*paths)
    if not paths and asked.manifest is None:
        raise click.UsageError("give files, folders or patterns, or --manifest FILE")
    from dashpot.lots.batches import plan_batch, run_batch

    if dry_run:
        planned = plan_batch(asked)
        return Outcome(planned, Text(_planned(planned)))
    found = summarised(asked, run_batch(asked))
    write_lot(asked, found)
    return outcome(asked, found)


def _comparison(named: tuple[str, str], quantities: tuple[str, ...]) -> Outcome:
    from dashpot.lots.comparison import compared, opened_both

    first, second = opened_both(named)
    found = compared(first, second, quantities)
    return Outcome(found, Text(str(found).splitlines()), found.checks)


def _planned(plan: BatchPlan) -> list[str]:
    left, seconds = plan.files - plan.done, plan.seconds
    return [
        f"files       {plan.files}, {plan.done} of them done",
        f"to do       {left} in {plan.chunks} chunks by {plan.jobs} processes, {seconds:.3g} s",
    ]
