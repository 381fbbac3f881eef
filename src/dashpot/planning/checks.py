"""What a planned test will not tell, as criteria with a sentence."""

from __future__ import annotations

from dashpot.base.checks import Finding, criterion
from dashpot.base.units import written
from dashpot.planning.expected import Pulse, RecordNeed


@criterion("standard deviation / loss factor", "<=", source="what is wanted, 0.1 by default")
def loss_factor_known(sd: float, at: float, wanted: float) -> Finding:
    """The loss factor would be known well enough."""
    return Finding(
        f"the loss factor at {at:g} Hz would be known to {percent(sd)} "
        f"(one standard deviation); {percent(wanted)} is wanted",
        sd,
        limit=wanted,
    )


@criterion("frequency, Hz", source="within 1/(2 pi hold) to 1/(pi ramp)")
def inside_identified_band(at: float, band: tuple[float, float]) -> Finding:
    """The frequency that matters lies in what the relaxation test informs."""
    inside = band[0] <= at <= band[1]
    return Finding(
        f"this relaxation test informs {band[0]:.2g} to {band[1]:.2g} Hz; {at:g} Hz is "
        f"{'inside' if inside else 'outside'}",
        at,
        limit=band[1] if at > band[1] else band[0],
        faulted=not inside,
    )


@criterion("record, s", ">=", source="6 time constants, and 5 lines in the half-power band")
def record_long_enough(need: RecordNeed) -> Finding:
    """The planned record holds the decay, and resolves the peak."""
    return Finding(
        f"a record of {need.record:g} s reads the peak up to {100 * (need.peak_error or 0.0):+.0f} "
        f"% wrong off its lines; {need.for_decay:.3g} s hold six time constants, "
        f"{need.for_lines:.3g} s put five lines into the peak",
        need.record,
        limit=max(need.for_decay, need.for_lines),
    )


@criterion("level, dB", ">=", -10.0, "our choice: where a tip's useful band ends")
def tip_excites(tip: Pulse, at: float) -> Finding:
    """The hammer's tip excites the frequency that matters."""
    return Finding(
        f"a {written(tip.duration, 'ms', 'g')} pulse is {tip.level_db:.3f} dB down at {at:g} Hz "
        f"and useful to {tip.band_10db:.3g} Hz (-10 dB)",
        tip.level_db,
    )


def percent(value: float, beyond: str = "more than 1000 %") -> str:
    """Return a part of 1 as people read it."""
    return beyond if value > 10 else f"{100 * value:.3g} %"
