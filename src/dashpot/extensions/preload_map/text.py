"""Preload map, as text."""

from __future__ import annotations

from cmath import phase

from dashpot.base.units import convert_to_unit
from dashpot.extensions.preload_map.preload_map import PreloadMap
from dashpot.extensions.preload_map.separability import PairTest
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import format_rounded

PAIR_HEAD = ("pair", "separable", "probability", "departure", "at most", "of the angle, rad")


def preload_map(found: PreloadMap) -> Text:
    """Return factors, tests of separability, and resonances."""
    lines = [f"  {describe_map(found)}"]
    lines += table([["compression, mm", "factor F_e'(c)"], *(
        [f"{convert_to_unit(c, 'mm'):.4g}", f"{factor:.4f}"]
        for c, factor in zip(
            found.compressions.tolist(), found.compression_factor.tolist(), strict=True)
    )])  # fmt: skip
    if len(found.amplitudes):
        lines += table([["amplitude, mm", "factor s(X)", "angle, rad"], *(
            [f"{convert_to_unit(X, 'mm'):.4g}", f"{abs(factor):.4f}", f"{phase(factor):.4f}"]
            for X, factor in zip(
                found.amplitudes.tolist(), found.amplitude_factor.tolist(), strict=True)
        )])  # fmt: skip
    lines += table([list(PAIR_HEAD), *(list(list_pair_cells(test)) for test in found.pairs)])
    if found.resonances:
        lines += table([["compression, mm", "resonance, Hz", "95 % interval", "damping ratio"], *(
            [f"{convert_to_unit(each.compression, 'mm'):.4g}", f"{each.frequency:.4f}",
             " to ".join(format_rounded(end) for end in each.frequency_limits),
             format_rounded(each.damping, digits=3)]
            for each in found.resonances
        )])  # fmt: skip
    details = [["compression, mm", "amplitude, mm", "sweeps", "lines", "residual, %"]]
    details += [
        [f"{convert_to_unit(cell.compression, 'mm'):.4g}",
         "" if cell.amplitude is None else f"{convert_to_unit(cell.amplitude, 'mm'):.4g}",
         str(cell.sweeps), str(cell.lines), format_rounded(100 * cell.residual, digits=2)]
        for cell in found.cells
    ]  # fmt: skip
    return Text(lines, table(details))


def describe_map(found: PreloadMap) -> str:
    """Return what the map spans, in one line."""
    low, high = found.band
    parts = [f"{low:.4g} to {high:.4g} Hz", f"{len(found.compressions)} compressions"]
    if len(found.amplitudes):
        count = len(found.amplitudes)
        parts.append(f"{count} amplitude" + ("s" if count > 1 else ""))
    count = len(found.model.tau)
    parts.append(f"{count} Maxwell arm" + ("s" if count != 1 else ""))
    return ", ".join(parts)


def list_pair_cells(test: PairTest) -> tuple[str, ...]:
    """Return the cells of a tested pair."""
    if not test.tested or test.chance is None:
        return (test.pair, "not tested", "", "", "", "")
    return (
        test.pair,
        "yes" if test.chance >= _CHANCE else "no",
        test.shown_chance,
        f"{100 * (test.departure or 0):.2g} %",
        f"{100 * (test.departure_limit or 0):.2g} %",
        f"{test.angle_limit or 0:.2g}",
    )


_CHANCE = 0.01
