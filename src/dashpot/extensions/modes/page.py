"""Page of one solid under several masses, and the app's cards of modes."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from dashpot import plot
from dashpot.base.number_format import format_with_error, round_to_error
from dashpot.base.progress import send_progress
from dashpot.base.provenance import Source
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import format_quantity
from dashpot.datamodel.frf import Mode
from dashpot.extensions.modes.job import ModesJob
from dashpot.extensions.modes.mass_series_files import MassSeriesModes, modes_by_mass
from dashpot.extensions.modes.measured_modes import MeasuredModes, modes_files
from dashpot.report.result_page import AppCard, Group, JobPage, KindPage, Topic, make_indicators
from dashpot.report.solid_and_frf_pages import mode_rows
from dashpot.report.tables import TextTable


def masses_page(modes: MassSeriesModes) -> KindPage:
    """Return the contents of the page of one solid under several masses."""
    joint_modes = modes.joint_modes
    groups = tuple(
        Group(format_with_error(mass, "g", digits=4), tuple(mode_rows(mode)))
        for mass, mode in zip(joint_modes.masses, joint_modes.modes, strict=True)
    )
    return KindPage(
        subject=f"one model under {len(joint_modes.masses)} masses",
        summary_line=(
            (
                "Masses",
                ", ".join(format_with_error(mass, "g", digits=4) for mass in joint_modes.masses),
            ),
        ),
        indicators=make_indicators(
            modes.checks, Topic("FRFs"), Topic("One model", {"single_solid_explains_masses"})
        ),
        figure_title="The response under each mass",
        picture=modes.plot(),
        table_title="Resonance under each mass",
        groups=groups,
        sources=_list_sources(modes),
        name="masses",
    )


def _list_sources(modes: MassSeriesModes) -> tuple[Source, ...]:
    return tuple(dict.fromkeys(source for test in modes.tests for source in test.frf.source))


def fit_job(job: ModesJob) -> tuple[MeasuredModes | MassSeriesModes, JobPage]:
    """Return the modes in the files of a job, and their cards in the app."""
    send_progress(f"finding the modes of {', '.join(Path(path).name for path in job.files)}")
    options, band = job.options, job.band
    if job.masses:
        modes = modes_by_mass(job.files, job.masses, seals=job.seals, options=options, band=band)
        return modes, _describe_masses(modes)
    measured_modes, chart = modes_files(job.files, options=options, band=band)
    picture = plot.stabilisation(chart, [mode.mode for mode in measured_modes.modes])
    labelled_modes = ((str(i), mode.mode) for i, mode in enumerate(measured_modes.modes, 1))
    return measured_modes, JobPage(
        (AppCard("Stabilisation chart", picture), *_list_tables(measured_modes)),
        "Modes",
        list_mode_facts(labelled_modes),
        measured_modes.frf.source,
    )


def _describe_masses(modes: MassSeriesModes) -> JobPage:
    joint_modes = modes.joint_modes
    picture = plot.several_masses(joint_modes, [test.frf for test in modes.tests])
    pairs = zip(joint_modes.masses, joint_modes.modes, strict=True)
    labelled_modes = ((format_quantity(mass, "g"), mode) for mass, mode in pairs)
    return JobPage(
        (AppCard("", picture),), "Modes", list_mode_facts(labelled_modes), _list_sources(modes)
    )


def list_mode_facts(labelled_modes: Iterable[tuple[str, Mode]]) -> tuple[ReportedValue, ...]:
    """Return frequency and damping of every mode, labelled by the mode."""
    modes = tuple(labelled_modes)
    return tuple(
        replace(mode.facts[i], words=f"{symbol}, {label}")
        for i, symbol in enumerate(("f", "ζ"))
        for label, mode in modes
    )


def _list_tables(measured_modes: MeasuredModes) -> list[AppCard]:
    """Return the tables of modes; of several points also those of mode shapes and their MAC."""
    if not measured_modes.modes:
        return []
    quality_headers = ["MPC", "MPD, °"] if measured_modes.points else ["modal mass, kg"]
    rows = []
    for i, mode in enumerate(measured_modes.modes, 1):
        quality_cells = [f"{mode.modal_mass:.4g}"]
        if measured_modes.points:
            quality_cells = [f"{mode.phase_collinearity:.3f}", f"{mode.phase_deviation_deg:.2g}"]
        residue = mode.mode.facts[2].cells.with_error
        rows.append([str(i), round_to_error(mode.frequency_hz, digits=4), residue, *quality_cells,
                     f"{mode.orders} of {measured_modes.highest_order}"])  # fmt: skip
    header = ["mode", "Hz", "residue, m/(N s)", *quality_headers, "orders stable"]
    mass_note = " of 1 kg on the base" if measured_modes.frf.quantity.over_base else ""
    tables = [(f"Modes{mass_note}", header, rows)]
    if measured_modes.points:
        tables += _make_shape_tables(measured_modes)
    return [
        AppCard(title, TextTable(tuple(header), tuple(map(tuple, rows))), min(i, 1) + 1)
        for i, (title, header, rows) in enumerate(tables)
    ]


def _make_shape_tables(
    measured_modes: MeasuredModes,
) -> list[tuple[str, list[str], list[list[str]]]]:
    """Return the tables of mode shapes and of their MAC: title, head and rows."""
    numbers = [str(i + 1) for i in range(len(measured_modes.modes))]
    parts = [complex(p.real, p.imag) for mode in measured_modes.modes for p in mode.shape]
    sizes = np.array(parts).reshape(len(numbers), -1).T
    shapes = [
        [point, *(f"{abs(v):.3f}, {_format_degrees(v)}°" for v in row)]
        for point, row in zip(measured_modes.points, sizes, strict=True)
    ]
    macs = [
        [n, *(f"{v:.3f}" for v in row)] for n, row in zip(numbers, measured_modes.mac, strict=True)
    ]
    return [
        ("Shapes: size and phase", ["point", *(f"mode {n}" for n in numbers)], shapes),
        ("Modal assurance criterion", ["mode", *numbers], macs),
    ]


def _format_degrees(value: complex) -> str:
    """Return the phase in whole degrees, 0 without a sign."""
    return f"{round(math.degrees(cmath.phase(value))):d}".replace("-", "−")
