"""A hyperelastic law as text."""

from __future__ import annotations

import dashpot as dp
from dashpot.text_output.layout import Text, facts, table
from dashpot.text_output.results import format_bic_differences, format_rounded


def hyperelastic(found: dp.HyperelasticFit) -> Text:
    """The law, its constants with their intervals, each curve, and where it is stable."""
    tests = [["", "stretch", "rows", "residual, %"]]
    for curve, left in zip(found.curves, found.residuals, strict=True):
        name = curve.mode if curve.source is None else f"{curve.mode}, {curve.source.file}"
        span = f"{curve.stretch.min():.4g} to {curve.stretch.max():.4g}"
        tests.append([name, span, str(curve.rows), format_rounded(100 * left, digits=3)])
    notes = [
        f"  {one.file}: {note}" for one in found.sources for note in one.notes
    ]  # fmt: skip
    lines = [
        f"  law: {found.law.kind}",
        *facts(found.found),
        *table(tests),
        format_bic_differences(found.orders),
    ]
    return Text(lines, notes)
