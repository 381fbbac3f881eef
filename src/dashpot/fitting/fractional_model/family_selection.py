"""Selection between a fractional solid and Maxwell arms for the same data."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import FitError
from dashpot.base.plain_text import sentence
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Alternative, OrderScore
from dashpot.datamodel.parameter_estimate import ELEMENT_PARAMETERS, Profile
from dashpot.fitting.data_blocks import FitData, build_solid
from dashpot.fitting.fractional_model.checks import (
    MAX_HEARD_FREQUENCY,
    MIN_LOSS_DIFFERENCE,
    MIN_STIFFNESS_DIFFERENCE,
    fractional_model_suffices,
    fractional_slope_determined,
    model_families_distinguished,
)
from dashpot.fitting.order_selection import SelectedModel
from dashpot.fitting.parameter_errors import estimate_covariance, rounding_rms
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit import Jacobian, Solution
from dashpot.numerics.inference.model_order import bic, deviance, is_significant_fall
from dashpot.numerics.least_squares import (
    Optimum,
    Parameter,
    Problem,
    Rows,
    require_optimum,
    triangle,
)
from dashpot.numerics.log_tau_descent import Stack
from dashpot.solids.fractional import FractionalZener, Weights, compute_arm_weights
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

# The best fractional element in a stack of blocks, without a guess.
#
# At fixed relaxation times tau_i, even in ln tau, the column of an element is a sum of columns of
# arms (:func:`~dashpot.solids.fractional.compute_arm_weights`),
#
# .. math:: c(\tau, \alpha) = \sum_i w(\ln\tau_i - \ln\tau;\, \alpha)\, \varphi(\tau_i)
#
# so the rows of a stack are asked once, and any trial of tau and alpha is a product with weights.


# Step in ln tau of the columns, and their range outside the window of the data: an arm beyond it
# acts as a spring or not at all.
GRID_STEP, GRID_MARGIN = 0.2, float(np.log(1e3))
# slopes between which elements are sought: nearly a spring, and nearly an arm
ALPHA_RANGE = (0.05, 0.92)
# relaxation times are sought this far beyond the window
TAU_MARGIN = float(np.log(100.0))
_START_SLOPES, _STARTS_PER_FOLD = (0.2, 0.4, 0.6, 0.8), 1.0
_STARTS = 3
# sizes of steps of ln tau and alpha
_STEP_SIZES = (1.0, 0.13)
# columns evaluated on every sample at once
_COLUMNS_PER_BATCH = 16


class ArmColumns:
    """Reduced rows of a stack, with columns of arms at fixed relaxation times."""

    def __init__(self, blocks: Sequence[DataBlock]) -> None:
        self.stack = stack = Stack(blocks)
        low, high = stack.bounds
        count = int(np.ceil((high - low + 2 * GRID_MARGIN) / GRID_STEP))
        self.log_tau = low - GRID_MARGIN + GRID_STEP * np.arange(count + 1.0)
        rows = stack.evaluate(self.log_tau, derivative=False)
        factor = triangle(rows.columns)
        q = len(stack.names)
        self.fixed, self.arms, self.target = factor[:, :q], factor[:, q:-1], factor[:, -1]
        self.restricted = stack.get_nonnegative_mask(1, signed=False)
        self.bounds = (
            np.array([low - TAU_MARGIN, ALPHA_RANGE[0]]),
            np.array([high + TAU_MARGIN, ALPHA_RANGE[1]]),
        )

    def weights(self, element: FloatArray) -> Weights:
        """Return weights of the equivalent arms of an element."""
        return compute_arm_weights(self.log_tau - element[0], float(element[1]))

    @cached_property
    def problem(self) -> Problem:
        """The rows at ln tau and alpha; beta is the fixed coefficients, then k, N/m."""
        low, high = self.bounds

        def model(theta: FloatArray) -> Rows:
            column, *by = (self.arms @ weight for weight in self.weights(theta))
            A = np.concatenate((self.fixed, column[:, None]), axis=1)
            return Rows(self.target, A, lambda beta: beta[-1] * np.column_stack(by))

        return Problem(model, [*map(Parameter, low, high, _STEP_SIZES)], self.restricted)

    def best(self) -> Optimum:
        """Return the element with the smallest residual, from the best of a grid of starts."""
        return require_optimum(
            self.problem, [start_theta.theta for start_theta in self.starts(_STARTS)]
        )

    def starts(self, count: int) -> list[Optimum]:
        """Return the best points of a grid, no two of nearly the same relaxation time."""
        low, high = self.bounds
        times = np.arange(low[0], high[0], 1 / _STARTS_PER_FOLD)
        grid_optima = [
            self.problem.solve_linear(np.array([t, slope]))
            for t in times
            for slope in _START_SLOPES
        ]
        optima: list[Optimum] = []
        for grid_optimum in sorted(grid_optima, key=lambda optimum: optimum.cost):
            if all(
                abs(grid_optimum.theta[0] - optimum.theta[0]) > 2 / _STARTS_PER_FOLD
                for optimum in optima
            ):
                optima.append(grid_optimum)
            if len(optima) == count:
                break
        return optima

    def solution(self, best: Optimum) -> Solution:
        """Return an element as its equivalent arms, in the parameters of the engine."""
        arms = best.beta[-1] * self.weights(best.theta).value
        low, high = self.bounds
        # an edge of tau or of alpha is one of all its arms
        is_at_edge = bool(((best.theta <= low + 1e-9) | (best.theta >= high - 1e-9)).any())
        return Solution(
            log_tau=self.log_tau,
            groups=self.stack.groups,
            arms=arms[None],
            fixed_names=self.stack.names,
            fixed=best.beta[:-1],
            sse=self.stack.floor + best.sse,
            samples=self.stack.samples,
            requested_arms=len(arms),
            evaluations=0,
            converged=best.stationary and not is_at_edge,
            relative_offset=0.0 if best.stationary else 1.0,
            at_bound=np.full(len(arms), is_at_edge),
            bounds=self.stack.bounds,
        )


def fractional_jacobian(
    blocks: Sequence[DataBlock], columns: ArmColumns, best: Optimum
) -> Jacobian:
    """Residual and derivative by fixed coefficients, k, ln tau and alpha, in the blocks' rows."""
    stack, weights = Stack(blocks), columns.weights(best.theta)
    matrix = np.stack(weights, axis=1)
    values = None
    for first in range(0, len(columns.log_tau), _COLUMNS_PER_BATCH):
        part = slice(first, first + _COLUMNS_PER_BATCH)
        rows = stack.evaluate(columns.log_tau[part], derivative=False)
        q = len(stack.names)
        if values is None:
            target, fixed = rows.target, rows.phi[:, :q]
            values = np.zeros((len(target), 3))
        values += rows.phi[:, q:] @ matrix[part]
    assert values is not None  # noqa: S101  # a window holds times
    jacobian = np.concatenate((fixed, values * [1.0, best.beta[-1], best.beta[-1]]), axis=1)
    model = jacobian[:, : q + 1] @ best.beta
    return Jacobian((*stack.names, "k", "ln_tau", "alpha"), jacobian, target - model)


