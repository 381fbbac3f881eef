"""Page of a transfer stiffness."""

from __future__ import annotations

from dashpot.base.number_format import round_to_error
from dashpot.base.units import celsius, convert_to_unit, format_quantity
from dashpot.extensions.transfer_stiffness.stiffness_sheet import TransferStiffness
from dashpot.extensions.transfer_stiffness.text import describe_method
from dashpot.report.first_screen import NOT_GIVEN
from dashpot.report.result_page import CollapsibleSection, KindPage, Topic, group, make_indicators
from dashpot.report.tables import TextTable, describe_rows, select_rows

_ROWS = 200
"""Lines in the table, at most; every one stands in the document."""


def page(sheet: TransferStiffness) -> KindPage:
    """Return the page of a transfer stiffness."""
    level = f"{sheet.bands[0].level:.2f} to {sheet.bands[-1].level:.2f} dB"
    start, indices = sheet.valid_from, select_rows(len(sheet.frequency), _ROWS)
    valid = (
        "not known"
        if sheet.transmissibility is None
        else ("nowhere" if start is None else f"from {start:.3g} Hz")
    )
    if sheet.rigid_to is not None:
        valid += f" to {sheet.rigid_to:.4g} Hz"
    return KindPage(
        subject="dynamic transfer stiffness",
        summary_line=(
            ("Method", describe_method(sheet)),
            ("Preload", NOT_GIVEN if sheet.preload is None
                else format_quantity(sheet.preload, "N")),
            ("Temperature", NOT_GIVEN if sheet.temperature is None
                else celsius(sheet.temperature)),
            ("Output blocked", valid),
        ),
        indicators=make_indicators(
            sheet.checks,
            Topic("Records"),
            Topic("Level", {"level_determined", "third_octaves_resolved"}, level),
            Topic("Method", {
                "output_blocked", "errors_not_magnified", "flange_inertia_negligible",
                "blocking_mass_rigid", "third_octaves_in_valid_band"}),
            Topic("Mount", {"mount_dissipates", "mount_acts_as_spring"}, "a spring with loss"),
        ),
        figure_title="Transfer stiffness and loss factor over frequency",
        picture=sheet.plot(),
        table_title="Transfer stiffness in third octaves",
        groups=(group("", sheet.facts),),
        sources=sheet.source,
        note=f"{KindPage.note} {sheet.interval_note}".rstrip(),
        collapsible_sections=(
            CollapsibleSection("Third octaves", _describe_bands(sheet), _make_band_table(sheet)),
            CollapsibleSection(
                "Lines", describe_rows(indices, "lines"), _make_line_table(sheet, indices)
            ),
        ),
        name="transfer-stiffness",
    )  # fmt: skip


def _describe_bands(sheet: TransferStiffness) -> str:
    return "level, loss factor" + ("" if sheet.method == "predicted" else ", validity")


def _make_band_table(sheet: TransferStiffness) -> TextTable:
    has_limits = sheet.method != "predicted"
    header = (
        "Hz", "lines", "dB re 1 N/m", "from", "to", "loss factor", "from", "to",
        "blocked by, dB", "indirect formula, dB", *(("valid",) if has_limits else ()),
    )  # fmt: skip
    rows = []
    for band in sheet.bands:
        gap, formula = band.level_difference, band.indirect_level
        rows.append((
            f"{band.centre:g}", str(band.lines), f"{band.level:.2f}",
            *(f"{end:.2f}" for end in band.level_limits),
            round_to_error(band.loss_factor, digits=3),
            *(round_to_error(end, digits=3) for end in band.loss_factor_limits),
            "" if gap is None else f"{gap:.1f}",
            "" if formula is None else f"{formula:.2f}",
            *(("yes" if band.valid else "no",) if has_limits else ()),
        ))  # fmt: skip
    return TextTable(
        header, tuple(rows), tuple("" if band.valid else "doubt" for band in sheet.bands)
    )


def _make_line_table(sheet: TransferStiffness, indices: range) -> TextTable:
    rows = tuple(
        (
            f"{sheet.frequency[i]:.5g}",
            *(f"{convert_to_unit(value, 'N/mm'):.5g}" for value in (
                float(sheet.value.real[i]), float(sheet.value.imag[i]))),
            f"{sheet.level[i]:.2f}",
            f"{sheet.loss_factor[i]:.4g}",
        )
        for i in indices
    )  # fmt: skip
    return TextTable(("Hz", "k', N/mm", "k'', N/mm", "dB re 1 N/m", "loss factor"), rows)
