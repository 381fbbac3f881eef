r"""Relaxation test as data of a fit, with the rig's contributions eliminated.

What a rig adds to the force of the solid is linear: an offset, a drift, the change that a late
clock makes, what the readings of the encoder leave unknown. Each is known beforehand to within a
standard deviation (:mod:`dashpot.fitting.nuisance_priors`), so that all of them together add
:math:`C C'` to the covariance of the noise, C their columns times their standard deviations. The
rows are whitened for it.

A force that is late by :math:`\delta` is :math:`F - \delta \dot F`. Its column needs no new
column of the record: with the elongations q_j of unit arms,

.. math:: \dot F = k_g \dot x - \sum_j (k_j/\tau_j)\, q_j, \qquad k_g = k_\infty + \sum_j k_j
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.datamodel.shift_factors import decades, shifted_log_tau
from dashpot.fitting.nuisance_priors import NuisanceTerms, Prior, get_column_kind
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.inference.correlated_noise import marginalise
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

# Ratio of the shortest time of the window and of the relaxation time of an arm that acts as a
# dashpot.
DASHPOT_TAU_RATIO = 1e-3
SOLID_PARAMETERS = ("k_inf", "b")
# ratio of the drift error with a baseline of 10 s and a data sheet to the default
NAMED_DRIFT_RATIO = 0.2
LN_10 = float(np.log(10.0))
EXACT_PRIOR = Prior(0.0)


class ThermalShift(NamedTuple):
    r"""Shift of a solid at the temperature of a test: relaxation times and stiffnesses.

    Attributes
    ----------
    log_a, log_b : float
        :math:`\ln a_T` and :math:`\ln b_T`.
    slope : float
        How much further each decade of tau shifts.
    shift_sd, slope_sd : float
        Uncertainty of ln a_T and of the slope; 0 at the reference.
    """

    log_a: float = 0.0
    log_b: float = 0.0
    slope: float = 0.0
    shift_sd: float = 0.0
    slope_sd: float = 0.0

    @property
    def a_t(self) -> float:
        """Shift factor of time."""
        return float(np.exp(self.log_a))

    @property
    def stretch(self) -> float:
        """Slope of ln tau there by ln tau."""
        return 1 + self.log_a * self.slope / LN_10

    def log_tau(self, log_tau: FloatArray) -> FloatArray:
        """Ln of relaxation times there."""
        return shifted_log_tau(log_tau, self.log_a, self.slope)

    def compute_shift_columns(self, model: GeneralizedMaxwell, slopes: FloatArray) -> FloatArray:
        """Return the columns of an uncertain shift and slope, times their standard deviation.

        `model` is the solid at this temperature, `slopes` the derivatives of its arms' columns.
        """
        k = np.asarray(model.k)
        distances = decades(np.log(np.asarray(model.tau)) - self.log_a)
        return np.column_stack(
            (slopes @ (k * self.shift_sd), slopes @ (k * self.log_a * distances * self.slope_sd))
        )


class UnmeasuredEffects(NamedTuple):
    """Unmeasured effects of a rig, d terms, as sums of a block's columns.

    Attributes
    ----------
    names : tuple of str
    log_tau : array, shape (m,)
        Ln of the relaxation times of its arms, s.
    fixed, arms : array, shape (q, d) and (m, d)
        Weights of the block's fixed columns and of those arms', times a standard deviation.
    """

    names: tuple[str, ...]
    log_tau: FloatArray
    fixed: FloatArray
    arms: FloatArray

    def exclude(self, *names: str) -> UnmeasuredEffects:
        """Return the terms without these."""
        is_retained = [name not in names for name in self.names]
        kept_names = tuple(name for name in self.names if name not in names)
        return UnmeasuredEffects(
            kept_names, self.log_tau, self.fixed[:, is_retained], self.arms[:, is_retained]
        )

    def columns(self, fixed: FloatArray, arms: FloatArray) -> FloatArray:
        """One column a term, in the coordinates of these."""
        return np.asarray(fixed @ self.fixed + arms @ self.arms)


class RelaxationRows(NamedTuple):
    """Rows of a relaxation test at some relaxation times, each of unit noise.

    Target, the columns of k_inf and of b, of the arms, and their derivatives by ln tau; what the
    rig may add that is neither sought nor doubted. The coordinates may differ from call to call, so
    rows of two calls must not be mixed.
    """

    target: FloatArray
    spring: FloatArray
    dashpot: FloatArray
    arms: FloatArray
    slopes: FloatArray
    rig_rows: FloatArray = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class RelaxationData:
    r"""Relaxation test, weighted by its noise.

    Attributes
    ----------
    block : DataBlock
        Fixed columns other than those of the solid are private to the test.
    weight : float
        :math:`1/\sqrt S`, 1/N, with S the power of the residuals in the band of the arms.
    kappa : float
        :math:`S/s^2`: so many samples say the same thing.
    terms : NuisanceTerms
        Priors of private columns; the others are free.
    model : GeneralizedMaxwell
        The solid whose force is late, and whose size the depth decides.
    delay, size : float
        Standard deviations of the delay, s, and of the relative size of the force.
    certain : DataBlock
        The test without the columns for errors of the motion.
    misfit : float
        Residual sum of squares of the fit over every sample, in units of the noise.
    thermal_shift : ThermalShift or None
        Shift of the sought solid to the temperature of the test.
    unmeasured_effects : UnmeasuredEffects or None
        Unmeasured effects without a separate column.
    drift : Prior
        As the fit that is asked about held it, N/s; `terms` are those of the doubtful rig.
    """

    block: DataBlock
    weight: float
    kappa: float
    terms: NuisanceTerms
    model: GeneralizedMaxwell
    delay: float
    size: float
    certain: DataBlock
    misfit: float
    thermal_shift: ThermalShift | None = None
    unmeasured_effects: UnmeasuredEffects | None = None
    drift: Prior = EXACT_PRIOR

    @property
    def window(self) -> tuple[float, float]:
        """Shortest and longest relaxation time, at the reference, that the test could show, s."""
        low, high = self.block.window
        a_t = 1.0 if self.thermal_shift is None else self.thermal_shift.a_t
        return low / a_t, high / a_t

    @property
    def on_a_named_rig(self) -> RelaxationData:
        """The data if machine, crosshead and rest were known, the drift to a fifth of its doubt."""
        mean, sd = self.terms.priors["drift"]
        terms = self.terms.add_terms(drift=Prior(mean, NAMED_DRIFT_RATIO * sd))
        effects = self.unmeasured_effects and self.unmeasured_effects.exclude(
            "give", "settling", "memory"
        )
        return replace(self, unmeasured_effects=effects, terms=terms)

    @property
    def floor(self) -> float:
        """Weighted sum of squares that no model can remove."""
        return self.weight**2 * self.block.floor

    @property
    def samples(self) -> float:
        """Effective number of samples."""
        return self.block.samples / self.kappa

    def build_weighted_block(self, index: int) -> DataBlock:
        """The certain block in rows of unit noise; `index` shows private columns of tests apart."""
        names = (n if n in SOLID_PARAMETERS else f"{n}@{index}" for n in self.certain.fixed_names)
        block = self.certain.scale_rows(self.weight, tuple(names))
        thermal_shift = self.thermal_shift
        if thermal_shift is None:
            return block
        return block.map_relaxation_times(
            thermal_shift.log_tau,
            float(np.exp(thermal_shift.log_b)),
            stretch=thermal_shift.stretch,
            window=self.window,
        )

    def rows(
        self,
        log_tau: FloatArray,
        *,
        with_slopes: bool = True,
        extra_priors: Mapping[str, Prior] = MappingProxyType({}),
    ) -> RelaxationRows:
        """Rows that depend on the solid, whitened for the effects of the rig.

        Except for `extra_priors`, by the kind of column: each is a column of `rig_rows`, times its
        standard deviation.
        """
        count, kinds = len(log_tau), [get_column_kind(name) for name in self.block.fixed_names]
        shortest = np.log(DASHPOT_TAU_RATIO * self.block.window[0])
        shift = self.thermal_shift or ThermalShift()
        doubtful = shift.shift_sd > 0
        effects, span = self.unmeasured_effects, slice(count, count + self.model.arms)
        effect_log_tau = np.zeros(0) if effects is None else effects.log_tau
        evaluation = self.block.evaluate(
            np.concatenate(
                (shift.log_tau(log_tau), np.log(self.model.tau), effect_log_tau, [shortest])
            ),
            with_slopes or doubtful,
        )
        spring = evaluation.fixed[:, kinds.index("k_inf")]
        fast_column = evaluation.arms[:, -1] / np.exp(shortest)
        of_answer = _build_delay_columns(self.model, spring, fast_column, evaluation.arms[:, span])
        columns, mean = self.terms.build_prior_columns(evaluation.fixed, self.block.fixed_names)
        if effects is not None:
            columns = np.hstack(
                (columns, effects.columns(evaluation.fixed, evaluation.arms[:, span.stop : -1]))
            )
        of_shift = (
            shift.compute_shift_columns(self.model, evaluation.d_arms[:, span])
            if doubtful
            else columns[:, :0]
        )
        b_t = float(np.exp(shift.log_b))
        known_kinds = {*SOLID_PARAMETERS, *self.terms.priors, *extra_priors}
        is_free = [kind not in known_kinds for kind in kinds]
        differences = replace(self.terms, priors=extra_priors).build_prior_columns(
            evaluation.fixed, self.block.fixed_names
        )[0]
        all_columns = np.column_stack((columns, of_shift, of_answer * (self.delay, self.size)))
        white = marginalise(evaluation.fixed[:, is_free], self.weight * all_columns)
        dashpot = evaluation.fixed[:, kinds.index("b")] if "b" in kinds else fast_column
        return RelaxationRows(
            target=white(self.weight * (evaluation.target - mean)),
            spring=white(self.weight * b_t * spring),
            dashpot=white(self.weight * shift.a_t * b_t * dashpot),
            arms=white(self.weight * b_t * evaluation.arms[:, :count]),
            slopes=white(self.weight * b_t * shift.stretch * evaluation.d_arms[:, :count]),
            rig_rows=white(self.weight * differences),
        )

    def compute_rig_gradient(self, solid: Solid) -> FloatArray:
        r"""Return the gradient of each uncertainty of the rig on a solid, J'c, shape (p + 1, d).

        Of data that are claimed, each doubt with a column c; J excludes the fit's priors of offset,
        drift, delay and motion. The solid's parameters are k_inf, every k, every ln tau, or those
        of a fractional solid, then b; N/m, s and N s/m.
        """
        model, priors, fitted_drift = solid.maxwell, dict(self.terms.priors), self.drift
        # a seal that warms is sought where several temperatures were fitted
        kinds = (
            "give",
            "settling",
            "preload",
            "memory",
            *(("warming",) if self.thermal_shift is None else ()),
        )
        rig_priors = {kind: priors.pop(kind) for kind in kinds if kind in priors}
        if "drift" in priors:
            rig_priors["drift"], priors["drift"] = (
                priors["drift"].compute_remainder(fitted_drift),
                fitted_drift,
            )
        values, arms = np.unique(
            np.clip(np.log(model.tau), *np.log(self.window)), return_inverse=True
        )
        without_rig = replace(self, terms=replace(self.terms, priors=priors))
        rows = without_rig.rows(values, extra_priors=rig_priors)
        columns = np.column_stack((rows.spring, rows.arms[:, arms], rows.slopes[:, arms] * model.k))
        if isinstance(solid, FractionalZener):
            columns = columns @ solid.arm_gradient()
        return np.asarray(np.column_stack((columns, rows.dashpot)).T @ rows.rig_rows)


def _build_delay_columns(
    model: GeneralizedMaxwell, spring: FloatArray, dashpot: FloatArray, arms: FloatArray
) -> FloatArray:
    """Return columns of a late force, -dF/dt, and of the force itself, shape (n, 2)."""
    k, tau = np.asarray(model.k), np.asarray(model.tau)
    delayed = arms @ (k / tau) - (model.k_inf + k.sum()) * dashpot
    return np.column_stack((delayed, model.k_inf * spring + arms @ k))


def misfits(relaxations: Sequence[RelaxationData]) -> tuple[float, float]:
    """Return the misfit of each test, and the part that no model can remove."""
    return sum(relaxation.misfit for relaxation in relaxations), sum(
        relaxation.floor for relaxation in relaxations
    )
