r"""Joint likelihood of relaxation tests, a hammer test and rig priors, and its optimum.

With r the weighted residuals of each test and a prior on each nuisance, the fit minimises

.. math::

    \chi^2 = \sum_\mathrm{tests} |W(F - F(\theta))|^2
           + \sum_\mathrm{lines} \frac{|A - A(\theta, m, g, d)|^2}{\sigma^2}
           + \frac{\ln^2(m/m_0)}{\sigma_m^2} + \frac{\ln^2 g}{\sigma_g^2} + \frac{d^2}{\sigma_d^2}
           + \dots

over :math:`\theta = (\ln k_\infty, \ln k_j, \ln\tau_j[, \ln b])`, or the numbers of a fractional
element (``identification/parametrisation``). Under the hammer a seal may be
:math:`\lambda` times as stiff, as at another compression, or rest on a :math:`k_\infty` of its own.
Equalities, such as a measured
static stiffness, enter as priors too narrow to bend. Source: J. Zhang and C. M. Richards, MSSP 21
(2007), for the constraints; the joint likelihood is standard.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, fields, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.datamodel.fit import Fit
from dashpot.fitting.identification.frf_data import FRFData
from dashpot.fitting.identification.parametrisation import (
    Arms,
    Parametrisation,
    RelaxationResiduals,
    differentiate_poles,
    on_another_spring,
)
from dashpot.fitting.marginal_relaxation import RelaxationData
from dashpot.fitting.nuisance_priors import Prior
from dashpot.numerics import least_squares
from dashpot.numerics.inference.covariance_estimate import Estimate, estimate, white_noise
from dashpot.numerics.inference.model_order import bic_of_deviance, deviance
from dashpot.numerics.least_squares import (
    Optimum,
    Parameter,
    Rows,
    require_optimum,
    stack_real_rows,
)
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import Solid
from dashpot.vibration.mass_on_seals import Response, TruncationLoss, residues, ringing_pole

# Units of the parameters that are no logarithms, s and Hz: typical differences between channels.
LINEAR_UNITS = {"delay": 1e-4, "high_pass": 1.0}
# arms are sought this far, as a factor in time, beyond what the lines and tests could show
TAU_MARGIN = 3.0
SMALLEST_SCATTER = 1e-9
# a step that ends a search
STEP_TOLERANCE = 1e-10
# what moves the rows by less, as a part of what anything does, has left the solid
MIN_COLUMN_SHARE = 1e-7
SPRING = Arms(0)


UNCHANGED = Prior(1.0)


@dataclass(frozen=True)
class NuisancePriors:
    """Priors of the rig: mass, gain of acceleration over force, delay, and seals.

    An infinite standard deviation leaves a quantity free.

    Attributes
    ----------
    mass : Prior or None
        kg; None if nothing is known.
    gain : Prior
        1 where acceleration over force reads what it is.
    delay : Prior
        s.
    factor : Prior
        Stiffness of a seal under the hammer over that of the solid, every arm alike.
    spring : Prior
        k_inf of a seal under the hammer over that of the solid.
    high_pass : Prior
        Corner of the high-pass of the accelerometer, Hz.
    """

    mass: Prior | None
    gain: Prior
    delay: Prior
    factor: Prior = UNCHANGED
    spring: Prior = UNCHANGED
    high_pass: Prior = Prior(0.0)

    @property
    def priors_by_name(self) -> dict[str, Prior | None]:
        """Priors by name, in the order of the vector."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True)
class Constraints:
    """Exact or approximate equalities that the solid must satisfy besides the tests.

    Attributes
    ----------
    static_stiffness : Prior or None
        k_inf of one seal, N/m.
    natural_frequency : Prior or None
        |p| / 2 pi of the mass on the seals, Hz.
    damping_ratio : Prior or None
        -Re p / |p|.
    before : Fit or None
        An earlier fit of one seal whose covariance is a prior on its parameters.
    """

    static_stiffness: Prior | None = None
    natural_frequency: Prior | None = None
    damping_ratio: Prior | None = None
    before: Fit | None = None


