"""The page of pieces that were pressed and released."""

from __future__ import annotations

from collections.abc import Iterator

from dashpot import plot
from dashpot.base.number_format import counted, rounded
from dashpot.base.provenance import sources_of
from dashpot.base.reported_values import Fact
from dashpot.base.units import in_unit, written
from dashpot.extensions.materials.cld.fit_files import Pieces
from dashpot.report.first_screen import NBSP, Row
from dashpot.report.page_content import Fold, Group, KindPage, Topic, lights, row, who
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
    asked_for = [("Nominal", written(first.nominal.compression, "mm"))]
    if first.least is not None and first.most is not None:
        ends = " to ".join(
            f"{in_unit(one.compression, 'mm'):.4g}" for one in (first.least, first.most)
        )
        asked_for.append(("Tolerance", f"{ends} mm"))
    length = first.specimen.length
    asked_for.append(("Length", "not given" if length is None else written(length, "mm")))
    limits = None if able is None else (able.lower, able.upper)
    return KindPage(
        about=f"compression load deflection, {counted(several, 'piece')}",
        strip=(*who(first.specimen), *asked_for, ("Pieces", str(several))),
        lights=lights(found.checks, Topic("Records"), *asked[several < 2 :]),
        answers="Pressed and released",
        picture=plot.cld(found.pieces, limits=limits),
        told=f"Of {'100 mm' if length is not None else 'the piece'}"
        + (f", mean of {counted(several, 'piece')}" if several > 1 else ""),
        groups=(Group("", tuple(_of_pieces(found))),),
        note=f"From and to: 95 % interval of the mean of {counted(several, 'piece')}."
        if several > 1 else KindPage.note,
        sources=sources,
        folds=(Fold("Each piece and cycle", "force, slope, hysteresis, set; one row a cycle",
                    _cycles(found)),),
    )  # fmt: skip


def _of_pieces(found: Pieces) -> Iterator[Row]:
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
        where = written(at.compression, "mm", ".4g").replace(" ", NBSP)
        force = Fact.known("", one.per * at.loading, one.per * at.loading_se, unit="N")
        slope = Fact.known("", one.per * at.slope, one.per * at.slope_se, unit="N/m")
        yield row(force, f"Force at {where}")
        yield row(slope, f"Slope at {where}")
    if one.cycle.hysteresis is not None:
        yield row(Fact("", one.cycle.hysteresis, unit="1", read="%"), "Hysteresis")
    if one.set is not None:
        yield row(Fact("", one.set, unit="m"), "Set")


def _cycles(found: Pieces) -> TextTable:
    rows = []
    for one in found.pieces:
        name = "" if one.source is None else one.source.file
        for each in one.cycles:
            lost, met = each.hysteresis, each.contact
            rows.append((
                name, str(each.number), rounded(in_unit(each.depth, "mm")), rounded(each.peak),
                rounded(in_unit(each.energy, "mJ")),
                "" if lost is None else rounded(100 * lost, digits=3),
                "" if met is None else rounded(in_unit(met, "mm"), digits=3),
            ))  # fmt: skip
    head = ("piece", "cycle", "depth, mm", "peak, N", "energy, mJ", "hysteresis, %", "met, mm")
    return TextTable(head, tuple(rows))
