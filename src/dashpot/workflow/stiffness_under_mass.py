"""Static equilibrium of a mass on fitted seals: secant and tangent stiffness, limits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.option_fields import Family
from dashpot.base.reported_values import NORMAL
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.datamodel.bounds import FRFBounds
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import Kind, Mode
from dashpot.fitting.prediction_bounds import PredictedFRF, formal_frf_band, frf_band
from dashpot.solids.maxwell import Solid
from dashpot.vibration.checks import compression_tested, mass_of_a_block
from dashpot.vibration.mass_on_seals import (
    MassOnSeals,
    OperatingPoint,
    model_modes,
    operating_point,
)
from dashpot.workflow.checks import families_predict_alike

if TYPE_CHECKING:
    from dashpot.datamodel.relaxation import RampHold

# Static equilibrium, with peaks by secant and tangent stiffness, and limits.


# Number of lines of the limits in a band.
LIMIT_LINES = 401
# what a tangent in doubt keeps at least of its value
MIN_TANGENT_SHARE = 0.05


@dataclass(frozen=True)
class StiffnessAt:
    """Stiffness of a seal, and the frequency of the mass on it.

    Attributes
    ----------
    stiffness, stiffness_se : float
        Relaxed, of one seal, N/m. The error is that of the elastic law's shape.
    frequency, damping_ratio : float or None
        Frequency and damping ratio of the first mode, Hz; None if nothing oscillates.
    """

    stiffness: float
    stiffness_se: float
    frequency: float | None
    damping_ratio: float | None


class EquilibriumSummary(NamedTuple):
    """Compression and tested depth, m; whether the law is extrapolated; both stiffnesses."""

    compression: float | None
    depth: float | None
    extrapolated_law: bool
    secant: StiffnessAt
    tangent: StiffnessAt


@dataclass(frozen=True)
class StaticEquilibrium:
    """Static equilibrium of a mass, with the solids of secant and tangent stiffness.

    Attributes
    ----------
    point : OperatingPoint
    secant : StiffnessAt
        The fit's own, at the depth of the relaxation test.
    tangent : StiffnessAt
        Tangent stiffness at the compression of the mass, used in predictions.
    """

    point: OperatingPoint
    secant: StiffnessAt
    tangent: StiffnessAt

    @property
    def summary(self) -> EquilibriumSummary:
        """Equilibrium as a document shows it."""
        point = self.point
        compression = point.compression if np.isfinite(point.compression) else None
        law = point.is_extrapolated and not point.linear
        return EquilibriumSummary(compression, point.depth, law, self.secant, self.tangent)

    def __str__(self) -> str:
        point, secant, tangent = self.point, self.secant, self.tangent
        if point.linear:
            return ""
        how_known = "as given" if point.is_stated else "under its weight"
        compression_text, depth = (
            format_quantity(value or 0.0, "mm", ".3g") for value in (point.compression, point.depth)
        )
        lines = [
            (
                f"The seals are compressed by {compression_text} {how_known}; they were tested to "
                f"{depth}."
            )
        ]
        for name, stiffness in (
            (f"secant at {depth}", secant),
            (f"tangent at {compression_text}", tangent),
        ):
            peak = (
                "no resonance" if stiffness.frequency is None else f"{stiffness.frequency:.5g} Hz"
            )
            error = (
                f" ± {convert_to_unit(stiffness.stiffness_se, 'N/mm'):.2g}"
                if stiffness.stiffness_se > 0
                else ""
            )
            lines.append(
                f"  {name}  {convert_to_unit(stiffness.stiffness, 'N/mm'):.4g}{error} N/mm, {peak}"
            )
        if point.is_extrapolated:
            lines.append("  ! deeper than tested: the last tangent is used")
        return "\n".join(lines)


def find_static_equilibrium(fit: Fit, load: MassOnSeals) -> StaticEquilibrium:
    """Return where a mass rests on seals, with the secant and the tangent solid."""
    point = operating_point(fit, load)
    k = fit.solid.k_inf

    def evaluate_stiffness(solid: Solid, error: float) -> StiffnessAt:
        mode = next(iter(model_modes(load.seals * solid, load.mass)), None)
        items = (None, None) if mode is None else (mode.frequency, mode.damping_ratio)
        return StiffnessAt(solid.k_inf, error, *items)

    return StaticEquilibrium(
        point,
        evaluate_stiffness(fit.solid, 0.0),
        evaluate_stiffness(point.solid(fit), k * point.factor_se),
    )


def rest_checks(point: OperatingPoint, mass: float) -> tuple[Check, ...]:
    """Ask whether a mass, kg, is a block's and rests no deeper than the seals were tested."""
    return mass_of_a_block(mass), compression_tested(point.compression, point.depth)


