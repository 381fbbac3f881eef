r"""Separability of a complex stiffness in compression, amplitude and frequency, pair by pair.

:math:`K^* = h(c)\,\Gamma(f)\,s(X)` is additive in its logarithm, :math:`\ln|K^*|` and the loss
angle :math:`\varphi`:

.. math::

    \ln|K^*| = \alpha_c + \beta_f + \gamma_X + \epsilon, \qquad
    \varphi = \beta'_f + \gamma'_X + \epsilon'

with a real factor of the compression. Each pair is an interaction of a two-way layout: columns
that a separable stiffness does not need. Of a pair with frequency they are a slope and a bend over
ln f of each level, of compression and frequency also an angle of each compression; of compression
and amplitude one level of each combination. F tests of Fisher and Yates say whether the columns
lower the sum of squares by more than chance: those that differ within a sweep against the scatter
of its lines, those that differ between sweeps against the scatter of sweeps repeated at one
setting, where there are any. A pair has several such statistics, of magnitude and of angle; the
chance of the least of their probabilities is that of independent ones (Sidak).

Source: H. Scheffe, *The Analysis of Variance* (1959), ch. 4; Z. Sidak, *JASA* 62 (1967).
"""

from __future__ import annotations

from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.errors import DataError
from dashpot.base.serialisation import Serialisable
from dashpot.base.student_t import t_quantile
from dashpot.extensions.preload_map.stiffness_lines import StiffnessLines
from dashpot.numerics.inference.model_order import bic

Pair: TypeAlias = Literal[
    "compression and frequency", "amplitude and frequency", "compression and amplitude"
]
_SHAPES = 2
"""Degree of the polynomial in ln f by which levels may differ."""
_RANK = 1e-9
_ZERO_VARIANCE = 1e-24
"""Sum of squares due to rounding."""
_DEGREES = range(1, 9)
"""Degrees over ln f of sweeps that share no frequencies."""
_MIN_DOF = 4
_MIN_CHANCE = 1e-9
"""Probability below which no scatter is known to be normal."""
SIGNIFICANCE_LEVEL = 0.01
"""Least probability by chance of a separable pair."""
NEGLIGIBLE = 0.01
"""Departure from a separable stiffness, relative or in rad, that is too small to matter."""


@dataclass(frozen=True)
class PairTest(Serialisable):
    """Test of one pair of variables for separability.

    Attributes
    ----------
    pair : str
    tested : bool
        The sweeps hold combinations that show it.
    chance : float or None
        Probability of a departure as clear as this if there is none.
    departure, departure_limit : float or None
        Largest relative departure of the stiffness from a separable one over all lines, as
        estimated and at most at 95 %.
    angle, angle_limit : float or None
        The same of the loss angle, rad.
    """

    pair: Pair
    tested: bool
    chance: float | None = None
    departure: float | None = None
    departure_limit: float | None = None
    angle: float | None = None
    angle_limit: float | None = None

    @property
    def is_negligible(self) -> bool:
        """The sweeps exclude every departure that matters."""
        return max(self.departure_limit or 0.0, self.angle_limit or 0.0) < NEGLIGIBLE

    @property
    def is_separable(self) -> bool | None:
        """The departure is no clearer than chance, or negligible; None without a test."""
        if not self.tested or self.chance is None:
            return None
        return self.chance >= SIGNIFICANCE_LEVEL or self.is_negligible

    @property
    def shown_chance(self) -> str:
        """The probability, as people read it; empty of a pair without a test."""
        if self.chance is None:
            return ""
        return f"{self.chance:.2g}" if self.chance > _MIN_CHANCE else f"below {_MIN_CHANCE:g}"


class Layout(NamedTuple):
    """Columns of one part, magnitude or angle.

    `main` is what a separable stiffness needs, `within` and `between` what each pair adds within
    sweeps and between them.
    """

    main: FloatArray
    within: dict[Pair, FloatArray]
    between: dict[Pair, FloatArray]

    @property
    def all_columns(self) -> FloatArray:
        """All columns."""
        return np.hstack((self.main, *self.within.values(), *self.between.values()))


class SweepScatter(NamedTuple):
    """Scatter of one part, magnitude or angle.

    `line` of a line and its degrees of freedom, `sweep` of whole sweeps beside it; `mean_square`
    that differences between sweeps are held against, and its degrees of freedom.
    """

    line: float
    dof: int
    sweep: float
    mean_square: float
    sweep_dof: int


