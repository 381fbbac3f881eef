"""dashpot level: what stiffness and damping do with amplitude."""

from __future__ import annotations

from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._shell import File, Outcome, reports, write, write_figure
from dashpot.workflow.job import LevelJob


@click.command("level")
@click.argument("files", type=File(), nargs=-1, required=True, metavar="SWEEP|LOOPS|HITS|FRF...")
@options.of(LevelJob)
@options.picture
@options.output("Write a page of it.", ".html", ".htm")
@options.overwrite
@reports
@options.reading
def command(
    *, files: tuple[str, ...], picture: str | None, output: str | None, **choices: Any
) -> Outcome:
    """Find how far stiffness and damping depend on how far the seal is moved.

    SWEEP is storage and loss against strain or displacement at one frequency or a few; LOOPS a
    record of harmonic cycles at several amplitudes; HITS a hammer test with hits of different
    height; FRF... those of one mass at several levels, from which arms, sliders and a spring are
    found. Hits and FRFs tell the resonance at another level (--at), and whether they speak for it.

    \b
    dashpot level sweep.csv
    dashpot level loops.csv --plot loops.png -o loops.html
    dashpot level hammer.csv --at 0.5N
    dashpot level low.csv high.csv --level 0.02N --level 0.2N --mass 104g --seals 2 --at 0.1N
    """
    found = workflow.level_files(files, **choices)
    if picture:
        write_figure(picture, dp.plot.level(found.fit, found.records))
    if output:
        write(output, dp.report.html(found))
    return Outcome(found, _text.levels(found), found.checks, verdict=found.verdict)
