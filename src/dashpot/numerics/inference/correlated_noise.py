"""Correlated noise: parameter covariance, and whitened records."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IndexArray,
    block_means,
    cache_on_record,
    find_fast_length,
)
from dashpot.numerics.design_matrices.block import DataBlock, design_rows
from dashpot.numerics.design_matrices.data_compression import (
    FEW_DIGITS_ACCURACY,
    FEW_DIGITS_RANK_TOLERANCE,
    FEW_TIMES_PER_FOLD,
    Kernels,
)

if TYPE_CHECKING:
    from dashpot.numerics.exponential_fit import Solution

# Parameter covariance under correlated residuals.
#
# The covariance of a least-squares estimate whose noise has the autocovariance
# :math:`\gamma_l`, constant in time, is the Toeplitz sandwich
#
# .. math:: C = (J^T J)^{-1} \, J^T \Gamma J \, (J^T J)^{-1}, \qquad \Gamma_{ik} = \gamma_{|i-k|}
#
# The residuals show their own :math:`\gamma_l`; it is cut where the sum of two neighbouring lags
# first falls to zero (Geyer's initial positive sequence), beyond which it is noise itself.
# Source: C. J. Geyer, Statistical Science 7 (1992) 473.


# Share of the information below which a direction is rounding error.
_SINGULAR_SHARE = 1e-13
# kappa below which residuals are so nearly white that evenness is not tested
_MIN_KAPPA = 3.0
# noise as even as this costs least squares no more than a tenth of what the data know
_MAX_EVEN_GAIN = 2.0
# parameters per effective residual beyond which the fit's own part is given back lag by lag
_MIN_ABSORBED_SHARE = 0.005
_ITERATIONS = 3
# so few lags cost less one by one than by Fourier transforms
_DIRECT_LAGS, _DIRECT_TERMS = 16, 8
# most noise ends within this part of all lags, which costs two thirds of all
_MAX_LAG_SHARE = 1 / 3
# frequencies that stay in cache
_FREQUENCIES_PER_BATCH = 4096
# slow noise is sought in about so many means to a record, never of fewer samples than that; so many
# times the scatter of its power under white noise is no chance: one white record in 100 has more
_MEANS_PER_RECORD, _MIN_COUNT, _MAX_CHANCE_RATIO = 1024, 4, 6.0


@dataclass(frozen=True, eq=False)
class Noise:
    r"""Noise of one record, estimated from its residuals.

    Attributes
    ----------
    samples : int
        Number of residuals n.
    autocovariance : array, shape (lags,)
        :math:`\gamma_0, \gamma_1, \ldots` up to the cut, in the residual's unit squared.
    kappa : float
        :math:`1 + 2\sum_{l>0} \gamma_l/\gamma_0`, at least 1: n / kappa is the effective number of
        independent residuals.
    durbin_watson : float
        :math:`\sum (r_i - r_{i-1})^2 / \sum r_i^2`: 2 if white, towards 0 if correlated.
    """

    samples: int
    autocovariance: FloatArray
    kappa: float
    durbin_watson: float

    @property
    def effective(self) -> float:
        """Effective number of independent residuals, n / kappa."""
        return self.samples / self.kappa

    @property
    def power(self) -> float:
        """Sum of the autocovariance over all lags: the scatter of means over very many samples."""
        return float(self.autocovariance[0] * self.kappa)


class ResidualSeries:
    """Residual of one record in order of time, with its correlations.

    Attributes
    ----------
    values : array, shape (n,)
    """

    def __init__(self, values: FloatArray) -> None:
        self.values = values

    @cached_property
    def sequence(self) -> tuple[FloatArray, FloatArray | None]:
        """Initial sequence of the residuals, see :func:`compute_initial_sequence`."""
        return compute_initial_sequence(self.values)

    @cached_property
    def durbin_watson(self) -> float:
        """Durbin-Watson statistic of neighbours, as in :class:`Noise`."""
        steps = np.diff(self.values)
        return float(steps @ steps / (self.values @ self.values))

    @cached_property
    def means(self) -> ResidualSeries:
        """Return the series of means over a few samples."""
        return ResidualSeries(block_means(self.values, len(self.values) // _MEANS_PER_RECORD))


class JacobianColumns:
    """Derivatives of one record by the parameters, column by column, with Fourier transforms.

    Attributes
    ----------
    matrix : array, shape (n, r)
    shared : bool
        The columns are orthonormal over all the records that were fitted together, of which this
        is one: of each it takes but a part.
    """

    def __init__(self, matrix: FloatArray, *, is_shared: bool = False) -> None:
        self.matrix, self.shared = matrix, is_shared
        self._size, self._spectra = 0, np.zeros((0, 0), dtype=complex)

    @cached_property
    def gram(self) -> FloatArray:
        """The inner products, shape (r, r)."""
        return np.asarray(self.matrix.T @ self.matrix)

    @cached_property
    def whitening_matrix(self) -> FloatArray:
        """Matrix that makes the columns orthonormal over all fitted data, shape (r, s)."""
        return np.eye(self.matrix.shape[1]) if self.shared else _orthonormalise(self.gram)[0]

    @property
    def absorbed_count(self) -> float:
        """Number of residuals of white noise that the columns absorb in this record."""
        return float(np.trace(self.gram)) if self.shared else float(self.matrix.shape[1])

    def means(self, samples_per_mean: int) -> JacobianColumns:
        """Return the columns of means over a few samples."""
        mean_columns = block_means(self.matrix.T, samples_per_mean).T
        return JacobianColumns(
            np.sqrt(samples_per_mean) * mean_columns if self.shared else mean_columns,
            is_shared=self.shared,
        )

    def spectra(self, min_size: int) -> tuple[int, ComplexArray]:
        """Return the transforms as rows, padded to `min_size` samples or more, and their length."""
        if self._size < min_size:
            self._size = find_fast_length(min_size)
            rows = np.ascontiguousarray(self.matrix.T)
            self._spectra = np.asarray(np.fft.rfft(rows, self._size))
        return self._size, self._spectra


def estimate_noise(
    residual: FloatArray | ResidualSeries,
    jacobian: FloatArray | JacobianColumns | None = None,
    *,
    rounding: float = 0.0,
) -> Noise:
    r"""Return the noise estimated from `residual`, shape (n,).

    A fit takes the part of the noise that its columns span out of the residuals: with Q an
    orthonormal basis of the Jacobian and S the sum of all :math:`\gamma_l`,

    .. math:: E[\hat\gamma_l] = \gamma_l - \frac Sn \sum_k \sum_i Q_{ik} Q_{i+l,k}

    to first order, which is given back; for white noise that is the usual n/(n - p). Of records
    that were fitted together Q is the part of each in a basis of all.

    A slow wander much smaller than the scatter of the samples is lost among their correlations,
    though a sum of many lags of it is what the slow arms meet. So means over many samples, which
    scatter less, are asked as well.

    Residuals of rms below `rounding` are rounding errors, not noise: their pattern has no
    information.
    """
    series = ResidualSeries(residual) if isinstance(residual, np.ndarray) else residual
    columns = JacobianColumns(jacobian) if isinstance(jacobian, np.ndarray) else jacobian
    fine_noise = _estimate_noise(series, columns, rounding=rounding)
    samples_per_mean = len(series.values) // _MEANS_PER_RECORD
    if samples_per_mean < _MIN_COUNT or fine_noise.autocovariance[0] <= rounding**2:
        return fine_noise
    mean_columns = None if columns is None else columns.means(samples_per_mean)
    coarse_noise = _estimate_noise(series.means, mean_columns)
    # a sum over so many lags of white means scatters by that
    chance = np.sqrt(len(coarse_noise.autocovariance) / _MEANS_PER_RECORD)
    if samples_per_mean * coarse_noise.power <= (1 + _MAX_CHANCE_RATIO * chance) * fine_noise.power:
        return fine_noise
    return _join_noise_scales(fine_noise, coarse_noise.autocovariance, samples_per_mean)


def _join_noise_scales(
    fine_noise: Noise, slow_autocovariance: FloatArray, samples_per_mean: int
) -> Noise:
    """Return the noise of fine and coarse scales: of samples, and of means over a few."""
    gamma, fine_length = fine_noise.autocovariance, len(fine_noise.autocovariance)
    lag = np.arange(fine_length, max(samples_per_mean * len(slow_autocovariance), fine_length))
    # between one mean and its neighbour it is at least what neighbours share
    interpolated = np.interp(
        lag / samples_per_mean,
        np.arange(1, len(slow_autocovariance) + 1),
        np.append(slow_autocovariance[1:], 0.0),
    )
    joined_autocovariance = np.concatenate((gamma, interpolated))
    return Noise(
        fine_noise.samples,
        joined_autocovariance,
        _kappa(joined_autocovariance),
        fine_noise.durbin_watson,
    )


def _estimate_noise(
    series: ResidualSeries, columns: JacobianColumns | None, *, rounding: float = 0.0
) -> Noise:
    """Return the noise by the autocorrelation up to the lag at which it is chance."""
    n = len(series.values)
    kept_autocovariance, gamma = series.sequence
    parameters = 0.0 if columns is None else columns.absorbed_count
    whitened = n / max(n - parameters, 1.0)
    if kept_autocovariance[0] <= rounding**2:
        return Noise(n, kept_autocovariance[:1] * whitened, 1.0, 2.0)
    kappa = _kappa(kept_autocovariance)
    if columns is not None and parameters * kappa > _MIN_ABSORBED_SHARE * n:
        if gamma is None:
            gamma = autocovariance(series.values, max(int(_MAX_LAG_SHARE * n), 1))
        kept_autocovariance = _restore_autocovariance(gamma, kappa, columns)
        if len(kept_autocovariance) == len(gamma) < n:
            kept_autocovariance = _restore_autocovariance(
                autocovariance(series.values), kappa, columns
            )
        kappa = _kappa(kept_autocovariance)
    else:
        kept_autocovariance = kept_autocovariance * whitened
    return Noise(n, kept_autocovariance, kappa, series.durbin_watson)


def _kappa(gamma: FloatArray) -> float:
    return max(1.0, float(2.0 * gamma.sum() / gamma[0] - 1.0))


def _restore_autocovariance(
    gamma: FloatArray, kappa: float, columns: JacobianColumns
) -> FloatArray:
    """The autocovariance with what the fit took out of it, cut; uncut if all lags are too few."""
    n, parameters = len(columns.matrix), max(columns.absorbed_count, 1e-9)
    absorbed, restored_gamma = _compute_absorbed_autocovariance(columns, len(gamma)), gamma
    for _ in range(_ITERATIONS):
        restored = gamma + gamma[0] * min(kappa, n / (2.0 * parameters)) * absorbed / n
        restored_gamma = restored[: geyer_cut(restored)]
        if len(restored_gamma) == len(gamma) < n:
            break
        kappa = _kappa(restored_gamma)
    return restored_gamma


def _compute_absorbed_autocovariance(columns: JacobianColumns, lags: int) -> FloatArray:
    r"""Return :math:`\sum_k \sum_i Q_{ik} Q_{i+l,k}` at l = 0 .. `lags` - 1."""
    even_spectra = columns.whitening_matrix
    fft_length, spectra = columns.spectra(len(columns.matrix) + lags)
    rows, power = spectra.view(np.float64), np.empty(fft_length // 2 + 1)
    for first in range(0, len(power), _FREQUENCIES_PER_BATCH):
        rotated = even_spectra.T @ rows[:, 2 * first : 2 * (first + _FREQUENCIES_PER_BATCH)]
        squares = (rotated * rotated).sum(axis=0)
        power[first : first + _FREQUENCIES_PER_BATCH] = squares[::2] + squares[1::2]
    return np.asarray(np.fft.irfft(power, fft_length)[:lags])


def autocovariance(residual: FloatArray, lags: int | None = None) -> FloatArray:
    r"""Return :math:`\gamma_l = \frac1n \sum_i r_i r_{i+l}`, l = 0 .. `lags` - 1, by one FFT each.

    All n lags by default.
    """
    n = residual.shape[-1]
    lags = n if lags is None else lags
    fft_length = find_fast_length(n + lags)
    spectrum = np.fft.rfft(residual, fft_length)
    power = spectrum.real**2 + spectrum.imag**2
    return np.asarray(np.fft.irfft(power, fft_length)[..., :lags] / n)


def compute_initial_sequence(residual: FloatArray) -> tuple[FloatArray, FloatArray | None]:
    """Return :func:`autocovariance` up to :func:`geyer_cut`, and what of it was transformed.

    Lag by lag while lags are few, and none transformed; all lags only if the part where most noise
    ends does not show the cut.
    """
    n, values = len(residual), [float(residual @ residual)]
    for lag in range(1, min(_DIRECT_LAGS, n - 1), 2):
        # gamma_{lag - 1} is the first of the pair
        values.append(float(residual[lag:] @ residual[:-lag]))
        if values[-2] + values[-1] <= 0.0:
            return np.array(values[: max(lag - 1, 1)]) / n, None
        values.append(float(residual[lag + 1 :] @ residual[: -lag - 1]))
    gamma = autocovariance(residual, max(int(_MAX_LAG_SHARE * n), 1))
    if (cut_lag := geyer_cut(gamma)) == len(gamma):
        gamma = autocovariance(residual)
        cut_lag = geyer_cut(gamma)
    return gamma[:cut_lag], gamma


def geyer_cut(gamma: FloatArray) -> int:
    r"""Return how many lags to keep: up to the first :math:`\gamma_{2m}+\gamma_{2m+1} \le 0`."""
    return int(geyer_cuts(gamma))


def geyer_cuts(gamma: FloatArray) -> IndexArray:
    """Return :func:`geyer_cut` of many autocovariances (..., n) at once."""
    pairs = gamma[..., :-1:2] + gamma[..., 1::2]
    positive = np.logical_and.accumulate(~(pairs <= 0.0), axis=-1).sum(axis=-1)
    is_all_positive = positive == pairs.shape[-1]
    return np.asarray(np.where(is_all_positive, gamma.shape[-1], np.maximum(2 * positive, 1)))


def sandwich(
    jacobians: Sequence[FloatArray] | Directions,
    noises: Sequence[Noise],
    *,
    other_columns: Sequence[Callable[[FloatArray], FloatArray]] = (),
) -> FloatArray:
    r"""Return the covariance of the parameters, shape (p, p), from one Jacobian per record.

    Each record keeps its own noise: the middle of the sandwich is
    :math:`\sum_r J_r^T \Gamma_r J_r`. `other_columns` adds errors that are not constant in time: a
    function for each record that makes, of columns of its Jacobian (n, r), their products (m, r)
    with m independent errors of unit variance. A parameter that the data do not determine has an
    infinite variance and no correlation.
    """
    information = jacobians if isinstance(jacobians, Directions) else make_directions(jacobians)
    return information.covariance(information.sum_noise_gain(noises), other_columns=other_columns)


def noise_gain_ratio(information: Directions, noise_along: Sequence[FloatArray]) -> float:
    r"""Return how much more of the noise meets one direction of the parameters than another.

    The ratio u of the largest to the smallest eigenvalue of :math:`(J^TJ)^{-1} J^T\Gamma J`: 1 for
    white noise, and for any that is flat over the frequencies of the arms. Noise whose power
    varies by a factor u leaves least squares an efficiency of :math:`4u/(1+u)^2` at worst, 0.89
    at 2. Source: P. Bloomfield and G. S. Watson, Biometrika 62 (1975) 121.

    Parameters
    ----------
    information : Directions
    noise_along : sequence of array, shape (r, r)
        The noise of each record along them; further columns are no data.
    """
    if not information.parameter_directions.size:
        return 1.0
    rotation, _ = _orthonormalise(
        np.sum([columns.gram for columns in information.columns[: len(noise_along)]], axis=0)
    )
    noise_gains = np.linalg.eigvalsh(rotation.T @ np.sum(noise_along, axis=0) @ rotation)
    return float(noise_gains[-1] / noise_gains[0]) if noise_gains[0] > 0.0 else np.inf


def nearly_white(noises: Sequence[Noise]) -> bool:
    """Return True if the noise is so nearly white that its evenness need not be tested."""
    return all(noise.kappa <= _MIN_KAPPA for noise in noises)


def noise_gain_differs(ratio: float) -> bool:
    """Return True if least squares is no fair judge of what meets so different amounts of noise."""
    return ratio > _MAX_EVEN_GAIN


def white(jacobian: FloatArray, variance: float) -> FloatArray:
    """Return the covariance for independent residuals of this variance, shape (p, p)."""
    information = make_directions([jacobian])
    return information.covariance(variance * information.gram)


def toeplitz_form(columns: JacobianColumns, gamma: FloatArray) -> FloatArray:
    """Return J' Gamma J: a term a lag, or by Parseval's sum over the circulant around Gamma."""
    jacobian, lags = columns.matrix, len(gamma)
    n, _ = jacobian.shape
    if lags == 1:
        return np.asarray(gamma[0] * columns.gram)
    if lags <= min(_DIRECT_TERMS, n) and _is_power(gamma):
        form = gamma[0] * columns.gram
        for lag in range(1, lags):
            crossed = gamma[lag] * (jacobian[lag:].T @ jacobian[:-lag])
            form += crossed + crossed.T
        return np.asarray(form)
    fft_length, spectra = columns.spectra(n + lags - 1)
    circulant = np.zeros(fft_length)
    circulant[:lags] = gamma
    circulant[-(lags - 1) :] = gamma[:0:-1]
    # a cut autocovariance need not be positive definite; a power spectrum must not be negative
    spectrum = np.maximum(np.fft.rfft(circulant).real, 0.0)
    line_weights = np.full(len(spectrum), 2.0)
    line_weights[0] = 1.0
    if fft_length % 2 == 0:
        line_weights[-1] = 1.0
    # real and imaginary parts in turn, so that one real product serves both
    rows, power = spectra.view(np.float64), np.repeat(spectrum * line_weights / fft_length, 2)
    form = np.zeros((len(rows), len(rows)))
    for first in range(0, len(power), 2 * _FREQUENCIES_PER_BATCH):
        span = slice(first, first + 2 * _FREQUENCIES_PER_BATCH)
        form += (rows[:, span] * power[span]) @ rows[:, span].T
    return form


def _is_power(gamma: FloatArray) -> bool:
    """Return whether a few lags are those of a positive power spectrum."""
    power = np.fft.rfft(gamma, 64 * len(gamma)).real
    return bool((2.0 * power > gamma[0]).all())


class Directions(NamedTuple):
    """Directions of the parameters that the data determine, and the change of the data by each.

    Attributes
    ----------
    parameter_directions : array, shape (p, r)
        Parameters by direction.
    columns : tuple of JacobianColumns, shape (n, r)
        The Jacobians along the directions: orthonormal but for rounding.
    gram : array, shape (r, r)
        Their inner products, which take the rounding into account.
    is_undetermined : bool array, shape (p,)
        Parameters with a component in directions that the data do not determine.
    """

    parameter_directions: FloatArray
    columns: tuple[JacobianColumns, ...]
    gram: FloatArray
    is_undetermined: BoolArray

    def sum_noise_gain(self, noises: Sequence[Noise]) -> FloatArray:
        """Return the noise along the directions, shape (r, r)."""
        return np.asarray(
            np.sum([*map(self.compute_record_gain, range(len(noises)), noises)], axis=0)
        )

    def compute_record_gain(self, record: int, noise: Noise) -> FloatArray:
        """Return the gain of one record."""
        return toeplitz_form(self.columns[record], noise.autocovariance)

    def covariance(
        self,
        noise_along: FloatArray,
        *,
        other_columns: Sequence[Callable[[FloatArray], FloatArray]] = (),
    ) -> FloatArray:
        """Return the covariance of the parameters (p, p), infinite if undetermined."""
        noise_matrix = noise_along.copy()
        for absorbed_columns, columns in zip(other_columns, self.columns, strict=False):
            row = absorbed_columns(columns.matrix)
            noise_matrix += row.T @ row
        inverse_map = np.linalg.solve(self.gram, self.parameter_directions.T)
        covariance = inverse_map.T @ noise_matrix @ inverse_map
        covariance[self.is_undetermined, :] = 0.0
        covariance[:, self.is_undetermined] = 0.0
        covariance[self.is_undetermined, self.is_undetermined] = np.inf
        return np.asarray(covariance)


def make_directions(
    jacobians: Sequence[FloatArray], *, is_shared: bool = False, with_fine_scales: bool = False
) -> Directions:
    """Return orthonormal columns of Jacobians; `is_shared` if several records share them.

    The normal equations square the condition number, and what one direction that is hardly known
    loses to rounding would outweigh all that is known of the others. They only choose the
    directions; the result is computed from the rotated columns. With `with_fine_scales`, what J'J
    no longer knows is asked of J, whose rounding is the root of it: for data that are known to a
    millionth or better.
    """
    information = np.sum([jacobian.T @ jacobian for jacobian in jacobians], axis=0)
    rotation, is_undetermined = _orthonormalise(information)
    if with_fine_scales and is_undetermined.any():
        rotation, is_undetermined = _orthonormalise_finely(np.concatenate(jacobians))
    # a row for each direction, as they are transformed
    columns = tuple(
        JacobianColumns((rotation.T @ jacobian.T).T, is_shared=is_shared) for jacobian in jacobians
    )
    gram = np.sum([column.gram for column in columns], axis=0)
    return Directions(rotation, columns, gram, is_undetermined)


def _orthonormalise(information: FloatArray) -> tuple[FloatArray, BoolArray]:
    """The directions that J'J knows, orthonormal by it, and which parameters have lost a part."""
    scale = np.sqrt(np.diag(information))
    is_determined = scale > 0.0
    scale = np.where(is_determined, scale, 1.0)
    values, vectors = np.linalg.eigh(
        information / np.outer(scale, scale) - np.diag(~is_determined * 1.0)
    )
    sharp = values > _SINGULAR_SHARE * max(values[-1], 0.0)
    dull = np.abs(vectors[:, ~sharp]).max(axis=1, initial=0.0)
    rotation = vectors[:, sharp] / (np.sqrt(values[sharp]) * scale[:, None])
    return rotation, ~is_determined | (dull > np.sqrt(_SINGULAR_SHARE))


