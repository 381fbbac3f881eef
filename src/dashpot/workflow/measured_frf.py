"""FRF and modes from files of hammer or base-excitation tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import overload

import numpy as np

from dashpot.base import dataclass
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError, ReadError
from dashpot.base.number_format import format_count
from dashpot.base.option_fields import get_option_flag, iterate_option_fields
from dashpot.base.provenance import Step
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import Plottable, Series, collect_columns
from dashpot.base.serialisation import Serialisable
from dashpot.base.value_ranges import SIZES
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.frf import FRF, Mode
from dashpot.datamodel.vibration_tests import ImpactTest, ShakenTest
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.impact import HITS, read_impact, read_joined_impacts
from dashpot.registry import RESPONSES, require_handler
from dashpot.vibration.impact.checks import (
    coherence,
    frf_dissipates,
    line_errors_stated,
    mass_over_base,
)
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.mass_on_seals import (
    as_relative,
    compute_coupled_mass,
    moving_mass,
    remove_mount_mass,
)
from dashpot.vibration.modal.peaks import find_peak
from dashpot.workflow.job import BlockOnSeals, HammerChoices

# FRF of files, with checks.


_NO_MASS = (
    "the file holds a transmissibility, which shows the stiffness over the mass and neither alone: "
    "give the mass (--mass)"
)
_NO_BASE = "--relative is of a mass over a base that moves, and here a force moves it: leave out"


def read_measured(
    paths: Sequence[str | Path],
    *,
    choices: HammerChoices,
    options: ReadOptions,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
) -> tuple[ImpactTest | None, FRF]:
    """Return the hits that files hold and their FRF, or the FRF that a file holds.

    Its checks are about the resonance in `band`, Hz.
    """
    record = read_record(paths, options)
    frf = measured_frf(record, choices=choices, mass=mass, band=band)
    return record if isinstance(record, ImpactTest) else None, frf


def read_record(paths: Sequence[str | Path], options: ReadOptions) -> FRF | ShakenTest | ImpactTest:
    """Return the hits, the shaken test or the FRF that files hold."""
    if options.base_acceleration is not None:
        shaken_test: ShakenTest = require_handler("read several", "shaken base")(
            paths, options=options
        )
        return shaken_test
    if len(paths) == 1 and recognise(paths[0], options).kind in RESPONSES:
        return read_frf(paths[0], options=options)
    return read_joined_impacts(list(paths), options, f"an FRF or {HITS}")


def measured_frf(
    record: FRF | ShakenTest | ImpactTest | Sequence[ImpactTest],
    *,
    choices: HammerChoices,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
) -> FRF:
    """Return the FRF of a test, with the metadata of its file.

    Raises
    ------
    ReadError
        If it is a base excitation, and no mass, kg, is given.
    """
    if isinstance(record, ShakenTest):
        if mass is None:
            raise ReadError(_NO_MASS)
        estimate = require_handler("estimate frf", record)
        transmissibility: FRF = estimate(record, choices=choices, mass=mass, band=band)[0]
        return transmissibility
    if isinstance(record, FRF):
        refuse_choices_of_hits(choices, "the file holds an FRF", exceptions=("motion", "polarity"))
        (frf,) = with_polarity([as_measured(record, choices.motion)], choices.polarity)
        if frf.quantity.over_base and mass is None:
            raise ReadError(_NO_MASS)
        return add_frf_checks(frf, band, mass=mass)
    return average(record, choices=choices, mass=mass, band=band)


def with_polarity(frfs: Sequence[FRF], polarity: Sequence[int] | None) -> tuple[FRF, ...]:
    """Return FRFs with the sign that is given to each, +1 or -1; without any as they are.

    Raises
    ------
    ReadError
        If there is not one sign for each.
    """
    if polarity is None:
        return tuple(frfs)
    if len(polarity) != len(frfs):
        raise ReadError(
            f"--polarity was given {len(polarity)} times for {format_count(len(frfs), 'FRF')}; "
            "give +1 or -1 for each, in their order"
        )
    step = Step("polarity", (("turned", "FRF"),), "the sign of the FRF was turned, as given")
    return tuple(
        replace(frf, value=-frf.value, steps=(*frf.steps, step)) if sign < 0 else frf
        for frf, sign in zip(frfs, polarity, strict=True)
    )


def as_measured(frf: FRF, motion: str) -> FRF:
    """Return the FRF, as a relative transmissibility if the user states so."""
    if motion == "absolute":
        return frf
    if not frf.quantity.over_base:
        raise ReadError(_NO_BASE)
    return as_relative(frf)


def refuse_choices_of_hits(
    choices: HammerChoices, reason: str, *, exceptions: Sequence[str] = ()
) -> None:
    """Refuse choices that only hits have a use for, all `exceptions` some.

    Raises
    ------
    ReadError
    """
    default = HammerChoices()
    unused = [
        get_option_flag(field)
        for field in iterate_option_fields(choices)
        if field.name not in exceptions
        and getattr(choices, field.name) != getattr(default, field.name)
    ]
    if unused:
        raise ReadError(f"{', '.join(unused)}: of hits, and {reason}; leave out")


def add_frf_checks(
    frf: FRF,
    band: tuple[float, float] | None,
    main: Mode | None = None,
    *,
    mass: float | None = None,
    is_driven: bool = True,
) -> FRF:
    """Return a measured FRF with the checks of its values at the peak.

    The peak is the highest in `band`, Hz, or that of a mode; a transmissibility needs the mass, kg.
    Only where a point is struck itself (`is_driven`) does its phase show whether the part
    dissipates.
    """
    band_frf = frf.to("accelerance", mass=mass)
    band_frf = band_frf if band is None else band_frf.band(*band)
    peak = find_peak(band_frf) if main is None else main
    peak_line = int(np.argmin(np.abs(band_frf.frequency - peak.frequency)))
    checks = [
        frf_dissipates(complex(band_frf.value[peak_line]), float(band_frf.frequency[peak_line]))
    ] * is_driven
    if frf.quantity.over_base:
        checks.insert(0, mass_over_base(frf))
    if frf.coherence is not None:
        checks.append(coherence(band_frf, peak_line))
    elif frf.sd is None:
        checks.append(line_errors_stated())
    checks += caution_checks(frf.source)
    return replace(frf, checks=(*frf.checks, *checks))


def average(
    impact: ImpactTest | Sequence[ImpactTest],
    *,
    choices: HammerChoices,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
) -> FRF:
    """Return the FRF of a hammer test under these choices."""
    options = asdict(choices)
    if options.pop("motion") != "absolute":
        raise ReadError(_NO_BASE)
    return estimate_frf(impact, **options, mass=mass, resonance_band=band)


def total_mass(block: BlockOnSeals) -> tuple[float | None, tuple[Check, ...]]:
    """Return the mass of the block and the moving part of the seals, where both are known."""
    if block.mass is not None:
        SIZES["mass"].refuse(block.mass)
    if block.mass is None or block.seal_mass is None:
        return block.mass, ()
    mass, check = moving_mass(block.mass, seal=block.seal_mass, seals=block.seals)
    return mass, (check,)


def remove_seal_mass(frf: FRF, block: BlockOnSeals) -> FRF:
    """Return a transmissibility as seals without mass would show it; another FRF as it is."""
    mass, _ = total_mass(block)
    if not frf.quantity.over_base or mass is None:
        return frf
    coupled = compute_coupled_mass(block.seal_mass, block.seals)
    return remove_mount_mass(frf, mass=mass, coupled=coupled)


# Modes of an FRF, with checks.


@dataclass(frozen=True)
class ImpactMode:
    """Mode as its document holds it; None where a method does not determine a value."""

    frequency_hz: float
    damping_ratio: float
    frequency_se_hz: float | None
    damping_ratio_se: float | None
    method: str

    @property
    def mode(self) -> Mode:
        """The pole with its errors: nan where a method gives none."""
        values = (self.frequency_se_hz, self.damping_ratio_se)
        frequency, ratio = (np.nan if se is None else se for se in values)
        return Mode(self.frequency_hz, self.damping_ratio, 0j, frequency, ratio, 0.0, self.method)


@dataclass(frozen=True, repr=False)
class Modes(Plottable, Serialisable, Sequence[Mode]):
    """Natural frequencies, damping ratios and shapes, each with its standard error.

    A sequence of :class:`~dashpot.datamodel.frf.Mode`, the one that moves most first.

    Attributes
    ----------
    frf : FRF
        That they were found in, with every check.
    modes : tuple of ImpactMode
        As the document shows them.

    Examples
    --------
    >>> import dashpot as dp
    >>> modes = dp.fit(dp.simulate("impact", seal="broad", hits=3))
    >>> len(modes), round(modes[0].damping_ratio, 3)
    (1, 0.029)
    """

    frf: FRF
    modes: tuple[ImpactMode, ...]

    @overload
    def __getitem__(self, index: int) -> Mode: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Mode, ...]: ...
    def __getitem__(self, index: int | slice) -> Mode | tuple[Mode, ...]:
        """The mode at a place, or several."""
        return tuple(mode.mode for mode in self.modes)[index]

    def __len__(self) -> int:
        """Number of modes."""
        return len(self.modes)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the FRF and of its modes."""
        return self.frf.checks

    @property
    def verdict(self) -> Verdict:
        """Verdict on the FRF and its modes."""
        return verdict(self.frf.checks, headline=self._headline)

    @property
    def _headline(self) -> str:
        """The first mode and how many there are."""
        return format_modes_headline(self)

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Frequency, damping ratio and residue of each mode."""
        return tuple(reported_value for mode in self for reported_value in mode.facts)

    @property
    def _table_columns(self) -> Series:
        """The modes as a table."""
        columns = collect_columns(
            self, frequency="Hz", frequency_se="Hz", damping_ratio="", damping_ratio_se=""
        )
        return {"mode": (np.arange(1, len(self) + 1), ""), **columns}

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict, and each mode."""
        rows = (mode.facts for mode in self)
        return (
            str(self.verdict),
            *(f"{hz.cells.with_unit}, damping {ratio.cells.with_unit}" for hz, ratio, _ in rows),
        )


