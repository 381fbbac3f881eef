"""Prediction of a mass on seals at several amplitudes, by a sweep or by a nonlinear elastic law."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from dashpot.base import dataclass, fields
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.reported_values import ReportedValue
from dashpot.base.serialisation import Key
from dashpot.datamodel.frf import FRF, Kind
from dashpot.extensions.amplitude.amplitude_response import (
    VANISHING_LEVEL,
    LevelResonance,
    ReferencePoint,
    SweptPart,
    parse_level,
)
from dashpot.extensions.amplitude.preloaded_response import PreloadedLevel, preloaded_levels
from dashpot.solids.maxwell import Solid
from dashpot.vibration.checks import compression_tested
from dashpot.vibration.mass_on_seals import model_modes
from dashpot.workflow.frf_prediction import MountedMass, Prediction
from dashpot.workflow.job import LevelChoices, PartChoices


@dataclass(frozen=True, repr=False)
class LevelPrediction(Prediction):
    """Prediction with the resonance at each requested level; other values are without level.

    Attributes
    ----------
    levels : tuple of LevelResonance
        By a sweep.
    sweep : SweptPart or None
        The sweep behind them.
    preloaded : tuple of PreloadedLevel
        By an elastic law that bends.
    """

    _keys: ClassVar[tuple[str | Key, ...]] = tuple(
        key
        for old in Prediction._keys
        for key in (
            (Key("levels", "resonances", optional=True), Key("sweep", optional=True), old)
            if old == Key("random", optional=True)
            else (old,)
        )
    )

    levels: tuple[LevelResonance, ...] = ()
    sweep: SweptPart | None = None
    preloaded: tuple[PreloadedLevel, ...] = ()

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Values of each mode, and of each level."""
        return (
            *super().facts,
            *(reported_value for level in self.preloaded for reported_value in level.facts),
        )

    @property
    def resonances(self) -> tuple[LevelResonance, ...] | tuple[PreloadedLevel, ...]:
        """The resonance at each level, by the sweep or by the preloaded mass."""
        return self.levels or self.preloaded

    @property
    def table_frf(self) -> FRF:
        """The FRF at the first level."""
        return self.resonances[0].frf

    def __repr__(self) -> str:
        return super().__repr__().removeprefix("Level")


@dataclass(frozen=True)
class LevelResonances:
    """Resonance at each level, with checks."""

    levels: tuple[LevelResonance, ...]
    swept_part: SweptPart | None
    preloaded: tuple[PreloadedLevel, ...]
    checks: tuple[Check, ...]

    def add_to_prediction(self, prediction: Prediction) -> LevelPrediction:
        """Return the prediction with its levels."""
        entries = {field.name: getattr(prediction, field.name) for field in fields(prediction)}
        return LevelPrediction(
            **entries, levels=self.levels, sweep=self.swept_part, preloaded=self.preloaded
        )


@dataclass(frozen=True)
class LevelEffect:
    """Effect of levels on parts, by an amplitude sweep or by the elastic law of the fit."""

    choices: LevelChoices
    swept_part: SweptPart | None

    def measured_peak(self, kind: Kind) -> Callable[[Solid, float, float], float] | None:
        """Return the resonance of a mass at the level at which that of the user was measured.

        None where the solid was measured as the resonance was: by a vanishing motion.
        """
        fitted_sweep, stated_level = self.swept_part, self.choices.resonance_level
        if fitted_sweep is None or not (stated_level or fitted_sweep.fitted_at):
            return None
        level = parse_level(stated_level, kind) if stated_level else VANISHING_LEVEL

        def peak(solid: Solid, factor: float, mass: float) -> float:
            linear_frequency = model_modes(solid, mass)[0].frequency
            conditions = {"scale": factor, "mass": mass, "level": level, "kind": kind}
            return fitted_sweep.peak(
                solid,
                fitted_sweep.law,
                fitted_sweep.factors[0],
                around_hz=linear_frequency,
                **conditions,
            )[0]

        return peak

    def predict_resonances(
        self,
        rig: MountedMass,
        part: PartChoices | None,
        *,
        scale: float,
        linear_frequency: float,
        frequency: FloatArray,
    ) -> LevelResonances:
        """Return the resonance at each level: of `scale` parts, `linear_frequency` in Hz."""
        anchor = self._anchor(part, rig.solid, kind=rig.kind, scale=scale)
        levels = [parse_level(word, rig.kind) for word in self.choices.levels]
        if self.swept_part is not None:
            resonances = self.swept_part.compute_resonances(
                rig.solid, levels, scale=scale, mass=rig.mass_on_seals.mass, kind=rig.kind,
                around_hz=linear_frequency,
                frequency=frequency, coupled=rig.mass_on_seals.coupled, anchor=anchor,
            )  # fmt: skip
            checks = (*self.swept_part.check_level_coverage(resonances), *self.swept_part.checks)
            return LevelResonances(resonances, self.swept_part, (), checks)
        nonlinear_levels = preloaded_levels(
            rig.fit,
            levels,
            rig.mass_on_seals,
            kind=rig.kind,
            around_hz=linear_frequency,
            frequency=frequency,
        )
        depth = rig.equilibrium.point.depth
        compressions = tuple(
            compression_tested(level.compression, depth) for level in nonlinear_levels
        )
        return LevelResonances((), None, nonlinear_levels, compressions)

    def _anchor(
        self, part: PartChoices | None, solid: Solid, *, kind: Kind, scale: float
    ) -> ReferencePoint | None:
        """The resonance that determined the geometry, and its strain; None where a shape did."""
        fitted_sweep, stated_level = self.swept_part, self.choices.resonance_level
        if (
            fitted_sweep is None
            or part is None
            or part.resonance is None
            or part.resonance_mass is None
        ):
            return None
        if not stated_level:
            return ReferencePoint(part.resonance, fitted_sweep.fitted_at)
        conditions = {
            "scale": scale, "mass": part.resonance_mass, "kind": kind,
            "level": parse_level(stated_level, kind),
        }  # fmt: skip
        factor = fitted_sweep.factors[0]
        _, _, change = fitted_sweep.peak(
            solid, fitted_sweep.law, factor, around_hz=part.resonance, **conditions
        )
        return ReferencePoint(part.resonance, change / fitted_sweep.stretch(factor))
