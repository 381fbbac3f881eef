"""Disturbances of the force by machine, mains and climate that no channel shows."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.machine import DEFAULT_UNCERTAINTIES, Machine
from dashpot.solids.maxwell import GeneralizedMaxwell

# Disturbances of the force by the machine and the climate that no channel records.


# Mains frequencies and their tolerance, Hz.
MAINS_FREQUENCIES, MAINS_TOLERANCE = (50.0, 60.0), 0.05
# K, of which the change is taken
_TEMPERATURE_STEP = 0.5
# s for which a seal may have been pressed before its record
USUAL_PRESSED_TIME = 30.0


def build_machine_terms(
    machine: Machine,
    solid: GeneralizedMaxwell,
    time: FloatArray,
    x: FloatArray,
    *,
    time_since_stop: FloatArray,
    ramp_time: float,
    depth: float,
    has_settling: bool = True,
) -> dict[str, tuple[FloatArray, float]]:
    """Return what machine and crosshead may add, in N a m, and its standard deviation in m.

    The machine gives under the force; its crosshead settles after its stop.

    Parameters
    ----------
    machine : Machine
    solid : GeneralizedMaxwell
    time, x : array, shape (n,)
        s, and the motion that it is thought to feel, m.
    time_since_stop : array, shape (n,)
        Since the end of the ramp, s.
    ramp_time, depth : float
        s and m.
    has_settling : bool
        No reading would show it if the crosshead did.
    """
    force = solid.force(time, x)
    entries: dict[str, tuple[FloatArray, float]] = {}
    peak = float(np.abs(force).max())
    give = machine.give_sd(depth, peak)
    if give > 0 and peak > 0:
        entries["give"] = solid.force(time, force / peak), give
    creep = machine.creep_sd(depth)
    if creep > 0 and has_settling:
        log_time = np.log1p(np.maximum(time_since_stop, 0.0) / ramp_time)
        entries["settling"] = solid.force(time, log_time), creep
    return entries


def build_earlier_press(
    machine: Machine, solid: GeneralizedMaxwell, time: FloatArray, *, depth: float
) -> tuple[FloatArray, float]:
    r"""Return the remaining force of earlier presses, N per m, and the standard deviation in m.

    An arm that was pressed for D, and left alone for R, pulls by

    .. math:: k_j m_j e^{-t/\tau_j}, \qquad m_j = (1 - e^{-D/\tau_j})\, e^{-R/\tau_j}
    """
    tau = np.asarray(solid.tau)
    memory = _compute_residual_stiffness(solid, machine.min_rest_time)
    return -np.exp(-time[:, None] / tau) @ memory, DEFAULT_UNCERTAINTIES[
        "earlier press"
    ].size * depth


def compute_set_sd(
    machine: Machine, solid: GeneralizedMaxwell, *, depth: float, gap: float
) -> float:
    """Return the standard deviation of how much of a gap, m, is the set of an earlier press, m.

    A set recovers as the solid relaxes.
    """
    usual_stiffness = float(
        _compute_residual_stiffness(solid, DEFAULT_UNCERTAINTIES["rest after it"].size).sum()
    )
    ratio = (
        float(_compute_residual_stiffness(solid, machine.min_rest_time).sum()) / usual_stiffness
        if usual_stiffness > 0
        else 0.0
    )
    return min(gap / 2, DEFAULT_UNCERTAINTIES["set"].size * depth * ratio)


def _compute_residual_stiffness(solid: GeneralizedMaxwell, rest_time: float) -> FloatArray:
    """Return what each arm keeps of a press after a rest, s, over its compression, N/m."""
    tau = np.asarray(solid.tau)
    return np.asarray(-np.expm1(-USUAL_PRESSED_TIME / tau) * np.exp(-rest_time / tau) * solid.k)


def build_folded_mains(time: FloatArray, *, step: float) -> tuple[FloatArray, ...]:
    r"""Return lines of the mains that a converter without a filter folds to rest, of size 1.

    At a rate of which 50 or 60 Hz is a multiple, its alias is slower than the record: no spectrum
    shows it, and it looks like relaxation. The mains are off by up to `MAINS_TOLERANCE`; so a
    record is asked about a half and a whole turn of it. Empty at any other rate.

    Parameters
    ----------
    time : array, shape (n,)
        Since the first sample, s.
    step : float
        From one sample to the next, s.
    """
    duration = float(time[-1])
    if not step > 0 or not duration > 0:
        return ()
    aliases = [
        abs(mains - round(mains * step) / step) for mains in MAINS_FREQUENCIES if mains * step > 0.5
    ]
    if not aliases or min(aliases) > MAINS_TOLERANCE + 1 / duration:
        return ()
    turns = [2 * np.pi * part * time / duration for part in (0.5, 1.0)]
    return tuple(np.asarray(line(phase)) for phase in turns for line in (np.cos, np.sin))


def compute_warming(
    time: FloatArray,
    x: FloatArray,
    solid: GeneralizedMaxwell,
    *,
    by_a: float = -DEFAULT_UNCERTAINTIES["faster by warmth"].size,
    by_b: float = 0.0,
    start_time: float = 0.0,
) -> FloatArray:
    r"""Return the change of force if the seal warms by one kelvin until the end of its record, N/K.

    It answers in reduced time :math:`\xi = \int dt/a(T(t))`, its stiffnesses times b(T(t)).

    Parameters
    ----------
    time, x : array, shape (n,)
        s and m.
    solid : GeneralizedMaxwell
        At the temperature of the test.
    by_a, by_b : float
        Slopes of ln a_T and of ln b_T there, 1/K.
    start_time : float
        From when on it warms evenly, s: until then it has the temperature that is meant.
    """
    temperature_rise = (
        _TEMPERATURE_STEP * np.maximum(time - start_time, 0.0) / (time[-1] - start_time)
    )
    # time counts for more as the seal gets faster
    time_factor = np.exp(-by_a * temperature_rise)
    reduced = np.concatenate(
        ([0.0], np.cumsum(np.diff(time) * (time_factor[1:] + time_factor[:-1]) / 2))
    )
    change = np.exp(by_b * temperature_rise) * solid.force(reduced, x) - solid.force(time, x)
    return np.asarray(change / _TEMPERATURE_STEP)
