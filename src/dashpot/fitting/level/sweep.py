"""From an amplitude sweep to how stiffness and loss move with amplitude."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray, median
from dashpot.base.checks import Check
from dashpot.base.errors import FitError
from dashpot.fitting.level.checks import (
    FAR_ENOUGH,
    MATTERS,
    amplitudes_spread,
    law_followed,
    level_matters,
    loss_followed,
    softening_seen,
)
from dashpot.records.amplitude import AmplitudeFit, AmplitudeSweep
from dashpot.solids.softening import softened

_LEAST = 6
"""Samples: two numbers of a level, three of the law, one to spare."""
_EXPONENTS = (0.1, 0.95)
_SET = 0.5
_PARTED = 2.0
"""Difference of BIC below which two laws are not told apart (Kass and Raftery 1995)."""
_STRAY = 5.0
"""A leading sample so many robust SD off is of an instrument that is not yet in its range."""


def fit_amplitude(
    sweep: AmplitudeSweep, *, law: Literal["auto", "factor", "additive"] = "auto"
) -> AmplitudeFit:
    r"""Fit Kraus's law with tied loss to an amplitude sweep, as a factor or beside the solid.

    Least squares on complex residuals over the size of the modulus; a linear complex level for
    each frequency, one share, half-way amplitude and exponent for all. BIC chooses the law where
    frequencies differ enough to tell; at one frequency the two are the same curve, and the factor
    is taken for a modulus, the element beside the solid for a stiffness. Where the sweep ends
    below twice X_c the exponent is set to 0.5.

    Source: G. Kraus (1984); the tie of the loss is the rule of broad friction,
    :math:`K'' = -(2/\pi)\,dK'/d\ln X`.

    Parameters
    ----------
    sweep : AmplitudeSweep
    law : str
        ``"auto"``, ``"factor"`` or ``"additive"``.

    Raises
    ------
    FitError
        If there are too few samples.
    """
    if len(sweep.amplitude) < _LEAST:
        raise FitError(
            f"{len(sweep.amplitude)} amplitudes; a law of amplitude needs {_LEAST} or more"
        )
    tried = _ranked(sweep, law)
    stray = _strays(sweep, tried[0].left)
    if stray.any() and np.count_nonzero(~stray) >= _LEAST:
        sweep = sweep.only(~stray)
        tried = _ranked(sweep, law)
    plain, best = _fitted(sweep, "none", None), tried[0]
    reach = float(sweep.amplitude.max()) / best.half_way
    if reach < FAR_ENOUGH:
        best = _fitted(sweep, best.law, _SET)
    gain = plain.deviance - best.deviance
    span = float(sweep.amplitude.max() / sweep.amplitude.min())
    if gain <= MATTERS:  # nothing moves with amplitude
        best = plain
    range_ = (float(sweep.amplitude.min()), float(sweep.amplitude.max()))
    followed = law_followed(best.residual)
    checks: list[Check] = [
        level_matters(gain, range_, sweep.of, followed=bool(followed.passed)),
        amplitudes_spread(span, sweep.of),
        followed,
        loss_followed(best.loss_left),
    ]
    if best.law != "none":
        checks.insert(2, softening_seen(reach))
    return AmplitudeFit(
        best.law,
        np.unique(sweep.frequency),
        best.linear,
        best.lost,
        best.half_way,
        best.exponent,
        best.se,
        range_,
        best.residual,
        tuple((one.law, one.bic) for one in (plain, *tried)),
        int(np.count_nonzero(stray)),
        sweep.unit,
        sweep.of,
        tuple(checks),
        sweep.source,
    )


def _ranked(sweep: AmplitudeSweep, law: str) -> list[_Found]:
    """The laws, the best first; of two that BIC does not part, the one at home in the unit."""
    home = "factor" if sweep.unit == "Pa" else "additive"
    tried = [_fitted(sweep, each, None) for each in ("factor", "additive") if law in {"auto", each}]
    least = min(one.bic for one in tried)
    return sorted(tried, key=lambda one: (one.bic > least + _PARTED, one.law != home, one.bic))


@dataclass(frozen=True, eq=False)
class _Found:
    law: str
    linear: ComplexArray
    lost: float
    half_way: float
    exponent: float
    se: tuple[tuple[str, float], ...]
    residual: float
    loss_left: float
    bic: float
    deviance: float
    """n ln(rss/n): minus twice the log likelihood, but for a constant."""
    left: ComplexArray


def _fitted(sweep: AmplitudeSweep, law: str, exponent: float | None) -> _Found:
    """Least squares of one law; linear levels are projected out at every trial."""
    from scipy.optimize import least_squares  # costs an import that few need

    X, K = sweep.amplitude, sweep.value
    size = np.abs(K)
    tones, tone = np.unique(sweep.frequency, return_inverse=True)
    chosen = np.eye(len(tones))[tone]

    def columns(p: FloatArray) -> ComplexArray:
        """What the linear coefficients multiply: real and imaginary level per tone, and d."""
        shape = np.ones(len(X), dtype=complex)
        if law == "factor":
            shape = softened(X, p[2], float(np.exp(p[0])), p[1])
        levels = chosen * shape[:, None]
        found = [levels, 1j * levels]
        if law == "additive":
            found.append((softened(X, 1.0, float(np.exp(p[0])), p[1]) - 1)[:, None])
        return np.asarray(np.hstack(found) / size[:, None], dtype=complex)

    def solved(p: FloatArray) -> tuple[FloatArray, ComplexArray]:
        A = columns(p)
        both, y = np.vstack((A.real, A.imag)), K / size
        found = np.linalg.lstsq(both, np.concatenate((y.real, y.imag)), rcond=None)[0]
        coefficients = np.asarray(found, dtype=float)
        return coefficients, np.asarray(A @ coefficients - y)

    def residual(p: FloatArray) -> FloatArray:
        left = solved(p)[1]
        return np.concatenate((left.real, left.imag))

    free = np.zeros(0)
    if law != "none":
        free = _descended(least_squares, residual, X, law, exponent)
    coefficients, left = solved(free)
    n, count = 2 * len(X), 2 * len(tones)
    known = count + {"none": 0, "factor": 3, "additive": 3}[law] - (exponent is not None)
    rss = max(float((np.abs(left) ** 2).sum()), n * 1e-20)
    fit = n * np.log(rss / n)
    linear = coefficients[: len(tones)] + 1j * coefficients[len(tones) : count]
    lost = float(coefficients[count]) if law == "additive" else float(free[2]) if len(free) else 0.0
    half_way, m = (float(np.exp(free[0])), float(free[1])) if len(free) else (np.nan, np.nan)
    scatter = rss / max(n - known, 1)
    se = _errors(columns, coefficients, free, law=law, exponent=exponent, scatter=scatter)
    return _Found(
        law,
        linear,
        lost,
        half_way,
        m,
        se,
        float(np.sqrt(rss / n)),
        float(np.sqrt(np.mean((left.imag * size) ** 2) / np.mean(K.imag**2))),
        fit + known * np.log(n),
        fit,
        left,
    )


def _descended(
    least_squares: Callable[..., Any],
    residual: Callable[[FloatArray], FloatArray],
    X: FloatArray,
    law: str,
    exponent: float | None,
) -> FloatArray:
    """Logarithm of X_c, m and, for a factor, the share: the best of three starts."""
    low, high = np.log(X.min()) - 3, np.log(X.max()) + 5
    band = _EXPONENTS if exponent is None else (exponent - 1e-9, exponent + 1e-9)
    lower, upper = [low, band[0]], [high, band[1]]
    if law == "factor":
        lower, upper = [*lower, 1e-6], [*upper, 1.0]
    found = []
    for share in (0.2, 0.5, 0.8):
        ln_X_c = (1 - share) * np.log(X.min()) + share * np.log(X.max())
        start = [ln_X_c, _SET if exponent is None else exponent, 0.5][: len(lower)]
        found.append(
            least_squares(
                residual,
                start,
                bounds=(lower, upper),
                x_scale=[1, 0.2, 0.2][: len(lower)],
                xtol=1e-12,
                ftol=1e-12,
                gtol=1e-12,
            )
        )
    return np.asarray(min(found, key=lambda one: one.cost).x)


def _errors(
    columns: Callable[[FloatArray], ComplexArray],
    coefficients: FloatArray,
    free: FloatArray,
    *,
    law: str,
    exponent: float | None,
    scatter: float,
) -> tuple[tuple[str, float], ...]:
    """Standard errors of lost, half_way and m, from all parameters' covariance."""
    if not len(free):
        return ()
    steps = 1e-5 * np.maximum(np.abs(free), 1e-3)
    kept = [i for i in range(len(free)) if not (i == 1 and exponent is not None)]
    J = [columns(free)]
    for i in kept:
        step = np.zeros(len(free))
        step[i] = steps[i]
        slope = (columns(free + step) - columns(free - step)) @ coefficients / (2 * steps[i])
        J.append(slope[:, None])
    A = np.hstack(J)
    both = np.vstack((A.real, A.imag))
    sd = np.sqrt(np.diag(np.linalg.pinv(both.T @ both)) * scatter)
    extra = dict(
        zip([("ln", "exponent", "lost")[i] for i in kept], sd[len(coefficients) :], strict=True)
    )
    lost = float(sd[len(coefficients) - 1]) if law == "additive" else float(extra["lost"])
    return (
        ("lost", lost),
        ("half_way", float(np.exp(free[0]) * extra["ln"])),
        ("exponent", float(extra.get("exponent", 0.0))),
    )


def _strays(sweep: AmplitudeSweep, left: ComplexArray) -> BoolArray:
    """The smallest amplitudes of a frequency whose residual is beyond the scatter of the rest."""
    size = np.abs(left)
    limit = _STRAY * 1.4826 * median(size)
    out = np.zeros(len(size), dtype=bool)
    for tone in np.unique(sweep.frequency):
        rows = np.flatnonzero(sweep.frequency == tone)
        for i in rows[np.argsort(sweep.amplitude[rows])]:
            if size[i] <= limit:
                break
            out[i] = True
    return out