@dataclass(frozen=True)
class Parameters:
    """Point of the parameter space, in physical units."""

    model: Solid
    mass: float
    gain: float
    delay: float
    factor: float = 1.0
    spring: float = 1.0
    high_pass: float = 0.0

    @property
    def channel(self) -> tuple[float, float, float]:
        """Gain, delay and high-pass of the accelerometer."""
        return self.gain, self.delay, self.high_pass

    @property
    def seal_under_hammer(self) -> Solid:
        """The seal under the hammer."""
        solid = self.model if self.spring == 1 else on_another_spring(self.model, self.spring)
        return solid if self.factor == 1 else self.factor * solid


@dataclass(frozen=True, eq=False)
class IdentificationProblem:
    """Objective of one kind of solid as a function of a flat parameter vector.

    The vector holds the numbers of the solid, ln b if there is a dashpot, then those of ln m,
    ln g, d / 0.1 ms, of the logarithms of factor and spring, and of the high-pass, Hz, that are not
    known exactly.

    Attributes
    ----------
    relaxations : tuple of RelaxationData
    frf_data : FRFData
    priors : NuisancePriors
    constraints : Constraints
    parametrisation : Parametrisation
    dashpot : bool
    scale : float
        What the standard deviation of the lines is multiplied by.
    """

    relaxations: tuple[RelaxationData, ...]
    frf_data: FRFData
    priors: NuisancePriors
    constraints: Constraints
    parametrisation: Parametrisation = SPRING
    dashpot: bool = False
    scale: float = 1.0

    @cached_property
    def index(self) -> dict[str, int]:
        """Place of b, and of each nuisance, in the vector."""
        free_names = [
            name
            for name, prior in self.priors.priors_by_name.items()
            if prior is None or prior.sd > 0
        ]
        names = ["b"] * self.dashpot + free_names
        return {name: index for index, name in enumerate(names, start=self.parametrisation.size)}

    @property
    def is_hammer_alone(self) -> bool:
        """Whether nothing but the hammer test is known of the seal."""
        return not self.relaxations and self.constraints.before is None

    @property
    def log_tau_range(self) -> tuple[float, float]:
        """Shortest and longest relaxation time that is sought, ln s."""
        windows = [relaxation.window for relaxation in self.relaxations]
        windows.append(self.frf_data.stiffness_block(1.0, dashpot=False).window)
        prior = self.constraints.before
        if prior is not None and prior.model.arms:
            solid = prior.solid
            tau = (solid.tau,) if isinstance(solid, FractionalZener) else prior.model.tau
            windows.append((tau[0] / TAU_MARGIN, tau[-1] * TAU_MARGIN))
        low, high = min(w[0] for w in windows), max(w[1] for w in windows)
        return float(np.log(low / TAU_MARGIN)), float(np.log(high * TAU_MARGIN))

    # -- parameters ---------------------------------------------------------------------------

    def pack(self, point: Parameters) -> FloatArray:
        """Return the vector of a point."""
        values_by_name = {"b": max(point.model.maxwell.b, 1e-300), **vars(point)}
        nuisance_values = [
            values_by_name[name] / LINEAR_UNITS[name]
            if name in LINEAR_UNITS
            else np.log(values_by_name[name])
            for name in self.index
        ]
        return np.append(self.parametrisation.pack(point.model), nuisance_values)

    def unpack(self, theta: FloatArray) -> Parameters:
        """Return the point of a vector."""
        entries = {
            name: float(theta[i] * LINEAR_UNITS[name] if name in LINEAR_UNITS else np.exp(theta[i]))
            for name, i in self.index.items()
        }
        model = self.parametrisation.unpack(
            theta[: self.parametrisation.size], entries.pop("b", 0.0)
        )
        available = {
            name: prior.mean
            for name, prior in self.priors.priors_by_name.items()
            if prior is not None
        }
        return Parameters(model, **available | entries)

    # -- what is known beforehand ---------------------------------------------------------------

    @cached_property
    def rig(self) -> tuple[list[int], FloatArray, FloatArray]:
        """Return the indices of the rig's parameters, their means and standard deviations."""
        entries = {
            name: (prior.mean / LINEAR_UNITS[name], prior.sd / LINEAR_UNITS[name])
            if name in LINEAR_UNITS
            else (float(np.log(prior.mean)), prior.sd / prior.mean)
            for name, prior in self.priors.priors_by_name.items()
            if prior is not None and name in self.index
        }
        mean, sd = np.array([*entries.values()]).reshape(-1, 2).T
        return [self.index[name] for name in entries], mean, sd

    @cached_property
    def earlier(self) -> tuple[list[int], FloatArray, FloatArray] | None:
        """Return indices, values and covariance root of the parameters of an earlier fit."""
        prior = self.constraints.before
        if prior is None:
            return None
        earlier_values, indices = self.parametrisation.extract_earlier_values(prior)
        place_of = dict(zip(earlier_values, indices, strict=True))
        # with all that its rig may have done it could not show that the tests disagree
        covariance, rows = prior.estimate.noise_only.covariance, self.earlier_rows
        names = [prior.estimate.parameters[i] for i in rows]
        root = np.asarray(np.linalg.cholesky(covariance[np.ix_(rows, rows)]))
        return (
            [place_of[name] for name in names],
            np.array([earlier_values[name] for name in names]),
            root,
        )

    @cached_property
    def earlier_rows(self) -> list[int]:
        """Rows of the covariance of an earlier fit that are kept."""
        prior = self.constraints.before
        if prior is None:
            return []
        earlier_values = self.parametrisation.extract_earlier_values(prior)[0]
        variance = np.diag(prior.estimate.noise_only.covariance)
        return [
            i for i, name in enumerate(prior.estimate.parameters)
            if name in earlier_values and np.isfinite(variance[i]) and variance[i] > 0
        ]  # fmt: skip

    def build_problem(self, start: FloatArray) -> least_squares.Problem:
        """Return the least-squares problem about a start; logarithms stay within doubles."""
        low, high = start - 25.0, start + 12.0
        log_tau_limits = self.parametrisation.ends(self.log_tau_range)
        tau_slice = slice(
            self.parametrisation.size - len(log_tau_limits), self.parametrisation.size
        )
        low[tau_slice], high[tau_slice] = log_tau_limits.T
        for name in LINEAR_UNITS.keys() & self.index.keys():
            low[self.index[name]], high[self.index[name]] = -1e3, 1e3
        return least_squares.Problem(
            lambda theta: ModelPrediction(self, theta).rows,
            [Parameter(*limits) for limits in zip(low.tolist(), high.tolist(), strict=True)],
            priors=len(ModelPrediction(self, start).prior_residuals[0]),
        )


