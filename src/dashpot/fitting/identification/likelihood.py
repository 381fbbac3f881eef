r"""One likelihood for relaxation tests, a hammer test, and what is known of the rig; its optimum.

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

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.fitting.identification.frf_data import FRFData
from dashpot.fitting.identification.parametrisation import (
    Arms,
    Parametrisation,
    on_another_spring,
)
from dashpot.fitting.relaxation_data import RelaxationData
from dashpot.records.fit import Fit
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import Solid
from dashpot.vibration.systems.prediction import ringing_pole

# one unit of the delay parameter, s: of the order of what channels differ by
DELAY_UNIT = 1e-4
# an equality is a prior of this relative width
EXACT = 1e-6
# arms are sought this far, as a factor in time, beyond what the lines and tests could tell
BEYOND = 3.0
SMALLEST_SCATTER = 1e-9
SPRING = Arms(0)


@dataclass(frozen=True)
class Prior:
    """A quantity known before the fit: its value and standard deviation, 0 for exactly."""

    value: float
    sd: float = 0.0

    def off(self, found: float) -> float:
        """How far `found` is from it, in standard deviations; an equality has a narrow one."""
        return (found - self.value) / max(self.sd, EXACT * abs(self.value))

    def log_off(self, found: float) -> float:
        """So too, on a logarithmic scale: 0 where nothing is known."""
        return float(np.log(found / self.value)) * self.value / self.sd


UNCHANGED = Prior(1.0)


@dataclass(frozen=True)
class NuisancePriors:
    """What is known of the rig: mass, gain of acceleration over force, its delay, and its seals.

    An infinite standard deviation leaves a quantity free.

    Attributes
    ----------
    mass : Prior or None
        kg; None if nothing is known.
    gain_sd : float
        Relative; 0 if the gain is exactly one.
    delay_sd : float
        s; 0 if there is no delay.
    factor : Prior
        Stiffness of a seal under the hammer over that of the solid, every arm alike.
    spring : Prior
        k_inf of a seal under the hammer over that of the solid.
    """

    mass: Prior | None
    gain_sd: float
    delay_sd: float
    factor: Prior = UNCHANGED
    spring: Prior = UNCHANGED


@dataclass(frozen=True)
class Constraints:
    """Equalities, or near equalities, that the solid must obey besides the tests.

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
    """A point of the parameter space, in physical terms."""

    model: Solid
    mass: float
    gain: float
    delay: float
    factor: float = 1.0
    spring: float = 1.0

    @property
    def felt(self) -> Solid:
        """The seal under the hammer."""
        solid = self.model if self.spring == 1 else on_another_spring(self.model, self.spring)
        return solid if self.factor == 1 else self.factor * solid


