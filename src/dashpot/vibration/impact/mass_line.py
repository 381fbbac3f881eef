"""The mass line: a free block answers 1/m, which calibrates hammer and accelerometers in place."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.checks import Check

TOLERANCE = 0.05  # ISO 7626-2, 7.5.2
ABOVE = 2.5  # times the natural frequency the mass line begins
G = 9.80665


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


def mass_line_check(apparent: tuple[float, float] | None, mass: float) -> Check:
    """Hold the apparent mass against the weighed one."""
    if apparent is None:
        return Check(
            "mass_line",
            False,
            f"no good lines above {ABOVE:g} times the natural frequency, so the calibration could "
            "not be checked against the mass; take a harder tip or widen the band",
            None,
            TOLERANCE,
        )
    shown, se = apparent
    factor = shown / mass
    says = (
        f"above resonance the block shows {1000 * shown:.4g} ± {1000 * se:.2g} g where "
        f"{1000 * mass:.4g} g were weighed"
    )
    error = factor - 1
    if abs(error) <= TOLERANCE:
        return Check(
            "mass_line", True, says + f": calibrated within {100 * error:+.1f} %", error, TOLERANCE
        )
    return Check("mass_line", False, says + f"; {_why(factor)}", error, TOLERANCE)


def _why(factor: float) -> str:
    if factor < 0:
        return "the sign is wrong: turn the polarity of the hammer or of the accelerometers"
    for unit, ratio in (
        ("the acceleration seems to be in g, not in m/s^2", G),
        ("the acceleration seems to be in m/s^2 but was taken for g", 1 / G),
        ("the mass seems to be in grams or the force in mN", 1e-3),
        ("the mass seems to be in tonnes or the force in kN", 1e3),
    ):
        if abs(factor / ratio - 1) < 2 * TOLERANCE:
            return f"a factor of {factor:.4g}: {unit}"
    return (
        f"a calibration factor of {1 / factor:.4g} on the FRF would agree; check sensitivities, "
        "and whether the weighed mass is what moves"
    )