def build_frequency_columns(lines: StiffnessLines) -> FloatArray:
    """Return columns of the common dependence on frequency, the mean among them."""
    if lines.shares_tones:
        return _make_level_columns(lines.frequency_index, len(lines.distinct_frequencies))
    u, y = lines.centred_frequency, lines.magnitude
    sweep_columns = _make_level_columns(lines.sweep, int(lines.sweep.max()) + 1)

    def score(degree: int) -> float:
        rss, rank = _fit(
            np.hstack((_make_legendre_columns(u, degree), sweep_columns)), y, lines.weight
        )
        return bic(rss, effective=len(y), parameters=rank, rounding_sse=_ZERO_VARIANCE)

    return _make_legendre_columns(u, min(_DEGREES, key=score))


def build_layouts(lines: StiffnessLines) -> tuple[Layout, Layout]:
    """Return the columns of magnitude and of angle."""
    frequency = build_frequency_columns(lines)
    compression = _make_level_columns(lines.compression, len(lines.compressions))
    amplitude = _make_level_columns(lines.amplitude, len(lines.amplitudes))
    degree = min(_SHAPES, len(lines.distinct_frequencies) - 1)
    shapes = _make_legendre_columns(lines.centred_frequency, degree)[:, 1:]
    within_columns: dict[Pair, FloatArray] = {
        "compression and frequency": _multiply_columns(compression, shapes),
        "amplitude and frequency": _multiply_columns(amplitude, shapes),
    }
    cells = _multiply_columns(compression, amplitude)
    return (
        Layout(
            np.hstack((frequency, compression, amplitude)),
            within_columns,
            {"compression and amplitude": cells},
        ),
        Layout(
            np.hstack((frequency, amplitude)),
            within_columns,
            {"compression and frequency": compression, "compression and amplitude": cells},
        ),
    )


def estimate_scatter(
    lines: StiffnessLines, values: FloatArray, layout: Layout, stated_scatter: float
) -> SweepScatter:
    """Return the scatter of lines and of whole sweeps.

    That of sweeps is shown by those repeated at one setting; else it is `stated_scatter`.

    Raises
    ------
    DataError
        If too few lines remain to estimate the scatter.
    """
    within_columns = np.hstack((layout.main, *layout.within.values()))
    sweeps = _make_level_columns(lines.sweep, int(lines.sweep.max()) + 1)
    rss, rank = _fit(np.hstack((within_columns, sweeps)), values, lines.weight)
    dof = len(values) - rank
    if dof < _MIN_DOF:
        raise DataError(
            f"{len(values)} lines in {sweeps.shape[1]} sweeps are too few to distinguish scatter "
            "from a departure. Measure at more frequencies, the same in every sweep"
        )
    line = rss / dof
    cells = np.hstack(
        (within_columns, _multiply_columns(_make_level_columns(lines.compression,
        len(lines.compressions)),
                           _make_level_columns(lines.amplitude, len(lines.amplitudes))))
    )  # fmt: skip
    rss_cells, rank_cells = _fit(cells, values, lines.weight)
    repeats = rank - rank_cells
    lines_per_sweep = len(values) / sweeps.shape[1]
    if repeats > 0:
        mean_square = (rss_cells - rss) / repeats
        sweep = float(np.sqrt(max(mean_square - line, 0.0) / lines_per_sweep))
        return SweepScatter(float(np.sqrt(line)), dof, sweep, float(mean_square), repeats)
    return SweepScatter(
        float(np.sqrt(line)),
        dof,
        stated_scatter,
        float(line + lines_per_sweep * stated_scatter**2),
        dof,
    )


def judge_pairs(
    lines: StiffnessLines,
    layouts: tuple[Layout, Layout],
    scatters: tuple[SweepScatter, SweepScatter],
) -> tuple[PairTest, ...]:
    """Return the test of every pair that the sweeps vary."""
    values = (lines.magnitude, lines.angle)
    pairs: list[Pair] = ["compression and frequency"]
    if len(lines.amplitudes) > 1:
        pairs += ["amplitude and frequency", "compression and amplitude"]
    return tuple(_test_pair(pair, lines, values, layouts, scatters) for pair in pairs)


def _test_pair(
    pair: Pair,
    lines: StiffnessLines,
    values: tuple[FloatArray, FloatArray],
    layouts: tuple[Layout, Layout],
    scatters: tuple[SweepScatter, SweepScatter],
) -> PairTest:
    chances: list[float] = []
    sizes: list[tuple[float, float]] = []
    for y, layout, scatter in zip(values, layouts, scatters, strict=True):
        chances += _compute_probabilities(pair, lines, y, layout, scatter)
        sizes.append(_find_largest_departure(pair, lines, y, layout, scatter))
    if not chances:
        return PairTest(pair, tested=False)
    chance = 1 - (1 - min(chances)) ** len(chances)
    (size, largest), (turn, most_turn) = sizes
    return PairTest(
        pair, True, float(chance), float(np.expm1(size)), float(np.expm1(largest)), turn, most_turn
    )


