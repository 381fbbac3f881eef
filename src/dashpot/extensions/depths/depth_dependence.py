r"""Depth dependence of stiffness in relaxation tests at several depths.

If only the elastic force depends on depth, the seal is quasi-linear (Fung):

.. math:: F(t) = \int_0^t G(t-u)\, \frac{d F_e(x(u))}{du}\, du, \qquad G(\infty) = 1

and every linear method applies with :math:`F_e(x)` in place of x. All tests share one :math:`F_e`,
which follows from their ramps and their depths
(:mod:`~dashpot.fitting.nonlinear_ramp.elastic_law`). To test whether one relaxation function is
valid at every depth, each test gets its own stiffnesses, and the ratios k_j/k_inf are compared.
Source: Y. C. Fung, *Biomechanics* (1993), ch. 7.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import FitError
from dashpot.base.reported_values import NORMAL
from dashpot.base.units import format_quantity
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import DepthStiffness
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.checks.relaxation import depth_and_time_separable
from dashpot.fitting.checks.solid import arms_enough
from dashpot.fitting.input_tests import Tests, checked_temperatures, ramp_holds
from dashpot.fitting.marginal_relaxation import RelaxationData
from dashpot.fitting.nonlinear_ramp.elastic_law import (
    RampLaw,
    find_arm_shortage,
    select_elastic_law,
)
from dashpot.fitting.nonlinear_ramp.fit_construction import (
    build_ramp_data,
    build_ramp_fit,
    depth_error,
)
from dashpot.fitting.nonlinear_ramp.hold_then_ramp import MAX_ARMS, fit_ramp_and_hold
from dashpot.fitting.order_selection import validate_arm_count
from dashpot.fitting.parameter_errors import compute_clock_sensitivity, compute_rig_sensitivity
from dashpot.numerics.inference.covariance_estimate import Estimate
from dashpot.solids.elastic import ElasticLaw


@dataclass(frozen=True)
class DepthLaw:
    """Joint result of tests at several depths.

    Attributes
    ----------
    law : ElasticLaw
        Relaxed force against compression.
    by_depth : tuple of DepthStiffness
        Each test's secant stiffnesses, shallowest first.
    separable : Check
        Whether the shape of relaxation is the same at every depth; the value is the
        p-value of equal shapes.
    fit : Fit
        All tests by one quasi-linear solid; ``fit.model`` is its secant solid at the deepest
        test.
    """

    law: ElasticLaw
    by_depth: tuple[DepthStiffness, ...]
    separable: Check
    fit: Fit


def fit_depths(
    tests: Tests, *, arms: int | Literal["auto"] = "auto", max_arms: int = MAX_ARMS
) -> DepthLaw:
    """Fit tests at two or more depths: elastic law, separability, one quasi-linear solid.

    Parameters
    ----------
    tests : sequence of RampHold or RelaxationTest
        At different depths.
    arms : int or "auto"
        ``"auto"`` selects the number by BIC of the holds, up to `max_arms`.

    Raises
    ------
    FitError
        If there are fewer than two tests, two share a depth, they are of several temperatures, or
        a test has no equilibrium stiffness.
    """
    records = ramp_holds(tests)
    if len(records) < 2:
        raise FitError(
            f"found {len(records)} test of one depth; a depth law needs at least two depths, in "
            "separate files, or in one record that returns and rests between them"
        )
    ordered_tests = sorted(records, key=lambda test: test.depth)
    depths = [test.depth for test in ordered_tests]
    if len(set(depths)) < len(depths):
        raise FitError(
            f"depths {', '.join(format_quantity(value, 'mm') for value in depths)}; expected "
            "different compressions > 0: fit equal depths together without depth_law"
        )
    checked_temperatures(records, shared=False)
    arm_limit = validate_arm_count(arms, max_arms)
    requested_arms = None if arms == "auto" else arm_limit
    law = select_elastic_law(ordered_tests, arms=requested_arms, max_arms=arm_limit)
    stiffnesses, ramp_data = _fit_each_test(law), build_ramp_data(ordered_tests, law)
    by_depth = tuple(
        stiffnesses.secant_stiffness(i, test.depth, rig)
        for i, (test, rig) in enumerate(_add_rig_errors(ordered_tests, ramp_data, law))
    )
    for at in by_depth:
        if at.k_inf <= 0:
            raise FitError(
                f"the test at {format_quantity(at.depth, 'mm')} has no equilibrium stiffness; hold "
                "it longer, or leave it out"
            )
    check = _check_separability(stiffnesses)
    arm_checks = (
        ()
        if requested_arms is None
        else (arms_enough(find_arm_shortage(ordered_tests, law.hold), law.model.arms, unit="N"),)
    )
    joint_fit = build_ramp_fit(
        ordered_tests, law, requested_arms=requested_arms, by_depth=by_depth,
        checks=(check, *arm_checks),
        unmeasured=compute_rig_sensitivity(ramp_data, law.model),
    )  # fmt: skip
    return DepthLaw(law.law, by_depth, check, joint_fit)


class _StiffnessPerTest(NamedTuple):
    """Stiffnesses of each test on the path of the law, shape (R, 1 + N), and their covariance."""

    k: FloatArray
    estimate: Estimate
    dof: float
    law: ElasticLaw

    def secant_stiffness(self, test: int, depth: float, rig: FloatArray) -> DepthStiffness:
        """Return the secant stiffnesses of one test; `rig` is their error by its rig."""
        scale = float(self.law.path(depth)) / depth
        error = self.estimate.standard_error[len(self.estimate.optimum.theta) :]
        noise = error[: self.k.size].reshape(self.k.shape)[test]
        k, se = scale * self.k[test], scale * np.hypot(noise, rig)
        upper = float(k[0] + NORMAL * se[0])
        return DepthStiffness(
            depth, float(k[0]), upper, tuple(k[1:].tolist()), tuple(se[1:].tolist())
        )


def _add_rig_errors(
    tests: Sequence[RampHold], ramp_data: Sequence[RelaxationData], law: RampLaw
) -> Iterator[tuple[RampHold, FloatArray]]:
    """Iterate over the tests, each with the errors of its stiffnesses by its rig, N/m."""
    model = law.model
    k = np.array((model.k_inf, *model.k))
    sensitivity = compute_rig_sensitivity(ramp_data, model, separate=True)
    for i, test in enumerate(tests):
        rows = slice(i * len(k), (i + 1) * len(k))
        clocks = compute_clock_sensitivity([test], model)[: len(k)]
        columns = np.column_stack((sensitivity[rows], depth_error(test) * k, clocks))
        yield test, np.linalg.norm(columns, axis=1)


def _fit_each_test(ramp_law: RampLaw) -> _StiffnessPerTest:
    """Fit the stiffnesses of each test, with common relaxation times and law."""
    ramp_optimum = ramp_law.optimum
    solid, log_tau = ramp_optimum.weighted.solid, np.log(np.asarray(ramp_law.model.tau))
    optimum = fit_ramp_and_hold(
        solid,
        ramp_law.hold,
        ramp_optimum,
        solid.theta(log_tau, ramp_optimum.shape),
        value=ramp_optimum.weighted.nuisances,
        separate=True,
    )
    law = ElasticLaw(ramp_law.law.knots, tuple(optimum.shape.tolist()), 1.0)
    return _StiffnessPerTest(optimum.k, optimum.estimate(ramp_law.hold), ramp_law.estimate.dof, law)


def _check_separability(stiffnesses: _StiffnessPerTest) -> Check:
    r"""Test :math:`k_j/k_\infty` equal at every depth: Wald's statistic, as an F."""
    if stiffnesses.k.shape[1] == 1:
        return depth_and_time_separable(None, None)
    ratio = stiffnesses.k[:, 1:] / stiffnesses.k[:, :1]
    max_deviation = float(np.abs(ratio / ratio.mean(axis=0) - 1.0).max())
    first = len(stiffnesses.estimate.optimum.theta)
    rows = slice(first, first + stiffnesses.k.size)
    if not np.all(np.isfinite(stiffnesses.estimate.covariance[rows, rows])):
        return depth_and_time_separable(None, max_deviation)

    def differences(values: FloatArray) -> FloatArray:
        k = values[rows].reshape(stiffnesses.k.shape)
        shapes = k[:, 1:] / k[:, :1]
        return np.asarray((shapes[1:] - shapes[0]).ravel())

    quantity = stiffnesses.estimate.derive_quantity(differences)
    free = len(quantity.values)
    weighted_values = np.linalg.lstsq(quantity.covariance, quantity.values, rcond=1e-12)[0]
    # a rare path: scipy's F distribution costs an import that a plain fit does not pay
    from scipy.special import fdtrc

    p_value = fdtrc(free, max(stiffnesses.dof, 1.0), quantity.values @ weighted_values / free)
    return depth_and_time_separable(float(p_value), max_deviation)
