"""Stiffness of one solid from FRF files of several masses on the same seals."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.checks import Check, HasChecks
from dashpot.base.errors import DataError
from dashpot.base.result_mixins import HasVerdict, Series, collect_columns
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.datamodel.structure import FRFSet
from dashpot.extensions.modes.checks import single_solid_explains_masses
from dashpot.extensions.modes.mass_series import SeveralMasses, several_masses
from dashpot.extensions.modes.measured_modes import MeasuredMode, MeasuredModes, modes_of
from dashpot.extensions.modes.read_frf_set import read_frfs
from dashpot.reading.read_options import ReadOptions


class MassModes(NamedTuple):
    """Mass, kg, with its modes and the range in which they were sought, Hz."""

    mass: float
    band: tuple[float, float]
    modes: tuple[MeasuredMode, ...]


class StiffnessAtMode(NamedTuple):
    """Stiffness, N/m, at a frequency, with the standard errors of its parts."""

    frequency_hz: float
    storage: float
    loss: float
    storage_se: float
    loss_se: float


@dataclass(frozen=True, repr=False)
class MassSeriesModes(HasChecks, HasVerdict, Serialisable):
    """Result of ``dashpot fit`` under several masses.

    Attributes
    ----------
    tests : tuple of MeasuredModes
        One for each mass.
    joint_modes : SeveralMasses
    checks : tuple of Check
        Checks of every test, with its mass, and whether one solid has all poles.

    Examples
    --------
    >>> import dashpot as dp
    >>> light, heavy = dp.simulate("impact", mass="90g"), dp.simulate("impact", mass="120g")
    >>> result = dp.fit(light.frf(), heavy.frf(), mass=["90g", "120g"], seals=2)
    >>> result.verdict.use in ("use", "use with care", "do not use")
    True
    """

    schema = "dashpot/modes-by-mass@2"
    _keys = (
        Key("tests", "modes_by_mass"),
        "stiffness",
        "model",
        "joint_modes.distance",
        "verdict",
        "checks",
    )

    tests: tuple[MeasuredModes, ...]
    joint_modes: SeveralMasses
    checks: tuple[Check, ...]

    @property
    def _table_columns(self) -> Series:
        """The mode under each mass, and the stiffness of the seals there."""
        joint_modes = self.joint_modes
        return {
            "mass": (list(joint_modes.masses), "kg"),
            **collect_columns(
                joint_modes.modes,
                frequency="Hz",
                frequency_se="Hz",
                damping_ratio="",
                damping_ratio_se="",
            ),
            **collect_columns(
                self.stiffness, storage="N/m", storage_se="N/m", loss="N/m", loss_se="N/m"
            ),
        }

    @property
    def modes_by_mass(self) -> tuple[MassModes, ...]:
        """The modes under each mass."""
        masses = zip(self.joint_modes.masses, self.tests, strict=True)
        return tuple(MassModes(mass, modes.band, modes.modes) for mass, modes in masses)

    @property
    def _headline(self) -> str:
        """The resonance under each mass."""
        pairs = zip(self.joint_modes.masses, self.joint_modes.modes, strict=True)
        names = [
            f"{mode.frequency:.4g} Hz under {format_quantity(mass, 'g')}" for mass, mode in pairs
        ]
        return f"one model has the resonance of every mass: {', '.join(names[:3])}"

    @property
    def stiffness(self) -> tuple[StiffnessAtMode, ...]:
        """Stiffness of the seals at every mode."""
        joint_modes = self.joint_modes
        rows = zip(joint_modes.modes, joint_modes.stiffness, joint_modes.spread, strict=True)
        return tuple(StiffnessAtMode(mode.frequency, k.real, k.imag, *se) for mode, k, se in rows)

    @property
    def model(self) -> dict[str, Any]:
        """The solid that has all poles, if one has."""
        solid = self.joint_modes.solid
        arms = [{"k": k, "tau": tau} for k, tau in zip(solid.k, solid.tau, strict=True)]
        return {"k_inf": solid.k_inf, "b": solid.b, "arms": arms}


def modes_by_mass(
    files: Sequence[str | Path],
    masses: Sequence[float],
    *,
    seals: float = 1.0,
    options: ReadOptions | None = None,
    band: tuple[float, float] | None = None,
) -> MassSeriesModes:
    """Find the main mode under each of several masses, and hold them against one solid.

    Parameters
    ----------
    files : sequence of path
        The FRF of each mass on the same seals.
    masses : sequence of float
        kg, in the order of the files.
    seals : float
        That carry each of them.
    options, band
        As in :func:`.modes_files`.

    Raises
    ------
    DataError
        If there are not two or more masses, one for each file, two files hold the same FRF, or
        nothing rings under one of them.
    """
    tests = [read_frfs([file], options=options) for file in files]
    names = [Path(file).name for file in files]
    return fit_modes_by_mass(tests, masses, names, seals=seals, band=band)


def fit_modes_by_mass(
    measured: Sequence[FRFSet],
    masses: Sequence[float],
    names: Sequence[str],
    *,
    seals: float = 1.0,
    band: tuple[float, float] | None = None,
) -> MassSeriesModes:
    """Hold the main modes of FRFs under several masses against one solid; each has a name."""
    if len(measured) != len(masses) or len(measured) < 2:
        raise DataError(
            f"{len(masses)} masses (--mass) for {len(measured)} files; expected two or more files "
            "and the mass of each, in their order"
        )
    tests = tuple(modes_of(frfs, band=band)[0] for frfs in measured)
    _refuse_same(names, masses, tests)
    masses_without_mode = [mass for mass, test in zip(masses, tests, strict=True) if not test.modes]
    if masses_without_mode:
        raise DataError(
            f"nothing rings under the mass of {format_quantity(masses_without_mode[0], 'g')}; give "
            "the band of its resonance (--band), or leave its file out"
        )
    modes = [test.modes[0].mode for test in tests]
    new_masses = several_masses(modes, masses, seals=seals)
    difference = new_masses.max_difference
    modes_by_mass = (
        f"{100 * difference.real:+.2g} % of stiffness and {100 * difference.imag:+.2g} % of damping"
    )
    checks = [
        check.with_location(f"under {format_quantity(mass, 'g')}")
        for mass, test in zip(masses, tests, strict=True)
        for check in test.frf.checks
    ]
    single_model_check = single_solid_explains_masses(
        new_masses.distance, masses, (masses[new_masses.worst], modes_by_mass)
    )
    return MassSeriesModes(tests, new_masses, (single_model_check, *checks))


def _refuse_same(
    names: Sequence[str], masses: Sequence[float], tests: Sequence[MeasuredModes]
) -> None:
    """Refuse an FRF given under two masses."""
    entries = list(zip(names, masses, tests, strict=True))
    for (name, mass, modes), (other, other_mass, two) in combinations(entries, 2):
        if np.array_equal(modes.frf.value, two.frf.value):
            names_text = " and ".join(dict.fromkeys((name, other)))
            raise DataError(
                f"{names_text}: the same FRF is given under {convert_to_unit(mass, 'g'):.4g} and "
                f"under {format_quantity(other_mass, 'g')}; expected what was measured under each "
                "mass"
            )
