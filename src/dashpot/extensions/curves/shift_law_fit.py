r"""Fit of a law to shift factors, by generalised least squares with their covariance.

.. math:: D = (s - f(\theta))' C^{-1} (s - f(\theta)), \qquad \mathrm{BIC} = D + p \ln n

over the n shifts :math:`s = \log_{10} a_T` away from the reference. Shifts along a master curve are
chained and hang together: with the diagonal of C alone their law misses the truth every third time.
WLF is sought as :math:`-\beta\,(T - T_r) / (1 + u\,(T - T_r))` with :math:`u = 1/C_2` and
:math:`\beta = C_1/C_2`, which is a straight line in T where u is 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray, validate_samples
from dashpot.base.errors import FitError
from dashpot.base.option_fields import ShiftLaw, require_choice
from dashpot.numerics.inference.covariance_estimate import estimate, white_noise
from dashpot.numerics.inference.model_order import bic_of_deviance, is_significant_fall
from dashpot.numerics.least_squares import Optimum, Parameter, Problem, Rows, require_optimum
from dashpot.solids.shift_laws import GAS_CONSTANT, WLF, Arrhenius, FreeShifts, TemperatureLaw

MAX_MISSED = 0.15
"""Decades by which a law may miss a shift: a factor 1.4 in time."""
# of BIC: "not worth more than a bare mention" (Kass and Raftery, J. Am. Stat. Assoc. 90, 1995)
_EQUAL_BIC = 2.0
# a temperature is the odd one if a law follows the others so much better, two of them to spare
_OUTLIER_SHARE, _MIN_SPARE_SHIFTS = 0.1, 2
# temperatures that a law needs: two shifts, the fewest of which one can contradict the other
MIN_TEMPERATURES = 3
# C_2 less the least it can be, and C_2 beyond which WLF is a straight line in T, K
_MIN_C2_MARGIN, _MAX_C2 = 1e-3, 1e5
# part of the largest eigenvalue of a covariance that rounding can make
_ROUNDING = 1e-13


@dataclass(frozen=True)
class LawScore:
    """Goodness of fit of one law to the shifts.

    Attributes
    ----------
    kind : str
        ``"wlf"``, ``"arrhenius"`` or ``"free"``.
    deviance : float
        D, chi-square where the law holds.
    dof : int
    bic : float
        Differences count.
    missed : float
        Largest deviation from a shift, decades.
    at : float
        Temperature of that shift, K.
    """

    kind: str
    deviance: float
    dof: int
    bic: float
    missed: float
    at: float

    @property
    def fails(self) -> bool:
        """Whether it deviates from a shift significantly and by more than the tolerance."""
        beyond_chance = self.dof > 0 and is_significant_fall(self.deviance, self.dof)
        return beyond_chance and self.missed > MAX_MISSED


@dataclass(frozen=True)
class ShiftOutlier:
    """Temperature whose shift deviates from the law of all others.

    Attributes
    ----------
    temperature : float
        K.
    missed : float
        Deviation of its shift from that law, decades.
    """

    temperature: float
    missed: float


@dataclass(frozen=True, eq=False)
class ShiftLawFit:
    """Chosen shift law, the uncertainty of its constants, and the scores of the others.

    Attributes
    ----------
    law : TemperatureLaw
    parameters : tuple of str
        ``("c1", "c2")``, ``("energy",)`` or none.
    covariance : array, shape (p, p)
        Covariance of them; widened by D/dof where the law misses the shifts by more than their
        errors.
    scores : tuple of LawScore
        Scores of every law that was tried, the best BIC first.
    outlier : ShiftOutlier or None
        The one temperature off the law of all others; None if there is none, or too few others.
    """

    law: TemperatureLaw
    parameters: tuple[str, ...]
    covariance: FloatArray
    scores: tuple[LawScore, ...]
    outlier: ShiftOutlier | None = None

    @property
    def score(self) -> LawScore:
        """Score of the selected law."""
        return next(score for score in self.scores if score.kind == self.law.kind)


@dataclass(frozen=True, eq=False)
class _Shifts:
    """Shifts in units of their errors, away from the reference."""

    temperature: FloatArray
    log10: FloatArray
    whitener: FloatArray
    reference: float

    def rows(self, column: FloatArray, slope: FloatArray | None = None) -> Rows:
        """Return the rows of a law of unit factor, one theta of which has that slope."""
        W = self.whitener
        derivative = None if slope is None else lambda beta: (W @ slope * beta)[:, None]
        return Rows(W @ self.log10, (W @ column)[:, None], derivative)


class _SolvedLaw(NamedTuple):
    """A law, the problem that it solves, and its constants out of theta and beta."""

    law: TemperatureLaw
    optimum: Optimum
    constants: Callable[[FloatArray], FloatArray]


def fit_shift_law(
    temperature: npt.ArrayLike,
    log10_shift: npt.ArrayLike,
    covariance: npt.ArrayLike,
    *,
    reference: float,
    law: ShiftLaw = "auto",
) -> ShiftLawFit:
    """Lay a law through shift factors.

    Parameters
    ----------
    temperature : array_like, shape (n,)
        K, rising; the reference is among them.
    log10_shift : array_like, shape (n,)
        Decadic logarithm of each shift factor, 0 at the reference.
    covariance : array_like, shape (n, n)
        Covariance of them, as :class:`~dashpot.datamodel.shift_factors.TemperatureShifts` begins
        with it.
    reference : float
        T_r, K.
    law : str
        ``"auto"`` takes WLF or Arrhenius by BIC, the simpler within 2; the shifts themselves at
        fewer than three temperatures or where neither law follows them. Else the law to use.

    Raises
    ------
    FitError
        If the law requested cannot follow the shifts.
    """
    require_choice("law", law, ShiftLaw, FitError)
    t, s = (
        validate_samples("temperature", temperature),
        validate_samples("log10_shift", log10_shift),
    )
    free = FreeShifts(tuple(t), tuple(s), reference)
    is_not_reference = t != reference
    c = np.asarray(covariance, dtype=float)[np.ix_(is_not_reference, is_not_reference)]
    shifts = _Shifts(t[is_not_reference], s[is_not_reference], _compute_whitener(c), reference)
    n = int(is_not_reference.sum())
    entries: dict[str, tuple[TemperatureLaw, FloatArray]] = {"free": (free, np.empty((0, 0)))}
    bic = bic_of_deviance(0.0, effective=max(n, 1), parameters=n)
    scores = [LawScore("free", 0.0, 0, bic, 0.0, reference)]
    for kind, lay in _FIT_FUNCTIONS.items():
        if n < (MIN_TEMPERATURES - 1 if law == "auto" else 1) or (solution := lay(shifts)) is None:
            continue
        temperature_law, fit, constants = solution
        size, deviance = len(fit.values), fit.sse
        if size > n:
            continue
        deviation = np.abs(temperature_law.log10_a_t(shifts.temperature) - shifts.log10)
        error_factor = max(1.0, deviance / (n - size)) if n > size else 1.0
        uncertainty = estimate(fit, noises=[white_noise(fit, error_factor)])
        entries[kind] = temperature_law, uncertainty.derive_quantity(constants).covariance
        bic = bic_of_deviance(deviance, effective=n, parameters=size)
        worst_index = int(np.argmax(deviation))
        scores.append(
            LawScore(
                kind,
                deviance,
                n - size,
                bic,
                float(deviation[worst_index]),
                float(shifts.temperature[worst_index]),
            )
        )
    scores.sort(key=lambda score: score.bic)
    kind = law
    if law == "auto":
        best = _choose_law(scores)
        kind = "free" if best.fails else best.kind
    if kind not in entries:
        raise FitError(
            f"no {kind} law follows the shifts at {n + 1} temperatures: time scales must fall as "
            "it gets warmer, and WLF needs three temperatures; take the "
            "shifts themselves (dashpot fit --shift free)"
        )
    best_law, errors = entries[kind]
    return ShiftLawFit(
        best_law, _PARAMETERS[kind], errors, tuple(scores), _find_outlier_temperature(shifts, c)
    )


def _find_outlier_temperature(shifts: _Shifts, covariance: FloatArray) -> ShiftOutlier | None:
    """Return the temperature without which a law follows the shifts that it fails with it.

    None if a law follows them all within their errors, however few shifts it has to spare.
    """
    pairs: list[tuple[float, ShiftOutlier]] = []
    n = len(shifts.temperature)
    for kind, lay in _FIT_FUNCTIONS.items():
        dof = n - len(_PARAMETERS[kind])
        if dof < 1 or (solution := lay(shifts)) is None:
            continue
        deviance = solution.optimum.sse
        if not is_significant_fall(deviance, dof):
            return None
        if dof < _MIN_SPARE_SHIFTS:
            continue
        for i in range(n):
            other_indices = np.delete(np.arange(n), i)
            part = _Shifts(
                shifts.temperature[other_indices], shifts.log10[other_indices],
                _compute_whitener(covariance[np.ix_(other_indices, other_indices)]),
                shifts.reference,
            )  # fmt: skip
            if (fit_without := lay(part)) is None:
                continue
            temperature, remainder = (
                float(shifts.temperature[i]),
                fit_without.optimum.sse / (dof - 1),
            )
            deviation = float(shifts.log10[i]) - float(fit_without.law.log10_a_t(temperature))
            pairs.append((remainder / (deviance / dof), ShiftOutlier(temperature, deviation)))
    share, outlier = min(pairs, key=lambda pair: pair[0], default=(1.0, None))
    return outlier if share < _OUTLIER_SHARE else None


def _choose_law(scores: Sequence[LawScore]) -> LawScore:
    """Return the law, if any, that BIC takes: of two that are nearly even, the simpler."""
    laws = [score for score in scores if score.kind != "free"]
    if not laws:
        return scores[0]
    return max(
        (law for law in laws if law.bic < laws[0].bic + _EQUAL_BIC), key=lambda score: score.dof
    )


_PARAMETERS = {"wlf": ("c1", "c2"), "arrhenius": ("energy",), "free": ()}


def _compute_whitener(covariance: FloatArray) -> FloatArray:
    """Return W with W C W' = 1."""
    if not len(covariance):
        return np.empty((0, 0))
    values, vectors = np.linalg.eigh((covariance + covariance.T) / 2)
    min_eigenvalue = max(_ROUNDING * float(values[-1]), np.finfo(float).tiny)
    return np.asarray((vectors / np.sqrt(np.maximum(values, min_eigenvalue))).T)


