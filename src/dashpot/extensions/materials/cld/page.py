"""Page of compression load deflection tests."""

from __future__ import annotations

from collections.abc import Iterator

from dashpot import plot
from dashpot.base.number_format import format_count, round_to_error
from dashpot.base.provenance import list_sources
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.materials.cld.fit_files import CLDResult
from dashpot.report.first_screen import NBSP, Row
from dashpot.report.result_page import (
    CollapsibleSection,
    Group,
    KindPage,
    Topic,
    format_specimen_header,
    make_indicators,
    row,
)
from dashpot.report.tables import TextTable


def page(result: CLDResult) -> KindPage:
    """Return the page of one specimen or of several."""
    first, specimen_count = result.specimens[0], len(result.specimens)
    sources = list_sources(result.specimens)
    capability = result.capability
    text = "no limits given" if capability is None else capability.summary
    topics = [
        Topic("Specimens", {"specimens_tested_alike"}, f"{specimen_count} tested alike"),
        Topic("Capability", {"specimens_capable"}, text, text),
    ]
    asked_for = [("Nominal", format_quantity(first.nominal.compression, "mm"))]
    if first.least is not None and first.most is not None:
        compressions_text = " to ".join(
            f"{convert_to_unit(point.compression, 'mm'):.4g}" for point in (first.least, first.most)
        )
        asked_for.append(("Tolerance", f"{compressions_text} mm"))
    length = first.specimen.length
    asked_for.append(("Length", "not given" if length is None else format_quantity(length, "mm")))
    limits = None if capability is None else (capability.lower, capability.upper)
    return KindPage(
        subject=f"compression load deflection, {format_count(specimen_count, 'specimen')}",
        summary_line=(
            *format_specimen_header(first.specimen),
            *asked_for,
            ("Specimens", str(specimen_count)),
        ),
        indicators=make_indicators(result.checks, Topic("Records"), *topics[specimen_count < 2 :]),
        figure_title="Pressed and released",
        picture=plot.cld(result.specimens, limits=limits),
        table_title=f"Of {'100 mm' if length is not None else 'the specimen'}"
        + (f", mean of {format_count(specimen_count, 'specimen')}" if specimen_count > 1 else ""),
        groups=(Group("", tuple(_make_specimen_rows(result))),),
        note=(
            "From and to: 95 % interval of the mean of "
            f"{format_count(specimen_count, 'specimen')}."
        )
        if specimen_count > 1 else KindPage.note,
        sources=sources,
        collapsible_sections=(
            CollapsibleSection(
                "Each specimen and cycle",
                "force, slope, hysteresis, set; one row a cycle",
                _make_cycle_table(result),
            ),
        ),
    )  # fmt: skip


def _make_specimen_rows(result: CLDResult) -> Iterator[Row]:
    """Mean of each figure with its interval; of one specimen its own."""
    if result.scatter:
        for statistics in result.scatter:
            reported_value = statistics.fact
            # what is of 100 mm stands in the heading
            unit = reported_value.word.partition(" per ")[0]
            yield row(reported_value, statistics.name.capitalize())._replace(unit=unit)
        return
    cld = result.specimens[0]
    for mark in cld.limit_marks:
        compression_text = format_quantity(mark.compression, "mm", ".4g").replace(" ", NBSP)
        force = ReportedValue.from_error(
            "", cld.per * mark.loading, cld.per * mark.loading_se, unit="N"
        )
        slope = ReportedValue.from_error(
            "", cld.per * mark.slope, cld.per * mark.slope_se, unit="N/m"
        )
        yield row(force, f"Force at {compression_text}")
        yield row(slope, f"Slope at {compression_text}")
    if cld.cycle.hysteresis is not None:
        yield row(ReportedValue("", cld.cycle.hysteresis, unit="1", read="%"), "Hysteresis")
    if cld.set is not None:
        yield row(ReportedValue("", cld.set, unit="m"), "Set")


def _make_cycle_table(result: CLDResult) -> TextTable:
    rows = []
    for specimen in result.specimens:
        name = "" if specimen.source is None else specimen.source.file
        for cycle in specimen.cycles:
            loss_ratio, contact = cycle.hysteresis, cycle.contact
            rows.append(
                (
                    name,
                    str(cycle.number),
                    round_to_error(convert_to_unit(cycle.depth, "mm")),
                    round_to_error(cycle.peak),
                    round_to_error(convert_to_unit(cycle.energy, "mJ")),
                    "" if loss_ratio is None else round_to_error(100 * loss_ratio, digits=3),
                    ""
                    if contact is None
                    else round_to_error(convert_to_unit(contact, "mm"), digits=3),
                )
            )
    header = (
        "specimen", "cycle", "depth, mm", "peak, N", "energy, mJ", "hysteresis, %", "contact, mm",
    )  # fmt: skip
    return TextTable(header, tuple(rows))
