"""dashpot verify: a project, recomputed end to end."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.checks import Check, verdict
from dashpot.base.documents import Documented
from dashpot.cli._shell import Folder, Outcome, reports
from dashpot.cli._terminal import Text


@dataclass(frozen=True)
class Verification(Documented):
    """A project, the hash of its history, and what was found of every result."""

    schema = "dashpot/verification@1"
    keys = ("project", "ok", "head", "checks")

    project: str
    head: str
    checks: tuple[Check, ...]

    @property
    def ok(self) -> bool:
        """Whether nothing of weight failed."""
        return not any(check.failed and check.grade != "note" for check in self.checks)


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
    every = [
        f"  {'ok' if check.passed else '--'}  {check.says}" for check in checks if not check.failed
    ]
    return Outcome(
        Verification(project, place.head, checks),
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
