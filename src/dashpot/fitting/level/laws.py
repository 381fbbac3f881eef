"""Least squares of one law of amplitude: Kraus's, a cubic spring, or both."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.fitting.level.checks import MATTERS
from dashpot.records.amplitude import AmplitudeSweep
from dashpot.solids.friction import slipping_share
from dashpot.solids.softening import softened

LAWS = ("factor", "additive", "cubic", "factor+cubic", "additive+cubic")
"""Kraus's law as a factor or beside the solid, a cubic spring, and both."""
_EXPONENTS = (0.1, 0.95)
SET = 0.5
"""The exponent where it cannot be known."""
_LEFT = 3e-3
"""Part of a modulus that laws of amplitude leave: scatter counts beyond it."""
_PER_DECADE = 10
_RISES = 3.0
"""Residuals by which the storage rises again where a spring stiffens beside friction."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """A law as it fits a sweep.

    Attributes
    ----------
    law : str
        One of `LAWS`, or ``"none"``.
    linear : complex array, shape (f,)
        At a vanishing amplitude, one a frequency.
    linear_se : complex array, shape (f,)
        Standard errors of its real and of its imaginary part.
    numbers : dict of str to float
        lost, half_way, exponent and k3, those that the law has.
    se : dict of str to float
        Their standard errors; 0 for an exponent that was set.
    left : complex array, shape (n,)
        Fit less sample, over the size of the sample.
    loss_left : float
        What is left of the loss over the loss, rms.
    bic, deviance : float
        n ln(rss/n), with and without what the parameters cost.
    sound : bool
        It loses stiffness with amplitude, or rises where it is said to.
    bends : float
        What a term of X^4 beside a cubic spring would gain in deviance.
    """

    law: str
    linear: ComplexArray
    linear_se: ComplexArray
    numbers: dict[str, float]
    se: dict[str, float]
    left: ComplexArray
    loss_left: float
    bic: float
    deviance: float
    sound: bool
    bends: float = 0.0

    @property
    def terms(self) -> int:
        """How many dependences on amplitude it has."""
        return 0 if self.law == "none" else len(self.law.split("+"))

    @property
    def loss_deviance(self) -> float:
        """As `deviance`, of the losses alone."""
        rss = max(float((self.left.imag**2).sum()), 1e-20)
        return len(self.left) * float(np.log(rss / len(self.left)))

    @property
    def residual(self) -> float:
        """Rms of what is left, of either part."""
        return float(np.sqrt((np.abs(self.left) ** 2).mean() / 2))


def fitted(sweep: AmplitudeSweep, law: str, exponent: float | None = None) -> Fitted:
    """Fit one law to a sweep; linear levels are projected out at every trial.

    Parameters
    ----------
    sweep : AmplitudeSweep
    law : str
        One of `LAWS`, or ``"none"``.
    exponent : float, optional
        Set; else it is found.
    """
    problem = _Problem(sweep, law, exponent)
    free = problem.descended() if problem.kraus else np.zeros(0)
    coefficients, left = problem.solved(free)
    n, known = 2 * len(left), len(coefficients) + len(problem.free)
    rss = max(float((np.abs(left) ** 2).sum()), n * 1e-20)
    deviance = n * float(np.log(rss / n))
    tones = len(problem.tones)
    numbers = problem.numbers(free, coefficients)
    sd, se = problem.errors(free, coefficients, rss / max(n - known, 1))
    bends = 0.0
    if problem.cubic:
        bends, other = problem.bent(free, deviance)
        # the number depends on what is taken for the spring, or for the friction beside it
        others = [other] * (bends > MATTERS) + [problem.among_sliders()] * problem.kraus
        se["k3"] = float(np.hypot(se["k3"], sum(abs(one - numbers["k3"]) for one in others)))
    loss = np.sqrt(np.mean((left.imag * problem.size) ** 2) / np.mean(sweep.loss**2))
    return Fitted(
        law,
        coefficients[:tones] + 1j * coefficients[tones : 2 * tones],
        sd[:tones] + 1j * sd[tones : 2 * tones],
        numbers,
        se,
        left,
        float(loss),
        deviance + known * float(np.log(n)),
        deviance,
        numbers.get("lost", 0.0) >= 0 and problem.rises(left),
        bends,
    )


@dataclass(frozen=True, eq=False)
class _Problem:
    """A law on a sweep; free are ln X_c, the exponent and, of a factor, the share."""

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
    def free(self) -> list[int]:
        """Which of the nonlinear numbers are found and not set."""
        every = [0, 1, 2] if self.factor else [0, 1] if self.kraus else []
        return [i for i in every if i != 1 or self.exponent is None]

    @cached_property
    def size(self) -> FloatArray:
        """What residuals are over: the sample's own size, more where its scatter is more."""
        size, sd = np.abs(self.sweep.value), self.sweep.sd
        return size if sd is None else np.hypot(size, sd / _LEFT)

    @cached_property
    def tones(self) -> FloatArray:
        """Frequencies, Hz."""
        return np.unique(self.sweep.frequency)

    @cached_property
    def chosen(self) -> BoolArray:
        """Which sample is of which frequency, shape (n, f)."""
        return np.asarray(self.sweep.frequency[:, None] == self.tones)

    def columns(self, p: FloatArray) -> ComplexArray:
        """What the linear coefficients multiply: levels per tone, then d, then k3."""
        X, size = self.sweep.amplitude, self.size
        shape = np.ones(len(X), dtype=complex)
        if self.factor:
            shape = softened(X, p[2], float(np.exp(p[0])), p[1])
        levels = self.chosen * shape[:, None]
        found = [levels, 1j * levels]
        if self.kraus and not self.factor:
            found.append((softened(X, 1.0, float(np.exp(p[0])), p[1]) - 1)[:, None])
        if self.cubic:
            found.append(0.75 * (X / X.max())[:, None] ** 2)
        return np.asarray(np.hstack(found) / size[:, None], dtype=complex)

    def bent(self, p: FloatArray, deviance: float) -> tuple[float, float]:
        """What a term of X^4 gains in deviance, and k3 beside it."""
        X = self.sweep.amplitude
        coefficients, left = self.solved(p, ((X / X.max()) ** 4 / self.size)[:, None])
        n = 2 * len(left)
        rss = max(float((np.abs(left) ** 2).sum()), n * 1e-20)
        return deviance - n * float(np.log(rss / n)), float(coefficients[-2] / X.max() ** 2)

    def among_sliders(self) -> float:
        """The cubic spring beside a spectrum of sliders, any friction, in the place of Kraus's."""
        from scipy.optimize import nnls  # costs an import that few need

        X, K, most = self.sweep.amplitude, self.sweep.value, float(self.sweep.amplitude.max())
        count = max(round(_PER_DECADE * np.log10(2 * most / X.min())), 2)
        sliders = slipping_share(X[:, None], np.geomspace(X.min() / 2, most, count))
        if self.factor:  # as much of the stiffness at every frequency
            sliders = sliders * (self.chosen @ np.abs(K @ self.chosen))[:, None] / np.abs(K).sum()
        spring = 0.75 * (X[:, None] / most) ** 2 * np.array([1.0, -1.0])
        A = np.hstack((self.chosen, 1j * self.chosen, sliders, spring)) / self.size[:, None]
        y = K / self.size
        k, _ = nnls(np.vstack((A.real, A.imag)), np.concatenate((y.real, y.imag)))
        return float(k[-2] - k[-1]) / most**2

    def solved(self, p: FloatArray, *more: FloatArray) -> tuple[FloatArray, ComplexArray]:
        """Linear coefficients, and what they leave."""
        A, y = np.hstack((self.columns(p), *more)), self.sweep.value / self.size
        both = np.vstack((A.real, A.imag))
        found = np.linalg.lstsq(both, np.concatenate((y.real, y.imag)), rcond=None)[0]
        coefficients = np.asarray(found, dtype=float)
        return coefficients, np.asarray(A @ coefficients - y)

    def residual(self, p: FloatArray) -> FloatArray:
        """What is left, its real and its imaginary parts."""
        left = self.solved(p)[1]
        return np.concatenate((left.real, left.imag))

    def descended(self) -> FloatArray:
        """Nonlinear numbers: the best of three starts."""
        from scipy.optimize import least_squares  # costs an import that few need

        X, m = self.sweep.amplitude, self.exponent
        low, high = np.log(X.min()) - 3, np.log(X.max()) + 5
        band = _EXPONENTS if m is None else (m - 1e-9, m + 1e-9)
        lower, upper = [low, band[0]], [high, band[1]]
        if self.factor:
            lower, upper = [*lower, 1e-6], [*upper, 1.0]
        found = []
        for share in (0.2, 0.5, 0.8):
            ln_X_c = (1 - share) * np.log(X.min()) + share * np.log(X.max())
            start = [ln_X_c, SET if m is None else m, 0.5][: len(lower)]
            found.append(
                least_squares(
                    self.residual,
                    start,
                    bounds=(lower, upper),
                    x_scale=[1, 0.2, 0.2][: len(lower)],
                    xtol=1e-12,
                    ftol=1e-12,
                    gtol=1e-12,
                )
            )
        return np.asarray(min(found, key=lambda one: one.cost).x)

    def numbers(self, p: FloatArray, coefficients: FloatArray) -> dict[str, float]:
        """What the law is, by name."""
        found = {}
        if self.kraus:
            lost = p[2] if self.factor else coefficients[2 * len(self.tones)]
            found = {"lost": lost, "half_way": np.exp(p[0]), "exponent": p[1]}
        if self.cubic:
            found["k3"] = coefficients[-1] / self.sweep.amplitude.max() ** 2
        return {name: float(one) for name, one in found.items()}

    def errors(
        self, p: FloatArray, coefficients: FloatArray, scatter: float
    ) -> tuple[FloatArray, dict[str, float]]:
        """Standard errors of the coefficients and of those numbers, from one covariance."""
        steps = 1e-5 * np.maximum(np.abs(p), 1e-3)
        J = [self.columns(p)]
        for i in self.free:
            step = np.zeros(len(p))
            step[i] = steps[i]
            slope = (self.columns(p + step) - self.columns(p - step)) @ coefficients
            J.append(slope[:, None] / (2 * steps[i]))
        A = np.hstack(J)
        both = np.vstack((A.real, A.imag))
        sd = np.sqrt(np.diag(np.linalg.pinv(both.T @ both)) * scatter)
        linear, free = sd[: len(coefficients)], np.zeros(3)
        free[self.free] = sd[len(coefficients) :]
        found = {}
        if self.kraus:
            lost = free[2] if self.factor else linear[2 * len(self.tones)]
            found = {"lost": lost, "half_way": np.exp(p[0]) * free[0], "exponent": free[1]}
        if self.cubic:
            found["k3"] = linear[-1] / self.sweep.amplitude.max() ** 2
        return linear, {name: float(one) for name, one in found.items()}

    def rises(self, left: ComplexArray) -> bool:
        """Whether the storage rises at the end, where a spring stands beside Kraus's law.

        A spring that only bends how the storage falls is but another way to soften.
        """
        if not (self.kraus and self.cubic):
            return True
        size = self.size
        storage, X = self.sweep.storage + left.real * size, self.sweep.amplitude
        least = _RISES * float(np.sqrt((np.abs(left) ** 2).mean() / 2))
        for here in self.chosen.T:
            last = storage[here][X[here].argmax()]
            if last - storage[here].min() > least * size[here].min():
                return True
        return False
