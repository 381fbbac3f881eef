"""Page of the paper's statements and figures beside the reproduced ones."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace

from dashpot import plot
from dashpot.base.number_format import round_to_error
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import convert_to_unit
from dashpot.extensions.paper.figure import figure_2, figure_4
from dashpot.extensions.paper.reproduction import BASELINE, Coefficient, Reproduction, Statement
from dashpot.plot.picture import Picture
from dashpot.report.figures import HALF_WIDTH, render_figure
from dashpot.report.page_frame import encode_data_uri, environment, frame
from dashpot.report.tables import TextTable

TITLE = "The paper, reproduced"
SIMULATION_NOTE = "SIMULATED: Table 1 of the paper, no measurement"
PARTS = {
    "equation": "Equations",
    "figure": "Figures",
    "misprint": "Misprinted, or said the wrong way round",
    "unsaid": "Not said, and what is supposed here",
}
"""Headings of the tables of statements."""


def paper_page(reproduction: Reproduction) -> str:
    """Return the page as one self-contained HTML file.

    Parameters
    ----------
    reproduction : Reproduction
        Result of ``dashpot demo --paper``.
    """
    contents = {
        **frame(),
        "title": TITLE,
        "verdict": None,
        "colour": "good" if reproduction.is_reproduced else "bad",
        "word": "Reproduced" if reproduction.is_reproduced else "Not reproduced",
        "message": reproduction.summary,
        "figures": {
            name: render_figure(picture, width=HALF_WIDTH)
            for name, picture in paper_pictures(reproduction).items()
        },
        "table_1": make_table_1(reproduction.table),
        "parts": {
            part: (PARTS[part], make_statement_table(reproduction.rows, part)) for part in PARTS
        },
        "link": encode_data_uri("application/json", json.dumps(reproduction.to_dict(), indent=2)),
    }
    return str(environment("dashpot.extensions.paper").get_template("paper.html").render(contents))


def paper_pictures(reproduction: Reproduction) -> dict[str, Picture]:
    """Return the paper's figures by file name: 2, 4 and 6."""
    fits = [
        (f"N = {hold_fit.solid.arms}", hold_fit.time, hold_fit.force)
        for hold_fit in (reproduction.single_arm, reproduction.two_arms)
    ]
    study = reproduction.study
    assert study.comparison is not None  # noqa: S101
    sixth = plot.comparison(study.comparison, band=study.frf_band, stamp=SIMULATION_NOTE)
    return {
        "figure_2": figure_2(reproduction.ideal, BASELINE, stamp=SIMULATION_NOTE),
        "figure_4": figure_4(reproduction.ideal, BASELINE, fits, stamp=SIMULATION_NOTE),
        "figure_6": replace(sixth, name="figure-6"),
    }


def make_table_1(table: Sequence[Coefficient]) -> TextTable:
    """Table 1 as printed, and as each record gives it back."""
    header = (
        "", "unit", "printed", "exact record", "in steps of 1/1280 N",
        "simulation, whole history", "simulation, hold alone",
    )  # fmt: skip
    rows, row_classes = [], []
    for item in table:
        unit = item.full.word
        printed_value, exact, quantised = (
            convert_to_unit(value, item.full.reading)
            for value in (item.printed, item.noise_free, item.quantised)
        )
        rows.append((
            item.full.symbol, unit, f"{printed_value:.4f}", round_to_error(exact, digits=9),
            round_to_error(quantised, digits=7), _format_fact(item.full), _format_fact(item.hold),
        ))  # fmt: skip
        row_classes.append("" if all(item.is_covered) else "doubt")
    return TextTable(header, tuple(rows), tuple(row_classes))


def _format_fact(reported_value: ReportedValue) -> str:
    cells = reported_value.cells
    return f"{cells.value}, {cells.interval}" if cells.interval else cells.value


def make_statement_table(rows: Sequence[Statement], part: str) -> TextTable:
    """Return the statements of one part of the paper with computed values and differences."""
    part_rows = [row for row in rows if row.part == part]
    has_intervals = any(row.within_interval is not None for row in part_rows)
    header = ("where", "the paper says", "found", *(("off by", "allowed") if has_intervals else ()))
    cells = []
    for row in part_rows:
        difference_text, tolerance_text = (
            "–" if value is None else f"{value:.1g}" for value in (row.difference, row.tolerance)
        )
        cells.append(
            (
                row.name,
                row.paper,
                row.reproduced,
                *((difference_text, tolerance_text) if has_intervals else ()),
            )
        )
    return TextTable(
        header,
        tuple(cells),
        tuple("bad" if row.within_interval is False else "" for row in part_rows),
    )
