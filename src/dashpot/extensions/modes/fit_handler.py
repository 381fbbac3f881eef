"""Handlers of ``dashpot fit`` for modes: FRFs of one structure, or of several masses."""

from __future__ import annotations

import click

import dashpot as dp
from dashpot.base.number_format import format_count
from dashpot.cli._command_result import CommandResult
from dashpot.cli.fit_handlers import FitRequest
from dashpot.extensions.modes.mass_series_files import modes_by_mass
from dashpot.extensions.modes.measured_modes import modes_files


def run(request: FitRequest) -> CommandResult:
    """Find the modes that the FRFs share."""
    request.check_output_suffix(".json", result_name="the modes of FRFs")
    modes, chart = modes_files(
        request.files,
        options=request.reading,
        band=request["band"],
        motion=request.hammer.motion,
        polarity=request.hammer.polarity,
    )
    return request.write_output(
        modes,
        figure=lambda: dp.plot.stabilisation(
            chart, [mode.mode for mode in modes.modes], stamp=dp.plot.stamp(modes.frf.source)
        ),
    )


def fit_mass_series(request: FitRequest) -> CommandResult:
    """Find the modes under each mass, and whether one solid carries them all."""
    masses, files = request["mass"], request.files
    if len(masses) != len(files):
        raise click.UsageError(
            f"--mass was given {len(masses)} times for {format_count(len(files), 'file')}. Give "
            "the mass of each file, in their order."
        )
    request.refuse_polarity()
    request.check_output_suffix(".json", result_name="the modes under several masses")
    seals = request["seals"]
    modes = modes_by_mass(files, masses, seals=seals, options=request.reading, band=request["band"])
    frfs = [test.frf for test in modes.tests]
    stamp_text = dp.plot.stamp([source for frf in frfs for source in frf.source], seals=seals)
    return request.write_output(
        modes, figure=lambda: dp.plot.several_masses(modes.joint_modes, frfs, stamp=stamp_text)
    )