# The fractional solid of some data beside their arms: which to take, and where the two part.
#
# A fractional Zener solid has three parameters and a spring, arms two each. Both families are
# solved on the same rows with the same nuisance terms, and BIC with the effective number of
# residuals decides; arms keep their place unless it falls by more than 10, which is very strong
# evidence (R. E. Kass and A. E. Raftery, *J. Am. Stat. Assoc.* 90, 1995). Where the residuals of
# the other are within what chance allows, it is kept: the two may part where no test has looked.


# Decrease of BIC below which the generalized Maxwell model is kept.
DECISIVE_FAMILY_BIC = 10.0
#: what distinguishes two families that explain ramps and holds, and sweeps
FAMILY_ADVICE = "A faster ramp, a colder test or a hammer test"
# lines per decade on which two solids are compared
_LINES_PER_DECADE = 40


@dataclass(frozen=True, eq=False)
class FractionalFit(SelectedModel):
    """Best fractional solid of some data, with its uncertainty.

    Attributes
    ----------
    optimum : Optimum
        Theta are ln tau and alpha, beta the fixed coefficients and the stiffness of the element,
        N/m; `solution` holds it as arms, even in ln tau.
    """

    optimum: Optimum

    @property
    def k(self) -> float:
        """Stiffness of the element, N/m."""
        return float(self.optimum.beta[-1])

    @cached_property
    def solid(self) -> FractionalZener:
        """The solid of the optimum."""
        fixed = dict(zip(self.solution.fixed_names, self.optimum.beta[:-1].tolist(), strict=True))
        k_inf = max(fixed["k_inf"], 0.0)
        log_tau, alpha = self.optimum.theta.tolist()
        return FractionalZener(
            k_inf + self.k,
            k_inf,
            float(np.exp(log_tau)),
            alpha,
            max(fixed.get("b", 0.0), 0.0),
        )

    @cached_property
    def model(self) -> GeneralizedMaxwell:
        """Equivalent arms."""
        return self.solid.maxwell

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the solid's parameters."""
        return (
            (*ELEMENT_PARAMETERS, "b") if "b" in self.solution.fixed_names else ELEMENT_PARAMETERS
        )

    @cached_property
    def covariance(self) -> FloatArray:
        """Return the covariance of k_inf, k_0, ln tau, alpha and b; k_0 sums both springs."""
        names = ["k_inf", "k", "ln_tau", "alpha", *(["b"] if "b" in self.parameters else [])]
        rows = [self.estimate.names.index(name) for name in names]
        covariance = self.estimate.covariance[np.ix_(rows, rows)]
        if not np.isfinite(covariance).all():
            return np.diag(np.full(len(rows), np.inf))
        transform = np.eye(len(rows))
        transform[1, 0] = 1.0
        return np.asarray(transform @ covariance @ transform.T)

    @property
    def is_at_edge(self) -> bool:
        """Whether slope or relaxation time is at an end of its range."""
        return bool(self.solution.at_bound.any())

    def profiles(self, *, in_order_of_time: bool) -> tuple[Profile, ...]:  # noqa: ARG002
        """None: its errors are even."""
        return ()

    @property
    def orders(self) -> tuple[OrderScore, ...]:
        """None: there is one element."""
        return ()

    @property
    def stiffnesses(self) -> dict[str, float]:
        """Stiffnesses that an error of the depth scales, by their rows."""
        return {"k_inf": self.solid.k_inf, "k": self.k}


