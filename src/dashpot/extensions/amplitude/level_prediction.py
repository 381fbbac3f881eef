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
    VANISHING,
    LevelResonance,
    ReferencePoint,
    SweptPart,
    level_of,
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
        """Those of each mode, and what each level makes of it."""
        return (
            *super().facts,
            *(fact for level in self.preloaded for fact in level.facts),
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
    swept: SweptPart | None
    preloaded: tuple[PreloadedLevel, ...]
    checks: tuple[Check, ...]

    def complete(self, prediction: Prediction) -> LevelPrediction:
        """Return the prediction with its levels."""
        entries = {field.name: getattr(prediction, field.name) for field in fields(prediction)}
        return LevelPrediction(
            **entries, levels=self.levels, sweep=self.swept, preloaded=self.preloaded
        )


@dataclass(frozen=True)
class LevelEffect:
    """Effect of levels on parts, by an amplitude sweep or by the elastic law of the fit."""

    choices: LevelChoices
    swept: SweptPart | None

    def measured_peak(self, kind: Kind) -> Callable[[Solid, float, float], float] | None:
        """Return the resonance of a mass at the level at which that of the user was measured.

        None where the solid was measured as the resonance was: by a vanishing motion.
        """
        swept, typed = self.swept, self.choices.resonance_level
        if swept is None or not (typed or swept.fitted_at):
            return None
        level = level_of(typed, kind) if typed else VANISHING

        def peak(solid: Solid, factor: float, mass: float) -> float:
            about = model_modes(solid, mass)[0].frequency
            how = {"scale": factor, "mass": mass, "level": level, "kind": kind}
            return swept.peak(solid, swept.law, swept.factors[0], about=about, **how)[0]

        return peak

    def respond(
        self,
        rig: MountedMass,
        part: PartChoices | None,
        *,
        scale: float,
        about: float,
        frequency: FloatArray,
    ) -> LevelResonances:
        """Return the resonance at each level: of `scale` parts, `about` a frequency, Hz."""
        anchor = self._anchor(part, rig.solid, kind=rig.kind, scale=scale)
        levels = [level_of(word, rig.kind) for word in self.choices.levels]
        if self.swept is not None:
            resonances = self.swept.compute_resonances(
                rig.solid, levels, scale=scale, mass=rig.load.mass, kind=rig.kind, about=about,
                frequency=frequency, coupled=rig.load.coupled, anchor=anchor,
            )  # fmt: skip
            checks = (*self.swept.check_level_coverage(resonances), *self.swept.checks)
            return LevelResonances(resonances, self.swept, (), checks)
        nonlinear_levels = preloaded_levels(
            rig.fit, levels, rig.load, kind=rig.kind, about=about, frequency=frequency
        )
        depth = rig.rests.point.depth
        pressed = tuple(compression_tested(level.compression, depth) for level in nonlinear_levels)
        return LevelResonances((), None, nonlinear_levels, pressed)

    def _anchor(
        self, part: PartChoices | None, solid: Solid, *, kind: Kind, scale: float
    ) -> ReferencePoint | None:
        """The resonance that determined the geometry, and its strain; None where a shape did."""
        swept, typed = self.swept, self.choices.resonance_level
        if swept is None or part is None or part.resonance is None or part.resonance_mass is None:
            return None
        if not typed:
            return ReferencePoint(part.resonance, swept.fitted_at)
        how = {
            "scale": scale, "mass": part.resonance_mass, "kind": kind,
            "level": level_of(typed, kind),
        }  # fmt: skip
        factor = swept.factors[0]
        _, _, change = swept.peak(solid, swept.law, factor, about=part.resonance, **how)
        return ReferencePoint(part.resonance, change / swept.stretch(factor))