def frf_limits(
    fit: Fit,
    tests: RampHold | Sequence[RampHold],
    point: OperatingPoint,
    load: MassOnSeals,
    *,
    frequency: npt.ArrayLike,
    temperature: float | None = None,
    kind: Kind = Kind.ACCELERANCE,
) -> FRFBounds:
    r"""Return limits of the response by both kinds of ignorance, where the mass rests.

    A solid that is s times as stiff and a times as slow answers at :math:`\omega` as the fit at
    :math:`a\omega` under a mass :math:`m/(a^2 s)`, an accelerance times :math:`1/(a^2 s)`. The
    uncertainty of the tangent, and of b_T, slides the limits along the frequency axis
    (:func:`_slide_limits`); that of a_T is met by the limits at both of its ends.

    Parameters
    ----------
    fit : Fit
        Fit of one seal.
    tests : RampHold or sequence of RampHold
        What it was fitted to.
    point : OperatingPoint
        At `temperature`.
    load : MassOnSeals
    frequency : array_like, shape (n,)
        Hz, > 0.
    temperature : float, optional
        K; by default that of the fit's solid.
    kind : Kind
        Accelerance or transmissibility.
    """
    forced = kind is Kind.ACCELERANCE
    shifts, f = fit.temperatures, np.asarray(frequency, dtype=float)
    b_t, time_factors, shifted_fit, doubt_b = 1.0, [1.0], fit, 0.0
    if temperature is not None and shifts is not None and temperature != shifts.reference:
        shifted_fit, b_t = fit.at_temperature(temperature), shifts.b_t(temperature)
        doubt_a, doubt_b = shifts.error(temperature)
        half_width = NORMAL * doubt_a
        time_factors = list(float(shifts.law.a_t(temperature)) * np.exp([-half_width, half_width]))
    s = point.factor * b_t
    bounds = []
    for a in time_factors:
        scale = a**2 * s
        limits = frf_band(
            fit, tests, mass=load.mass / scale, frequency=a * f, seals=load.seals, kind=kind,
            coupled=load.coupled / scale,
        )  # fmt: skip
        bounds.append(_scale_bounds(limits, 1 / a, 1 / scale if forced else 1.0))
    if shifted_fit is fit:
        merged_bounds = bounds[0]
    else:
        omega = 2 * np.pi * f
        K = point.solid(shifted_fit).complex_stiffness(omega=omega)
        values = PredictedFRF(load, kind).magnitude(K, omega)
        formal = formal_frf_band(
            shifted_fit, load.divide_masses(point.factor), frequency=f, kind=kind
        )
        merged_bounds = _merge_bounds(bounds, values, formal / point.factor if forced else formal)
    note = "; with the uncertainty of the tangent at the compression of the mass"
    widened_point = replace(
        point, factor_se=float(np.hypot(point.factor_se, point.factor * doubt_b))
    )
    return replace(
        merged_bounds,
        parameter=_slide_limits(f, merged_bounds.parameter, widened_point),
        unmeasured=_slide_limits(f, merged_bounds.unmeasured, widened_point),
        message=merged_bounds.message + note * (point.factor_se > 0),
    )


def _scale_bounds(bounds: FRFBounds, frequency: float, height: float) -> FRFBounds:
    """Return limits with both axes multiplied by factors."""

    def times(scale: float, interval: tuple[float, float] | None) -> tuple[float, float] | None:
        return None if interval is None else (scale * interval[0], scale * interval[1])

    return replace(
        bounds,
        frequency=frequency * bounds.frequency,
        magnitude=height * bounds.magnitude,
        parameter=height * bounds.parameter,
        unmeasured=height * bounds.unmeasured,
        peak_frequency=times(frequency, bounds.peak_frequency),
        peak_height=times(height, bounds.peak_height),
    )


