"""Preload map, as text."""

from __future__ import annotations

from cmath import phase

from dashpot.base.units import convert_to_unit
from dashpot.extensions.preload_map.preload_map import MapCell, PreloadMap
from dashpot.extensions.preload_map.separability import PairTest
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import format_rounded

PAIR_HEAD = ("pair", "separable", "probability", "departure", "at most", "angle at most, rad")
SETTING_HEAD = ("compression, mm", "amplitude, mm", "sweeps", "lines", "rms residual, %")


def format_preload_map(preload_map: PreloadMap) -> Text:
    """Return factors, tests of separability, and resonances."""
    lines = [f"  {describe_map(preload_map)}"]
    lines += table([["compression, mm", "factor F_e'(c)"], *(
        [f"{convert_to_unit(c, 'mm'):.4g}", f"{factor:.4f}"]
        for c, factor in zip(
            preload_map.compressions.tolist(), preload_map.compression_factor.tolist(), strict=True)
    )])  # fmt: skip
    if len(preload_map.amplitudes):
        lines += table([["amplitude, mm", "factor s(X)", "angle, rad"], *(
            [f"{convert_to_unit(X, 'mm'):.4g}", f"{abs(factor):.4f}", f"{phase(factor):.4f}"]
            for X, factor in zip(
                preload_map.amplitudes.tolist(), preload_map.amplitude_factor.tolist(), strict=True)
        )])  # fmt: skip
    lines += table([list(PAIR_HEAD), *(list(list_pair_cells(test)) for test in preload_map.pairs)])
    if preload_map.resonances:
        lines += table([["compression, mm", "resonance, Hz", "95 % interval", "damping ratio"], *(
            [f"{convert_to_unit(cell.compression, 'mm'):.4g}", value, f"{low} to {high}",
             format_rounded(cell.damping, digits=3)]
            for cell in preload_map.resonances
            for value, low, high in [cell.reported_frequency.cell_texts]
        )])  # fmt: skip
    settings = [list(SETTING_HEAD), *(list(list_setting_cells(cell)) for cell in preload_map.cells)]
    return Text(lines, table(settings))


def describe_map(preload_map: PreloadMap) -> str:
    """Return the ranges of the map, in one line."""
    low, high = preload_map.band
    parts = [f"{low:.4g} to {high:.4g} Hz", f"{len(preload_map.compressions)} compressions"]
    if len(preload_map.amplitudes):
        count = len(preload_map.amplitudes)
        parts.append(f"{count} amplitude" + ("s" if count > 1 else ""))
    count = len(preload_map.model.tau)
    parts.append(f"{count} Maxwell arm" + ("s" if count != 1 else ""))
    return ", ".join(parts)


def list_setting_cells(cell: MapCell) -> tuple[str, ...]:
    """Return the cells of a setting."""
    return (
        f"{convert_to_unit(cell.compression, 'mm'):.4g}",
        "" if cell.amplitude is None else f"{convert_to_unit(cell.amplitude, 'mm'):.4g}",
        str(cell.sweeps), str(cell.lines), format_rounded(100 * cell.residual, digits=2),
    )  # fmt: skip


def list_pair_cells(test: PairTest) -> tuple[str, ...]:
    """Return the cells of a tested pair."""
    if test.is_separable is None:
        return (test.pair, "not tested", "", "", "", "")
    return (
        test.pair,
        "yes" if test.is_separable else "no",
        test.shown_chance,
        f"{100 * (test.departure or 0):.2g} %",
        f"{100 * (test.departure_limit or 0):.2g} %",
        f"{test.angle_limit or 0:.2g}",
    )
