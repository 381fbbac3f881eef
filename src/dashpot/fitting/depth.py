r"""Relaxation tests at several depths: what depends on depth, and what does not.

If only the elastic force depends on depth, the seal is quasi-linear (Fung):

.. math:: F(t) = \int_0^t G(t-u)\, \frac{d F_e(x(u))}{du}\, du, \qquad G(\infty) = 1

and every linear tool serves it with :math:`F_e(x)` in place of x. Whether it is so is a question
to the tests: each gets its own stiffnesses, and the shapes k_j/k_inf are compared.
Source: Y. C. Fung, *Biomechanics* (1993), ch. 7.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import DataError, FitError
from dashpot.engine.solver.variable_projection import solve
from dashpot.fitting.checks import separable
from dashpot.fitting.design import Design, compressed
from dashpot.fitting.relaxation import fit
from dashpot.fitting.uncertainty.estimate import Estimate, estimated
from dashpot.records.fit import AtDepth, Fit
from dashpot.records.relaxation import RampHold
from dashpot.solids.elastic import PolynomialLaw, elastic_law
from dashpot.solids.maxwell import GeneralizedMaxwell

_ROUNDS = 8


@dataclass(frozen=True)
class DepthLaw:
    """What several depths say together.

    Attributes
    ----------
    law : PolynomialLaw
        Equilibrium force against compression.
    by_depth : tuple of AtDepth
        Each test's secant stiffnesses, shallowest first.
    separable : Check
        Whether the shape of relaxation is the same at every depth; the value is the
        probability of shapes as different as found if it were.
    fit : Fit
        All tests by one quasi-linear solid; ``fit.model`` is its secant solid at the deepest
        test.
    """

    law: PolynomialLaw
    by_depth: tuple[AtDepth, ...]
    separable: Check
    fit: Fit

    def secant_model(self, depth: float) -> GeneralizedMaxwell:
        """The linear solid that gives the force at this depth, m."""
        return self._scaled(float(self.law.secant(depth)), depth)

    def tangent_model(self, depth: float) -> GeneralizedMaxwell:
        """The linear solid that small vibration about this compression, m, feels."""
        return self._scaled(float(self.law.tangent(depth)), depth)

    def _scaled(self, stiffness: float, depth: float) -> GeneralizedMaxwell:
        if not (np.isfinite(depth) and depth > 0):
            raise DataError(f"depth = {depth!r} m; expected a compression > 0")
        if not stiffness > 0:
            raise DataError(
                f"the elastic law gives {stiffness:.4g} N/m at {1e3 * depth:.4g} mm, outside what "
                f"its tests support (up to {1e3 * self.law.deepest:.4g} mm); test that depth"
            )
        return self.fit.model * (stiffness / self.fit.model.k_inf)


def fit_depths(
    tests: Sequence[RampHold], *, arms: int | Literal["auto"] = "auto", thorough: bool = False
) -> DepthLaw:
    """Fit tests at two or more depths: elastic law, separability, one quasi-linear solid.

    The motion of each test is bent by the elastic law until every test's equilibrium force lies
    on it, so the ramps are fitted as what they are.

    Parameters
    ----------
    tests : sequence of RampHold
        At different depths.
    arms, thorough
        As in :func:`~dashpot.fitting.relaxation.fit`.

    Raises
    ------
    FitError
        If there are fewer than two tests, two share a depth, or a test has no equilibrium
        stiffness.
    """
    if len(tests) < 2:
        raise FitError(f"found {len(tests)} test; a depth law needs at least two depths")
    ordered = sorted(tests, key=lambda test: test.depth)
    depth = np.array([test.depth for test in ordered])
    first = fit(ordered, arms=arms, thorough=thorough, depth_law=True)
    count = first.model.arms if arms == "auto" else arms
    secant, error = _secants(first.by_depth)
    law = elastic_law(depth, secant, error)
    log_tau = np.log(first.model.tau)
    for _ in range(_ROUNDS):
        bent = [_bent(test, law) for test in ordered]
        each = _each(bent, ordered, count, log_tau if len(log_tau) == count else None)
        log_tau = each.solution.log_tau
        # what a bent fit calls stiffness is a factor on the law's own force
        stretch = np.array([test.depth for test in bent]) / depth
        new = elastic_law(depth, _springs(each) * stretch, error)
        change = float(np.abs(new.secant(depth) / law.secant(depth) - 1.0).max())
        law = new
        if change < 1e-7:
            break
    together = fit([_bent(test, law) for test in ordered], arms=count, thorough=thorough)
    return DepthLaw(
        law, each.by_depth(depth.tolist(), stretch.tolist()), _separable(each), together
    )


def _each(
    tests: Sequence[RampHold],
    recorded: Sequence[RampHold],
    arms: int,
    start: FloatArray | None,
) -> Estimate:
    """Return every test's own stiffnesses with their common covariance."""
    design = Design("full", depth_law=True)
    blocks = compressed(tests, design)
    peak = max(float(np.abs(test.force).max()) for test in tests)
    solution = solve(blocks, arms, log_tau_start=start)
    found = estimated(solution, [block.exact for block in blocks], peak=peak)
    return found.with_depth_doubt([test.depth_doubt for test in recorded], shared=False)


def _springs(each: Estimate) -> FloatArray:
    names = [name for name in each.solution.fixed_names if name.startswith("k_inf@")]
    return np.array([each.solution.coefficient(name) for name in names])


def _separable(each: Estimate) -> Check:
    r"""Test :math:`k_j/k_\infty` equal at every depth: Wald's statistic, as an F."""
    springs, arms = _springs(each), each.solution.arms
    tests, count = arms.shape
    if count == 0:
        return separable(None, None)
    ratio = arms / springs[:, None]
    spread = float(np.abs(ratio / ratio.mean(axis=0) - 1.0).max())
    if not np.all(np.isfinite(each.covariance)):
        return separable(None, spread)
    slope = np.zeros((tests * count, len(each.names)))
    for i in range(tests):
        for j in range(count):
            row = slope[i * count + j]
            row[each.names.index(f"k_{j + 1}@{i}")] = 1.0 / springs[i]
            row[each.names.index(f"k_inf@{i}")] = -arms[i, j] / springs[i] ** 2
    contrast = np.kron(np.eye(tests)[1:] - np.eye(tests)[:1], np.eye(count))
    difference = contrast @ ratio.ravel()
    gradient = contrast @ slope
    free = len(difference)
    statistic = (
        difference @ np.linalg.solve(gradient @ each.covariance @ gradient.T, difference) / free
    )
    # a rare path: scipy's F distribution costs an import that a plain fit does not pay
    from scipy.special import fdtrc

    return separable(float(fdtrc(free, max(each.dof, 1.0), statistic)), spread)


def _secants(by_depth: Sequence[AtDepth]) -> tuple[FloatArray, FloatArray]:
    secant = np.array([at.k_inf for at in by_depth])
    if (secant <= 0).any():
        at = by_depth[int(np.argmin(secant))]
        raise FitError(
            f"the test at {1e3 * at.depth:.4g} mm has no equilibrium stiffness; hold it longer, "
            "or leave it out"
        )
    return secant, np.array([at.k_inf_se for at in by_depth])


def _bent(test: RampHold, law: PolynomialLaw) -> RampHold:
    """Return the test with F_e(x)/k_sec(deepest) for x: a linear solid then answers it."""
    unit = float(law.secant(law.deepest))
    return replace(
        test,
        displacement=law.force(test.displacement) / unit,
        depth=float(law.force(test.depth)) / unit,
    )