def fit_fractional(data: FitData) -> FractionalFit:
    """Return the best fractional solid; the weight of the priors follows the noise.

    Raises
    ------
    FitError
        If the data have fewer samples than parameters.
    """
    columns = ArmColumns(data.rows)
    unknown = len(columns.stack.names) + 3
    if columns.stack.samples + columns.stack.known <= unknown:
        raise FitError(
            f"{columns.stack.samples} samples cannot determine the {unknown} parameters of a "
            "fractional solid; use a longer record"
        )
    best = columns.best()
    estimate = estimate_covariance(
        columns.solution(best),
        data.samples,
        peak=data.peak,
        priors=data.priors,
        encoders=data.encoders,
        jacobian=fractional_jacobian(data.full_rows, columns, best),
    )
    return FractionalFit(data, estimate, (), None, None, best)


# -- Comparison with the generalized Maxwell model ------------------------------------------------


class AlternativeFamily(NamedTuple):
    """Family that was not selected.

    Attributes
    ----------
    solid : Solid
        Its best; of arms, the fewest that explain the data, if any do.
    residual : float
        Residual standard deviation of the selected family over that of this one.
    bic : float
        BIC less that of the selected family.
    is_sufficient : bool
        The residuals may be due to chance, or BIC does not distinguish the two.
    """

    solid: Solid
    residual: float
    bic: float
    is_sufficient: bool


@dataclass(frozen=True, eq=False)
class FamilySelection:
    """Selected family, and the alternative.

    Attributes
    ----------
    best : SelectedModel
    arms : SelectedModel
        The solid with arms, taken or not.
    other_family : AlternativeFamily or None
        None if only arms were requested.
    """

    best: SelectedModel
    arms: SelectedModel
    other_family: AlternativeFamily | None = None

    def alternative(
        self, band: tuple[float, float], extra: str = FAMILY_ADVICE
    ) -> Alternative | None:
        """Return the other family, as a fit keeps it; `band` is the valid band of the data, Hz."""
        if self.other_family is None:
            return None
        solid, _, bic_difference, explains = self.other_family
        return build_alternative(
            self.best.solid, solid, bic_difference, band, is_sufficient=explains, extra=extra
        )

    def checks(self, alternative: Alternative | None) -> tuple[Check, ...]:
        """Return the checks of a solid that was selected against another family."""
        if self.other_family is None:
            return ()
        check = model_families_distinguished(alternative)
        if not isinstance(self.best, FractionalFit):
            return (check,)
        error = float(self.best.error[ELEMENT_PARAMETERS.index("alpha")])
        return (
            fractional_slope_determined(error, edge=self.best.is_at_edge),
            fractional_model_suffices(
                self.other_family.residual, self.other_family.solid.maxwell.arms
            ),
            check,
        )


