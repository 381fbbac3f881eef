"""dashpot watch: each test of a folder that is being filled, as it comes."""

from __future__ import annotations

import signal
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import click

from dashpot.cli._lots import Filled, of_many, outcome, summarised, write_lot
from dashpot.cli._shell import Folder, Outcome, reports
from dashpot.cli._terminal import Text


@click.command("watch")
@click.argument("folder", type=Folder())
@reports
@of_many
def command(*, folder: str, job: Callable[..., Any], **_: Any) -> Outcome:
    r"""Fit each test that is written into FOLDER, and keep table and page of the lot up to date.

    A file is taken when it has been still for two seconds. LOT is that of dashpot batch with the
    same options; what it holds already is not made again. Ctrl-C ends it.

    \b
    dashpot watch rig/ -o lot
    dashpot watch rig/ -o lot --by 'lot(\w+)_seal(\d+)_rep(\d+)' --mass 104g --seals 2
    """
    from dashpot.lots.watching import watch_batch

    asked = job(folder)
    with suppress(ValueError):  # not the main thread of whoever calls
        signal.signal(signal.SIGTERM, signal.default_int_handler)
    lot = watch_batch(asked, lambda found: write_lot(asked, summarised(asked, found)))
    if lot is None:
        told = "stopped before a table was made; the same command goes on from there"
        return Outcome(Filled(str(asked.output)), Text([told]))
    return outcome(asked, summarised(asked, lot))
