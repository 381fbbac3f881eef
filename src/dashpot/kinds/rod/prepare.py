r"""The modulus of a rod or cylinder with an inertial mass on top, from its wave equation.

With m = rho A L the mass of the rod, M the mass on it and
:math:`z = \omega L\sqrt{\rho/E^*}`, a base that moves gives, and a force on the mass meets,

.. math:: T = \frac{1}{\cos z - \frac Mm z \sin z}, \qquad
    \frac{F}{x} = \omega^2\Bigl(\frac{m \cot z}{z} - M\Bigr)

Either is inverted line by line for the complex :math:`w = z^2`, by Newton's method from the line of
the resonance, where a spring with a third of the rod's mass is near, outwards; so the root is the
one that continues it. E* is that of the rod: bonded between plates a short cylinder is stiffer than
its material by :math:`1 + 2S^2`, S = D/4L, which is taken off.
Source: V. M. Kulik et al., Exp. Mech. (2009) (base excitation, two accelerometers).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from dashpot.base.arrays import BoolArray, ByValue, ComplexArray, FloatArray, IndexArray
from dashpot.base.checks import Check
from dashpot.base.demands import positive
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, Range, si, si_range
from dashpot.kinds.rod.checks import mass_beside_rod, rod_usable, sensors_agree, waves_plane
from dashpot.records.frf import FRF, Kind
from dashpot.solids.part import Block, Disc
from dashpot.vibration.modal.sensitivity import changed

_ROUNDS = 50
_CLOSE = 1e-13
_NEIGHBOURS = 11
"""Lines over which the scatter is averaged where the FRF comes without."""
_FEW = 3
"""Lines that make a median."""
_EXACT = 1e-3
"""No two sensors are known to agree better, as a part, or in rad."""
_GOOD = 0.1
"""Error of storage and of loss factor in the band that is called usable."""


@dataclass(frozen=True)
class RodErrors:
    """How well a rod's test is known, as standard deviations; the defaults are our choice.

    Attributes
    ----------
    gain : float
        Of one sensor over the other, relative.
    phase : float
        Between them, rad.
    mass, length, area, density : float
        Of the mass on top, and of the rod, relative.
    """

    gain: float = 0.01
    phase: float = float(np.pi / 180)
    mass: float = 0.002
    length: float = 0.005
    area: float = 0.005
    density: float = 0.005


@dataclass(frozen=True, eq=False)
class RodModulus(ByValue):
    r"""Modulus of a rod's material against frequency, and what spoils it.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz.
    modulus : complex array, shape (n,)
        E*, Pa.
    by_gain, by_phase, by_mass, by_length, by_area, by_density : complex array, shape (n,)
        :math:`d\ln E^*` for each relative change of these, for each rad of phase; what that does to
        storage and loss factor is :meth:`changes`.
    storage_sd, loss_factor_sd : array, shape (n,)
        All errors together, random ones too: Pa, and absolute.
    band : (float, float)
        About the resonance, where both are known to 10 %, Hz; (nan, nan) if nowhere.
    checks : tuple of Check
    """

    frequency: FloatArray
    modulus: ComplexArray
    by_gain: ComplexArray
    by_phase: ComplexArray
    by_mass: ComplexArray
    by_length: ComplexArray
    by_area: ComplexArray
    by_density: ComplexArray
    storage_sd: FloatArray
    loss_factor_sd: FloatArray
    band: tuple[float, float]
    checks: tuple[Check, ...] = ()

    @property
    def storage(self) -> FloatArray:
        """E', Pa."""
        return np.asarray(self.modulus.real)

    @property
    def loss_factor(self) -> FloatArray:
        """E''/E'."""
        return np.asarray(self.modulus.imag / self.modulus.real)

    def changes(self, of: str, by: float) -> tuple[FloatArray, FloatArray]:
        """Relative change of the storage, and change of the loss factor, by an error of `of`."""
        slope: ComplexArray = getattr(self, f"by_{of}")
        return changed(by * slope, self.loss_factor)

    def only(self, lines: BoolArray | IndexArray) -> RodModulus:
        """The same at some of its lines."""
        per_line = [one.name for one in fields(self) if one.name not in ("band", "checks")]
        return replace(self, **{name: getattr(self, name)[lines] for name in per_line})

    @property
    def usable(self) -> BoolArray:
        """The lines in the band."""
        return np.asarray((self.frequency >= self.band[0]) & (self.frequency <= self.band[1]))


def rod_transmissibility(
    frequency: FloatArray, modulus: ComplexArray | complex, *, mass_ratio: float, length: float,
    density: float,
) -> ComplexArray:  # fmt: skip
    """Return T of a rod with `mass_ratio` times its own mass on top; Hz, Pa, m, kg/m^3."""
    z = 2 * np.pi * np.asarray(frequency) * length * np.sqrt(density / np.asarray(modulus))
    return np.asarray(1 / (np.cos(z) - mass_ratio * z * np.sin(z)), dtype=complex)