@dataclass(frozen=True, eq=False)
class ModelPrediction:
    """Model prediction of every test at one parameter vector, with its derivative."""

    problem: IdentificationProblem
    theta: FloatArray

    @cached_property
    def point(self) -> Parameters:
        """Return the parameters in physical terms."""
        return self.problem.unpack(self.theta)

    @property
    def rows(self) -> Rows:
        """All weighted residuals: tests first, priors last; none is linear."""
        y = -np.concatenate([*self.tests, self.lines, self.prior_residuals[0]])
        return Rows(y, np.empty((len(y), 0)), lambda _: self.slope)

    @cached_property
    def tests(self) -> list[FloatArray]:
        """Residuals of the relaxation tests."""
        return [
            relaxation.residual + self._get_dashpot * relaxation.dashpot
            for relaxation in self._relaxation_residuals
        ]

    @cached_property
    def lines(self) -> FloatArray:
        """Residuals of the lines, real then imaginary, shape (2n,)."""
        problem, p = self.problem, self.point
        fitted_lines = problem.frf_data.predict(self._response, *p.channel)
        return problem.frf_data.misfit(fitted_lines) / problem.scale

    @cached_property
    def prior_residuals(self) -> tuple[FloatArray, FloatArray]:
        """Residuals of the priors, shape (r,), and their slope (r, p)."""
        index, mean, sd = self.problem.rig
        rig = (self.theta[index] - mean) / sd, np.eye(len(self.theta))[index] / sd[:, None]
        residuals, slopes = zip(rig, *self._iterate_solid_constraints(), self.earlier, strict=True)
        return np.concatenate(list(map(np.atleast_1d, residuals))), np.vstack(slopes)

    @cached_property
    def earlier(self) -> tuple[FloatArray, FloatArray]:
        """Deviation of the solid from the earlier fit, in standard deviations; empty without."""
        slope = np.zeros((0, len(self.theta)))
        if self.problem.earlier is None:
            return np.empty(0), slope
        indices, prior_values, root = self.problem.earlier
        _, values, gradient = self.problem.parametrisation.physical(self._numbers)
        slope = np.zeros((len(indices), len(self.theta)))
        slope[:, : len(self._numbers)] = np.linalg.solve(root, gradient[indices])
        return np.asarray(np.linalg.solve(root, values[indices] - prior_values)), slope

    @property
    def slope(self) -> FloatArray:
        """Derivative of every row."""
        parameter_count = len(self._numbers)
        tests = [
            np.zeros((len(relaxation.residual), len(self.theta)))
            for relaxation in self._relaxation_residuals
        ]
        for columns, residuals in zip(tests, self._relaxation_residuals, strict=True):
            columns[:, :parameter_count] = residuals.jacobian
            if self.problem.dashpot:
                columns[:, self.problem.index["b"]] = self._get_dashpot * residuals.dashpot
        return np.concatenate([*tests, self._differentiate_lines(), self.prior_residuals[1]])

    # -- private ------------------------------------------------------------------------------

    @property
    def _numbers(self) -> FloatArray:
        return self.theta[: self.problem.parametrisation.size]

    @property
    def _get_dashpot(self) -> float:
        return float(np.exp(self.theta[self.problem.index["b"]])) if self.problem.dashpot else 0.0

    @cached_property
    def _relaxation_residuals(self) -> list[RelaxationResiduals]:
        problem = self.problem
        return [
            problem.parametrisation.residuals(relaxation, self._numbers)
            for relaxation in problem.relaxations
        ]

    @cached_property
    def _response(self) -> Response:
        return self.problem.frf_data.response(self.point.seal_under_hammer, self.point.mass)

    def _differentiate_lines(self) -> FloatArray:
        problem, response, p = self.problem, self._response, self.point
        s, data = response.s, problem.frf_data
        values = problem.parametrisation.differentiate_stiffness(self._numbers, s)
        stiffness = 1 / response.receptance - p.mass * s**2

        def differentiate_lost_poles(
            truncation: TruncationLoss,
        ) -> tuple[ComplexArray, ComplexArray]:
            mass, columns = (
                p.mass,
                differentiate_poles(problem.parametrisation, self._numbers, truncation.p),
            )
            return (
                self._differentiate_impedance(truncation.p, columns[0], -mass * truncation.p**2),
                self._differentiate_impedance(
                    truncation.p,
                    columns[1],
                    1 / truncation.residue - 2 * mass * truncation.p,
                    order=1,
                ),
            )

        by = response.slope(
            self._differentiate_impedance(s, values, stiffness), differentiate_lost_poles
        )
        by, *solid_slopes = data.slopes(response, *p.channel, by)
        units = {"mass": 1.0, "gain": 1.0, **LINEAR_UNITS}
        for (name, unit), column in zip(units.items(), solid_slopes, strict=True):
            if name in problem.index:
                by[:, problem.index[name]] += unit * column
        return stack_real_rows(by / data.sd[:, None]) / problem.scale

    def _differentiate_impedance(
        self,
        s: ComplexArray,
        derivatives: ComplexArray,
        seal_stiffness: npt.ArrayLike,
        *,
        order: int = 0,
    ) -> ComplexArray:
        """Derivative of m s^2 + n K(s) under the hammer by the vector, or that of its slope by s.

        `derivatives` are those of one seal's K or K' by its own numbers, `seal_stiffness` is n K or
        n K' under the hammer.
        """
        problem, p = self.problem, self.point
        count = problem.frf_data.seals * p.factor
        spring = count * p.model.k_inf * (1 - order)
        by = np.zeros((len(s), len(self.theta)), dtype=complex)
        by[:, : derivatives.shape[1]] = count * derivatives
        by[:, 0] += (p.spring - 1) * spring
        nuisance_slopes = {
            "b": count * self._get_dashpot * s ** (1 - order),
            "mass": p.mass * s ** (2 - order) * (1 + order),
            "factor": seal_stiffness,
            "spring": p.spring * spring,
        }
        for name in nuisance_slopes.keys() & problem.index.keys():
            by[:, problem.index[name]] = nuisance_slopes[name]
        return by

    def _iterate_solid_constraints(self) -> Iterator[tuple[float, FloatArray]]:
        constraints, p = self.problem.constraints, self.point
        if constraints.static_stiffness is not None:
            k_inf = p.model.k_inf
            yield constraints.static_stiffness.standardise(
                k_inf, k_inf * np.eye(1, len(self.theta))[0]
            )
        if constraints.natural_frequency is None and constraints.damping_ratio is None:
            return
        solid = self.problem.frf_data.seals * p.seal_under_hammer
        pole = ringing_pole(solid, p.mass)
        pole_array, pole_magnitude = np.array([pole]), abs(pole)
        values = differentiate_poles(self.problem.parametrisation, self._numbers, pole_array)[0]
        by = self._differentiate_impedance(pole_array, values, -p.mass * pole_array**2)[0]
        change = -by * complex(residues(solid.maxwell, p.mass, pole_array)[0])
        growth = (pole.conjugate() * change).real / pole_magnitude
        if constraints.natural_frequency is not None:
            yield constraints.natural_frequency.standardise(
                pole_magnitude / (2 * np.pi), growth / (2 * np.pi)
            )
        if constraints.damping_ratio is not None:
            slope = (pole.real * growth / pole_magnitude - change.real) / pole_magnitude
            yield constraints.damping_ratio.standardise(-pole.real / pole_magnitude, slope)


