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
def _find_modes_and_plot(asked: ModesJob) -> tuple[MeasuredModes | ModesByMass, Picture]:
    """The modes, and their figure."""
    send_progress(f"seeking the modes of {', '.join(Path(path).name for path in asked.files)}")
    options, band = asked.options, asked.band
    if asked.masses:
        held = modes_by_mass(
            asked.files, asked.masses, seals=asked.seals, options=options, band=band
        )
        return held, plot.several_masses(held.together, [one.frf for one in held.tests])
    found, chart = modes_files(asked.files, options=options, band=band)
    return found, plot.stabilisation(chart, [one.mode for one in found.modes])


def modes(request: Mapping[str, Any], folder: Path) -> bytes:
    """The modes of such files: verdict, numbers, checks, chart, tables, and the command."""
    asked = _parse_request(request, folder)
    found, picture = _find_modes_and_plot(asked)
    width = sizes_of(request).get("bench", WIDE)[0]
    drawn = make_figure_cards(picture, width)
    checks: tuple[Check, ...]
    frfs: list[FRF]
    if isinstance(found, MeasuredModes):
        checks, frfs = found.frf.checks, [found.frf]
        named = [(str(i), one.mode) for i, one in enumerate(found.modes, 1)]
        drawn = [drawn[0]._replace(title="Stabilisation chart"), *_tables(found)]
    else:
        checks, frfs = found.checks, [one.frf for one in found.tests]
        held = zip(found.together.masses, found.together.modes, strict=True)
        named = [(format_quantity(mass, "g"), mode) for mass, mode in held]
    said = found.verdict
    return wire_format.encode_message(
        {
            "verdict": view_models.verdict(said),
            "colour": COLOURS[said.use],
            "solid": view_models.term_table("Modes", _terms(named)),
            "arms": "",
            "checks": view_models.check_list(checks),
            "figures": drawn,
            "simulated": any(source.simulated for one in frfs for source in one.source),
            "command": line("fit", asked),
        }
    )


def download_modes(request: Mapping[str, Any], folder: Path) -> bytes:
    """The modes as their JSON, as ``dashpot fit --json`` prints it."""
    found, _ = _find_modes_and_plot(_parse_request(request, folder))
    text = (
        json.dumps(found.document, indent=2, ensure_ascii=False, allow_nan=False)
        if isinstance(found, ModesByMass)
        else to_json(found)
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


def _tables(found: MeasuredModes) -> list[FigureCard]:
    """What each mode is beside its pole; of several points shapes and how alike they are."""
    if not found.modes:
        return []
    last = ["MPC", "MPD, °"] if found.points else ["modal mass, kg"]
    rows = []
    for i, one in enumerate(found.modes, 1):
        own = [f"{one.modal_mass:.4g}"]
        if found.points:
            own = [f"{one.phase_collinearity:.3f}", f"{one.phase_deviation_deg:.2g}"]
        residue = one.mode.facts[2].cells.with_error
        rows.append([str(i), round_to_error(one.frequency_hz, digits=4), residue, *own,
                     f"{one.orders} of {found.highest_order}"])  # fmt: skip
    head = ["mode", "Hz", "residue, m/(N s)", *last, "orders stable"]
    of = " of 1 kg on the base" if found.frf.quantity.over_base else ""
    tables = [(f"Modes{of}", head, rows)]
    if found.points:
        tables += _shapes(found)
    return [
        FigureCard(title, view_models.render_template("cells", head=head, rows=rows), min(i, 1) + 1)
        for i, (title, head, rows) in enumerate(tables)
    ]


def _shapes(found: MeasuredModes) -> list[tuple[str, list[str], list[list[str]]]]:
    """The shapes of the modes, and how alike they are: title, head and rows."""
    numbers = [str(i + 1) for i in range(len(found.modes))]
    parts = [complex(p.real, p.imag) for one in found.modes for p in one.shape]
    sizes = np.array(parts).reshape(len(numbers), -1).T
    shapes = [
        [point, *(f"{abs(v):.3f}, {_degrees(v)}°" for v in row)]
        for point, row in zip(found.points, sizes, strict=True)
    ]
    macs = [[n, *(f"{v:.3f}" for v in row)] for n, row in zip(numbers, found.mac, strict=True)]
    return [
        ("Shapes: size and phase", ["point", *(f"mode {n}" for n in numbers)], shapes),
        ("Modal assurance criterion", ["mode", *numbers], macs),
    ]


def _degrees(value: complex) -> str:
    """The phase in whole degrees, 0 without a sign."""
    return f"{round(math.degrees(cmath.phase(value))):d}".replace("-", "−")
