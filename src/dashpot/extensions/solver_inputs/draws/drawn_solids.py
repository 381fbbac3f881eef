r"""Solids drawn from the covariance of a fit, with arms that its test does not resolve.

The test hardly determines an arm faster than its ramp, so that the fit has none. Each draw has one:
ln tau is uniform from the shortest time that affects the peak to the end of the valid band or the
fastest arm of the fit. With :math:`a` its whitened column, J the columns of the fit and y the
residual,

.. math::

    r = a - J J^+ a, \qquad k = \frac{r'y}{|r|^2} \pm \frac{1}{|r|}, \quad k \ge 0, \qquad
    \theta(k) = \hat\theta - J^+ a\, k

where :math:`\theta(k)` minimises the residual for the stiffness k; the covariance of the other
parameters is added.
"""

from __future__ import annotations

from collections.abc import Sequence
from statistics import NormalDist

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.option_fields import Method, get_choice_values
from dashpot.base.provenance import Step
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.relaxation import RampHold
from dashpot.extensions.solver_inputs.draws.stratified_sampling import (
    convert_to_uniform,
    draw_standard_normal,
    truncated_normal,
)
from dashpot.fitting.marginal_relaxation import RelaxationData
from dashpot.fitting.prediction_bounds import (
    UNKNOWN_SD,
    compute_covariance_root,
    get_solid_parameters,
)
from dashpot.fitting.relaxation_likelihood import build_relaxation_data
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

_MIN_SHARE = 0.02
"""Smallest fraction of a stiffness in a draw."""
_FASTEST_ARM_RATIO = 3.0
"""Frequency of the loss maximum of the fastest unresolved arm over that of the peak."""
_MAX_ITERATIONS = 40
_MIN_COLUMN_SHARE = 1e-9
"""Smallest remainder of a column after projection, relative, that data can determine."""


@dataclass(frozen=True)
class UnresolvedArm:
    """Arm of a draw that the fit does not have: k in N/m, tau in s."""

    k: float
    tau: float


@dataclass(frozen=True)
class DrawnSolid:
    """One solid that the test does not reject.

    Attributes
    ----------
    number : int
        From 1 on.
    solid : Solid
    arm : UnresolvedArm or None
        The unresolved arm among its arms.
    deviance : float or None
        Sum of squares of its residuals less that of the fit, in units of the noise variance; None
        without a record.
    """

    number: int
    solid: Solid
    arm: UnresolvedArm | None = None
    deviance: float | None = None


def draw_solids(
    fit: Fit,
    count: int,
    *,
    seed: int,
    records: Sequence[RampHold] = (),
    times: tuple[float, float] | None = None,
) -> tuple[DrawnSolid, ...]:
    """Return stratified draws of the solid of a fit.

    Parameters
    ----------
    fit : Fit
    count : int
    seed : int
    records : sequence of RampHold
        The relaxation tests behind the fit.
    times : (float, float), optional
        Range of the relaxation time of the unresolved arm, s; without it no such arm is drawn.

    Raises
    ------
    DataError
        If the fit has no covariance, or the records are not those of a relaxation fit.
    """
    names, mean, covariance = get_solid_parameters(fit)
    if not fit.estimate.parameters:
        raise DataError(
            "the fit has no covariance, so nothing can be drawn from it; fit with fewer arms"
        )
    max_sd = UNKNOWN_SD * np.where([name.startswith("ln") for name in names], 1.0, np.abs(mean))
    variance = np.diag(covariance)
    is_undetermined = ~np.isfinite(variance) | (variance > max_sd**2)
    covariance[is_undetermined, :] = covariance[:, is_undetermined] = 0.0
    covariance[is_undetermined, is_undetermined] = max_sd[is_undetermined] ** 2
    normal = draw_standard_normal(count, len(names) + 2, seed)
    values = mean + normal[:, :-2] @ compute_covariance_root(covariance)
    if times is None or not records:
        return tuple(
            DrawnSolid(number, _build_solid(fit, names, mean, row))
            for number, row in enumerate(values, start=1)
        )
    if isinstance(fit.solid, FractionalZener) or fit.method not in get_choice_values(Method):
        raise DataError(
            "--record adds an unresolved arm to the fit of one or more relaxation tests with "
            f"Maxwell arms; this one is of the method '{fit.method}': leave --record out"
        )
    test = _Sensitivities([build_relaxation_data(record, fit) for record in records], fit, names)
    shares = convert_to_uniform(normal[:, -2:])
    low, high = np.log(times)
    return tuple(
        test.add_arm(number, mean, row, float(np.exp(low + (high - low) * position)), float(share))
        for number, (row, (position, share)) in enumerate(zip(values, shares, strict=True), start=1)
    )


def choose_unresolved_times(fit: Fit, peak: float) -> tuple[float, float] | None:
    """Return the relaxation times, s, of arms that act on a peak, Hz, above the valid band.

    None if the test determines the peak, or no frequency at all.
    """
    high = fit.band[1]
    if not 0 < high < peak:
        return None
    return 1 / (2 * np.pi * _FASTEST_ARM_RATIO * peak), min(1 / (2 * np.pi * high), *fit.model.tau)


def compute_deviance_quantile(dof: int) -> float:
    """Return the 99 % quantile of chi-square (E. B. Wilson and M. M. Hilferty, 1931)."""
    part = 2 / (9 * dof)
    return float(dof * (1 - part + NormalDist().inv_cdf(0.99) * np.sqrt(part)) ** 3)


