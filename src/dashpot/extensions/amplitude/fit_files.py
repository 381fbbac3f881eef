"""Fit of amplitude dependence to files, and prediction of a mass at another level."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray, median
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import ReadError
from dashpot.base.provenance import Source
from dashpot.base.result_mixins import HasVerdict, Series, collect_columns
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.extensions.amplitude.amplitude_response import HITS, amplitude_file
from dashpot.extensions.amplitude.checks import (
    amplitude_in_tested_range,
    levels_as_stated,
    loops_not_clipped,
)
from dashpot.extensions.amplitude.datamodel import AmplitudeFit, AmplitudeSweep, LoopRecord
from dashpot.extensions.amplitude.fit import fit_amplitude
from dashpot.extensions.amplitude.fit_frfs import fit_levels
from dashpot.extensions.amplitude.hits_by_amplitude import HitLevels, hits_as_levels
from dashpot.extensions.amplitude.level_results import Elements, LevelFit, PeakAtLevel
from dashpot.extensions.amplitude.preprocess import (
    compute_sweep,
    find_flat_part,
    find_steady_cycles,
)
from dashpot.extensions.amplitude.response import resonance_at_level
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.impact import read_impacts
from dashpot.registry import RESPONSES
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.impact.hits import cut_hits
from dashpot.workflow.job import require_test_for_machine
from dashpot.workflow.measured_frf import as_measured


@dataclass(frozen=True, repr=False)
class AmplitudeResult(HasVerdict, Serialisable):
    """Result of ``dashpot fit`` on tests at several amplitudes.

    Attributes
    ----------
    fit : AmplitudeFit, LevelFit or HitLevels
    peaks : tuple of PeakAtLevel
        The levels that were requested.
    checks : tuple of Check
    records : tuple of AmplitudeSweep, RelaxationTest, StressStrainLoops or FRF
        Fitted records: one sweep, one record of loops, or the FRF of each level.

    Examples
    --------
    >>> import dashpot as dp
    >>> hits = dp.simulate("impact", hits=4)
    >>> type(dp.fit(hits, hits, levels=["3N", "3N"])).__name__  # doctest: +SKIP
    'AmplitudeResult'
    """

    schema = "dashpot/levels@2"
    _keys = (
        "fit.amplitudes",
        "verdict",
        "checks",
        Key("fit", flatten=True),
        Key("peaks", "requested_levels", optional=True),
    )

    fit: AmplitudeFit | LevelFit | HitLevels
    peaks: tuple[PeakAtLevel, ...]
    checks: tuple[Check, ...]
    records: tuple[AmplitudeSweep | LoopRecord | FRF, ...]

    @property
    def _table_columns(self) -> Series:
        """Columns of the fit; of hits each with its motion, resonance and damping."""
        if isinstance(self.fit, HitLevels):
            return collect_columns(
                self.fit.hits, name="", peak="N", amplitude="m", frequency_hz="Hz", damping_ratio=""
            )
        return self.fit._table_columns

    @property
    def verdict(self) -> Verdict:
        """Verdict on the fit."""
        return verdict(self.checks, headline=self.fit._headline)

    @property
    def source(self) -> tuple[Source, ...]:
        """The files."""
        source = self.fit.source
        if isinstance(source, Source):
            return (source,)
        return source or ()

    @property
    def loss_per_lag(self) -> float | None:
        """Change of the loss per lag, from the fit of recorded loops."""
        return self.fit.loss_per_lag if isinstance(self.fit, AmplitudeFit) else None

    @property
    def requested_levels(self) -> tuple[PeakAtLevel, ...] | None:
        """Return the requested levels; None for one sweep or record of loops, which has none."""
        return None if isinstance(self.fit, AmplitudeFit) else self.peaks

    def to_dict(self) -> dict[str, Any]:
        """``dashpot/levels@2``; of FRFs as their fit writes it, which is read again."""
        if isinstance(self.fit, LevelFit):
            return replace(self.fit, checks=self.checks, peaks=self.peaks).to_dict()
        return super().to_dict()


def level_files(
    files: Sequence[str | Path],
    *,
    levels: Sequence[Quantity] = (),
    mass: float | None = None,
    seals: float = 1.0,
    band: tuple[float, float] | None = None,
    at: Sequence[float] = (),
    law: str = "auto",
    motion: str = "absolute",
    machine: Machine | None = None,
    options: ReadOptions | None = None,
) -> AmplitudeResult:
    """Find how stiffness and damping move with amplitude.

    Parameters
    ----------
    files : sequence of path
        One amplitude sweep, one record of loops, FRFs of one mass at several amplitudes, or hits of
        different height.
    levels : sequence of str or float
        For the FRFs: amplitude of the force, N, one for each file; of transmissibilities that of
        the base's acceleration, m/s^2. Of hammer files: peak force of their hits, N, which is held
        against the records; these count.
    mass : float, optional
        Under those FRFs, kg; or the struck mass, compared with the mass by the hits.
    seals : float
    band : (float, float), optional
        Lines taken, or where the resonance of the hits lies, Hz.
    at : sequence of float
        Levels at which the resonance of that mass, or of the one that was struck, is wanted, N.
    law : str
        For an amplitude sweep or loops: ``"auto"`` or one of ``kinds.level.laws.LAWS``.
    motion : str
        Motion of the mass in transmissibilities: ``"absolute"``, or ``"relative"`` to the base.
    machine : Machine, optional
        Known properties of the machine that recorded loops: its `sync`.
    options : ReadOptions, optional
        Reading options of the files.
    """
    kinds = [recognise(path, options).kind for path in files]
    if any(kind in RESPONSES or kind in HITS for kind in kinds):
        require_test_for_machine(machine, tests=0, add="recorded loops")
    if all(kind in RESPONSES for kind in kinds):
        _refuse_law(law, "FRFs")
        frfs = [as_measured(read_frf(path, options=options), motion) for path in files]
        return frfs_at_levels(frfs, levels, mass=mass, seals=seals, band=band, at=at)
    all_hits = all(kind in HITS for kind in kinds)
    _refuse_mixture(files, kinds)
    request = {
        "--amplitude": levels, "--mass": mass is not None, "--seals": seals != 1,
        "--relative": motion != "absolute", "--band": band is not None, "--resonance-amplitude": at,
    }  # fmt: skip
    _refuse_frf_options(files[0], request, *(_OF_HITS if all_hits else ()))
    if all_hits:
        _refuse_law(law, "hits")
        return _fit_hit_files(
            files, levels, mass=mass, band=band, requested_levels=at, options=options
        )
    if len(files) > 1:
        raise ReadError("one amplitude sweep at a time; only FRFs of several amplitudes go along")
    amplitude_fit, _, record = amplitude_file(
        files[0], kinds[0], law=law, options=options, machine=machine
    )
    return _attach_sweep(amplitude_fit, record)


def fit_amplitude_record(
    record: AmplitudeSweep | LoopRecord, *, law: str = "auto", machine: Machine | None = None
) -> AmplitudeResult:
    """Fit stiffness and damping over amplitude to a sweep or to loops."""
    if not isinstance(record, AmplitudeSweep):
        sweep = compute_sweep(record, machine)
    else:
        sweep = record
        require_test_for_machine(machine, tests=int(sweep.delay_sd > 0), add="recorded loops")
        if machine is not None and machine.sync is not None:
            machine.refuse_unused("sync", subject="recorded loops")
            sweep = replace(sweep, delay_sd=machine.sync, units="SI")
    return _attach_sweep(fit_amplitude(sweep, law=law), record)


def _attach_sweep(
    amplitude_fit: AmplitudeFit, record: AmplitudeSweep | LoopRecord
) -> AmplitudeResult:
    if not isinstance(record, AmplitudeSweep):
        fastest = float(amplitude_fit.frequency.max())
        force_name = "force" if amplitude_fit.unit == "N/m" else "stress"
        clipping_check = loops_not_clipped(find_flat_part(find_steady_cycles(record)), force_name)
        amplitude_fit = replace(
            amplitude_fit,
            loss_per_lag=2 * np.pi * fastest,
            checks=(*([clipping_check] if clipping_check.failed else ()), *amplitude_fit.checks),
        )
    return AmplitudeResult(amplitude_fit, (), amplitude_fit.checks, (record,))


_OF_HITS = ("--amplitude", "--mass", "--band", "--resonance-amplitude")
"""Options of FRFs that hits have as well."""


def _refuse_frf_options(
    path: str | Path, options: Mapping[str, object], *accepted_flags: str
) -> None:
    """Refuse options of FRFs that were given with a file of another kind."""
    given_flags = [
        flag for flag, option in options.items() if option and flag not in accepted_flags
    ]
    if given_flags:
        raise ReadError(
            f"{given_flags[0]} belongs to FRFs of a mass, and {Path(path).name} is another kind of "
            "file; leave it out"
        )


def _refuse_law(law: str, subject: str) -> None:
    if law != "auto":
        raise ReadError(
            f"--model is of an amplitude sweep, and {subject} take no law; leave it out"
        )


def _refuse_mixture(files: Sequence[str | Path], kinds: Sequence[str]) -> None:
    """Held and dying motions are not of one fit."""
    response_files, hit_files = (
        [Path(path).name for path, kind in zip(files, kinds, strict=True) if kind in kinds_of_group]
        for kinds_of_group in (RESPONSES, HITS)
    )
    if response_files and hit_files:
        raise ReadError(
            f"{response_files[0]} is an FRF and {hit_files[0]} holds hits, whose motion dies away: "
            "its lines have no one amplitude, and the two are not fitted together; give the FRFs "
            "alone and the hits alone, and compare the resonance of each at one amplitude "
            "(--resonance-amplitude)"
        )


def _get_peak_forces(levels: Sequence[Quantity], tests: int) -> list[float]:
    """Return the stated peak forces of the hammer tests, N."""
    if len(levels) not in {0, tests}:
        raise ReadError(
            f"{tests} hammer files and {len(levels)} amplitudes; expected the peak force of the "
            "hits of each file, in their order, or none (--amplitude): hits show how hard they are"
        )
    forces = [convert_to_si(level, "force") for level in levels]
    if not all(0 < force < np.inf for force in forces):
        raise ReadError(f"amplitude {min(forces):g} N; expected a peak force > 0 (--amplitude)")
    return forces


def _fit_hit_files(
    files: Sequence[str | Path],
    levels: Sequence[Quantity],
    *,
    mass: float | None,
    band: tuple[float, float] | None,
    requested_levels: Sequence[float],
    options: ReadOptions | None,
) -> AmplitudeResult:
    _get_peak_forces(levels, len(files))
    tests = read_impacts(list(files), options=options)
    with add_name_to_errors(", ".join(Path(path).name for path in files)):
        return hits_at_levels(tests, levels, mass=mass, band=band, at=requested_levels)


def hits_at_levels(
    tests: Sequence[ImpactTest],
    levels: Sequence[Quantity] = (),
    *,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
    at: Sequence[float] = (),
) -> AmplitudeResult:
    """Fit hits of different height; the parameters are those of :func:`level_files`."""
    stated_forces = _get_peak_forces(levels, len(tests))
    frf = estimate_frf(tests, resonance_band=band, mass=mass)
    hit_levels = hits_as_levels(frf, band=band)
    if stated_forces:
        counts = np.cumsum([len(cut_hits([test])) for test in tests])[:-1]
        peaks_of = np.split(np.array([hit.peak for hit in frf.hits]), counts)
        median_peaks = [median(peak) for peak in peaks_of]
        hit_levels = replace(
            hit_levels, checks=(levels_as_stated(stated_forces, median_peaks), *hit_levels.checks)
        )
    peaks = []
    for level in at:
        hz, receptance, about_hz, about_receptance = hit_levels.resonance(level)
        peaks.append(
            PeakAtLevel(level, hz, receptance, about_hz, about_receptance, level * receptance)
        )
    range_checks = tuple(
        amplitude_in_tested_range(
            peak.amplitude, hit_levels.amplitudes, location=f"{peak.level:.4g} N"
        )
        for peak in peaks
    )
    return AmplitudeResult(hit_levels, tuple(peaks), (*hit_levels.checks, *range_checks), (frf,))


def frfs_at_levels(
    frfs: Sequence[FRF],
    levels: Sequence[Quantity],
    *,
    mass: float | None,
    seals: float = 1.0,
    band: tuple[float, float] | None = None,
    at: Sequence[float] = (),
) -> AmplitudeResult:
    """Fit FRFs of one mass at several amplitudes; parameters as of :func:`level_files`."""
    if mass is None or len(levels) != len(frfs):
        raise ReadError(
            f"{len(frfs)} FRFs, {len(levels)} amplitudes and {'no' if mass is None else 'a'} mass; "
            "expected the mass (--mass) and the amplitude of each FRF, in their order "
            "(--amplitude 0.05N --amplitude 0.5N)"
        )
    level_fit = fit_levels(frfs, levels, mass=mass, seals=seals, band=band)
    peaks = tuple(_find_peak(level_fit, level) for level in at)
    range_checks = tuple(
        amplitude_in_tested_range(
            peak.amplitude, level_fit.amplitudes, location=f"{peak.level:.4g} N"
        )
        for peak in peaks
    )
    return AmplitudeResult(level_fit, peaks, (*level_fit.checks, *range_checks), tuple(frfs))


def _find_peak(level_fit: LevelFit, level: float) -> PeakAtLevel:
    """Return the largest motion of the mass at a level, and its interval by the draws."""

    def find_largest_motion(solid: GeneralizedMaxwell, elements: Elements) -> FloatArray:
        hz, X = resonance_at_level(level_fit, level, parts_of_model=(solid, elements))
        return np.array((hz, X / level))

    frequency, receptance = find_largest_motion(
        level_fit.solid, level_fit.rate_independent
    ).tolist()
    (least_hz, lowest), (most_hz, highest) = level_fit.interval(find_largest_motion).tolist()
    return PeakAtLevel(
        level,
        frequency,
        receptance,
        (least_hz, most_hz),
        (lowest, highest),
        receptance * level,
    )
