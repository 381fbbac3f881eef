"""Result of a door on its seal."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.checks import Check, HasChecks
from dashpot.base.provenance import Source
from dashpot.base.result_mixins import HasVerdict, Series, collect_columns
from dashpot.base.serialisation import Key, Serialisable
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.random_response import RandomResponse
from dashpot.datamodel.seal_line import SealSection, Stations
from dashpot.extensions.systems.door.assembly import Assembly
from dashpot.extensions.systems.door.door_model import Door, DoorPoint
from dashpot.extensions.systems.door.modes import DoorMode
from dashpot.extensions.systems.door.mounts import SEAL
from dashpot.extensions.systems.door.seal_line import SealLine


@dataclass(frozen=True)
class BaseResponse(Serialisable):
    """Response of a point to random base motion, with and without the seal.

    Attributes
    ----------
    name : str
    sealed : RandomResponse
    bare : RandomResponse or None
        Response without the seal; None if there is no other damping.
    """

    _keys = (Key("point", "name"), "sealed", "bare")

    name: str
    sealed: RandomResponse
    bare: RandomResponse | None


class LineStatistics(NamedTuple):
    """Statistics of values along a line."""

    least: float
    mean: float
    most: float


class LateralStiffness(NamedTuple):
    """Statistics of the lateral stiffness along a line."""

    across: float
    along: float


@dataclass(frozen=True)
class SealOfDoor(Serialisable):
    """Seal along the line of a door.

    Attributes
    ----------
    line : SealLine
    section : SealSection
    along : Stations
    fit : Fit or None
        Fit of the seal, at its temperature.
    """

    _keys = (
        "line.length",
        Key("closed", "line.is_closed"),
        "stations",
        "pitch",
        "compression",
        "touching",
        "stiffness",
        Key("stiffness_per_metre", "section.solid.k_inf"),
        "sideways",
        Key("slip_limit", optional=True),
        "force",
        "line.joints",
        "fit.specimen.temperature",
        Key("band_hz", "fit.band"),
        Key("fit", "fit._identity"),
    )

    line: SealLine
    section: SealSection
    along: Stations
    fit: Fit | None

    @property
    def stations(self) -> int:
        """Number of stations."""
        return len(self.along.length)

    @property
    def pitch(self) -> float:
        """Average distance of the stations, m."""
        return float(self.along.length.mean())

    @property
    def compression(self) -> LineStatistics | None:
        """Compression, m; None if it is unknown."""
        x = self.along.compression
        return None if x is None else LineStatistics(x.min(), x.mean(), x.max())

    @property
    def touching(self) -> float | None:
        """Part of the line that touches."""
        x = self.along.compression
        return None if x is None else float((x >= 0).mean())

    @property
    def stiffness(self) -> float:
        """Stiffness at rest of the whole seal, N/m."""
        return self._compute_rest_stiffness(0)

    @property
    def sideways(self) -> LateralStiffness:
        """Lateral stiffness at rest of the whole seal, across and along the line, N/m."""
        return LateralStiffness(self._compute_rest_stiffness(1), self._compute_rest_stiffness(2))

    @property
    def slip_limit(self) -> float | None:
        """Motion sideways up to which no station slips, m; None without friction."""
        slip_ratios = [
            slips[sticks > 0] / sticks[sticks > 0]
            for direction in self.section.ways(self.along)
            if direction.friction is not None
            for sticks, slips in (direction.friction,)
        ]
        all_ratios = np.concatenate(slip_ratios) if slip_ratios else np.zeros(0)
        return float(all_ratios.min()) if len(all_ratios) else None

    def _compute_rest_stiffness(self, direction_index: int) -> float:
        direction = self.section.ways(self.along)[direction_index]
        return float(direction.solid.k_inf * direction.share.sum())

    @property
    def force(self) -> float | None:
        """Relaxed, of all of it, N."""
        x = self.along.compression
        if x is None:
            return None
        return float((self.along.length * self.along.factor) @ self.section.force(x))


@dataclass(frozen=True, repr=False)
class DoorResult(HasChecks, HasVerdict, Serialisable):
    """Result of ``dashpot predict`` on a door.

    Attributes
    ----------
    assembly : Assembly
    fit : Fit or None
        Fit of the seal, at its temperature.
    band : (float, float)
        Hz.
    modes : tuple of DoorMode
        Up to the end of the band.
    bare : tuple of float
        Natural frequencies without the seal, Hz.
    driven : DoorPoint
        Where the force acts.
    frfs : tuple of (str, FRF, FRF)
        The name of a point, its FRF with the seal and without.
    random : tuple of BaseResponse
    checks : tuple of Check
    """

    schema = "dashpot/door@2"
    _keys = (
        "seal",
        "modes",
        Key("without_seal_hz", "bare"),
        Key("frf", "responses"),
        "random",
        "verdict",
        "checks",
        Key("source", "sources"),
    )

    assembly: Assembly
    fit: Fit | None
    band: tuple[float, float]
    modes: tuple[DoorMode, ...]
    bare: tuple[float, ...]
    driven: DoorPoint
    frfs: tuple[tuple[str, FRF, FRF], ...]
    random: tuple[BaseResponse, ...]
    checks: tuple[Check, ...]

    @property
    def _table_columns(self) -> Series:
        """The modes, with the stored energy and the loss of the seal in each."""
        seal = [(mode.share(SEAL), mode.loss_share(SEAL)) for mode in self.modes]
        return {
            "mode": (list(range(1, len(self.modes) + 1)), ""),
            **collect_columns((mode.mode for mode in self.modes), frequency="Hz", damping_ratio=""),
            **collect_columns(self.modes, without_seal="Hz"),
            "seal_energy": ([energy for energy, _ in seal], ""),
            "seal_loss": ([loss for _, loss in seal], ""),
        }

    @property
    def door(self) -> Door:
        """Door with its seal, as its file describes it."""
        return self.assembly.door

    @property
    def _headline(self) -> str:
        """Change by the seal of the first mode in which it stores energy; else the first mode."""
        seal_modes = [mode for mode in self.modes if mode.share(SEAL) > 0]
        if not self.modes:
            return f"no mode lies below {self.band[1]:.3g} Hz"
        first = (seal_modes or list(self.modes))[0]
        number, hz = self.modes.index(first) + 1, first.mode.frequency
        if not seal_modes:
            return f"mode 1 lies at {hz:.3g} Hz"
        message = f"the seal stores {100 * first.share(SEAL):.2g} % of the energy of mode {number}"
        if first.without_seal is None:
            return f"{message} ({hz:.3g} Hz)"
        shift = hz - first.without_seal
        verb = "raises" if shift >= 0 else "lowers"
        return f"{message} ({hz:.3g} Hz) and {verb} it by {abs(shift):.2g} Hz"

    @property
    def stations(self) -> Stations | None:
        """Stations of the seal line."""
        line = self.door.line
        return None if line is None else line.stations(self.assembly.door.pitch)

    def extrapolation_factor(self, frequency: float) -> float:
        """Return the factor by which a frequency, Hz, lies outside the valid band of the seal.

        1 or less inside; nan where there is no test.
        """
        if self.fit is None:
            return math.nan
        low, high = self.fit.band
        return max(frequency / high, low / frequency) if high > 0 else math.inf

    @property
    def sources(self) -> tuple[Source, ...]:
        """The files behind it."""
        return list_sources(self.assembly, self.fit)

    @property
    def responses(self) -> dict[str, Any]:
        """The FRF of every point, by their names."""
        points = {
            name: {"sealed": sealed.value, "bare": bare_frf.value}
            for name, sealed, bare_frf in self.frfs
        }
        return {
            "force": self.driven.name,
            "kind": "accelerance",
            "frequency_hz": self.frfs[0][1].frequency if self.frfs else (),
            "points": points,
        }

    @property
    def seal(self) -> SealOfDoor | None:
        """Seal of the line; None without a seal."""
        line, stations = self.door.line, self.stations
        if line is None or stations is None or line.section is None:
            return None
        return SealOfDoor(line, line.section, stations, self.fit)


def list_sources(assembly: Assembly, fit: Fit | None) -> tuple[Source, ...]:
    """Return the files behind a door: its own, that of its modes, and those of its seal's fit."""
    sources = (assembly.door.source, None if assembly.modes is None else assembly.modes.source)
    return (
        *(source for source in sources if source is not None),
        *(fit.source if fit else ()),
    )