class _Sensitivities:
    """Whitened derivatives of some records by the parameters of a fit."""

    def __init__(self, data: Sequence[RelaxationData], fit: Fit, names: Sequence[str]) -> None:
        self.data, self.fit, self.names = data, fit, names
        self.fitted = [name in fit.estimate.parameters for name in names]
        self.limit = compute_deviance_quantile(sum(self.fitted) + 1)

    def _list_columns(
        self, model: GeneralizedMaxwell, tau: Sequence[float]
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the target, the columns of the parameters, and those of arms at other times."""
        log_tau, n = np.log([*model.tau, *tau]), model.arms
        targets, columns, other_columns = [], [], []
        for data in self.data:
            rows = data.rows(log_tau)
            parts = [rows.spring[:, None], rows.arms[:, :n], rows.slopes[:, :n] * model.k]
            if "b" in self.names:
                parts.append(rows.dashpot[:, None])
            targets.append(rows.target - model.b * rows.dashpot * ("b" not in self.names))
            columns.append(np.hstack(parts))
            other_columns.append(rows.arms[:, n:])
        return np.concatenate(targets), np.vstack(columns), np.vstack(other_columns)

    def add_arm(
        self, number: int, mean: FloatArray, values: FloatArray, tau: float, share: float
    ) -> DrawnSolid:
        """Return the draw of these values with an unresolved arm, whose k is a quantile at `share`.

        No stiffness falls below 2 % of its value in the fit. A draw that the record rejects at
        99 % is moved towards the fit.
        """
        model = self.fit.model
        target, columns, other_columns = self._list_columns(model, [tau])
        J, a = columns[:, self.fitted], other_columns[:, 0]
        norms = np.maximum(np.linalg.norm(J, axis=0), 1e-300)
        coefficients = np.linalg.lstsq(J / norms, a, rcond=1e-12)[0] / norms
        remainder = a - J @ coefficients
        magnitude = float(np.linalg.norm(remainder))
        linear = [i for i in range(len(mean)) if not self.names[i].startswith("ln")]
        residual = target - columns[:, linear] @ mean[linear]
        parameter_changes = np.zeros(len(mean))
        parameter_changes[self.fitted] = -coefficients
        falling_indices = [i for i in linear if parameter_changes[i] < 0]
        max_stiffness = min(
            [(1 - _MIN_SHARE) * mean[i] / -parameter_changes[i] for i in falling_indices],
            default=model.k_0,
        )
        if magnitude <= _MIN_COLUMN_SHARE * float(np.linalg.norm(a)):
            k = share * max_stiffness
        else:
            k = truncated_normal(share, float(remainder @ residual) / magnitude**2, 1 / magnitude)
        k = min(k, max_stiffness, 10 * model.k_0)
        step, scale = values - mean + parameter_changes * k, 1.0
        for _ in range(_MAX_ITERATIONS):
            solid = _build_solid(self.fit, self.names, mean, mean + scale * step)
            combined = solid.maxwell + GeneralizedMaxwell(0.0, (scale * k,), (tau,))
            deviance = self._compute_deviance(model, combined)
            if deviance <= self.limit:
                break
            scale *= min(0.9, float(np.sqrt(self.limit / deviance)))
        return DrawnSolid(number, combined, UnresolvedArm(scale * k, tau), deviance)

    def _compute_deviance(self, fitted: GeneralizedMaxwell, model: GeneralizedMaxwell) -> float:
        log_tau = np.log([*fitted.tau, *model.tau])
        total = 0.0
        for data in self.data:
            rows = data.rows(log_tau, with_slopes=False)
            for sign, solid, arm_slice in (
                (-1, fitted, slice(fitted.arms)),
                (1, model, slice(fitted.arms, None)),
            ):
                residual = (
                    rows.target
                    - solid.k_inf * rows.spring
                    - solid.b * rows.dashpot
                    - rows.arms[:, arm_slice] @ np.asarray(solid.k)
                )
                total += sign * float(residual @ residual)
        return total


def _build_solid(fit: Fit, names: Sequence[str], mean: FloatArray, values: FloatArray) -> Solid:
    """Return the solid of parameters in the order of their names."""
    if isinstance(fit.solid, FractionalZener):
        k_inf, k_0 = np.maximum(values[:2], _MIN_SHARE * mean[:2])
        alpha = float(np.clip(values[3], 0.05, 1.0))
        return FractionalZener(float(k_0), float(k_inf), float(np.exp(values[2])), alpha)
    arms = fit.model.arms
    k = np.maximum(values[: 1 + arms], _MIN_SHARE * mean[: 1 + arms])
    tau = np.exp(np.clip(values[1 + arms : 1 + 2 * arms], -60.0, 60.0))
    order = np.argsort(tau)
    b = max(float(values[-1]), 0.0) if "b" in names else fit.model.b
    return GeneralizedMaxwell(
        float(k[0]), tuple(k[1:][order].tolist()), tuple(tau[order].tolist()), b
    )


def replace_solid(fit: Fit, solid_drawn: DrawnSolid, *, count: int, seed: int) -> Fit:
    """Return the fit with a drawn solid, whose parameters have no errors."""
    step = Step(
        "draw",
        (("number", str(solid_drawn.number)), ("of", fit._identity), ("seed", str(seed))),
        f"draw {solid_drawn.number} of {count} of fit {fit._identity}, with seed {seed}",
    )
    zero = np.zeros_like(fit.covariance)
    return replace(
        fit,
        solid=solid_drawn.solid,
        estimate=replace(fit.estimate, covariance=zero, noise_covariance=None, profiles=()),
        provenance=replace(fit.provenance, steps=(*fit.steps, step)),
    )
