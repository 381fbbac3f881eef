"""dashpot verify: recomputation of a project."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import click

from dashpot import workflow
from dashpot.base import dataclass
from dashpot.base.checks import Check, verdict
from dashpot.base.errors import ReadError
from dashpot.base.number_format import format_count
from dashpot.base.plain_text import decapitalise_sentence
from dashpot.base.serialisation import Serialisable
from dashpot.cli._command import group, opt, verb
from dashpot.cli._command_result import CommandResult
from dashpot.cli._options import RESULT
from dashpot.cli._param_types import Folder
from dashpot.extensions.projects.partial_files import find_partial_files
from dashpot.text_output.layout import Text


@dataclass(frozen=True)
class Verification(Serialisable):
    """Verification of a project: the hash of its history, and the findings on every result."""

    schema = "dashpot/verification@2"
    _keys = ("project", "ok", "head", "checks")

    project: str
    head: str
    checks: tuple[Check, ...]

    @property
    def ok(self) -> bool:
        """Whether no check failed, other than notes."""
        return not any(check.failed and check.grade != "note" for check in self.checks)


@verb(
    "verify",
    """Recompute a project's results from its raw files and check every checksum.

  dashpot verify door-seal/
  dashpot verify door-seal/ --expect 5f0c...
  dashpot verify lot/ --overwrite

Half-written files of killed runs are listed, in any folder of results.
--overwrite removes them.""",
    click.Argument(["project"], type=Folder(), metavar="DIR"),
    group(
        RESULT,
        opt("--expect", metavar="HASH", help="Last line of its history, as you noted it."),
        opt("--overwrite", help="Remove half-written files of killed runs."),
        opt("--json", "as_json", help="Print one JSON document."),
        opt("-v", "--verbose", help="Print everything."),
    ),
)
def command(*, project: str, expect: str | None) -> CommandResult:
    """Recompute every result; exit with code 1 if anything differs."""
    from dashpot.extensions.projects.project import open_project  # not needed for --help
    from dashpot.extensions.projects.verification import verify

    paths = find_partial_files(project)
    if click.get_current_context().obj.replace:
        for path in paths:
            path.unlink(missing_ok=True)
    try:
        opened_project = open_project(project)
    except ReadError:
        if not paths or expect is not None:
            raise
        return _make_cleanup_result(
            project, [path.relative_to(project).as_posix() for path in paths]
        )
    checks = verify(opened_project, page=workflow.html, expect=expect)
    check_lines = [
        f"  {'ok' if check.passed else '--'}  {check.message}"
        for check in checks
        if not check.failed
    ]
    return CommandResult(
        Verification(project, opened_project.head, checks),
        Text([f"history {opened_project.head}"], check_lines),
        checks,
        must_pass=True,
        verdict=verdict(checks, headline=_format_headline(checks)),
    )


def _make_cleanup_result(folder: str, partial_files: list[str]) -> CommandResult:
    """Return the result for a folder that is not a project."""
    from dashpot.extensions.projects.verification import check_half_written_files

    check = check_half_written_files(Path(folder))
    verification = Verification(folder, "", (check,))
    action = "left" if check.failed else "cleared"
    removed_text = f"{format_count(len(partial_files), 'half-written file')} {action}"
    text = Text([f"{action} {name}" for name in partial_files], [])
    return CommandResult(
        verification, text, (check,), verdict=verdict((check,), headline=removed_text)
    )


def _format_headline(checks: Iterable[Check]) -> str:
    """Return the headline where nothing failed."""
    open_ = [check.message for check in checks if check.passed is None]
    open_text = f". {len(open_)} not checked: {decapitalise_sentence(open_[0])}" if open_ else ""
    return f"every result follows from its raw files again{open_text}"
