"""Recommended solid of a study, and its values with their limits."""

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
"""Of SI, and the one in which people read it where that is not the usual one."""


@dataclass(frozen=True)
class Answer:
    """Value with its interval.

    Attributes
    ----------
    quantity : str
    value, low, high : float
        SI; nan ends where none are known, infinite ones where nothing limits it.
    at : float or None
        The frequency, Hz, or the time, s, that it holds for.
    bound : bool
        The ends are those of every non-negative spectrum that the test does not reject, not of a
        confidence interval of the parameters.
    measured, measured_se : float or None
        The same by the hammer, and its standard error.
    """

    quantity: Quantity
    value: float
    low: float = float("nan")
    high: float = float("nan")
    at: float | None = None
    bound: bool = False
    measured: float | None = None
    measured_se: float | None = None

    @property
    def fact(self) -> ReportedValue:
        """Reported value, as a table shows it."""
        unit, read = _UNITS[self.quantity]
        return ReportedValue(self.quantity, self.value, self.low, self.high, unit, read=read)

    @property
    def measured_fact(self) -> ReportedValue | None:
        """The same by the hammer."""
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
        False where the verdict is "do not use": `solid` is then what the relaxation test gave.
    joint : bool
        True if the solid is that of both tests.
    solid : Fit
        Of one seal.
    point : OperatingPoint or None
        Where the mass rests on it; None without a mass.
    under_mass, one_seal : tuple of Answer
        Of the mass on its seals, none without a mass; and of one seal.
    """

    recommended: bool
    joint: bool
    solid: Fit
    point: OperatingPoint | None
    under_mass: tuple[Answer, ...]
    one_seal: tuple[Answer, ...]

    @property
    def answers(self) -> tuple[Answer, ...]:
        """All of them."""
        return (*self.under_mass, *self.one_seal)


def recommend_solid(study: Study, *, requested: bool = False) -> Recommendation:
    """Return the solid to take, and what it says, each with its interval or bound.

    The joint fit where there is one and the verdict allows it; else that of the relaxation test.
    Where the joint fit is what was `requested`, it is reported whether or not it is to be used.
    Ends of the joint fit are 95 % intervals of its parameters; those of the relaxation test are
    bounds over unresolved arms wherever they were computed.
    """
    usable = study.verdict.use != "do not use"
    fitted = study.joint if usable or requested else None
    solid = study.fit if fitted is None else fitted
    joint = fitted is not None
    point, resonance = _resonance(study, solid)
    at = solid.band[1] if resonance is None else resonance.frequency
    bounds, bound = _bounds(study, solid, at, joint=joint)
    stiffness = _evaluate_answer(solid, bounds, "storage", at, bound=bound)
    loss = _evaluate_answer(solid, bounds, "loss_factor", at, bound=bound)
    under: tuple[Answer, ...] = ()
    if resonance is not None:
        under = _under_mass(study, resonance, stiffness, loss, joint=joint)
    if point is not None:
        ends = [point.factor * v for v in (stiffness.value, stiffness.low, stiffness.high)]
        stiffness = replace(stiffness, value=ends[0], low=ends[1], high=ends[2])
    seal = (*_end_of_hold(study, solid), stiffness, loss)
    return Recommendation(usable, joint, solid, point, under, seal)


class _Resonance(NamedTuple):
    """The frequency of a peak, Hz, the damping ratio of its mode, and its height, 1/kg."""

    frequency: float
    damping: float
    height: float


def _resonance(study: Study, solid: Fit) -> tuple[OperatingPoint | None, _Resonance | None]:
    """Return where the mass rests; and its resonance, if any."""
    mass = _mass(study, solid)
    if mass is None:
        return None, None
    rests = study.static_equilibrium
    compression = None if rests is None or not rests.point.given else rests.point.compression
    point = operating_point(solid, MassOnSeals(mass, study.seals, compression))
    seals = study.seals * get_hammer_stiffness_factor(solid) * point.solid(solid)
    mode = next(iter(model_modes(seals, mass)), None)
    if mode is None:
        return point, None
    frequency, height = _peak(seals, mass, mode.frequency)
    return point, _Resonance(frequency, mode.damping_ratio, height)


def _mass(study: Study, solid: Fit) -> float | None:
    """Return what vibrates on the solid: the joint fit has settled on a mass of its own."""
    return None if study.mass is None else get_fitted_mass(solid) or study.mass


def _peak(solid: Solid, mass: float, near: float) -> tuple[float, float]:
    """Return where the accelerance peaks, Hz, and how high, 1/kg: what a hammer shows.

    Where it does not peak it is the pole's own frequency, and no height.
    """
    about = predict_frf(solid, mass=mass, frequency=near * np.geomspace(0.9, 1.6, 401))
    top = int(np.argmax(np.abs(about.value)))
    if not 0 < top < len(about.frequency) - 1:
        return near, float("nan")
    peak = find_peak(about)
    return peak.frequency, peak.height


def _bounds(
    study: Study, solid: Fit, at: float, *, joint: bool
) -> tuple[StiffnessBounds | None, bool]:
    """Return the limits that hold at a frequency, and whether they are over unresolved arms."""
    wide = study.unmeasured
    if not joint and wide is not None and wide.frequency[0] <= at <= wide.frequency[-1]:
        return wide, True
    if not solid.estimate.parameters:
        return None, False
    return parameter_band(solid, [at]), False


def _evaluate_answer(
    solid: Fit, bounds: StiffnessBounds | None, name: str, at: float, *, bound: bool
) -> Answer:
    """Return stiffness or loss factor at a frequency, Hz; the ends hold the value itself."""
    value = float(getattr(solid.solid, name)(frequency=at))
    quantity: Quantity = "dynamic stiffness" if name == "storage" else "loss factor"
    if bounds is None:
        return Answer(quantity, value, at=at)
    edges: FloatArray = getattr(bounds, name)
    low, high = (float(np.interp(np.log(at), np.log(bounds.frequency), e)) for e in edges)
    return Answer(quantity, value, min(low, value), max(high, value), at, bound)


def _under_mass(
    study: Study, peak: _Resonance, stiffness: Answer, loss: Answer, *, joint: bool
) -> tuple[Answer, ...]:
    """Peak frequency, damping ratio and height, with the ends that stiffness and loss factor give.

    A frequency goes with the root of the stiffness, the damping ratio with the loss factor.
    """
    c, frequency, limits = study.comparison, peak.frequency, None if joint else study.frf_band
    ends = [frequency * np.sqrt(end / stiffness.value) for end in (stiffness.low, stiffness.high)]
    if limits is not None and limits.peak_frequency is not None:
        ends = _holding(limits.peak_frequency, frequency)
    damping = max(peak.damping, 0.0) + 0.0  # of a spring, to rounding
    share = damping / loss.value if loss.value > 0 else 0.5
    bound = stiffness.bound
    return (
        Answer(
            "frequency", frequency, float(ends[0]), float(ends[1]), bound=bound,
            measured=None if c is None else c.measured_hz,
            measured_se=None if c is None else c.measured_hz_se,
        ),
        Answer(
            "damping", damping, share * loss.low, share * loss.high, bound=bound,
            measured=None if c is None else c.measured_damping,
            measured_se=None if c is None else c.measured_damping_se,
        ),
        *_height(study, peak.height, loss, joint=joint),
    )  # fmt: skip


def _height(study: Study, height: float, loss: Answer, *, joint: bool) -> tuple[Answer, ...]:
    """How high the peak is, on the lines of the hammer if there is one; none that does not peak.

    Where its ends were not sought it goes with the reciprocal of the loss factor.
    """
    held = study.joint_comparison if joint else study.comparison
    if held is not None:
        height = held.predicted_peak
    if not np.isfinite(height):
        return ()
    limits = None if joint else study.frf_band
    if limits is not None and limits.peak_height is not None:
        low, high = _holding(limits.peak_height, height)
    else:
        low, high = (height * loss.value / end if end > 0 else np.inf
                     for end in (loss.high, loss.low))  # fmt: skip
    measured = None if held is None else held.measured_peak
    return (Answer("peak", height, low, high, bound=loss.bound, measured=measured),)


def _holding(ends: tuple[float, float], value: float) -> list[float]:
    """Ends that hold the value itself."""
    return [min(ends[0], value), max(ends[1], value)]


def _end_of_hold(study: Study, solid: Fit) -> tuple[Answer, ...]:
    """Return the stiffness that the relaxation test knows best."""
    end = solid.evidence.end_of_hold or study.fit.evidence.end_of_hold
    if end is None:
        return ()
    value = end.compute_stiffness(solid.solid)
    low, high = min(end.k_end[0], value), max(end.k_end[1], value)
    return (Answer("end of hold", value, low, high, end.end_time, bound=True),)
