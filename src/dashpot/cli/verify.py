"""dashpot verify: a project, recomputed end to end."""

from __future__ import annotations

from dataclasses import asdict

import click

from dashpot import workflow
from dashpot.cli._shell import Outcome, reports


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
    lines = [f"  {'!!' if check.failed else 'ok'}  {check.says}" for check in checks]
    verdict = f"{len(checks) - len(bad)} of {len(checks)} checks passed"
    document = {
        "schema": "dashpot/verification@1",
        "project": project,
        "ok": not bad,
        "checks": [asdict(check) for check in checks],
    }
    return Outcome(document, "\n".join([*lines, verdict]), checks, must_pass=True)
