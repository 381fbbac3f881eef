"""Result of a comparison of two FRFs."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.result_mixins import Plottable, Series
from dashpot.base.serialisation import EVERY_FIELD, Serialisable
from dashpot.datamodel.frf import FRF


@dataclass(frozen=True)
class ArmEvidence:
    """Evidence of an FRF on one arm of the model.

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

    def __str__(self) -> str:
        """Return the share of the loss, as text."""
        return (
            f"arm tau = {self.tau:.4g} s: {100 * self.loss_share:.1f} % of the model's loss at the "
            f"measured peak, {'' if self.seen_by_relaxation else 'not '}resolved by the relaxation"
        )


@dataclass(frozen=True, repr=False)
class Comparison(Plottable, Serialisable):
    """Comparison of a predicted FRF with a measured one, on the measured lines.

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
    message : str
        Conclusion: what agrees, what does not, and why.
    band : (float, float)
        First and last of the lines that `frac`, `rms_db` and `z_rms` were taken over, Hz.
    measured_hz_se, measured_damping_se : float or None
        Random standard errors of the measured peak frequency, Hz, and damping ratio.
    legend : str
        Legend of the prediction in a figure.

    Examples
    --------
    >>> import dashpot as dp
    >>> fit = dp.fit(dp.simulate("relaxation", hold="5s", noise_free=True), arms=2)
    >>> frf = dp.predict(fit, mass="104g", seals=2).frf
    >>> round(dp.compare(frf, frf).frac, 6)
    1.0
    """

    schema = "dashpot/comparison@2"
    _keys = ("peak", "damping", "verdict", EVERY_FIELD, "message")

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
    message: str
    band: tuple[float, float] = (0.0, float("inf"))
    measured_hz_se: float | None = None
    measured_damping_se: float | None = None
    legend: str = "predicted"

    @property
    def verdict(self) -> Verdict:
        """Verdict on the prediction, by the gravest failed check, with the sentence `message`."""
        return replace(verdict(self.checks), message=self.message)

    @property
    def frequency_error(self) -> float:
        """Predicted over measured peak frequency, less one."""
        return self.predicted_hz / self.measured_hz - 1

    @property
    def ratio_db(self) -> float:
        """Predicted over measured peak height, dB."""
        return float(20 * np.log10(self.predicted_peak / self.measured_peak))

    @property
    def damping_ratio_error(self) -> float | None:
        """Predicted over measured damping ratio, less one; None if either is unknown."""
        if self.predicted_damping is None or not self.measured_damping:
            return None
        return self.predicted_damping / self.measured_damping - 1

    @property
    def peak(self) -> dict[str, float]:
        """Both peaks, Hz and 1/kg, and their difference."""
        return {
            "predicted_hz": self.predicted_hz,
            "measured_hz": self.measured_hz,
            "difference_percent": 100 * self.frequency_error,
            "predicted": self.predicted_peak,
            "measured": self.measured_peak,
            "ratio": self.predicted_peak / self.measured_peak,
            "ratio_db": self.ratio_db,
        }

    @property
    def damping(self) -> dict[str, float | None]:
        """Both damping ratios, and the predicted over the measured one; None if unknown."""
        predicted, measured = self.predicted_damping, self.measured_damping
        ratio = predicted / measured if predicted and measured else None
        return {"predicted": predicted, "measured": measured, "ratio": ratio}

    @property
    def z(self) -> FloatArray | None:
        """Difference of each line over its standard deviation; None if unknown.

        The standard deviation is that of the complex value: z is about 1 for a correct model.
        """
        sd = self.measured.random_sd
        if sd is None:
            return None
        difference = np.abs(self.predicted.value - self.measured.value)
        return np.asarray(difference / np.maximum(np.sqrt(2) * sd, np.finfo(float).tiny))

    @property
    def rows(self) -> tuple[tuple[str, str, str, str], ...]:
        """Rows of a table: quantity, predicted, measured, difference."""
        error = self.damping_ratio_error
        return (
            (
                "peak frequency, Hz",
                f"{self.predicted_hz:.3f}",
                f"{self.measured_hz:.3f}",
                f"{100 * self.frequency_error:+z.2f} %",
            ),
            (
                "peak height, 1/kg",
                f"{self.predicted_peak:.2f}",
                f"{self.measured_peak:.2f}",
                f"{self.ratio_db:+z.2f} dB",
            ),
            (
                "damping ratio",
                _ratio(self.predicted_damping),
                _ratio(self.measured_damping),
                "" if error is None else f"{100 * error:+z.1f} %",
            ),
        )

    @property
    def resonance_match(self) -> str:
        """Measured peak and damping with the errors of the model, as text."""
        error_text = f"{100 * self.frequency_error:+z.2g} %, {self.ratio_db:+z.1f} dB"
        peak = f"peak at {self.measured_hz:.4g} Hz ({error_text})"
        if self.measured_damping is None or self.predicted_damping is None:
            return peak
        return (
            f"{peak}, damping ratio {100 * self.measured_damping:.3g} % "
            f"(model {100 * self.predicted_damping:.3g} %)"
        )

    @property
    def lines(self) -> str:
        """Agreement of the lines, as text."""
        z = "" if self.z_rms is None else f", {self.z_rms:.3g} times the noise"
        return (
            f"{len(self.measured.frequency)} frequency lines from {self.band[0]:.3g} to "
            f"{self.band[1]:.3g} Hz: correlation (FRAC) {self.frac:.3f}; "
            f"rms error {self.rms_db:.2f} dB{z}"
        )

    @property
    def _table_columns(self) -> Series:
        """Measured and predicted over frequency, and what parts them in standard deviations."""
        return {
            "frequency": (self.measured.frequency, "Hz"),
            "measured": (self.measured.value, self.measured.unit),
            "predicted": (self.predicted.value, self.predicted.unit),
            "z": (self.z, ""),
        }

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict and the peaks."""
        rows = [("", "predicted", "measured", "difference"), *self.rows]
        return (
            str(self.verdict),
            *(f"{a:<20}{b:>12}{c:>12}{d:>13}" for a, b, c, d in rows),
            self.lines,
        )

    def __str__(self) -> str:
        failed = (
            f"{check.message_with_remedy} [{check.name}]" for check in self.checks if check.failed
        )
        return "\n".join((*self._summary_lines, *map(str, self.arms), *failed))


def _ratio(value: float | None) -> str:
    return "not given" if value is None else f"{100 * value:.3f} %"
