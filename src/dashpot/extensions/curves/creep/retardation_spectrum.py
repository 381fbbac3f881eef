"""Retardation spectrum of a creep fit, and the equivalent relaxation solid."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.datamodel.fit_diagnostics import OrderScore
from dashpot.datamodel.parameter_estimate import CreepEstimate, Profile
from dashpot.fitting.order_selection import SelectedModel
from dashpot.numerics.design_matrices.block import DataBlock, Evaluation
from dashpot.numerics.exponential_fit import Solution
from dashpot.numerics.inference.covariance_estimate import propagate_covariance
from dashpot.solids.interconversion import CreepSpectrum, relaxation_spectrum
from dashpot.solids.maxwell import GeneralizedMaxwell


def make_retardation_block(block: DataBlock, equilibrium_name: str) -> DataBlock:
    r"""Return the block with each arm as a retardation: the displacement that a force still causes.

    An arm's column q of the input F is :math:`\int e^{-(t-u)/\lambda}\,dF`, so

    .. math:: \int_0^t \bigl(1 - e^{-(t-u)/\lambda}\bigr)\,dF(u) = F(t) - q(t)

    Parameters
    ----------
    block : DataBlock
        Block of arms under the input F.
    equilibrium_name : str
        Name of the fixed column that is F.
    """
    equilibrium_index = block.fixed_names.index(equilibrium_name)

    def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
        evaluation = block.rows(log_tau, derivative)
        arms = evaluation.fixed[:, [equilibrium_index]] - evaluation.arms
        return evaluation._replace(arms=arms, d_arms=-evaluation.d_arms if derivative else arms)

    return replace(
        block,
        rows=rows,
        sampling=None,
        build_full=None
        if block.build_full is None
        else lambda: make_retardation_block(block.exact, equilibrium_name),
        add_fixed_column=lambda name, column: make_retardation_block(
            block.with_column(name, column), equilibrium_name
        ),
        add_delayed_column=None,
    )


def compute_relaxation_sensitivity(creep: CreepSpectrum, tau: Sequence[float]) -> FloatArray:
    r"""Return how the relaxation spectrum moves with the creep spectrum, exactly.

    Each arm is a zero :math:`-\rho_j` of the compliance J(s) with
    :math:`k_j = -1 / (\rho_j J'(-\rho_j))`, so that, with all of J at :math:`s = -\rho`,

    .. math:: d\rho = \frac{J_\theta}{J'}\,d\theta, \qquad
        d\ln k = -\frac{d\rho}{\rho} - \frac{J'_\theta\,d\theta - J''\,d\rho}{J'}

    Parameters
    ----------
    creep : CreepSpectrum
    tau : sequence of float
        Relaxation times of :func:`relaxation_spectrum`, s.

    Returns
    -------
    array, shape (2 + 2 arms, 2 + 2 retardations)
        Rows: k_inf, every k, every ln tau, b; columns: glass, every D, every ln lambda, flow.
    """
    d, lam = np.array(creep.d, dtype=float), np.array(creep.lam, dtype=float)
    rho, x, n = 1 / np.array(tau, dtype=float), 1 / lam, len(lam)
    excess, row = x - rho[:, None], np.ones((len(rho), 1))
    weight = d * x
    value = np.hstack((row, x / excess, weight * rho[:, None] / excess**2, -row / rho[:, None]))
    slope = np.hstack((
        0 * row, -x / excess**2, -weight * (x + rho[:, None]) / excess**3, -row / rho[:, None] ** 2,
    ))  # fmt: skip
    first = -creep.flow / rho**2 - (weight / excess**2).sum(axis=1)
    second = -2 * creep.flow / rho**3 + 2 * (weight / excess**3).sum(axis=1)
    ratio = value / first[:, None]
    log_k = -ratio / rho[:, None] - (slope - second[:, None] * ratio) / first[:, None]
    k = -1 / (rho * first)
    value_at_rest = np.concatenate(([1.0], np.ones(n), np.zeros(n + 1)))
    viscous = np.concatenate(([0.0], x, -weight, [1.0]))
    k_inf = 0.0 if creep.flow > 0 else 1 / creep.equilibrium
    b = 0.0 if creep.glass > 0 else 1 / (creep.flow + float(weight.sum()))
    return np.vstack(
        (-(k_inf**2) * value_at_rest, k[:, None] * log_k, -ratio / rho[:, None], -(b**2) * viscous)
    )


GLASS, FLOW = "glass", "flow"
"""Names of the columns of instantaneous compliance and flow."""


def get_spectrum(solution: Solution) -> CreepSpectrum:
    """Return the compliances of a solution; a retardation that it does not show is omitted."""
    d = solution.arms[0] if solution.order else np.zeros(0)
    flow = solution.coefficient(FLOW) if FLOW in solution.fixed_names else 0.0
    return CreepSpectrum(
        max(solution.coefficient(GLASS), 0.0),
        tuple(d[d > 0].tolist()),
        tuple(solution.tau[d > 0].tolist()),
        max(flow, 0.0),
    )


def _make_solid(solution: Solution) -> GeneralizedMaxwell:
    creep = get_spectrum(solution)
    if creep.glass <= 0 and not creep.d and creep.flow <= 0:
        return GeneralizedMaxwell(0.0)
    return GeneralizedMaxwell(*relaxation_spectrum(creep))


@dataclass(frozen=True, eq=False)
class SelectedCreepModel(SelectedModel):
    """Optimum in compliances, and the equivalent solid.

    Attributes
    ----------
    alternative_bic_difference : float or None
        BIC of the alternative (a part that flows, or one that comes to rest) less that of this one.
    """

    alternative_bic_difference: float | None = None

    @cached_property
    def spectrum(self) -> CreepSpectrum:
        """The compliances."""
        return get_spectrum(self.solution)

    @property
    def flows(self) -> bool:
        """True if the displacement never comes to rest."""
        return self.spectrum.flow > 0

    @cached_property
    def model(self) -> GeneralizedMaxwell:
        """The solid, by exact interconversion."""
        return _make_solid(self.solution)

    @cached_property
    def creep(self) -> CreepEstimate:
        """Compliances and retardation times with their covariance."""
        row_names = self.rows_named(GLASS, "d", "ln_lam", FLOW if self.flows else None)
        rows = list(row_names.values())
        covariance = self.estimate.covariance[np.ix_(rows, rows)]
        return CreepEstimate(self.spectrum, tuple(row_names), covariance)

    @cached_property
    def _gradient(self) -> dict[str, FloatArray]:
        """Return the derivative of each parameter of the solid by those of the creep."""
        model, size = self.model, len(self.creep.parameters)
        sensitivity = compute_relaxation_sensitivity(self.spectrum, model.tau)[:, :size]
        arms = range(1, model.arms + 1)
        names = ("k_inf", *(f"k_{j}" for j in arms), *(f"ln_tau_{j}" for j in arms), "b")
        fixed_names = {
            name for name, value in (("k_inf", model.k_inf), ("b", model.b)) if value == 0
        }
        return {
            name: row
            for name, row in zip(names, sensitivity, strict=True)
            if name not in fixed_names
        }

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the solid's parameters; a part that flows has no k_inf."""
        return tuple(self._gradient)

    @cached_property
    def covariance(self) -> FloatArray:
        """Covariance of the solid's parameters, by the derivative of the interconversion."""
        return propagate_covariance(self.creep.covariance, np.array(list(self._gradient.values())))

    @property
    def every_error(self) -> FloatArray:
        """Standard errors of k_inf (0 where the part flows), every k and every ln tau."""
        errors = dict(zip(self.parameters, self.error, strict=True))
        return np.array([errors.get("k_inf", 0.0), *(e for n, e in errors.items()
                                                     if n not in {"k_inf", "b"})])  # fmt: skip

    @property
    def orders(self) -> tuple[OrderScore, ...]:
        """Every number of retardations tried, as the solids that they make."""
        return tuple(
            OrderScore(solid.arms, score.solution.sse, score.bic, score.significant, solid)
            for score in self.scores
            for solid in (_make_solid(score.solution),)
        )

    def profiles(
        self,
        *,
        in_order_of_time: bool,  # noqa: ARG002
        unmeasured: FloatArray | None = None,  # noqa: ARG002
    ) -> tuple[Profile, ...]:
        """None: the intervals are those of the covariance."""
        return ()