# -- Optimum ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Candidate:
    """Optimum for one number of arms, or an element, with or without a parallel dashpot."""

    problem: IdentificationProblem
    optimum: Optimum

    @property
    def theta(self) -> FloatArray:
        """The flat parameter vector."""
        return self.optimum.theta

    @property
    def arms(self) -> int:
        """Number of arms of the solid or of its approximation."""
        return self.point.model.maxwell.arms

    @property
    def cost(self) -> float:
        """Minimised cost."""
        return self.optimum.cost

    @cached_property
    def model_prediction(self) -> ModelPrediction:
        """Prediction of every test."""
        return ModelPrediction(self.problem, self.theta)

    @property
    def point(self) -> Parameters:
        """The optimum in physical terms."""
        return self.model_prediction.point

    @cached_property
    def estimate(self) -> Estimate:
        """Every row has unit variance; what has faded from the solid is held."""
        column_norms = np.linalg.norm(self.optimum.jacobian, axis=0)
        noise, faded = (
            white_noise(self.optimum, 1.0),
            column_norms <= MIN_COLUMN_SHARE * column_norms.max(),
        )
        # lines that nobody measured stand far above what is known of the mass
        return estimate(
            self.optimum, noises=[noise], is_fixed=faded, prior_variance=1.0, with_fine_scales=True
        )

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the flat parameter vector."""
        return self.estimate.covariance

    @property
    def significant(self) -> bool:
        """Every arm has k > 3 SE and SE(ln tau) < 0.5; the slope of an element is known."""
        return self.problem.parametrisation.is_identified(self._error)

    @property
    def unknown(self) -> tuple[float, ...]:
        """Relaxation times of the arms that are not known, s, ascending."""
        assert isinstance(self.problem.parametrisation, Arms)  # noqa: S101  # an element has none
        tau = np.exp(self.problem.parametrisation.log_tau(self.theta))
        return tuple(
            np.sort(tau[~self.problem.parametrisation.find_identified_arms(self._error)]).tolist()
        )

    @property
    def _error(self) -> FloatArray:
        """Standard errors of the solid's numbers."""
        return np.sqrt(np.diag(self.covariance))[: self.problem.parametrisation.size]

    @cached_property
    def bic(self) -> float:
        """Bayesian criterion with each test's own noise profiled."""
        lines = 2.0 * len(self.problem.frf_data.lines.s)
        # below a billionth of the value, or of the noise, one misfit is as good as another
        total = deviance(max(self.line_misfit / lines, SMALLEST_SCATTER**2), effective=lines)
        for relaxation, chi2 in zip(self.problem.relaxations, self.relaxation_chi2, strict=True):
            total += deviance(chi2 / relaxation.samples, effective=relaxation.samples)
        prior = self.model_prediction.prior_residuals[0]
        return self._compute_bic(total + float(prior @ prior))

    @property
    def exact(self) -> bool:
        """Whether it fits the lines exactly, and there is no other data."""
        lines = 2.0 * len(self.problem.frf_data.lines.s)
        is_negligible = self.line_misfit / lines <= SMALLEST_SCATTER**2
        return (
            is_negligible
            and not self.problem.relaxations
            and self.problem.constraints.before is None
        )

    @property
    def criterion(self) -> float:
        """Information criterion with the noise as it is weighted."""
        return self._compute_bic(self.cost)

    def _compute_bic(self, total: float) -> float:
        return bic_of_deviance(total, effective=self.samples, parameters=len(self.theta))

    @property
    def samples(self) -> float:
        """Numbers that the lines hold, and effective samples of the relaxation tests."""
        problem = self.problem
        lines = 2.0 * len(problem.frf_data.lines.s)
        return lines + sum(relaxation.samples for relaxation in problem.relaxations)

    @cached_property
    def relaxation_chi2(self) -> list[float]:
        """Chi-square of each relaxation test, its floor included."""
        pairs = zip(self.model_prediction.tests, self.problem.relaxations, strict=True)
        return [float(rows @ rows) + relaxation.floor for rows, relaxation in pairs]

    @cached_property
    def line_misfit(self) -> float:
        """Squared misfit of the lines in units of their own scatter, not scaled."""
        return float(np.sum((self.model_prediction.lines * self.problem.scale) ** 2))

    @property
    def chi2(self) -> float:
        """Chi-square of the lines and of the relaxation tests."""
        return self.line_misfit / self.problem.scale**2 + sum(self.relaxation_chi2)

    @property
    def line_scale(self) -> float:
        """Factor on the standard deviation of the lines that explains the misfit."""
        dof = max(2 * len(self.problem.frf_data.lines.s) - len(self.theta), 1)
        rms = float(np.sqrt(self.line_misfit / dof))
        return max(rms, 1.0 if self.problem.frf_data.has_absolute_sd else SMALLEST_SCATTER)

    def copy_with_scale(self, scale: float) -> Candidate:
        """Return the candidate with its covariance scaled by the scatter of the lines."""
        problem = replace(self.problem, scale=scale)
        return Candidate(problem, problem.build_problem(self.theta).solve_linear(self.theta))


def descend(
    problem: IdentificationProblem, start: FloatArray, *, tolerance: float, max_steps: int = 200
) -> Candidate:
    """Return the nearest optimum, in at most so many steps.

    Until a step promises to lower chi-square by less than that part of it.
    """
    whole_problem = problem.build_problem(start)
    return Candidate(
        problem,
        require_optimum(
            whole_problem,
            [start],
            max_steps=max_steps,
            step_tolerance=STEP_TOLERANCE,
            cost_tolerance=tolerance,
        ),
    )
