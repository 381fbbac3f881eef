r"""Fit of a specimen's loss factor, and of an arm too fast for a ramp, to drop tests.

The motion of each impact (``dashpot.extensions.materials.drop.motion``) follows from one elastic
law and one relaxation function of the specimen; its speed, its time of first contact and the zero
of the force are nuisance parameters:

.. math:: F_i(t) = F(t - t_i;\, c, g, \tau, v_i) + b_i + \text{noise}

Prior rows hold the law of a load deflection test, the arms of a relaxation test with their
covariance, and the stated speeds, so that all tests have one likelihood.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import DataError, FitError
from dashpot.base.number_format import format_count
from dashpot.base.provenance import Step, list_sources
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence, Provenance
from dashpot.datamodel.parameter_estimate import ParameterEstimate, Residual, parameter_names
from dashpot.extensions.materials.drop import checks
from dashpot.extensions.materials.drop.approach import Approach
from dashpot.extensions.materials.drop.datamodel import DropFit, DropImpact, DropTest
from dashpot.extensions.materials.drop.elastic_law import POWERS, ElasticLawPrior
from dashpot.extensions.materials.drop.least_squares_problem import DropProblem, RelaxationPrior
from dashpot.extensions.materials.drop.motion import ImpactMotion
from dashpot.extensions.materials.drop.preprocess import find_impacts
from dashpot.extensions.materials.drop.residual_shapes import compute_residual_shapes
from dashpot.fitting.fit_construction import SolidEstimate, build_fit
from dashpot.numerics.inference.covariance_estimate import DerivedQuantity, Estimate, estimate
from dashpot.solids.maxwell import GeneralizedMaxwell

SPEED_SD = 0.05
"""Relative standard deviation of a stated speed, by a light barrier or a ruler."""


def fit_drop_tests(
    records: Sequence[DropTest],
    *,
    mass: Quantity | None = None,
    drop: Quantity | Sequence[Quantity] = (),
    relaxation: Fit | Sequence[Fit] = (),
    law: ElasticLawPrior | None = None,
    speed_sd: float = SPEED_SD,
) -> DropFit:
    """Fit the loss factor of a specimen, and an arm too fast for a ramp, to drop tests.

    Parameters
    ----------
    records : sequence of DropTest
        All of one specimen.
    mass : float or str
        kg, or ``"200g"``.
    drop : sequence of float or str
        Impact speed, ``"0.6m/s"``, or drop height, ``"18mm"``, of each impact in its order. Speeds
        that are not stated are fitted.
    relaxation : Fit, optional
        Fit of a relaxation test, or of a load deflection test fitted with one: prior of the arms,
        with their covariance, and of the elastic law where it is nonlinear, with its errors.
    law : ElasticLawPrior, optional
        Prior of the elastic law, by default that of `relaxation`.
    speed_sd : float
        Relative standard deviation of a stated speed.

    Raises
    ------
    DataError, FitError
        If the mass is missing, no impact exceeds the noise, or no motion fits.
    """
    if mass is None:
        raise DataError("impacts need the mass of what moves. Add it: --mass 200g")
    fits = (relaxation,) if isinstance(relaxation, Fit) else tuple(relaxation)
    if len(fits) > 1:
        raise DataError(
            f"--relaxation was given {len(fits)} times, and impacts take one. Give it once"
        )
    mass_kg, fit = convert_to_si(mass, "mass"), fits[0] if fits else None
    impacts = tuple(
        impact
        for number, test in enumerate(records, 1)
        for impact in find_impacts(
            test, mass_kg, test.source.file if test.source else f"record {number}"
        )
    )
    speeds, accelerations = _parse_approaches(drop, len(impacts))
    length_ratio = _compute_length_ratio(records, fit)
    if law is None:
        law = (
            ElasticLawPrior.without_law()
            if fit is None
            else ElasticLawPrior.from_fit(fit, length_ratio)
        )
    problem = DropProblem(
        impacts, mass_kg, accelerations, speeds, speed_sd, law, RelaxationPrior.from_fit(fit)
    )
    optimum = problem.find_optimum()
    if optimum is None:
        raise FitError(
            "no motion of the mass fits the impacts. Check the mass and the speeds, or look at "
            "the record with dashpot inspect"
        )
    uncertainty = estimate(optimum, parts=[len(hit.time) for hit in impacts], prior_variance=1.0)
    return _FittedImpacts(tuple(records), problem, uncertainty, fit).drop_fit


def _parse_approaches(
    drop: Quantity | Sequence[Quantity], count: int
) -> tuple[FloatArray, FloatArray]:
    """Return stated speeds, NaN if missing, and gravity accelerations, the last one repeated."""
    quantities = [drop] if isinstance(drop, str | float | int) else list(drop)
    if len(quantities) > count:
        raise DataError(
            f"--drop was given {len(quantities)} times, and the record has "
            f"{format_count(count, 'impact')}. Give the speed of each impact, in their order"
        )
    approaches = [Approach.from_quantity(item) for item in quantities]
    accelerations, unstated_count = (
        [approach.gravity for approach in approaches],
        count - len(approaches),
    )
    accelerations += [accelerations[-1] if accelerations else 0.0] * unstated_count
    return np.array(
        [*(approach.speed for approach in approaches), *[np.nan] * unstated_count]
    ), np.array(accelerations)


def _compute_length_ratio(records: Sequence[DropTest], fit: Fit | None) -> float:
    """Return the length of the specimen over that of the specimen with the known law."""
    length = next((record.specimen.length for record in records if record.specimen.length), None)
    reference_length = None if fit is None else fit.specimen.length
    return length / reference_length if length and reference_length else 1.0


@dataclass(frozen=True, eq=False)
class _FittedImpacts:
    """Result of a drop test at the optimum, from which values and checks follow."""

    records: tuple[DropTest, ...]
    problem: DropProblem
    estimate: Estimate
    fit: Fit | None

    @property
    def drop_fit(self) -> DropFit:
        """The fit with its values and checks."""
        uncertainty, problem, frequency = self.estimate, self.problem, self.frequency
        arm = uncertainty.derive_quantity(
            lambda values: values[
                problem.shared_parameter_count - 2 : problem.shared_parameter_count
            ]
        )
        reported_values = [
            self._make_reported_value(
                "loss_factor", self.loss_factor, 0, f"loss factor at {frequency:.3g} Hz"
            ),
            self._make_reported_value("arm", arm, 0, "fast arm, g over the relaxed force"),
            self._make_reported_value("arm_time", arm, 1, "fast arm, relaxation time"),
        ]
        if len(problem.relaxation.g):
            loss_without_arm = uncertainty.derive_quantity(
                lambda values: self._compute_loss_factor(values, with_arm=False)
            )
            reported_values.insert(
                1,
                self._make_reported_value(
                    "loss_before", loss_without_arm, 0, "loss factor without the fast arm"
                ),
            )
        checks = self._run_checks()
        return DropFit(
            frequency, tuple(reported_values), self.impacts, problem.mass,
            self._build_specimen_fit(checks),
            checks, list_sources(self.records),
        )  # fmt: skip

    @property
    def theta(self) -> FloatArray:
        return self.estimate.optimum.theta

    def _make_reported_value(
        self, name: str, quantity: DerivedQuantity, index: int, text: str
    ) -> ReportedValue:
        """Return one number with its interval; of a time, by its logarithm."""
        value, error = float(quantity.values[index]), float(quantity.standard_error[index])
        quantile = self.estimate.quantile()
        if name != "arm_time":
            return ReportedValue.from_error(name, value, error, quantile, words=text)
        time = float(np.exp(value))
        return ReportedValue.from_error(
            name, time, error, quantile, of_log=True, unit="s", read="ms", words=text
        )

    @cached_property
    def motions(self) -> tuple[ImpactMotion, ...]:
        """Motion of every impact, to its release."""
        problem = self.problem
        rows = np.repeat(self.theta[None, :], len(problem.impacts), axis=0)
        x, v, force, relaxed_force = problem.integrate_motion(
            rows, problem.select_speeds(self.theta), problem.gravity_accelerations
        )
        end_indices = np.minimum((force > 0).cumsum(axis=0).argmax(axis=0) + 2, len(force))
        time = problem.step * np.arange(float(len(force)))
        return tuple(
            ImpactMotion(
                time[:end], x[:end, i], v[:end, i], force[:end, i], relaxed_force[:end, i],
                problem.mass,
                float(problem.gravity_accelerations[i]),
            )
            for i, end in enumerate(end_indices.tolist())
        )  # fmt: skip

    @cached_property
    def frequency(self) -> float:
        """Frequency of the loss factor, Hz: a contact is half a cycle."""
        return float(np.median([motion.frequency for motion in self.motions]))

    @property
    def depth(self) -> float:
        """Largest compression of the specimen, m."""
        return max(motion.max_compression.compression for motion in self.motions)

    def _compute_loss_factor(self, values: FloatArray, *, with_arm: bool = True) -> FloatArray:
        """Return the loss factor of the relaxation function, which holds at any compression."""
        g, tau = self.problem.compute_arms(values[: self.problem.shared_parameter_count])
        g, tau = (g, tau) if with_arm else (g[:-1], tau[:-1])
        s_tau = 2j * np.pi * self.frequency * tau
        K = 1 + (g * s_tau / (1 + s_tau)).sum()
        return np.array([K.imag / K.real])

    @cached_property
    def loss_factor(self) -> DerivedQuantity:
        """The loss factor, with its error."""
        return self.estimate.derive_quantity(self._compute_loss_factor)

    @cached_property
    def impacts(self) -> tuple[DropImpact, ...]:
        """Fitted values and curves of every impact."""
        errors, zeros = self.estimate.standard_error, self.estimate.optimum.beta
        quantile, fitted_impacts = self.estimate.quantile(), []
        modelled = self.problem.compute_forces(self.theta)
        for i, (impact, motion) in enumerate(zip(self.problem.impacts, self.motions, strict=True)):
            index = self.problem.shared_parameter_count + 2 * i
            speed, error = float(self.theta[index]), float(errors[index])
            reported_speed = ReportedValue.from_error(
                "speed", speed, error, quantile, unit="m/s", read="m/s"
            )
            time = impact.time - self.theta[index + 1]
            fitted_impact = DropImpact(
                impact.name, reported_speed, motion.peak.force, motion.max_compression.compression,
                motion.release.time, motion.rebound, motion.absorbed_energy / motion.energy, time,
                impact.force - zeros[i], modelled[i],
            )  # fmt: skip
            fitted_impacts.append(fitted_impact)
        return tuple(fitted_impacts)

    def _run_checks(self) -> tuple[Check, ...]:
        """Return every check."""
        problem, impacts, elastic_law = self.problem, self.impacts, self.problem.law.law
        value, sd = float(self.loss_factor.values[0]), float(self.loss_factor.standard_error[0])
        sizes = np.cumsum([len(impact.time) for impact in problem.impacts])[:-1]
        residuals = np.split(self.estimate.optimum.residual, sizes)
        misfit = max(
            float(np.sqrt(np.mean(residual[impact.modelled > 0] ** 2)))
            for residual, impact in zip(residuals, impacts, strict=True)
        )
        speeds = np.array([impact.speed.value for impact in impacts])
        is_stated = np.isfinite(problem.stated_speeds)
        speed_deviations = np.abs(speeds / problem.stated_speeds - 1)[is_stated] / problem.speed_sd
        rest_over_contact = [
            impact.time_since_impact / impact.contact_duration
            for impact in problem.impacts
            if impact.time_since_impact is not None
        ]
        ratios = [
            impact.impulse_ratio for impact in problem.impacts if impact.impulse_ratio is not None
        ]
        samples = min(impact.contact / float(impact.time[1] - impact.time[0]) for impact in impacts)
        return (
            checks.loss_determined(sd / max(value, 1e-300), self.frequency),
            checks.impacts_residual_small(misfit),
            checks.impact_residual_structureless(
                compute_residual_shapes(problem, self.estimate.optimum)
            ),
            checks.impacts_sampled(samples),
            checks.slow_arms_determined(is_given=self.fit is not None),
            checks.impact_speeds_spread(
                None if elastic_law else float(speeds.max() / speeds.min())
            ),
            checks.impact_speeds_agree(
                float(speed_deviations.max()) if len(speed_deviations) else None
            ),
            checks.impacts_separated(min(rest_over_contact, default=None)),
            checks.impact_mass_agrees(
                max(ratios, key=lambda number: abs(number - 1), default=None)
            ),
            *self._check_relaxation_agreement(value, sd),
            *(
                []
                if elastic_law is None
                else [checks.impact_within_measured_depth(self.depth, elastic_law.depth)]
            ),
            checks.air_escapes(float(speeds.max())),
            checks.specimen_length_stated(is_given=self.records[0].specimen.length is not None),
            *caution_checks(list_sources(self.records)),
        )

    def _check_relaxation_agreement(self, value: float, sd: float) -> list[Check]:
        """Return checks of the arms and the loss factor against those of the relaxation test."""
        relaxation, fit = self.problem.relaxation, self.fit
        if fit is None or not len(relaxation.g):
            return []
        largest_change, prior = None, np.concatenate((relaxation.g, np.log(relaxation.tau)))
        if relaxation.free:
            fitted_arms = self.theta[
                len(POWERS) : len(POWERS) + self.problem.relaxation_parameter_count
            ]
            largest_change = float(np.abs(relaxation.precision @ (fitted_arms - prior)).max())
        s_tau = 2j * np.pi * self.frequency * relaxation.tau
        K = 1 + (relaxation.g * s_tau / (1 + s_tau)).sum()
        relaxation_loss = float(K.imag / K.real)
        distance = (value - relaxation_loss) / sd if np.isfinite(sd) and sd > 0 else None
        # beyond its band a relaxation test gives a lower bound
        in_band = self.frequency <= fit.band[1]
        if distance is not None and not in_band:
            distance = min(distance, 0.0)
        return [
            checks.arms_agree_with_relaxation_test(largest_change),
            checks.spectrum_has_gaps(len(relaxation.g)),
            checks.loss_factors_agree(distance, value, relaxation_loss, is_in_interval=in_band),
        ]

    def _build_specimen_fit(self, checks: tuple[Check, ...]) -> Fit:
        """Return the model of the specimen: elastic law, arms of the relaxation test, fast arm."""
        problem, depth, law_parameters = self.problem, self.depth, slice(0, len(POWERS))
        g, tau = problem.compute_arms(self.theta[: problem.shared_parameter_count])
        order = [i for i in np.argsort(tau).tolist() if g[i] > 0]
        arms = len(order)

        def compute_parameters(values: FloatArray) -> FloatArray:
            g_drawn, tau_drawn = problem.compute_arms(values[: problem.shared_parameter_count])
            k_inf = problem.law.compute_knot_tangents(values[law_parameters], depth)[2]
            return np.concatenate(([k_inf], k_inf * g_drawn[order], np.log(tau_drawn[order])))

        quantity = self.estimate.derive_quantity(compute_parameters)
        ratio = self.estimate.derive_quantity(
            lambda values: problem.law.compute_knot_tangents(values[law_parameters], depth)[1]
        )
        ratio_se = np.nan_to_num(ratio.standard_error, posinf=0.0)
        k_inf, *relaxation_values = quantity.values.tolist()
        taus = np.exp(relaxation_values[arms:]).tolist()
        law = problem.law.piecewise(self.theta[law_parameters], depth)
        n, sse = len(self.estimate.optimum.residual), self.estimate.optimum.sse
        residual = Residual(n, sse, float(np.sqrt(sse / n)), self.estimate.kappa, unit="sd")
        estimate = ParameterEstimate(
            parameter_names(arms), quantity.covariance, self.estimate.dof, residual
        )
        contact_times = [impact.contact for impact in self.impacts]
        band_start = 1 / (np.pi * max(contact_times)) if self.fit is None else self.fit.band[0]
        step = Step(
            "fit",
            (("slams", str(len(contact_times))), ("mass_kg", repr(problem.mass))),
            f"fitted {format_count(len(contact_times), 'impact')} of {problem.mass:.4g} kg",
        )
        model = GeneralizedMaxwell(k_inf, tuple(relaxation_values[:arms]), tuple(taus))
        return build_fit(
            SolidEstimate(model, estimate),
            Evidence((band_start, 2 / (np.pi * min(contact_times))), checks=checks),
            Provenance("slam", list_sources(self.records), (step,), self.records[0].specimen),
            elastic_law=replace(law, ratio_se=tuple(ratio_se.tolist())),
        )
