"""dashpot verify: a project, recomputed end to end."""

from __future__ import annotations

from dataclasses import asdict

import click

from dashpot import workflow
from dashpot.base.checks import verdict
from dashpot.cli._shell import Outcome, reports
from dashpot.cli._terminal import Text


@click.command("verify")
@click.argument("project")
@reports
def command(*, project: str) -> Outcome:
    """Recompute every result of PROJECT from its raw files and check every hash.

    A project is made by 'dashpot report ... --project DIR'. Leaves with 1 if anything differs.

    \b
    dashpot verify door-seal/
    """
    checks = workflow.verify(workflow.open_project(project))
    bad = [check for check in checks if check.failed]
    document = {
        "schema": "dashpot/verification@1",
        "project": project,
        "ok": not bad,
        "checks": [asdict(check) for check in checks],
    }
    every = [f"  ok  {check.says}" for check in checks if not check.failed]
    return Outcome(
        document,
        Text((), every),
        checks,
        must_pass=True,
        verdict=verdict(checks, sound="every result follows again from its raw files"),
    )
