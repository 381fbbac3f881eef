"""What is told of amplitudes and levels, as text for people."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from dashpot.base.number_format import ascii_only
from dashpot.base.units import convert_to_unit, format_quantity, get_display_unit
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import list_notes, with_error

if TYPE_CHECKING:
    from dashpot.extensions.amplitude.datamodel import AmplitudeFit
    from dashpot.extensions.amplitude.fit_files import Levels
    from dashpot.extensions.amplitude.preloaded_response import PreloadedLevel


def levels(found: Levels) -> Text:
    """Return what moves with amplitude, and the resonance at each level that was asked for."""
    lines = [f"  {line}" for line in found.fit.described[1:]]
    if found.loss_per_lag is not None:
        lines.append(
            f"  A delay of 1 ms between the channels would add {1e-3 * found.loss_per_lag:.2g} to "
            f"the loss factor at {found.loss_per_lag / 2 / math.pi:.4g} Hz. Loops at one frequency "
            "cannot show such a delay."
        )
        lines += _loops(found.fit)  # type: ignore[arg-type]  # a lag is of loops alone
    rows = [["level, N", "peak, Hz", "95 %", "motion, mm/N", "95 %", "seal, mm"]]
    for one in found.at:
        peak, motion = (fact.cells.ascii for fact in one.facts)
        of_peak, of_motion = (peak.value, peak.interval), (motion.value, motion.interval)
        seal = f"{convert_to_unit(one.amplitude, 'mm'):.3g}"
        rows.append([f"{one.level:.4g}", *of_peak, *of_motion, seal])
    return Text([*lines, *(table(rows) if found.at else ()), *list_notes(found.source)])


def _loops(found: AmplitudeFit) -> list[str]:
    """Storage and loss of small loops, and the delay of the force that their errors include."""
    read = get_display_unit(found.unit)
    listed = (
        f"at {one.frequency_hz:.4g} Hz stiffness "
        f"{with_error(one.storage, one.storage_se, found.unit)}, loss "
        f"{with_error(one.loss, one.loss_se, found.unit)} {read}"
        for one in found.lines
    )
    known = format_quantity(found.delay_sd, "ms", ".3g")
    return [
        f"  A small loop {ascii_only('; '.join(listed))}",
        f"  These errors include a delay of 0 ± {known} (dashpot fit --machine sync=0.1ms)",
    ]


def amplitude(found: Any) -> Text:
    """Return what moves with amplitude, of a fit alone."""
    from dashpot.extensions.amplitude.fit_files import Levels  # with the numbers

    return levels(Levels(found, (), found.checks, ()))


_HARMONIC = 1e-4
"""Part of the first harmonic below which none is told."""


def list_preloaded_levels(found: Sequence[PreloadedLevel], unit: str) -> list[str]:
    """Return the resonance and harmonics at each level, by the law, and what the seal does."""
    head = [f"level, {found[0].unit}", "peak, Hz", unit, "1st, mm", "2nd, mm",
            "3rd, mm", "mean shift, mm", "apart", "floquet"]  # fmt: skip
    rows: list[list[str]] = [head]
    says: list[str] = []
    for one in found:
        at = one.orbit
        # what is less is rounding
        least = _HARMONIC * one.amplitude
        rows.append(
            [
                f"{one.level:.4g}",
                f"{one.frequency:.5g}",
                f"{one.value:.4g}",
                *(
                    f"{convert_to_unit(each, 'mm') * (abs(each) > least):.3g}"
                    for each in (*at.amplitudes[1:4].tolist(), at.shift)
                ),
                f"{100 * at.lost:.3g} %",
                f"{at.growth:.3g}",
            ]
        )
        if one.interval is not None:
            rows.append(_within(one, least))
        says += _of_level(one, least)
    return [*table(rows), *says]


def _of_level(one: PreloadedLevel, least: float) -> Iterator[str]:
    """What else is to be known of the response at one level."""
    name, shift = f"at {one.level:.4g} {one.unit}", one.orbit.shift
    if one.interval is not None and one.interval.value is None:
        jumps = one.interval.harmonics is None
        why = "a sweep jumps down from it" if jumps else "its error is as large as itself"
        yield f"  ! {name} the height of the peak is not identified: {why}"
    if abs(shift) <= least:
        return
    does, second = "opens" if shift < 0 else "closes", one.second_harmonic
    yield (
        f"  {name} the seal {does} by {format_quantity(abs(shift), 'mm', '.2g')} when shaken; the "
        f"second harmonic is largest at {second['frequency_hz']:.4g} Hz, "
        f"{100 * second['amplitude'] / second['first']:.3g} % of the first"
    )
    for low, high in one.unsteady:
        yield f"  ! {name} no answer at the drive's period lasts from {low:.4g} to {high:.4g} Hz"
    for hz in one.jumps_hz:
        yield (
            f"  ! {name} two answers last below {hz:.5g} Hz. This is a rising frequency's; a "
            "falling one keeps the other"
        )


def _within(one: PreloadedLevel, least: float) -> list[str]:
    """The row of 95 % intervals under a level's, as far as they are known."""
    hz, height, shift, *harmonics = one.facts
    cells = ["  95 %"]
    for fact in (hz, height, *harmonics, shift):
        told = fact.bounded and (fact.unit != "m" or abs(fact.value) > least)
        half = convert_to_unit(0.5 * (fact.high - fact.low), fact.read or "1")
        cells.append(f"± {half:.2g}" if told else "")
    return [*cells, "", ""]