def rod_modulus(
    frf: FRF,
    part: Disc | Block,
    *,
    mass: Quantity,
    density: float,
    bonded: bool = True,
    errors: RodErrors | None = None,
    band: Range | None = None,
) -> RodModulus:
    """Return E* of a rod's material, line by line, from the FRF of the mass on it.

    Parameters
    ----------
    frf : FRF
        Transmissibility to the mass, or motion of the mass over the force on it.
    part : Disc or Block
        Shape of the rod; its height is L.
    mass : float or str
        On top, kg.
    density : float
        Of the rod, kg/m^3.
    bonded : bool
        To its plates: 1 + 2 S^2 is taken off.
    errors : RodErrors, optional
    band : (float, float), optional
        Lines to use, Hz.

    Raises
    ------
    DataError
        If a number cannot be, the FRF was windowed, or a line has no modulus.
    """
    top, limits = float(si(mass, "mass")), si_range(band, "frequency")
    positive(mass=top, density=density, expected="a finite number above 0")
    if frf.shift:
        raise DataError("a rod's waves need an FRF without an exponential window")
    over_base, relative_sensor = frf.kind.over_base, frf.kind is Kind.RELATIVE_TRANSMISSIBILITY
    measured = frf.to(Kind.TRANSMISSIBILITY if over_base else Kind.DYNAMIC_STIFFNESS)
    measured = measured if limits is None else measured.band(*limits)
    measured = measured.only(measured.usable)
    omega = 2 * np.pi * measured.frequency
    own = density * part.area * part.height
    ratio = top / own
    y = 1 / measured.value if over_base else measured.value / (own * omega**2)
    equation = _base if over_base else _force
    w = _tracked(equation, y, omega, ratio)
    _, by_w, by_ratio = equation(w, ratio)
    # the bonded factor goes with the area over the length squared
    shape = part.factor(bonded=bonded) * part.height / part.area
    steep = 2 * (shape - 1) / shape
    E = density * omega**2 * part.height**2 / w / shape
    relative = y / (by_w * w)  # d ln E for a gain of the response over the base, or over the force
    heavy = ratio * by_ratio / (by_w * w)
    # F / (m omega^2) falls as the rod grows heavier; 1/T does not know its mass
    rod = np.zeros_like(y) if over_base else relative
    # of a sensor between both ends the gain is that of T - 1
    gained = relative * (1 - y) if relative_sensor else relative
    sensitivity = {
        "by_gain": gained,
        "by_phase": 1j * gained,
        "by_mass": heavy,
        "by_length": 2 + steep - heavy + rod,
        "by_area": -steep / 2 - heavy + rod,
        "by_density": 1 - heavy + rod,
    }
    errors = errors or RodErrors()
    spread = [getattr(errors, name.removeprefix("by_")) * d for name, d in sensitivity.items()]
    random = measured.random_sd
    if random is None:
        part_of: ComplexArray = _scatter(np.log(E)).astype(complex)
    else:
        part_of = random / np.abs(measured.value) * relative
    spread += [part_of, 1j * part_of]
    none = np.zeros(len(E))
    found = RodModulus(
        measured.frequency, E, **sensitivity,
        storage_sd=none, loss_factor_sd=none, band=(np.nan, np.nan), checks=(),
    )  # fmt: skip
    response = np.abs(measured.value if over_base else 1 / measured.value)
    found = _judged(found, spread, response, np.abs(w) / part.height**2 * _across(part))
    gain, phase = _at_rest(found, measured, w, ratio) if over_base else (None, 0.0)
    known = max(errors.gain, _EXACT), max(errors.phase, _EXACT)
    # a sensor between both ends is not seen at rest
    both = over_base and not relative_sensor
    beside = [sensors_agree(gain, phase, known=known)] if both else []
    return replace(found, checks=(*found.checks, mass_beside_rod(ratio), *beside))


def _judged(
    found: RodModulus, spread: list[ComplexArray], response: FloatArray, bulging: FloatArray
) -> RodModulus:
    """With its errors, the band in which they are small, and what else limits it."""
    E, storage, loss = found.modulus, found.storage, found.loss_factor
    changes = [E * one for one in spread]
    storage_sd = np.sqrt(sum(one.real**2 for one in changes))
    loss_sd = np.sqrt(sum(((one.imag - loss * one.real) / storage) ** 2 for one in changes))
    good = (storage_sd < _GOOD * np.abs(storage)) & (loss_sd < _GOOD * np.abs(loss)) & (storage > 0)
    band = _about(found.frequency, good, int(response.argmax()))
    found = replace(found, storage_sd=storage_sd, loss_factor_sd=loss_sd, band=band)
    widest = float(bulging[found.usable].max()) if found.usable.any() else None
    return replace(
        found, checks=(rod_usable(int(found.usable.sum()), band), waves_plane(widest, band[1]))
    )


