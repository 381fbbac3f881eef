"""From compliances to stiffnesses: the optimum of a creep fit, and the solid it stands for."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.fit_diagnostics import OrderScore
from dashpot.datamodel.parameter_estimate import CreepEstimate, Profile
from dashpot.fitting.pipeline import SelectedModel
from dashpot.numerics.exponential_fit.variable_projection import Solution
from dashpot.numerics.inference.covariance_estimate import propagate_covariance
from dashpot.solids.interconversion import (
    CreepSpectrum,
    relaxation_sensitivity,
    relaxation_spectrum,
)
from dashpot.solids.maxwell import GeneralizedMaxwell

GLASS, FLOW = "glass", "flow"
"""Names of the columns of what a part gives at once, and of its flow."""


def spectrum_of(solution: Solution) -> CreepSpectrum:
    """The compliances of a solution; a retardation that it does not show is left out."""
    d = solution.arms[0] if solution.order else np.zeros(0)
    flow = solution.coefficient(FLOW) if FLOW in solution.fixed_names else 0.0
    return CreepSpectrum(
        max(solution.coefficient(GLASS), 0.0),
        tuple(d[d > 0].tolist()),
        tuple(solution.tau[d > 0].tolist()),
        max(flow, 0.0),
    )


def _solid(solution: Solution) -> GeneralizedMaxwell:
    creep = spectrum_of(solution)
    if creep.glass <= 0 and not creep.d and creep.flow <= 0:
        return GeneralizedMaxwell(0.0)
    return GeneralizedMaxwell(*relaxation_spectrum(creep))


@dataclass(frozen=True, eq=False)
class Retarded(SelectedModel):
    """The optimum in compliances, and the solid that it stands for.

    Attributes
    ----------
    alternative : float or None
        How much higher the BIC of the other kind of part is: of one that flows, or of one that
        comes to rest.
    """

    alternative: float | None = None

    @cached_property
    def spectrum(self) -> CreepSpectrum:
        """The compliances."""
        return spectrum_of(self.solution)

    @property
    def flows(self) -> bool:
        """True if the displacement never comes to rest."""
        return self.spectrum.flow > 0

    @cached_property
    def model(self) -> GeneralizedMaxwell:
        """The solid, by exact interconversion."""
        return _solid(self.solution)

    @cached_property
    def creep(self) -> CreepEstimate:
        """Compliances and retardation times with their covariance."""
        named = self.rows_named(GLASS, "d", "ln_lam", FLOW if self.flows else None)
        rows = list(named.values())
        covariance = self.estimate.covariance[np.ix_(rows, rows)]
        return CreepEstimate(self.spectrum, tuple(named), covariance)

    @cached_property
    def _gradient(self) -> dict[str, FloatArray]:
        """How each parameter of the solid moves with those of the creep."""
        model, size = self.model, len(self.creep.parameters)
        sensitivity = relaxation_sensitivity(self.spectrum, model.tau)[:, :size]
        arms = range(1, model.arms + 1)
        names = ("k_inf", *(f"k_{j}" for j in arms), *(f"ln_tau_{j}" for j in arms), "b")
        held = {name for name, value in (("k_inf", model.k_inf), ("b", model.b)) if value == 0}
        return {name: row for name, row in zip(names, sensitivity, strict=True) if name not in held}

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the solid's parameters; k_inf is none of a part that flows."""
        return tuple(self._gradient)

    @cached_property
    def covariance(self) -> FloatArray:
        """Of the solid's parameters, by the derivative of the interconversion."""
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
            for solid in (_solid(score.solution),)
        )

    def profiles(
        self,
        *,
        in_order_of_time: bool,  # noqa: ARG002
        unmeasured: FloatArray | None = None,  # noqa: ARG002
    ) -> tuple[Profile, ...]:
        """None: the intervals are those of the covariance."""
        return ()
