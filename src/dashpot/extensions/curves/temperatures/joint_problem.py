r"""Least-squares problem of one solid and its shifts over tests at several temperatures.

Everything that is shared is unknown together: k_inf and every k, which are linear, and every
ln tau, ln a_T and ln b_T of every further temperature, and how much further slow arms shift than
fast ones,

.. math:: \ln a_T(\tau) = \ln a_T \bigl[1 + g\,(\log_{10} \tau - \log_{10} 0.5\,\mathrm{s})\bigr]

With :math:`q'_j = \partial q / \partial \ln \tau` of the column of an arm, the derivative by
:math:`\ln a_T` is :math:`b_T \sum_j k_j q'_j`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import NamedTuple, TypeAlias

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.option_fields import Vertical
from dashpot.datamodel.shift_factors import decades, shifted_log_tau
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.inference.correlated_noise import white
from dashpot.numerics.inference.model_order import significant
from dashpot.numerics.least_squares import Parameter, Problem, Rows, require_optimum
from dashpot.solids.maxwell import GeneralizedMaxwell

# target, columns of k_inf and k, and the derivative by theta
_Rows: TypeAlias = tuple[FloatArray, FloatArray, Callable[[FloatArray], FloatArray]]

# Scales of ln tau, ln a, ln b and g: a step is at most 1.5 times as long.
_STEP_SIZES = {"ln_tau": 0.7, "ln_a": 0.35, "ln_b": 0.2, "slope": 0.07}
# an arm smaller than this part of the stiffness is none
_MIN_ARM_SHARE = 1e-8
# steps of a descent, and the relative fall of chi-square that is none
_MAX_STEPS, _STATIONARY_FALL = 80, 1e-10


@dataclass(frozen=True, eq=False)
class ShiftedSolid:
    """Solid at the reference temperature, with the shifts of all temperatures.

    Attributes
    ----------
    k_inf : float
        N/m.
    k, log_tau : array, shape (N,)
    log_a, log_b : array, shape (T,)
        Logarithms of the shift factors of every temperature; 0 at the reference.
    slope : float
        g, per decade.
    chi_square : float
    """

    k_inf: float
    k: FloatArray
    log_tau: FloatArray
    log_a: FloatArray
    log_b: FloatArray
    slope: float = 0.0
    chi_square: float = np.inf

    @property
    def order(self) -> int:
        """Number of arms."""
        return len(self.log_tau)

    @property
    def stiffnesses(self) -> FloatArray:
        """K_inf, then k."""
        return np.append(self.k_inf, self.k)

    @property
    def alive(self) -> BoolArray:
        """Mask of the arms that are not zero."""
        return np.asarray(self.k > _MIN_ARM_SHARE * self.stiffnesses.sum())

    @property
    def solid(self) -> GeneralizedMaxwell:
        """Solid at the reference temperature."""
        order = np.argsort(self.log_tau)
        return GeneralizedMaxwell(
            self.k_inf, tuple(self.k[order]), tuple(np.exp(self.log_tau[order]))
        )

    def compute_log_tau(self, i: int) -> FloatArray:
        """Ln of the relaxation times at temperature i."""
        return shifted_log_tau(self.log_tau, float(self.log_a[i]), self.slope)

    def solid_at(self, i: int) -> GeneralizedMaxwell:
        """Return the solid at temperature i."""
        order, b = np.argsort(self.log_tau), float(np.exp(self.log_b[i]))
        return GeneralizedMaxwell(
            b * self.k_inf,
            tuple(b * self.k[order]),
            tuple(np.exp(self.compute_log_tau(i)[order])),
        )


class TestContribution(NamedTuple):
    """Residual of one test at a point, and derivatives by the shared parameters."""

    residual: FloatArray
    by: FloatArray


@dataclass(frozen=True, eq=False)
class JointTests:
    """Tests at several temperatures.

    Attributes
    ----------
    blocks : sequence of DataBlock
        Rows of unit noise, one fixed column, k_inf.
    at : array, shape (n,)
        Which temperature each is of.
    temperatures : array, shape (T,)
        K, rising.
    reference : int
        Which of them has no shift.
    vertical : str
        ``"free"``, or what ln b_T is held to.
    slope_sd : float
        What is known of g.
    """

    blocks: Sequence[DataBlock]
    at: IndexArray
    temperatures: FloatArray
    reference: int
    vertical: Vertical
    slope_sd: float

    @cached_property
    def free_temperatures(self) -> IndexArray:
        """The temperatures whose shifts are sought."""
        indices = np.arange(len(self.temperatures))
        return np.asarray(indices[indices != self.reference])

    @property
    def fixed_log_b(self) -> FloatArray:
        """Ln b_T where it is held, and where it starts."""
        if self.vertical == "1":
            return np.zeros(len(self.temperatures))
        return np.asarray(np.log(self.temperatures / self.temperatures[self.reference]))

    def names(self, order: int) -> tuple[str, ...]:
        """Return what is shared, in the order of the derivatives."""
        arms, extra = range(1, order + 1), self.free_temperatures
        return (
            "k_inf",
            *(f"k_{j}" for j in arms),
            *(f"ln_tau_{j}" for j in arms),
            *(f"ln_a_{i}" for i in extra),
            *((f"ln_b_{i}" for i in extra) if self.vertical == "free" else ()),
            # one arm cannot shift apart
            *(("slope",) if order > 1 else ()),
        )

    def shift_rows(self, names: Sequence[str]) -> FloatArray:
        """Return the rows that select log10 a_T and ln b_T of every temperature."""
        count = len(self.temperatures)
        selection = np.zeros((2 * count, len(names)))
        for i in self.free_temperatures:
            selection[i, names.index(f"ln_a_{i}")] = 1 / np.log(10.0)
            if f"ln_b_{i}" in names:
                selection[count + i, names.index(f"ln_b_{i}")] = 1.0
        return selection

    def part(self, block: DataBlock, i: int, point: ShiftedSolid) -> TestContribution:
        """One test of temperature i, in the rows of its block."""
        return _part(self._test(block, i, point), point)

    def descend(self, point: ShiftedSolid) -> ShiftedSolid:
        """Return the nearest optimum."""
        best = require_optimum(
            self.problem(point),
            [self.theta(point)],
            max_steps=_MAX_STEPS,
            cost_tolerance=_STATIONARY_FALL,
        )
        k_inf, k = float(best.beta[0]), best.beta[1:]
        return replace(
            self._replace_parameters(point, best.theta), k_inf=k_inf, k=k, chi_square=best.cost
        )

    def has_significant_arms(self, point: ShiftedSolid) -> bool:
        """Return whether every arm is significant."""
        n, error = point.order, np.sqrt(np.diag(self.covariance(point)))
        return significant(point.k, error[1 : 1 + n], error[1 + n : 1 + 2 * n])

    def covariance(self, point: ShiftedSolid) -> FloatArray:
        """Return covariance of what is shared under white noise of unit variance."""
        return white(_part(self._stack_all_tests(point), point).by, 1.0)

    def problem(self, start: ShiftedSolid) -> Problem:
        """Return all tests at once, with as many arms."""
        n, (low, high) = start.order, np.array([block.bounds for block in self.blocks]).T

        def clip_log_tau(theta: FloatArray) -> FloatArray:
            """Relaxation times that one of the tests shows."""
            change = self._replace_parameters(start, theta).log_a[self.at]
            tau = np.clip(theta[:n], (low - change).min(), (high - change).max())
            return np.concatenate((tau, theta[n:]))

        kinds = [name.rpartition("_")[0] or name for name in self.names(n)[1 + n :]]
        return Problem(
            lambda theta: Rows(*self._stack_all_tests(self._replace_parameters(start, theta))),
            [Parameter(scale=_STEP_SIZES[kind]) for kind in kinds],
            positive=True,
            priors=len(self._build_prior_rows(start)),
            gauge=clip_log_tau,
        )

    def _build_prior_rows(self, point: ShiftedSolid) -> FloatArray:
        """Rows by theta of what is known of g, below one of what no model of the tests removes."""
        values = np.zeros((1 + (point.order > 1), len(self.theta(point))))
        values[1:, -1:] = 1 / self.slope_sd
        return values

    def _stack_all_tests(self, point: ShiftedSolid) -> _Rows:
        """Return the rows of all tests and of the priors."""
        tests = zip(self.blocks, self.at.tolist(), strict=True)
        y, A, slopes = zip(*(self._test(block, i, point) for block, i in tests), strict=True)
        values = self._build_prior_rows(point)
        extra = -values @ self.theta(point)
        extra[0] = np.sqrt(sum(block.floor for block in self.blocks))
        return (
            np.concatenate((*y, extra)),
            np.concatenate((*A, np.zeros((len(values), 1 + point.order)))),
            lambda k: np.concatenate((*(slope(k) for slope in slopes), values)),
        )

    def _test(self, block: DataBlock, i: int, point: ShiftedSolid) -> _Rows:
        """One test of temperature i."""
        n, evaluation = point.order, block.evaluate(point.compute_log_tau(i))
        b, spring = float(np.exp(point.log_b[i])), list(block.fixed_names).index("k_inf")
        A = b * np.column_stack((evaluation.fixed[:, spring], evaluation.arms))

        def slope(k: FloatArray) -> FloatArray:
            names, decade_distances = self.names(n)[1 + n :], decades(point.log_tau)
            derivative, row = np.zeros((len(A), len(names))), b * evaluation.d_arms * k[1:]
            derivative[:, :n] = row * (1 + point.log_a[i] * point.slope / np.log(10.0))
            if i != self.reference:
                derivative[:, names.index(f"ln_a_{i}")] = row @ (1 + point.slope * decade_distances)
                if self.vertical == "free":
                    derivative[:, names.index(f"ln_b_{i}")] = A @ k
            if n > 1:
                derivative[:, -1] = row @ (point.log_a[i] * decade_distances)
            return derivative

        return evaluation.target, A, slope

    def theta(self, point: ShiftedSolid) -> FloatArray:
        """Ln tau, the shifts that are sought, and g."""
        log_b = point.log_b[self.free_temperatures] if self.vertical == "free" else ()
        slope = [point.slope] * (point.order > 1)
        return np.concatenate((point.log_tau, point.log_a[self.free_temperatures], log_b, slope))

    def _replace_parameters(self, point: ShiftedSolid, theta: FloatArray) -> ShiftedSolid:
        """Return the point with its ln tau, shifts and g."""
        n, m = point.order, len(self.free_temperatures)
        log_a, log_b = point.log_a.copy(), point.log_b.copy()
        log_a[self.free_temperatures] = theta[n : n + m]
        if self.vertical == "free":
            log_b[self.free_temperatures] = theta[n + m : n + 2 * m]
        slope = float(theta[-1]) if n > 1 else 0.0
        return replace(point, log_tau=theta[:n], log_a=log_a, log_b=log_b, slope=slope)


def _part(rows: _Rows, point: ShiftedSolid) -> TestContribution:
    (y, A, slope), k = rows, point.stiffnesses
    return TestContribution(y - A @ k, np.concatenate((A, slope(k)), axis=1))
