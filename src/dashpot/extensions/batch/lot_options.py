"""Options and output that the commands of lots share."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

import dashpot as dp
from dashpot.cli import _options
from dashpot.cli._command import CommandOption, build_options, group, mark_advanced, opt
from dashpot.cli._param_types import File, Folder
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.reading.read_options import OF_HAMMER, ReadOptions

if TYPE_CHECKING:
    from dashpot.datamodel.machine import Machine
    from dashpot.extensions.batch.batch_run import BatchJob
    from dashpot.extensions.batch.summary import Summary


HAMMER_ONLY = tuple(name for name in OF_HAMMER if name != "frequency")
"""Options of hammer tests that no dynamic sweep has."""


_ROWS, _TEST_GROUP = "Rows and page", "Each test"


def build_lot_options(*own: CommandOption) -> list[CommandOption]:
    """Return the options of the table and its page, after those of the verb itself."""
    return group(
        _ROWS,
        opt("-o", "--output", type=Folder(), metavar="LOT", help="Folder to fill."),
        *own,
        opt("--manifest", type=File(), metavar="FILE",
            help="Table of files with lot, seal, repeat, mass, ..."),
        opt("--label-pattern", hidden_alias="by", metavar="REGEX",
            help="Lot, seal and repeat from the path."),
        opt("--pair", metavar="PATTERN", help="Hammer files of a test: {stem}_hammer*.csv."),
        opt("--limits", type=File(), metavar="FILE", help="Acceptance limits (.toml)."),
        mark_advanced(
            opt("--quantity", "quantities", multiple=True, metavar="NAME",
                help="Quantity of the page (k_end)."),
            opt("--jobs", type=click.IntRange(1), metavar="N",
                help="Processes (one per processor)."),
            opt("--scheduler", metavar="ADDRESS", help="A dask cluster: tcp://host:8786."),
        ),
    )  # fmt: skip


def build_fit_options() -> list[CommandOption]:
    """Return the options of how each test is fitted."""
    return group(
        _TEST_GROUP,
        build_options(
            BatchOptions, "arms", "quick", "joint", "mass", "seals", "at", argument="choices"
        ),
        mark_advanced(
            build_options(
                BatchOptions, "method", "compression", "length", "radius", argument="choices"
            ),
            _options.machine_option(),
        ),
    )


def build_job(
    paths: tuple[str, ...],
    *,
    output: str | None,
    choices: BatchOptions,
    label_pattern: str | None,
    manifest: str | None,
    pair: str | None,
    jobs: int | None,
    scheduler: str | None,
    quantities: tuple[str, ...],
    limits: str | None,
    options: ReadOptions,
    machine: Machine,
) -> BatchJob:
    """Return the requested batch."""
    from dashpot.extensions.batch.batch_run import (
        BatchJob,  # polars and all are not needed for --help
    )
    from dashpot.extensions.batch.columns import list_number_columns
    from dashpot.extensions.batch.limits import read_limits
    from dashpot.extensions.batch.quantities import quantity

    if output is None:
        raise click.UsageError("Say which folder to fill: -o LOT")
    # columns named for one kind of file need not exist in the other's; units do no harm
    choices = replace(
        choices,
        reading=options.drop_fields(HAMMER_ONLY),
        reading_impact=options.select_fields(("units", *OF_HAMMER)),
        machine=machine,
    )
    columns = list_number_columns(choices)
    main = quantity(quantities[-1], columns).name if quantities else ""
    requested_limits = () if limits is None else read_limits(limits, columns)
    return BatchJob(
        paths,
        Path(output),
        choices,
        label_pattern,
        manifest,
        pair,
        jobs,
        scheduler,
        main,
        requested_limits,
    )


def summarise_lot(job: BatchJob, lot: dp.Lot) -> Summary:
    """Return the summary of a lot for these options."""
    from dashpot.extensions.batch.summary import summary

    return summary(lot, quantity=job.quantity or lot.main, limits=job.limits)
