"""Result of a rod test: modulus of the material against frequency."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, field, fields, replace
from dashpot.base.arrays import BoolArray, ComplexArray, EqualByValue, FloatArray, IndexArray
from dashpot.base.checks import Check
from dashpot.vibration.modal.dynamic_stiffness import compute_stiffness_change


@dataclass(frozen=True)
class RodErrors:
    """Errors of a rod's test, as standard deviations; the defaults are our choice.

    Attributes
    ----------
    gain : float
        Error of the gain of one sensor over the other, relative.
    phase : float
        Between them, rad.
    mass, length, area, density : float
        Relative errors of the mass on top, and of length, area and density of the rod.
    poisson : float
        Absolute error of Poisson's ratio: by default its range for rubber, 0.4985 to 0.4999.
    glue : float
        Compliance of the glue between rod, base and mass over that of the rod: trials had 12 %.
    """

    gain: float = 0.01
    phase: float = float(np.pi / 180)
    mass: float = 0.01
    length: float = 0.005
    area: float = 0.005
    density: float = 0.005
    poisson: float = 0.0007
    glue: float = 0.065


_PER_LINE = ("frequency", "modulus", "wave", "by_", "storage_sd", "loss_factor_sd")


@dataclass(frozen=True, eq=False)
class RodModulus(EqualByValue):
    r"""Modulus of a rod's material against frequency, with its errors.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz.
    modulus : complex array, shape (n,)
        E*, Pa.
    wave : complex array, shape (n,)
        Square of the wave number times the length, :math:`z^2`.
    by_gain, by_phase, by_mass, by_length, by_area, by_density, by_poisson, by_glue : complex array
        :math:`d\ln E^*` for each relative change of these, for each rad of phase, for 1 of
        Poisson's ratio, for a glue that gives as much as the rod; shape (n,). :meth:`changes` gives
        their effect on storage and loss factor.
    storage_sd, loss_factor_sd : array, shape (n,)
        All errors together, random ones too: Pa, and absolute.
    band : (float, float)
        About the resonance, where both are known to 10 %, Hz; (nan, nan) if nowhere.
    checks : tuple of Check
    errors : RodErrors
        The errors that were included; where gain and phase of the sensors are corrected, those that
        remain.
    """

    frequency: FloatArray
    modulus: ComplexArray
    wave: ComplexArray
    by_gain: ComplexArray
    by_phase: ComplexArray
    by_mass: ComplexArray
    by_length: ComplexArray
    by_area: ComplexArray
    by_density: ComplexArray
    by_poisson: ComplexArray
    by_glue: ComplexArray
    storage_sd: FloatArray
    loss_factor_sd: FloatArray
    band: tuple[float, float]
    checks: tuple[Check, ...] = ()
    errors: RodErrors = field(default_factory=RodErrors)

    @property
    def storage(self) -> FloatArray:
        """E', Pa."""
        return np.asarray(self.modulus.real)

    @property
    def loss_factor(self) -> FloatArray:
        """E''/E'."""
        return np.asarray(self.modulus.imag / self.modulus.real)

    def changes(self, name: str, size: float) -> tuple[FloatArray, FloatArray]:
        """Relative change of the storage, and change of the loss factor, by an error of `name`."""
        slope: ComplexArray = getattr(self, f"by_{name}")
        return compute_stiffness_change(size * slope, self.loss_factor)

    @property
    def error_contributions(self) -> tuple[ComplexArray, ...]:
        """Relative change of the modulus by one standard deviation of each error that is not 0."""
        sizes = vars(self.errors).items()
        return tuple(size * getattr(self, f"by_{name}") for name, size in sizes if size)

    def only(self, lines: BoolArray | IndexArray) -> RodModulus:
        """Return the modulus at some of its lines."""
        per_line = [
            attribute.name for attribute in fields(self) if attribute.name.startswith(_PER_LINE)
        ]
        return replace(self, **{name: getattr(self, name)[lines] for name in per_line})

    @property
    def usable(self) -> BoolArray:
        """Mask of the lines in the usable band."""
        return np.asarray((self.frequency >= self.band[0]) & (self.frequency <= self.band[1]))
