"""Least-squares fits of amplitude laws: Kraus's, a cubic spring, or both."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.option_fields import AmplitudeLaw, get_choice_values
from dashpot.extensions.amplitude.checks import SIGNIFICANT_DEVIANCE
from dashpot.extensions.amplitude.datamodel import AmplitudeSweep
from dashpot.extensions.amplitude.payne_softening import softening_factor
from dashpot.numerics.inference.covariance_estimate import estimate, white_noise
from dashpot.numerics.inference.model_order import bic, deviance
from dashpot.numerics.least_squares import (
    Optimum,
    Parameter,
    Problem,
    Rows,
    require_optimum,
    solve_ordinary,
    stack_real_rows,
)
from dashpot.numerics.nonnegative_least_squares import solve_linear
from dashpot.solids.jenkins import jenkins_reduction

LAWS = get_choice_values(AmplitudeLaw)
"""Kraus's law as a factor or in parallel to the solid, a cubic spring, and both."""
_EXPONENTS = (0.1, 0.95)
DEFAULT_EXPONENT = 0.5
"""The exponent if the data do not determine it."""
_MIN_SCATTER = 3e-3
"""Relative misfit of amplitude laws; only larger scatter counts as noise."""
_PER_DECADE = 10
_RISE_RESIDUALS = 3.0
"""Rise of the storage, in residuals, that shows a stiffening spring in parallel to friction."""
_ROUNDING_POWER = 1e-20
"""Relative mean square of rounding errors."""


@dataclass(frozen=True, eq=False)
class FittedLaw:
    """Amplitude law fitted to a sweep.

    Attributes
    ----------
    law : str
        One of `LAWS`, or ``"none"``.
    linear : complex array, shape (f,)
        At a vanishing amplitude, one a frequency.
    linear_se : complex array, shape (f,)
        Standard errors of its real and of its imaginary part.
    parameters : dict of str to float
        lost, half_way, exponent and k3, those that the law has.
    se : dict of str to float
        Their standard errors; 0 for an exponent that was set.
    residuals : complex array, shape (n,)
        Fit less sample, over the size of the sample.
    residual_loss : float
        Relative rms residual of the loss, of the worst third of the amplitudes.
    bic, deviance : float
        n ln(rss/n), with and without the penalty of the parameters.
    is_adequate : bool
        The stiffness falls with amplitude, or rises where the law has a stiffening spring.
    quartic_gain : float
        Gain of the deviance by a term of X^4 in parallel to a cubic spring.
    """

    law: str
    linear: ComplexArray
    linear_se: ComplexArray
    parameters: dict[str, float]
    se: dict[str, float]
    residuals: ComplexArray
    residual_loss: float
    bic: float
    deviance: float
    is_adequate: bool
    quartic_gain: float = 0.0

    @property
    def terms(self) -> int:
        """Number of amplitude-dependent terms of the law."""
        return 0 if self.law == "none" else len(self.law.split("+"))

    @property
    def loss_deviance(self) -> float:
        """Deviance of the losses alone."""
        n, residual = len(self.residuals), self.residuals.imag
        return deviance(
            float(residual @ residual) / n, effective=n, rounding_sse=_ROUNDING_POWER / n
        )

    @property
    def residual(self) -> float:
        """Rms of the residual, of both parts."""
        return float(np.sqrt((np.abs(self.residuals) ** 2).mean() / 2))


def fit_sweep_law(sweep: AmplitudeSweep, law: str, exponent: float | None = None) -> FittedLaw:
    """Fit one law to a sweep; linear levels are projected out at every trial.

    Parameters
    ----------
    sweep : AmplitudeSweep
    law : str
        One of `LAWS`, or ``"none"``.
    exponent : float, optional
        Set; else it is found.
    """
    problem = _LawOnSweep(sweep, law, exponent)
    best = require_optimum(problem.least_squares_problem, problem.starts)
    residual, n = problem.compute_relative_residual(best), len(best.residual)
    numbers = problem.name_parameters(best.values)
    uncertainty = estimate(best, noises=[white_noise(best)])
    law_error = uncertainty.derive_quantity(
        lambda values: np.array(list(problem.name_parameters(values).values()))
    )
    se = dict(zip(numbers, law_error.standard_error.tolist(), strict=True))
    if problem.kraus and exponent is not None:
        se["exponent"] = 0.0
    level_columns = slice(len(best.theta), len(best.theta) + 2 * len(problem.frequencies))
    levels, sd = best.values[level_columns], uncertainty.standard_error[level_columns]
    closeness = {"effective": n, "rounding_sse": _ROUNDING_POWER}
    cubic_gain = 0.0
    if problem.cubic:
        cubic_gain, other = problem.compute_cubic_gain(best)
        # the number depends on what is taken for the spring, or for the friction beside it
        other_problems = [other] * (cubic_gain > SIGNIFICANT_DEVIANCE) + [
            problem.among_sliders()
        ] * problem.kraus
        se["k3"] = float(
            np.hypot(se["k3"], sum(abs(other - numbers["k3"]) for other in other_problems))
        )
    return FittedLaw(
        law,
        join_complex_parts(levels),
        join_complex_parts(sd),
        numbers,
        se,
        residual,
        _compute_worst_loss_error(sweep, residual.imag * problem.residual_scale),
        bic(best.sse / n, parameters=len(best.values), **closeness),
        deviance(best.sse / n, **closeness),
        numbers.get("lost", 0.0) >= 0 and problem.is_storage_rising(residual),
        cubic_gain,
    )


