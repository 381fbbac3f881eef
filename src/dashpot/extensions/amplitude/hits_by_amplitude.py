"""Resonance against amplitude from hammer hits of different height."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.checks import Check, HasChecks
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source
from dashpot.base.serialisation import Serialisable
from dashpot.base.student_t import t_quantile
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.frf import FRF
from dashpot.extensions.amplitude.checks import softening_detectable
from dashpot.vibration.impact.amplitude_trend import (
    TREND_CONFIDENCE,
    RegressionLine,
    Trend,
    fit_amplitude_trend,
)
from dashpot.vibration.impact.checks import (
    amplitude_linear,
    high_frequency_mass_agrees,
    hits_enough,
)

_MAX_ITERATIONS = 20


def predict_interval(line: RegressionLine, x: float) -> tuple[float, float]:
    """Return a regression line at x, and half its 95 % interval there."""
    count = line.dof + 2
    error = line.se * float(np.hypot(line.spread / np.sqrt(count), x - line.middle))
    return line.value + line.slope * (x - line.middle), t_quantile(
        TREND_CONFIDENCE, line.dof
    ) * error


class HitSummary(NamedTuple):
    """Hit: its peak force, N, and amplitude, m, resonance, Hz, and damping ratio after it."""

    name: str
    peak: float | None
    amplitude: float | None
    frequency_hz: float | None
    damping_ratio: float | None


@dataclass(frozen=True, eq=False)
class HitLevels(HasChecks, Serialisable):
    """Dependence of a resonance on amplitude, from hits of different height.

    Attributes
    ----------
    frf : FRF
        With its hits, each with its own resonance.
    trend : Trend
    checks : tuple of Check
    """

    _keys = ("hits", "per_doubling")

    frf: FRF
    trend: Trend
    checks: tuple[Check, ...]

    @property
    def source(self) -> tuple[Source, ...]:
        """The files of the hits."""
        return self.frf.source

    @property
    def amplitudes(self) -> tuple[float, float]:
        """Amplitude range of the motion at the resonances of the hits, m."""
        return self.trend.amplitudes

    @property
    def _headline(self) -> str:
        """Change of stiffness and damping for twice the motion, and the range."""
        low, high = self.amplitudes
        return (
            f"from {convert_to_unit(low, 'mm'):.3g} to {format_quantity(high, 'mm', '.3g')} a "
            "doubled motion "
            f"changes the stiffness by {_with_error(self.trend.stiffness_line)}, the damping "
            f"ratio by {_with_error(self.trend.damping_line)}"
        )

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict, the trend, and the detectable trend."""
        trend = self.trend
        low, high = self.amplitudes
        return (
            str(self.verdict),
            (
                f"{trend.stiffness_line.dof + 2} hits, motion of {convert_to_unit(low, 'mm'):.3g} "
                "to "
                f"{format_quantity(high, 'mm', '.3g')}: per doubling the stiffness changes by "
                f"{_with_error(trend.stiffness_line)}, the damping ratio by "
                f"{_with_error(trend.damping_line)}"
            ),
            (
                f"four of five such tests find {100 * trend.detectable_stiffness_change:.2g} % of "
                "stiffness "
                f"and {100 * trend.detectable_damping_change:.2g} % of damping per doubling"
            ),
            *(check.message_with_remedy for check in self.checks if check.failed),
        )

    @property
    def hits(self) -> tuple[HitSummary, ...]:
        """The hits that count."""
        return tuple(
            HitSummary(hit.name, hit.peak, hit.amplitude, hit.frequency, hit.damping_ratio)
            for hit in self.frf.hits
            if hit.accepted
        )

    @property
    def per_doubling(self) -> dict[str, RegressionLine]:
        """The trends of stiffness and damping by their names."""
        return {"stiffness": self.trend.stiffness_line, "damping": self.trend.damping_line}

    def resonance(
        self, level: float
    ) -> tuple[float, float, tuple[float, float], tuple[float, float]]:
        r"""Resonance under a steady force: frequency, Hz, motion over force, m/N; 95 % of both.

        .. math:: X = \frac{F}{2 m \zeta(X)\, \omega_n(X)^2}

        with the modal mass m, and frequency and damping of the trend at X.

        Parameters
        ----------
        level : float
            Amplitude of the force, N.

        Raises
        ------
        DataError
            If the damping of the trend is so large there that nothing resonates.
        """
        trend = self.trend

        def compute_resonance_at(
            x: float, stiffness: float = 0.0, damping: float = 0.0
        ) -> tuple[float, float]:
            log_square, half_width = predict_interval(trend.stiffness_line, x)
            ratio, damping_half_width = predict_interval(trend.damping_line, x)
            # a whole decay is of no one amplitude: which, is known to a doubling
            half_width = float(np.hypot(half_width, trend.stiffness))
            damping_half_width = float(
                np.hypot(np.hypot(damping_half_width, trend.damping), 2 * trend.mass_se)
            )
            omega_n = float(np.exp((log_square + stiffness * half_width) / 2))
            zeta = float(np.exp(ratio + damping * damping_half_width))
            hz = omega_n * float(np.sqrt(max(1 - 2 * zeta**2, 0.0)))
            return hz, 1 / (2 * trend.mass * zeta * (2 * np.pi * omega_n) ** 2)

        x = trend.stiffness_line.middle
        for _ in range(_MAX_ITERATIONS):
            hz, receptance = compute_resonance_at(x)
            x = float(np.log2(level * receptance))
        if hz == 0:
            low, high = self.amplitudes
            raise DataError(
                f"at {level:g} N the line through the damping of the hits, of "
                f"{convert_to_unit(low, 'mm'):.3g} to {format_quantity(high, 'mm', '.3g')}, leaves "
                "no resonance: "
                "hit so that the seal moves as it does at that amplitude"
            )
        least_hz, most_hz = (compute_resonance_at(x, stiffness=sign)[0] for sign in (-1.0, 1.0))
        lowest, highest = (compute_resonance_at(x, damping=sign)[1] for sign in (1.0, -1.0))
        return hz, receptance, (least_hz, most_hz), (lowest, highest)


def hits_as_levels(frf: FRF, *, band: tuple[float, float] | None = None) -> HitLevels:
    """Regress the resonance of every hit on its amplitude.

    Raises
    ------
    DataError
        If there is no mode, or too few hits of different height.
    """
    modes, trend = frf.modes(band=band), fit_amplitude_trend(frf.hits)
    if not modes or trend is None:
        total = sum(hit.amplitude is not None for hit in frf.hits)
        raise DataError(
            f"{total} hits have a resonance, too few or too alike in height; expected four or "
            "more, from soft to hard"
        )
    checks = (
        *(check for check in frf.checks if check.name == high_frequency_mass_agrees.name),
        hits_enough(frf),
        amplitude_linear(trend, modes[0]),
        softening_detectable(trend),
        *caution_checks(frf.source),
    )
    return HitLevels(frf, trend, checks)


def _with_error(line: RegressionLine) -> str:
    return f"{100 * line.slope:+.2g} ± {100 * line.se:.1g} %"
