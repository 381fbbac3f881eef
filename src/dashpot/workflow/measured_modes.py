"""From the file of a measured FRF to its modes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from dashpot.io.options import ReadOptions
from dashpot.io.readers.frf import read_frf
from dashpot.records.frf import FRF, Mode
from dashpot.vibration.impact.checks import (
    lines_in_half_power_band,
    modes_within_band,
    record_long_enough,
    resonance,
)
from dashpot.vibration.modal.modes import mount_band
from dashpot.workflow.impacts import ImpactMode, finite, judged


@dataclass(frozen=True)
class MeasuredMode(ImpactMode):
    """A mode with its residue of the receptance, m/(N s), and the mass that moves in it, kg."""

    residue_real: float
    residue_imag: float
    residue_se: float | None
    modal_mass: float


@dataclass(frozen=True)
class MeasuredModes:
    """What ``dashpot modes`` found.

    Attributes
    ----------
    frf : FRF
        As it was read, with every check.
    modes : tuple of MeasuredMode
        The one that moves most first; empty if nothing rings in the band.
    band : (float, float)
        Where they were sought, Hz.
    """

    frf: FRF
    modes: tuple[MeasuredMode, ...]
    band: tuple[float, float]


def modes_file(
    path: str | Path,
    *,
    options: ReadOptions | None = None,
    band: tuple[float, float] | None = None,
) -> MeasuredModes:
    """Find natural frequencies, damping ratios and residues of the FRF in a file.

    Parameters
    ----------
    path : path
        Of any format and kind that :func:`~dashpot.io.readers.frf.read_frf` reads.
    options : ReadOptions, optional
        What the user said of the file.
    band : (float, float), optional
        Where to look for modes, Hz; by default two octaves to either side of where a block on its
        mounts moves most.

    Raises
    ------
    ReadError
        If there is no FRF in the file.
    DataError
        If the band holds fewer than 8 lines.
    """
    frf = read_frf(path, options=options)
    accelerance = frf.to("accelerance")
    sought = band or mount_band(accelerance.frequency, accelerance.value, accelerance.sd)
    modes = accelerance.modes(band=sought)
    main = modes[0] if modes else None
    near = accelerance.band(*sought)
    checks = [*judged(frf, sought, main).checks, resonance(near, main)]
    if main is not None:
        checks += [modes_within_band(modes, sought), lines_in_half_power_band(near, main)]
        if frf.record is not None:
            checks.append(record_long_enough(frf, main))
    told = tuple(_told(mode) for mode in modes)
    return MeasuredModes(replace(frf, checks=tuple(checks)), told, sought)


def _told(mode: Mode) -> MeasuredMode:
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
    )
