r"""Modulus of a rod or cylinder with a mass on top, by its wave equation.

With m = rho A L the mass of the rod, M the mass on it and
:math:`z = \omega L\sqrt{\rho/E^*}`, a base that moves gives, and a force on the mass meets,

.. math:: T = \frac{1}{\cos z - \frac Mm z \sin z}, \qquad
    \frac{F}{x} = \omega^2\Bigl(\frac{m \cot z}{z} - M\Bigr)

Either is inverted line by line for the complex :math:`w = z^2`, by Newton's method from the line of
the resonance, where a spring with a third of the rod's mass is near, outwards; so the root is the
one that continues it. E* is that of the rod: bonded between plates a short cylinder is stiffer than
its material, :func:`~dashpot.solids.part_geometry.bonded_cylinder`, which is taken off. A phase
between the sensors looks like loss, and no law of physics distinguishes the two; but far below the
resonance both sensors see one motion. Their gain and phase there are removed. Source: V. M. Kulik
et al., Exp. Mech. (2009) (base excitation, two accelerometers).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.frf import FRF, Kind
from dashpot.extensions.materials.rod.checks import (
    PLANE,
    ROD_LINES,
    mass_ratio_suitable,
    modulus_determined_near_resonance,
    sensors_agree,
    single_solid_explains_lines,
    waves_plane,
)
from dashpot.extensions.materials.rod.datamodel import RodErrors, RodModulus
from dashpot.extensions.materials.rod.solid_consistency import compute_single_model_misfit
from dashpot.solids.part_geometry import Block, Disc

_MAX_ITERATIONS = 50
_CONVERGENCE_TOLERANCE = 1e-13
_NEIGHBOUR_LINES = 11
"""Lines over which the scatter is averaged where the FRF comes without."""
_MEDIAN_LINES = 3
"""Lines that make a median."""
_EXACT = 1e-3
"""No two sensors are known to agree better, as a part, or in rad."""
_GAIN_LEFT, _PHASE_LEFT = 0.003, float(np.radians(0.3))
"""Standard deviations of gain and phase that remain after their correction below the resonance,
beside those of the correction."""
_MEDIAN = float(np.sqrt(np.pi / 2))
"""Standard error of a median over that of a mean."""
_TURNS = 3
_USABLE_ERROR = 0.1
"""Error of storage and of loss factor in the band that is called usable."""
_POISSON_ERROR, _HIGHEST_POISSON = 0.0007, 0.4999
"""Uncertainty of Poisson's ratio of a rubber, and its largest value."""


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
        Density of the rod, kg/m^3.
    bonded : bool
        To its plates: the resulting stiffening is removed.
    errors : RodErrors, optional
    band : (float, float), optional
        Lines to use, Hz.

    Raises
    ------
    DataError
        If a number cannot be, the FRF was windowed, or a line has no modulus.
    """
    top, limits = float(convert_to_si(mass, "mass")), si_range(band, "frequency")
    require_positive(mass=top, density=density, expected="a finite number above 0")
    if frf.shift:
        raise DataError("a rod's waves need an FRF without an exponential window")
    over_base, relative_sensor = (
        frf.quantity.over_base,
        frf.quantity is Kind.RELATIVE_TRANSMISSIBILITY,
    )
    measured = frf.to(Kind.TRANSMISSIBILITY if over_base else Kind.DYNAMIC_STIFFNESS)
    measured = measured if limits is None else measured.band(*limits)
    measured = measured.only(measured.usable)
    value = density * part.area * part.height
    rod = _Setup(part, top / value, value, density, bonded)
    modulus = _invert_lines(measured, rod, errors or RodErrors(), relative_sensor=relative_sensor)
    # a sensor between both ends is not seen at rest
    checks = []
    if over_base and not relative_sensor:
        modulus, corrected_frf = _remove_sensor_offset(modulus, measured, rod)
        checks = [corrected_frf]
    return replace(modulus, checks=(*modulus.checks, mass_ratio_suitable(rod.ratio), *checks))


@dataclass(frozen=True)
class _Setup:
    """Rod with its mass and ends: `ratio` of the mass on it to its own, kg; kg/m^3."""

    part: Disc | Block
    ratio: float
    rod_mass: float
    density: float
    bonded: bool


def _remove_sensor_offset(
    modulus: RodModulus, measured: FRF, rod: _Setup
) -> tuple[RodModulus, Check]:
    """Return the modulus corrected for gain and phase of the sensors, and these."""
    errors, total_offset = modulus.errors, 0j
    values = max(errors.gain, _EXACT), max(errors.phase, _EXACT)
    seen_first = _estimate_rest_offset(modulus, measured, rod.ratio)
    if seen_first is None:
        return modulus, sensors_agree(None, 0.0, values=values)
    log_offset, error = seen_first
    values = float(np.hypot(values[0], error.real)), float(np.hypot(values[1], error.imag))
    gain = min(errors.gain, float(np.hypot(_GAIN_LEFT, error.real)))
    phase = min(errors.phase, float(np.hypot(_PHASE_LEFT, error.imag)))
    # who calibrated them as well knows as much
    by_gain, by_phase = gain < errors.gain, phase < errors.phase
    if not (by_gain or by_phase):
        return modulus, sensors_agree(log_offset.real, log_offset.imag, values=values)
    rod_errors = replace(errors, gain=gain, phase=phase)
    for _ in range(_TURNS):  # it moves the modulus, and so what is expected at rest
        total_offset += complex(by_gain * log_offset.real, by_phase * log_offset.imag)
        corrected_frf = replace(measured, value=measured.value * np.exp(-total_offset))
        modulus = _invert_lines(corrected_frf, rod, rod_errors, relative_sensor=False)
        remaining_offset = _estimate_rest_offset(modulus, corrected_frf, rod.ratio)
        if remaining_offset is None:
            log_offset = 0j
            break
        log_offset, _ = remaining_offset
    total_offset += log_offset
    return modulus, sensors_agree(total_offset.real, total_offset.imag, values=values)


def _compute_bonded_slopes(part: Disc | Block) -> tuple[float, float]:
    r"""Return slopes of the logarithm of the bonded factor.

    By the logarithm of the height, and by Poisson's ratio, over the range of its error.
    """

    def compute_slope(first: Disc | Block, second: Disc | Block, difference: float) -> float:
        factors = [pad.factor() / pad.factor(bonded=False) for pad in (first, second)]
        return float(np.log(factors[0] / factors[1]) / difference)

    step, nu = 1e-4, min(part.poisson, _HIGHEST_POISSON - _POISSON_ERROR)
    taller, shorter = (
        replace(part, height=part.height * np.exp(log_step)) for log_step in (step, -step)
    )
    stiffer, soft = (
        replace(part, poisson=nu + log_step) for log_step in (_POISSON_ERROR, -_POISSON_ERROR)
    )
    return compute_slope(taller, shorter, 2 * step), compute_slope(
        stiffer, soft, 2 * _POISSON_ERROR
    )


def _invert_lines(
    measured: FRF, rod: _Setup, errors: RodErrors, *, relative_sensor: bool
) -> RodModulus:
    """Return E* line by line, with its errors, usable lines and checks."""
    part, ratio, density, over_base = rod.part, rod.ratio, rod.density, measured.quantity.over_base
    omega = 2 * np.pi * measured.frequency
    y = 1 / measured.value if over_base else measured.value / (rod.rod_mass * omega**2)
    equation = _evaluate_base_equation if over_base else _evaluate_force_equation
    w = _solve_line_roots(equation, y, omega, ratio)
    finite = np.isfinite(w)
    measured, omega, y, w = measured.only(finite), omega[finite], y[finite], w[finite]
    _, by_w, by_ratio = equation(w, ratio)
    # the bonded factor goes with the area over the length squared
    shape = part.factor(bonded=rod.bonded) * part.height / part.area
    steep, by_poisson = _compute_bonded_slopes(part) if rod.bonded else (0.0, 0.0)
    E = density * omega**2 * part.height**2 / w / shape
    relative = y / (by_w * w)  # d ln E for a gain of the response over the base, or over the force
    heavy = ratio * by_ratio / (by_w * w)
    # F / (m omega^2) falls as the rod grows heavier; 1/T does not know its mass
    values = np.zeros_like(y) if over_base else relative
    # of a sensor between both ends the gain is that of T - 1
    relative_gain = relative * (1 - y) if relative_sensor else relative
    sensitivity = {
        "by_gain": relative_gain,
        "by_phase": 1j * relative_gain,
        "by_mass": heavy,
        "by_length": 2 - steep - heavy + values,
        "by_area": steep / 2 - heavy + values,
        "by_density": 1 - heavy + values,
        "by_poisson": np.full_like(y, -by_poisson),
        "by_glue": _compute_glue_sensitivity(w, by_w, ratio, over_base=over_base)
        * E
        / np.abs(E.real),
    }
    relative_errors = [
        getattr(errors, name.removeprefix("by_")) * d for name, d in sensitivity.items()
    ]
    random = measured.random_sd
    if random is None:
        part_of: ComplexArray = _estimate_scatter(np.log(E)).astype(complex)
    else:
        part_of = random / np.abs(measured.value) * relative
    relative_errors += [part_of, 1j * part_of]
    zeros = np.zeros(len(E))
    modulus = RodModulus(
        measured.frequency, E, w, **sensitivity,
        storage_sd=zeros, loss_factor_sd=zeros, band=(np.nan, np.nan), checks=(), errors=errors,
    )  # fmt: skip
    response = np.abs(measured.value if over_base else 1 / measured.value)
    modulus = _estimate_errors_and_band(
        modulus,
        relative_errors,
        response,
        np.abs(w) / part.height**2 * _correct_lateral_inertia(part),
    )
    usable = modulus.usable
    scatter = np.hypot(np.abs(part_of), _EXACT * np.abs(relative))
    # a model in series with a spring is one model again
    without_glue = replace(modulus.only(usable), errors=replace(errors, glue=0.0))
    misfit = compute_single_model_misfit(without_glue, scatter[usable])
    return replace(modulus, checks=(*modulus.checks, single_solid_explains_lines(misfit)))


def _compute_glue_sensitivity(
    w: ComplexArray, by_w: ComplexArray, ratio: float, *, over_base: bool
) -> ComplexArray:
    r"""Return d ln E* by g, the compliance of the glue over that of a rod of modulus E'.

    Between base and rod it gives under the force there, so that

    .. math:: \frac1T = \cos z - \frac Mm z \sin z
              - g\,\frac{E^*}{E'}\,z\Bigl(\sin z + \frac Mm z \cos z\Bigr)

    Under a mass that is struck it is a spring in a row with the rod.
    """
    if not over_base:
        return np.ones_like(w)
    z: ComplexArray = np.sqrt(np.asarray(w, dtype=complex))
    return np.asarray(-z * (np.sin(z) + ratio * z * np.cos(z)) / (by_w * w))


def _estimate_errors_and_band(
    modulus: RodModulus,
    relative_errors: list[ComplexArray],
    response: FloatArray,
    bulging: FloatArray,
) -> RodModulus:
    """Return the modulus with its errors, its usable band and its checks."""
    E, storage, loss = modulus.modulus, modulus.storage, modulus.loss_factor
    changes = [E * values for values in relative_errors]
    storage_sd = np.sqrt(sum(change.real**2 for change in changes))
    loss_sd = np.sqrt(
        sum(((change.imag - loss * change.real) / storage) ** 2 for change in changes)
    )
    is_usable = (
        (storage_sd < _USABLE_ERROR * np.abs(storage))
        & (loss_sd < _USABLE_ERROR * np.abs(loss))
        & (storage > 0)
    )
    plane = is_usable & (bulging <= PLANE)
    if np.count_nonzero(plane) >= ROD_LINES:  # what is beyond is not the rod's wave equation
        is_usable = plane
    band = _find_good_band(modulus.frequency, is_usable, int(response.argmax()))
    modulus = replace(modulus, storage_sd=storage_sd, loss_factor_sd=loss_sd, band=band)
    widest = float(bulging[modulus.usable].max()) if modulus.usable.any() else None
    return replace(
        modulus,
        checks=(
            modulus_determined_near_resonance(int(modulus.usable.sum()), band),
            waves_plane(widest, band[1]),
        ),
    )


def _estimate_rest_offset(
    modulus: RodModulus, measured: FRF, ratio: float
) -> tuple[complex, complex] | None:
    """Return the logarithm of T below the band over what the modulus where it begins makes of it.

    The middle of its lines, and the standard error of either part.
    """
    f, usable = measured.frequency, np.flatnonzero(modulus.usable)
    low = f < 0.5 * modulus.band[0]
    if not usable.size or np.count_nonzero(low) < _MEDIAN_LINES:
        return None
    first = int(usable[0])
    # a modulus that falls towards rest as its loss there says: E* as f^(2 delta/pi)
    power = 2 - 2 / np.pi * float(np.angle(modulus.modulus[first]))
    expected, _, _ = _evaluate_base_equation(
        modulus.wave[first] * (f[low] / f[first]) ** power, ratio
    )
    log_offsets = np.log(measured.value[low] * expected)
    parts = np.stack([log_offsets.real, log_offsets.imag])
    error = _MEDIAN * parts.std(axis=1, ddof=1) / np.sqrt(len(log_offsets))
    return complex(*np.median(parts, axis=1)), complex(*error)


def _estimate_scatter(lines: ComplexArray) -> FloatArray:
    """Standard deviation of either part of lines by their second differences, which no curve has.

    The mean over a few neighbours; of fewer lines than that it is not known, 0.
    """
    if len(lines) < 2 * _NEIGHBOUR_LINES:
        return np.zeros(len(lines))
    squared_differences = np.abs(np.diff(lines, 2)) ** 2 / 12  # 1 + 4 + 1, in two parts
    kernel = np.ones(_NEIGHBOUR_LINES)
    mean = np.convolve(squared_differences, kernel, "same") / np.convolve(
        np.ones_like(squared_differences), kernel, "same"
    )
    return np.sqrt(np.pad(mean, 1, mode="edge"))


def _correct_lateral_inertia(part: Disc | Block) -> float:
    r"""Return the decrease of the modulus by lateral inertia, over k^2 (Rayleigh).

    .. math:: \nu^2 I_p / A, \qquad \nu = 1/2
    """
    if isinstance(part, Disc):
        return part.diameter**2 / 32
    return (part.length**2 + part.width**2) / 48


_Equation = Callable[[ComplexArray, float], tuple[ComplexArray, ComplexArray, ComplexArray]]


def _evaluate_base_equation(
    w: ComplexArray, ratio: float
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return 1/T, and its derivatives by w = z^2 and by M/m."""
    z: ComplexArray = np.sqrt(np.asarray(w, dtype=complex))
    sine, cosine = np.sin(z), np.cos(z)
    by_z = -sine - ratio * (sine + z * cosine)
    return cosine - ratio * z * sine, by_z / (2 * z), -z * sine


def _evaluate_force_equation(
    w: ComplexArray, ratio: float
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """F/(x m omega^2), and its derivatives by w = z^2 and by M/m."""
    z: ComplexArray = np.sqrt(np.asarray(w, dtype=complex))
    cotangent = 1 / np.tan(z)
    by_z = -(1 + cotangent**2) / z - cotangent / z**2
    return cotangent / z - ratio, by_z / (2 * z), -np.ones_like(z)


def _solve_line_roots(
    equation: _Equation, y: ComplexArray, omega: FloatArray, ratio: float
) -> ComplexArray:
    """Return the root w of every line: from the resonance outwards, each from its neighbour's.

    nan where noise leaves none: far from the resonance T hardly depends on the modulus.

    Raises
    ------
    DataError
        If less than half of the lines have one.
    """
    peak = int(np.abs(y / (1 if equation is _evaluate_base_equation else 1 / omega**2)).argmin())
    w = np.zeros(len(y), dtype=complex)
    guess = (
        (1 - y[peak]) / (ratio + 0.5)
        if equation is _evaluate_base_equation
        else 1 / (y[peak] + ratio + 1 / 3)
    )
    for order in (range(peak, len(y)), range(peak - 1, -1, -1)):
        previous_line = peak
        for i in order:
            start = (
                guess if i == peak else w[previous_line] * (omega[i] / omega[previous_line]) ** 2
            )
            w[i] = _find_root(equation, complex(start), complex(y[i]), ratio)
            previous_line = i if np.isfinite(w[i]) else previous_line
    failed_indices = np.flatnonzero(~np.isfinite(w))
    if np.isnan(w[peak]) or 2 * len(failed_indices) > len(w):
        line = omega[peak if np.isnan(w[peak]) else failed_indices[0]] / (2 * np.pi)
        raise DataError(
            f"no modulus explains the line at {line:.5g} Hz: expected the FRF of a mass on the "
            "rod. Check mass and density, or narrow the band (--band)"
        )
    return w


def _find_root(equation: _Equation, w: complex, y: complex, ratio: float) -> complex:
    for _ in range(_MAX_ITERATIONS):
        value, slope, _ = equation(np.asarray(w), ratio)
        step = complex((value - y) / slope)
        w -= step * min(1.0, 0.5 * abs(w) / max(abs(step), 1e-300))
        if abs(step) <= _CONVERGENCE_TOLERANCE * abs(w):
            return w
    return complex(np.nan, np.nan)


def _find_good_band(frequency: FloatArray, is_usable: np.ndarray, peak: int) -> tuple[float, float]:
    """Return the run of good lines nearest to the peak."""
    if not is_usable.any():
        return np.nan, np.nan
    nearest = int(np.flatnonzero(is_usable)[np.abs(np.flatnonzero(is_usable) - peak).argmin()])
    bad_indices = np.flatnonzero(~is_usable)
    low = int(bad_indices[bad_indices < nearest].max(initial=-1)) + 1
    high = int(bad_indices[bad_indices > nearest].min(initial=len(is_usable))) - 1
    return float(frequency[low]), float(frequency[high])
