"""What is said of a door that closes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import format_rounded

if TYPE_CHECKING:
    from dashpot.extensions.door.closing_analysis import Closing
    from dashpot.extensions.door.closing_result import ClosingResult


def render_closing(found: ClosingResult) -> Text:
    """Return how a door closes."""
    return closing_text(found.closing)


def closing_text(found: Closing) -> Text:
    """The outcome, its energy by terms, the least speed and how it scatters."""
    lines = [
        (
            f"  {format_rounded(found.speed)} m/s at the edge, {format_rounded(found.door.edge)} m "
            "from the "
            f"hinges: {format_rounded(found.energy)} J (I = {format_rounded(found.door.inertia)} "
            "kg m^2)"
        ),
        _outcome(found),
        _least(found),
    ]
    pressed = found.door.compression
    force = found.door.section.force(pressed)
    lines.append(
        "  Closed, the seal is compressed by at least "
        f"{format_rounded(convert_to_unit(float(pressed.min()), 'mm'), digits=3)} mm, with "
        f"{format_rounded(float(force.min()), digits=3)} N/m after relaxation."
    )
    lines += _scatter(found)
    rows = [["term", "J", "% of all", "recoverable, J", "highest moment, N m"]]
    taken = sum(one.work for one in found.terms)
    for one in found.terms:
        rows.append(
            [
                one.name,
                format_rounded(one.work, digits=3),
                f"{100 * one.work / taken:.1f}" if taken > 0 else "",
                "" if math.isnan(one.stored) else format_rounded(one.stored, digits=3),
                format_rounded(one.moment, digits=3),
            ]
        )
    rows.append(["all", format_rounded(taken, digits=3), "", "", ""])
    peaks = ", ".join(
        f"{name} {format_rounded(float(each.max()), digits=3)} Pa"
        for name, each in found.march.pressure.items()
    )
    return Text([*lines, *table(rows), *([f"  highest pressure: {peaks}"] if peaks else [])])


def _outcome(found: Closing) -> str:
    if found.latched:
        return (
            f"  The door closes in {format_rounded(found.seconds, digits=3)} s; the last "
            f"{format_rounded(convert_to_unit(found.sealing, 'ms'), digits=3)} ms compress the "
            "seal. "
            f"{format_rounded(found.left, digits=3)} J are left when it latches."
        )
    return (
        "  The door does not close. Its edge stops "
        f"{format_rounded(convert_to_unit(found.stopped or 0.0, 'mm'), digits=3)} mm short and "
        "comes back at "
        f"{format_rounded(found.rebound, digits=3)} m/s."
    )


def _least(found: Closing) -> str:
    if not math.isfinite(found.minimum):
        return "  No speed closes it."
    if found.minimum == 0:
        return "  It closes by itself."
    known = ""
    if found.interval is not None:
        low, high = (format_rounded(one, digits=3) for one in found.interval)
        known = (
            f" ({low} to {high} by the test of the seal)"
            if math.isfinite(found.interval[1])
            else f" ({low} or more: the test sets no upper limit to a seal so fast)"
        )
    return f"  Least closing speed: {format_rounded(found.minimum)} m/s{known}"


def _scatter(found: Closing) -> list[str]:
    scatter = found.scatter
    if scatter is None:
        return []
    one = scatter.variation
    alike = (
        "the same all along"
        if one.correlation is None
        else f"the same over {format_rounded(one.correlation)} m"
    )
    low, middle, high = (scatter.quantile(part) for part in (0.05, 0.5, 0.95))
    said = [
        (
            f"  {one.count} doors, gap ±{format_quantity(one.gap, 'mm', '.3g')} {alike}, force of "
            "the "
            f"seal ±{100 * one.load:.3g} % (three standard deviations, seed {one.seed}):"
        ),
        (
            f"  least speed {format_rounded(low, digits=3)}, {format_rounded(middle, digits=3)}, "
            f"{format_rounded(high, digits=3)} m/s (5, 50, 95 %); in "
            f"{format_rounded(100 * scatter.leaking, digits=3)} % the seal does not touch all along"
        ),
    ]
    if scatter.above is not None:
        said.append(
            f"  {format_rounded(100 * scatter.above, digits=3)} % need more than "
            f"{format_rounded(one.limit or 0.0)} m/s"
        )
    return said
