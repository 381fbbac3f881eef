"""Page of one solid under several masses, and the app's cards of modes."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from dashpot import plot
from dashpot.base.number_format import format_count, format_with_error, round_to_error
from dashpot.base.progress import send_progress
from dashpot.base.provenance import Source
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import format_quantity
from dashpot.datamodel.frf import Mode
from dashpot.extensions.modes.job import ModesJob
from dashpot.extensions.modes.mass_series_files import MassSeriesModes, modes_by_mass
from dashpot.extensions.modes.measured_modes import MeasuredModes, modes_files
from dashpot.report.result_page import AppCard, Group, JobPage, KindPage, Topic, lights
from dashpot.report.solid_and_frf_pages import mode_rows
from dashpot.report.tables import TextTable


def masses_page(modes: MassSeriesModes) -> KindPage:
    """Return what the page of one solid under several masses holds."""
    of = modes.together
    facts = tuple(
        Group(format_with_error(mass, "g", digits=4), tuple(mode_rows(mode)))
        for mass, mode in zip(of.masses, of.modes, strict=True)
    )
    return KindPage(
        about=f"one model under {format_count(len(of.masses), 'mass').replace('masss', 'masses')}",
        strip=(
            ("Masses", ", ".join(format_with_error(mass, "g", digits=4) for mass in of.masses)),
        ),
        lights=lights(
            modes.checks, Topic("FRFs"), Topic("One model", {"one_solid_explains_masses"})
        ),
        answers="The response under each mass",
        picture=modes.plot(),
        told="Resonance under each mass",
        groups=facts,
        sources=_list_sources(modes),
        name="masses",
    )


def _list_sources(modes: MassSeriesModes) -> tuple[Source, ...]:
    return tuple(dict.fromkeys(source for test in modes.tests for source in test.frf.source))


def fit_job(job: ModesJob) -> tuple[MeasuredModes | MassSeriesModes, JobPage]:
    """Find the modes in the files of a job, and list what the app shows of them."""
    send_progress(f"seeking the modes of {', '.join(Path(path).name for path in job.files)}")
    options, band = job.options, job.band
    if job.masses:
        modes = modes_by_mass(job.files, job.masses, seals=job.seals, options=options, band=band)
        return modes, _describe_masses(modes)
    measured_modes, chart = modes_files(job.files, options=options, band=band)
    picture = plot.stabilisation(chart, [mode.mode for mode in measured_modes.modes])
    named = ((str(i), mode.mode) for i, mode in enumerate(measured_modes.modes, 1))
    return measured_modes, JobPage(
        (AppCard("Stabilisation chart", picture), *_list_tables(measured_modes)),
        "Modes",
        list_mode_facts(named),
        measured_modes.frf.source,
    )


def _describe_masses(modes: MassSeriesModes) -> JobPage:
    of = modes.together
    picture = plot.several_masses(of, [test.frf for test in modes.tests])
    pairs = zip(of.masses, of.modes, strict=True)
    named = ((format_quantity(mass, "g"), mode) for mass, mode in pairs)
    return JobPage((AppCard("", picture),), "Modes", list_mode_facts(named), _list_sources(modes))


def list_mode_facts(named: Iterable[tuple[str, Mode]]) -> tuple[ReportedValue, ...]:
    """Return frequency and damping of every mode, each by the name that its mode has."""
    modes = tuple(named)
    return tuple(
        replace(mode.facts[i], words=f"{sign}, {which}")
        for i, sign in enumerate(("f", "ζ"))
        for which, mode in modes
    )


def _list_tables(measured_modes: MeasuredModes) -> list[AppCard]:
    """Return what each mode is beside its pole; of several points shapes and how alike they are."""
    if not measured_modes.modes:
        return []
    last = ["MPC", "MPD, °"] if measured_modes.points else ["modal mass, kg"]
    rows = []
    for i, mode in enumerate(measured_modes.modes, 1):
        names = [f"{mode.modal_mass:.4g}"]
        if measured_modes.points:
            names = [f"{mode.phase_collinearity:.3f}", f"{mode.phase_deviation_deg:.2g}"]
        residue = mode.mode.facts[2].cells.with_error
        rows.append([str(i), round_to_error(mode.frequency_hz, digits=4), residue, *names,
                     f"{mode.orders} of {measured_modes.highest_order}"])  # fmt: skip
    head = ["mode", "Hz", "residue, m/(N s)", *last, "orders stable"]
    of = " of 1 kg on the base" if measured_modes.frf.quantity.over_base else ""
    tables = [(f"Modes{of}", head, rows)]
    if measured_modes.points:
        tables += _shapes(measured_modes)
    return [
        AppCard(title, TextTable(tuple(head), tuple(map(tuple, rows))), min(i, 1) + 1)
        for i, (title, head, rows) in enumerate(tables)
    ]


def _shapes(measured_modes: MeasuredModes) -> list[tuple[str, list[str], list[list[str]]]]:
    """Return the shapes of the modes, and how alike they are: title, head and rows."""
    numbers = [str(i + 1) for i in range(len(measured_modes.modes))]
    parts = [complex(p.real, p.imag) for mode in measured_modes.modes for p in mode.shape]
    sizes = np.array(parts).reshape(len(numbers), -1).T
    shapes = [
        [point, *(f"{abs(v):.3f}, {_degrees(v)}°" for v in row)]
        for point, row in zip(measured_modes.points, sizes, strict=True)
    ]
    macs = [
        [n, *(f"{v:.3f}" for v in row)] for n, row in zip(numbers, measured_modes.mac, strict=True)
    ]
    return [
        ("Shapes: size and phase", ["point", *(f"mode {n}" for n in numbers)], shapes),
        ("Modal assurance criterion", ["mode", *numbers], macs),
    ]


def _degrees(value: complex) -> str:
    """Return the phase in whole degrees, 0 without a sign."""
    return f"{round(math.degrees(cmath.phase(value))):d}".replace("-", "−")
