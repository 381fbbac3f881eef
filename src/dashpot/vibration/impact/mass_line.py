"""The mass line: a free block answers 1/m, which calibrates hammer and accelerometers in place."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray

ABOVE = 2.5  # times the natural frequency the mass line begins


def apparent_mass(
    frequency: FloatArray,
    accelerance: ComplexArray,
    *,
    natural_frequency: float,
    shift: float = 0.0,
    sd: FloatArray | None = None,
) -> tuple[float, float] | None:
    r"""Mass that the FRF shows above its resonance, and its standard error, kg.

    .. math:: \mathrm{Re}\,\frac1A = m + \mathrm{Re}\,\frac{K}{s^2}

    is a straight line in :math:`\mathrm{Re}\,s^{-2}`, whose end is the mass, from 2.5 times the
    natural frequency up. None if fewer than 5 good lines lie there.
    """
    size = np.abs(accelerance)
    keep: BoolArray = (frequency > ABOVE * natural_frequency) & (size > 0)
    if sd is not None:
        keep = keep & (sd < 0.3 * size)
    if np.count_nonzero(keep) < 5:
        return None
    inverse = 1 / accelerance[keep]
    x = (1 / (2j * np.pi * frequency[keep] + shift) ** 2).real
    relative = 1e-3 if sd is None else np.hypot(sd[keep] / size[keep], 1e-3)
    w = 1 / (relative * np.abs(inverse))
    rows = np.column_stack((np.ones_like(x), x / np.abs(x).max())) * w[:, None]
    c, *_ = np.linalg.lstsq(rows, inverse.real * w, rcond=None)
    misfit = inverse.real * w - rows @ c
    scale = float(misfit @ misfit) / (len(x) - 2)
    return float(c[0]), float(np.sqrt(np.linalg.inv(rows.T @ rows)[0, 0] * scale))
