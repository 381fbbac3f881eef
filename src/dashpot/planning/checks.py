"""Criteria on a planned test."""

from __future__ import annotations

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.units import format_quantity
from dashpot.planning.expected_errors import Pulse, RecordNeed


@criterion("standard deviation / loss factor", "<=", source="the target, 0.1 by default")
def loss_factor_determined(
    sd: float, frequency: float, target_sd: float, *, remedy: str = ""
) -> Finding:
    """The planned test determines the loss factor well enough."""
    return Finding(
        f"The loss factor at {frequency:g} Hz would be known to {format_relative_sd(sd)} (1 SD); "
        f"{format_relative_sd(target_sd)} is "
        "wanted",
        sd,
        remedy=remedy or "Add a hammer test.",
        limit=target_sd,
    )


@criterion("frequency, Hz", source="within 1/(2 pi hold) to 1/(pi ramp)")
def inside_valid_band(frequency: float, band: tuple[float, float]) -> Finding:
    """The frequency of interest lies in the valid band of the ramp and hold."""
    is_inside = band[0] <= frequency <= band[1]
    return Finding(
        f"The valid band of this ramp and hold is {band[0]:.2g} to {band[1]:.2g} Hz; "
        f"{frequency:g} Hz lies {'inside' if is_inside else 'outside'}",
        frequency,
        remedy="Ramp faster, or add a hammer test.",
        limit=band[1] if frequency > band[1] else band[0],
        always_fails=not is_inside,
    )


@criterion("record, s", ">=", source="6 time constants, and 5 lines in the half-power band")
def record_long_enough(record_need: RecordNeed) -> Finding:
    """The planned record contains the decay and resolves the peak."""
    return Finding(
        f"A record of {record_need.record:g} s gives a peak wrong by up to "
        f"{100 * (record_need.peak_error or 0.0):+.0f} %. Six time constants last "
        f"{record_need.for_decay:.3g} s; five lines in the half-power band need "
        f"{record_need.for_lines:.3g} s",
        record_need.record,
        remedy=Remedy(
            f"Record each hit for {max(record_need.for_decay, record_need.for_lines):.3g} s.",
            "hit-length",
            f"{max(record_need.for_decay, record_need.for_lines):.3g}s",
        ),
        limit=max(record_need.for_decay, record_need.for_lines),
    )


@criterion("level, dB", ">=", -10.0, "our choice: the end of the useful band of a tip")
def tip_excites(tip: Pulse, frequency: float) -> Finding:
    """The hammer tip excites the frequency of interest."""
    return Finding(
        f"A pulse of {format_quantity(tip.duration, 'ms', 'g')} is {tip.level_db:.3f} dB at "
        f"{frequency:g} Hz. It excites up to {tip.band_10db:.3g} Hz (-10 dB)",
        tip.level_db,
        remedy="Use a harder tip.",
    )


def format_percent(value: float, text: str = "more than 1000 %") -> str:
    """Return a part of 1 in per cent, of three digits; above 10 as `text`."""
    return text if value > 10 else f"{100 * value:.3g} %"


def format_relative_sd(sd: float) -> str:
    """Return a relative standard deviation as text, ± per cent."""
    return f"±{format_percent(sd)}" if sd <= 10 else "worse than ±1000 %"
