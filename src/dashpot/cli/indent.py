"""dashpot indent: what an indenter's hit says of a surface."""

from __future__ import annotations

from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.choices import ImpactLawAsked, words
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._shell import File, Outcome, reports, write_figure
from dashpot.kinds.indentation.record import Indenter


@click.command("indent")
@click.argument("hit", type=File(), metavar="HIT")
@options.filled(Indenter, "indenter")
@click.option(
    "--law",
    type=click.Choice(words(ImpactLawAsked)),
    default="auto",
    show_default=True,
    help="Of the contact; auto takes the one that the record prefers.",
)
@options.picture
@options.overwrite
@reports
@options.reading
def command(*, hit: str, picture: str | None, **choices: Any) -> Outcome:
    """Find stiffness, damping, modulus and restitution from the motion of an indenter.

    HIT is the acceleration or the velocity (or displacement, or force) of a body of known mass
    that hits a surface and leaves it again. A spherical tip's radius makes a modulus of the
    stiffness; a height of fall holds the recorded speed to account.

    \b
    dashpot indent hit.csv --mass 5g --radius 5mm
    dashpot indent hit.csv --mass 5g --radius 5mm --drop-height 51mm --plot hit.png
    """
    found = workflow.indent_file(hit, **choices)
    if picture:
        write_figure(picture, dp.plot.indentation(found.fit))
    return Outcome(found, _text.indentation(found), found.checks, verdict=found.verdict)
