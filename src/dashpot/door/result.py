"""What was found of a door on its seal."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Checked
from dashpot.base.provenance import Source
from dashpot.door.assembly import Assembly
from dashpot.door.modes import DoorMode
from dashpot.door.record import Door, DoorPoint
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF
from dashpot.records.seal_line import Stations
from dashpot.vibration.systems.random_base import RandomResponse


@dataclass(frozen=True)
class Shaken:
    """A place over a base that shakes at random, with the seal and without.

    Attributes
    ----------
    name : str
    sealed : RandomResponse
    bare : RandomResponse or None
        None where nothing else damps what the base shakes.
    """

    name: str
    sealed: RandomResponse
    bare: RandomResponse | None


@dataclass(frozen=True)
class DoorResult(Checked):
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
    def document(self) -> dict[str, Any]:
        """``dashpot/door@1``."""
        return {
            "schema": "dashpot/door@1",
            "seal": _seal(self),
            "modes": [
                {
                    "frequency_hz": one.mode.frequency,
                    "damping_ratio": one.mode.damping_ratio,
                    "loss_factor": one.loss_factor,
                    "without_seal_hz": one.without_seal,
                    "shares": [asdict(share) for share in one.shares],
                }
                for one in self.modes
            ],
            "without_seal_hz": list(self.bare),
            "frf": {
                "force": self.driven.name,
                "kind": "accelerance",
                "frequency_hz": self.frfs[0][1].frequency.tolist() if self.frfs else [],
                "points": {
                    name: {"sealed": _parts(sealed), "bare": _parts(bare)}
                    for name, sealed, bare in self.frfs
                },
            },
            "random": [
                {
                    "point": one.name,
                    "sealed": asdict(one.sealed),
                    "bare": None if one.bare is None else asdict(one.bare),
                }
                for one in self.shaken
            ],
            "verdict": self.verdict.document,
            "checks": [check.document for check in self.checks],
            "source": [asdict(one) for one in self.sources],
        }


def _seal(found: DoorResult) -> dict[str, Any] | None:
    """What lies along the line: its length, stations, compression, stiffness and closed force."""
    door, stations = found.door, found.stations
    if door.line is None or stations is None or door.line.section is None:
        return None
    section, pressed = door.line.section, stations.compression
    share = stations.length * stations.factor
    factor = np.ones_like(share) if pressed is None else section.factor(pressed)
    return {
        "length": door.line.length,
        "closed": door.line.closed,
        "stations": len(share),
        "pitch": float(stations.length[0]),
        "compression": None if pressed is None else _spread(pressed),
        "touching": None if pressed is None else float((pressed >= 0).mean()),
        "stiffness": float(section.solid.k_inf * (share @ factor)),
        "stiffness_per_metre": section.solid.k_inf,
        "force": None if pressed is None else float(share @ section.force(pressed)),
        "joints": [asdict(joint) for joint in door.line.joints],
        "temperature": None if found.fit is None else found.fit.specimen.temperature,
        "band_hz": None if found.fit is None else list(found.fit.band),
        "fit": None if found.fit is None else found.fit.identity,
    }


def _spread(values: FloatArray) -> dict[str, float]:
    return {
        "least": float(values.min()), "mean": float(values.mean()), "most": float(values.max())
    }  # fmt: skip


def _parts(frf: FRF) -> dict[str, list[float]]:
    return {"real": frf.value.real.tolist(), "imag": frf.value.imag.tolist()}
