"""What was found of a door that closes."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dashpot.base.checks import Check, Checked
from dashpot.base.provenance import Source
from dashpot.door.record import Door
from dashpot.door.slam import Closing, Scatter
from dashpot.records.fit import Fit


@dataclass(frozen=True)
class ClosingResult(Checked):
    """What ``dashpot door --close`` found.

    Attributes
    ----------
    door : Door
    fit : Fit or None
        Of the seal, at its temperature.
    closing : Closing
    checks : tuple of Check
    """

    door: Door
    fit: Fit | None
    closing: Closing
    checks: tuple[Check, ...]

    @property
    def sources(self) -> tuple[Source, ...]:
        """The files behind it."""
        own = () if self.door.source is None else (self.door.source,)
        return (*own, *(self.fit.source if self.fit else ()))

    @property
    def document(self) -> dict[str, Any]:
        """``dashpot/closing@1``."""
        found = self.closing
        done = found.march
        return {
            "schema": "dashpot/closing@1",
            "speed": found.speed,
            "edge": found.door.edge,
            "inertia": found.door.inertia,
            "latched": found.latched,
            "energy": found.energy,
            "energy_left": found.left,
            "stopped": found.stopped,
            "rebound": found.rebound,
            "time": found.seconds,
            "sealing_time": found.sealing,
            "terms": [
                {
                    "name": one.name, "work": one.work, "stored": _known(one.stored),
                    "lost": _known(one.lost), "peak_moment": one.moment,
                }
                for one in found.terms
            ],
            "peak_pressure": {name: float(each.max()) for name, each in done.pressure.items()},
            "least_speed": _known(found.minimum),
            "least_speed_interval": None
            if found.interval is None
            else [_known(one) for one in found.interval],
            "least_compression": float(found.door.compression.min()),
            "least_contact_force": float(found.door.section.force(found.door.compression).min()),
            "scatter": None if found.scatter is None else _scatter(found.scatter),
            "history": {
                "time": done.time[:, 0].tolist(),
                "angle": done.angle.tolist(),
                "kinetic": [_known(one) for one in done.kinetic[:, 0].tolist()],
            },
            "verdict": self.verdict.document,
            "checks": [check.document for check in self.checks],
            "source": [asdict(one) for one in self.sources],
        }  # fmt: skip


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _scatter(found: Scatter) -> dict[str, Any]:
    return {
        **asdict(found.variation),
        "least_speed": [_known(one) for one in found.speed.tolist()],
        "least_speed_95": _known(found.quantile(0.95)),
        "above_limit": found.above,
        "leaking": found.leaking,
        "least_compression": found.least.tolist(),
        "least_contact_force": found.contact.tolist(),
    }
