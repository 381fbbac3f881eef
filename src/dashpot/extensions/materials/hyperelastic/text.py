"""Hyperelastic law, as text."""

from __future__ import annotations

import dashpot as dp
from dashpot.extensions.materials.law_ranking import format_bic_differences
from dashpot.text_output.layout import Text, format_values, table
from dashpot.text_output.results import format_rounded


def hyperelastic(hyperelastic_fit: dp.HyperelasticFit) -> Text:
    """Return the law, its constants with their intervals, each curve, and its stable range."""
    tests = [["", "stretch", "rows", "residual, %"]]
    for curve, residual in zip(hyperelastic_fit.curves, hyperelastic_fit.residuals, strict=True):
        name = curve.mode if curve.source is None else f"{curve.mode}, {curve.source.file}"
        span = f"{curve.stretch.min():.4g} to {curve.stretch.max():.4g}"
        tests.append([name, span, str(curve.rows), format_rounded(100 * residual, digits=3)])
    notes = [
        f"  {source.file}: {note}" for source in hyperelastic_fit.sources for note in source.notes
    ]  # fmt: skip
    lines = [
        f"  law: {hyperelastic_fit.law.kind}, {hyperelastic_fit.loading_rate}",
        *format_values(hyperelastic_fit.reported_values),
        *table(tests),
        format_bic_differences(hyperelastic_fit.orders),
    ]
    return Text(lines, notes)
