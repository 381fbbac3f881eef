"""dashpot verify: a project, recomputed end to end."""

from __future__ import annotations

from collections.abc import Iterable

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.checks import Check, verdict
from dashpot.cli._shell import Folder, Outcome, reports
from dashpot.cli._terminal import Text


@click.command("verify")
@click.argument("project", type=Folder())
@click.option("--expect", metavar="HASH", help="A line of its history, noted when it was the last.")
@reports
def command(*, project: str, expect: str | None) -> Outcome:
    """Recompute every result of PROJECT from its raw files and check every hash.

    A project is made by 'dashpot report ... --project DIR', which prints the hash of its history.
    Leaves with 1 if anything differs.

    \b
    dashpot verify door-seal/
    dashpot verify door-seal/ --expect 5f0c...
    """
    place = workflow.open_project(project)
    checks = workflow.verify(place, page=dp.report.html, expect=expect)
    bad = [check for check in checks if check.failed and check.grade != "note"]
    document = {
        "schema": "dashpot/verification@1",
        "project": project,
        "ok": not bad,
        "head": place.head,
        "checks": [check.document for check in checks],
    }
    every = [
        f"  {'ok' if check.passed else '--'}  {check.says}" for check in checks if not check.failed
    ]
    return Outcome(
        document,
        Text([f"history {place.head}"], every),
        checks,
        must_pass=True,
        verdict=verdict(checks, sound=_sound(checks)),
    )


def _sound(checks: Iterable[Check]) -> str:
    """What to say where nothing failed: no more than was judged."""
    open_ = [check.says for check in checks if check.passed is None]
    more = f" ({len(open_)} such)" if len(open_) > 1 else ""
    but = f"; not judged: {open_[0]}{more}" if open_ else ""
    return f"every result follows again from its raw files{but}"
