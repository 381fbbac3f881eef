"""Filters that a user may ask for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.base.errors import DataError
from dashpot.base.provenance import Step
from dashpot.base.units import parse_quantity
from dashpot.datamodel.relaxation import RampHold

STEP = "filter"
_EXPECTED = (
    "expected 'lowpass:10Hz', 'lowpass:10Hz:causal', 'notch:50Hz', 'notch:50Hz:causal' or "
    "'median:5'"
)


@dataclass(frozen=True)
class Filter:
    """A filter for both channels of a record.

    Attributes
    ----------
    kind : str
        ``"lowpass"`` (Butterworth, 2nd order), ``"notch"`` (Q = 10) or ``"median"``.
    cutoff : float
        Hz; 0 for a median.
    window : int
        Samples of a median.
    causal : bool
        Run once, forwards, as a filter in an instrument does; else forwards and backwards,
        which shifts nothing in time.
    """

    kind: Literal["lowpass", "notch", "median"]
    cutoff: float = 0.0
    window: int = 0
    causal: bool = False

    @property
    def linear(self) -> bool:
        """A linear filter on force and displacement alike leaves their relation as it was."""
        return self.kind != "median"

    def __str__(self) -> str:
        """As the user writes it."""
        if self.kind == "median":
            return f"median:{self.window}"
        return f"{self.kind}:{self.cutoff:g}Hz" + (":causal" if self.causal else "")

    def __call__(self, time: FloatArray, values: FloatArray) -> FloatArray:
        """Return filtered `values`.

        Raises
        ------
        DataError
            If a linear filter meets uneven sampling, or a cut-off above half the rate.
        """
        from scipy import signal

        if self.kind == "median":
            from scipy.ndimage import median_filter

            return np.asarray(median_filter(values, size=self.window, mode="nearest"))
        rate = _even_rate(time, self)
        if self.kind == "lowpass":
            sections = signal.butter(2, self.cutoff, fs=rate, output="sos")
        else:
            sections = signal.tf2sos(*signal.iirnotch(self.cutoff, 10.0, fs=rate))
        if not self.causal:
            return np.asarray(signal.sosfiltfilt(sections, values))
        settled = signal.sosfilt_zi(sections) * values[0]
        return np.asarray(signal.sosfilt(sections, values, zi=settled)[0])


def parse_filter(text: str) -> Filter:
    """Return the filter that `text` names, such as ``"lowpass:10Hz"``.

    >>> str(parse_filter("lowpass:10 Hz"))
    'lowpass:10Hz'

    Raises
    ------
    DataError
        If it names none.
    """
    kind, _, rest = text.strip().partition(":")
    value, _, mode = rest.partition(":")
    if (
        kind == "median"
        and not mode
        and value.strip().isdigit()
        and int(value) % 2
        and value != "1"
    ):
        return Filter("median", window=int(value))
    if kind == "lowpass" and mode in {"", "causal"}:
        return Filter("lowpass", cutoff=_cutoff(text, value), causal=bool(mode))
    if kind == "notch" and mode in {"", "causal"}:
        return Filter("notch", cutoff=_cutoff(text, value), causal=bool(mode))
    raise DataError(f"filter '{text}' is not known; {_EXPECTED} (a median of odd length)")


def filter_record(test: RampHold, by: Filter) -> RampHold:
    """The record with both channels behind a filter, and the record before it beside."""
    step = Step(STEP, (("filter", str(by)),), f"both channels are filtered by {by}")
    return replace(
        test,
        force=by(test.time, test.force),
        displacement=by(test.time, test.displacement),
        given=None if test.given is None else by(test.time, test.given),
        unfiltered=test,
        steps=(*test.steps, step),
    )


def filter_of(test: RampHold) -> Filter | None:
    """Return the filter that a record went through, None if it went through none."""
    for step in test.steps:
        if step.name == STEP:
            return parse_filter(dict(step.parameters)["filter"])
    return None


def _cutoff(text: str, value: str) -> float:
    try:
        cutoff = parse_quantity(value, "frequency")
    except DataError as error:
        raise DataError(f"filter '{text}': {error}; {_EXPECTED}") from None
    if cutoff <= 0:
        raise DataError(f"filter '{text}': the cut-off must be above 0 Hz; {_EXPECTED}")
    return cutoff


def _even_rate(time: FloatArray, by: Filter) -> float:
    steps = np.diff(time)
    usual = median(steps)
    worst = int(np.argmax(np.abs(steps - usual)))
    if abs(steps[worst] - usual) > 0.2 * usual:
        raise DataError(
            f"{by} needs even sampling, but the step after t = {time[worst]:.6g} s is "
            f"{steps[worst]:.4g} s where {usual:.4g} s is usual; fit the raw record, or use a "
            "median"
        )
    rate = (len(time) - 1) / (time[-1] - time[0])
    if by.cutoff >= rate / 2:
        raise DataError(
            f"{by} lies above half the sampling rate, {rate / 2:.4g} Hz; give a lower frequency, "
            "or no filter"
        )
    return float(rate)
