"""dashpot modes: what rings in a measured FRF, and how well that is known."""

from __future__ import annotations

import click

from dashpot import workflow
from dashpot.base.checks import verdict
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._options import Range
from dashpot.cli._shell import File, Outcome, reports
from dashpot.io.options import ReadOptions


@click.command("modes")
@click.argument("frf", type=File(), metavar="FRF")
@click.option("--band", type=Range("frequency"), help="Where to look for modes, e.g. 5:50Hz.")
@reports
@options.reading
def command(*, frf: str, band: tuple[float, float] | None, options: ReadOptions) -> Outcome:
    """Find the modes of the frequency response in FRF (text, UFF 58, MAT, HDF5).

    Natural frequencies, damping ratios and residues of the receptance, each with its standard
    error; the mode that moves most comes first. Without a band they are sought within two octaves
    of where a block on its mounts moves most.

    \b
    dashpot modes frf.csv
    dashpot modes frf.uff --band 5:50Hz --json
    """
    found = workflow.modes_file(frf, options=options, band=band)
    checks = found.frf.checks
    return Outcome(found, _text.modes(found), checks, verdict=verdict(checks))
