"""Transfer stiffness of a mount, as text."""

from __future__ import annotations

from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.transfer_stiffness.checks import MIN_BLOCKED_DIFFERENCE
from dashpot.extensions.transfer_stiffness.stiffness_sheet import (
    BandStiffness,
    TransferStiffness,
)
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import format_rounded

_HEAD = ("Hz", "|k|, N/mm", "95 % interval", "dB re 1 N/m", "loss factor", "95 % interval")


def render_transfer_stiffness(sheet: TransferStiffness) -> Text:
    """Return the method and the table of third octaves."""
    lines = [f"  {describe_method(sheet)}"]
    if sheet.transmissibility is not None:
        start = sheet.valid_from
        range_text = "nowhere" if start is None else f"from {start:.4g} Hz on"
        lines.append(
            f"  the output moves {MIN_BLOCKED_DIFFERENCE:g} dB less than the input {range_text}"
        )
    has_output = sheet.transmissibility is not None
    # a prediction needs no blocked output: "valid" would be read as the valid band of its fit
    has_limits = has_output and sheet.method != "predicted"
    header = [*_HEAD, *(["blocked, dB"] if has_output else []), *(["valid"] if has_limits else [])]
    rows = (_format_row(band, has_output=has_output, is_checked=has_limits) for band in sheet.bands)
    lines += table([header, *rows])
    lines += [f"  {sheet.interval_note}"] if sheet.interval_note else []
    details = [["Hz", "dB re 1 N/m", "95 % interval", "indirect formula, dB", "lines"]]
    details += [
        [
            f"{band.centre:g}", f"{band.level:.4f}",
            " to ".join(f"{end:.3f}" for end in band.level_limits),
            "" if band.indirect_level is None else f"{band.indirect_level:.3f}", str(band.lines),
        ]
        for band in sheet.bands
    ]  # fmt: skip
    return Text(lines, table(details))


def describe_method(sheet: TransferStiffness) -> str:
    """Return the method, its masses and its formula in one line."""
    words = {
        "direct": "direct method, blocked force over input displacement",
        "indirect": "indirect method, blocking mass",
        "predicted": "predicted from the fit",
    }[sheet.method]
    parts = [words]
    if sheet.mass is not None:
        parts.append(f"m2 {format_quantity(sheet.mass, 'kg')}")
    if sheet.flange_mass:
        parts.append(f"flange {format_quantity(sheet.flange_mass, 'g')}")
    if sheet.seals != 1:
        parts.append(f"{sheet.seals:g} in parallel")
    if sheet.preload is not None:
        parts.append(f"preload {format_quantity(sheet.preload, 'N')}")
    if sheet.exact:
        parts.append("exact formula")
    return ", ".join(parts)


def _format_row(band: BandStiffness, *, has_output: bool, is_checked: bool) -> list[str]:
    low, high = (format_rounded(convert_to_unit(end, "N/mm"), digits=3) for end in band.limits)
    cells = [
        f"{band.centre:g}",
        format_rounded(convert_to_unit(band.stiffness, "N/mm"), digits=3),
        f"{low} to {high}",
        f"{band.level:.2f}",
        format_rounded(band.loss_factor, digits=3),
        " to ".join(format_rounded(end, digits=2) for end in band.loss_factor_limits),
    ]
    if has_output:
        gap = band.level_difference
        cells.append("" if gap is None else f"{gap:.1f}")
    if is_checked:
        cells.append("yes" if band.valid else "no")
    return cells
