"""Recommended model of a study, and its values with their intervals."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.reported_values import ReportedValue
from dashpot.datamodel.bounds import StiffnessBounds
from dashpot.datamodel.fit import Fit, get_fitted_mass, get_hammer_stiffness_factor
from dashpot.fitting.prediction_bounds import parameter_band
from dashpot.solids.maxwell import Solid
from dashpot.vibration.mass_on_seals import (
    MassOnSeals,
    OperatingPoint,
    model_modes,
    operating_point,
    predict_frf,
)
from dashpot.vibration.modal.peaks import find_peak
from dashpot.workflow.study import Study

Quantity = Literal[
    "frequency", "damping", "peak", "end of hold", "dynamic stiffness", "loss factor"
]

_UNITS: dict[Quantity, tuple[str, str]] = {
    "frequency": ("Hz", ""), "damping": ("1", "%"), "peak": ("1/kg", ""),
    "end of hold": ("N/m", ""), "dynamic stiffness": ("N/m", ""),
    "loss factor": ("", ""),
}  # fmt: skip
"""SI unit, and the display unit if unusual."""


@dataclass(frozen=True)
class RecommendedValue:
    """Recommended value with its interval.

    Attributes
    ----------
    quantity : str
    value, low, high : float
        SI; nan without an interval, infinite without a limit.
    at : float or None
        Its frequency, Hz, or time, s.
    is_limit : bool
        The interval is a bound over every non-negative spectrum that the test does not reject, not
        a confidence interval of the parameters.
    measured, measured_se : float or None
        Value measured by the hammer, and its standard error.
    """

    quantity: Quantity
    value: float
    low: float = float("nan")
    high: float = float("nan")
    at: float | None = None
    is_limit: bool = False
    measured: float | None = None
    measured_se: float | None = None

    @property
    def fact(self) -> ReportedValue:
        """The value for tables."""
        unit, read = _UNITS[self.quantity]
        return ReportedValue(self.quantity, self.value, self.low, self.high, unit, read=read)

    @property
    def measured_fact(self) -> ReportedValue | None:
        """The value measured by the hammer, for tables."""
        if self.measured is None:
            return None
        unit, read = _UNITS[self.quantity]
        return ReportedValue.from_error(
            self.quantity, self.measured, self.measured_se, unit=unit, read=read
        )


@dataclass(frozen=True)
class Recommendation:
    """Recommendation of a study.

    Attributes
    ----------
    recommended : bool
        False where the verdict is "do not use": `solid` is then that of the relaxation test.
    joint : bool
        Whether `solid` is the joint model.
    solid : Fit
        Model of one seal.
    point : OperatingPoint or None
        Static equilibrium of the mass on it; None without a mass.
    mass_values, seal_values : tuple of RecommendedValue
        Values of the mass on its seals, none without a mass; and of one seal.
    """

    recommended: bool
    joint: bool
    solid: Fit
    point: OperatingPoint | None
    mass_values: tuple[RecommendedValue, ...]
    seal_values: tuple[RecommendedValue, ...]

    @property
    def values(self) -> tuple[RecommendedValue, ...]:
        """All values."""
        return (*self.mass_values, *self.seal_values)


def recommend_solid(study: Study, *, allow_rejected: bool = False) -> Recommendation:
    """Return the recommended model, and its values with intervals or bounds.

    The joint model is recommended where there is one and the verdict allows it, else the model of
    the relaxation test. With `allow_rejected` a joint model is returned whatever its verdict.
    Intervals of the joint model are 95 % intervals of its parameters; those of the relaxation test
    are bounds over unresolved arms where these were computed.
    """
    is_usable = study.verdict.use != "do not use"
    joint_fit = study.joint if is_usable or allow_rejected else None
    solid = study.fit if joint_fit is None else joint_fit
    joint = joint_fit is not None
    point, resonance = _find_resonance(study, solid)
    frequency = solid.band[1] if resonance is None else resonance.frequency
    bounds, is_bound = _select_bounds(study, solid, frequency, joint=joint)
    stiffness = _evaluate_value(solid, bounds, "storage", frequency, is_limit=is_bound)
    loss = _evaluate_value(solid, bounds, "loss_factor", frequency, is_limit=is_bound)
    under_mass: tuple[RecommendedValue, ...] = ()
    if resonance is not None:
        under_mass = _list_values_under_mass(study, resonance, stiffness, loss, joint=joint)
    if point is not None:
        scaled_values = [point.factor * v for v in (stiffness.value, stiffness.low, stiffness.high)]
        stiffness = replace(
            stiffness, value=scaled_values[0], low=scaled_values[1], high=scaled_values[2]
        )
    one_seal = (*_list_end_of_hold(study, solid), stiffness, loss)
    return Recommendation(is_usable, joint, solid, point, under_mass, one_seal)


class _Resonance(NamedTuple):
    """Frequency of a peak, Hz, damping ratio of its mode, and height, 1/kg."""

    frequency: float
    damping: float
    height: float


def _find_resonance(study: Study, solid: Fit) -> tuple[OperatingPoint | None, _Resonance | None]:
    """Return the static equilibrium of the mass and its resonance, if any."""
    mass = _get_mass(study, solid)
    if mass is None:
        return None, None
    equilibrium = study.static_equilibrium
    compression = (
        None
        if equilibrium is None or not equilibrium.point.is_stated
        else equilibrium.point.compression
    )
    point = operating_point(solid, MassOnSeals(mass, study.seals, compression))
    seals = study.seals * get_hammer_stiffness_factor(solid) * point.solid(solid)
    mode = next(iter(model_modes(seals, mass)), None)
    if mode is None:
        return point, None
    frequency, height = _find_peak(seals, mass, mode.frequency)
    return point, _Resonance(frequency, mode.damping_ratio, height)


def _get_mass(study: Study, solid: Fit) -> float | None:
    """Return the mass on the seals: that of the joint model, where it was fitted."""
    return None if study.mass is None else get_fitted_mass(solid) or study.mass


def _find_peak(solid: Solid, mass: float, around_hz: float) -> tuple[float, float]:
    """Return frequency, Hz, and height, 1/kg, of the peak of the accelerance.

    Without a peak: the frequency of the pole, and no height.
    """
    frf = predict_frf(solid, mass=mass, frequency=around_hz * np.geomspace(0.9, 1.6, 401))
    peak_line = int(np.argmax(np.abs(frf.value)))
    if not 0 < peak_line < len(frf.frequency) - 1:
        return around_hz, float("nan")
    peak = find_peak(frf)
    return peak.frequency, peak.height


def _select_bounds(
    study: Study, solid: Fit, frequency: float, *, joint: bool
) -> tuple[StiffnessBounds | None, bool]:
    """Return the limits at a frequency, and whether they are bounds over unresolved arms."""
    unmeasured = study.unmeasured
    if (
        not joint
        and unmeasured is not None
        and unmeasured.frequency[0] <= frequency <= unmeasured.frequency[-1]
    ):
        return unmeasured, True
    if not solid.estimate.parameters:
        return None, False
    return parameter_band(solid, [frequency]), False


def _evaluate_value(
    solid: Fit, bounds: StiffnessBounds | None, name: str, frequency: float, *, is_limit: bool
) -> RecommendedValue:
    """Return stiffness or loss factor at a frequency, Hz; the interval contains the value."""
    value = float(getattr(solid.solid, name)(frequency=frequency))
    quantity: Quantity = "dynamic stiffness" if name == "storage" else "loss factor"
    if bounds is None:
        return RecommendedValue(quantity, value, at=frequency)
    edges: FloatArray = getattr(bounds, name)
    low, high = (float(np.interp(np.log(frequency), np.log(bounds.frequency), e)) for e in edges)
    return RecommendedValue(quantity, value, min(low, value), max(high, value), frequency, is_limit)


def _list_values_under_mass(
    study: Study,
    peak: _Resonance,
    stiffness: RecommendedValue,
    loss: RecommendedValue,
    *,
    joint: bool,
) -> tuple[RecommendedValue, ...]:
    """Return peak frequency, damping ratio and height, with intervals by stiffness and loss factor.

    The frequency scales with the root of the stiffness, the damping ratio with the loss factor.
    """
    c, frequency, limits = study.comparison, peak.frequency, None if joint else study.frf_band
    value_limits = [
        frequency * np.sqrt(stiffness_limit / stiffness.value)
        for stiffness_limit in (stiffness.low, stiffness.high)
    ]
    if limits is not None and limits.peak_frequency is not None:
        value_limits = _contain(limits.peak_frequency, frequency)
    damping = max(peak.damping, 0.0) + 0.0  # of a spring, to rounding
    damping_ratio = damping / loss.value if loss.value > 0 else 0.5
    damping_range = _contain((damping_ratio * loss.low, damping_ratio * loss.high), damping)
    bound = stiffness.is_limit
    return (
        RecommendedValue(
            "frequency", frequency, float(value_limits[0]), float(value_limits[1]), is_limit=bound,
            measured=None if c is None else c.measured_hz,
            measured_se=None if c is None else c.measured_hz_se,
        ),
        RecommendedValue(
            "damping", damping, damping_range[0], damping_range[1], is_limit=bound,
            measured=None if c is None else c.measured_damping,
            measured_se=None if c is None else c.measured_damping_se,
        ),
        *_list_peak_height(study, peak.height, loss, joint=joint),
    )  # fmt: skip


def _list_peak_height(
    study: Study, height: float, loss: RecommendedValue, *, joint: bool
) -> tuple[RecommendedValue, ...]:
    """Return the height of the peak, on the lines of the hammer if there is one; empty without one.

    Where its limits were not computed it scales with the reciprocal of the loss factor.
    """
    comparison = study.joint_comparison if joint else study.comparison
    if comparison is not None:
        height = comparison.predicted_peak
    if not np.isfinite(height):
        return ()
    limits = None if joint else study.frf_band
    if limits is not None and limits.peak_height is not None:
        low, high = _contain(limits.peak_height, height)
    else:
        low, high = (height * loss.value / loss_limit if loss_limit > 0 else np.inf
                     for loss_limit in (loss.high, loss.low))  # fmt: skip
    measured_peak = None if comparison is None else comparison.measured_peak
    return (
        RecommendedValue("peak", height, low, high, is_limit=loss.is_limit, measured=measured_peak),
    )


def _contain(limits: tuple[float, float], value: float) -> list[float]:
    """Return an interval widened to contain a value."""
    return [min(limits[0], value), max(limits[1], value)]


def _list_end_of_hold(study: Study, solid: Fit) -> tuple[RecommendedValue, ...]:
    """Return the stiffness at the end of the hold, the best known of a relaxation test."""
    end_of_hold = solid.evidence.end_of_hold or study.fit.evidence.end_of_hold
    if end_of_hold is None:
        return ()
    value = end_of_hold.compute_stiffness(solid.solid)
    low, high = _contain(end_of_hold.k_end, value)
    return (RecommendedValue("end of hold", value, low, high, end_of_hold.end_time, is_limit=True),)
