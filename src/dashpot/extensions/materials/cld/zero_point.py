"""Zero of compression and force in a load deflection record."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, find_true_runs, median
from dashpot.datamodel.relaxation import find_quantum
from dashpot.extensions.materials.strokes import Stroke
from dashpot.preprocessing.contact import MIN_AIR_SAMPLES, find_contact, find_first_contact
from dashpot.signals.noise import estimate_robust_scatter

_MIN_REST_SAMPLES = 5
"""Smallest number of samples for a mean that is subtracted."""
_DRIFT_TOLERANCE = 1e-3
"""Error of a mean of the force in air, as a part of the peak, with which it shows a drift."""
_PARABOLA = 1e-3
"""Part of the depth by which first contact is off where the rise is no parabola, as of a seal that
relaxes while it is met: over 240 records with 1 mN of noise, up to this."""
_SIGNIFICANT_AIR = 5.0
"""Distance of first contact from the start, in standard errors, that shows an air gap."""
MAX_PRELOAD = 0.05
"""Force at the first sample, as a part of the rise, that may be the load cell's own zero."""


class Zero(NamedTuple):
    """Zeros of compression and force.

    Attributes
    ----------
    contact, contact_se : float
        Compression of first contact on the scale of the record, and its standard error, m.
    comes_through_air : bool
        Whether the record shows the plate in air before contact.
    force : array, shape (n,)
        Offset to subtract from the force, N.
    force_se : float
        Standard error of that, N.
    drift : float
        Change of the zero over the record, N.
    preload : float
        Preload of the first samples, which is not removed, N.
    initial_force_ratio : float
        Force at the first samples over the rise, without a motion through air.
    noise : float
        N.
    """

    contact: float
    contact_se: float
    comes_through_air: bool
    force: FloatArray
    force_se: float
    drift: float
    preload: float
    initial_force_ratio: float
    noise: float


def find_zero(
    clock: FloatArray, x: FloatArray, force: FloatArray, first: Stroke, *, resolution: float
) -> Zero:
    """Find first contact in the first stroke, and the load cell's zero wherever there is air.

    The zero is a line through its means from one stay in air to the next. A record that begins in
    contact has its zero at its first samples, unless they carry more than a twentieth of the rise:
    this is a preload, which is not removed.
    """
    noise = max(estimate_robust_scatter(clock, force), find_quantum(force) / 12**0.5)
    has_rest = first.first + 1 >= _MIN_REST_SAMPLES
    start = slice(0, first.first + 1)
    level, rest_position, top = (
        median(force[start]),
        median(x[: first.first + 1]),
        float(x[first.last]),
    )
    force_rise = float(force[first.last]) - level
    first_contact = find_first_contact(
        x[: first.last + 1],
        force[: first.last + 1] - level,
        noise=noise,
        rest_position=rest_position,
        level=top,
        least_gap=max(2 * resolution, 1e-3 * (top - rest_position)),
        is_rested=has_rest,
    )
    if first_contact.gap > _SIGNIFICANT_AIR * first_contact.standard_error:
        margin = max(3 * first_contact.standard_error, resolution)
        return _measure_air_force(
            clock, x, force, first_contact.displacement,
            float(np.hypot(first_contact.standard_error,
            _PARABOLA * (top - first_contact.displacement))),
            margin=margin, noise=noise, force_rise=force_rise,
        )  # fmt: skip
    begins = abs(level) / max(abs(force_rise), 1e-300)
    tare = level if begins <= MAX_PRELOAD else 0.0
    return Zero(
        rest_position, 0.25 * resolution, False, np.full(len(x), tare), noise / start.stop**0.5,
        0.0,
        level - tare, begins, noise,
    )  # fmt: skip


def _measure_air_force(
    clock: FloatArray,
    x: FloatArray,
    force: FloatArray,
    contact: float,
    contact_se: float,
    *,
    margin: float,
    noise: float,
    force_rise: float,
) -> Zero:
    rest_runs = find_true_runs(x < contact - margin)
    counts = np.diff(rest_runs, axis=1)[:, 0] + 1
    is_long = counts >= max(
        _MIN_REST_SAMPLES, (noise / (_DRIFT_TOLERANCE * max(force_rise, 1e-300))) ** 2
    )
    is_long[0] = True
    means = [(float(clock[a : b + 1].mean()), float(force[a : b + 1].mean()))
             for a, b in rest_runs[is_long].tolist()]  # fmt: skip
    positions, level = np.array(means).T
    return Zero(
        contact,
        contact_se,
        True,
        np.interp(clock, positions, level),
        noise / float(counts[is_long].min()) ** 0.5,
        float(level[-1] - level[0]),
        0.0,
        0.0,
        noise,
    )


def find_later_contact(x: FloatArray, force: FloatArray, *, noise: float) -> float | None:
    """Return the compression at which a later loading meets the seal, m; None if in no air."""
    contact = find_contact(x, force, noise=noise)
    return None if contact is None or contact.sample < MIN_AIR_SAMPLES else contact.displacement
