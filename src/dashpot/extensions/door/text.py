"""How a door vibrates on its seal, as text."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan

from dashpot import workflow
from dashpot.base.units import convert_to_unit
from dashpot.extensions.door.mounts import SEAL
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import format_rounded, hertz

_MOST = 9
"""Modes that are told at once."""
_ROUNDING = 1e-9
"""Of a damping, %."""


def door(found: workflow.DoorResult, *, every: bool = False) -> Text:
    """The seal line, the modes with what shares them, and what a shaken base does.

    Of many modes those of which the seal has most; `every` tells what each part has of them.
    """
    lines = _line(found)
    if not found.modes:
        return Text([*lines, f"  no mode in {hertz(found.band)}", *_shaken(found)])
    parts = list(dict.fromkeys(one.name for mode in found.modes for one in mode.shares))
    numbers = range(len(found.modes))
    first = sorted(sorted(numbers, key=lambda i: -found.modes[i].share(SEAL))[:_MOST])
    lines += table(_rows(found, first, parts if every else []))
    if len(first) < len(numbers):
        lines.append(f"  {len(numbers) - len(first)} more modes, of which the seal has less")
    if every:
        lines.append("  of each part: % of the energy/% of the loss")
    lines += _shaken(found)
    details = table(_rows(found, numbers, [])) if every or len(first) < len(numbers) else []
    bare = f"{', '.join(format_rounded(f) for f in found.bare)} Hz" if found.bare else "none"
    details.append(f"  modes without the seal: {bare}")
    details += table([["% of the energy", *parts], *_shares(found, parts, loss=False)])
    details += table([["% of the loss", *parts], *_shares(found, parts, loss=True)])
    return Text(lines, details)


def _rows(
    found: workflow.DoorResult, numbers: Sequence[int], parts: Sequence[str]
) -> list[list[str]]:
    """Frequency, damping and shares of some modes: of the seal, or of each of the `parts`."""
    named = ["without seal", "damping, %", "seal: % of energy", "% of loss", "times outside"]
    rows = [["mode", "Hz", *(("damping, %", *parts) if parts else named)]]
    for i in numbers:
        one = found.modes[i]
        damped = _format_damping(100 * one.mode.damping_ratio)
        bare = "" if one.without_seal is None else format_rounded(one.without_seal, digits=5)
        cells = [
            bare, damped, f"{100 * one.share(SEAL):.3f}", f"{100 * one.loss_share(SEAL):.1f}",
            _format_extrapolation_factor(found, one.mode.frequency),
        ]  # fmt: skip
        if parts:
            both = ((one.share(name), one.loss_share(name)) for name in parts)
            cells = [damped, *("/".join(_part(100 * part) for part in each) for each in both)]
        rows.append([str(i + 1), format_rounded(one.mode.frequency, digits=5), *cells])
    return rows


def _part(value: float) -> str:
    """A share, %: to a tenth below ten."""
    return f"{value:.1f}" if value < 10 else f"{value:.0f}"


def _format_damping(value: float) -> str:
    """A damping; what is rounding is none."""
    return format_rounded(value, digits=3) if value > _ROUNDING else "0"


def _format_extrapolation_factor(found: workflow.DoorResult, frequency: float) -> str:
    """By what factor a frequency lies outside what the test of the seal informs."""
    factor = found.beyond(frequency)
    return "" if isnan(factor) else "inside" if factor <= 1 else f"{factor:.3g}"


def _shares(found: workflow.DoorResult, parts: list[str], *, loss: bool) -> list[list[str]]:
    rows = []
    for number, mode in enumerate(found.modes, start=1):
        known = {one.name: one.loss if loss else one.energy for one in mode.shares}
        whole = sum(known.values()) or 1.0
        rows.append([str(number), *(f"{100 * known.get(name, 0.0) / whole:.2f}" for name in parts)])
    return rows


def _line(found: workflow.DoorResult) -> list[str]:
    seal = found.seal
    if seal is None:
        return ["  no seal"]
    closed = "closed" if seal.line.closed else "open"
    count, stiffness = seal.stations, format_rounded(convert_to_unit(seal.stiffness, "N/mm"))
    length = format_rounded(seal.line.length)
    said = [f"  seal line {length} m, {closed}, {count} stations, k_inf {stiffness} N/mm in all"]
    if seal.fit is not None:
        said[0] += f"; valid band {hertz(seal.fit.band)}"
    across, along = (format_rounded(convert_to_unit(one, "N/mm")) for one in seal.sideways)
    if seal.section.shear.holds:
        said.append(f"  sideways {across} N/mm across the line and {along} N/mm along it in all")
    if seal.sticks is not None:
        said.append(
            "  its friction sticks sideways up to "
            f"{format_rounded(convert_to_unit(seal.sticks, 'mm'), digits=3)} "
            "mm; the modes are of a seal that sticks"
        )
    if seal.compression is not None and seal.force is not None:
        least, mean, most = (
            format_rounded(convert_to_unit(one, "mm"), digits=3) for one in seal.compression
        )
        said.append(
            f"  compressed by {least} to {most} mm (mean {mean}); {format_rounded(seal.force)} N "
            "in all "
            "after relaxation"
        )
    return said


def _shaken(found: workflow.DoorResult) -> list[str]:
    if not found.shaken:
        return []
    rows = [["base shakes: rms", "m/s^2", "mm to the body", "without seal, m/s^2", "mm"]]
    for one in found.shaken:
        bare = one.bare
        rows.append(
            [
                one.name,
                format_rounded(one.sealed.acceleration),
                format_rounded(convert_to_unit(one.sealed.stretch, "mm")),
                "not damped" if bare is None else format_rounded(bare.acceleration),
                "" if bare is None else format_rounded(convert_to_unit(bare.stretch, "mm")),
            ]
        )
    return table(rows)
