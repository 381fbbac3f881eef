r"""What a test says of the stiffness when it ends, and of where that ends.

An arm slower than every hold is a spring there: no record bounds k_inf from below. What it knows is

.. math:: k(t) = k_\infty + \sum_j k_j e^{-t/\tau_j}

at the time T that it was held, and less and less of it at 3 T, and how steeply it still falls,
:math:`-dk/d\ln t`: all over every spectrum that the tests do not reject
(:mod:`dashpot.fitting.uncertainty.admissible_spectra`). Of a sweep it knows the storage at its
lowest line, and less of it below; of creep the compliance.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.bounds import Ended, EndOfHold
from dashpot.datamodel.parameter_estimate import Interval
from dashpot.fitting.relaxation_data import RelaxationData, misfits
from dashpot.fitting.uncertainty.admissible_spectra import AdmissibleSpectra, deviance_limit
from dashpot.solids.maxwell import GeneralizedMaxwell

if TYPE_CHECKING:
    from dashpot.fitting.uncertainty.band_limits import BeforeCurve
    from dashpot.fitting.uncertainty.curve_data import CurveData

# so many T later a compliance is asked for its most stiffness at rest: one that flows has no end
AT_REST = 100.0


def spectra_of_holds(
    relaxations: Sequence[RelaxationData],
    *,
    time: float,
    own: GeneralizedMaxwell,
    dof: float,
    level: float = 0.95,
) -> AdmissibleSpectra:
    """Return the spectra that some holds do not reject, as :func:`compute_end_limits` asks."""
    spectra = AdmissibleSpectra(
        relaxations, fastest=1 / time, limit=deviance_limit(level, dof), extra=own.tau
    )
    spectra.validate_misfit(*misfits(relaxations))
    return spectra


def compute_end_limits(
    relaxations: Sequence[RelaxationData],
    *,
    time: float,
    own: GeneralizedMaxwell,
    dof: float,
    level: float = 0.95,
    spectra: AdmissibleSpectra | None = None,
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
    spectra : AdmissibleSpectra, optional
        Those of :func:`spectra_of_holds`, where they are known already.
    """
    if spectra is None:
        spectra = spectra_of_holds(relaxations, time=time, own=own, dof=dof, level=level)
    falling = spectra.falling_at(time)
    end = EndOfHold(
        time=time,
        k_end=_reach(spectra, spectra.relaxed_to(time)),
        k_3end=_reach(spectra, spectra.relaxed_to(3 * time)),
        k_inf=(0.0, _highest(spectra, spectra.relaxed_to(np.inf))),
        falling=_highest(spectra, falling),
        named=_compute_named_rig_share(relaxations, spectra, time),
    )
    return end.holding(own)


def spectra_of_curve(
    data: CurveData | BeforeCurve, *, time: float, extra: Sequence[float], level: float = 0.95
) -> AdmissibleSpectra:
    """Return the spectra that a curve does not reject; the parameters of :func:`end_of_curve`."""
    return AdmissibleSpectra(
        [data], fastest=1 / time, limit=deviance_limit(level, data.dof), extra=extra
    )


def end_of_curve(
    data: CurveData,
    ended: Ended,
    *,
    time: float,
    model: GeneralizedMaxwell,
    extra: Sequence[float],
    level: float = 0.95,
    spectra: AdmissibleSpectra | None = None,
) -> EndOfHold:
    """Return the limits of a curve at its end, 3 and 10 times as late, and of where it ends.

    They hold the fit itself.

    Parameters
    ----------
    data : CurveData
    ended : str
        What it is of: a modulus over time, storage and loss, or a compliance.
    time : float
        T, s; of a sweep 1/omega of its lowest line.
    model : GeneralizedMaxwell
        The fit.
    extra : sequence of float
        Its relaxation times, of creep its retardation times, s.
    level : float
        Coverage of each limit, nearly.
    spectra : AdmissibleSpectra, optional
        Those of :func:`spectra_of_curve`, where they are known already.
    """
    if spectra is None:
        spectra = spectra_of_curve(data, time=time, extra=extra, level=level)

    def reach(times: float) -> Interval:
        return _compute_curve_limits(spectra, ended, times * time)

    k_end, rest = reach(1), reach(AT_REST if ended == "creep" else np.inf)
    if ended == "creep":
        # k = 1/J falls by J'/J^2
        falling = _highest(spectra, spectra.creeping_at(time)) * k_end[1] ** 2
    else:
        falling = _highest(spectra, spectra.falling_at(time))
    end = EndOfHold(
        time=time,
        k_end=k_end,
        k_3end=reach(3),
        k_10end=reach(10),
        k_inf=(0.0, rest[1]),
        falling=falling,
        ended=ended,
    )
    return end.holding(model)


def _compute_curve_limits(spectra: AdmissibleSpectra, ended: Ended, time: float) -> Interval:
    """Limits of k(t), K'(1/t) or 1/J(t)."""
    if ended == "sweep":
        return _reach(spectra, spectra.stiffness_at(1 / time)[0])
    if ended == "creep":
        least, most = _reach(spectra, spectra.crept_to(time))
        return (1 / most if most > 0 else np.inf), (1 / least if least > 0 else np.inf)
    return _reach(spectra, spectra.relaxed_to(time))


def _compute_named_rig_share(
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
        rows = [relaxation_data.rows(np.log(tau), slopes=False) for relaxation_data in data]
        matrix = np.vstack([np.column_stack((row.spring, row.arms)) for row in rows])
        scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
        along = np.linalg.lstsq((matrix / scale).T, goal / scale, rcond=1e-9)[0]
        return float(along @ along)

    return float(np.sqrt(variance([relaxation.on_a_named_rig for relaxation in relaxations])
                         / variance(relaxations)))  # fmt: skip


def _reach(spectra: AdmissibleSpectra, v: FloatArray) -> Interval:
    """Limits of a sum that cannot be negative, freed of rounding."""
    low, high = spectra.reach(v)
    return max(low, 0.0), max(high, 0.0)


def _highest(spectra: AdmissibleSpectra, v: FloatArray) -> float:
    return float(v @ spectra.find_extreme_spectrum(v))
