"""dashpot example: files to learn on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

from dashpot import workflow
from dashpot.base.documents import Documented
from dashpot.base.progress import doing
from dashpot.cli import _options as options
from dashpot.cli._shell import Folder, Outcome, claim, grams, reports, typed, write
from dashpot.cli._terminal import Text


@dataclass(frozen=True)
class Examples(Documented):
    """The files that were written."""

    schema = "dashpot/example@1"

    files: tuple[str, ...]


@click.command("example")
@click.option("-o", "--output", type=Folder(), metavar="DIR", default="example", show_default=True)
@click.option("--all", "every", is_flag=True, help="The files of the how-to pages, too.")
@options.force
@reports
def command(*, output: str, every: bool) -> Outcome:
    """Write the test of a seal and of a hammer into DIR: simulated, and stamped so.

    \b
    dashpot example
    dashpot example -o lab --all
    """
    folder = Path(output)
    names = tuple(workflow.EXAMPLES) if every else workflow.FIRST
    paths = [folder / name for name in names]
    claim(paths)
    for name, path in zip(names, paths, strict=True):
        doing(f"simulating {name}")
        write(path, workflow.EXAMPLES[name]())
    bench, hammer = paths[:2]
    lines = [f"{path}: {workflow.CAPTIONS[name]}" for name, path in zip(names, paths, strict=True)]
    words = ("report", bench, "--impact", hammer, "--mass", grams(workflow.MASS), "--seals", 2)
    found = Examples(tuple(map(str, paths)))
    return Outcome(found, Text(lines), follow=typed(*words, "-o", "report.html"))
