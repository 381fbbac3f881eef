"""What FRFs at several levels tell, as ``dashpot/levels@1``: written, and read again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from dashpot.base.checks import Check, verdict
from dashpot.base.facts import Fact
from dashpot.base.provenance import Source
from dashpot.kinds.level.levels import LevelFit
from dashpot.solids.friction import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.stiffening import Cubic


@dataclass(frozen=True)
class PeakAtLevel:
    """The resonance of a mass at a level that was asked for.

    Attributes
    ----------
    level : float
        Amplitude of the force, N.
    frequency, receptance : float
        Of the largest motion, Hz, and that motion over the force, m/N.
    frequency_interval, receptance_interval : (float, float)
        95 %.
    amplitude : float
        Of the seal's displacement there, m.
    """

    level: float
    frequency: float
    receptance: float
    frequency_interval: tuple[float, float]
    receptance_interval: tuple[float, float]
    amplitude: float

    @property
    def facts(self) -> tuple[Fact, Fact]:
        """Where the motion is largest, and how large it is per force."""
        at = f"at {self.level:.4g} N"
        return (
            Fact(f"peak {at}", self.frequency, *self.frequency_interval, "Hz"),
            Fact(f"motion {at}", self.receptance, *self.receptance_interval, "m/N"),
        )


@dataclass(frozen=True)
class CubicFound:
    """A cubic spring, N/m^3, with its 95 % interval."""

    k3: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class LevelDocument:
    """A :class:`~dashpot.kinds.level.levels.LevelFit` as its document has it, without its draws."""

    amplitudes: tuple[float, float]
    verdict: dict[str, Any]
    checks: tuple[Check, ...]
    residual: float
    mass: float
    seals: float
    band_hz: tuple[float, float]
    linear_residual: float
    model: GeneralizedMaxwell
    sliders: tuple[Jenkins, ...]
    cubic: CubicFound | None
    orders: dict[str, float]
    levels: tuple[float, ...] = ()
    source: tuple[Source, ...] = ()
    at: tuple[PeakAtLevel, ...] = ()

    @classmethod
    def of(
        cls, fit: LevelFit, checks: tuple[Check, ...], at: tuple[PeakAtLevel, ...]
    ) -> LevelDocument:
        """What was found, with the checks of the levels that were asked for."""
        return cls(
            fit.amplitudes,
            verdict(checks, sound=fit.verdict.says).document,
            checks,
            fit.residual,
            fit.mass,
            fit.seals,
            fit.band,
            fit.linear_residual,
            fit.solid,
            fit.sliders,
            CubicFound(fit.k3, fit.k3_interval) if fit.k3 else None,
            dict(fit.orders),
            fit.levels,
            fit.source,
            at,
        )

    @property
    def fit(self) -> LevelFit:
        """The fit, of which chance is no longer known."""
        return LevelFit(
            self.model,
            (*self.sliders, *([Cubic(self.cubic.k3)] if self.cubic else [])),
            self.amplitudes,
            self.band_hz,
            self.residual,
            self.linear_residual,
            (),
            self.mass,
            self.seals,
            self.levels,
            self.checks,
            self.source,
            tuple(self.orders.items()),
        )
