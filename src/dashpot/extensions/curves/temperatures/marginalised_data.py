r"""Data of one test at one temperature, with its own nuisance terms eliminated.

At the temperature T the solid of the reference answers with every relaxation time times
:math:`a_T` and every stiffness times :math:`b_T`, so that a test is the same data at other
relaxation times,

.. math:: F_T(t) = b_T \Bigl[k_\infty x + \sum_j k_j\, q(t; a_T \tau_j)\Bigr]
    + F_0 + \dot F t - \delta\,\dot F_T + \theta\,\partial_\theta F_T

Offset, drift and delay are those of :mod:`dashpot.fitting.nuisance_priors`. The last term is a seal
that warms by :math:`\theta` over the record: it answers in reduced time :math:`\int dt/a(T(t))`.
What is known of the four beforehand makes them a part of the noise, whose rows are whitened for it.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.shift_factors import shifted_log_tau
from dashpot.fitting.data_blocks import InitialFit, first_sample, motion
from dashpot.fitting.nuisance_priors import (
    NuisanceTerms,
    build_load_cell_priors,
    build_nuisance_terms,
    build_recorded_warming_prior,
    get_column_kind,
)
from dashpot.fitting.relaxation_likelihood import compute_unmeasured_effects, select_motion_samples
from dashpot.numerics.design_matrices.block import DataBlock, Evaluation
from dashpot.numerics.design_matrices.data_compression import compact_block
from dashpot.numerics.inference.correlated_noise import marginalise
from dashpot.signals.disturbances import compute_warming
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

# Factor outside the window of a record up to which relaxation times are in the grid.
TAU_MARGIN = 1e4
WARMING_NAME = "warming@0"
# relaxation times that stand for all, and the weakest direction that their columns know of
_COLUMNS, _MIN_DIRECTION = 240, 5e-6


@dataclass(frozen=True, eq=False)
class SingleTemperatureTest:
    """Single test: its data, and the result of its own free fit.

    Attributes
    ----------
    record : RampHold
    temperature : float
        K.
    block_without_warming : DataBlock
        The data, with the columns of its load cell and of its clock.
    spread : float
        Standard deviation of one independent residual, N.
    effective : float
        Independent residuals.
    chi_square : float
        What the free fit leaves, in units of the noise.
    parameters : int
        Parameters of the solid of that fit.
    law : ElasticLaw or None
        Where its ramp is not linear: the hold alone is then fitted, after this path.
    warming : array or None
        The column of a seal that warms by one kelvin over the record, N/K.
    """

    record: RampHold
    temperature: float
    block_without_warming: DataBlock
    spread: float
    effective: float
    chi_square: float
    parameters: int
    law: ElasticLaw | None = None
    warming: FloatArray | None = None

    @classmethod
    def from_first_fit(
        cls, record: RampHold, temperature: float, first: InitialFit, law: ElasticLaw | None
    ) -> SingleTemperatureTest:
        """Return the test with the nuisances of its own free fit."""
        noise, best = first.noises[0], first.solutions[-1]
        block = first.data.blocks[0]
        rounding_power = block.rounding_floor / noise.samples
        noise_sd = float(np.sqrt(max(noise.power, rounding_power, 1e-300)))
        return cls(
            record,
            temperature,
            block,
            noise_sd,
            noise.effective,
            float(best.sse) / noise_sd**2,
            1 + 2 * best.order,
            law,
        )

    @cached_property
    def block(self) -> DataBlock:
        """The data with every column that is the test's own."""
        if self.warming is None:
            return self.block_without_warming
        return self.block_without_warming.with_column(WARMING_NAME, self.warming)

    @cached_property
    def terms(self) -> NuisanceTerms:
        """Nuisance terms of the test's own columns."""
        return build_nuisance_terms(self.record).add_terms(
            warming=build_recorded_warming_prior(self.record.specimen)
        )

    @property
    def nuisance_columns(self) -> list[int]:
        """Indices of the fixed columns that are the test's own."""
        return [i for i, name in enumerate(self.block.fixed_names) if name != "k_inf"]

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of the columns: ``"offset"``, ``"drift"``, ``"delay"``, ``"warming"``."""
        return tuple(get_column_kind(self.block.fixed_names[i]) for i in self.nuisance_columns)

    @cached_property
    def prior_rows(self) -> tuple[FloatArray, FloatArray]:
        """Priors of the test's own columns as rows of unit noise, with their targets."""
        prior = self.terms.build_rows(self.block, self.spread)
        evaluation, unit = prior.evaluate(np.zeros(0), False), float(np.sqrt(prior.variance or 1.0))
        return evaluation.fixed / unit, evaluation.target / unit

    @cached_property
    def marginal(self) -> DataBlock:
        """The data in a few rows of unit noise, its own columns projected out."""
        return _marginalise_test(self)

    @property
    def path(self) -> tuple[FloatArray, FloatArray]:
        """Time and compression as a linear solid answers it, up to the end of the hold."""
        time, x, _ = motion(self.record)
        return time, x if self.law is None else self.law.path(x)

    @property
    def start(self) -> int:
        """The first sample that is fitted."""
        return first_sample(self.record) if self.law is None else self.record.settled_samples.start

    def add_warming_column(
        self, solid: GeneralizedMaxwell, *, by_a: float, by_b: float
    ) -> SingleTemperatureTest:
        """Return the test with the column of a seal that warms while it is recorded.

        Parameters
        ----------
        solid : GeneralizedMaxwell
            At the temperature of the test.
        by_a, by_b : float
            Slopes of ln a_T and of ln b_T there, 1/K.
        """
        time, x = self.path
        column = compute_warming(time, x, solid, by_a=by_a, by_b=by_b)
        return replace(self, warming=column[self.start :])

    def unmeasured_effects(self, solid: GeneralizedMaxwell) -> FloatArray:
        """Return forces that the rig may add and no column fits, N, one SD each, (n, d).

        Of the drift, what the fit holds to be less than it may be. `solid` is that at the
        temperature of the test.
        """
        (time, x), cell_priors = self.path, build_load_cell_priors(self.record)
        samples = select_motion_samples(self.record, time)
        effects = compute_unmeasured_effects(self.record, time[samples], x[samples], solid)
        # it is sought
        del effects["warming"]
        columns = [sd * np.interp(time, time[samples], column) for column, sd in effects.values()]
        columns.append(
            cell_priors.limit_drift.compute_remainder(cell_priors.drift).sd
            * (time - cell_priors.offset_time)
        )
        return np.column_stack(columns)[self.start :]


