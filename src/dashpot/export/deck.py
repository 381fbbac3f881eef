"""A solid in deck units, with everything its header must say."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from dashpot.base.provenance import Source
from dashpot.base.version import __version__
from dashpot.export.number_fields import one_line, text
from dashpot.export.unit_systems import UnitSystem
from dashpot.records.specimen import Specimen
from dashpot.solids.maxwell import GeneralizedMaxwell

NOT_VERIFIED = "not solver-verified: no solver of this kind runs in dashpot's tests"


@dataclass(frozen=True)
class Deck:
    """A solid ready to be written, with everything its header must say.

    Attributes
    ----------
    model : GeneralizedMaxwell
        SI.
    units : UnitSystem
    specimen : Specimen
    band : (float, float) or None
        The frequencies that the test informs, Hz; None for a bare model.
    source : tuple of Source
    overrides : tuple of str
        What was wrong and written all the same, one sentence each.
    doubts : tuple of str
        What the failed checks of the fit say.
    identity : str
        Of the fit; empty for a bare model.
    """

    model: GeneralizedMaxwell
    units: UnitSystem
    specimen: Specimen = field(default_factory=Specimen)
    band: tuple[float, float] | None = None
    source: tuple[Source, ...] = ()
    overrides: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    identity: str = ""

    # -- the solid in deck units ----------------------------------------------------------------

    @property
    def k_inf(self) -> float:
        """Equilibrium stiffness, deck units."""
        return self.units.stiffness(self.model.k_inf)

    @property
    def b(self) -> float:
        """Parallel dashpot, deck units."""
        return self.units.damping(self.model.b)

    @property
    def arms(self) -> tuple[tuple[float, float, float], ...]:
        """Each arm's k, tau, b = k tau, deck units."""
        return tuple(
            (self.units.stiffness(k), tau / self.units.time, self.units.damping(b))
            for k, tau, b in zip(self.model.k, self.model.tau, self.model.arm_b, strict=True)
        )

    @property
    def relative_moduli(self) -> tuple[float, ...]:
        """g_j = k_j / k_0."""
        return tuple(k / self.model.k_0 for k in self.model.k)

    # -- what it says of itself -----------------------------------------------------------------

    def header(
        self, comment: str, title: str, *, verified: str = NOT_VERIFIED, remarks: Sequence[str] = ()
    ) -> list[str]:
        """The comment lines that open a deck, each behind the target's comment sign."""
        units = self.units
        length, mass, time, force, stress = units.words
        lines = [
            f"dashpot {__version__}: {title}",
            (
                f"UNITS: {units.name}: {length}, {mass}, {time}, {force}, {stress}; frequency in "
                f"{units.frequency_word}"
            ),
            f"model: k_inf = {text(self.k_inf)} {units.stiffness_word}"
            + (f", b = {text(self.b)} {units.damping_word}" if self.b > 0 else ""),
            *(
                f"  arm {j}: k = {text(k)} {units.stiffness_word}, tau = {text(tau)} {time}, "
                f"b = {text(b)} {units.damping_word}{self._seen(j - 1)}"
                for j, (k, tau, b) in enumerate(self.arms, start=1)
            ),
            f"temperature: {self._temperature()}",
            f"contact length: {self._length()}",
            *self._sources(),
            self._band(),
            *(f"OVERRIDE: {sentence}" for sentence in self.overrides),
            *(f"CHECK FAILED: {sentence}" for sentence in self.doubts),
            verified,
            *remarks,
        ]
        return [f"{comment} {one_line(line)}" for line in lines]

    def extrapolated(self, frequency: float) -> bool:
        """True if the test says nothing of this frequency, Hz; False where no band is known."""
        return self.band is not None and not self.band[0] <= frequency <= self.band[1]

    def _seen(self, j: int) -> str:
        centre = 1 / (2 * math.pi * self.model.tau[j])
        return (
            f" [{centre:.4g} Hz lies outside the identified band]"
            if self.extrapolated(centre)
            else ""
        )

    def _temperature(self) -> str:
        kelvin = self.specimen.temperature
        return "not stated" if kelvin is None else f"{kelvin:.6g} K ({kelvin - 273.15:.4g} degC)"

    def _length(self) -> str:
        metres = self.specimen.length
        if metres is None:
            return "not stated"
        return f"{metres / self.units.length:.6g} {self.units.words[0]}"

    def _sources(self) -> list[str]:
        if not self.source:
            return ["source: a model in memory; no file is known to stand behind it"]
        lines = [f"fit: {self.identity}"] if self.identity else []
        lines += [f"source: {each.file} sha256 {each.sha256}" for each in self.source]
        if any(each.simulated for each in self.source):
            lines.append("SIMULATED: the test behind this deck was made by a virtual rig")
        return lines

    def _band(self) -> str:
        if self.band is None:
            return "identified band: not stated; nothing marks what is extrapolated"
        low, high = self.band
        return (
            f"identified band: {low:.4g} to {high:.4g} Hz; whatever lies outside is EXTRAPOLATED "
            "from the fitted arms"
        )