class _Contender(NamedTuple):
    """One solid of a family: its sum of squared residuals, N^2, and its number of parameters."""

    family: SelectedModel
    solid: Solid
    sse: float
    parameters: int


def select_family(
    arms: SelectedModel, family: str, fit: FractionalFit | None = None
) -> FamilySelection:
    """Return the requested family, or with ``"auto"`` the one that BIC prefers, and the other one.

    `fit` is the fractional solid of the same data, if already known.
    """
    if family == "maxwell":
        return FamilySelection(arms, arms)
    fit = fit or fit_fractional(arms.data)
    lowest_selection = min(arms, fit, key=lambda selection: selection.solution.sse)
    effective = lowest_selection.estimate.effective
    rounding_sse = arms.solution.samples * rounding_rms(arms.data.peak) ** 2

    def criterion(contender: _Contender) -> float:
        return bic(
            contender.sse,
            effective=effective,
            parameters=contender.parameters,
            rounding_sse=rounding_sse,
        )

    def is_as_good(contender: _Contender, best: _Contender) -> bool:
        value, lowest_deviance = (
            deviance(candidate_fit.sse, effective=effective, rounding_sse=rounding_sse)
            for candidate_fit in (contender, best)
        )
        return not is_significant_fall(
            value - lowest_deviance, max(best.parameters - contender.parameters, 1)
        )

    def spread(contender: _Contender) -> float:
        # many arms leave less of few samples by chance alone
        return (contender.sse + rounding_sse) / max(effective - contender.parameters, 1.0)

    maxwell_candidate, arm_solutions = _candidate(fit), _list_orders(arms)
    selected = arm_solutions[0]
    is_better = (
        criterion(maxwell_candidate) + DECISIVE_FAMILY_BIC < criterion(selected)
        and not fit.is_at_edge
    )
    best, contenders = (
        (maxwell_candidate, arm_solutions)
        if is_better or family == "fractional"
        else (selected, [maxwell_candidate])
    )
    bic_limit = criterion(best) + DECISIVE_FAMILY_BIC
    explain = [
        rival for rival in contenders if criterion(rival) < bic_limit or is_as_good(rival, best)
    ]
    rival = (explain or contenders)[0]
    return FamilySelection(
        best.family,
        arms,
        AlternativeFamily(
            rival.solid,
            residual=float(np.sqrt(spread(best) / spread(rival))),
            bic=criterion(rival) - criterion(best),
            is_sufficient=bool(explain),
        ),
    )


def _candidate(selection: SelectedModel) -> _Contender:
    return _Contender(
        selection, selection.solid, selection.solution.sse, len(selection.estimate.names)
    )


def _list_orders(arms: SelectedModel) -> list[_Contender]:
    """Return the number of arms that was taken, and the larger ones that were tried."""
    contender = _candidate(arms)
    larger_solutions = [
        score.solution for score in arms.scores if score.solution.order > arms.solution.order
    ]
    count = 1 + len(arms.solution.groups)
    return [
        contender,
        *(
            _Contender(
                arms,
                build_solid(solution),
                solution.sse,
                contender.parameters + count * (solution.order - arms.solution.order),
            )
            for solution in larger_solutions
        ),
    ]


def add_linear_alternative(
    nonlinear_fit: Fit, residuals: Sequence[FloatArray], fit: FractionalFit
) -> Fit:
    """Return a nonlinear fit with a linear fractional solid as its alternative.

    Parameters
    ----------
    nonlinear_fit : Fit
    residuals : sequence of array
        Residuals of each test, up to the end of the hold, N.
    fit : FractionalFit
        Fit of the same tests.
    """
    pairs = [
        (
            residual[-min(len(residual), len(linear_residual)) :],
            linear_residual[-min(len(residual), len(linear_residual)) :],
        )
        for residual, linear_residual in zip(residuals, fit.estimate.residuals, strict=True)
    ]
    sse = np.array(
        [[residual_part @ residual_part for residual_part in pair] for pair in pairs]
    ).sum(axis=0)
    effective = fit.estimate.effective
    own_sse, other_sse = sse.tolist()
    deviance_fall = deviance(other_sse, effective=effective) - deviance(
        own_sse, effective=effective
    )
    law = nonlinear_fit.elastic_law
    parameters = (
        len(nonlinear_fit.estimate.parameters)
        + len(nonlinear_fit.estimate.nuisance)
        + (len(law.knots) if law else 0)
    )
    bic_difference = deviance_fall + (len(fit.estimate.names) - parameters) * float(
        np.log(effective)
    )
    explains = bic_difference < DECISIVE_FAMILY_BIC or not is_significant_fall(deviance_fall, 1)
    linear_alternative = build_alternative(
        nonlinear_fit.solid,
        fit.solid,
        bic_difference,
        nonlinear_fit.band,
        is_sufficient=explains,
        extra=FAMILY_ADVICE,
    )
    checks = (*nonlinear_fit.checks, model_families_distinguished(linear_alternative))
    return replace(
        nonlinear_fit,
        evidence=replace(nonlinear_fit.evidence, alternative=linear_alternative, checks=checks),
    )


