"""Compression load deflection as text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from dashpot import workflow
from dashpot.base.number_format import ascii_only
from dashpot.base.units import convert_to_unit, format_quantity, get_display_unit
from dashpot.extensions.materials.cld.datamodel import format_hysteresis
from dashpot.text_output import results as text_of
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import cell, format_rounded, with_error

if TYPE_CHECKING:
    from dashpot.extensions.batch.statistics.process_capability import Capability
    from dashpot.extensions.materials.cld.fit_files import PieceStatistics


def cld(found: workflow.Pieces) -> Text:
    """The figures of each piece, then of all; the cycles for who asks."""
    lines, details = [], []
    for one in found.pieces:
        name = "" if one.source is None else one.source.file
        lines += [f"{name}: cycle {one.cycle.number} of {len(one.cycles)}", *_piece(one)]
        details += [f"{name}, every cycle", *_cycles(one)]
    if found.scatter:
        scatter = [f"{len(found.pieces)} pieces", *_scatter(found.scatter)]
        # one piece a row says more than a block each
        lines = [*(_overview(found) if len(found.pieces) > _BLOCKS else lines), *scatter]
    lines += _capability(found.capability)
    if found.fit is not None and found.relaxed is None:
        fitted = text_of.fit(found.fit)
        lines = [*_overview(found), *fitted.lines]
        details += fitted.details
    if found.rate is not None:
        lines += [_choice(found.rate)]
        # of a law that explains the speeds worse the numbers are for who asks
        (details if found.rate.bic > 0 else lines).extend(_rate(found.rate))
    if found.relaxed is not None:
        lines += _format_relaxed_law(found.relaxed, found.pieces[0])
    return Text(lines, details)


def _scatter(found: Sequence[PieceStatistics]) -> list[str]:
    rows = [["", "mean", "deviation", "cv, %", "unit"]]
    for each in found:
        unit = get_display_unit(each.unit) or "%"
        cv = format_rounded(100 * each.deviation / each.mean) if each.mean else ""
        told = (format_rounded(convert_to_unit(one, unit)) for one in (each.mean, each.deviation))
        rows.append([each.name, *told, cv, unit])
    return table(rows)


def _capability(found: Capability | None) -> list[str]:
    if found is None or found.cpk is None:
        return []
    return [f"  {found.says}, {found.outside} of {found.count} outside"]


def _choice(rate: workflow.RateLaw) -> str:
    better = "better" if rate.bic < 0 else "worse"
    return (
        f"  A spring and a dashpot that depend on compression explain the speeds {better} than one "
        f"memory (BIC {rate.bic:+.3g})."
    )


def _rate(rate: workflow.RateLaw) -> list[str]:
    rows = [["F_e + c(x) v, mm", "force, N", "tangent, N/mm", "c, N s/m"]]
    for knot in rate.knots[1:]:
        c, error = rate.c(knot)
        law, k = rate.law, rate.law.stiffness
        stiff, off = (float(k * each(knot)) for each in (law.factor, law.factor_se))
        rows.append(
            [
                cell(knot, "mm"),
                format_rounded(float(law.force(knot))),
                with_error(stiff, off, "N/m"),
                with_error(c, error) if c > 2 * error else f"below {c + 2 * error:.2g}",
            ]
        )
    arms = ", ".join(
        f"{with_error(k, se, 'N/m')} N/mm over {with_error(tau, tau * wide)} s"
        for k, tau, se, wide in zip(rate.k, rate.tau, rate.k_se, rate.ln_tau_se, strict=True)
    )
    return [*table(rows), f"  arms beside it: {arms or 'none'}"]


def _format_relaxed_law(found: workflow.RelaxedLaw, one: workflow.CLD) -> list[str]:
    law = found.law
    rows = [["relaxed, mm", "force, N", "secant, N/mm", "tangent, N/mm"]]
    for mark in (at.compression for at in one.marked):
        tangent, error = (float(law.stiffness * each(mark)) for each in (law.factor, law.factor_se))
        rows.append(
            [
                cell(mark, "mm"),
                with_error(float(law.force(mark)), found.force_se(mark)),
                cell(float(law.secant(mark)), "N/mm"),
                with_error(tangent, error, "N/m"),
            ]
        )
    said = f"  softer than cycle 1 by {100 * found.softening:.3g} % without the memory"
    if found.left is not None and found.hysteresis is not None:
        said += f"; hysteresis {100 * found.left:.2g} % instead of {100 * found.hysteresis:.3g} %"
    return [*table(rows), said]


_BLOCKS = 2
"""Pieces that are shown one by one."""


def _overview(found: workflow.Pieces) -> list[str]:
    rows = [["", "mm/s", f"{found.unit} at nominal", "hysteresis, %", "set, mm"]]
    for one in found.pieces:
        lost = one.cycle.hysteresis
        rows.append(
            [
                "" if one.source is None else one.source.file,
                cell(one.cycle.speed, "mm/s"),
                with_error(one.per * one.nominal.loading, one.per * one.nominal.loading_se),
                cell(lost, "%", digits=3),
                cell(one.set, "mm", digits=3),
            ]
        )
    return table(rows)


def _piece(one: workflow.CLD) -> list[str]:
    per, of = one.per, one.unit.removeprefix("N")
    rows = [["compression, mm", f"loading, {one.unit}", "unloading", f"slope, N/mm{of}",
             f"energy, mJ{of}"]]  # fmt: skip
    for mark in one.marked:
        back = "" if mark.unloading is None else format_rounded(per * mark.unloading)
        rows.append(
            [
                cell(mark.compression, "mm"),
                with_error(per * mark.loading, per * mark.loading_se),
                back,
                with_error(per * mark.slope, per * mark.slope_se, "N/m"),
                cell(per * mark.energy, "mJ"),
            ]
        )
    cycle, said = one.cycle, []
    if cycle.hysteresis is not None and cycle.returned is not None:
        said.append(
            f"hysteresis {ascii_only(format_hysteresis(cycle))} of "
            f"{format_quantity(per * cycle.energy, 'mJ')}{of}"
        )
    if len(one.cycles) > 1:
        said.append(f"softer than cycle 1 by {100 * one.softening:.3g} %")
    if one.set is not None:
        said.append(f"set {format_quantity(one.set, 'mm', '.3g')} at the next contact")
    if cycle.speed is not None:
        said.append(format_quantity(cycle.speed, "mm/s"))
    if one.time is not None:
        known = format_quantity(one.delay_sd, "ms", ".3g")
        said.append(f"the errors include a delay of 0 ± {known} (dashpot fit --machine sync=0.1ms)")
    return [*table(rows), f"  {'; '.join(said)}"] if said else table(rows)


def _cycles(one: workflow.CLD) -> list[str]:
    rows = [["cycle", "depth, mm", "peak, N", "in, mJ", "back, mJ", "hysteresis, %", "met, mm"]]
    for each in one.cycles:
        lost, back = each.hysteresis, each.returned
        rows.append(
            [
                str(each.number),
                cell(each.depth, "mm"),
                format_rounded(each.peak),
                cell(each.energy, "mJ"),
                cell(back, "mJ"),
                cell(lost, "%"),
                cell(each.contact, "mm"),
            ]
        )
    return table(rows)
