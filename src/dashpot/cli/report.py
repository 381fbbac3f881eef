"""dashpot report: the main job."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from dashpot.cli._hammer import Hammer, hammer
from dashpot.cli._reading import reading
from dashpot.cli._shell import Arms, Outcome, Quantity, Range, failed, reports, write
from dashpot.cli._specimen import specimen

if TYPE_CHECKING:
    from dashpot.io.options import ReadOptions
    from dashpot.relaxation.records import Specimen


@click.command("report", short_help="The main job: both tests in, one report out.")
@click.argument("relaxation")
@click.option("--impact", multiple=True, metavar="FILE", help="Hits, or an FRF; repeat for more.")
@click.option(
    "--mass", type=Quantity("mass"), help="Block mass; inferred, and said so, if missing."
)
@click.option("--seals", type=float, default=1.0, show_default=True, help="Seals in parallel.")
@click.option("--arms", type=Arms(), default="auto", show_default=True, help="Maxwell arms.")
@click.option("--band", type=Range("frequency"), help="Lines compared, e.g. 5:40Hz.")
@click.option("--filter", "filter_", metavar="SPEC", help="E.g. lowpass:10Hz; off by default.")
@click.option("--no-joint", is_flag=True, help="Leave out the joint fit.")
@click.option("-o", "--output", metavar="FILE", default="report.html", show_default=True)
@specimen
@hammer
@reading
@reports
def command(
    *,
    relaxation: str,
    impact: tuple[str, ...],
    mass: float | None,
    seals: float,
    arms: int | str,
    band: tuple[float, float] | None,
    filter_: str | None,
    no_joint: bool,
    output: str,
    specimen: Specimen,
    hammer: Hammer,
    options: ReadOptions,
) -> Outcome:
    """Characterise the seal of RELAXATION and check it against the hammer; write one HTML file.

    \b
    dashpot report seal_8mm.csv --mass 104g --seals 2 -o report.html
    dashpot report seal_8mm.csv --impact hammer.csv --mass 104g --seals 2 -o report.html
    """
    from dashpot.archive import document
    from dashpot.cli import _words
    from dashpot.io.options import ReadOptions
    from dashpot.io.read import read_relaxation
    from dashpot.report import html
    from dashpot.study import characterise

    test = read_relaxation(relaxation, options=options, specimen=specimen)
    record = measured = None
    if impact:
        # the answers given for the bench file need not fit the hammer's: units may, columns do not
        own = ReadOptions(units=options.units, acceleration=options.acceleration)
        record, measured = hammer.read(impact, options=own, mass=mass)
    study = characterise(
        test,
        measured,
        impact=record,
        mass=mass,
        seals=seals,
        arms=arms,
        band=band,
        filter=filter_,
        joint=not no_joint,
    )
    write(output, html(study))
    content = document(study) | {"report": output}
    text = "" if output == "-" else _words.study(study)
    return Outcome(content, text, study.checks)
