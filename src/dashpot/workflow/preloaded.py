"""A mass at a level on a seal whose own elastic law bends: its resonance, harmonics and shift."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.documents import Documented
from dashpot.base.errors import DataError
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF, Kind
from dashpot.vibration.systems.mounts import on_heavy_mounts
from dashpot.vibration.systems.preloaded import Orbit, PreloadedMass, largest
from dashpot.workflow.at_level import unit_of

_LINES, _FINE, _REACH = 121, 21, (0.25, 2.5)
"""Lines over the band and about the linear resonance, about the largest of these, and how far the
search goes."""


@dataclass(frozen=True)
class PreloadedLevel(Documented):
    """The resonance of a pressed mass at a level.

    Attributes
    ----------
    level : float
        Amplitude of the force, N, or of the base's acceleration, m/s^2.
    unit : str
    frequency, value : float
        Of the largest magnitude of answers that last, Hz, and that magnitude.
    orbit : Orbit
        The answer there.
    doubled : Orbit
        That with the largest second harmonic.
    unsteady : tuple of (float, float)
        Between which frequencies no answer at the drive's period lasts, Hz.
    frf : FRF
        First harmonics over the band.
    """

    keys = (
        "level", "unit", "peak", "amplitude", "orbit.rest", "mean_shift=orbit.shift",
        "harmonics=orbit.shown", "phases=orbit.phases", "floquet=orbit.growth",
        "lost_contact=orbit.lost", "compression=deepest", "second_harmonic", "unsteady",
    )  # fmt: skip

    level: float
    unit: str
    frequency: float
    value: float
    orbit: Orbit
    doubled: Orbit
    unsteady: tuple[tuple[float, float], ...]
    frf: FRF

    @property
    def peak(self) -> dict[str, float]:
        """Its numbers by their names."""
        return {"frequency_hz": self.frequency, "value": self.value}

    @property
    def amplitude(self) -> float:
        """First harmonic of the compression there, m."""
        return float(self.orbit.amplitudes[1])

    @property
    def second_harmonic(self) -> dict[str, float]:
        """Where it is largest, Hz, how large, m, and beside which first one."""
        first, second = self.doubled.amplitudes[1:3].tolist()
        return {"frequency_hz": self.doubled.frequency, "amplitude": second, "first": first}

    @property
    def deepest(self) -> float:
        """Greatest compression of both, m."""
        return max(self.orbit.most, self.doubled.most)


def preloaded_levels(
    fit: Fit,
    levels: Sequence[float],
    *,
    mass: float,
    seals: float,
    kind: Kind,
    about: float,
    frequency: FloatArray,
    compression: float | None = None,
    coupled: float = 0.0,
) -> tuple[PreloadedLevel, ...]:
    """The resonance of a mass on seals at each level.

    Parameters
    ----------
    fit : Fit
        Of one seal, with a law that bends.
    levels : sequence of float
        N, or m/s^2 of a base.
    mass, coupled : float
        What moves, and what couples it to a base, kg.
    seals : float
    kind : Kind
    about : float
        The linear resonance, Hz.
    frequency : array, shape (n,)
        Of the FRF, Hz; at most 121 lines of it are taken.
    compression : float, optional
        At rest, m; by default that of the weight.

    Raises
    ------
    DataError
        If the law does not bend, nothing rests, or no resonance is found.
    """
    if fit.elastic_law is None or fit.elastic_law.kind == "linear":
        raise DataError(
            "a level changes what bends, and the elastic law of this fit does not: add a sweep "
            "(--sweep), fit tests at several depths (dashpot fit FILE FILE), or leave out --level"
        )
    law = seals * fit.elastic_law
    preload = None if compression is None else float(law.force(compression))
    pressed = PreloadedMass(mass, law, fit.solid, preload)
    band = frequency[:: -(-len(frequency) // _LINES)]
    ends = about * _REACH[0], about * _REACH[1]
    lines = np.union1d(band, np.geomspace(*ends, _LINES))
    found = []
    for level in levels:
        force = mass * level if kind.over_base else level
        swept = pressed.sweep(level=force, frequency=lines)
        lasting = [one for one in swept if one.stable]

        def frf(orbits: Sequence[Orbit], force: float = force) -> FRF:
            f = np.array([one.frequency for one in orbits])
            shaken = np.array([complex(one.harmonics[1]) for one in orbits])
            H = np.asarray(shaken / force, dtype=complex)
            if not kind.over_base:
                return FRF.of_receptance(f, H, kind=kind)
            T: ComplexArray = np.asarray(1 + mass * (2 * np.pi * f) ** 2 * H)
            answer = FRF(f, T, Kind.TRANSMISSIBILITY, units="SI").to(kind)
            return on_heavy_mounts(answer, mass=mass, coupled=coupled) if coupled > 0 else answer

        near = [one for one in lasting if ends[0] <= one.frequency <= ends[1]]
        size = np.abs(frf(near).value) if near else np.zeros(1)
        top = int(size.argmax())
        if top in {0, len(size) - 1}:
            raise DataError(
                f"at {level:g} {unit_of(kind)} no resonance is found between {ends[0]:.4g} and "
                f"{ends[1]:.4g} Hz, of answers that last; ask for a lower level"
            )
        about_top = np.linspace(near[top - 1].frequency, near[top + 1].frequency, _FINE)
        fine = [one for one in pressed.sweep(level=force, frequency=about_top) if one.stable]
        best = max((near[top], *fine), key=lambda one: float(np.abs(frf([one]).value[0])))
        shown = [one for one in lasting if band[0] <= one.frequency <= band[-1]]
        found.append(
            PreloadedLevel(
                level,
                unit_of(kind),
                best.frequency,
                float(np.abs(frf([best]).value[0])),
                best,
                largest(near, 2),
                _unsteady(lines, lasting),
                frf(shown),
            )
        )
    return tuple(found)


def _unsteady(lines: FloatArray, lasting: Sequence[Orbit]) -> tuple[tuple[float, float], ...]:
    """Runs of lines without an answer that lasts, Hz."""
    gone = ~np.isin(lines, [one.frequency for one in lasting])
    turns = np.flatnonzero(np.diff(np.concatenate(([0], gone.astype(int), [0]))))
    return tuple(
        (float(lines[a]), float(lines[b - 1])) for a, b in zip(turns[::2], turns[1::2], strict=True)
    )
