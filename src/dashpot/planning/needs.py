"""What a plan says."""

from __future__ import annotations

from dataclasses import dataclass

from dashpot.base.checks import Check
from dashpot.solids.maxwell import GeneralizedMaxwell


@dataclass(frozen=True)
class ExpectedError:
    """What one relaxation test would leave unknown at one frequency.

    Attributes
    ----------
    method : str
        ``"full"`` or ``"hold"``; ``"joint"`` for ramp, hold and a hammer test together.
    ramp_time, hold_time : float
        s.
    storage_sd, loss_factor_sd : float
        Expected standard deviation over the value, dimensionless; infinite if the test says
        nothing.
    arm_sd : float or None
        That of the stiffness of the unseen arm; None if none was supposed.
    """

    method: str
    ramp_time: float
    hold_time: float
    storage_sd: float
    loss_factor_sd: float
    arm_sd: float | None


@dataclass(frozen=True)
class RecordNeed:
    """How long the impact record must be for the mass on this solid.

    Attributes
    ----------
    frequency, damping_ratio : float
        Of the ringing pole, Hz and dimensionless.
    time_constant : float
        1/sigma of the free response, s.
    half_power_width : float
        Of the peak, Hz.
    for_decay, for_lines : float
        Six time constants, and five lines in the half-power band, s.
    record : float or None
        The record that was planned, s.
    peak_error : float or None
        What cutting at that record does to the peak read off the lines, relative; the worst
        place of the lines.
    """

    frequency: float
    damping_ratio: float
    time_constant: float
    half_power_width: float
    for_decay: float
    for_lines: float
    record: float | None = None
    peak_error: float | None = None


@dataclass(frozen=True)
class Pulse:
    """What a half-sine hammer pulse excites.

    Attributes
    ----------
    duration : float
        s.
    level_db : float
        Force spectrum at the frequency asked for, relative to 0 Hz, dB.
    band_10db, band_20db : float
        Where the spectrum has fallen by 10 and 20 dB, Hz.
    first_zero : float
        1.5 / duration, Hz.
    """

    duration: float
    level_db: float
    band_10db: float
    band_20db: float
    first_zero: float


@dataclass(frozen=True)
class Plan:
    """What a test can and cannot tell at a frequency, and what to change.

    Attributes
    ----------
    at : float
        Hz.
    model : GeneralizedMaxwell
        The solid that was supposed, the unseen arm included.
    arm : (float, float) or None
        Stiffness, N/m, and relaxation time, s, of the arm that the test may not see.
    expected : ExpectedError
        Of the test as asked.
    alternatives : tuple of ExpectedError
        Of the other method, of faster ramps, and of the same test with a hammer test.
    band : (float, float)
        The frequencies that the relaxation test can inform, Hz.
    record : RecordNeed
    pulse : Pulse or None
    checks : tuple of Check
    advice : tuple of str
        What to change, most useful first.
    """

    at: float
    model: GeneralizedMaxwell
    arm: tuple[float, float] | None
    expected: ExpectedError
    alternatives: tuple[ExpectedError, ...]
    band: tuple[float, float]
    record: RecordNeed
    pulse: Pulse | None
    checks: tuple[Check, ...]
    advice: tuple[str, ...]

    def __str__(self) -> str:
        head = f"{'method':<8}{'ramp, s':>10}{'hold, s':>10}{'storage':>12}{'loss factor':>14}"
        rows = [
            f"{e.method:<8}{e.ramp_time:>10.3g}{e.hold_time:>10.3g}"
            f"{_percent(e.storage_sd):>12}{_percent(e.loss_factor_sd):>14}"
            for e in (self.expected, *self.alternatives)
        ]
        title = f"expected standard deviation at {self.at:g} Hz"
        return "\n".join([title, head, *rows, *self.advice])


def _percent(value: float) -> str:
    return "unknown" if value > 10 else f"{100 * value:.3g} %"