def _compute_worst_loss_error(sweep: AmplitudeSweep, residual: FloatArray) -> float:
    """Rms of the loss that is left over the loss, in the worst third of ln X: they differ."""
    log_amplitude = np.log(sweep.amplitude)
    thirds = np.floor(
        3 * (log_amplitude - log_amplitude.min()) / max(float(np.ptp(log_amplitude)), 1e-12)
    ).clip(0, 2)
    parts = [
        float(
            np.sqrt(
                np.sum(residual[selected] ** 2) / max(np.sum(sweep.loss[selected] ** 2), 1e-300)
            )
        )
        for selected in (thirds == i for i in range(3))
        if selected.any()
    ]
    return max(parts)


@dataclass(frozen=True, eq=False)
class _LawOnSweep:
    """A law on a sweep; sought are ln X_c, the exponent and, of a factor, the share."""

    sweep: AmplitudeSweep
    law: str
    exponent: float | None

    @property
    def kraus(self) -> bool:
        """Whether Kraus's law is in it."""
        return self.law not in {"none", "cubic"}

    @property
    def factor(self) -> bool:
        """Whether that is a factor."""
        return self.law.startswith("factor")

    @property
    def cubic(self) -> bool:
        """Whether a cubic spring is in it."""
        return self.law.endswith("cubic")

    @property
    def least_squares_problem(self) -> Problem:
        """Return the least-squares problem, real parts first, scaled by the size of the samples."""
        X, y = self.sweep.amplitude, stack_real_rows(self.sweep.value / self.residual_scale)
        parameters = [
            Parameter(np.log(X.min()) - 3, np.log(X.max()) + 5),
            *[Parameter(*_EXPONENTS, 0.2)] * (self.exponent is None),
            *[Parameter(1e-6, 1.0, 0.2)] * self.factor,
        ]
        return Problem(
            lambda theta: Rows(
                y, stack_real_rows(self.columns(self.insert_fixed_parameters(theta)))
            ),
            parameters if self.kraus else (),
        )

    @property
    def starts(self) -> list[FloatArray]:
        """Return the starting points of the descents."""
        low, high = np.log(self.sweep.amplitude.min()), np.log(self.sweep.amplitude.max())
        other_starts = [DEFAULT_EXPONENT] * (self.exponent is None) + [0.5] * self.factor
        return [
            np.array([(1 - fraction) * low + fraction * high, *other_starts])
            for fraction in (0.2, 0.5, 0.8)
        ]

    def insert_fixed_parameters(self, theta: FloatArray) -> FloatArray:
        """Ln X_c, exponent and share, fixed values included."""
        return (
            theta if self.exponent is None else np.insert(theta, min(1, len(theta)), self.exponent)
        )

    @cached_property
    def residual_scale(self) -> FloatArray:
        """Scale of the residuals: the size of the sample, more where its scatter is larger."""
        magnitude, sd = np.abs(self.sweep.value), self.sweep.sd
        return magnitude if sd is None else np.hypot(magnitude, sd / _MIN_SCATTER)

    @cached_property
    def frequencies(self) -> FloatArray:
        """Frequencies, Hz."""
        return np.unique(self.sweep.frequency)

    @cached_property
    def sample_masks(self) -> BoolArray:
        """Mask of the samples of each frequency, shape (n, f)."""
        return np.asarray(self.sweep.frequency[:, None] == self.frequencies)

    def columns(self, p: FloatArray) -> ComplexArray:
        """Return the columns of the linear coefficients: two per frequency, then d, then k3."""
        X, size = self.sweep.amplitude, self.residual_scale
        shape = np.ones(len(X), dtype=complex)
        if self.factor:
            shape = softening_factor(X, p[2], float(np.exp(p[0])), p[1])
        levels = self.sample_masks * shape[:, None]
        arrays = [levels, 1j * levels]
        if self.kraus and not self.factor:
            arrays.append((softening_factor(X, 1.0, float(np.exp(p[0])), p[1]) - 1)[:, None])
        if self.cubic:
            arrays.append(0.75 * (X / X.max())[:, None] ** 2)
        return np.asarray(np.hstack(arrays) / size[:, None], dtype=complex)

    def compute_relative_residual(self, best: Optimum) -> ComplexArray:
        """Fit less sample, over the size of the sample."""
        return -join_complex_parts(best.residual)

    def compute_cubic_gain(self, best: Optimum) -> tuple[float, float]:
        """Return the fall of the deviance by a term of X^4, and k3 with it."""
        X, n = self.sweep.amplitude, len(best.residual)
        cubic_columns = stack_real_rows((X / X.max()) ** 4 / self.residual_scale)
        cubic_fit = solve_ordinary(best.rows.y, np.column_stack((best.rows.A, cubic_columns)))
        gain = [
            bic(optimum.sse / n, effective=n, parameters=0, rounding_sse=_ROUNDING_POWER)
            for optimum in (best, cubic_fit)
        ]
        return gain[0] - gain[1], float(cubic_fit.beta[-2] / X.max() ** 2)

    def among_sliders(self) -> float:
        """The cubic spring in parallel to a spectrum of sliders, in place of Kraus's law."""
        X, K, max_amplitude = (
            self.sweep.amplitude,
            self.sweep.value,
            float(self.sweep.amplitude.max()),
        )
        count = max(round(_PER_DECADE * np.log10(2 * max_amplitude / X.min())), 2)
        sliders = jenkins_reduction(X[:, None], np.geomspace(X.min() / 2, max_amplitude, count))
        if self.factor:  # as much of the stiffness at every frequency
            sliders = (
                sliders
                * (self.sample_masks @ np.abs(K @ self.sample_masks))[:, None]
                / np.abs(K).sum()
            )
        spring = 0.75 * (X[:, None] / max_amplitude) ** 2 * np.array([1.0, -1.0])
        A = (
            np.hstack((self.sample_masks, 1j * self.sample_masks, sliders, spring))
            / self.residual_scale[:, None]
        )
        k, _ = solve_linear(
            stack_real_rows(A), stack_real_rows(K / self.residual_scale), positive=True
        )
        return float(k[-2] - k[-1]) / max_amplitude**2

    def name_parameters(self, values: FloatArray) -> dict[str, float]:
        """Return the parameters of the law by name."""
        theta, coefficients = np.split(values, [len(self.least_squares_problem.parameters)])
        entries = {}
        if self.kraus:
            p = self.insert_fixed_parameters(theta)
            softening = p[2] if self.factor else coefficients[2 * len(self.frequencies)]
            entries = {"lost": softening, "half_way": np.exp(p[0]), "exponent": p[1]}
        if self.cubic:
            entries["k3"] = coefficients[-1] / self.sweep.amplitude.max() ** 2
        return {name: float(entry) for name, entry in entries.items()}

    def is_storage_rising(self, residual: ComplexArray) -> bool:
        """Return whether the storage rises at the end, as by a spring in parallel to Kraus's law.

        A spring that only bends how the storage falls is but another way to soften.
        """
        if not (self.kraus and self.cubic):
            return True
        size = self.residual_scale
        storage, X = self.sweep.storage + residual.real * size, self.sweep.amplitude
        min_rise = _RISE_RESIDUALS * float(np.sqrt((np.abs(residual) ** 2).mean() / 2))
        for tone in self.sample_masks.T:
            storage_at_largest = storage[tone][X[tone].argmax()]
            if storage_at_largest - storage[tone].min() > min_rise * size[tone].min():
                return True
        return False


def join_complex_parts(values: FloatArray) -> ComplexArray:
    """Return real parts, and imaginary ones behind them, as complex numbers; also infinite ones."""
    complex_values = np.empty(len(values) // 2, dtype=complex)
    complex_values.real, complex_values.imag = np.split(values, 2)
    return complex_values
