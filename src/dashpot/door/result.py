"""What was found of a door on its seal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.checks import Check, Checked
from dashpot.base.documents import Documented
from dashpot.base.provenance import Source
from dashpot.door.assembly import Assembly
from dashpot.door.modes import DoorMode
from dashpot.door.record import Door, DoorPoint
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF
from dashpot.records.seal_line import Joint, Stations
from dashpot.vibration.systems.random_base import RandomResponse


@dataclass(frozen=True)
class Shaken(Documented):
    """A place over a base that shakes at random, with the seal and without.

    Attributes
    ----------
    name : str
    sealed : RandomResponse
    bare : RandomResponse or None
        None where nothing else damps what the base shakes.
    """

    keys = ("point=name", "sealed", "bare")

    name: str
    sealed: RandomResponse
    bare: RandomResponse | None


class AlongLine(NamedTuple):
    """Of values along a line."""

    least: float
    mean: float
    most: float


class SealOfDoor(NamedTuple):
    """What lies along the line of a door.

    Attributes
    ----------
    length : float
        m.
    closed : bool
        Whether the line is.
    stations : int
        At a distance of `pitch`, m.
    pitch : float
    compression : AlongLine or None
        m; None where it is not known.
    touching : float or None
        Part of the line that touches.
    stiffness, stiffness_per_metre : float
        At rest, of all of it, N/m, and of a metre.
    force : float or None
        Relaxed, of all of it, N.
    joints : tuple of Joint
    temperature : float or None
        K.
    band_hz : (float, float) or None
        Which its test informs.
    fit : str or None
        The fit's identity.
    """

    length: float
    closed: bool
    stations: int
    pitch: float
    compression: AlongLine | None
    touching: float | None
    stiffness: float
    stiffness_per_metre: float
    force: float | None
    joints: tuple[Joint, ...]
    temperature: float | None
    band_hz: tuple[float, float] | None
    fit: str | None


@dataclass(frozen=True)
class DoorResult(Checked, Documented):
    """What ``dashpot door`` found.

    Attributes
    ----------
    assembly : Assembly
    fit : Fit or None
        Of the seal, at its temperature.
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
    shaken : tuple of Shaken
    checks : tuple of Check
    """

    schema = "dashpot/door@1"
    keys = (
        "seal", "modes", "without_seal_hz=bare", "frf=responses", "random=shaken", "verdict",
        "checks", "source=sources",
    )  # fmt: skip

    assembly: Assembly
    fit: Fit | None
    band: tuple[float, float]
    modes: tuple[DoorMode, ...]
    bare: tuple[float, ...]
    driven: DoorPoint
    frfs: tuple[tuple[str, FRF, FRF], ...]
    shaken: tuple[Shaken, ...]
    checks: tuple[Check, ...]

    @property
    def door(self) -> Door:
        """As its file describes it, with the seal."""
        return self.assembly.door

    @property
    def stations(self) -> Stations | None:
        """Of the seal line."""
        line = self.door.line
        return None if line is None else line.stations(self.assembly.door.pitch)

    @property
    def sources(self) -> tuple[Source, ...]:
        """The files behind it."""
        modes = self.assembly.modes
        known = (self.door.source, None if modes is None else modes.source)
        return (*(one for one in known if one is not None), *(self.fit.source if self.fit else ()))

    @property
    def responses(self) -> dict[str, Any]:
        """The FRF of every point, by their names."""
        points = {
            name: {"sealed": sealed.value, "bare": bare.value} for name, sealed, bare in self.frfs
        }
        return {
            "force": self.driven.name,
            "kind": "accelerance",
            "frequency_hz": self.frfs[0][1].frequency if self.frfs else (),
            "points": points,
        }

    @property
    def seal(self) -> SealOfDoor | None:
        """What lies along the line; None without a seal."""
        door, stations, fit = self.door, self.stations, self.fit
        if door.line is None or stations is None or door.line.section is None:
            return None
        section, pressed = door.line.section, stations.compression
        share = stations.length * stations.factor
        factor = np.ones_like(share) if pressed is None else section.factor(pressed)
        return SealOfDoor(
            door.line.length,
            door.line.closed,
            len(share),
            float(stations.length[0]),
            None if pressed is None else AlongLine(pressed.min(), pressed.mean(), pressed.max()),
            None if pressed is None else float((pressed >= 0).mean()),
            float(section.solid.k_inf * (share @ factor)),
            section.solid.k_inf,
            None if pressed is None else float(share @ section.force(pressed)),
            door.line.joints,
            None if fit is None else fit.specimen.temperature,
            None if fit is None else fit.band,
            None if fit is None else fit.identity,
        )
