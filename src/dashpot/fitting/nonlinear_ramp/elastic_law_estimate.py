"""The elastic law that ramps support as a value, and how well it is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.parameter_estimate import ParameterEstimate, parameter_names
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.fit_construction import nuisances
from dashpot.fitting.nonlinear_ramp.goodness_of_fit import LinearFitQuality
from dashpot.fitting.nonlinear_ramp.hold_then_ramp import HoldEstimate, RampHoldOptimum, independent
from dashpot.fitting.uncertainty.solution_covariance import ParameterCovariance
from dashpot.numerics.design_matrices.recorded_motion import arm_columns
from dashpot.numerics.inference.covariance import noise_of
from dashpot.preprocessing.denoising import denoise_displacement
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

# a law that lowers BIC by less is as good
LEAST_GAIN = 10.0


class KnotSpacing(NamedTuple):
    """A step of the ladder of laws: how many knots, and the power of their spacing."""

    knots: int
    power: int = 1

    def at(self, depth: float) -> FloatArray:
        """The knots down to a depth, m."""
        return np.asarray(depth * np.linspace(0.0, 1.0, self.knots) ** float(self.power))


@dataclass(frozen=True)
class ElasticLawScore:
    """One law of the ladder, fitted.

    Attributes
    ----------
    spacing : KnotSpacing
    elastic_law : ElasticLaw
    bic : float
        Differences count.
    ramp, hold : tuple of float
        Root mean square residual of each record, N.
    """

    spacing: KnotSpacing
    elastic_law: ElasticLaw
    bic: float
    ramp: tuple[float, ...]
    hold: tuple[float, ...]

    @property
    def gap(self) -> float:
        """Largest distance between the law's path and the linear one, as a part of the depth."""
        x = np.linspace(0.0, self.elastic_law.depth, 101)
        return float(np.abs(self.elastic_law.path(x) - x).max()) / self.elastic_law.depth


@dataclass(frozen=True, eq=False)
class RampLaw:
    r"""The elastic law that ramps support, the solid that answers it, and how well both are known.

    Attributes
    ----------
    law : ElasticLaw
    model : GeneralizedMaxwell
        Secant at the depth of the law.
    estimate : ParameterEstimate
        Of the parameters of `model`.
    law_covariance : array, shape (p + P, p + P)
        Of the parameters of `model` and then of the law's shape at its knots.
    hold : Hold
        What the holds say without their ramps.
    soundness : tuple of Soundness
        Of each record under the linear law with the full weight of its ramp.
    followed : Followed
        The optimum of the law, and what it leaves.
    scores : tuple of ElasticLawScore
        The laws tried, the linear one first.
    residuals : tuple of array
        Of every sample from contact to the end of the hold, N.
    """

    law: ElasticLaw
    model: GeneralizedMaxwell
    estimate: ParameterEstimate
    law_covariance: FloatArray
    hold: HoldEstimate
    soundness: tuple[LinearFitQuality, ...]
    followed: RampHoldOptimum
    scores: tuple[ElasticLawScore, ...]
    residuals: tuple[FloatArray, ...]

    @property
    def sound(self) -> bool:
        """True if the linear law explains every record to its noise."""
        return all(quality.sound for quality in self.soundness)

    @property
    def discrepancy(self) -> tuple[float, ...]:
        r"""Scatter of each ramp over that of its hold, :math:`s_r/(s_h \sqrt{\kappa_h})`: >= 1."""
        return tuple(
            float(ramp / held)
            for ramp, held in zip(self.followed.ramp_scatter, independent(self.hold), strict=True)
        )

    @property
    def relative_residuals(self) -> tuple[float, ...]:
        """Residual on each ramp as a part of the largest force."""
        rows = self.followed.weighted.solid.rows
        return tuple(value / rows.peak(i) for i, value in enumerate(self.followed.ramp))

    @property
    def rho(self) -> tuple[float, ...]:
        """Residual of each hold over what the hold alone leaves."""
        return tuple(a / b for a, b in zip(self.followed.hold, self.hold.rms, strict=True))