def _merge_bounds(
    bounds: Sequence[FRFBounds], values: FloatArray, parameter_limits: FloatArray
) -> FRFBounds:
    """Return what holds every one of some limits, and the solid's own magnitude."""
    low = np.min([values, *(bound.unmeasured[0] for bound in bounds)], axis=0)
    high = np.max([values, *(bound.unmeasured[1] for bound in bounds)], axis=0)

    def ends(pairs: Sequence[tuple[float, float] | None]) -> tuple[float, float] | None:
        items = [pair for pair in pairs if pair is not None]
        if len(items) < len(pairs):
            return None
        return min(pair[0] for pair in items), max(pair[1] for pair in items)

    return replace(
        bounds[0],
        magnitude=values,
        parameter=parameter_limits,
        unmeasured=np.array([low, high]),
        peak_frequency=ends([bound.peak_frequency for bound in bounds]),
        peak_height=ends([bound.peak_height for bound in bounds]),
    )


def replace_by_alternative(fit: Fit) -> Fit | None:
    """A fit with the other family's solid in place of its own, if that explains the tests too."""
    other = fit.evidence.alternative
    return None if other is None or not other.is_sufficient else replace(fit, solid=other.solid)


def find_alternative_modes(fit: Fit, point: OperatingPoint, load: MassOnSeals) -> tuple[Mode, ...]:
    """Modes of a mass on the other family of solids, if one explains the tests as well."""
    other_fit = replace_by_alternative(fit)
    return () if other_fit is None else model_modes(load.seals * point.solid(other_fit), load.mass)


def family_checks(fit: Fit, point: OperatingPoint, load: MassOnSeals) -> tuple[Check, ...]:
    """Whether another family of solids, where one was fitted, foretells the same resonance."""
    if fit.evidence.alternative is None:
        return ()
    modes = model_modes(load.seals * point.solid(fit), load.mass)
    other_modes = find_alternative_modes(fit, point, load)
    return (families_predict_alike(next(iter(modes), None), next(iter(other_modes), None)),)


def formal_limits(
    fit: Fit,
    point: OperatingPoint,
    load: MassOnSeals,
    *,
    frequency: FloatArray,
    kind: Kind = Kind.ACCELERANCE,
) -> FloatArray:
    """Return the limits by the standard errors alone, shape (2, n), so too."""
    s = point.factor
    limits = formal_frf_band(fit, load.divide_masses(s), frequency=frequency, kind=kind)
    limits = limits / s if kind is Kind.ACCELERANCE else limits
    return _slide_limits(frequency, limits, point)


def _slide_limits(frequency: FloatArray, limits: FloatArray, point: OperatingPoint) -> FloatArray:
    r"""Return lowest and highest limit over the interval of a doubtful tangent, shape (2, n).

    A stiffness that hardly changes over a few per cent of frequency, times s, answers at f as the
    old one at :math:`f/\sqrt s`.
    """
    part = NORMAL * point.factor_se / point.factor
    if part <= 0:
        return limits
    first, last = (
        frequency / np.sqrt(1 + part),
        frequency / np.sqrt(max(1 - part, MIN_TANGENT_SHARE)),
    )
    end_values = [[np.interp(edge, frequency, row) for edge in (first, last)] for row in limits]
    low = np.min(end_values[0], axis=0)
    # beside a line that nothing limits, the straight line to it is no number
    high = np.nan_to_num(np.max(end_values[1], axis=0), nan=np.inf, posinf=np.inf)
    windows = zip(
        np.searchsorted(frequency, first), np.searchsorted(frequency, last, "right"), strict=True
    )
    for i, (start, stop) in enumerate(windows):
        low[i] = min(low[i], limits[0, start:stop].min())
        high[i] = max(high[i], limits[1, start:stop].max())
    return np.array([low, high])


# Predicted FRF of a mass, with peak, modes and limits.


class RivalModes(NamedTuple):
    """Alternative family of solids that explains the test, with the modes of the mass on it."""

    family: Family
    modes: tuple[Mode, ...]
