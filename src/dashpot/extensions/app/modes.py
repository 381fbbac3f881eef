"""FRFs that the page finds the modes of: points of one structure, or several masses on one seal."""

from __future__ import annotations

import cmath
import json
import math
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from dashpot import plot
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.number_format import round_to_error
from dashpot.base.progress import send_progress
from dashpot.base.units import format_quantity
from dashpot.datamodel.frf import FRF, Mode
from dashpot.extensions.app import view_models, wire_format
from dashpot.extensions.app.bench_tests import KEPT, WIDE
from dashpot.extensions.app.figure_cards import FigureCard, make_figure_cards
from dashpot.extensions.app.request_parsing import build_from_request, get_list, sizes_of
from dashpot.extensions.app.upload_store import path_in
from dashpot.extensions.modes.mass_series_files import ModesByMass, modes_by_mass
from dashpot.extensions.modes.measured_modes import MeasuredModes, modes_files
from dashpot.plot.picture import Picture
from dashpot.report.page_frame import COLOURS
from dashpot.workflow.command_lines import line
from dashpot.workflow.job import ModesJob
from dashpot.workflow.json_archive import to_json


def _parse_request(request: Mapping[str, Any], folder: Path) -> ModesJob:
    for file, mass in zip(get_list(request, "files"), get_list(request, "masses"), strict=False):
        if not mass:
            name = path_in(folder, file).name
            raise DataError(f"{name}: say which mass was on the seals, such as 104 g")
    return build_from_request(ModesJob, request, folder)


@lru_cache(KEPT)
def _find_modes_and_plot(modes_job: ModesJob) -> tuple[MeasuredModes | ModesByMass, Picture]:
    """The modes, and their figure."""
    send_progress(f"seeking the modes of {', '.join(Path(path).name for path in modes_job.files)}")
    options, band = modes_job.options, modes_job.band
    if modes_job.masses:
        held = modes_by_mass(
            modes_job.files, modes_job.masses, seals=modes_job.seals, options=options, band=band
        )
        return held, plot.several_masses(held.together, [test.frf for test in held.tests])
    measured_modes, chart = modes_files(modes_job.files, options=options, band=band)
    return measured_modes, plot.stabilisation(chart, [mode.mode for mode in measured_modes.modes])


def modes(request: Mapping[str, Any], folder: Path) -> bytes:
    """The modes of such files: verdict, numbers, checks, chart, tables, and the command."""
    modes_job = _parse_request(request, folder)
    modes, picture = _find_modes_and_plot(modes_job)
    width = sizes_of(request).get("bench", WIDE)[0]
    drawn = make_figure_cards(picture, width)
    checks: tuple[Check, ...]
    frfs: list[FRF]
    if isinstance(modes, MeasuredModes):
        checks, frfs = modes.frf.checks, [modes.frf]
        named = [(str(i), mode.mode) for i, mode in enumerate(modes.modes, 1)]
        drawn = [drawn[0]._replace(title="Stabilisation chart"), *_tables(modes)]
    else:
        checks, frfs = modes.checks, [test.frf for test in modes.tests]
        held = zip(modes.together.masses, modes.together.modes, strict=True)
        named = [(format_quantity(mass, "g"), mode) for mass, mode in held]
    verdict = modes.verdict
    return wire_format.encode_message(
        {
            "verdict": view_models.verdict(verdict),
            "colour": COLOURS[verdict.use],
            "solid": view_models.term_table("Modes", _terms(named)),
            "arms": "",
            "checks": view_models.check_list(checks),
            "figures": drawn,
            "simulated": any(source.simulated for frf in frfs for source in frf.source),
            "command": line("fit", modes_job),
        }
    )


def download_modes(request: Mapping[str, Any], folder: Path) -> bytes:
    """The modes as their JSON, as ``dashpot fit --json`` prints it."""
    modes, _ = _find_modes_and_plot(_parse_request(request, folder))
    text = (
        json.dumps(modes.document, indent=2, ensure_ascii=False, allow_nan=False)
        if isinstance(modes, ModesByMass)
        else to_json(modes)
    )
    return wire_format.encode_message(
        {"name": "modes.json", "kind": "application/json", "text": text}
    )


def _terms(named: list[tuple[str, Mode]]) -> list[view_models.Term]:
    """Frequency and damping of every mode, with the ends of their intervals."""
    return [
        view_models.term(replace(mode.facts[i], words=f"{sign}, {which}"))
        for i, sign in enumerate(("f", "ζ"))
        for which, mode in named
    ]


def _tables(measured_modes: MeasuredModes) -> list[FigureCard]:
    """What each mode is beside its pole; of several points shapes and how alike they are."""
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
        FigureCard(title, view_models.render_template("cells", head=head, rows=rows), min(i, 1) + 1)
        for i, (title, head, rows) in enumerate(tables)
    ]


def _shapes(measured_modes: MeasuredModes) -> list[tuple[str, list[str], list[list[str]]]]:
    """The shapes of the modes, and how alike they are: title, head and rows."""
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
    """The phase in whole degrees, 0 without a sign."""
    return f"{round(math.degrees(cmath.phase(value))):d}".replace("-", "−")
