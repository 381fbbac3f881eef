"""Response of a mass at a level on a nonlinear seal: resonance, harmonics and shift."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.base.reported_values import NORMAL, ReportedValue
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import format_quantity
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF, Kind
from dashpot.extensions.amplitude.amplitude_response import get_level_unit
from dashpot.extensions.amplitude.preloaded_mass import (
    Jump,
    Orbit,
    PreloadedMass,
    find_largest_orbit,
)
from dashpot.fitting.prediction_bounds import off_by_error
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import Solid
from dashpot.vibration.mass_on_seals import MassOnSeals, add_mount_mass

_LINES, _FINE_LINES, _LINE_RANGE = 121, 21, (0.25, 2.5)
"""Lines over the band and about the linear resonance, about the largest of these, and how far the
search goes."""
_REPORTED_HARMONICS, _MIN_HARMONIC_SHARE, _MAX_HALF_WIDTH = 3, 1e-3, 1.0
"""Harmonics that a text shows, the part of the first below which one is not known, and the half
width of an interval, in parts of the value, from which on it is none."""
_MIN_COMPRESSION_SHARE = 1e-3
"""Part of the tested compression below which no contact was tested."""
Ends = tuple[float, float]


@dataclass(frozen=True)
class LevelInterval(Serialisable):
    """95 % intervals of a resonance, from the errors of the solid and its elastic law.

    Where a sweep jumps down from the resonance its height is not reported, nor a number whose
    errors are as large as itself: those are no longer small, as the delta method takes them to be.

    Attributes
    ----------
    frequency : (float, float)
        Hz.
    value : (float, float) or None
    mean_shift : (float, float) or None
        Shift of the mean, m.
    harmonics : tuple of ((float, float) or None), or None
        Amplitudes, m, the mean first; not of those below a thousandth of the first, which show how
        a law bends between its knots.
    magnitude : array, shape (2, n)
        Magnitude of the response, at the lines of the FRF.
    """

    _keys = (Key("frequency_hz", "frequency"), "value", "mean_shift", "harmonics")

    frequency: Ends
    value: Ends | None
    mean_shift: Ends | None
    harmonics: tuple[Ends | None, ...] | None
    magnitude: FloatArray


@dataclass(frozen=True)
class PreloadedLevel(Serialisable):
    """Resonance of a preloaded mass at a level, under rising frequency.

    Attributes
    ----------
    level : float
        Amplitude of the force, N, or of the base's acceleration, m/s^2.
    unit : str
    frequency, value : float
        Frequency, Hz, and value of the largest magnitude of the stable responses.
    orbit : Orbit
        The answer there.
    doubled : Orbit
        That with the largest second harmonic.
    unsteady : tuple of (float, float)
        Between which frequencies no answer at the drive's period lasts, Hz.
    jumps : tuple of Jump
        Jumps between two responses at rising frequency; at falling frequency the second one
        persists.
    frf : FRF
        First harmonics over the band.
    interval : LevelInterval or None
        Where the errors of the fit are known.
    """

    _keys = (
        "level",
        "unit",
        "peak",
        "amplitude",
        "orbit.rest",
        Key("mean_shift", "orbit.shift"),
        Key("harmonics", "orbit.harmonic_amplitudes"),
        "orbit.phases",
        Key("floquet", "orbit.growth"),
        Key("lost_contact", "orbit.lost_contact"),
        "compression",
        "second_harmonic",
        "unsteady",
        "jumps_hz",
        "interval",
        "response",
    )

    level: float
    unit: str
    frequency: float
    value: float
    orbit: Orbit
    doubled: Orbit
    unsteady: tuple[tuple[float, float], ...]
    jumps: tuple[Jump, ...]
    frf: FRF
    interval: LevelInterval | None

    @property
    def peak(self) -> dict[str, float]:
        """Frequency and height of the peak by their names."""
        return {"frequency_hz": self.frequency, "value": self.value}

    @property
    def amplitude(self) -> float:
        """First harmonic of the compression there, m."""
        return float(self.orbit.amplitudes[1])

    @property
    def second_harmonic(self) -> dict[str, float]:
        """Largest second harmonic: frequency, Hz, amplitude, m, and the first harmonic there."""
        first, second = self.doubled.amplitudes[1:3].tolist()
        return {"frequency_hz": self.doubled.frequency, "amplitude": second, "first": first}

    @property
    def compression(self) -> float:
        """Greatest compression of both, m."""
        return max(self.orbit.most, self.doubled.most)

    @property
    def magnitude(self) -> FloatArray | None:
        """Interval of the magnitude of the response, shape (2, n), at the lines of `frf`."""
        return None if self.interval is None else self.interval.magnitude

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """The resonance, mean and harmonics, with their intervals."""
        interval, unknown_interval = self.interval, (np.nan, np.nan)
        level_text = f"at {self.level:.4g} {self.unit}"

        def fact(
            name: str, value: float, given_interval: Ends | None, unit: str, read: str = ""
        ) -> ReportedValue:
            low, high = given_interval or unknown_interval
            words = f"{name.replace('_', ' ')} {level_text}"
            error = None if given_interval or interval is None else math.inf
            return ReportedValue(name, value, low, high, unit, error, read, words)

        harmonics: Sequence[Ends | None] = (None,) * len(self.orbit.harmonic_amplitudes)
        if interval is not None and interval.harmonics is not None:
            harmonics = interval.harmonics
        amplitudes = self.orbit.harmonic_amplitudes.tolist()
        return (
            fact("peak_frequency", self.frequency, interval.frequency if interval else None, "Hz"),
            fact("peak_height", self.value, interval.value if interval else None, self.frf.unit),
            fact(
                "mean_shift", self.orbit.shift, interval.mean_shift if interval else None, "m", "mm"
            ),
            *(
                fact(f"harmonic_{h}", amplitudes[h], harmonics[h], "m", "mm")
                for h in range(1, _REPORTED_HARMONICS + 1)
            ),
        )

    @property
    def jumps_hz(self) -> list[float]:
        """Frequencies at which an upward sweep jumps, Hz."""
        return [jump.after.frequency for jump in self.jumps]

    @property
    def response(self) -> dict[str, Any]:
        """The first harmonic over the band, and between which magnitudes it lies."""
        frf = self.frf
        return {
            "frequency_hz": frf.frequency, "real": frf.value.real, "imag": frf.value.imag,
            "magnitude_between": self.magnitude,
        }  # fmt: skip


def preloaded_levels(
    fit: Fit,
    levels: Sequence[float],
    load: MassOnSeals,
    *,
    kind: Kind,
    around_hz: float,
    frequency: FloatArray,
) -> tuple[PreloadedLevel, ...]:
    """Return the resonance of a mass on seals at each level.

    Parameters
    ----------
    fit : Fit
        Fit of one seal, with a law that bends.
    levels : sequence of float
        N, or m/s^2 of a base.
    load : MassOnSeals
    kind : Kind
    around_hz : float
        The linear resonance, Hz.
    frequency : array, shape (n,)
        Frequency of the FRF, Hz; at most 121 lines of it are taken.

    Raises
    ------
    DataError
        If the law is linear, there is no static equilibrium, or no resonance is found.
    """
    if fit.elastic_law is None or fit.elastic_law.kind == "linear":
        raise DataError(
            "the elastic law of this fit is linear, so the response is the same at every "
            "amplitude. Leave out --amplitude, add a sweep of amplitudes (--sweep), or fit tests "
            "at several depths (dashpot fit FILE FILE)"
        )

    def build_preloaded_mass(law: ElasticLaw, solid: Solid) -> PreloadedMass:
        seal_law, at = load.seals * law, load.compression
        return PreloadedMass(
            load.mass, seal_law, solid, None if at is None else float(seal_law.force(at))
        )

    preloaded_mass = build_preloaded_mass(fit.elastic_law, fit.solid)
    if preloaded_mass.rest < _MIN_COMPRESSION_SHARE * fit.elastic_law.depth:
        raise DataError(
            f"the mass presses the seal by {format_quantity(preloaded_mass.rest, 'mm', '.2g')} "
            f"alone, and the tests reach to {format_quantity(fit.elastic_law.depth, 'mm', '.3g')}: "
            "so slight a contact was not tested; expected a thousandth of that, or more. Check "
            "the mass and its unit"
        )
    variant_masses = [
        build_preloaded_mass(*group) for group in _list_shifted_laws(fit, fit.elastic_law)
    ]
    band = frequency[:: -(-len(frequency) // _LINES)]
    rig = _LevelResponses(preloaded_mass, variant_masses, load, kind)
    return tuple(rig.compute_resonance(level, band, around_hz) for level in levels)


def _list_shifted_laws(fit: Fit, law: ElasticLaw) -> list[tuple[ElasticLaw, Solid]]:
    """The law and the solid one standard error off: by each axis of the solid's, by each knot."""
    variants = [
        (replace(law, stiffness=law.stiffness * solid.k_inf / fit.solid.k_inf), solid)
        for solid in off_by_error(fit)
    ]
    for i, error in enumerate(law.ratio_se if variants else ()):
        if error > 0:
            ratio = np.array(law.ratio)
            ratio[i] += error
            mean = float(np.trapezoid(ratio, law.knots)) / law.depth
            variants.append((replace(law, ratio=tuple((ratio / mean).tolist())), fit.solid))
    return variants


