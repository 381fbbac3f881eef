"""Windows for impact tests."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.vibration.impact.hits import HitBlock

LEFT = 0.01  # what an exponential window leaves of the response at the end of the record
FORMS = "none, force, exponential, exponential:0.01, force+exponential"


def parse_window(window: str) -> tuple[bool, bool, float | None]:
    """Return whether to window the force, whether exponentially both, and the end value if given.

    Never a Hann window: it would erase the pulse, which stands at the edge of the record.
    """
    force, exponential, end = False, False, None
    for part in window.split("+"):
        name, _, value = part.strip().partition(":")
        if name == "force" and not value:
            force = True
        elif name == "exponential":
            exponential = True
            end = _end(value, window) if value else None
        elif name != "none" or value or window != "none":
            raise DataError(
                f"window {window!r} does not suit a hammer test; expected one of {FORMS}"
            )
    return force, exponential, end


def _end(value: str, window: str) -> float:
    try:
        end = float(value)
    except ValueError:
        end = float("nan")
    if not 0 < end < 1:
        raise DataError(
            f"window {window!r}: the number is what the window leaves at the end of the record; "
            "expected more than 0 and less than 1, such as exponential:0.01"
        )
    return end


def window_decay(remaining: float, record: float, end: float | None) -> float:
    r"""Decay a of the exponential window :math:`e^{-at}`, 1/s.

    Without a wanted `end` value, the gentlest window that leaves 1 % of the response at the end of
    a record of `record` s, where `remaining` is the part that is left without a window.
    """
    if end is None:
        end = min(1.0, LEFT / max(remaining, LEFT))
    return float(-np.log(end) / record)


def force_window(hit: HitBlock) -> FloatArray:
    """One over the pulse, a half-cosine down over twice its length, then zero: shape (n,)."""
    pulse = hit.pulse(0.01)
    flat = pulse.stop + max(pulse.stop - pulse.start, 4)
    fall = 2 * max(pulse.stop - pulse.start, 4)
    at = np.arange(len(hit.force))
    return np.asarray(0.5 * (1 + np.cos(np.pi * np.clip((at - flat) / fall, 0, 1))))
