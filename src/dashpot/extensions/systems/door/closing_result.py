"""Result of the closing of a door."""

from __future__ import annotations

import math

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, HasChecks
from dashpot.base.provenance import Source
from dashpot.base.result_mixins import HasVerdict, Series, collect_columns
from dashpot.base.serialisation import Key, Serialisable
from dashpot.datamodel.fit import Fit
from dashpot.extensions.systems.door.closing_analysis import ClosingAnalysis
from dashpot.extensions.systems.door.door_model import Door


@dataclass(frozen=True, repr=False)
class ClosingResult(HasChecks, HasVerdict, Serialisable):
    """Result of ``dashpot predict --close``.

    Attributes
    ----------
    door : Door
    fit : Fit or None
        Fit of the seal, at its temperature.
    closing : ClosingAnalysis
    checks : tuple of Check
    """

    schema = "dashpot/closing@2"
    _keys = (
        "closing.speed",
        "closing.door.edge",
        "closing.door.inertia",
        Key("latched", "closing.is_latched"),
        "closing.energy",
        "closing.remaining_energy",
        Key("stopped", "closing.stopped_gap"),
        "closing.rebound",
        Key("time", "closing.seconds"),
        Key("sealing_time", "closing.sealing"),
        "closing.terms",
        "peak_pressure",
        Key("least_speed", "closing.minimum", nonfinite_as_null=True),
        Key("least_speed_interval", "closing.interval", nonfinite_as_null=True),
        "least_compression",
        "least_contact_force",
        "closing.scatter",
        Key("history", nonfinite_as_null=True),
        "verdict",
        "checks",
        Key("source", "sources"),
    )

    door: Door
    fit: Fit | None
    closing: ClosingAnalysis
    checks: tuple[Check, ...]

    @property
    def _table_columns(self) -> Series:
        """Columns: the energy of each term."""
        return collect_columns(self.closing.terms, name="", work="J", stored="J", peak_moment="N m")

    @property
    def _headline(self) -> str:
        """The lowest speed that closes the door, and whether the stated speed does."""
        closing = self.closing
        if not math.isfinite(closing.minimum):
            return "no speed closes the door"
        verb = "closes" if closing.is_latched else "does not close"
        speed_text = f"from {closing.minimum:.3g} m/s on"
        if closing.interval is not None and math.isfinite(closing.interval[1]):
            low, high = closing.interval
            speed_text += f" ({low:.3g} to {high:.3g})"
        return f"the door closes {speed_text}. At {closing.speed:.3g} m/s it {verb}"

    @property
    def sources(self) -> tuple[Source, ...]:
        """The files behind it."""
        value = () if self.door.source is None else (self.door.source,)
        return (*value, *(self.fit.source if self.fit else ()))

    @property
    def peak_pressure(self) -> dict[str, float]:
        """The highest in each chamber, Pa."""
        return {name: float(values.max()) for name, values in self.closing.march.pressure.items()}

    @property
    def least_compression(self) -> float:
        """Along the line, closed, m."""
        return float(self.closing.door.compression.min())

    @property
    def least_contact_force(self) -> float:
        """Relaxed, along the line, closed, N/m."""
        door = self.closing.door
        return float(door.section.force(door.compression).min())

    @property
    def history(self) -> dict[str, FloatArray]:
        """The course of the door: s, rad, J."""
        march = self.closing.march
        return {"time": march.time[:, 0], "angle": march.angle, "kinetic": march.kinetic[:, 0]}
