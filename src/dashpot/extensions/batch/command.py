"""dashpot batch: many tests, one table."""

from __future__ import annotations

import signal
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dashpot.base.number_format import format_count
from dashpot.cli import _options as options
from dashpot.cli._command import group, opt, verb
from dashpot.cli._command_result import CommandResult
from dashpot.cli._options import RESULT
from dashpot.extensions.batch.lot_options import (
    build_fit_options,
    build_job,
    build_lot_options,
    summarise_lot,
)
from dashpot.extensions.batch.lot_output import LotOutput, make_command_result, write_lot
from dashpot.text_output.layout import Text

if TYPE_CHECKING:
    from dashpot.extensions.batch.batch_run import BatchJob, BatchPlan


@verb(
    "batch",
    """Fit every test in a folder: one table, one page; --watch keeps it up to date.

  dashpot batch tests/ -o lot
  dashpot batch rig/ -o lot --watch
  dashpot batch tests/ -o lot --limits limits.toml --strict

A stopped batch goes on where it was. Two lots: dashpot compare LOT LOT.""",
    options.file_argument("PATH...", "paths", min_count=0),
    build_lot_options(
        opt("--watch", help="Go on as files are written; Ctrl-C ends it."),
        opt("--dry-run", help="Say what would be done."),
    ),
    build_fit_options(),
    options.reading_options(),
    group(
        RESULT,
        opt("--json", "as_json", help="Print one JSON document in SI units."),
        opt("--strict", help="Exit with 1 if a check limits the use."),
        opt("-v", "--verbose", help="Print everything."),
    ),
)
def command(*, paths: tuple[str, ...], watch: bool, dry_run: bool, **said: Any) -> CommandResult:
    """Fit the files of a folder, and with ``--watch`` new ones."""
    if not paths and said["manifest"] is None:
        raise click.UsageError(
            "Give files, folders or patterns, and the folder to fill: dashpot batch tests/ -o LOT"
        )
    batch_job = build_job(paths, **said)
    if watch:
        if dry_run:
            raise click.UsageError("--watch waits for files, --dry-run does nothing: leave one out")
        return _watch_folder(batch_job)
    from dashpot.extensions.batch.batch_run import plan_batch, run_batch

    if dry_run:
        plan = plan_batch(batch_job)
        return CommandResult(plan, Text(_format_plan(plan)))
    summary = summarise_lot(batch_job, run_batch(batch_job))
    write_lot(batch_job.output, summary, batch_job.quantity)
    return make_command_result(batch_job, summary)


def _watch_folder(batch_job: BatchJob) -> CommandResult:
    """Fit each test of a folder as it is written, until Ctrl-C; a file is taken when it rests."""
    from dashpot.extensions.batch.folder_watch import watch_batch

    if len(batch_job.paths) != 1 or not Path(batch_job.paths[0]).is_dir():
        raise click.UsageError("--watch looks at one folder, such as: dashpot batch rig/ --watch")
    with suppress(ValueError):  # not the main thread of whoever calls
        signal.signal(signal.SIGTERM, signal.default_int_handler)
    lot = watch_batch(
        batch_job,
        lambda lot: write_lot(batch_job.output, summarise_lot(batch_job, lot), batch_job.quantity),
    )
    if lot is None:
        text = "stopped before a table was made; the same command goes on from there"
        return CommandResult(LotOutput(str(batch_job.output)), Text([text]))
    return make_command_result(batch_job, summarise_lot(batch_job, lot))


def _format_plan(plan: BatchPlan) -> list[str]:
    count, seconds = plan.files - plan.done, plan.seconds
    chunks = format_count(plan.chunks, "chunk")
    return [
        f"files       {plan.files}, {plan.done} of them done",
        f"to do       {count} in {chunks} by {plan.jobs} processes, {seconds:.3g} s",
    ]