@dataclass(frozen=True)
class _LevelResponses:
    """Responses of a preloaded mass, and of masses with one parameter off by its standard error."""

    preloaded_mass: PreloadedMass
    perturbed_masses: Sequence[PreloadedMass]
    mass_on_seals: MassOnSeals
    kind: Kind

    def compute_resonance(self, level: float, band: FloatArray, around_hz: float) -> PreloadedLevel:
        """Return the resonance at a level, N or m/s^2."""
        force = self.mass_on_seals.mass * level if self.kind.over_base else level
        if force >= self.preloaded_mass.static_force:
            raise DataError(
                f"an amplitude of {level:.4g} {get_level_unit(self.kind)} lifts the mass off the "
                f"seal: its force is {force:.4g} N, and {self.preloaded_mass.static_force:.4g} N "
                "presses; expected less. Ask for a lower amplitude"
            )
        range_hz = around_hz * _LINE_RANGE[0], around_hz * _LINE_RANGE[1]
        lines = np.union1d(band, np.geomspace(*range_hz, _LINES))
        orbits_in_sweep = self.preloaded_mass.sweep(level=force, frequency=lines)
        stable_orbits = [orbit for orbit in orbits_in_sweep if orbit.stable]
        near_orbits = [
            orbit for orbit in stable_orbits if range_hz[0] <= orbit.frequency <= range_hz[1]
        ]
        peak_index = (
            int(np.argmax([self.response_magnitude(orbit) for orbit in near_orbits]))
            if near_orbits
            else 0
        )
        if peak_index in {0, max(len(near_orbits) - 1, 0)}:
            raise DataError(
                f"at {level:g} {get_level_unit(self.kind)} no resonance is found between "
                f"{range_hz[0]:.4g} and {range_hz[1]:.4g} Hz, of steady responses; ask for a lower "
                "amplitude"
            )
        jumps = self.preloaded_mass.jumps(orbits_in_sweep)
        jump_into, jump_out = _find_adjacent_jumps(
            near_orbits[peak_index - 1], near_orbits[peak_index], near_orbits[peak_index + 1], jumps
        )
        run, best = self._summit(
            force,
            jump_into.after if jump_into else near_orbits[peak_index - 1],
            jump_out.before if jump_out else near_orbits[peak_index + 1],
        )
        # both sides of a jump, between which nothing is to be drawn
        orbits = {
            end.frequency: end for end in (*stable_orbits, *(end for jump in jumps for end in jump))
        }
        shown_orbits = [orbits[hz] for hz in sorted(orbits) if band[0] <= hz <= band[-1]]
        return PreloadedLevel(
            level,
            get_level_unit(self.kind),
            run[best].frequency,
            self.response_magnitude(run[best]),
            run[best],
            find_largest_orbit(near_orbits, 2),
            _find_unsteady_runs(lines, stable_orbits),
            jumps,
            self.frf(shown_orbits),
            self.interval(run, best, jump_into, shown_orbits),
        )

    def _summit(self, force: float, start: Orbit, last: Orbit) -> tuple[list[Orbit], int]:
        """Return the responses that last between two, and which of them is the largest."""
        fine_lines = np.linspace(start.frequency, last.frequency, _FINE_LINES)[1:-1]
        about_top = self.preloaded_mass.sweep(level=force, frequency=fine_lines, start=start)
        run = [start, *(orbit for orbit in about_top if orbit.stable), last]
        best_index = int(np.argmax([self.response_magnitude(orbit) for orbit in run]))
        if 0 < best_index < len(run) - 1:
            # between the lines, where the parabola through three is highest
            top_orbits = run[best_index - 1 : best_index + 2]
            curvature, slope, _ = _fit_parabola(top_orbits) @ np.log(
                [self.response_magnitude(orbit) for orbit in top_orbits]
            )
            near_top = np.array([top_orbits[1].frequency - slope / (2 * curvature)])
            summit = self.preloaded_mass.sweep(level=force, frequency=near_top, start=top_orbits[1])
            run[best_index : best_index + 1] = [
                orbit for orbit in summit if orbit.stable
            ] or top_orbits[1:2]
        return run, best_index

    def frf(self, orbits: Sequence[Orbit], motion: complex = 0.0) -> FRF:
        """First harmonics, all changed by so much, m, as the kind has them."""
        f = np.array([orbit.frequency for orbit in orbits])
        force = np.array([orbit.level for orbit in orbits])
        response = np.array([complex(orbit.harmonics[1]) for orbit in orbits]) + motion
        H = np.asarray(response / force, dtype=complex)
        if not self.kind.over_base:
            return FRF.from_receptance(f, H, kind=self.kind)
        T: ComplexArray = np.asarray(1 + self.mass_on_seals.mass * (2 * np.pi * f) ** 2 * H)
        frf = FRF(f, T, Kind.TRANSMISSIBILITY, units="SI").to(self.kind)
        coupled = self.mass_on_seals.coupled
        return (
            add_mount_mass(frf, mass=self.mass_on_seals.mass, coupled=coupled)
            if coupled > 0
            else frf
        )

    def response_magnitude(self, orbit: Orbit) -> float:
        """Magnitude of the response."""
        return float(np.abs(self.frf([orbit]).value[0]))

    # -- what the errors leave open ---------------------------------------------------------------

    def interval(
        self, run: Sequence[Orbit], best: int, jump_into: Jump | None, shown_orbits: Sequence[Orbit]
    ) -> LevelInterval | None:
        r"""Return the 95 % interval by the delta method; None if the error is unknown.

        The largest of :math:`L(f) = \ln|H|` stays where its slope is 0:
        :math:`\Delta f = -(\partial \Delta L/\partial f) / L''`; beside a jump it moves with it.
        """
        if not self.perturbed_masses:
            return None
        response, f = (
            np.abs(self.frf(shown_orbits).value),
            [orbit.frequency for orbit in shown_orbits],
        )
        errors = [_compute_norm(self._log_changes(orbit)) for orbit in shown_orbits[::_LINE_STRIDE]]
        error_factor = np.exp(NORMAL * np.interp(f, f[::_LINE_STRIDE], errors))
        magnitude = np.array([response / error_factor, response * error_factor])
        peak_orbit, first, last = run[best], best == 0, best == len(run) - 1
        if first or last:
            end = peak_orbit if jump_into is None or last else jump_into.before
            shift = self.preloaded_mass.end_changes(end, self.perturbed_masses)
        else:
            shift = self._compute_frequency_shifts(run[best - 1 : best + 2])
        frequency = _compute_interval(peak_orbit.frequency, shift)
        if last:
            return LevelInterval(frequency, None, None, None, magnitude)
        by_frequency = self._slopes(run[:2] if first else run[best - 1 : best + 2])
        log_slope = by_frequency(lambda orbit: np.log(self.response_magnitude(orbit)))
        value = self.response_magnitude(peak_orbit) * np.exp(
            NORMAL * _compute_norm(self._log_changes(peak_orbit) + log_slope * shift) * _SIGNS
        )
        count = len(peak_orbit.harmonic_amplitudes)
        rotation = np.conj(peak_orbit.harmonics[:count]) / np.maximum(
            peak_orbit.harmonic_amplitudes, 1e-300
        )
        real = (
            rotation * self.preloaded_mass.changes(peak_orbit, self.perturbed_masses)[:, :count]
        ).real
        real += np.outer(shift, by_frequency(lambda orbit: orbit.harmonic_amplitudes))
        rest_changes = np.array([other.rest for other in self.perturbed_masses]) - peak_orbit.rest
        low, high = value.tolist()
        return LevelInterval(
            frequency,
            (low, high)
            if high < (1 + _MAX_HALF_WIDTH) * self.response_magnitude(peak_orbit)
            else None,
            _compute_narrow_interval(peak_orbit.shift, real[:, 0] - rest_changes),
            tuple(
                _compute_narrow_interval(float(number), real[:, h])
                if number > _MIN_HARMONIC_SHARE * peak_orbit.harmonic_amplitudes[1]
                else None
                for h, number in enumerate(peak_orbit.harmonic_amplitudes)
            ),
            magnitude,
        )

    def _log_changes(self, orbit: Orbit) -> FloatArray:
        """Return the change of the logarithm of the response for each of the other masses."""
        first = complex(orbit.harmonics[1])
        part = _SLOPE_SHARE * first
        value, changed_value = (complex(self.frf([orbit], off).value[0]) for off in (0.0, -part))
        change = self.preloaded_mass.changes(orbit, self.perturbed_masses)[:, 1]
        return np.asarray(((value - changed_value) / part / value * change).real)

    def _compute_frequency_shifts(self, top_orbits: Sequence[Orbit]) -> FloatArray:
        """Return the shift of the largest response for each of the other masses, Hz."""
        curvature, slope, _ = _fit_parabola(top_orbits)
        size = np.log([self.response_magnitude(orbit) for orbit in top_orbits])
        return np.asarray(
            -(slope @ [self._log_changes(orbit) for orbit in top_orbits]) / (2 * curvature @ size)
        )

    @staticmethod
    def _slopes(orbits: Sequence[Orbit]) -> Callable[[Callable[[Orbit], Any]], Any]:
        """Return a function for derivatives by frequency at the middle of three orbits or two."""
        if len(orbits) == 2:
            difference = orbits[1].frequency - orbits[0].frequency
            return lambda function: (function(orbits[1]) - function(orbits[0])) / difference
        return lambda function: _fit_parabola(orbits)[1] @ [function(orbit) for orbit in orbits]


