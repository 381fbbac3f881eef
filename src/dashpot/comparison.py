"""Predicted against measured: what the hammer confirms, and which arms it tested."""

from __future__ import annotations

from dataclasses import dataclass

from dashpot.checks import Check
from dashpot.vibration.frf import FRF


@dataclass(frozen=True)
class ArmEvidence:
    """Whether one arm of the model was tested by this FRF.

    Attributes
    ----------
    tau : float
        Relaxation time, s.
    loss_share : float
        Share of the loss stiffness at the measured peak that this arm carries, 0 to 1.
    seen_by_relaxation : bool
        True if the relaxation test could identify an arm at this relaxation time.
    """

    tau: float
    loss_share: float
    seen_by_relaxation: bool


@dataclass(frozen=True)
class Comparison:
    """A predicted FRF held against a measured one, on the measured lines.

    Attributes
    ----------
    predicted, measured : FRF
        Accelerance on the same lines.
    predicted_hz, measured_hz : float
        Frequency of the peak, Hz.
    predicted_peak, measured_peak : float
        Height of the accelerance peak, 1/kg.
    predicted_damping, measured_damping : float or None
        Damping ratio; None where the record cannot support it.
    frac : float
        Frequency response assurance criterion, 0 to 1.
    rms_db : float
        Root mean square difference of the magnitudes over the lines, dB.
    z_rms : float or None
        Root mean square of the difference in units of the measured standard deviation.
    arms : tuple of ArmEvidence
    checks : tuple of Check
    verdict : str
        The sentence that matters: what agrees, what does not, and why.
    """

    predicted: FRF
    measured: FRF
    predicted_hz: float
    measured_hz: float
    predicted_peak: float
    measured_peak: float
    predicted_damping: float | None
    measured_damping: float | None
    frac: float
    rms_db: float
    z_rms: float | None
    arms: tuple[ArmEvidence, ...]
    checks: tuple[Check, ...]
    verdict: str
