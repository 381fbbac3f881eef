"""Gauge repeatability and reproducibility: the share of variance due to testing."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError

POOLING_P_VALUE = 0.25
"""P-value above which an interaction counts as repeatability (Montgomery, Design and Analysis of
Experiments, section 13.3; AIAG asks for more evidence of one)."""
CATEGORY_FACTOR = 1.41
"""Confidence intervals of the gauge in a standard deviation of parts (AIAG, MSA, 4th ed.)."""
GOOD_SHARE, LIMIT = 0.10, 0.30
"""Share of the total deviation below which a gauge is good, and above which it is not (AIAG)."""
_DRAWS, _SEED = 20_000, 1

Labels: TypeAlias = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Variation:
    """Source of variation in a gauge study.

    Attributes
    ----------
    name : str
        ``"repeatability"``, ``"operator"``, ``"interaction"``, ``"gauge"``, ``"part"`` or
        ``"total"``.
    deviation : float
        Standard deviation; an estimate of a variance below 0 is given as 0.
    interval : (float, float)
        95 %.
    share : float
        Share of the total deviation; the shares of deviations do not add up to 1.
    share_interval : (float, float)
    """

    name: str
    deviation: float
    interval: tuple[float, float]
    share: float
    share_interval: tuple[float, float]


@dataclass(frozen=True)
class Gauge:
    """Result of a gauge study.

    Attributes
    ----------
    parts, operators, tests : int
        How many; one operator where none was named.
    omitted_tests : int
        Tests beyond a design in which every operator tests every part equally often.
    variations : tuple of Variation
    categories : int
        That the gauge can distinguish, ndc: 1.41 deviations of parts over those of the gauge.
    categories_interval : (float, float)
        95 %.
    interaction_p : float or None
        p value of the F test for an interaction of operators and parts; above 0.25 it was pooled.
    """

    parts: int
    operators: int
    tests: int
    omitted_tests: int
    variations: tuple[Variation, ...]
    categories: float
    categories_interval: tuple[float, float]
    interaction_p: float | None

    def __getitem__(self, name: str) -> Variation:
        """The source of a name."""
        return next(variation for variation in self.variations if variation.name == name)

    @property
    def summary(self) -> str:
        """The share of the gauge, and ndc with its interval: whole categories, the rest cut off."""
        text, low, high = (
            f"{math.floor(value)}" if math.isfinite(value) else "∞"
            for value in (self.categories, *self.categories_interval)
        )
        return f"{100 * self['gauge'].share:.1f} % of all, ndc {text} ({low} to {high})"

    @property
    def is_pooled(self) -> bool:
        """Whether the interaction was tried and counts as repeatability."""
        return self.interaction_p is not None and self.interaction_p > POOLING_P_VALUE


_Variances: TypeAlias = dict[str, FloatArray]


@dataclass(frozen=True, eq=False)
class _Squares:
    """Mean squares with their degrees of freedom, and the variances that they mean."""

    mean_squares: FloatArray
    dof: FloatArray
    solve_variances: Callable[[FloatArray], _Variances]


def gauge(
    values: FloatArray,
    parts: Sequence[str],
    operators: Sequence[str] | None = None,
    *,
    level: float = 0.95,
) -> Gauge:
    r"""Return repeatability, reproducibility and variation of the parts, with intervals.

    The analysis of variance of AIAG, Measurement Systems Analysis, 4th ed., chapter III: parts and
    operators at random, crossed, with their interaction, which is pooled into repeatability where
    its F test has p > 0.25. Without operators, or with one, repeats of parts alone: reproducibility
    is then not known. The intervals are generalized ones (Hamada and Weaver, Quality Engineering
    12, 2000): each mean square over its :math:`\chi^2`, drawn anew 20 000 times from one seed.

    Parameters
    ----------
    values : array, shape (n,)
    parts : sequence of str, n
    operators : sequence of str, n, optional
        Operator or rig of each test. Parts that not every operator tested are omitted, and tests
        beyond the fewest of any operator and part; without operators no test is.
    level : float

    Raises
    ------
    DataError
        If there are fewer than two parts, or no repeats, or no part that every operator tested.
    """
    x = np.asarray(values, dtype=float)
    part = np.unique(np.asarray(parts), return_inverse=True)[1].reshape(-1)
    names, operator = np.unique(
        np.asarray(operators if operators is not None else [""] * len(x)), return_inverse=True
    )
    p_value = None
    if len(names) > 1:
        table = _extract_balanced_table(x, part, operator.reshape(-1), len(names))
        squares, p_value = _compute_crossed_squares(table)
        count, value_count = table.shape[0], table.size
    else:
        squares, count, value_count = _compute_repeat_squares(x, part)
    entries, intervals = squares.solve_variances(squares.mean_squares), _draw_variances(squares)
    tails = [(1 - level) / 2, (1 + level) / 2]

    def compute_interval(draws: FloatArray) -> tuple[float, float]:
        low, high = np.quantile(draws, tails)
        return float(low), float(high)

    variations = tuple(
        Variation(
            name,
            float(entries[name]) ** 0.5,
            compute_interval(np.sqrt(intervals[name])),
            _compute_ratio(entries[name], entries["total"]),
            compute_interval(_compute_ratios(intervals[name], intervals["total"])),
        )
        for name in entries
    )
    categories = CATEGORY_FACTOR * _compute_ratio(entries["part"], entries["gauge"])
    return Gauge(
        count,
        len(names),
        value_count,
        len(x) - value_count,
        variations,
        categories,
        compute_interval(CATEGORY_FACTOR * _compute_ratios(intervals["part"], intervals["gauge"])),
        p_value,
    )


def _compute_ratio(first: FloatArray, second: FloatArray) -> float:
    return float(_compute_ratios(np.asarray(first), np.asarray(second)))


def _compute_ratios(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return ratios of deviations, from variances; 0 over 0 is 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(first == 0, 0.0, np.sqrt(first / second))


def _extract_balanced_table(
    x: FloatArray, part: Labels, operator: Labels, operators: int
) -> FloatArray:
    """Return the balanced part of a design, shape (parts, operators, repeats)."""
    tests = np.bincount(part * operators + operator, minlength=(part.max() + 1) * operators)
    tests = tests.reshape(-1, operators)
    complete_parts = np.flatnonzero(tests.all(axis=1))
    if len(complete_parts) < 2:
        raise DataError(
            f"{len(complete_parts)} parts were tested by all {operators} operators; expected two "
            "or more: what operators add cannot be separated from the parts"
        )
    repeats = tests[complete_parts].min()
    if repeats < 2:
        raise DataError(
            "an operator tested a part once; expected two repeats or more of each: repeatability "
            "cannot be separated from the rest"
        )
    return np.array([
        [x[(part == i) & (operator == j)][:repeats] for j in range(operators)]
        for i in complete_parts
    ])  # fmt: skip


def _compute_repeat_squares(x: FloatArray, part: Labels) -> tuple[_Squares, int, int]:
    """One-way: unweighted means of the parts, whatever the number of their repeats."""
    size = np.bincount(part)
    if len(size) < 2 or size.max() < 2:
        raise DataError(
            f"{len(size)} parts with at most {size.max()} tests each; expected two parts or more, "
            "of which one was tested twice"
        )
    means = np.bincount(part, x) / size
    repeat_variance = float(np.sum((x - means[part]) ** 2)) / (len(x) - len(size))
    ratio = float(1 / np.mean(1 / size))

    def solve_variances(square: FloatArray) -> _Variances:
        error = square[0]
        return _add_variance_totals({"repeatability": error}, (square[1] - error) / ratio)

    return (
        _Squares(
            np.array([repeat_variance, ratio * np.var(means, ddof=1)]),
            np.array([len(x) - len(size), len(size) - 1]),
            solve_variances,
        ),
        len(size),
        len(x),
    )


def _compute_crossed_squares(table: FloatArray) -> tuple[_Squares, float]:
    """Two-way, crossed and balanced; shape (parts, operators, repeats)."""
    from scipy.stats import f

    p, o, r = table.shape
    mean, cell = table.mean(), table.mean(axis=2)
    part_means, operator_means = cell.mean(axis=1), cell.mean(axis=0)
    sums = np.array([
        np.sum((table - cell[:, :, None]) ** 2),
        r * np.sum((cell - part_means[:, None] - operator_means + mean) ** 2),
        p * r * np.sum((operator_means - mean) ** 2),
        o * r * np.sum((part_means - mean) ** 2),
    ])  # fmt: skip
    freedom = np.array([p * o * (r - 1), (p - 1) * (o - 1), o - 1, p - 1])
    square = sums / freedom
    p_value = float(f.sf(square[1] / square[0], freedom[1], freedom[0])) if square[0] > 0 else 0.0
    if p_value > POOLING_P_VALUE:
        pooled_variance = sums[:2].sum() / freedom[:2].sum()

        def solve_pooled_variances(square: FloatArray) -> _Variances:
            error, operators, parts = square
            variances = {"repeatability": error, "operator": (operators - error) / (p * r)}
            return _add_variance_totals(variances, (parts - error) / (o * r))

        values = np.array([pooled_variance, *square[2:]])
        return _Squares(
            values, np.array([freedom[:2].sum(), *freedom[2:]]), solve_pooled_variances
        ), p_value

    def solve_variances(square: FloatArray) -> _Variances:
        error, interaction, operators, parts = square
        variances = {
            "repeatability": error,
            "operator": (operators - interaction) / (p * r),
            "interaction": (interaction - error) / r,
        }
        return _add_variance_totals(variances, (parts - interaction) / (o * r))

    return _Squares(square, freedom, solve_variances), p_value


def _add_variance_totals(variances: _Variances, part: FloatArray) -> _Variances:
    """Return the variances, at least 0, with those of the gauge and in total."""
    entries = {name: np.maximum(values, 0.0) for name, values in variances.items()}
    part_variance, gauge_variance = np.maximum(part, 0.0), np.asarray(sum(entries.values()))
    return entries | {
        "gauge": gauge_variance,
        "part": part_variance,
        "total": gauge_variance + part_variance,
    }


def _draw_variances(squares: _Squares) -> _Variances:
    """Variances that could have given these mean squares."""
    chi_square = np.random.default_rng(_SEED).chisquare(
        squares.dof, (_DRAWS, len(squares.mean_squares))
    )
    return squares.solve_variances((squares.mean_squares * squares.dof / chi_square).T)