def _compute_probabilities(
    pair: Pair, lines: StiffnessLines, y: FloatArray, layout: Layout, scatter: SweepScatter
) -> list[float]:
    """Return the p-values of the terms of a pair within sweeps and between them."""
    # a rare path: scipy's F distribution costs an import that a plain fit does not pay
    from scipy.special import fdtrc

    sweeps = _make_level_columns(lines.sweep, int(lines.sweep.max()) + 1)
    other_columns = [columns for name, columns in layout.within.items() if name != pair]
    between_columns = [columns for name, columns in layout.between.items() if name != pair]
    chances = []
    if pair in layout.within:
        base_columns = np.hstack((layout.main, sweeps, *other_columns))
        gain, rank = _compute_gain(base_columns, layout.within[pair], y, lines.weight)
        if rank:
            chances.append(float(fdtrc(rank, scatter.dof, gain / rank / scatter.line**2)))
    if pair in layout.between:
        base_columns = np.hstack((layout.main, *layout.within.values(), *between_columns))
        gain, rank = _compute_gain(base_columns, layout.between[pair], y, lines.weight)
        if rank:
            chances.append(float(fdtrc(rank, scatter.sweep_dof, gain / rank / scatter.mean_square)))
    return chances


def _find_largest_departure(
    pair: Pair, lines: StiffnessLines, y: FloatArray, layout: Layout, scatter: SweepScatter
) -> tuple[float, float]:
    """Return the largest departure that a pair adds over all lines, and its 95 % limit."""
    pair_columns = [group[pair] for group in (layout.within, layout.between) if pair in group]
    other_columns = [
        columns
        for group in (layout.within, layout.between)
        for name, columns in group.items()
        if name != pair
    ]
    if not pair_columns:
        return 0.0, 0.0
    weighted_columns, w = (
        np.hstack((layout.main, *other_columns)) * lines.weight[:, None],
        lines.weight,
    )
    # the part of the columns that a separable stiffness with the other pairs does not follow
    columns = np.hstack(pair_columns) * w[:, None]
    independent_columns = (
        columns - weighted_columns @ np.linalg.lstsq(weighted_columns, columns, rcond=_RANK)[0]
    )
    basis = _make_orthonormal_basis(independent_columns)
    if not basis.shape[1]:
        return 0.0, 0.0
    size = basis @ (basis.T @ (y * w)) / w
    variance = scatter.line**2 * (basis**2).sum(axis=1)
    if scatter.sweep:
        sums = _make_level_columns(lines.sweep, int(lines.sweep.max()) + 1) * w[:, None]
        variance += scatter.sweep**2 * ((basis @ (basis.T @ sums)) ** 2).sum(axis=1)
    se = np.sqrt(variance) / w
    t = t_quantile(0.95, min(scatter.dof, scatter.sweep_dof))
    return float(np.abs(size).max()), float((np.abs(size) + t * se).max())


def _make_legendre_columns(u: FloatArray, degree: int) -> FloatArray:
    """Return the polynomials of Legendre up to a degree, a column each."""
    return np.asarray(np.polynomial.legendre.legvander(u, degree), dtype=float)


def _make_level_columns(group: IndexArray, count: int) -> FloatArray:
    """Return one column of ones and zeros for each level."""
    return np.asarray(group[:, None] == np.arange(count), dtype=float)


def _multiply_columns(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return every product of a column of the one with a column of the other."""
    return np.asarray((first[:, :, None] * second[:, None, :]).reshape(len(first), -1))


def _make_orthonormal_basis(A: FloatArray) -> FloatArray:
    """Return an orthonormal basis of the columns."""
    u, size, _ = np.linalg.svd(A, full_matrices=False)
    min_singular_value = _RANK * max(float(size.max(initial=0.0)), 1.0)
    is_significant: BoolArray = size > min_singular_value
    return u[:, is_significant]


def _fit(A: FloatArray, y: FloatArray, weight: FloatArray) -> tuple[float, int]:
    """Return the residual sum of squares of columns, and the number of independent ones."""
    basis = _make_orthonormal_basis(A * weight[:, None])
    residual = y * weight - basis @ (basis.T @ (y * weight))
    return float(residual @ residual), basis.shape[1]


def _compute_gain(
    base_columns: FloatArray, added_columns: FloatArray, y: FloatArray, weight: FloatArray
) -> tuple[float, int]:
    """Return by how much columns lower the sum of squares beside others, and their number."""
    base_misfit, rank = _fit(base_columns, y, weight)
    residual_after, rank_after = _fit(np.hstack((base_columns, added_columns)), y, weight)
    return max(base_misfit - residual_after, 0.0), rank_after - rank
