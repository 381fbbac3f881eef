"""Lines of an FRF to be fitted, and what a pole looks like on them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray

# no line of a measured FRF is trusted beyond this part of its value: leakage and aliasing remain
FLOOR = 1e-3
FLOOR_OF_TOP = 3e-4  # and of the highest line: leakage is modelled that well


@dataclass(frozen=True, eq=False)
class FRFLines:
    """FRF lines to be fitted: one row of `value` and `sd` per channel.

    Attributes
    ----------
    s : complex array, shape (n,)
    value : complex array, shape (channels, n)
        Accelerance, 1/kg.
    sd : array, shape (channels, n)
    record : float or None
        Length of the record after the hit, s; None if the response was not cut.
    pulse : float
        Rms width of the hit, s.
    """

    s: ComplexArray
    value: ComplexArray
    sd: FloatArray
    record: float | None
    pulse: float = 0.0

    @classmethod
    def measured(
        cls,
        s: ComplexArray,
        value: ComplexArray,
        sd: FloatArray | None,
        *,
        record: float | None,
        pulse: float = 0.0,
    ) -> FRFLines:
        """Lines as an FRF holds them; `value` and `sd` of shape (channels, n)."""
        size = np.abs(value)
        top = size.max(axis=1, keepdims=True)
        error = np.broadcast_to(FLOOR * top, size.shape)
        if sd is not None:
            error = np.sqrt(sd**2 + (FLOOR * size) ** 2 + (FLOOR_OF_TOP * top) ** 2)
        return cls(s, value, error, record, pulse)

    def only(self, keep: BoolArray) -> FRFLines:
        """The chosen lines."""
        return replace(self, s=self.s[keep], value=self.value[:, keep], sd=self.sd[:, keep])


def kernel(lines: FRFLines, p: complex | ComplexArray) -> ComplexArray:
    r"""Transform of :math:`e^{pt}` over the record (:mod:`.rational_fraction`), shape (n,).

    Of poles of shape (k, 1) it is a row for each.
    """
    s = lines.s
    if lines.record is None:
        return np.asarray(1 / (s - p))
    return np.asarray(-np.expm1(_compute_log_truncation(lines, p)) / (s - p))


def _compute_log_truncation(lines: FRFLines, p: complex | ComplexArray) -> ComplexArray:
    """Logarithm of the part that the end of the record takes."""
    T = lines.record or 0.0
    return np.asarray((p - lines.s) * T + 0.5 * lines.pulse**2 * (p**2 - lines.s**2))


def kernel_slope(lines: FRFLines, p: complex | ComplexArray) -> ComplexArray:
    """Derivative of :func:`kernel` by the pole."""
    k = kernel(lines, p)
    if lines.record is None:
        return k**2
    later = lines.record + lines.pulse**2 * p
    return np.asarray((k - later * np.exp(_compute_log_truncation(lines, p))) / (lines.s - p))
