"""Page of a preload map."""

from __future__ import annotations

from dashpot.base.number_format import round_to_error
from dashpot.base.units import convert_to_unit
from dashpot.extensions.preload_map.preload_map import PreloadMap
from dashpot.extensions.preload_map.text import PAIR_HEAD, describe_map, list_pair_cells
from dashpot.report.first_screen import NOT_GIVEN
from dashpot.report.result_page import CollapsibleSection, KindPage, Topic, group, lights
from dashpot.report.tables import TextTable

_SEPARABLE = {
    "compression_and_frequency_separable", "amplitude_and_frequency_separable",
    "compression_and_amplitude_separable", "every_pair_tested", "departure_excluded",
}  # fmt: skip


def page(found: PreloadMap) -> KindPage:
    """Return the page of a preload map."""
    tested = [test for test in found.pairs if test.tested]
    return KindPage(
        about="complex stiffness over frequency, amplitude and compression",
        strip=(
            ("Map", describe_map(found)),
            ("Compressions", _levels(found.compressions.tolist())),
            ("Amplitudes", _levels(found.amplitudes.tolist())),
            ("Scatter of lines", _scatter(found)),
        ),
        lights=lights(
            found.checks,
            Topic("Records", {"repeatability_known", "part_dissipates"}),
            Topic("Separable", _SEPARABLE, f"{len(tested)} of {len(found.pairs)} pairs tested"),
            Topic("Map", {
                "sweeps_followed", "solid_follows_master_curve", "levels_enough", "levels_dense"}),
            Topic("Limits", {"stiffness_determined", "loss_factor_determined"}),
        ),
        answers="Stiffness and loss factor over frequency, compression and amplitude",
        picture=found.plot(),
        told="Stiffness, loss factor and resonances",
        groups=(group("", found.facts),),
        sources=found.source,
        folds=(
            CollapsibleSection("Separability", f"{len(tested)} pairs tested", _pairs(found)),
            CollapsibleSection("Map", "at the measured levels", _table(found)),
            CollapsibleSection("Settings", f"{len(found.cells)} settings", _cells(found)),
        ),
        name="preload-map",
    )  # fmt: skip


def _scatter(found: PreloadMap) -> str:
    size, turn = found.line_scatter
    return f"{100 * size:.2g} %, {turn:.2g} rad"


def _levels(values: list[float]) -> str:
    shown = ", ".join(f"{convert_to_unit(value, 'mm'):.3g}" for value in values)
    return f"{shown} mm" if shown else NOT_GIVEN


def _pairs(found: PreloadMap) -> TextTable:
    rows = tuple(list_pair_cells(test) for test in found.pairs)
    return TextTable(PAIR_HEAD, rows, tuple("doubt" if row[1] != "yes" else "" for row in rows))


def _table(found: PreloadMap) -> TextTable:
    """Return the map at its levels and a few frequencies."""
    head = (
        "compression, mm",
        "amplitude, mm",
        "Hz",
        "K', N/mm",
        "from",
        "to",
        "loss factor",
        "from",
        "to",
    )
    f = found.grid[:: max(len(found.grid) // 5, 1)]
    rows = []
    for c, X in found.settings:
        at = found.evaluate(f, compression=c, amplitude=X)
        storage, error = (convert_to_unit(entry, "N/mm") for entry in
                          (at.value.real, at.storage_error))  # fmt: skip
        eta, turn = at.value.imag / at.value.real, at.loss_factor_error
        rows += [
            (
                f"{convert_to_unit(c, 'mm'):.4g}",
                "" if X is None else f"{convert_to_unit(X, 'mm'):.4g}",
                f"{f[i]:.4g}",
                f"{storage[i]:.4g}", f"{storage[i] - error[i]:.4g}", f"{storage[i] + error[i]:.4g}",
                f"{eta[i]:.3g}",
                round_to_error(float(eta[i] - turn[i]), digits=2),
                round_to_error(float(eta[i] + turn[i]), digits=2),
            )
            for i in range(len(f))
        ]  # fmt: skip
    return TextTable(head, tuple(rows))


def _cells(found: PreloadMap) -> TextTable:
    head = ("compression, mm", "amplitude, mm", "sweeps", "lines", "rms residual, %")
    rows = tuple(
        (
            f"{convert_to_unit(cell.compression, 'mm'):.4g}",
            "" if cell.amplitude is None else f"{convert_to_unit(cell.amplitude, 'mm'):.4g}",
            str(cell.sweeps),
            str(cell.lines),
            f"{100 * cell.residual:.2g}",
        )
        for cell in found.cells
    )
    return TextTable(head, rows)
