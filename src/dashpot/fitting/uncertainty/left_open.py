r"""What relaxation tests say of the stiffness at the end of their hold, and of where it ends.

An arm slower than every hold is a spring there: no record bounds k_inf from below. What it knows is

.. math:: k(t) = k_\infty + \sum_j k_j e^{-t/\tau_j}

at the time T that it was held, and less and less of it at 3 T, and how steeply it still falls,
:math:`-dk/d\ln t`: all over every spectrum that the tests do not reject
(:mod:`dashpot.fitting.uncertainty.admissible_spectra`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.fitting.relaxation_data import RelaxationData
from dashpot.fitting.uncertainty.admissible_spectra import AdmissibleSpectra, deviance_limit
from dashpot.records.bounds import EndOfHold
from dashpot.records.estimate import Interval
from dashpot.solids.maxwell import GeneralizedMaxwell


def end_of_hold(
    relaxations: Sequence[RelaxationData],
    *,
    time: float,
    own: GeneralizedMaxwell,
    dof: float,
    level: float = 0.95,
) -> EndOfHold:
    """Return the limits of k(T), k(3 T), k_inf, and of the slope at T.

    They hold the fit itself: nothing is printed outside its own interval.

    Parameters
    ----------
    relaxations : sequence of RelaxationData
    time : float
        T, how long the longest of them was held, s.
    own : GeneralizedMaxwell
        The fit.
    dof : float
        Degrees of freedom of the noise.
    level : float
        Coverage of each limit, nearly.
    """
    spectra = AdmissibleSpectra(
        relaxations, fastest=1 / time, limit=deviance_limit(level, dof), further=own.tau
    )
    at_once = spectra.relaxed_to(np.inf)
    k_end, k_3end = (_above_zero(spectra.reach(spectra.relaxed_to(n * time))) for n in (1, 3))
    falling = spectra.falling_at(time)
    here = float(own.relaxation(time))
    missed = max(k_end[0] - here, here - k_end[1], 0.0)
    found = EndOfHold(
        time=time,
        k_end=k_end,
        k_3end=k_3end,
        k_inf=(0.0, float(at_once @ spectra.farthest(at_once))),
        falling=float(falling @ spectra.farthest(falling)),
        beyond=missed / max(k_end[1] - k_end[0], 1e-300),
        named=_left_if_named(relaxations, spectra, time),
    )
    return holding(found, own)


def holding(end: EndOfHold, own: GeneralizedMaxwell) -> EndOfHold:
    """Return limits that hold a fit itself, too: nothing is printed outside its own interval."""
    here, later = (float(own.relaxation(n * end.time)) for n in (1, 3))
    return replace(
        end,
        k_end=_holding(end.k_end, here),
        k_3end=_holding(end.k_3end, later),
        k_inf=(0.0, max(end.k_inf[1], own.k_inf)),
    )


def _left_if_named(
    relaxations: Sequence[RelaxationData], spectra: AdmissibleSpectra, time: float
) -> float:
    """What is left of the width of k(T) if give, settling and drift were named; nan if they are.

    About the best spectrum, whose arms are free: to first order.
    """
    if not any(data.unseen for data in relaxations):
        return float("nan")
    tau = spectra.tau[spectra.best[2:] > 0]
    goal = np.append(1.0, np.exp(-time / tau))

    def variance(data: Sequence[RelaxationData]) -> float:
        rows = [one.rows(np.log(tau), slopes=False) for one in data]
        matrix = np.vstack([np.column_stack((one.spring, one.arms)) for one in rows])
        scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
        along = np.linalg.lstsq((matrix / scale).T, goal / scale, rcond=1e-9)[0]
        return float(along @ along)

    return float(np.sqrt(variance([one.on_a_named_rig for one in relaxations])
                         / variance(relaxations)))  # fmt: skip


def _holding(reach: Interval, own: float) -> Interval:
    return min(reach[0], own), max(reach[1], own)


def _above_zero(reach: Interval) -> Interval:
    """Limits of a sum that cannot be negative, freed of rounding."""
    return max(reach[0], 0.0), max(reach[1], 0.0)
