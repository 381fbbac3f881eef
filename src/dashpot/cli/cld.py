"""dashpot cld: compression load deflection of one piece or several."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.errors import ReadError
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._options import Range, WithUnit
from dashpot.cli._shell import File, Outcome, printed, reports, write, write_figure
from dashpot.cli._terminal import Text
from dashpot.cli._text import rounded, table, with_error

if TYPE_CHECKING:
    from dashpot.base.capability import Capability
    from dashpot.kinds.cld.from_files import PieceStatistics


@click.command("cld")
@click.argument("files", type=File(), nargs=-1, required=True, metavar="FILE...")
@click.option(
    "--at", type=WithUnit("length"), help="Nominal compression, e.g. 6mm [default: the deepest]."
)
@click.option("--between", type=Range("length"), help="Its tolerance, e.g. 4:8mm.")
@click.option(
    "--limits",
    type=Range("force"),
    help="Of the force there, over several pieces, e.g. 4.5:5.5N; of 100 mm with --length.",
)
@click.option(
    "--with",
    "memory",
    type=File(),
    metavar="FIT",
    multiple=True,
    help="Of a relaxation test: its memory is taken off, which leaves the elastic law. Once for "
    "each depth that was held: the nearest tells the memory, all are held against the law.",
)
@options.output("Write that fit with the elastic law, or that of several speeds, as JSON.", ".json")
@options.picture
@options.overwrite
@reports
@options.specimen
@options.reading
def command(
    *,
    files: tuple[str, ...],
    memory: tuple[str, ...],
    output: str | None,
    picture: str | None,
    **choices: Any,
) -> Outcome:
    """Find force, slope, hysteresis, energy and set of a seal that is pressed and released.

    A FILE holds displacement and force of one piece, in one cycle or several, with a clock or
    without. Several are pieces that scatter; at several speeds they are one seal, whose elastic law
    and memory are fitted.

    \b
    dashpot cld piece.csv --length 100mm --at 6mm --between 4:8mm
    dashpot cld piece1.csv piece2.csv piece3.csv --length 100mm --at 6mm --limits 4.5:5.5N
    dashpot cld slow.csv fast.csv --at 6mm -o law.json
    dashpot cld piece.csv --at 6mm --with fit.json -o fit_with_law.json
    """
    found = workflow.cld_files(files, memory=[workflow.read_fit(one) for one in memory], **choices)
    if output:
        if found.fit is None:
            raise ReadError(
                "-o writes a fit: that of a relaxation test (--with), with the elastic law of the "
                "load deflection, or that of records at several speeds; here is neither"
            )
        write(output, printed(found.fit) + "\n")
    if picture:
        write_figure(picture, dp.plot.cld(found.pieces))
    return Outcome(found, _said(found), found.checks, verdict=found.verdict)


def _said(found: workflow.Pieces) -> Text:
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
        fitted = _text.fit(found.fit)
        lines = [*_overview(found), *fitted.lines]
        details += fitted.details
    if found.rate is not None:
        lines += [_choice(found.rate)]
        # of a law that explains the speeds worse the numbers are for who asks
        (details if found.rate.bic > 0 else lines).extend(_rate(found.rate))
    if found.relaxed is not None:
        lines += _relaxed(found.relaxed, found.pieces[0])
    return Text(lines, details)


def _scatter(found: Sequence[PieceStatistics]) -> list[str]:
    rows = [["", "mean", "deviation", "cv, %", "unit"]]
    for each in found:
        word, of, length = each.unit.partition(" per ")
        unit, scale = _SHOWN.get(word, (word, 1.0))
        cv = rounded(100 * each.deviation / each.mean) if each.mean else ""
        mean, deviation = rounded(scale * each.mean), rounded(scale * each.deviation)
        rows.append([each.name, mean, deviation, cv, unit + of + length])
    return table(rows)


def _capability(found: Capability | None) -> list[str]:
    if found is None or found.cpk is None:
        return []
    low, high = found.cpk_interval or (0.0, 0.0)
    outside = f"{found.outside} of {found.count} outside"
    return [f"  Cpk {found.cpk:.2f} ({low:.2f} to {high:.2f}), {outside}"]


def _choice(rate: dp.RateLaw) -> str:
    better = "better" if rate.bic < 0 else "worse"
    return (
        f"  a spring and a dashpot that depend on compression explain the speeds {better} than one "
        f"memory does, BIC {rate.bic:+.3g}"
    )


def _rate(rate: dp.RateLaw) -> list[str]:
    rows = [["F_e + c(x) v, mm", "force, N", "tangent, N/mm", "c, N s/m"]]
    for knot in rate.knots[1:]:
        c, error = rate.c(knot)
        stiff, off = (float(each(knot)) for each in (rate.law.factor, rate.law.factor_se))
        scale = 1e-3 * rate.law.stiffness
        rows.append(
            [
                rounded(1e3 * knot),
                rounded(float(rate.law.force(knot))),
                with_error(scale * stiff, scale * off),
                with_error(c, error) if c > 2 * error else f"below {c + 2 * error:.2g}",
            ]
        )
    arms = ", ".join(
        f"{with_error(1e-3 * k, 1e-3 * se)} N/mm over {with_error(tau, tau * wide)} s"
        for k, tau, se, wide in zip(rate.k, rate.tau, rate.k_se, rate.ln_tau_se, strict=True)
    )
    return [*table(rows), f"  arms beside it: {arms or 'none'}"]


def _relaxed(found: dp.RelaxedLaw, one: dp.CLD) -> list[str]:
    law = found.law
    rows = [["relaxed, mm", "force, N", "secant, N/mm", "tangent, N/mm"]]
    for mark in (at.compression for at in one.marked):
        tangent, error = (float(law.stiffness * each(mark)) for each in (law.factor, law.factor_se))
        rows.append(
            [
                rounded(1e3 * mark),
                with_error(float(law.force(mark)), found.force_se(mark)),
                rounded(1e-3 * float(law.secant(mark))),
                with_error(1e-3 * tangent, 1e-3 * error),
            ]
        )
    said = f"  softer than cycle 1 by {100 * found.softening:.3g} % without the memory"
    if found.left is not None and found.hysteresis is not None:
        said += f"; of {100 * found.hysteresis:.3g} % hysteresis {100 * found.left:.2g} % are left"
    return [*table(rows), said]


_BLOCKS = 2
"""Pieces that are shown one by one."""
_SHOWN = {"N/m": ("N/mm", 1e-3), "J": ("mJ", 1e3), "m": ("mm", 1e3), "": ("%", 100.0)}


def _overview(found: workflow.Pieces) -> list[str]:
    rows = [["", "mm/s", f"{found.unit} at nominal", "hysteresis, %", "set, mm"]]
    for one in found.pieces:
        lost = one.cycle.hysteresis
        rows.append(
            [
                "" if one.source is None else one.source.file,
                "" if one.cycle.speed is None else rounded(1e3 * one.cycle.speed),
                with_error(one.per * one.nominal.loading, one.per * one.nominal.loading_se),
                "" if lost is None else rounded(100 * lost, digits=3),
                "" if one.set is None else rounded(1e3 * one.set, digits=3),
            ]
        )
    return table(rows)


def _piece(one: dp.CLD) -> list[str]:
    per, of = one.per, one.unit.removeprefix("N")
    rows = [["compression, mm", f"loading, {one.unit}", "unloading", f"slope, N/mm{of}",
             f"energy, mJ{of}"]]  # fmt: skip
    for mark in one.marked:
        back = "" if mark.unloading is None else rounded(per * mark.unloading)
        rows.append(
            [
                rounded(1e3 * mark.compression),
                with_error(per * mark.loading, per * mark.loading_se),
                back,
                with_error(1e-3 * per * mark.slope, 1e-3 * per * mark.slope_se),
                rounded(1e3 * per * mark.energy),
            ]
        )
    cycle, said = one.cycle, []
    if cycle.hysteresis is not None and cycle.returned is not None:
        said.append(
            f"hysteresis {100 * cycle.hysteresis:.3g} % of {1e3 * per * cycle.energy:.4g} mJ{of}"
        )
    if len(one.cycles) > 1:
        said.append(f"softer than cycle 1 by {100 * one.softening:.3g} %")
    if one.set is not None:
        said.append(f"set {1e3 * one.set:.3g} mm when it was next met")
    if cycle.speed is not None:
        said.append(f"{1e3 * cycle.speed:.4g} mm/s")
    return [*table(rows), f"  {'; '.join(said)}"] if said else table(rows)


def _cycles(one: dp.CLD) -> list[str]:
    rows = [["cycle", "depth, mm", "peak, N", "in, mJ", "back, mJ", "hysteresis, %", "met, mm"]]
    for each in one.cycles:
        lost, back = each.hysteresis, each.returned
        rows.append(
            [
                str(each.number),
                rounded(1e3 * each.depth),
                rounded(each.peak),
                rounded(1e3 * each.energy),
                "" if back is None else rounded(1e3 * back),
                "" if lost is None else rounded(100 * lost),
                "" if each.contact is None else rounded(1e3 * each.contact),
            ]
        )
    return table(rows)
