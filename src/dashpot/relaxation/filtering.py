"""Filters that a user may ask for, and the bias that each brings."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from dashpot._arrays import FloatArray, median
from dashpot.checks import Check
from dashpot.errors import DashpotError, DataError
from dashpot.relaxation.records import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.units import parse_quantity

MAX_BIAS = 0.01
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


def filtered(test: RampHold, by: Filter) -> RampHold:
    """The record with both channels behind a filter."""
    return replace(
        test, force=by(test.time, test.force), displacement=by(test.time, test.displacement)
    )


def filter_bias(test: RampHold, by: Filter) -> Check:
    """What the filter does to each parameter, predicted on the noise-free answer of the seal.

    The solid is fitted to the unfiltered record; its exact answer to the recorded motion is
    fitted again, before and behind the filter, by eq. 5 and by the full history.

    Parameters
    ----------
    test : RampHold
        Not filtered.
    """
    from dashpot.relaxation.fitting import fit

    name = "filter_bias"
    try:
        model = fit(test, arms="auto").model
        clean = replace(test, force=model.force(test.time, test.displacement), checks=())
        changes = {
            "hold": _changes(clean, by, model.arms, "hold"),
            "full": _changes(clean, by, model.arms, "full"),
        }
    except DashpotError as error:
        says = f"the bias of {by} cannot be predicted, because the raw record has no fit: {error}"
        return Check(name, False, says, None, MAX_BIAS)
    value = max(abs(change) for found in changes.values() for change in found.values())
    least = 5 / model.tau[0] if model.tau else 0.0
    slow = by.kind == "lowpass" and by.cutoff < least
    says = f"{by} changes, by eq. 5 on the hold, {_listed(changes['hold'])}; with the full history "
    if by.linear:
        most = max(changes["full"].values(), key=abs)
        says += f"at most {_percent(most)}, because the displacement is filtered alike"
    else:
        says += _listed(changes["full"])
    if slow:
        says += f"; the cut-off is below 5/tau_1 = {least:.3g} Hz"
    if by.causal:
        says += "; a causal filter delays the force"
    passed = value <= MAX_BIAS and not slow and not by.causal
    if not passed:
        says += "; fit the raw record: the fit needs no smooth curve"
    return Check(name, passed, says, value, MAX_BIAS)


def _changes(
    clean: RampHold, by: Filter, arms: int, method: Literal["full", "hold"]
) -> dict[str, float]:
    """Relative change of each parameter that the filter makes; -1 where an arm is lost."""
    from dashpot.relaxation.fitting import fit

    behind = filtered(clean, by)
    if method == "hold":
        # eq. 5 takes the ramp from its corners, which were found before the filter
        behind = replace(behind, displacement=clean.displacement)
    before = _named(fit(clean, arms=arms, method=method).model)
    after = _named(fit(behind, arms=arms, method=method).model)
    return {
        name: after[name] / value - 1 if name in after else -1.0
        for name, value in before.items()
        if value > 0
    }


def _named(model: GeneralizedMaxwell) -> dict[str, float]:
    arms = zip(model.k, model.tau, strict=True)
    named = {"k_inf": model.k_inf}
    for j, (k, tau) in enumerate(arms, start=1):
        named |= {f"k_{j}": k, f"tau_{j}": tau}
    return named


def _listed(changes: dict[str, float]) -> str:
    return ", ".join(
        f"{name} by {_percent(change)}" if change > -1 else f"{name} to nothing"
        for name, change in changes.items()
    )


def _percent(change: float) -> str:
    return f"{100 * change:+.3g} %"


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
