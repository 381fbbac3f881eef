"""Natural frequencies, damping ratios and residues of FRFs of one or several points."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from dashpot.base import replace
from dashpot.base.errors import DataError
from dashpot.base.option_fields import require_choice
from dashpot.datamodel.frf import FRF, Kind, Mode
from dashpot.datamodel.structure import FRFSet, ModeShape
from dashpot.registry import require_handler
from dashpot.vibration.modal.peaks import find_mount_band
from dashpot.vibration.modal.pole_fit import FRFLines, find_poles

# Modes common to several FRFs.


MIN_BAND_LINES = 8
MAX_MODES, MAX_MODES_OF_SET = 6, 24
"""Modes sought in one FRF, about a mount's resonance, and in a set of them."""


def compute_rms_accelerance(points: FRFSet) -> FRF:
    """Return the root mean square of the accelerances of all points, each over its own size.

    Its value has no phase. It shows where to look for modes, and where a chart's peaks are.
    """
    value = points.accelerance
    power = np.abs(value) ** 2
    base = power.mean(axis=1, keepdims=True)
    rms_values = np.sqrt((power / base).mean(axis=0) * base.mean())
    first, scatter = points.frfs[0].to(Kind.ACCELERANCE), points.sd
    sd = None if scatter is None else np.sqrt((scatter**2 / base).mean(axis=0) * base.mean())
    return FRF(first.frequency, rms_values.astype(complex), sd=sd, units="SI")


def get_set_lines(points: FRFSet) -> FRFLines:
    """Return the accelerances of a set as lines to be fitted, a row for each point."""
    first = points.frfs[0].to(Kind.ACCELERANCE)
    return FRFLines.from_measurement(
        first.s, points.accelerance, points.sd, record=first.record, pulse=first.pulse
    )


def select_mode_band(points: FRFSet, band: tuple[float, float] | None) -> FRFSet:
    """The lines where modes are sought, by default about where the points together move most.

    Raises
    ------
    DataError
        If they are fewer than 8.
    """
    all_of_them = compute_rms_accelerance(points)
    f = all_of_them.frequency
    low, high = band or find_mount_band(f, all_of_them.value, all_of_them.sd)
    keep = (f >= low) & (f <= high) & (f > 0)
    if np.count_nonzero(keep) < MIN_BAND_LINES:
        raise DataError(
            f"{np.count_nonzero(keep)} lines between {low:g} and {high:g} Hz; modes need at least "
            f"{MIN_BAND_LINES}, and the FRF has lines from {f[0]:.3g} to {f[-1]:.4g} Hz: "
            "give a band within, or record longer"
        )
    accelerances = tuple(frf.to(Kind.ACCELERANCE).only(keep) for frf in points.frfs)
    return replace(points, frfs=accelerances)


def find_shapes(
    points: FRFSet, *, band: tuple[float, float] | None = None, count: int | None = None
) -> tuple[ModeShape, ...]:
    """Poles that all points share and each point's residues; see :meth:`.FRFSet.modes`."""
    return find_mode_shapes(select_mode_band(points, band), count)


def find_mode_shapes(band_frfs: FRFSet, count: int | None = None) -> tuple[ModeShape, ...]:
    """Modes on all lines of accelerances, by `find_poles`; the largest motion first."""
    max_modes = MAX_MODES if len(band_frfs.frfs) == 1 else MAX_MODES_OF_SET
    fit = find_poles(get_set_lines(band_frfs), max_modes=max_modes, count=count)
    if fit is None:
        return ()
    # a window spreads each line's noise over its neighbours, which then count less
    first = band_frfs.frfs[0]
    window_decay = 0.5 * first.shift * (first.record or 0.0)
    widening = float(np.sqrt(window_decay / np.tanh(window_decay))) if window_decay > 0 else 1.0
    se = widening * np.sqrt(np.diag(fit.covariance))
    shapes = []
    for i, p in enumerate(fit.poles):
        residues, errors = fit.residues[:, i], widening * fit.residue_se[:, i]
        largest_point = int(np.argmax(np.abs(residues)))
        values = (float(se[2 * i]), float(se[2 * i + 1]), float(errors[largest_point]))
        mode = make_mode(complex(p), complex(residues[largest_point]), values, "rational")
        shapes.append(ModeShape(mode, residues / p**2, errors / abs(p) ** 2, float(fit.misfit[i])))
    return tuple(sorted(shapes, key=lambda shape: -float(np.linalg.norm(shape.residues))))


def make_mode(
    p: complex, residue: complex, errors: tuple[float, float, float], method: str
) -> Mode:
    """Turn a pole and the accelerance's residue into a mode, errors of sigma and omega and all."""
    sigma_se, omega_se, residue_se = errors
    pole_magnitude = abs(p)
    return Mode(
        frequency=pole_magnitude / (2 * np.pi),
        damping_ratio=-p.real / pole_magnitude,
        residue=residue / p**2,
        frequency_se=float(np.hypot(p.imag * omega_se, p.real * sigma_se))
        / pole_magnitude
        / (2 * np.pi),
        damping_ratio_se=float(np.hypot(p.imag * sigma_se, p.real * omega_se))
        * p.imag
        / pole_magnitude**3,
        residue_se=residue_se / pole_magnitude**2,
        method=str(method),
    )


# Modes of one FRF.


class Method(StrEnum):
    """Method of modal analysis."""

    RATIONAL = "rational"  # rational fraction with the kernel of a finite record
    PEAK = "peak"  # parabola through the highest line
    HALF_POWER = "half-power"  # width of the peak at 1/sqrt(2) of its height
    CIRCLE = "circle"  # circle in the plane of the mobility
    DECREMENT = "decrement"  # logarithmic decrement of the impulse response


def find_modes(
    frf: FRF,
    *,
    method: Method | str = Method.RATIONAL,
    band: tuple[float, float] | None = None,
    count: int | None = None,
) -> tuple[Mode, ...]:
    """Modes of a measured accelerance; see :meth:`dashpot.datamodel.frf.FRF.modes`."""
    require_choice("method", method, Method)
    method = Method(method)
    band_frfs = select_mode_band(FRFSet((frf,)), band)
    if method is Method.RATIONAL:
        # cached with the FRF, which is frozen, by the first and the last of these lines
        cached_modes: dict[object, tuple[Mode, ...]] = vars(frf).setdefault("_modes", {})
        key = (*band_frfs.frfs[0].frequency[[0, -1]].tolist(), count)
        if key not in cached_modes:
            cached_modes[key] = tuple(shape.mode for shape in find_mode_shapes(band_frfs, count))
        return cached_modes[key]
    if count not in (None, 1):
        raise DataError(f"method {method.value!r} reads one mode, not {count}; use 'rational'")
    mode: Mode = require_handler("read resonance", "frf")(method, band_frfs.frfs[0])
    return (mode,)
