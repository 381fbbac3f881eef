r"""Fit of the contact law of a surface to the motion of an indenter.

For each law the record about its largest contact is followed by what the law's own motion would
make of the sensor, with its touch, its speed of approach, an offset and a drift free:

.. math:: y(t) = s(t - t_0;\, \theta, V) + b + d\,(t - \bar t) + \text{noise}

by least squares; offset and drift are projected out. The noise, coloured or not, is that of the
residual, and the covariance is the sandwich with it. Between laws BIC decides.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from itertools import product

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import DataError, FitError
from dashpot.base.option_fields import require_choice
from dashpot.base.provenance import list_sources
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import get_display_unit
from dashpot.base.value_ranges import SIZES
from dashpot.datamodel.checks import caution_checks
from dashpot.extensions.materials.indentation import checks
from dashpot.extensions.materials.indentation.candidate_laws import (
    LAWS,
    STEP,
    Law,
    SensorSignal,
    simulate_sensor_signal,
)
from dashpot.extensions.materials.indentation.collision import Collision
from dashpot.extensions.materials.indentation.contact_law import (
    ContactLaw,
    RelaxingContact,
    ViscousContact,
    reduced_modulus,
)
from dashpot.extensions.materials.indentation.datamodel import IndentationFit, IndentationTest
from dashpot.extensions.materials.indentation.indenter import ImpactLawOption
from dashpot.extensions.materials.indentation.preprocess import ContactInterval, largest_contact
from dashpot.extensions.materials.indentation.profile_likelihood import (
    ProfileSlice,
    compute_profile,
)
from dashpot.extensions.materials.systematic_error import estimate_parameter_shift
from dashpot.numerics.inference.correlated_noise import estimate_noise
from dashpot.numerics.inference.covariance_estimate import Estimate, estimate, score
from dashpot.numerics.least_squares import Optimum, Parameter, Problem, Rows

_WINDOW_MARGIN = 1.0
"""Time before and after the contact that is fitted, in contact times."""
_VELOCITY_OFFSET = 3e-3
"""Standard deviation of a velocity's offset, as a part of the speed: no flight shows it."""
_AT_TOUCH = 0.29
"""Standard deviation of a time that is known to lie between two samples, in their distance."""
_CONTACT_SHIFTS = (0.0, -2.0, -1.0, 1.0, 2.0)
"""Shifts at which the contact time is searched, in samples."""
_MIN_CLIPPED_SAMPLES = 3
"""Smallest number of samples at the same extreme of a saturated sensor."""
_ROUNDING = 1e-5
"""Numerical error of integration and interpolation, as a fraction of the record."""
_LOSSES = frozenset({"c", "viscous_time", "g"})
_OF_RADIUS = frozenset({"modulus", "glassy_modulus"})
"""Values in proportion to the root of the tip radius."""
_TIME = 2
"""Place of the law's time among the parameters."""
_SAME_VALLEY = 0.05
"""Difference of every parameter below which two valleys are one."""
_LEVEL = 0.95
_MAX_QUANTILE_FACTOR = 1.02
"""Factor on a quantile beyond which a slice of a profile is outside."""
_TIME_RANGE = 0.8
"""Search range of the contact time about its start, in contact times."""
_TRIES, _FLAT = 40, 1e-7
_STARTS = 4
"""Number of descents, from the best entries of a table."""
_NEAR_STEPS, _ROUGHLY = 3, 1e-3
"""Steps that the others take beside one of a table, and what they may leave."""
_DECISIVE_BIC = 10.0
"""Difference of BIC beyond which another law is out (Kass and Raftery 1995: very strong)."""


