"""Page of a preload map."""

from __future__ import annotations

import numpy as np

from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import convert_to_unit
from dashpot.extensions.preload_map.preload_map import PreloadMap
from dashpot.extensions.preload_map.text import (
    PAIR_HEAD,
    SETTING_HEAD,
    describe_map,
    list_pair_cells,
    list_setting_cells,
)
from dashpot.report.first_screen import NOT_GIVEN
from dashpot.report.result_page import CollapsibleSection, KindPage, Topic, group, make_indicators
from dashpot.report.tables import TextTable

_SEPARABLE = {
    "compression_and_frequency_separable", "amplitude_and_frequency_separable",
    "compression_and_amplitude_separable", "every_pair_tested", "departure_excluded",
}  # fmt: skip

_TABLE_FREQUENCIES = 6


def page(preload_map: PreloadMap) -> KindPage:
    """Return the page of a preload map."""
    tested_pairs = [test for test in preload_map.pairs if test.tested]
    return KindPage(
        subject="complex stiffness over frequency, amplitude and compression",
        summary_line=(
            ("Map", describe_map(preload_map)),
            ("Compressions", _format_levels(preload_map.compressions.tolist())),
            ("Amplitudes", _format_levels(preload_map.amplitudes.tolist())),
            ("Scatter of lines", _make_scatter_rows(preload_map)),
        ),
        indicators=make_indicators(
            preload_map.checks,
            Topic("Records", {"repeatability_determined", "part_dissipates"}),
            Topic(
                "Separable", _SEPARABLE,
                f"{len(tested_pairs)} of {len(preload_map.pairs)} pairs tested"),
            Topic("Map", {
                "sweeps_followed", "solid_follows_master_curve", "levels_enough", "levels_dense"}),
            Topic("Limits", {"stiffness_determined", "loss_factor_determined"}),
        ),
        figure_title="Stiffness and loss factor over frequency, compression and amplitude",
        picture=preload_map.plot(),
        table_title="Stiffness, loss factor and resonances",
        groups=(group("", preload_map.facts),),
        sources=preload_map.source,
        collapsible_sections=(
            CollapsibleSection("Separability", f"{len(tested_pairs)} pairs tested",
            _make_pair_rows(preload_map)),
            CollapsibleSection("Map", "at the measured levels", _make_map_table(preload_map)),
            CollapsibleSection("Settings", f"{len(preload_map.cells)} settings",
                TextTable(SETTING_HEAD, tuple(map(list_setting_cells, preload_map.cells)))),
        ),
        name="preload-map",
    )  # fmt: skip


def _make_scatter_rows(preload_map: PreloadMap) -> str:
    size, turn = preload_map.line_scatter
    return f"{100 * size:.2g} %, {turn:.2g} rad"


def _format_levels(values: list[float]) -> str:
    levels_text = ", ".join(f"{convert_to_unit(value, 'mm'):.3g}" for value in values)
    return f"{levels_text} mm" if levels_text else NOT_GIVEN


def _make_pair_rows(preload_map: PreloadMap) -> TextTable:
    rows = tuple(list_pair_cells(test) for test in preload_map.pairs)
    return TextTable(PAIR_HEAD, rows, tuple("doubt" if row[1] != "yes" else "" for row in rows))


def _make_map_table(preload_map: PreloadMap) -> TextTable:
    """Return the map at its levels and a few frequencies."""
    header = ("compression, mm", "amplitude, mm", "Hz", "K', N/mm", "from", "to", "loss factor",
            "from", "to")  # fmt: skip
    f = preload_map.grid[np.linspace(0, len(preload_map.grid) - 1, _TABLE_FREQUENCIES, dtype=int)]
    rows = []
    for c, X in preload_map.settings:
        evaluated = preload_map.evaluate(f, compression=c, amplitude=X)
        columns = (
            (evaluated.value.real, evaluated.storage_error, "N/m"),
            (evaluated.value.imag / evaluated.value.real, evaluated.loss_factor_error, ""),
        )
        rows += [
            (
                f"{convert_to_unit(c, 'mm'):.4g}",
                "" if X is None else f"{convert_to_unit(X, 'mm'):.4g}",
                f"{f[i]:.4g}",
                *(
                    text
                    for value, error, unit in columns
                    for text in ReportedValue(
                        "", float(value[i]), float((value - error)[i]), float((value + error)[i]),
                        unit=unit,
                    ).cell_texts
                ),
            )
            for i in range(len(f))
        ]  # fmt: skip
    return TextTable(header, tuple(rows))