def _orthonormalise_finely(jacobian: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return :func:`_orthonormalise` by the singular values of J itself."""
    column_norms = np.linalg.norm(jacobian, axis=0)
    value = column_norms > 0.0
    scale = np.where(value, column_norms, 1.0)
    _, values, rows = np.linalg.svd(np.linalg.qr(jacobian / scale, mode="r"))
    sharp = values > _SINGULAR_SHARE * values[0]
    dull = np.abs(rows[~sharp]).max(axis=0, initial=0.0)
    rotation = rows[sharp].T / (values[sharp] * scale[:, None])
    return rotation, ~value | (dull > np.sqrt(_SINGULAR_SHARE))


# Whitening of a record by its own noise.
#
# Every model of a record lies, to seven digits, in the span of its fixed columns G and of the space
# :math:`\Phi V` of its kernels (:mod:`dashpot.numerics.design_matrices.data_compression`),
# :math:`[\Phi V,\, G] = QR`; what the data hold outside the span of Q no model can answer. With
# :math:`\Gamma` the Toeplitz matrix of the noise's autocovariance,
#
# .. math:: C = Q'\Gamma Q = V \,\mathrm{diag}(c)\, V', \qquad
#     \chi^2(\theta) = \sum_i \frac{\bigl(V'Q'(y - m(\theta))\bigr)_i^2}{\max(c_i, \gamma_0)}
#
# is the deviance of a model m in units of chi-square, and its least value is that of generalised
# least squares: fast detail counts for more where the noise is slow. No direction is trusted better
# than white noise of the same variance would let it be: a filter leaves next to nothing above its
# cut-off, and to believe that would let its transients decide. So slow noise is as good as white
# above some frequency, and means over a few neighbours, which keep what is below it, stand for the
# record. What a record holds beside the model, columns that are free or known to within a standard
# deviation, adds to that covariance too, and is taken out likewise (``marginalise``). Source: A. C.
# Aitken, Proceedings of the Royal Society of Edinburgh 55 (1936) 42.


# rows of a tall matrix that fit into the cache
ROWS_PER_BATCH = 1024


def whitened_block(exact: DataBlock, noise: Noise) -> DataBlock:
    """Return the data in coordinates whose noise is independent, of variance one at most.

    Parameters
    ----------
    exact : DataBlock
        Every sample a row, in the order of time.
    noise : Noise
        Noise of its residuals, with a positive variance.
    """
    basis = reduced_basis(exact, compute_averaging_length(noise))
    variance, axes = _principal(basis, noise)
    whiten = (axes / np.sqrt(variance)).T
    return basis.block.transform_rows(lambda part: whiten @ part)


def marginalise(
    free_columns: FloatArray, error_columns: FloatArray
) -> Callable[[FloatArray], FloatArray]:
    """Return the whitening of noise with covariance 1 + C C', free columns projected out.

    Parameters
    ----------
    free_columns : array, shape (n, q)
        Columns without a prior.
    error_columns : array, shape (n, m)
        C, known columns times their standard deviation.
    """
    private = np.linalg.qr(free_columns)[0]
    axes, stretch, _ = np.linalg.svd(
        error_columns - private @ (private.T @ error_columns), full_matrices=False
    )
    shrink_factor = 1 - 1 / np.sqrt(1 + stretch**2)

    def white(columns: FloatArray) -> FloatArray:
        residual = columns - private @ (private.T @ columns)
        components = axes.T @ residual
        return np.asarray(
            residual - axes @ (shrink_factor.reshape(-1, *[1] * (components.ndim - 1)) * components)
        )

    return white


class ReducedBasis(NamedTuple):
    """Record in the coordinates of its models.

    Attributes
    ----------
    basis : JacobianColumns, shape (n, r)
        Q, orthonormal columns, a row for each mean over a few samples times the root of how many.
    block : DataBlock
        Q'y, Q'G and Q' phi, r rows.
    """

    basis: JacobianColumns
    block: DataBlock


def reduced_basis(exact: DataBlock, samples_per_mean: int) -> ReducedBasis:
    """Return the span of a block that has every sample as a row, in the order of time.

    Of means over `samples_per_mean` neighbours; found once.
    """
    bases = _bases(exact)
    if samples_per_mean not in bases:
        bases[samples_per_mean] = _make_reduced_basis(exact, samples_per_mean)
    return bases[samples_per_mean]


@cache_on_record
def _bases(_: DataBlock) -> dict[int, ReducedBasis]:
    """Return the reduced bases of a block, by the number of averaged neighbours."""
    return {}


def _make_reduced_basis(exact: DataBlock, length: int) -> ReducedBasis:
    kernels = Kernels.from_window(
        exact.window, per_fold=FEW_TIMES_PER_FOLD, rank=FEW_DIGITS_RANK_TOLERANCE
    )
    target, fixed, *_ = exact.evaluate(np.zeros(0), False)

    def means(columns: FloatArray) -> FloatArray:
        return np.sqrt(length) * block_means(columns.T, length).T if length > 1 else columns

    space = kernels.space(exact, means)
    basis, factor = compute_blockwise_qr(np.concatenate((space, means(fixed)), axis=1))
    rank = kernels.column_basis.shape[1]
    rows = design_rows(basis.T @ means(target), factor[:, rank:], kernels.columns(factor[:, :rank]))
    return ReducedBasis(
        JacobianColumns(basis), replace(exact, rows=rows, accuracy=FEW_DIGITS_ACCURACY)
    )


def compute_blockwise_qr(tall_matrix: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Q and R of a tall matrix, by pieces that a cache holds."""
    pieces = [
        np.linalg.qr(tall_matrix[i : i + ROWS_PER_BATCH])
        for i in range(0, len(tall_matrix), ROWS_PER_BATCH)
    ]
    joint_basis, factor = np.linalg.qr(np.concatenate([piece.R for piece in pieces]))
    basis, row, piece_start = np.empty((len(tall_matrix), joint_basis.shape[1])), 0, 0
    for values, (rows, columns) in ((piece.Q, piece.Q.shape) for piece in pieces):
        np.matmul(
            values, joint_basis[piece_start : piece_start + columns], out=basis[row : row + rows]
        )
        row, piece_start = row + rows, piece_start + columns
    return basis, factor


class NoiseGain:
    r"""Noise power along a change d of the model, :math:`d'\Gamma d / d'd`.

    Parameters
    ----------
    every_sample : sequence of DataBlock
        One per record, every sample a row.
    noises : sequence of Noise
    solution : Solution
        The model that changes.
    """

    def __init__(
        self, every_sample: Sequence[DataBlock], noises: Sequence[Noise], solution: Solution
    ) -> None:
        from dashpot.numerics.exponential_fit import compute_full_jacobian
        from dashpot.numerics.log_tau_descent import Stack

        pairs = zip(every_sample, noises, strict=True)
        spans = [reduced_basis(block, compute_averaging_length(noise)) for block, noise in pairs]
        blocks = [basis.block for basis in spans]
        self._stack = Stack(blocks)
        self._cuts = np.cumsum([len(block.target) for block in blocks])[:-1]
        self._principal = [_principal(*pair) for pair in zip(spans, noises, strict=True)]
        self._jacobian = compute_full_jacobian(blocks, solution).matrix
        self._model = self._evaluate_model(solution.beta, solution.log_tau)

    def compute_step_gain(self, step: FloatArray) -> float:
        """Return it for a small step of the parameters, in the order of the Jacobian."""
        return self._compute_gain(self._jacobian @ step)

    def evaluate(self, beta: FloatArray, log_tau: FloatArray) -> float:
        """Return it for the way to other linear parameters and relaxation times."""
        return self._compute_gain(self._evaluate_model(beta, log_tau) - self._model)

    def _evaluate_model(self, beta: FloatArray, log_tau: FloatArray) -> FloatArray:
        return np.asarray(self._stack.evaluate(log_tau, derivative=False).phi @ beta)

    def _compute_gain(self, change: FloatArray) -> float:
        change = change / max(float(np.abs(change).max()), 1e-150)  # a walk may go very far
        record_changes = np.split(change, self._cuts)
        principal_gain = sum(
            float(variance @ (axes.T @ record_change) ** 2)
            for record_change, (variance, axes) in zip(record_changes, self._principal, strict=True)
        )
        return principal_gain / max(float(change @ change), 1e-300)


def compute_averaging_length(noise: Noise) -> int:
    r"""Return how many neighbours may count as one, a power of two.

    Noise of correlation :math:`\kappa` falls to the power of white noise of its variance at some
    :math:`1/(\pi\sqrt\kappa)` of a sample's frequency, for an autoregressive one: means over a
    quarter of :math:`\sqrt\kappa` samples leave what is slower than that.
    """
    return 1 << max(int(np.log2(noise.kappa) / 2 - 2), 0)


def _principal(basis: ReducedBasis, noise: Noise) -> tuple[FloatArray, FloatArray]:
    """Return the variances of the noise along its principal axes, and these as columns."""
    gamma, samples_per_mean = noise.autocovariance, compute_averaging_length(noise)
    noise_along = toeplitz_form(
        basis.basis,
        gamma if samples_per_mean == 1 else _average_autocovariance(gamma, samples_per_mean),
    )
    variance, axes = np.linalg.eigh(noise_along)
    return np.maximum(variance, gamma[0]), axes


def _average_autocovariance(gamma: FloatArray, samples_per_mean: int) -> FloatArray:
    """Return the autocovariance of means over `samples_per_mean` neighbours, times that number."""
    lag_weights = 1 - np.abs(np.arange(1 - samples_per_mean, samples_per_mean)) / samples_per_mean
    # from the lag -(few - 1) on, and as far as any is left
    two_sided = np.concatenate(
        (gamma[samples_per_mean - 1 : 0 : -1], gamma, np.zeros(2 * samples_per_mean))
    )
    return np.asarray(np.convolve(two_sided, lag_weights, "valid")[::samples_per_mean])