@dataclass(frozen=True, eq=False)
class _NearHit:
    """Samples around one contact, with the columns of the sensor's offset and drift."""

    test: IndentationTest
    contact: ContactInterval
    time: FloatArray
    signal: FloatArray
    is_used: BoolArray
    clipped_count: int
    mass: float
    fixed: FloatArray
    prior: FloatArray  # inverse standard deviation of each column, over the noise's

    def sample_collision(self, hit: Collision, touch_time: float) -> SensorSignal:
        signal = simulate_sensor_signal(
            hit, self.test.quantity, self.time - touch_time, self.test.step
        )
        return SensorSignal(*(values[self.is_used] for values in signal))

    def simulate_collision(self, law: Law, theta: FloatArray) -> Collision:
        return law.collision(theta, self.mass, self.test.indenter.gravity)

    def simulate_signal(self, law: Law, theta: FloatArray, acceleration: float) -> SensorSignal:
        return self.sample_collision(
            law.collision(theta, self.mass, acceleration), float(theta[-1])
        )

    def rows(self, law: Law, acceleration: float, theta: FloatArray) -> Rows:
        """Return the residuals of a motion, with the columns of the sensor and their priors."""
        no_residual = np.zeros(len(self.prior))
        value, rate, stretched = self.simulate_signal(law, theta, acceleration)

        def slope(_: FloatArray) -> FloatArray:
            """Return the derivatives, exact except for the law's own parameters and gravity."""

            def differentiate_signal(theta: FloatArray, acceleration: float) -> FloatArray:
                return (self.simulate_signal(law, theta, acceleration).signal - value) / STEP

            J = np.zeros((len(value) + len(no_residual), len(theta)))
            J[: len(value), [0, -2, -1]] = np.stack((stretched, value, -rate), axis=1)
            for i in range(1, len(theta) - 2):
                J[: len(value), i] = differentiate_signal(
                    theta + STEP * np.eye(len(theta))[i], acceleration
                )
            if acceleration > 0:
                # in units of the contact it is proportional to the unit of time over the speed
                pulled = differentiate_signal(theta, acceleration * (1 + STEP))
                J[: len(value), [0, -2]] += np.stack((pulled, -pulled), axis=1)
            return J

        return Rows(
            np.append(self.signal[self.is_used] - value, no_residual),
            np.concatenate((self.fixed, np.diag(self.prior))),
            slope,
        )


@dataclass(frozen=True, eq=False)
class _LawOptimum:
    """One contact law at its optimum."""

    name: str
    collision: Collision
    model: FloatArray
    estimate: Estimate
    local_optima: tuple[Optimum, ...]

    @property
    def law(self) -> Law:
        return LAWS[self.name]

    @property
    def optimum(self) -> Optimum:
        return self.estimate.optimum

    @property
    def residual(self) -> FloatArray:
        return self.optimum.residual

    @property
    def touch(self) -> float:
        return float(self.optimum.theta[-1])

    @property
    def contact(self) -> ContactLaw:
        return self.law.contact(self.optimum.theta, self.collision.mass)


def fit_indentation(test: IndentationTest, *, law: ImpactLawOption = "auto") -> IndentationFit:
    """Fit the contact law of a surface to the largest contact of a record.

    Parameters
    ----------
    test : IndentationTest
        Its indenter's mass must be known; its radius makes a modulus of k.
    law : str
        ``"kelvin-voigt"``, ``"hertz"``, ``"hertz-kelvin-voigt"``, ``"hertz-maxwell"``, or
        ``"auto"``: the one that BIC prefers.

    Raises
    ------
    DataError
        If the mass is missing, there is no clear contact, or mass and radius give an implausible
        modulus or pressure.
    FitError
        If no law can follow the record.
    """
    require_choice("law", law, ImpactLawOption)
    window = _select_window(test, largest_contact(test))
    candidates = []
    for name in [law] if law != "auto" else LAWS:
        # beside a valley the body may never be let go
        with suppress(DataError):
            candidates += [optimum] if (optimum := _fit_law(window, name)) else []
    if not candidates:
        raise FitError(
            "no contact law fits the record: expected one push, in flight before and after; "
            "cut the record about the contact (--file-part segment=N), or look at it with dashpot "
            "inspect"
        )
    # all laws by the noise of the one that leaves least, for a misfit is no noise
    effective = min(candidates, key=lambda optimum: optimum.optimum.sse).estimate.effective
    scores = {
        optimum.name: score(
            optimum.optimum,
            effective,
            rounding_sse=len(optimum.residual) * _compute_rounding(optimum.model) ** 2,
        )
        for optimum in candidates
    }
    candidates.sort(key=lambda optimum: scores[optimum.name])
    best = candidates[0]
    reported_values = _make_contact_facts(window, best)
    _refuse_absurd(reported_values, test.indenter.radius)
    in_contact = _select_contact_samples(window, best)
    flight = best.residual[~in_contact]
    noise = float(np.sqrt(np.mean(flight**2))) if len(flight) > 8 else 0.0
    remainder = float(np.sqrt(np.mean(best.residual[in_contact] ** 2)))
    size = float(np.ptp(best.model)) or 1.0
    touch_time = best.touch
    close_laws = [
        item for item in candidates[1:] if scores[item.name] - scores[best.name] < _DECISIVE_BIC
    ]
    other_laws = [(item.name, _make_contact_facts(window, item)) for item in close_laws]
    indentation_fit = IndentationFit(
        best.name, best.contact, reported_values, tuple((item.name,
        scores[item.name]) for item in candidates),
        test.indenter, test.quantity, window.time[window.is_used] - touch_time,
        best.model + best.residual,
        best.model, noise, remainder / size, touch_time, best.collision.duration, (), test.source,
    )  # fmt: skip
    checked_checks = checks.run_checks(
        indentation_fit,
        best.collision,
        test,
        contact=window.contact,
        clipped_count=window.clipped_count,
        other_laws=other_laws,
    )
    return replace(indentation_fit, checks=(*checked_checks, *caution_checks(list_sources([test]))))


