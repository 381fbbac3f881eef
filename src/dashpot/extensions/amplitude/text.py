"""Results of tests at several amplitudes, as text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from dashpot.base.number_format import ascii_only
from dashpot.base.units import convert_to_unit, format_quantity, get_display_unit
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import list_notes, with_error

if TYPE_CHECKING:
    from dashpot.extensions.amplitude.datamodel import AmplitudeFit
    from dashpot.extensions.amplitude.fit_files import AmplitudeResult


def render_levels(value: AmplitudeResult) -> Text:
    """Return the dependence on amplitude, and the resonance at each requested force."""
    lines = [f"  {line}" for line in value.fit._summary_lines[1:]]
    if value.loss_per_lag is not None:
        lines.append(
            f"  A delay of 1 ms between the channels would add {1e-3 * value.loss_per_lag:.2g} to "
            f"the loss factor at {value.loss_per_lag / 2 / math.pi:.4g} Hz. Loops at one frequency "
            "cannot show such a delay."
        )
        lines += _format_small_loops(value.fit)  # type: ignore[arg-type]  # a lag is of loops alone
    rows = [["amplitude, N", "peak, Hz", "95 %", "motion, mm/N", "95 %", "seal, mm"]]
    for item in value.peaks:
        peak, motion = (reported_value.cells.ascii for reported_value in item.facts)
        peak_value, motion_value = (peak.value, peak.interval), (motion.value, motion.interval)
        seal = f"{convert_to_unit(item.amplitude, 'mm'):.3g}"
        rows.append([f"{item.level:.4g}", *peak_value, *motion_value, seal])
    return Text([*lines, *(table(rows) if value.peaks else ()), *list_notes(value.source)])


def _format_small_loops(amplitude_fit: AmplitudeFit) -> list[str]:
    """Return lines on storage and loss of small loops, and the delay that their errors include."""
    display_unit = get_display_unit(amplitude_fit.unit)
    storage, loss = ("stiffness", "loss")
    if amplitude_fit.unit == "Pa":
        storage, loss = ("storage modulus", "loss modulus")
    stiffness_texts = (
        f"at {line.frequency_hz:.4g} Hz {storage} "
        f"{with_error(line.storage, line.storage_se, amplitude_fit.unit)}, {loss} "
        f"{with_error(line.loss, line.loss_se, amplitude_fit.unit)} {display_unit}"
        for line in amplitude_fit.lines
    )
    quantity = format_quantity(amplitude_fit.delay_sd, "ms", ".3g")
    return [
        f"  small loops: {ascii_only('; '.join(stiffness_texts))}",
        f"  These errors include a delay of 0 ± {quantity} (dashpot fit --machine sync=0.1ms)",
    ]


def render_amplitude(result: Any) -> Text:
    """Return the dependence on amplitude of a fit alone, as text."""
    from dashpot.extensions.amplitude.fit_files import AmplitudeResult  # with the numbers

    return render_levels(AmplitudeResult(result, (), result.checks, ()))


_HARMONIC = 1e-4
"""Part of the first harmonic below which none is reported."""