def _at_rest(
    found: RodModulus, measured: FRF, w: ComplexArray, ratio: float
) -> tuple[float | None, float]:
    """How far T below the band is from what the modulus where it begins makes of it, 1 and rad."""
    f, usable = measured.frequency, np.flatnonzero(found.usable)
    low = f < 0.5 * found.band[0]
    if not usable.size or np.count_nonzero(low) < _FEW:
        return None, 0.0
    first = int(usable[0])
    expected, _, _ = _base(w[first] * (f[low] / f[first]) ** 2, ratio)
    off = np.log(measured.value[low] * expected)
    return float(np.median(off.real)), float(np.median(off.imag))


def _scatter(lines: ComplexArray) -> FloatArray:
    """Standard deviation of either part of lines by their second differences, which no curve has.

    The mean over a few neighbours; of fewer lines than that it is not known, 0.
    """
    if len(lines) < 2 * _NEIGHBOURS:
        return np.zeros(len(lines))
    rough = np.abs(np.diff(lines, 2)) ** 2 / 12  # 1 + 4 + 1, in two parts
    near = np.ones(_NEIGHBOURS)
    mean = np.convolve(rough, near, "same") / np.convolve(np.ones_like(rough), near, "same")
    return np.sqrt(np.pad(mean, 1, mode="edge"))


def _across(part: Disc | Block) -> float:
    r"""What the inertia of the bulging takes off a modulus, over k^2 (Rayleigh).

    .. math:: \nu^2 I_p / A, \qquad \nu = 1/2
    """
    if isinstance(part, Disc):
        return part.diameter**2 / 32
    return (part.length**2 + part.width**2) / 48


_Equation = Callable[[ComplexArray, float], tuple[ComplexArray, ComplexArray, ComplexArray]]


def _base(w: ComplexArray, ratio: float) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """1/T, and its derivatives by w = z^2 and by M/m."""
    z: ComplexArray = np.sqrt(np.asarray(w, dtype=complex))
    sine, cosine = np.sin(z), np.cos(z)
    by_z = -sine - ratio * (sine + z * cosine)
    return cosine - ratio * z * sine, by_z / (2 * z), -z * sine


def _force(w: ComplexArray, ratio: float) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """F/(x m omega^2), and its derivatives by w = z^2 and by M/m."""
    z: ComplexArray = np.sqrt(np.asarray(w, dtype=complex))
    cotangent = 1 / np.tan(z)
    by_z = -(1 + cotangent**2) / z - cotangent / z**2
    return cotangent / z - ratio, by_z / (2 * z), -np.ones_like(z)


def _tracked(equation: _Equation, y: ComplexArray, omega: FloatArray, ratio: float) -> ComplexArray:
    """The root w of every line: from the resonance outwards, each from its neighbour's."""
    peak = int(np.abs(y / (1 if equation is _base else 1 / omega**2)).argmin())
    w = np.zeros(len(y), dtype=complex)
    guess = (1 - y[peak]) / (ratio + 0.5) if equation is _base else 1 / (y[peak] + ratio + 1 / 3)
    for order in (range(peak, len(y)), range(peak - 1, -1, -1)):
        before = peak
        for i in order:
            start = guess if i == peak else w[before] * (omega[i] / omega[before]) ** 2
            w[i] = _root(equation, complex(start), complex(y[i]), ratio, omega[i] / (2 * np.pi))
            before = i
    return w


def _root(equation: _Equation, w: complex, y: complex, ratio: float, line: float) -> complex:
    for _ in range(_ROUNDS):
        value, slope, _ = equation(np.asarray(w), ratio)
        step = complex((value - y) / slope)
        w -= step * min(1.0, 0.5 * abs(w) / max(abs(step), 1e-300))
        if abs(step) <= _CLOSE * abs(w):
            return w
    raise DataError(
        f"no modulus explains the line at {line:.5g} Hz: expected the FRF of a mass on the rod; "
        "check mass and density, or leave the line out (Python: band=)"
    )


def _about(frequency: FloatArray, good: np.ndarray, peak: int) -> tuple[float, float]:
    """The run of good lines nearest to the peak."""
    if not good.any():
        return np.nan, np.nan
    at = int(np.flatnonzero(good)[np.abs(np.flatnonzero(good) - peak).argmin()])
    bad = np.flatnonzero(~good)
    low = int(bad[bad < at].max(initial=-1)) + 1
    high = int(bad[bad > at].min(initial=len(good))) - 1
    return float(frequency[low]), float(frequency[high])
