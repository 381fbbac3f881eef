"""From a base that is shaken and the mass on it to a transmissibility that is judged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.errors import DataError, FitError
from dashpot.base.provenance import Step
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.frf import FRF, Kind, Mode
from dashpot.datamodel.vibration_tests import ShakenTest
from dashpot.extensions.modes.checks import channels_not_clipped, segments_resolve
from dashpot.vibration.impact.checks import resonance
from dashpot.vibration.impact.spectral_estimators import Estimator, Spectra, coherence, estimate
from dashpot.workflow.job import HammerChoices
from dashpot.workflow.measured_frf import add_frf_checks, as_measured, refuse_choices_of_hits

USUAL_SEGMENTS = 8
"""Default number of segment lengths in a record."""
MIN_SEGMENTS = 3
OVERLAP_WEIGHT = 1 / (1 + 2 / 36)
"""Weight of a segment that shares half of its samples with either neighbour (Hann)."""
HIGHEST_OF_RATE = 0.4
"""Part of the sampling rate up to which lines are kept: above are filters and aliases."""
BASE_MOVES = 1e-3
"""Part of the base's strongest line below which it is not moved."""
COHERENT_BY_CHANCE = 1e-3
"""Probability that the coherence of mere noise exceeds the limit."""
_KEPT_COHERENCE = 0.5
"""Coherence above which lines are kept for any number of segments."""
_MEDIAN_LINES = 5
"""Neighbouring lines whose median coherence decides."""


def estimate_transmissibility(
    test: ShakenTest, *, estimator: Estimator | str = Estimator.H1, segment: Quantity | None = None
) -> FRF:
    r"""Transmissibility from the base to the mass, by averages over segments (Welch).

    Segments under a Hann window, half of each shared with the next, their straight line taken off:
    what hits are to :func:`~dashpot.vibration.impact.spectral_estimators.estimate`, with the
    base's motion in place of the force. Coherence shows the scatter, each segment counted as the
    0.95 that it is worth beside its neighbours. Where the mass's motion is no acceleration the
    ratio is differentiated; relative to the base it is a relative transmissibility.

    Parameters
    ----------
    test : ShakenTest
    estimator : {"H1", "H2", "Hv"}
        Noise on the mass, on the base, or on both.
    segment : float, optional
        Length of a segment, s; by default an eighth of the longest record. A resonance hardly wider
        than the line spacing appears lower than it is.

    Raises
    ------
    DataError
        If fewer than 3 segments fit, the base does not move, or the estimator needs a quiet before
        a hit.
    """
    estimator = Estimator(estimator)
    if estimator is Estimator.HS:
        raise DataError("Hs needs the quiet before a hit; over a base take H1, H2 or Hv")
    longest = max(record.stop - record.start for record in test.records())
    seconds = convert_to_si(segment, "time")
    segment_length = longest / USUAL_SEGMENTS if seconds is None else seconds * test.rate
    length = max(int(segment_length) // 2 * 2, 8)
    base, mass = (_transform_segments(test, signal, length) for signal in (test.base, test.mass))
    if len(base) < MIN_SEGMENTS:
        raise DataError(
            f"{len(base)} segments of {length / test.rate:.4g} s in the record; expected "
            f"{MIN_SEGMENTS} or more: record longer, or take shorter segments (--hit-length)"
        )
    frequency: FloatArray = np.fft.rfftfreq(length, 1 / test.rate).astype(float)
    power = (np.abs(base) ** 2).mean(axis=0)
    # the first two lines are the window's: the offset leaks into them
    keep = (frequency <= HIGHEST_OF_RATE * test.rate) & (np.arange(len(frequency)) > 1)
    keep &= power > BASE_MOVES**2 * power[keep].max()
    if not keep.any():
        raise DataError("the base does not move")
    full_coherence = coherence(Spectra(frequency, base, mass))
    keep &= full_coherence is None or _select_coherent_lines(full_coherence, len(base))
    if np.count_nonzero(keep) < MIN_SEGMENTS:
        raise DataError(
            "the mass does not answer the base at any line: the coherence is that of noise; check "
            "which column is which, and that both ran on one clock"
        )
    spectra = Spectra(frequency[keep], base[:, keep], mass[:, keep])
    settings = (
        ("estimator", str(estimator)),
        ("segment", f"{length / test.rate:.6g} s"),
        ("segments", str(len(base))),
    )
    return FRF(
        spectra.frequency,
        estimate(spectra, estimator) * (2j * np.pi * spectra.frequency) ** (2 - test.order),
        Kind.RELATIVE_TRANSMISSIBILITY if test.relative else Kind.TRANSMISSIBILITY,
        coherence=coherence(spectra),
        averages=max(int(OVERLAP_WEIGHT * len(base)), 2),
        source=test.source,
        steps=(Step("estimate_transmissibility", settings),),
        units="SI",
    )


def _select_coherent_lines(coherence: FloatArray, segments: int) -> BoolArray:
    r"""Lines where base and mass have more in common than chance has, with their neighbours.

    Of noise alone :math:`P(\gamma^2 > x) = (1 - x)^{n-1}`.
    """
    min_coherence = min(1 - COHERENT_BY_CHANCE ** (1 / (segments - 1)), _KEPT_COHERENCE)
    padded_values = np.pad(coherence, _MEDIAN_LINES // 2, mode="edge")
    median_value = np.median(
        np.lib.stride_tricks.sliding_window_view(padded_values, _MEDIAN_LINES), axis=1
    )
    return np.asarray(median_value > min_coherence)


def _transform_segments(test: ShakenTest, signal: FloatArray, length: int) -> ComplexArray:
    """Fourier transforms of the segments, shape (segments, lines)."""
    t = np.linspace(-1.0, 1.0, length)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(length) / length)
    rows = []
    for record in test.records():
        for first in range(record.start, record.stop - length + 1, length // 2):
            difference = signal[first : first + length]
            difference = difference - difference.mean() - t * (t @ difference) / (t @ t)
            rows.append(np.fft.rfft(window * difference))
    return np.array(rows).reshape(len(rows), length // 2 + 1)


_UNIT = 1.0
"""Mass, kg, which a transmissibility does not determine."""


def estimate_base_transmissibility(
    test: ShakenTest,
    *,
    choices: HammerChoices,
    mass: float | None,
    band: tuple[float, float] | None = None,
) -> tuple[FRF, tuple[Mode, ...], str]:
    """Return the transmissibility of a shaken base, judged, its modes, and why there are none.

    Frequency and damping do not depend on the mass, kg: where it is not given, 1 kg stands for it.
    """
    refuse_choices_of_hits(
        choices, "the base was shaken (--column base-acceleration)",
        exceptions=("estimator", "record", "motion"),
    )  # fmt: skip
    frf = estimate_transmissibility(test, estimator=choices.estimator, segment=choices.record)
    frf = as_measured(frf, choices.motion)
    clipping_check = channels_not_clipped(test)
    mass = _UNIT if mass is None else mass
    modes: tuple[Mode, ...] = ()
    reason = ""
    try:
        modes = frf.to("accelerance", mass=mass).modes(band=band)
    except (DataError, FitError) as error:
        reason = str(error)
    main = next(iter(modes), None)
    checks = [] if main is not None else [resonance(frf, None)]
    resolution_check = segments_resolve(frf, main)
    frf = add_frf_checks(frf, band, mass=mass)
    return (
        replace(frf, checks=(*frf.checks, clipping_check, *checks, resolution_check)),
        modes,
        reason,
    )
