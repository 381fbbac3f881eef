"""Vibration of a door on its seal, as text."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan

from dashpot.base.units import convert_to_unit
from dashpot.extensions.systems.door.mounts import SEAL
from dashpot.extensions.systems.door.result import DoorResult
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import format_rounded, hertz

_MAX_MODES = 9
"""Number of modes that are listed."""
_ROUNDING = 1e-9
"""Damping that is rounding, %."""


def door(result: DoorResult, *, every: bool = False) -> Text:
    """Return the seal line, the modes with their energy shares, and the response to a base.

    Of many modes only those with the largest share of the seal; `every` shows the share of each
    part.
    """
    lines = _format_line(result)
    if not result.modes:
        return Text([*lines, f"  no mode in {hertz(result.band)}", *_format_shaken(result)])
    parts = list(dict.fromkeys(share.name for mode in result.modes for share in mode.shares))
    numbers = range(len(result.modes))
    first = sorted(sorted(numbers, key=lambda i: -result.modes[i].share(SEAL))[:_MAX_MODES])
    lines += table(_make_mode_rows(result, first, parts if every else []))
    if len(first) < len(numbers):
        lines.append(f"  {len(numbers) - len(first)} more modes, of which the seal has less")
    if every:
        lines.append("  of each part: % of the energy/% of the loss")
    lines += _format_shaken(result)
    details = (
        table(_make_mode_rows(result, numbers, [])) if every or len(first) < len(numbers) else []
    )
    bare_text = f"{', '.join(format_rounded(f) for f in result.bare)} Hz" if result.bare else "none"
    details.append(f"  modes without the seal: {bare_text}")
    details += table([["% of the energy", *parts], *_format_shares(result, parts, loss=False)])
    details += table([["% of the loss", *parts], *_format_shares(result, parts, loss=True)])
    return Text(lines, details)


def _make_mode_rows(
    result: DoorResult, numbers: Sequence[int], parts: Sequence[str]
) -> list[list[str]]:
    """Frequency, damping and shares of some modes: of the seal, or of each of the `parts`."""
    column_titles = [
        "without seal",
        "damping, %",
        "seal: % of energy",
        "% of loss",
        "times above band",
    ]
    rows = [["mode", "Hz", *(("damping, %", *parts) if parts else column_titles)]]
    for i in numbers:
        mode = result.modes[i]
        damped = _format_damping(100 * mode.mode.damping_ratio)
        bare_text = "" if mode.without_seal is None else format_rounded(mode.without_seal, digits=5)
        cells = [
            bare_text, damped, f"{100 * mode.share(SEAL):.3f}",
            f"{100 * mode.loss_share(SEAL):.1f}",
            _format_extrapolation_factor(result, mode.mode.frequency),
        ]  # fmt: skip
        if parts:
            shares = ((mode.share(name), mode.loss_share(name)) for name in parts)
            cells = [
                damped,
                *("/".join(_format_share(100 * part) for part in values) for values in shares),
            ]
        rows.append([str(i + 1), format_rounded(mode.mode.frequency, digits=5), *cells])
    return rows


def _format_share(value: float) -> str:
    """Return a share, %: to a tenth below ten."""
    return f"{value:.1f}" if value < 10 else f"{value:.0f}"


def _format_damping(value: float) -> str:
    """Return a damping ratio as text; rounding counts as none."""
    return format_rounded(value, digits=3) if value > _ROUNDING else "0"


def _format_extrapolation_factor(result: DoorResult, frequency: float) -> str:
    """Return the factor by which a frequency lies outside the valid band, as text."""
    factor = result.extrapolation_factor(frequency)
    return "" if isnan(factor) else "inside" if factor <= 1 else f"{factor:.3g}"


def _format_shares(result: DoorResult, parts: list[str], *, loss: bool) -> list[list[str]]:
    rows = []
    for number, mode in enumerate(result.modes, start=1):
        entries = {share.name: share.loss if loss else share.energy for share in mode.shares}
        total = sum(entries.values()) or 1.0
        rows.append(
            [str(number), *(f"{100 * entries.get(name, 0.0) / total:.2f}" for name in parts)]
        )
    return rows


def _format_line(result: DoorResult) -> list[str]:
    seal = result.seal
    if seal is None:
        return ["  no seal"]
    closed = "closed" if seal.line.is_closed else "open"
    count, stiffness = seal.stations, format_rounded(convert_to_unit(seal.stiffness, "N/mm"))
    length = format_rounded(seal.line.length)
    sentences = [
        f"  seal line {length} m, {closed}, {count} stations, k_inf {stiffness} N/mm in all"
    ]
    if seal.fit is not None:
        sentences[0] += f"; valid band {hertz(seal.fit.band)}"
    stiffness_across, stiffness_along = (
        format_rounded(convert_to_unit(sideway, "N/mm")) for sideway in seal.sideways
    )
    if seal.section.shear.holds:
        sentences.append(
            f"  sideways {stiffness_across} N/mm across the line and {stiffness_along} N/mm along "
            "it in all"
        )
    if seal.slip_limit is not None:
        sentences.append(
            "  its friction sticks sideways up to "
            f"{format_rounded(convert_to_unit(seal.slip_limit, 'mm'), digits=3)} "
            "mm; the modes are of a seal that sticks"
        )
    if seal.compression is not None and seal.force is not None:
        lowest, mean, highest = (
            format_rounded(convert_to_unit(value, "mm"), digits=3) for value in seal.compression
        )
        sentences.append(
            f"  compressed by {lowest} to {highest} mm (mean {mean}); {format_rounded(seal.force)} "
            "N in all after relaxation"
        )
    return sentences


def _format_shaken(result: DoorResult) -> list[str]:
    if not result.random:
        return []
    rows = [["base shakes: rms", "m/s^2", "mm to the body", "without seal, m/s^2", "mm"]]
    for response in result.random:
        bare_response = response.bare
        rows.append(
            [
                response.name,
                format_rounded(response.sealed.acceleration),
                format_rounded(convert_to_unit(response.sealed.stretch, "mm")),
                "not damped"
                if bare_response is None
                else format_rounded(bare_response.acceleration),
                ""
                if bare_response is None
                else format_rounded(convert_to_unit(bare_response.stretch, "mm")),
            ]
        )
    return table(rows)