@dataclass(frozen=True, eq=False)
class Problem:
    """The residuals of one kind of solid, as a function of a flat parameter vector.

    The vector holds the numbers of the solid, ln b if there is a dashpot, then those of ln m,
    ln g, d / 0.1 ms, and of the logarithms of factor and spring, that are not known exactly.

    Attributes
    ----------
    relaxations : tuple of RelaxationData
    frf_data : FRFData
    priors : NuisancePriors
    constraints : Constraints
    sought : Parametrisation
    dashpot : bool
    scale : float
        What the standard deviation of the lines is multiplied by.
    """

    relaxations: tuple[RelaxationData, ...]
    frf_data: FRFData
    priors: NuisancePriors
    constraints: Constraints
    sought: Parametrisation = SPRING
    dashpot: bool = False
    scale: float = 1.0

    @cached_property
    def at(self) -> dict[str, int]:
        """Place of each nuisance, and of ln b, in the vector."""
        mass = self.priors.mass
        there = {
            "ln_b": self.dashpot,
            "ln_mass": mass is None or mass.sd > 0,
            "ln_gain": self.priors.gain_sd > 0,
            "delay": self.priors.delay_sd > 0,
            "ln_factor": self.priors.factor.sd > 0,
            "ln_spring": self.priors.spring.sd > 0,
        }
        names = [name for name, present in there.items() if present]
        return {name: place for place, name in enumerate(names, start=self.sought.size)}

    @property
    def log_tau_range(self) -> tuple[float, float]:
        """Shortest and longest relaxation time that is sought, ln s."""
        windows = [relaxation.window for relaxation in self.relaxations]
        windows.append(self.frf_data.stiffness_block(1.0, dashpot=False).window)
        before = self.constraints.before
        if before is not None and before.model.arms:
            solid = before.solid
            known = (solid.tau,) if isinstance(solid, FractionalZener) else before.model.tau
            windows.append((known[0] / BEYOND, known[-1] * BEYOND))
        low, high = min(w[0] for w in windows), max(w[1] for w in windows)
        return float(np.log(low / BEYOND)), float(np.log(high * BEYOND))

    # -- parameters ---------------------------------------------------------------------------

    def pack(self, point: Parameters) -> FloatArray:
        """The vector of a point."""
        model = point.model
        nuisances = {
            "ln_b": np.log(max(model.maxwell.b, 1e-300)),
            "ln_mass": np.log(point.mass),
            "ln_gain": np.log(point.gain),
            "delay": point.delay / DELAY_UNIT,
            "ln_factor": np.log(point.factor),
            "ln_spring": np.log(point.spring),
        }
        return np.append(self.sought.pack(model), [nuisances[name] for name in self.at])

    def unpack(self, theta: FloatArray) -> Parameters:
        """The point of a vector."""
        rest = {name: float(theta[place]) for name, place in self.at.items()}
        priors = self.priors
        known = 1.0 if priors.mass is None else priors.mass.value

        def exp(name: str, otherwise: float) -> float:
            return float(np.exp(rest[name])) if name in rest else otherwise

        return Parameters(
            model=self.sought.unpack(theta[: self.sought.size], exp("ln_b", 0.0)),
            mass=exp("ln_mass", known),
            gain=exp("ln_gain", 1.0),
            delay=rest.get("delay", 0.0) * DELAY_UNIT,
            factor=exp("ln_factor", priors.factor.value),
            spring=exp("ln_spring", priors.spring.value),
        )

    # -- residuals ----------------------------------------------------------------------------

    def residual(self, theta: FloatArray) -> FloatArray:
        """All weighted residuals, tests first, shape (n,)."""
        parts = [self._relaxation_rows(relaxation, theta)[0] for relaxation in self.relaxations]
        return np.concatenate([*parts, self.frf_residual(theta), self.prior_residual(theta)])

    def jacobian(self, theta: FloatArray, *, central: bool = True) -> FloatArray:
        """Derivative of `residual` by the vector, shape (n, p); one-sided at half the price."""
        parts = [self._relaxation_rows(relaxation, theta)[1] for relaxation in self.relaxations]

        def rest(at: FloatArray) -> FloatArray:
            return np.concatenate((self.frf_residual(at), self.prior_residual(at)))

        return np.concatenate([*parts, _differences(rest, theta, central=central)])

    def relaxation_chi2(self, theta: FloatArray) -> list[float]:
        """Chi-square of each relaxation test, its floor included."""
        return [
            float(np.sum(self._relaxation_rows(relaxation, theta)[0] ** 2)) + relaxation.floor
            for relaxation in self.relaxations
        ]

    def _relaxation_rows(
        self, relaxation: RelaxationData, theta: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        size = self.sought.size
        found = self.sought.answer(relaxation, theta[:size])
        residual, jacobian = found.residual, np.zeros((len(found.residual), len(theta)))
        jacobian[:, :size] = found.jacobian
        if self.dashpot:
            part = np.exp(theta[self.at["ln_b"]]) * found.dashpot
            residual = residual + part
            jacobian[:, self.at["ln_b"]] = part
        return residual, jacobian

    def frf_residual(self, theta: FloatArray) -> FloatArray:
        """Those of the lines, real then imaginary."""
        p = self.unpack(theta)
        return (
            self.frf_data.misfit(self.frf_data.predict(p.felt, p.mass, p.gain, p.delay))
            / self.scale
        )

    def prior_residual(self, theta: FloatArray) -> FloatArray:
        """Those of everything known beforehand."""
        point = self.unpack(theta)
        rows = np.array([*self._of_rig(point), *self._of_solid(point)], dtype=float)
        return np.append(rows, self.earlier_residual(point.model))

    def earlier_residual(self, model: Solid) -> FloatArray:
        """How far a solid is from the earlier fit, in its standard deviations; empty without."""
        before = self.constraints.before
        return np.empty(0) if before is None else _off(before, self.sought.kept(before, model))

    def _of_rig(self, point: Parameters) -> Iterator[float]:
        priors = self.priors
        for prior, found in (
            (priors.mass, point.mass),
            (priors.factor, point.factor),
            (priors.spring, point.spring),
        ):
            if prior is not None and prior.sd > 0:
                yield prior.log_off(found)
        if priors.gain_sd > 0:
            yield np.log(point.gain) / priors.gain_sd
        if priors.delay_sd > 0:
            yield point.delay / priors.delay_sd

    def _of_solid(self, point: Parameters) -> Iterator[float]:
        known = self.constraints
        if known.static_stiffness is not None:
            yield known.static_stiffness.off(point.model.k_inf)
        if known.natural_frequency is not None or known.damping_ratio is not None:
            pole = ringing_pole(self.frf_data.seals * point.felt, point.mass)
            if known.natural_frequency is not None:
                yield known.natural_frequency.off(abs(pole) / (2 * np.pi))
            if known.damping_ratio is not None:
                yield known.damping_ratio.off(-pole.real / abs(pole))


def _off(fit: Fit, off: dict[str, float]) -> FloatArray:
    """How far parameters are off an earlier fit, in its standard deviations."""
    rows = [i for i, name in enumerate(fit.parameters) if name in off]
    covariance = fit.covariance[np.ix_(rows, rows)]
    known = np.isfinite(np.diag(covariance)) & (np.diag(covariance) > 0)
    pick = [rows[i] for i in np.flatnonzero(known)]
    difference = np.array([off[fit.parameters[i]] for i in pick])
    root = np.linalg.cholesky(covariance[np.ix_(known, known)])
    return np.asarray(np.linalg.solve(root, difference))


def _differences(
    function: Callable[[FloatArray], FloatArray], theta: FloatArray, *, central: bool
) -> FloatArray:
    """Differences to one side or to both; every parameter is a logarithm or of order one.

    A peak curves so much that a one-sided difference of 1e-6 is off by 1e-6 Q of itself.
    """
    step = 1e-5 if central else 1e-6
    start = np.empty(0) if central else function(theta)
    columns = []
    for i in range(len(theta)):
        move = np.zeros(len(theta))
        move[i] = step
        if central:
            columns.append((function(theta + move) - function(theta - move)) / (2 * step))
        else:
            columns.append((function(theta + move) - start) / step)
    return np.array(columns).T


# -- the optimum ------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Candidate:
    """The optimum for one number of arms, or an element, with or without a parallel dashpot."""

    problem: Problem
    theta: FloatArray
    cost: float
    converged: bool

    @cached_property
    def point(self) -> Parameters:
        """The optimum in physical terms."""
        return self.problem.unpack(self.theta)

    @cached_property
    def covariance(self) -> FloatArray:
        """Of the flat parameter vector."""
        jacobian = self.problem.jacobian(self.theta)
        return np.asarray(np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-14, hermitian=True))

    @property
    def significant(self) -> bool:
        """Every arm has k > 3 SE and SE(ln tau) < 0.5; the slope of an element is known."""
        sought = self.problem.sought
        return sought.identified(np.sqrt(np.diag(self.covariance))[: sought.size])

    @cached_property
    def bic(self) -> float:
        r"""Bayesian criterion with each test's own noise profiled: sum n ln(chi2/n) + p ln n."""
        problem, theta = self.problem, self.theta
        lines = 2.0 * len(problem.frf_data.lines.s)
        # below a millionth of the value, or of the noise, one misfit is as good as another
        total = lines * np.log(max(self.line_misfit / lines, SMALLEST_SCATTER**2))
        chi2s = problem.relaxation_chi2(theta)
        for relaxation, chi2 in zip(problem.relaxations, chi2s, strict=True):
            total += relaxation.samples * np.log(chi2 / relaxation.samples)
        prior = float(np.sum(problem.prior_residual(theta) ** 2))
        return float(total + prior + len(theta) * np.log(self.samples))

    @property
    def samples(self) -> float:
        """Numbers that the lines hold, and effective samples of the relaxation tests."""
        problem = self.problem
        lines = 2.0 * len(problem.frf_data.lines.s)
        return lines + sum(relaxation.samples for relaxation in problem.relaxations)

    @cached_property
    def line_misfit(self) -> float:
        """Squared misfit of the lines in units of their own scatter, not scaled."""
        return float(np.sum((self.problem.frf_residual(self.theta) * self.problem.scale) ** 2))

    @cached_property
    def chi2(self) -> float:
        """Of the lines and of the relaxation tests."""
        lines = self.problem.frf_residual(self.theta)
        return float(lines @ lines) + sum(self.problem.relaxation_chi2(self.theta))

    @property
    def line_scale(self) -> float:
        """What the standard deviation of the lines must be multiplied by to explain the misfit."""
        spare = max(2 * len(self.problem.frf_data.lines.s) - len(self.theta), 1)
        rms = float(np.sqrt(self.line_misfit / spare))
        return max(rms, 1.0 if self.problem.frf_data.known_sd else SMALLEST_SCATTER)

    def scaled(self, scale: float) -> Candidate:
        """As it was found, its covariance with the scatter of the lines scaled."""
        return replace(self, problem=replace(self.problem, scale=scale))


def descend(
    problem: Problem,
    start: FloatArray,
    *,
    tolerance: float,
    central: bool = False,
    most: int = 200,
) -> Candidate:
    """To the nearest optimum, every logarithm kept where doubles can follow.

    In at most so many steps; by one-sided differences unless `central`, as a narrow valley asks.
    """
    from scipy.optimize import least_squares

    low, high = start - 25.0, start + 12.0
    size = problem.sought.size
    low[:size], high[:size] = problem.sought.bounded(low[:size], high[:size], problem.log_tau_range)
    if "delay" in problem.at:
        low[problem.at["delay"]], high[problem.at["delay"]] = -1e3, 1e3
    result = least_squares(
        problem.residual,
        np.clip(start, low + 1e-9, high - 1e-9),
        jac=partial(problem.jacobian, central=central),
        bounds=(low, high),
        x_scale="jac",
        xtol=1e-10,
        ftol=tolerance,
        gtol=1e-12,
        max_nfev=most,
    )
    return Candidate(problem, result.x, 2 * float(result.cost), result.status > 0)
