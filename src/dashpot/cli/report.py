"""dashpot report: the main job."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import click

from dashpot.cli._hammer import hammer
from dashpot.cli._reading import reading
from dashpot.cli._shell import Arms, Outcome, Quantity, Range, reports, said, write
from dashpot.cli._specimen import specimen

if TYPE_CHECKING:
    from dashpot.io.options import ReadOptions
    from dashpot.records.specimen import Specimen
    from dashpot.workflow.job import HammerChoices


@click.command("report", short_help="The main job: both tests in, one report out.")
@click.argument("relaxation")
@click.option("--impact", multiple=True, metavar="FILE", help="Hits, or an FRF; repeat for more.")
@click.option(
    "--mass", type=Quantity("mass"), help="Block mass; inferred, and said so, if missing."
)
@click.option("--impact-profile", metavar="FILE", help="Saved answers for the impact files.")
@click.option("--seal-mass", type=Quantity("mass"), help="Of one seal; a third moves along.")
@click.option("--seals", type=float, default=1.0, show_default=True, help="Seals in parallel.")
@click.option("--arms", type=Arms(), default="auto", show_default=True, help="Maxwell arms.")
@click.option("--band", type=Range("frequency"), help="Lines compared, e.g. 5:40Hz.")
@click.option("--filter", "filter_", metavar="SPEC", help="E.g. lowpass:10Hz; off by default.")
@click.option("--no-joint", is_flag=True, help="Leave out the joint fit.")
@click.option("--project", metavar="DIR", help="Keep raw files, results and history there.")
@click.option("-o", "--output", metavar="FILE", help="The report [default: report.html].")
@reports
@specimen
@hammer
@reading
def command(
    *,
    relaxation: str,
    impact: tuple[str, ...],
    impact_profile: str | None,
    mass: float | None,
    seal_mass: float | None,
    seals: float,
    arms: int | Literal["auto"],
    band: tuple[float, float] | None,
    filter_: str | None,
    no_joint: bool,
    project: str | None,
    output: str | None,
    specimen: Specimen,
    hammer: HammerChoices,
    options: ReadOptions,
) -> Outcome:
    """Characterise the seal of RELAXATION and check it against the hammer; write one HTML file.

    \b
    dashpot report seal_8mm.csv --mass 104g --seals 2 -o report.html
    dashpot report seal_8mm.csv --impact hammer.csv --mass 104g --seals 2 -o report.html
    dashpot report seal_8mm.csv --impact hammer.csv --mass 104g --seals 2 --project door-seal
    """
    from dashpot.cli import _text as _words
    from dashpot.io.options import ReadOptions
    from dashpot.io.reading_profile import load_profile
    from dashpot.report import html
    from dashpot.workflow.archive import document
    from dashpot.workflow.job import Job, run

    # columns named for the bench file need not exist in the hammer's; units do no harm
    of_impact = ReadOptions(units=options.units, acceleration=options.acceleration)
    if impact_profile:
        of_impact = of_impact.over(load_profile(impact_profile))
    job = Job(
        relaxation=relaxation,
        impact=impact,
        mass=mass,
        seal_mass=seal_mass,
        seals=seals,
        arms=arms,
        band=band,
        filter=filter_,
        joint=not no_joint,
        specimen=specimen,
        reading=options,
        reading_impact=of_impact,
        hammer=hammer,
    )
    if project:
        from dashpot.workflow.project import create, record

        study, place = record(create(project), job, page=html)
        said(f"wrote {place}")
        written = [str(place)]
    else:
        study, written = run(job), []
    if output or not project:
        written.append(output or "report.html")
        write(written[-1], html(study))
    text = "" if output == "-" else _words.study(study)
    return Outcome(lambda: document(study) | {"report": written[-1]}, text, study.every_check)
