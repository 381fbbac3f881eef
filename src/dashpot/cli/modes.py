"""dashpot modes: what rings in measured FRFs, and how well that is known."""

from __future__ import annotations

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.checks import verdict
from dashpot.base.errors import ReadError
from dashpot.cli import _modes_text as text
from dashpot.cli import _options as options
from dashpot.cli._shell import File, Outcome, reports, write_figure
from dashpot.io.options import ReadOptions
from dashpot.workflow.job import ModesJob


@click.command("modes")
@click.argument("frfs", type=File(), nargs=-1, required=True, metavar="FRF...")
@options.of(ModesJob)
@options.picture
@options.overwrite
@reports
@options.reading
def command(
    *,
    frfs: tuple[str, ...],
    band: tuple[float, float] | None,
    against: tuple[str, ...],
    masses: tuple[float, ...],
    seals: float,
    picture: str | None,
    options: ReadOptions,
) -> Outcome:
    """Find the modes of the frequency responses in FRF (text, UFF 58, MAT, HDF5).

    Natural frequencies, damping ratios and residues of the receptance, each with its standard
    error; the mode that moves most comes first. Without a band they are sought within two octaves
    of where a block on its mounts moves most. Several points of one structure, in one file or in
    several, give poles that they share, and shapes; --plot draws the stabilisation chart, with
    --mass the modes under each mass and the stiffness at their poles. Two modes of one frequency
    are one to a single point of excitation, and an exponential window that the file does not name
    reads as damping.

    \b
    dashpot modes frf.csv
    dashpot modes frf.uff --band 5:50Hz --plot chart.svg
    dashpot modes light.csv heavy.csv --mass 104g --mass 250g --seals 2
    """
    if masses:
        if against:
            raise ReadError("--against is of one structure, --mass of several: leave either out")
        held = workflow.modes_by_mass(frfs, masses, seals=seals, options=options, band=band)
        if picture:
            under = [one.frf for one in held.tests]
            stamp = dp.plot.stamp([source for one in under for source in one.source], seals=seals)
            write_figure(picture, dp.plot.several_masses(held.together, under, stamp=stamp))
        return Outcome(held, text.modes_by_mass(held), held.checks,
                       verdict=verdict(held.checks))  # fmt: skip
    found, chart = workflow.modes_files(frfs, options=options, band=band, against=against)
    if picture:
        modes = [one.mode for one in found.modes]
        stamp = dp.plot.stamp(found.frf.source)
        write_figure(picture, dp.plot.stabilisation(chart, modes, stamp=stamp))
    checks = found.frf.checks
    return Outcome(found, text.modes(found), checks, verdict=verdict(checks))