def _refuse_absurd(reported_values: Sequence[ReportedValue], radius: float | None) -> None:
    """Refuse a mass and a radius that give a modulus impossible for rubber."""
    entries = {reported_value.name: reported_value.value for reported_value in reported_values}
    remedy = "Check the mass and the radius of the indenter, and their units."
    if radius is None or "modulus" not in entries:
        return
    SIZES["modulus"].refuse(entries["modulus"], remedy=remedy)
    pressure = entries["largest_force"] / (np.pi * radius * entries["depth"])
    SIZES["contact pressure"].refuse(float(pressure), remedy=remedy)


def _select_window(test: IndentationTest, contact: ContactInterval) -> _NearHit:
    mass = test.indenter.mass
    if mass is None:
        raise DataError("the mass of the indenter is not known; give it (--mass 5g)")
    margin = _WINDOW_MARGIN * contact.duration
    in_window = (test.time >= contact.start - margin) & (
        test.time <= contact.start + contact.duration + margin
    )
    time, signal = test.time[in_window], contact.sign * test.signal[in_window]
    mask = ~_detect_clipped_samples(signal, test.quantity)
    clipped_count = int(np.count_nonzero(~mask))
    centred = (time - time.mean()) / max(float(np.ptp(time)), 1e-300)
    columns = {
        "acceleration": np.stack((np.ones(len(time)), centred), axis=1),
        "force": np.stack((np.ones(len(time)), centred), axis=1),
        "velocity": np.ones((len(time), 1)),
        "displacement": np.ones((len(time), 1)),
    }[test.quantity]
    prior = np.zeros(columns.shape[1])
    if test.quantity == "velocity":
        scatter = float(np.std(np.diff(signal, 2))) / np.sqrt(6)
        prior[:] = scatter / (_VELOCITY_OFFSET * float(np.ptp(signal)) / 2)
    return _NearHit(test, contact, time, signal, mask, clipped_count, mass, columns[mask], prior)


def _detect_clipped_samples(signal: FloatArray, signal_name: str) -> BoolArray:
    """Return which samples are at the limit of the sensor: equal and largest in a row."""
    if signal_name in {"velocity", "displacement"}:
        return np.zeros(len(signal), dtype=bool)
    index = np.flatnonzero(signal >= signal.max() - 1e-9 * float(np.ptp(signal)))
    is_clipped = np.zeros(len(signal), dtype=bool)
    if len(index) >= _MIN_CLIPPED_SAMPLES and index[-1] - index[0] < 2 * len(index):
        is_clipped[index[0] : index[-1] + 1] = True
    return is_clipped


def _estimate_speed_change(window: _NearHit) -> float:
    """Return an estimate of the speed by the contact."""
    signal, quantity = window.signal, window.test.quantity
    if quantity == "velocity":
        return float(np.ptp(signal))
    if quantity == "displacement":
        return 1.2 * float(np.ptp(signal)) / window.contact.duration
    start, end = window.contact.start, window.contact.start + window.contact.duration
    in_contact = (window.time >= start) & (window.time <= end)
    rest_level = float(np.median(signal[~in_contact])) if (~in_contact).any() else 0.0
    change = float(np.sum(signal[in_contact] - rest_level)) * window.test.step
    return max(change, 1e-12) / (window.mass if quantity == "force" else 1.0)


