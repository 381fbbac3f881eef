"""Compliance of a creep test, corrected to an ideal step."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import FitError
from dashpot.datamodel.fit import Fit
from dashpot.extensions.curves.creep.fit import estimate_preload_baseline, fit_creep
from dashpot.extensions.curves.creep.preprocess import load_hold
from dashpot.extensions.curves.datamodel.creep import (
    COMPLIANCES,
    CreepCompliance,
    CreepTest,
    LoadHold,
)

# Values per decade of time, each the mean of the recorded samples in its interval.
_PER_DECADE = 10
# a value is the mean of so many samples at least, and a curve has so many values
_MIN_SAMPLES, _MIN_COUNT = 4, 5
# times shorter than this part of the ramp are those of the ramp, not of the part
_OF_THE_RAMP = 1.0


def fitted_displacement(fit: Fit, data: LoadHold) -> FloatArray:
    """The fitted displacement at every sample, m, with its offset, drift and delay."""
    time = data.time - data.time[0]
    displacement = fit.solid.displacement(time, data.load)
    terms = {
        "offset": np.ones(len(time)),
        "drift": time,
        "delay": np.gradient(displacement, time),
    }
    items = [
        nuisance.value * terms[nuisance.name]
        for nuisance in fit.estimate.nuisance
        if nuisance.name in terms
    ]
    return np.asarray(displacement + np.sum(items, axis=0))


def measured_compliance(test: CreepTest | LoadHold) -> CreepCompliance:
    r"""Return the creep compliance that a test measured, free of its ramp and of its zero.

    A ramped load and a position before it are no part of J(t). The test's own fit knows both, so
    the compliance is that of the fit with what the record leaves of it added over the load,

    .. math:: J(t_i) = J_\mathrm{fit}(t_i) + \overline{(x - x_\mathrm{fit})}_i / F

    in means over even steps of log t through the hold, t counted from the middle of the ramp. A
    drift of the reading that is not visible before the load is not removed: one test cannot
    distinguish it from slow creep, several temperatures can.

    Parameters
    ----------
    test : CreepTest or LoadHold
        A raw test is prepared.

    Raises
    ------
    DataError, FitError
        As :func:`~dashpot.extensions.curves.creep.fit.fit_creep`, or if the hold is too short for a
        curve.
    """
    record = load_hold(test) if isinstance(test, CreepTest) else test
    fit = fit_creep(record)
    remainder = record.displacement - fitted_displacement(fit, record)
    if not estimate_preload_baseline(record).has_measured_drift:
        drift = sum(
            nuisance.value for nuisance in fit.estimate.nuisance if nuisance.name == "drift"
        )
        remainder = remainder + drift * (record.time - record.time[0])
    remainder = remainder[record.hold] / record.level
    time_since_ramp = record.time[record.hold] - (record.onset + record.ramp_end) / 2
    shortest = max(
        _OF_THE_RAMP * record.ramp_time, _MIN_SAMPLES * float(np.median(np.diff(time_since_ramp)))
    )
    bin_edges = np.arange(np.log10(shortest), np.log10(time_since_ramp[-1]) + 1e-9, 1 / _PER_DECADE)
    bin_index = np.digitize(np.log10(np.maximum(time_since_ramp, shortest / 10)), bin_edges)
    counts = np.bincount(bin_index, minlength=len(bin_edges) + 1)
    filled_bins = np.flatnonzero(counts >= _MIN_SAMPLES)
    filled_bins = filled_bins[filled_bins > 0]
    if len(filled_bins) < _MIN_COUNT:
        raise FitError(
            f"the hold of {record.hold_time:.3g} s after a ramp of {record.ramp_time:.3g} s gives "
            f"{len(filled_bins)} values of a compliance; expected at least "
            f"{_MIN_COUNT}: hold longer"
        )
    time, mean = (
        np.bincount(bin_index, values, minlength=len(counts))[filled_bins] / counts[filled_bins]
        for values in (time_since_ramp, remainder)
    )
    return CreepCompliance(
        time,
        fit.solid.creep(time) + mean,
        COMPLIANCES[record.unit],
        record.specimen,
        record.source,
        units="SI",
    )
