"""FRFs of one structure, or of one solid under several masses: their modes."""

from __future__ import annotations

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.number_format import format_count
from dashpot.cli._command_io import CommandResult
from dashpot.cli.fit_handlers._request import FitRequest


def run(given: FitRequest) -> CommandResult:
    """Find the modes that the FRFs share."""
    given.check_output_suffix(".json", what="the modes of FRFs")
    found, chart = workflow.modes_files(
        given.files,
        options=given.reading,
        band=given["band"],
        motion=given.hammer.motion,
        polarity=given.hammer.polarity,
    )
    return given.told(
        found,
        figure=lambda: dp.plot.stabilisation(
            chart, [one.mode for one in found.modes], stamp=dp.plot.stamp(found.frf.source)
        ),
    )


def under_masses(given: FitRequest) -> CommandResult:
    """Find the modes under each mass, and whether one solid carries them all."""
    masses, files = given["mass"], given.files
    if len(masses) != len(files):
        raise click.UsageError(
            f"--mass was given {len(masses)} times for {format_count(len(files), 'file')}. Give "
            "the "
            "mass of each file, in their order."
        )
    given.refuse_polarity()
    given.check_output_suffix(".json", what="the modes under several masses")
    seals = given["seals"]
    found = workflow.modes_by_mass(
        files, masses, seals=seals, options=given.reading, band=given["band"]
    )
    under = [one.frf for one in found.tests]
    stamp = dp.plot.stamp([source for one in under for source in one.source], seals=seals)
    return given.told(
        found, figure=lambda: dp.plot.several_masses(found.together, under, stamp=stamp)
    )
