"""Trend of the resonance of hits with amplitude."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.student_t import t_quantile
from dashpot.datamodel.frf import FRF, Hit, Mode
from dashpot.vibration.impact.spectral_estimators import Spectra

MAX_HITS_WITHOUT_TREND = 3
"""Number of hits up to which no trend is estimated."""
RESONANCE_BANDWIDTHS = 4.0  # bandwidths to either side of a resonance show it
RESONANCE_LINES = 5.0  # lines on either side of a resonance from which a single hit shows it
CONFIDENCE = 0.99  # of records without a trend show less than is called one
MIN_AMPLITUDE_RANGE = 0.2  # of a doubling: hits so alike show no trend
TREND_CONFIDENCE, POWER = 0.95, 0.6  # two-sided: a change is found at 5 %, by four of five tests
_MEDIAN_SE_RATIO = 1.25  # its standard error over that of a mean
MEAN_AMPLITUDE_RATIO = 0.55
"""Amplitude of the frequency fitted to a whole decay, over its first amplitude (friction)."""


@dataclass(frozen=True)
class RegressionLine(Serialisable):
    """Regression line over the binary logarithm of an amplitude.

    Attributes
    ----------
    slope : float
        Per doubling.
    critical_slope : float
        Slope that is exceeded by chance in 1 % of the records without a trend.
    detectable_change : float
        Slope that four of five records detect at the 5 % level.
    middle, value : float
        Mean of the logarithms, and of the quantity.
    se, spread : float
        Standard error of the slope, and root of the sum of squares of the logarithms.
    dof : int
    """

    _keys = (Key("change", "slope"), "se", "detectable_change")

    slope: float
    critical_slope: float
    detectable_change: float
    middle: float
    value: float
    se: float
    spread: float
    dof: int


@dataclass(frozen=True)
class Trend:
    """Trend of the resonance of single hits with their amplitude.

    Attributes
    ----------
    stiffness_line, damping_line : RegressionLine
        Lines through the logarithms of the squared frequency and of the damping ratio.
    mass, mass_se : float
        Modal mass, kg: the median over the hits, and the standard error of its logarithm.
    amplitudes : (float, float)
        Range of motion amplitudes, `MEAN_AMPLITUDE_RATIO` times the amplitude after each hit, m.
    range : float
        Highest over lowest.
    """

    stiffness_line: RegressionLine
    damping_line: RegressionLine
    mass: float
    mass_se: float
    amplitudes: tuple[float, float]
    range: float

    @property
    def stiffness(self) -> float:
        """Relative change of the stiffness for twice the motion."""
        return self.stiffness_line.slope

    @property
    def stiffness_sure(self) -> float:
        """Limit that chance exceeds in one of a hundred tests without a change of stiffness."""
        return self.stiffness_line.critical_slope

    @property
    def detectable_stiffness_change(self) -> float:
        """Change that four of five such tests find."""
        return self.stiffness_line.detectable_change

    @property
    def damping(self) -> float:
        """Relative change of the damping ratio for twice the motion."""
        return self.damping_line.slope

    @property
    def damping_sure(self) -> float:
        """Limit that chance exceeds in one of a hundred tests without a change of damping."""
        return self.damping_line.critical_slope

    @property
    def detectable_damping_change(self) -> float:
        """Change of damping that the test would detect, as `detectable_stiffness_change`."""
        return self.damping_line.detectable_change


def add_resonances(frf: FRF, spectra: Spectra, main: Mode) -> tuple[Hit, ...]:
    r"""Return the hits, each accepted one with the resonance of its own FRF and its amplitude.

    A hit of spectrum F sets a mode moving by :math:`|F(f_n)| / (m \omega_d)`. The modal mass m
    does not change with the height: the median over the hits, for hits whose frequencies differ
    have an average that is not of one mode.
    """
    step = float(np.median(np.diff(frf.frequency)))
    half_band = max(
        RESONANCE_BANDWIDTHS * (main.bandwidth + frf.shift / np.pi), RESONANCE_LINES * step
    )
    near_resonance = np.abs(frf.frequency - main.frequency) <= half_band
    band = (float(frf.frequency[near_resonance][0]), float(frf.frequency[near_resonance][-1]))
    nearest_line = int(np.argmin(np.abs(frf.frequency - main.frequency)))
    modes: list[Mode | None] = []
    for value in (spectra.response / spectra.force)[:, near_resonance]:
        local_frf = FRF(
            frf.frequency[near_resonance],
            value,
            frf.quantity,
            shift=frf.shift,
            record=frf.record,
            pulse=frf.pulse,
            units="SI",
        )
        new_modes = local_frf.modes(band=band, count=1)
        modes.append(new_modes[0] if new_modes and new_modes[0].damping_ratio > 0 else None)
    masses = [_get_modal_mass(mode) for mode in modes if mode is not None]
    if not masses:
        return frf.hits
    rows = iter(zip(modes, np.abs(spectra.force[:, nearest_line]).tolist(), strict=True))
    hits = []
    for hit in frf.hits:
        mode, amplitude = next(rows) if hit.accepted else (None, 0.0)
        if mode is None:
            hits.append(hit)
            continue
        hits.append(
            replace(
                hit,
                frequency=float(mode.frequency),
                damping_ratio=float(mode.damping_ratio),
                modal_mass=_get_modal_mass(mode),
                amplitude=amplitude / (float(np.median(masses)) * float(mode.pole.imag)),
            )
        )
    return tuple(hits)


def _get_modal_mass(mode: Mode) -> float:
    return float(1 / (2 * mode.pole.imag * abs(mode.residue)))


def fit_amplitude_trend(hits: Sequence[Hit]) -> Trend | None:
    r"""Regress the resonance of every single hit on its amplitude; None of too few hits.

    .. math:: 2 \ln f_i = a + s \log_2 X_i, \qquad \ln\zeta_i = b + d \log_2 X_i

    s and d are known by the scatter about the lines (Student); s is small, and so as good as the
    relative change of the stiffness.
    """
    rows = np.array(
        [
            (hit.amplitude, hit.frequency, hit.damping_ratio, hit.modal_mass)
            for hit in hits
            if hit.amplitude is not None
        ],
        dtype=float,
    )
    if len(rows) <= MAX_HITS_WITHOUT_TREND:
        return None
    X = MEAN_AMPLITUDE_RATIO * rows[:, 0]
    log_amplitude = np.log2(X)
    if np.ptp(log_amplitude) < MIN_AMPLITUDE_RANGE:
        return None
    return Trend(
        _fit_line(log_amplitude, 2 * np.log(rows[:, 1])),
        _fit_line(log_amplitude, np.log(rows[:, 2])),
        float(np.median(rows[:, 3])),
        float(_MEDIAN_SE_RATIO * np.log(rows[:, 3]).std() / np.sqrt(len(rows))),
        (float(X.min()), float(X.max())),
        float(X.max() / X.min()),
    )


def _fit_line(x: FloatArray, y: FloatArray) -> RegressionLine:
    mean_x, mean_y = float(x.mean()), float(y.mean())
    x, y = x - mean_x, y - mean_y
    norm = float(np.sqrt(x @ x))
    slope = float(x @ y) / norm**2
    residual, dof = y - slope * x, len(x) - 2
    se = float(np.sqrt(residual @ residual / dof)) / norm
    number = (t_quantile(TREND_CONFIDENCE, dof) + t_quantile(POWER, dof)) * se
    return RegressionLine(
        slope, t_quantile(CONFIDENCE, dof) * se, number, mean_x, mean_y, se, norm, dof
    )