def describe_fit(selection: SelectedModel) -> str:
    """Return a description of the fitted solid."""
    if isinstance(selection, FractionalFit):
        return "a fractional Zener model"
    arms = selection.model.arms
    return f"a generalized Maxwell model with {arms} arm{'s' * (arms != 1)}"


def divergence_frequency(first: Solid, second: Solid, band: tuple[float, float]) -> float | None:
    """Return the lowest frequency, Hz, at which two solids differ materially, if any.

    Frequencies from the middle of the valid `band`, Hz, to where parts vibrate.
    """
    # the slow half of what the data inform is of the end of the hold, not of vibration
    low, high = max(float(np.sqrt(band[0] * band[1])), 1e-6), max(10 * band[1], MAX_HEARD_FREQUENCY)
    count = int(np.ceil(_LINES_PER_DECADE * np.log10(high / low))) + 1
    f = np.geomspace(low, high, count)
    indices = np.flatnonzero(_find_disagreement(first, second, f))
    return float(f[indices[0]]) if indices.size else None


def _find_disagreement(first: Solid, other_solid: Solid, f: FloatArray) -> FloatArray:
    """Return at which of the frequencies, Hz, two solids differ noticeably."""
    a, b = (solid.complex_stiffness(omega=2 * np.pi * f) for solid in (first, other_solid))
    loss = np.array([a.imag / a.real, b.imag / b.real])
    # the damping of anything that is mounted is hardly ever below a hundredth
    of_loss = np.abs(np.diff(loss, axis=0)[0]) / np.maximum(loss.max(axis=0), 2e-2)
    return np.asarray(
        (np.abs(a.real / b.real - 1) > MIN_STIFFNESS_DIFFERENCE) | (of_loss > MIN_LOSS_DIFFERENCE)
    )


def build_alternative(
    own_solid: Solid,
    other_solid: Solid,
    bic_difference: float,
    band: tuple[float, float],
    *,
    is_sufficient: bool,
    extra: str,
) -> Alternative:
    """Return another family's solid as a fit keeps it, in numbers that no count of seals changes.

    Parameters
    ----------
    own_solid, other_solid : Solid
    bic_difference : float
        BIC of the other, less that of the fit's own.
    band : (float, float)
        Valid band of the data, Hz.
    is_sufficient : bool
        The data do not reject the other.
    extra : str
        Test that would distinguish the two.
    """
    frequency = divergence_frequency(own_solid, other_solid, band)
    if isinstance(other_solid, FractionalZener):
        name = f"a fractional model (alpha = {other_solid.alpha:.3g})"
    else:
        arms = other_solid.maxwell.arms
        name = f"a solid with {arms} arm{'s' * (arms != 1)}"
    both_text = f"{name} explains the data too (BIC {bic_difference:+.3g})"
    if not is_sufficient:
        message = f"{name} does not explain the data; its BIC is {bic_difference:.3g} higher"
    elif frequency is None:
        message = f"{both_text}. It predicts the same up to {MAX_HEARD_FREQUENCY:g} Hz"
    else:
        decade = max(10.0, 10.0 ** np.ceil(np.log10(frequency)))
        a, b = (
            complex(solid.complex_stiffness(omega=2 * np.pi * decade))
            for solid in (own_solid, other_solid)
        )
        advice = sentence(f"{extra} separates them")
        message = (
            f"{both_text}. From {frequency:.2g} Hz on the two differ: at {decade:g} Hz the loss "
            f"factor is {a.imag / a.real:.3g} by this model and {b.imag / b.real:.3g} by the "
            f"other, the stiffness {100 * (b.real / a.real - 1):+.2g} %. {advice}"
        )
    return Alternative(other_solid, bic_difference, is_sufficient, frequency, sentence(message))