def build_ramp_law(
    tests: Sequence[RampHold],
    hold: HoldEstimate,
    soundness: tuple[LinearFitQuality, ...],
    optimum: RampHoldOptimum,
    scores: tuple[ElasticLawScore, ...],
) -> RampLaw:
    """Return the value of an optimum, with its covariance and its residuals."""
    k, log_tau, solid = optimum.k[0], optimum.log_tau, optimum.weighted.solid
    order = np.argsort(log_tau)
    there = order[k[1:][order] > 0]
    model = GeneralizedMaxwell(
        float(k[0]), tuple(k[1:][there].tolist()), tuple(np.exp(log_tau[there]).tolist())
    )
    first = len(optimum.optimum.theta)

    def seal(values: FloatArray) -> FloatArray:
        """The solid's parameters, then the law's shape, whose mean is 1."""
        log_tau, shape = solid.split_parameters(values[:first])
        k = values[first : first + 1 + len(log_tau)]
        return np.concatenate(
            (k[:1], k[1 + there], log_tau[there], shape / (solid.weights @ shape))
        )

    # each encoder's step scales every stiffness of its test
    doubt = float(np.sqrt(np.mean([test.depth_doubt**2 for test in tests]) / len(tests)))
    scaled = np.zeros(len(optimum.optimum.values))
    scaled[first : first + len(k)] = doubt * k
    estimate = optimum.estimate(hold).add_parameter_error(scaled)
    covariance, names = estimate.derive_quantity(seal).covariance, parameter_names(len(there))
    nuisance = optimum.nuisance
    errors = dict(zip(nuisance, estimate.standard_error[-len(nuisance) :].tolist(), strict=True))
    residuals = tuple(_residual(test, i, model, optimum) for i, test in enumerate(tests))
    parameter_covariance = ParameterCovariance(
        (), covariance, residuals, tuple(map(noise_of, residuals))
    )
    return RampLaw(
        law=elastic_law_of(optimum),
        model=model,
        estimate=ParameterEstimate(
            names,
            covariance[: len(names), : len(names)],
            dof=max(parameter_covariance.effective - len(scaled), 1.0),
            residual=parameter_covariance.statistics([1.0] * len(tests)),
            nuisance=nuisances([*nuisance], nuisance.__getitem__, errors.__getitem__),
        ),
        law_covariance=covariance,
        hold=hold,
        soundness=soundness,
        followed=optimum,
        scores=scores,
        residuals=residuals,
    )


def _residual(
    test: RampHold, i: int, model: GeneralizedMaxwell, optimum: RampHoldOptimum
) -> FloatArray:
    """Every sample less the model and the load cell."""
    priors = optimum.weighted.solid.rows.known[i]
    path = elastic_law_of(optimum).path(denoise_displacement(test)[0])
    time = test.time[: len(path)] - test.time[0]
    arms = arm_columns(time, path, np.asarray(model.tau), derivative=False)[0]
    values = optimum.nuisance
    force = model.k_inf * path + arms @ np.asarray(model.k)
    force += values[f"offset@{i}"] + values[f"drift@{i}"] * (time - priors.at)
    if f"delay@{i}" in values:
        force -= values[f"delay@{i}"] * np.gradient(force, time)
    return np.asarray((test.force[: len(path)] - force)[priors.first :])


def elastic_law_of(optimum: RampHoldOptimum) -> ElasticLaw:
    """Return the law of an optimum."""
    knots, shape, k_inf = optimum.weighted.solid.knots, optimum.shape, float(optimum.k[0, 0])
    if len(knots) == 2:
        return ElasticLaw.linear(k_inf, float(knots[-1]))
    return ElasticLaw(tuple(knots.tolist()), tuple(shape.tolist()), k_inf)
