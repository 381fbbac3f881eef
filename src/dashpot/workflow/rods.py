"""From files of a mass on a rod to the modulus of the rod's material."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.choices import FamilyAsked
from dashpot.base.documents import Documented, plain
from dashpot.base.errors import DataError, FitError
from dashpot.base.options import option
from dashpot.base.provenance import Step
from dashpot.base.units import si_fields, written
from dashpot.io.options import ReadOptions
from dashpot.kinds.rod.fit import fit_rod
from dashpot.kinds.rod.prepare import RodErrors, RodModulus, rod_modulus
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF
from dashpot.records.specimen import Specimen
from dashpot.solids.part import Block, Disc
from dashpot.workflow.job import HammerChoices
from dashpot.workflow.measured import read_measured
from dashpot.workflow.part import pad

_LIGHTEST, _HEAVIEST = 5.0, 2e4
"""Of a foam and of a metal, kg/m^3."""
_ERRORS = ("gain", "phase", "mass", "length", "area", "density")


@dataclass(frozen=True)
class RodChoices:
    """A rod under a mass as a user says it, and how well its test is known."""

    disc: str | None = option(None, "Diameter and length of a round rod, e.g. 20mm,20mm.")
    block: str | None = option(None, "Both widths and length of another, e.g. 30mm,20mm,10mm.")
    lubricated: bool = option(False, "Its ends slide: no shape factor is taken off.", is_flag=True)
    gain_error: float = option(0.01, "Of one sensor over the other, e.g. 1%.", unit="strain")
    phase_error: float = option(
        RodErrors.phase, "Between the sensors, e.g. 1deg [default: 1deg].", unit="angle"
    )

    def __post_init__(self) -> None:
        si_fields(self)
        for name in ("gain_error", "phase_error"):
            value = getattr(self, name)
            if not 0 <= value < 1:
                raise DataError(
                    f"--{name.replace('_', '-')} {value:g}; expected an error from 0 to below 1"
                )

    @property
    def part(self) -> Disc | Block:
        """Its shape; the last length is the one along it."""
        if (self.disc is None) == (self.block is None):
            raise DataError(
                "a rod's shape turns motion into a modulus: give either --disc DIAMETER,LENGTH or "
                "--block WIDTH,WIDTH,LENGTH"
            )
        return pad("disc", self.disc) if self.block is None else pad("block", self.block)

    @property
    def errors(self) -> RodErrors:
        """As standard deviations."""
        return RodErrors(gain=self.gain_error, phase=self.phase_error)


@dataclass(frozen=True)
class Rod(Documented):
    """What ``dashpot rod`` found.

    Attributes
    ----------
    frf : FRF
        Of the mass, judged.
    modulus : RodModulus
        Line by line.
    part : Disc or Block
    bonded : bool
    mass, own_mass : float
        On the rod, and of the rod, kg.
    errors : RodErrors
    fit : Fit or None
        A solid, Pa, to the usable band.
    reason : str
        Why there is none.
    """

    schema = "dashpot/rod@1"
    keys = (
        "shape", "part.shape_factor", "bonded", "mass", "own_mass", "errors", "modulus.frequency",
        "modulus.storage", "modulus.loss_factor", "modulus.storage_sd", "modulus.loss_factor_sd",
        "sensitivity", "band", "verdict", "checks", "fit?",
    )  # fmt: skip

    frf: FRF
    modulus: RodModulus
    part: Disc | Block
    bonded: bool
    mass: float
    own_mass: float
    errors: RodErrors
    fit: Fit | None
    reason: str = ""

    @property
    def checks(self) -> tuple[Check, ...]:
        """Of the FRF, of the inversion, and of the fit."""
        own = (*self.frf.checks, *self.modulus.checks)
        return own if self.fit is None else self.fit.checks

    @property
    def verdict(self) -> Verdict:
        """What to make of it."""
        low, high = self.modulus.band
        return verdict(
            self.checks, sound=f"the modulus is known to 10 % from {low:.3g} to {high:.3g} Hz"
        )

    @property
    def shape(self) -> dict[str, Any]:
        """Which shape, and its lengths."""
        return {"kind": type(self.part).__name__.lower(), **plain(self.part)}

    @property
    def sensitivity(self) -> dict[str, FloatArray]:
        """Each as rows of the real and the imaginary part of d ln E*."""
        of = self.modulus
        every = {name: getattr(of, f"by_{name}") for name in _ERRORS}
        return {name: np.column_stack([one.real, one.imag]) for name, one in every.items()}

    @property
    def band(self) -> tuple[float, float] | None:
        """Where the modulus is known; None if nowhere."""
        return self.modulus.band if self.modulus.usable.any() else None


def rod_files(
    files: Sequence[str | Path],
    *,
    mass: float,
    density: float,
    rod: RodChoices,
    arms: int | Literal["auto"] = "auto",
    family: FamilyAsked = "maxwell",
    band: tuple[float, float] | None = None,
    hammer: HammerChoices | None = None,
    specimen: Specimen | None = None,
    options: ReadOptions | None = None,
) -> Rod:
    """Find the modulus of a rod's material from the motion of the mass on it.

    Parameters
    ----------
    files : sequence of path
        A transmissibility, or another FRF of the mass; or records of base and mass in time, or hits
        on the mass.
    mass : float
        On the rod, kg.
    density : float
        Of the rod, kg/m^3.
    rod : RodChoices
    arms, family
        Of the solid that is fitted to the usable band.
    band : (float, float), optional
        Lines to use, Hz.
    hammer, options, specimen
        How the files are read.
    """
    part, bonded = rod.part, not rod.lubricated
    if not _LIGHTEST <= density <= _HEAVIEST:
        raise DataError(
            f"--density {density:g}: expected {_LIGHTEST:g} to {_HEAVIEST:g} kg/m^3, such as 1100 "
            "of rubber"
        )
    _, frf = read_measured(
        files, choices=hammer or HammerChoices(), options=options or ReadOptions(), mass=mass,
        band=band,
    )  # fmt: skip
    modulus = rod_modulus(
        frf, part, mass=mass, density=density, bonded=bonded, errors=rod.errors, band=band
    )
    own = density * part.area * part.height
    found = Rod(frf, modulus, part, bonded, mass, own, rod.errors, None)
    try:
        fit = fit_rod(modulus, errors=rod.errors, arms=arms, family=family, specimen=specimen)
    except FitError as error:
        return replace(found, reason=str(error))
    step = Step(
        "rod_modulus",
        (("mass", f"{mass:.6g} kg"), ("density", f"{density:.6g} kg/m^3"), ("shape", str(part)),
         ("bonded", str(bonded).lower())),
        f"inverted the wave equation of a rod of {written(own, 'g')} under {written(mass, 'g')}",
    )  # fmt: skip
    provenance = replace(
        fit.provenance, source=frf.source, steps=(*frf.steps, step, *fit.provenance.steps)
    )
    checks = (*found.checks, *fit.checks)
    evidence = replace(fit.evidence, checks=checks)
    return replace(found, fit=replace(fit, provenance=provenance, evidence=evidence))