def _find_adjacent_jumps(
    low: Orbit, peak_orbit: Orbit, high: Orbit, jumps: Sequence[Jump]
) -> tuple[Jump | None, Jump | None]:
    """The jump into the largest response from the one below it, and out of it to the one above."""
    jumps_into = (
        jump for jump in jumps if low.frequency < jump.after.frequency <= peak_orbit.frequency
    )
    jumps_out = (
        jump for jump in jumps if peak_orbit.frequency <= jump.before.frequency < high.frequency
    )
    return next(jumps_into, None), next(jumps_out, None)


def _fit_parabola(orbits: Sequence[Orbit]) -> FloatArray:
    """Return the matrix that maps three values to the bend, slope and height of their parabola."""
    f = np.array([orbit.frequency for orbit in orbits])
    return np.asarray(np.linalg.inv(np.vander(f - f[1], 3)))


_SIGNS = np.array([-1.0, 1.0])
_SLOPE_SHARE, _LINE_STRIDE = 1e-3, 3
"""Share of the first harmonic by which a slope is determined; every so many lines, errors."""


def _compute_norm(change: FloatArray) -> float:
    return float(np.linalg.norm(change))


def _compute_interval(value: float, change: FloatArray) -> Ends:
    """Return the 95 % interval of a value that independent errors move by so much each."""
    half_width = NORMAL * _compute_norm(change)
    return value - half_width, value + half_width


def _compute_narrow_interval(value: float, change: FloatArray) -> Ends | None:
    """Return the interval of a value, if it is narrower than the value."""
    interval = _compute_interval(value, change)
    return interval if interval[1] - value < _MAX_HALF_WIDTH * abs(value) else None


def _find_unsteady_runs(
    lines: FloatArray, stable_orbits: Sequence[Orbit]
) -> tuple[tuple[float, float], ...]:
    """Runs of lines without an answer that lasts, Hz."""
    is_missing = ~np.isin(lines, [orbit.frequency for orbit in stable_orbits])
    turns = np.flatnonzero(np.diff(np.concatenate(([0], is_missing.astype(int), [0]))))
    return tuple(
        (float(lines[a]), float(lines[b - 1])) for a, b in zip(turns[::2], turns[1::2], strict=True)
    )
