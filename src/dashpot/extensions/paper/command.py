"""dashpot demo: the main job on a simulated seal, and files to learn on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from dashpot import workflow
from dashpot.base import dataclass
from dashpot.base.progress import send_progress
from dashpot.base.serialisation import Serialisable
from dashpot.cli import _options as options
from dashpot.cli._command import group, mark_advanced, opt, verb
from dashpot.cli._command_files import format_command, format_grams
from dashpot.cli._command_result import CommandResult, claim_outputs, write_output
from dashpot.cli._options import RESULT
from dashpot.cli._param_types import Folder
from dashpot.registry import load_object
from dashpot.text_output.layout import Text
from dashpot.workflow.job import Job

SEALS = 2


@dataclass(frozen=True)
class Examples(Serialisable):
    """Example files that were written."""

    schema = "dashpot/example@1"

    files: tuple[str, ...]


@verb(
    "demo",
    """Run the main workflow on a simulated seal, or write files to learn on.

  dashpot demo                  two files and their report in dashpot-demo/
  dashpot demo --files          seal_8mm.csv and hammer.csv, here
  dashpot demo --files --all    the files of every how-to page, too
  dashpot demo --story          reports of two seals, one tested cold, too
  dashpot demo --paper -o DIR   the paper's equations, figures and table, again

The 'paper' seal of the story is Table 1 of the paper. The 'broad' seal, also that
of the files, relaxes the same way. Its three faster arms show under a hammer,
but not in a 1 s ramp.""",
    group(
        RESULT,
        opt("--files", "files_only", help="Write the files only."),
        opt("--all", "every", help="With --files: those of the how-to pages, too."),
        opt("--story", help="Two seals, and the puzzle of one solved twice."),
        opt("--paper", help="Make the paper's figures and table again."),
        opt("-o", "--output", type=Folder(), metavar="DIR",
            help="Where (dashpot-demo; of --files, here; of\n--paper, paper)."),
        mark_advanced(opt("--seed", type=click.IntRange(0), metavar="N",
                 help="Seed of the noise of --story and --paper (0).")),
    ),
    options.result_options(plot=False, has_open_option=False),
)  # fmt: skip
def command(
    *,
    files_only: bool,
    every: bool,
    story: bool,
    paper: bool,
    output: str | None,
    seed: int | None,
) -> CommandResult:
    """Run the main job, show the whole story, or write the files of it."""
    if every and not files_only:
        raise click.UsageError("--all is for the files to learn on. Add --files")
    if story and paper:
        raise click.UsageError("--story and --paper are two demonstrations: leave out one")
    if story or paper:
        task, folder = ("paper", "paper") if paper else ("story", "dashpot-demo")
        if files_only:
            raise click.UsageError(f"--{task} makes files of its own: leave out --files")
        run = load_object(f"dashpot.extensions.paper.{task}_handler:run")
        outcome: CommandResult = run(Path(output or folder), seed or 0)
        return outcome
    if seed is not None:
        raise click.UsageError("--seed is for --story and --paper: leave it out")
    if files_only:
        return _run_examples(Path(output or "."), all_files=every)
    return _run_main_job(Path(output or "dashpot-demo"))


def _run_main_job(folder: Path) -> CommandResult:
    """Write the two files of the main job and their report."""
    from dashpot.cli.report import ReportResult
    from dashpot.text_output.results import render_study as format_study

    bench, hammer, page = (folder / name for name in (*workflow.FIRST, "report.html"))
    claim_outputs([bench, hammer, page])
    _write_examples(folder, workflow.FIRST)
    study = workflow.run(Job(str(bench), impact=(str(hammer),), mass=workflow.MASS, seals=SEALS))
    send_progress("drawing the report")
    write_output(page, workflow.html(study))
    return CommandResult(
        ReportResult(study, str(page), None),
        format_study(study),
        study.verdict_checks,
        verdict=study.verdict,
        next_command=_format_report_command(bench, hammer, page),
    )


def _write_examples(folder: Path, names: Sequence[str]) -> None:
    for name in names:
        send_progress(f"simulating {name}")
        write_output(folder / name, workflow.EXAMPLES[name]())


def _format_report_command(bench: Path, hammer: Path, page: Path) -> str:
    return format_command(
        "report", bench, hammer, "--mass", format_grams(workflow.MASS), "--seals", SEALS, "-o", page
    )


def _run_examples(folder: Path, *, all_files: bool) -> CommandResult:
    """Write the test of a seal and of a hammer, simulated, and stamped so."""
    names = tuple(workflow.EXAMPLES) if all_files else workflow.FIRST
    paths = [folder / name for name in names]
    claim_outputs(paths)
    _write_examples(folder, names)
    lines = [f"{path}: {workflow.CAPTIONS[name]}" for name, path in zip(names, paths, strict=True)]
    bench, hammer = paths[:2]
    return CommandResult(
        Examples(tuple(map(str, paths))),
        Text(lines),
        next_command=_format_report_command(bench, hammer, Path("report.html")),
    )
