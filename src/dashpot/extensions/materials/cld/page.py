"""The page of pieces that were pressed and released."""

from __future__ import annotations

from collections.abc import Iterator

from dashpot import plot
from dashpot.base.number_format import format_count, round_to_error
from dashpot.base.provenance import sources_of
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.materials.cld.fit_files import Pieces
from dashpot.report.first_screen import NBSP, Row
from dashpot.report.page_content import (
    CollapsibleSection,
    Group,
    KindPage,
    Topic,
    format_specimen_header,
    lights,
    row,
)
from dashpot.report.tables import TextTable


def page(found: Pieces) -> KindPage:
    """What the page of one piece or of several holds."""
    first, several = found.pieces[0], len(found.pieces)
    sources = sources_of(found.pieces)
    able = found.capability
    said = "no limits given" if able is None else able.says
    asked = [
        Topic("Pieces", {"pieces_tested_alike"}, f"{several} tested alike"),
        Topic("Capability", {"pieces_capable"}, said, said),
    ]
    asked_for = [("Nominal", format_quantity(first.nominal.compression, "mm"))]
    if first.least is not None and first.most is not None:
        ends = " to ".join(
            f"{convert_to_unit(one.compression, 'mm'):.4g}" for one in (first.least, first.most)
        )
        asked_for.append(("Tolerance", f"{ends} mm"))
    length = first.specimen.length
    asked_for.append(("Length", "not given" if length is None else format_quantity(length, "mm")))
    limits = None if able is None else (able.lower, able.upper)
    return KindPage(
        about=f"compression load deflection, {format_count(several, 'piece')}",
        strip=(*format_specimen_header(first.specimen), *asked_for, ("Pieces", str(several))),
        lights=lights(found.checks, Topic("Records"), *asked[several < 2 :]),
        answers="Pressed and released",
        picture=plot.cld(found.pieces, limits=limits),
        told=f"Of {'100 mm' if length is not None else 'the piece'}"
        + (f", mean of {format_count(several, 'piece')}" if several > 1 else ""),
        groups=(Group("", tuple(_make_piece_rows(found))),),
        note=f"From and to: 95 % interval of the mean of {format_count(several, 'piece')}."
        if several > 1 else KindPage.note,
        sources=sources,
        folds=(CollapsibleSection("Each piece and cycle", "force, slope, hysteresis, set; one row "
                                                          "a cycle",
                    _cycles(found)),),
    )  # fmt: skip


def _make_piece_rows(found: Pieces) -> Iterator[Row]:
    """Mean of each figure with its interval; of one piece its own."""
    if found.scatter:
        for each in found.scatter:
            fact = each.fact
            # what is of 100 mm stands in the heading
            unit = fact.word.partition(" per ")[0]
            yield row(fact, each.name.capitalize())._replace(unit=unit)
        return
    one = found.pieces[0]
    for at in one.marked:
        where = format_quantity(at.compression, "mm", ".4g").replace(" ", NBSP)
        force = ReportedValue.known("", one.per * at.loading, one.per * at.loading_se, unit="N")
        slope = ReportedValue.known("", one.per * at.slope, one.per * at.slope_se, unit="N/m")
        yield row(force, f"Force at {where}")
        yield row(slope, f"Slope at {where}")
    if one.cycle.hysteresis is not None:
        yield row(ReportedValue("", one.cycle.hysteresis, unit="1", read="%"), "Hysteresis")
    if one.set is not None:
        yield row(ReportedValue("", one.set, unit="m"), "Set")


def _cycles(found: Pieces) -> TextTable:
    rows = []
    for one in found.pieces:
        name = "" if one.source is None else one.source.file
        for each in one.cycles:
            lost, met = each.hysteresis, each.contact
            rows.append(
                (
                    name,
                    str(each.number),
                    round_to_error(convert_to_unit(each.depth, "mm")),
                    round_to_error(each.peak),
                    round_to_error(convert_to_unit(each.energy, "mJ")),
                    "" if lost is None else round_to_error(100 * lost, digits=3),
                    "" if met is None else round_to_error(convert_to_unit(met, "mm"), digits=3),
                )
            )
    head = ("piece", "cycle", "depth, mm", "peak, N", "energy, mJ", "hysteresis, %", "met, mm")
    return TextTable(head, tuple(rows))