class _Basis(NamedTuple):
    """Rows of unit noise that hold whatever a solid and the test's own columns can do.

    Attributes
    ----------
    turn : array, shape (d, n)
        From the rows of the compressed block.
    target, fixed : arrays, shapes (d,) and (d, q)
    floor : float
        Sum of squares beside them.
    """

    turn: FloatArray
    target: FloatArray
    fixed: FloatArray
    floor: float


def _compute_basis(compact: DataBlock, noise_sd: float) -> _Basis:
    low, high = compact.bounds
    log_tau_grid = np.linspace(low - np.log(TAU_MARGIN), high + np.log(TAU_MARGIN), _COLUMNS)
    evaluation = compact.evaluate(log_tau_grid, False)
    columns = np.concatenate((evaluation.fixed, evaluation.arms), axis=1)
    column_norms = np.linalg.norm(columns, axis=0)
    left_vectors, strength, _ = np.linalg.svd(
        columns / np.where(column_norms > 0, column_norms, 1.0), full_matrices=False
    )
    rotation = left_vectors[:, strength > _MIN_DIRECTION * strength[0]].T / noise_sd
    target, full_target = rotation @ evaluation.target, evaluation.target / noise_sd
    remainder_sse = float(full_target @ full_target - target @ target) + compact.floor / noise_sd**2
    return _Basis(rotation, target, rotation @ evaluation.fixed, max(remainder_sse, 0.0))


def _marginalise_test(test: SingleTemperatureTest) -> DataBlock:
    compact = compact_block(test.block, excess=TAU_MARGIN)
    basis, names = _compute_basis(compact, test.spread), compact.fixed_names
    prior_columns, mean = test.terms.build_prior_columns(basis.fixed, names)
    white = marginalise(basis.fixed[:, :0], prior_columns)
    data, residual = white(basis.turn), white(basis.target - mean)
    stiffness_column = white(basis.fixed[:, [names.index("k_inf")]])

    def evaluate_block(log_tau: FloatArray, derivative: bool) -> Evaluation:
        evaluation = compact.evaluate(log_tau, derivative)
        arms = data @ evaluation.arms
        return Evaluation(
            residual, stiffness_column, arms, data @ evaluation.d_arms if derivative else arms
        )

    return replace(
        compact, rows=evaluate_block, fixed_names=("k_inf",), floor=basis.floor, arm_group="k"
    )


def shift_block(block: DataBlock, log_a: float, log_b: float, slope: float = 0.0) -> DataBlock:
    """The data of another temperature as those of the reference: at other times, other sizes.

    `slope` is how much further each decade of tau shifts.
    """
    low, high = block.window
    a_t = float(np.exp(log_a))
    return block.map_relaxation_times(
        lambda log_tau: shifted_log_tau(log_tau, log_a, slope),
        float(np.exp(log_b)),
        stretch=1 + log_a * slope / float(np.log(10.0)),
        window=(low / a_t, high / a_t),
    )
