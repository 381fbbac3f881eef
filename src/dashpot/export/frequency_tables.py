"""Frequency tables with a bounded interpolation error."""

from __future__ import annotations

from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from typing import Literal, TypeAlias

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray, FrozenArrays
from dashpot.base.errors import ExportError
from dashpot.solids.maxwell import Solid

Damping: TypeAlias = Literal["loss_factor", "damping"]
"""Second column beside the storage stiffness: K''/K', or the viscous equivalent K''/omega."""

_MAX_POINTS = 5000
_CHECKED_FRACTIONS = (np.arange(16) + 0.5) / 16  # where each interval is checked


@dataclass(frozen=True, eq=False)
class Table(FrozenArrays):
    """Table of storage stiffness and damping that a solver interpolates linearly.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz, ascending.
    storage : array, shape (n,)
        N/m.
    damping : array, shape (n,)
        Loss factor, or N s/m.
    error : float
        Largest relative error of the FRF of any mass on the solid, anywhere in the table.
    tolerance : float
        The requested error.
    """

    frequency: FloatArray
    storage: FloatArray
    damping: FloatArray
    error: float
    tolerance: float

    @property
    def sentence(self) -> str:
        """The sentence a deck prints."""
        return (
            f"table: {len(self.frequency)} points, {self.frequency[0]:.6g} to "
            f"{self.frequency[-1]:.6g} Hz; linear interpolation changes the FRF of any mass by at "
            f"most {self.error:.2g} (tolerance {self.tolerance:.2g}); not valid outside its range"
        )


def tabulate(
    solid: Solid,
    *,
    frequency_range: tuple[float, float],
    tolerance: float,
    damping: Damping,
    edges: tuple[float, ...] = (),
    rounded: Callable[[float], float] = float,
) -> Table:
    r"""Return the shortest table that keeps every FRF within `tolerance`.

    A mass m on the solid has the FRF :math:`1/(K - m\omega^2)`. A table with
    :math:`K + \Delta` changes that by the relative amount :math:`|\Delta| / |K + \Delta -
    m\omega^2|`, which is largest for the mass that resonates there, and never more than
    :math:`|\Delta| / \operatorname{Im}(K + \Delta)`. That bound is kept, so the table suits
    every mass. Each point is as far from the one before as the tolerance allows.

    Parameters
    ----------
    solid : Solid
    frequency_range : (float, float)
        Hz, 0 < low < high.
    tolerance : float
        Tolerance of the FRF, relative.
    damping : {"loss_factor", "damping"}
    edges : tuple of float
        Frequencies, Hz, included as points, such as the ends of the valid band.
    rounded : callable
        Rounds a number as the deck prints it: the error includes the rounding.

    Raises
    ------
    ExportError
        If the range or the tolerance cannot be, or the table would pass 5000 points.
    """
    low, high = frequency_range
    if not (np.isfinite([low, high]).all() and 0 < low < high):
        raise ExportError(f"frequency_range = {low:g}:{high:g} Hz; expected 0 < low < high")
    if not 0 < tolerance < 1:
        raise ExportError(f"tolerance = {tolerance!r}; expected a number between 0 and 1")
    if solid.k_0 == 0:
        raise ExportError("a dashpot alone has no storage stiffness to tabulate; export its arms")
    interpolation = _LinearInterpolation(solid, damping, rounded)
    points = [rounded(low)]
    end_points = sorted({rounded(edge) for edge in edges if low < edge < high} | {rounded(high)})
    interval = 0.1  # in ln f
    for stop in end_points:
        while points[-1] < stop:
            next_point, interval = interpolation.find_next_point(
                points[-1], stop, interval, tolerance
            )
            points.append(next_point)
            if len(points) > _MAX_POINTS:
                raise ExportError(
                    f"tolerance = {tolerance:g} needs more than {_MAX_POINTS} points between "
                    f"{low:g} and {high:g} Hz; ask for less, or for a narrower range"
                )
    f = np.array(points)
    return Table(f, *interpolation.values(f), error=interpolation.error(f), tolerance=tolerance)


@dataclass(frozen=True)
class _LinearInterpolation:
    """Straight lines between printed points of a solid's stiffness and damping."""

    solid: Solid
    damping: Damping
    round_value: Callable[[float], float]

    def values(self, f: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return storage stiffness and damping at `f`, Hz, as printed."""
        omega = 2 * np.pi * f
        K = self.solid.complex_stiffness(omega=omega)
        second_column = K.imag / (K.real if self.damping == "loss_factor" else omega)
        return (
            np.array([self.round_value(v) for v in K.real]),
            np.array([self.round_value(v) for v in second_column]),
        )

    def error(self, f: FloatArray) -> float:
        """Return largest relative error of any FRF, of lines with points at `f`."""
        storage, second_column = self.values(f)
        inner = f[:-1, None] + np.diff(f)[:, None] * _CHECKED_FRACTIONS
        grid = np.concatenate((f, inner.ravel()))
        omega = 2 * np.pi * grid
        K = self.solid.complex_stiffness(omega=omega)
        if not K.imag.any():
            return 0.0  # a spring: both of its lines are level
        real, second = (np.interp(grid, f, storage), np.interp(grid, f, second_column))
        imaginary = second * (real if self.damping == "loss_factor" else omega)
        with np.errstate(divide="ignore"):
            return float((np.abs(real + 1j * imaginary - K) / np.abs(imaginary)).max())

    def find_next_point(
        self, start: float, stop: float, interval: float, tolerance: float
    ) -> tuple[float, float]:
        """Return the next point and how far away it is in ln f: the error grows with its square."""
        for trial in range(60):
            next_point = min(stop, self.round_value(start * float(np.exp(interval))))
            if not next_point > start:
                break
            value = self.error(np.array([start, next_point]))
            wasteful = value < 0.8 * tolerance and next_point < stop and trial < 30
            if value <= tolerance and not wasteful:
                return next_point, interval
            factor = np.sqrt(0.9 * tolerance / max(value, 1e-300))
            interval *= float(np.clip(factor, 0.1, 4.0 if trial < 30 else 0.5))
        raise ExportError(
            f"no table reaches the tolerance {tolerance:g} near {start:g} Hz with the digits that "
            "the deck prints; ask for less"
        )


def round_band_inwards(band: tuple[float, float]) -> tuple[float, float]:
    """Return the band to four digits, no wider than it is."""
    low, high = (
        float(Decimal(end).normalize(Context(prec=4, rounding=rounding)))
        for end, rounding in zip(band, (ROUND_CEILING, ROUND_FLOOR), strict=True)
    )
    return low, high
