r"""Leave-one-out prediction: each hit by a joint fit to the others.

Any fit agrees with its own data. The error on an unused hit is more informative: each hit in turn
is compared with the fit to the relaxation tests and all other hits, over the lines around the
resonance,

.. math:: \varepsilon_i = \mathrm{rms}|A_i - \hat A_i| / \mathrm{rms}|A_i|
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.fitting.identification.identify import identify
from dashpot.vibration.mass_on_seals import MassOnSeals, predict_frf
from dashpot.vibration.modal.peaks import find_peak
from dashpot.workflow.frf_comparison import LeaveOneOut
from dashpot.workflow.job import HammerChoices
from dashpot.workflow.measured_frf import average

_MIN_COUNT, _MAX_HITS = 3, 8
"""Smallest number of hits, and the largest number that are left out in turn."""
_BAND_RATIO = 2.3
"""Times the resonance to either side."""


def cross_validate_hits(
    impact: ImpactTest,
    tests: Sequence[RampHold],
    fit: Fit,
    load: MassOnSeals,
    *,
    choices: HammerChoices,
    band: tuple[float, float] | None = None,
) -> LeaveOneOut | None:
    """Predict each accepted hit from the others; None if there are fewer than three.

    Parameters
    ----------
    impact : ImpactTest
    tests : sequence of RampHold
        The relaxation tests that the hits were fitted together with.
    fit : Fit
        The joint fit: how many arms it has.
    load : MassOnSeals
    choices : HammerChoices
    band : (float, float), optional
        Lines compared, Hz; by default a factor of 2.3 about the resonance.
    """
    average_frf = average(impact, choices=choices)
    names = [hit.name for hit in average_frf.hits if hit.accepted]
    if len(names) < _MIN_COUNT:
        return None
    peak = find_peak(average_frf).frequency
    low, high = band or (peak / _BAND_RATIO, peak * _BAND_RATIO)
    errors, peaks = [], []
    for name in names[:_MAX_HITS]:
        other_average = average(impact, choices=replace(choices, reject=(*choices.reject, name)))
        other_hits = tuple(text for text in names if text != name)
        frf = average(impact, choices=replace(choices, reject=(*choices.reject, *other_hits)))
        item = _as_signed(frf.band(low, high), average_frf)
        new_fit = identify(
            _as_signed(other_average, average_frf),
            tests=tests,
            arms=fit.model.arms,
            **load.keywords,
        )
        predicted = predict_frf(
            new_fit, frequency=item.frequency, kind=item.quantity, shift=item.shift, **load.keywords
        )
        relative_difference = np.linalg.norm(predicted.value - item.value) / np.linalg.norm(
            item.value
        )
        errors.append(float(relative_difference))
        measured_peak, predicted_peak = find_peak(item), find_peak(predicted)
        peaks.append(
            (
                predicted_peak.frequency - measured_peak.frequency,
                predicted_peak.height / measured_peak.height - 1,
            )
        )
    hz, height = np.array(peaks).T
    return LeaveOneOut(
        float(np.mean(errors)), len(errors), (float(hz.min()), float(hz.max())),
        (float(height.min()), float(height.max())),
    )  # fmt: skip


def _as_signed(frf: FRF, reference: FRF) -> FRF:
    """Return the FRF with the sign of the average; one hit alone may have the other."""
    reference_values = np.interp(
        frf.frequency, reference.frequency, reference.value.real
    ) + 1j * np.interp(frf.frequency, reference.frequency, reference.value.imag)
    is_same_sign = float(np.real(np.vdot(reference_values, frf.value))) >= 0
    return frf if is_same_sign else replace(frf, value=-frf.value)
