"""Modes of measured FRF files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.option_fields import OverBase
from dashpot.base.serialisation import EVERY_FIELD
from dashpot.datamodel.frf import FRF, Mode
from dashpot.datamodel.structure import FRFSet, ModeShape
from dashpot.extensions.modes.checks import (
    modes_explain_lines,
    modes_stable,
    modes_within_band,
    points_share_modes,
)
from dashpot.extensions.modes.mode_shapes import phase_collinearity, phase_deviation
from dashpot.extensions.modes.read_frf_set import read_frfs
from dashpot.extensions.modes.stabilisation import Stabilisation, stabilisation
from dashpot.reading.read_options import ReadOptions
from dashpot.vibration.impact.checks import lines_in_half_power_band, record_long_enough, resonance
from dashpot.vibration.modal.modal_methods import find_mode_shapes, select_mode_band
from dashpot.vibration.modal.pole_fit import mac
from dashpot.workflow.measured_frf import (
    ImpactMode,
    Modes,
    add_frf_checks,
    as_measured,
    finite,
    with_polarity,
)

_UNIT = 1.0
"""Mass, kg, which a transmissibility does not determine."""
SAME_MODE = 0.2
"""Relative: no mode of another set is the same one farther off than this."""


@dataclass(frozen=True)
class PointInMode:
    """Motion of a point in a mode, relative to the largest; `se` of either part."""

    point: str
    real: float
    imag: float
    se: float | None


@dataclass(frozen=True)
class MeasuredMode(ImpactMode):
    """Mode with its residue of the receptance, m/(N s), and its modal mass, kg.

    Of several points they are those of the point that moves most; of a transmissibility those of
    1 kg on the base.

    Attributes
    ----------
    orders : int
        Orders of the stabilisation chart, at which the mode is stable.
    shape : tuple of PointInMode
        Empty of a single point.
    phase_collinearity, phase_deviation_deg : float or None
        1 and 0 where all points move in phase or against it.
    """

    residue_real: float
    residue_imag: float
    residue_se: float | None
    modal_mass: float
    orders: int = 0
    shape: tuple[PointInMode, ...] = ()
    phase_collinearity: float | None = None
    phase_deviation_deg: float | None = None

    @property
    def mode(self) -> Mode:
        """The pole with its residue and their errors: nan where a method gives none."""
        residue = complex(self.residue_real, self.residue_imag)
        residue_se = float("nan") if self.residue_se is None else self.residue_se
        return replace(super().mode, residue=residue, residue_se=residue_se)


@dataclass(frozen=True)
class SameMode:
    """Pair of corresponding modes of two sets: both numbers from 1, and their similarity."""

    mode: int
    other: int
    frequency_hz: float
    damping_ratio: float
    mac: float | None


@dataclass(frozen=True, repr=False)
class MeasuredModes(Modes):
    """Modes that several FRFs share.

    Attributes
    ----------
    frf : FRF
        As it was read, with every check; of several points that which the checks are about.
    modes : tuple of MeasuredMode
        The one that moves most first; empty if nothing rings in the band.
    band : (float, float)
        Searched band, Hz.
    points : tuple of str
        Names of the points; empty of a single one.
    highest_order : int
        Highest order of the stabilisation chart.
    mac : tuple of tuple of float
        Modal assurance criterion of every mode with every other; empty of a single point.
    matched_modes : tuple of SameMode
        The modes of another set that these are found in again.
    """

    schema = "dashpot/modes@2"
    _keys = ("frf.checks", "verdict", "frf.source", EVERY_FIELD)

    modes: tuple[MeasuredMode, ...]
    band: tuple[float, float]
    points: tuple[str, ...] = ()
    highest_order: int = 0
    mac: tuple[tuple[float, ...], ...] = ()
    matched_modes: tuple[SameMode, ...] = ()

    @property
    def _headline(self) -> str:
        """Change of the first mode between two tests, as a sentence."""
        if not self.matched_modes:
            return super()._headline
        matched_mode = self.matched_modes[0]
        mode = self.modes[matched_mode.mode - 1]
        change = 100 * (matched_mode.frequency_hz / mode.frequency_hz - 1)
        return (
            f"mode {matched_mode.mode} goes from {mode.frequency_hz:.4g} to "
            f"{matched_mode.frequency_hz:.4g} Hz ({change:+.2g} %), its damping ratio from "
            f"{100 * mode.damping_ratio:.3g} to {100 * matched_mode.damping_ratio:.3g} %"
        )


def modes_files(
    files: Sequence[str | Path],
    *,
    options: ReadOptions | None = None,
    band: tuple[float, float] | None = None,
    motion: OverBase = "absolute",
    polarity: Sequence[int] | None = None,
    against: Sequence[str | Path] = (),
) -> tuple[MeasuredModes, Stabilisation]:
    """Find the modes that the FRFs in files share, and their stabilisation chart.

    Parameters
    ----------
    files : sequence of path
        Files that :func:`~dashpot.extensions.modes.read_frf_set.read_frfs` reads:
        one point or several, in one file or in several.
    options : ReadOptions, optional
        Reading options of the files.
    band : (float, float), optional
        Where to look for modes, Hz; by default two octaves to either side of where a block on its
        mounts moves most.
    motion : str
        Motion of the mass in transmissibilities: ``"absolute"``, or ``"relative"`` to the base.
    polarity : sequence of +1 and -1, optional
        Sign of each FRF.
    against : sequence of path
        A second test of the same points, whose modes are compared with these.

    Raises
    ------
    ReadError
        If there is no FRF in a file.
    DataError
        If the band holds fewer than 8 lines, or the points are not on the same ones.
    """
    other = read_frfs(against, options=options) if against else None
    measured = read_frfs(files, options=options)
    frfs = with_polarity([as_measured(frf, motion) for frf in measured.frfs], polarity)
    return modes_of(FRFSet(frfs, measured.points), band=band, against=other)


def modes_of(
    measured: FRFSet, *, band: tuple[float, float] | None = None, against: FRFSet | None = None
) -> tuple[MeasuredModes, Stabilisation]:
    """Find the modes that FRFs share, as :func:`modes_files` does of those in files.

    Those of motions over a base are sought in what they would be per force on 1 kg: poles and
    damping ratios are those of any mass, residues those of 1 kg.
    """
    force_frfs = measured.per_force(mass=_UNIT)
    band_frfs = select_mode_band(force_frfs, band)
    lines = band_frfs.frfs[0].frequency
    search_band = band or (float(lines[0]), float(lines[-1]))
    chart = stabilisation(force_frfs, band=search_band)
    shapes = find_mode_shapes(band_frfs)
    has_several_points = len(measured.points) > 1
    modes = MeasuredModes(
        _select_checked_frf(measured, band_frfs, shapes, chart, search_band),
        tuple(
            _build_measured_mode(shape, chart, measured.points if has_several_points else ())
            for shape in shapes
        ),
        search_band,
        measured.points if has_several_points else (),
        chart.highest,
        _compute_macs(shapes, shapes) if has_several_points else (),
    )
    if against is None:
        return modes, chart
    if len(against.points) != len(measured.points):
        raise DataError(
            f"{len(measured.points)} points are held against {len(against.points)}; "
            "expected the same ones, in the same order"
        )
    repeat_modes = against.per_force(mass=_UNIT).modes(band=search_band)
    return replace(
        modes, matched_modes=_match_modes(shapes, repeat_modes, has_several_points)
    ), chart


def _select_checked_frf(
    measured: FRFSet,
    band_frfs: FRFSet,
    shapes: Sequence[ModeShape],
    chart: Stabilisation,
    search_band: tuple[float, float],
) -> FRF:
    """Return the FRF of the driven point or of the largest residue, with checks of the modes."""
    main = shapes[0] if shapes else None
    driven_points = [i for i, name in enumerate(measured.points) if _is_driven(name)]
    single = len(measured.points) == 1
    top = 0 if main is None else int(np.argmax(np.abs(main.residues)))
    checked_index = 0 if single else driven_points[0] if driven_points else top
    frf, mode = measured.frfs[checked_index], None if main is None else main.mode
    mass = _UNIT if measured.over_base else None
    checks = (
        *add_frf_checks(
            frf, search_band, mode, mass=mass, is_driven=single or bool(driven_points)
        ).checks,
        resonance(band_frfs.frfs[checked_index], mode),
        *(
            ()
            if main is None
            else _check_modes(frf, band_frfs, checked_index, shapes, chart, search_band=search_band)
        ),
    )
    return replace(frf, checks=checks)


def _check_modes(
    frf: FRF,
    band_frfs: FRFSet,
    point_index: int,
    shapes: Sequence[ModeShape],
    chart: Stabilisation,
    *,
    search_band: tuple[float, float],
) -> Iterator[Check]:
    """Yield the checks of the modes, and of the FRF of the representative point."""
    main = shapes[0].mode
    yield modes_within_band([shape.mode for shape in shapes], search_band)
    yield lines_in_half_power_band(band_frfs.frfs[point_index], main)
    yield modes_stable(shapes, chart)
    yield modes_explain_lines(shapes, is_known=band_frfs.sd is not None)
    if len(band_frfs.points) > 1:
        yield points_share_modes(shapes)
    if frf.record is not None:
        yield record_long_enough(frf, main)


def _is_driven(name: str) -> bool:
    """Return whether a point such as 1+Z/1+Z is struck where it is measured."""
    response_point, separator, force_point = name.rpartition(" ")[2].partition("/")
    return bool(separator) and response_point == force_point


def _build_measured_mode(
    mode_shape: ModeShape, chart: Stabilisation, points: Sequence[str]
) -> MeasuredMode:
    mode = mode_shape.mode
    largest = mode_shape.residues[np.argmax(np.abs(mode_shape.residues))]
    shape, errors = mode_shape.residues / largest, mode_shape.residue_se / abs(largest)
    return MeasuredMode(
        mode.frequency,
        mode.damping_ratio,
        finite(mode.frequency_se),
        finite(mode.damping_ratio_se),
        mode.method,
        mode.residue.real,
        mode.residue.imag,
        finite(mode.residue_se),
        mode.modal_mass,
        chart.orders_with(mode),
        tuple(
            PointInMode(name, float(value.real), float(value.imag), finite(float(se)))
            for name, value, se in zip(points, shape, errors, strict=False)
        ),
        phase_collinearity(shape) if points else None,
        float(np.degrees(phase_deviation(shape))) if points else None,
    )


def _compute_macs(
    first: Sequence[ModeShape], second: Sequence[ModeShape]
) -> tuple[tuple[float, ...], ...]:
    if not first or not second:
        return ()
    residue_matrices = [
        np.column_stack([shape.residues for shape in shapes]) for shapes in (first, second)
    ]
    return tuple(tuple(map(float, row)) for row in mac(*residue_matrices))


def _match_modes(
    shapes: Sequence[ModeShape], other_shapes: Sequence[ModeShape], has_several_points: bool
) -> tuple[SameMode, ...]:
    """The mode of another set that each is found in again: the most alike of those nearby."""
    mac_values = _compute_macs(shapes, other_shapes)
    modes = []
    for i, shape in enumerate(shapes):
        nearby = [
            (
                -mac_values[i][j] if has_several_points else 0.0,
                abs(other.mode.frequency / shape.mode.frequency - 1),
                j,
            )
            for j, other in enumerate(other_shapes)
            if abs(other.mode.frequency / shape.mode.frequency - 1) < SAME_MODE
        ]
        if nearby:
            j = min(nearby)[2]
            mode = other_shapes[j].mode
            modes.append(
                SameMode(i + 1, j + 1, mode.frequency, mode.damping_ratio,
                         mac_values[i][j] if has_several_points else None)
            )  # fmt: skip
    return tuple(modes)