def format_modes_headline(modes: Sequence[Mode]) -> str:
    """Return frequency and damping of the first of some modes, and how many there are."""
    if not modes:
        return "0 modes were found"
    frequency, ratio, _ = (reported_value.cells.with_unit for reported_value in modes[0].facts)
    count = "" if len(modes) == 1 else f", the first of {format_count(len(modes), 'mode')}"
    return f"resonance at {frequency}, damping ratio {ratio}{count}"


# Results of the files of a hammer test.


@dataclass(frozen=True, repr=False)
class ImpactResult(Modes):
    """FRF of a hammer test, and its modes.

    Attributes
    ----------
    frf : FRF
        With every hit and check.
    modes : tuple of ImpactMode
    estimator, window : str
        How the hits were averaged and windowed.
    file : str or None
        Where the FRF was written.
    """

    schema = "dashpot/impact@2"
    _keys = (
        "estimator", "window", "frf.averages", "modes", "peak", "frf.hits", "frf.checks", "verdict",
        "frf.source", "file", "frf",
    )  # fmt: skip

    estimator: str
    window: str
    file: str | None = None

    @property
    def peak(self) -> dict[str, float]:
        """Frequency, Hz, and magnitude of the highest line."""
        height = np.abs(self.frf.value)
        peak_line = int(height.argmax())
        return {
            "frequency_hz": float(self.frf.frequency[peak_line]),
            "value": float(height[peak_line]),
        }