def _fit_arrhenius(shifts: _Shifts) -> _SolvedLaw | None:
    column = (1 / shifts.temperature - 1 / shifts.reference) / (GAS_CONSTANT * np.log(10.0))
    best = require_optimum(Problem(lambda _: shifts.rows(column), positive=True))
    energy = float(best.beta[0])
    return _SolvedLaw(Arrhenius(energy, shifts.reference), best, np.array) if energy > 0 else None


def _fit_wlf(shifts: _Shifts) -> _SolvedLaw | None:
    """Return the law, unless the best is a straight line in T."""
    temperature_difference = shifts.temperature - shifts.reference
    min_c2 = max(0.0, -float(temperature_difference.min(initial=0.0)))

    def rows(theta: FloatArray) -> Rows:
        denominator = 1 + theta * temperature_difference
        return shifts.rows(
            -temperature_difference / denominator, (temperature_difference / denominator) ** 2
        )

    range_ = Parameter(1 / _MAX_C2, 1 / (min_c2 + _MIN_C2_MARGIN), scale=0.01)
    # linear where every shift is multiplied by what it is divided by
    linear_columns = np.column_stack(
        (-shifts.log10 * temperature_difference, -temperature_difference)
    )
    start = np.asarray(np.linalg.lstsq(linear_columns, shifts.log10)[0][:1])
    best = require_optimum(Problem(rows, [range_], positive=True), [start])
    if best.beta[0] <= 0 or best.theta[0] <= range_.low:
        return None
    c1, c2 = _compute_constants(best.values)
    return _SolvedLaw(WLF(float(c1), float(c2), shifts.reference), best, _compute_constants)


def _compute_constants(values: FloatArray) -> FloatArray:
    """C1 and C2 of u and beta."""
    u, beta = values
    return np.array([beta / u, 1 / u])


_FIT_FUNCTIONS: dict[str, Callable[[_Shifts], _SolvedLaw | None]] = {
    "arrhenius": _fit_arrhenius,
    "wlf": _fit_wlf,
}
