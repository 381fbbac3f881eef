"""dashpot report: the main job."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.documents import Documented
from dashpot.base.errors import ReadError
from dashpot.base.progress import doing
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._options import over_profile
from dashpot.cli._shell import (
    File,
    Folder,
    Outcome,
    claim,
    grams,
    note_written,
    opens,
    reports,
    typed,
    write,
)
from dashpot.io.options import OF_HAMMER, ReadOptions
from dashpot.workflow.job import Job

if TYPE_CHECKING:
    from dashpot import Study


@dataclass(frozen=True)
class Reported(Documented):
    """A study, the file of its report, and the hash of its project's history."""

    keys = ("*study", "report", "history?")

    study: Study
    report: str
    history: str | None


@click.command("report")
@click.argument("relaxation", type=File(), nargs=-1, required=True, metavar="RELAXATION...")
@options.of(Job, "impact", "mass")
@click.option(
    "--impact-profile", type=File(), metavar="FILE", help="Saved answers for the impact files."
)
@options.of(Job, "impact_temperature")
@options.carried
@options.of(Job, "arms", "method", "law", "family")
@options.cuts
@options.of(Job, "band", "filter", "joint")
@click.option(
    "--project", type=Folder(), metavar="DIR", help="Keep raw files, results and history there."
)
@options.of(Job, "title", "logo")
@options.output("The report [default: report.html].", ".html", ".htm")
@options.overwrite
@opens
@reports
@options.machine
@options.specimens
@options.hammer
@options.reading
def command(
    *,
    relaxation: tuple[str, ...],
    impact_profile: str | None,
    project: str | None,
    output: str | None,
    options: ReadOptions,
    **choices: Any,
) -> Outcome:
    """Characterise the seal of RELAXATION and check it against the hammer; write one HTML file.

    Several relaxation tests, such as a warm and a cold one, are fitted together; the hammer is of
    the temperature nearest to 23 degC, or of --impact-temperature.

    \b
    dashpot report seal_8mm.csv --mass 104g --seals 2 -o report.html
    dashpot report seal_8mm.csv --impact hammer.csv --mass 104g --seals 2 -o report.html
    dashpot report seal_8mm.csv --impact hammer.csv --mass 104g --seals 2 --project door-seal
    dashpot report warm.csv cold.csv --temperature 23degC --temperature 0degC --mass 104g --seals 2
    """
    # columns named for the bench file need not exist in the hammer's; units do no harm
    of_impact = options.only(("units", *OF_HAMMER))
    first, *further = relaxation
    job = Job(
        first,
        further=tuple(further),
        reading=options.without(OF_HAMMER),
        reading_impact=over_profile(of_impact, impact_profile),
        **choices,
    )
    if not (output or project):
        output = "report.html"
        claim([output])
    written: list[str] = []
    history = None
    if project:
        home = workflow.create(project)
        with _hammer_named():
            study, place = workflow.record(home, job, page=dp.report.html)
        note_written(place)
        history = home.head
        written.append(str(place))
    else:
        with _hammer_named():
            study = workflow.run(job)
    if output:
        doing("drawing the report")
        written.append(output)
        write(written[-1], dp.report.html(study))
    return Outcome(
        Reported(study, written[-1], history),
        _text.study(study),
        study.every_check,
        verdict=study.verdict,
        follow=typed("verify", project, "--expect", history, why="recomputes it")
        if project
        else _follow(job, study),
    )


@contextmanager
def _hammer_named() -> Iterator[None]:
    """Say how the files of the hammer are given, where one is taken for a bench test."""
    try:
        yield
    except ReadError as error:
        if "this is a hammer file" not in str(error):
            raise
        raise ReadError(f"{error}, or here: the hits of the hammer are given by --impact") from None


def _follow(job: Job, study: Study) -> str:
    """Return the command that keeps the solid which the report ends with."""
    family = () if job.family == "maxwell" else ("--family", job.family)
    if study.joint is None or study.mass is None:
        files = (job.relaxation, *job.further)
        return typed("fit", *files, *family, "-o", "fit.json", why="keeps the solid for export")
    rig = ("--mass", grams(study.mass), "--seals", f"{study.seals:g}")
    words = (*rig, *family, "-o", "joint.json")
    records = (word for one in (job.relaxation, *job.further) for word in ("--with", one))
    together = ("identify", *job.impact, *records)
    return typed(*together, *words, why="keeps the solid for export")