def impact_files(
    files: Sequence[str | Path],
    *,
    hammer: HammerChoices | None = None,
    options: ReadOptions | None = None,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
    file: str | None = None,
) -> tuple[ImpactResult, str]:
    """Average the hits in files into an FRF and find its modes.

    Parameters
    ----------
    files : sequence of path
    hammer, options
        How the hits are averaged, and what the user said of the files.
    mass : float, optional
        kg, of the block: checks the mass line.
    band : (float, float), optional
        Where to look for modes, Hz.
    file : str, optional
        Where the FRF will be written; stated in the document.

    Returns
    -------
    result : ImpactResult
    reason : str
        Why no mode was found, else empty.
    """
    options = options or ReadOptions()
    test: ImpactTest | ShakenTest
    if options.for_file(files[0]).base_acceleration is not None:
        test = require_handler("read several", "shaken base")(files, options=options)
    else:
        test = read_impact(list(files), options=options)
    result, reason = modes_of_hits(test, hammer=hammer, mass=mass, band=band)
    return replace(result, file=file), reason


def modes_of_hits(
    test: ImpactTest | ShakenTest,
    *,
    hammer: HammerChoices | None = None,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
) -> tuple[ImpactResult, str]:
    """Average hits, or a base that was shaken, into an FRF and find its modes.

    The parameters and what is returned are those of :func:`impact_files`.
    """
    hammer = hammer or HammerChoices()
    if isinstance(test, ShakenTest):
        estimate = require_handler("estimate frf", test)
        frf, modes, reason = estimate(test, choices=hammer, mass=mass, band=band)
    else:
        frf = average(test, choices=hammer, mass=mass, band=band)
        modes, reason = find_modes_or_reason(frf, band)
    return build_impact_result(frf, modes, hammer), reason


def find_modes_or_reason(
    frf: FRF, band: tuple[float, float] | None
) -> tuple[tuple[Mode, ...], str]:
    """Return the modes of an FRF, or why there is none."""
    try:
        return frf.modes(band=band), ""
    except DataError as error:
        return (), str(error)


def build_impact_result(frf: FRF, modes: Sequence[Mode], hammer: HammerChoices) -> ImpactResult:
    """Return the modes of a measured FRF with the choices that led to them."""
    shown_modes = tuple(
        ImpactMode(
            mode.frequency,
            mode.damping_ratio,
            finite(mode.frequency_se),
            finite(mode.damping_ratio_se),
            mode.method,
        )
        for mode in modes
    )
    return ImpactResult(frf, shown_modes, hammer.estimator, hammer.window)


def finite(value: float) -> float | None:
    """Return a number, or None where it is not known."""
    return value if np.isfinite(value) else None
