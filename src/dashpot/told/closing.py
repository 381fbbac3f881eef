"""What is said of a door that closes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dashpot.base.units import in_unit, written
from dashpot.told.layout import Text, table
from dashpot.told.text import rounded

if TYPE_CHECKING:
    from dashpot import Closing


def closing_text(found: Closing) -> Text:
    """The outcome, its energy by terms, the least speed and how it scatters."""
    lines = [
        (
            f"  {rounded(found.speed)} m/s at the edge, {rounded(found.door.edge)} m from the "
            f"hinges: {rounded(found.energy)} J (I = {rounded(found.door.inertia)} kg m^2)"
        ),
        _outcome(found),
        _least(found),
    ]
    pressed = found.door.compression
    force = found.door.section.force(pressed)
    lines.append(
        f"  closed, the seal is pressed {rounded(in_unit(float(pressed.min()), 'mm'), digits=3)} "
        f"mm at least, with {rounded(float(force.min()), digits=3)} N/m when it has relaxed"
    )
    lines += _scatter(found)
    rows = [["term", "J", "% of what is taken", "would give back, J", "highest moment, N m"]]
    taken = sum(one.work for one in found.terms)
    for one in found.terms:
        rows.append(
            [
                one.name,
                rounded(one.work, digits=3),
                f"{100 * one.work / taken:.1f}" if taken > 0 else "",
                "" if math.isnan(one.stored) else rounded(one.stored, digits=3),
                rounded(one.moment, digits=3),
            ]
        )
    rows.append(["all", rounded(taken, digits=3), "", "", ""])
    peaks = ", ".join(
        f"{name} {rounded(float(each.max()), digits=3)} Pa"
        for name, each in found.march.pressure.items()
    )
    return Text([*lines, *table(rows), *([f"  highest pressure: {peaks}"] if peaks else [])])


def _outcome(found: Closing) -> str:
    if found.latched:
        return (
            f"  it closes in {rounded(found.seconds, digits=3)} s, "
            f"{rounded(in_unit(found.sealing, 'ms'), digits=3)} ms of them for nine tenths of its "
            f"seal, with {rounded(found.left, digits=3)} J left"
        )
    return (
        "  it does not close: its edge stops "
        f"{rounded(in_unit(found.stopped or 0.0, 'mm'), digits=3)} mm short and comes back at "
        f"{rounded(found.rebound, digits=3)} m/s"
    )


def _least(found: Closing) -> str:
    if not math.isfinite(found.minimum):
        return "  no speed closes it"
    if found.minimum == 0:
        return "  it closes by itself"
    known = ""
    if found.interval is not None:
        low, high = (rounded(one, digits=3) for one in found.interval)
        known = (
            f"; {low} to {high} as far as the test knows its seal"
            if math.isfinite(found.interval[1])
            else f"; {low} or more: its test does not limit how stiff the seal is so fast"
        )
    return f"  least speed that closes it: {rounded(found.minimum)} m/s{known}"


def _scatter(found: Closing) -> list[str]:
    scatter = found.scatter
    if scatter is None:
        return []
    one = scatter.variation
    alike = (
        "all along alike" if one.correlation is None else f"over {rounded(one.correlation)} m alike"
    )
    low, middle, high = (scatter.quantile(part) for part in (0.05, 0.5, 0.95))
    said = [
        (
            f"  {one.count} doors, gap +-{written(one.gap, 'mm', '.3g')} {alike}, force of the "
            f"seal +-{100 * one.load:.3g} % (three standard deviations, seed {one.seed}):"
        ),
        (
            f"  least speed {rounded(low, digits=3)}, {rounded(middle, digits=3)}, "
            f"{rounded(high, digits=3)} m/s (5, 50, 95 %); the seal of "
            f"{rounded(100 * scatter.leaking, digits=3)} % does not touch all along"
        ),
    ]
    if scatter.above is not None:
        said.append(
            f"  {rounded(100 * scatter.above, digits=3)} % need more than "
            f"{rounded(one.limit or 0.0)} m/s"
        )
    return said