def _fit_law(window: _NearHit, name: str) -> _LawOptimum | None:
    """Return the best least-squares fit of a law from its starts; None without a motion."""
    law, change, duration = LAWS[name], _estimate_speed_change(window), window.contact.duration
    contact_start, max_shift = window.contact.start, _TIME_RANGE * duration
    touch_parameter = Parameter(contact_start - max_shift, contact_start + max_shift, duration)

    def problem(law: Law, acceleration: float) -> Problem:
        parameters = [*law.parameters(duration, change), touch_parameter]
        return Problem(
            partial(window.rows, law, acceleration), parameters, priors=len(window.prior)
        )

    def nearly(values: Sequence[float]) -> tuple[float, FloatArray]:
        """Return the cost of a loss and a time, by motions that all records share."""
        start = np.append(law.make_starting_parameters(duration, values, change), contact_start)
        rest = [0, len(start) - 2, len(start) - 1]
        optimum = problem(law.fix_loss(values), 0.0).solve(
            [start[rest]], max_steps=_NEAR_STEPS, cost_tolerance=_ROUGHLY
        )
        if optimum is None:
            return np.inf, start
        start[rest] = optimum.theta
        return optimum.cost, start

    table = [nearly(values) for values in product(*law.starting_values)]
    cost = np.array([value for value, _ in table]).reshape(
        [len(start) for start in law.starting_values]
    )
    starts = [table[i][1] for i in _find_valleys(cost)]
    full_problem = problem(law, window.test.indenter.gravity)
    optima = full_problem.find_optima(
        starts,
        same_distance=_SAME_VALLEY,
        max_steps=_TRIES,
        step_tolerance=_FLAT,
        cost_tolerance=_FLAT,
    )
    if not optima:
        return None
    best = min(optima, key=lambda optimum: optimum.cost)
    if len(law.starting_values) == 1:
        # where the force jumps, or rises as a root, a touch between two other samples is a valley
        shifted_starts = np.outer(_CONTACT_SHIFTS, np.eye(len(best.theta))[-1]) * window.test.step
        refined_optimum = full_problem.solve(
            [*best.theta + shifted_starts],
            max_steps=_TRIES,
            step_tolerance=_FLAT,
            cost_tolerance=_FLAT,
        )
        best = refined_optimum or best
    return _estimate_law_errors(window, name, best, optima)


def _find_valleys(cost: FloatArray) -> list[int]:
    """Return the local minima of a table, the best first."""
    padded_values = np.pad(cost, 1, constant_values=np.inf)
    inner = (slice(1, -1),) * cost.ndim
    has_lower_neighbour = np.zeros(cost.shape, dtype=bool)
    for axis in range(cost.ndim):
        for direction in (-1, 1):
            has_lower_neighbour |= np.roll(padded_values, direction, axis)[inner] < cost
    order: list[int] = np.argsort(np.where(has_lower_neighbour, np.inf, cost), axis=None).tolist()
    return order[: min(int(np.count_nonzero(~has_lower_neighbour)), _STARTS)]


def _estimate_law_errors(
    window: _NearHit, name: str, best: Optimum, optima: Sequence[Optimum]
) -> _LawOptimum:
    """Return a law with noise and parameter errors by its residual."""
    hit = window.simulate_collision(LAWS[name], best.theta)
    signal = window.sample_collision(hit, float(best.theta[-1]))
    model = signal.signal
    count = len(best.residual)
    noise = estimate_noise(best.residual, best.jacobian[:count], rounding=_compute_rounding(model))
    uncertainty = estimate(best, noises=[noise], prior_variance=float(noise.autocovariance[0]))
    if hit.force[0] > 0 and window.test.quantity in {"acceleration", "force"}:
        # how a recorder takes a jump is not known: the touch lies between two samples
        nearest = int(np.argmin(np.abs(window.time[window.is_used] - float(best.theta[-1]))))
        change = np.zeros(len(best.all_residuals))
        change[nearest] = _AT_TOUCH * window.test.step * signal.rate[nearest]
        uncertainty = uncertainty.add_parameter_error(estimate_parameter_shift(uncertainty, change))
    return _LawOptimum(name, hit, model, uncertainty, tuple(optima))


def _compute_rounding(model: FloatArray) -> float:
    """Return the rms error of integration and interpolation."""
    return _ROUNDING * float(np.ptp(model))


def _select_contact_samples(window: _NearHit, optimum: _LawOptimum) -> BoolArray:
    time_since_touch = window.time[window.is_used] - optimum.touch
    return np.asarray((time_since_touch >= 0) & (time_since_touch <= optimum.collision.duration))


