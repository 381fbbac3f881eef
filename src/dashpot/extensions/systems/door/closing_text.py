"""Closing of a door, as text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import format_rounded

if TYPE_CHECKING:
    from dashpot.extensions.systems.door.closing_analysis import ClosingAnalysis
    from dashpot.extensions.systems.door.closing_result import ClosingResult


def render_closing(closing: ClosingResult) -> Text:
    """Return how a door closes."""
    return closing_text(closing.closing)


def closing_text(value: ClosingAnalysis) -> Text:
    """Return the outcome, its energy by terms, the least speed and how it scatters."""
    lines = [
        (
            f"  {format_rounded(value.speed)} m/s at the edge, {format_rounded(value.door.edge)} m "
            f"from the hinges: {format_rounded(value.energy)} J (I = "
            f"{format_rounded(value.door.inertia)} kg m^2)"
        ),
        _format_outcome(value),
        _format_least_speed(value),
    ]
    compressions = value.door.compression
    force = value.door.section.force(compressions)
    lines.append(
        "  Closed, the seal is compressed by at least "
        f"{format_rounded(convert_to_unit(float(compressions.min()), 'mm'), digits=3)} mm, with "
        f"{format_rounded(float(force.min()), digits=3)} N/m after relaxation."
    )
    lines += _format_scatter(value)
    rows = [["term", "J", "% of all", "recoverable, J", "highest moment, N m"]]
    total_work = sum(term.work for term in value.terms)
    for energy_term in value.terms:
        rows.append(
            [
                energy_term.name,
                format_rounded(energy_term.work, digits=3),
                f"{100 * energy_term.work / total_work:.1f}" if total_work > 0 else "",
                ""
                if math.isnan(energy_term.stored)
                else format_rounded(energy_term.stored, digits=3),
                format_rounded(energy_term.peak_moment, digits=3),
            ]
        )
    rows.append(["all", format_rounded(total_work, digits=3), "", "", ""])
    peaks = ", ".join(
        f"{name} {format_rounded(float(values.max()), digits=3)} Pa"
        for name, values in value.march.pressure.items()
    )
    return Text([*lines, *table(rows), *([f"  highest pressure: {peaks}"] if peaks else [])])


def _format_outcome(closing: ClosingAnalysis) -> str:
    if closing.is_latched:
        return (
            f"  The door closes in {format_rounded(closing.seconds, digits=3)} s; the last "
            f"{format_rounded(convert_to_unit(closing.sealing, 'ms'), digits=3)} ms compress the "
            f"seal. {format_rounded(closing.remaining_energy, digits=3)} J are left when it "
            "latches."
        )
    return (
        "  The door does not close. Its edge stops "
        f"{format_rounded(convert_to_unit(closing.stopped_gap or 0.0, 'mm'), digits=3)} mm short "
        f"and comes back at {format_rounded(closing.rebound, digits=3)} m/s."
    )


def _format_least_speed(closing: ClosingAnalysis) -> str:
    if not math.isfinite(closing.minimum):
        return "  No speed closes it."
    if closing.minimum == 0:
        return "  It closes by itself."
    name = ""
    if closing.interval is not None:
        low, high = (format_rounded(value, digits=3) for value in closing.interval)
        name = (
            f" ({low} to {high} by the test of the seal)"
            if math.isfinite(closing.interval[1])
            else f" ({low} or more: the test sets no upper limit to a seal so fast)"
        )
    return f"  Least closing speed: {format_rounded(closing.minimum)} m/s{name}"


def _format_scatter(closing: ClosingAnalysis) -> list[str]:
    scatter = closing.scatter
    if scatter is None:
        return []
    variation = scatter.variation
    correlation_text = (
        "the same all along"
        if variation.correlation is None
        else f"the same over {format_rounded(variation.correlation)} m"
    )
    low, middle, high = (scatter.quantile(part) for part in (0.05, 0.5, 0.95))
    sentences = [
        (
            f"  {variation.count} doors, gap ±{format_quantity(variation.gap, 'mm', '.3g')} "
            f"{correlation_text}, force of the "
            f"seal ±{100 * variation.load:.3g} % (three standard deviations, seed "
            f"{variation.seed}):"
        ),
        (
            f"  least speed {format_rounded(low, digits=3)}, {format_rounded(middle, digits=3)}, "
            f"{format_rounded(high, digits=3)} m/s (5, 50, 95 %); in "
            f"{format_rounded(100 * scatter.share_leaking, digits=3)} % the seal does not touch "
            "all along"
        ),
    ]
    if scatter.share_above_limit is not None:
        sentences.append(
            f"  {format_rounded(100 * scatter.share_above_limit, digits=3)} % need more than "
            f"{format_rounded(variation.limit or 0.0)} m/s"
        )
    return sentences
