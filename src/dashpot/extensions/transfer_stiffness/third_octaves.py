"""Third-octave bands (IEC 61260-1, base ten), and means of a complex stiffness over them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray, IndexArray

_EDGE_RATIO = 10 ** (1 / 20)
"""Edge of a band over its centre."""
_NOMINAL = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)
"""Nominal centres of one decade (ISO 266)."""
_EDGE_TOLERANCE = 1e-9
"""Relative distance from an edge within which a frequency lies on it."""


MIN_LINES = 5
"""Lines of a third octave of which the standard takes a mean (ISO 10846-2, -3)."""


class ThirdOctave(NamedTuple):
    """Third-octave band: nominal and exact centre, and its edges, Hz."""

    nominal: float
    centre: float
    low: float
    high: float


def list_third_octaves(low: float, high: float) -> tuple[ThirdOctave, ...]:
    r"""Return the third-octave bands that lie between two frequencies, Hz, as a whole.

    .. math:: f_n = 10^{n/10}\,\mathrm{Hz}, \qquad f_n\,10^{\mp 1/20}
    """
    first = int(np.ceil(10 * np.log10(low * _EDGE_RATIO) - _EDGE_TOLERANCE))
    last = int(np.floor(10 * np.log10(high / _EDGE_RATIO) + _EDGE_TOLERANCE))
    bands = []
    for n in range(first, last + 1):
        decade, band_index = divmod(n, 10)
        centre = float(10 ** (n / 10))
        nominal = float(f"{_NOMINAL[band_index] * 10.0**decade:.12g}")
        bands.append(ThirdOctave(nominal, centre, centre / _EDGE_RATIO, centre * _EDGE_RATIO))
    return tuple(bands)


def assign_lines(
    frequency: FloatArray, bands: tuple[ThirdOctave, ...]
) -> tuple[tuple[int, int], ...]:
    """Return for each band the index of its first line, and that after its last.

    Parameters
    ----------
    frequency : array, shape (n,)
        Hz, rising.
    bands : tuple of ThirdOctave
    """
    edges = [
        (band.low * (1 - _EDGE_TOLERANCE), band.high * (1 - _EDGE_TOLERANCE)) for band in bands
    ]
    return tuple(
        (int(np.searchsorted(frequency, low)), int(np.searchsorted(frequency, high)))
        for low, high in edges
    )


class BandMeans(NamedTuple):
    r"""Means over groups of lines, with the 95 % limits of each.

    Attributes
    ----------
    stiffness : array, shape (bands,)
        :math:`\sqrt{\overline{|k|^2}}`, N/m.
    stiffness_limits, loss_factor_limits : array, shape (2, bands)
    loss_factor : array, shape (bands,)
    """

    stiffness: FloatArray
    stiffness_limits: FloatArray
    loss_factor: FloatArray
    loss_factor_limits: FloatArray


def compute_band_means(
    stiffness: ComplexArray,
    starts: IndexArray,
    *,
    random: FloatArray,
    common: ComplexArray,
    quantile: float,
) -> BandMeans:
    r"""Return the mean stiffness and loss factor of groups of lines, with their limits.

    .. math::

        \bar k = \sqrt{\tfrac1n \sum |k_i|^2}, \qquad
        \bar\eta = \frac{\mathrm{Im}\sum k_i}{\mathrm{Re}\sum k_i}

    Random errors of the lines are independent; an error that lines have in common does not
    average out. The mean of squares is larger than the square by the noise: the limits
    are those of the mean less :math:`2\overline{\sigma_i^2}`.

    Parameters
    ----------
    stiffness : complex array, shape (n,)
        N/m, by groups.
    starts : array of int, shape (bands,)
        First line of each group; a group ends where the next begins.
    random : array, shape (n,)
        Standard deviation of the real and of the imaginary part of :math:`d\ln k`.
    common : complex array, shape (m, n)
        What one standard error of each common cause does to :math:`\ln k`.
    quantile : float
        Half width of the limits, standard errors.
    """

    def add(values: FloatArray | ComplexArray) -> FloatArray | ComplexArray:
        return np.add.reduceat(values, starts, axis=-1)

    count = np.diff(np.append(starts, len(stiffness)))
    power = np.abs(stiffness) ** 2
    total_power, total_stiffness = np.asarray(add(power)), np.asarray(add(stiffness))
    mean = np.sqrt(total_power / count)
    noise = np.asarray(add(2 * power * random**2)) / total_power
    relative_sd = np.sqrt(np.asarray(add((power * random) ** 2))) / total_power
    shifts = np.asarray(add(power * common.real)) / total_power
    error = np.sqrt(relative_sd**2 + (shifts**2).sum(axis=0))
    middle = mean * np.sqrt(np.maximum(1 - noise, 0.0))
    factor = np.exp(quantile * error)
    limits = np.array([middle / factor, np.maximum(middle * factor, mean)])

    eta = total_stiffness.imag / total_stiffness.real
    turn = np.asarray(add(stiffness * common)) / total_stiffness
    random_turn = np.sqrt(np.asarray(add(power * random**2))) / np.abs(total_stiffness)
    half_width = quantile * (1 + eta**2) * np.sqrt(random_turn**2 + (turn.imag**2).sum(axis=0))
    return BandMeans(mean, limits, eta, np.array([eta - half_width, eta + half_width]))


def estimate_line_noise(stiffness: ComplexArray) -> float:
    r"""Return the relative random error of lines that state none, by their second differences.

    Of independent errors :math:`\mathrm{E}|k_{i-1} - 2k_i + k_{i+1}|^2 = 12\sigma^2`; the median
    of such squares is ln 2 of their mean. 0 of fewer than five lines.

    Parameters
    ----------
    stiffness : complex array, shape (n,)
        Stiffness of neighbouring lines.
    """
    if len(stiffness) < MIN_LINES:
        return 0.0
    second = np.diff(stiffness, 2) / stiffness[1:-1]
    return float(np.sqrt(np.median(np.abs(second) ** 2) / (12 * np.log(2))))