def _make_contact_facts(window: _NearHit, optimum: _LawOptimum) -> tuple[ReportedValue, ...]:
    """Return the law's parameters and derived values, each with its interval."""
    derived_values = _compute_numbers(window, optimum.law, optimum.optimum.theta)

    def numbers(values: FloatArray) -> FloatArray:
        theta = values[: len(optimum.optimum.theta)]
        return np.array(
            [value for value, _ in _compute_numbers(window, optimum.law, theta).values()]
        )

    slices = (
        _collect_slices(optimum)
        if len(optimum.law.starting_values) > 1
        else [ProfileSlice(0.0, optimum.estimate)]
    )
    widest = optimum.estimate.quantile(_LEVEL)
    derived = [
        (root, uncertainty.derive_quantity(numbers))
        for root, uncertainty in slices
        if root <= _MAX_QUANTILE_FACTOR * widest
    ]

    def ends(level: float) -> tuple[FloatArray, FloatArray]:
        """Return the limits by all slices, over the value."""
        quantile = optimum.estimate.quantile(level)
        group = []
        for root, compute_values in derived:
            if root > _MAX_QUANTILE_FACTOR * quantile:
                continue
            part = (
                compute_values.standard_error
                / compute_values.values
                * np.sqrt(max(quantile**2 - root**2, 0.0))
            )
            error_factor = np.exp(np.minimum(part, 50.0))
            # a loss has a normal error itself, where its logarithm has none
            low = np.where(losses, 1 - part, 1 / error_factor)
            high = np.where(losses, 1 + part, error_factor)
            group.append((compute_values.values * low, compute_values.values * high))
        low = np.min([low for low, _ in group], axis=0)
        high = np.max([high for _, high in group], axis=0)
        radius_part = quantile * of_radius
        with np.errstate(divide="ignore", invalid="ignore"):
            limits = [values * np.exp(sign * np.hypot(np.log(end / values), radius_part))
                    for sign, end in ((-1, low), (1, high))]  # fmt: skip
        return np.where(radius_part > 0, limits[0], low), np.where(radius_part > 0, limits[1], high)

    losses = np.array([name in _LOSSES for name in derived_values])
    # a modulus is that of a stiffness over the root of the radius
    of_radius = np.array([
        0.5 * window.test.indenter.radius_error * (name in _OF_RADIUS) for name in derived_values
    ])  # fmt: skip
    values = np.array([value for value, _ in derived_values.values()])
    (low, high), (_, upper_at_90) = ends(_LEVEL), ends(0.90)
    is_bounded = losses & (low <= 0)
    rows = zip(
        derived_values.items(), np.where(is_bounded, 0.0, low).tolist(), np.where(is_bounded,
        upper_at_90, high).tolist(),
        strict=True,
    )  # fmt: skip
    return tuple(
        ReportedValue(
            name, value, low, high, unit, read=get_display_unit(unit, prefers_small=unit == "s")
        )
        for (name, (value, unit)), low, high in rows
    )


def _collect_slices(optimum: _LawOptimum) -> list[ProfileSlice]:
    """Return the limits over all minima that the record does not reject.

    Loss and time are correlated along a curved valley of the misfit, in which the normal
    approximation fails.
    """
    noise, best = optimum.estimate.noises[0], optimum.optimum
    slices = compute_profile(optimum.estimate, _TIME)
    for valley in optimum.local_optima:
        cost_increase = (valley.cost - best.cost) / noise.power
        if valley is best or cost_increase > optimum.estimate.quantile() ** 2:
            continue
        profile_slices = compute_profile(estimate(valley, noises=[noise]), _TIME)
        slices += [
            ProfileSlice(float(np.sqrt(root**2 + cost_increase)), uncertainty)
            for root, uncertainty in profile_slices
        ]
    return slices


def _compute_numbers(window: _NearHit, law: Law, theta: FloatArray) -> dict[str, tuple[float, str]]:
    """Return each number by the parameters of a law, by name, with its unit."""
    contact, hit = law.contact(theta, window.mass), window.simulate_collision(law, theta)
    radius = window.test.indenter.radius
    entries: dict[str, tuple[float, str]] = {"k": (contact.k, f"N/m^{contact.exponent:g}")}
    sphere = radius is not None and contact.exponent != 1
    if isinstance(contact, ViscousContact) and contact.viscous_time > 0:
        if contact.exponent == 1:
            entries = {"k": (contact.k, "N/m"), "c": (contact.c, "N s/m")}
        else:
            entries["viscous_time"] = (contact.viscous_time, "s")
    if isinstance(contact, RelaxingContact):
        entries |= {"g": (contact.g, ""), "tau": (contact.tau, "s")}
    if sphere and radius is not None:
        entries["modulus"] = (reduced_modulus(contact.k, radius), "Pa")
        if isinstance(contact, RelaxingContact):
            entries["glassy_modulus"] = (entries["modulus"][0] * (1 + contact.g), "Pa")
    elif radius is not None:
        # of the sphere that is as stiff at the largest indentation
        entries["modulus"] = (reduced_modulus(contact.k / np.sqrt(hit.depth), radius), "Pa")
    return entries | {
        "restitution": (hit.restitution, ""),
        "impact_velocity": (hit.approach, "m/s"),
        "duration": (hit.duration, "s"),
        "depth": (hit.depth, "m"),
        "largest_force": (hit.largest_force, "N"),
    }
