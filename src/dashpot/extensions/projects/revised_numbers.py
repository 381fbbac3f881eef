"""Numbers of a result that later editions compute otherwise, and why."""

from __future__ import annotations

from typing import Any

_ERRORS = "errors hold what machine, drift and climate may do without a trace"
REVISED_NUMBERS: dict[str, str] = {
    "covariance": _ERRORS,
    "standard_error": f"{_ERRORS}; k_inf has none, for no test bounds it from below",
    "interval_95": f"{_ERRORS}; k_inf has an upper limit alone",
    "noise_covariance": _ERRORS,
    "dof": _ERRORS,
    "parameter_changes": "the errors beside each change are the new ones",
    "end_of_hold_limits": "limits count every loading on record; "
    "a joint model has those of its hold",
    "band_hz": "the band ends where the loss factor is not known to 30 %",
}
"""Reasons by key of a fit: why its number is another than in a document of the first version.

The solid, its residual and what is predicted from it are none of these.
"""
_ADDED = frozenset({"error_in_band", "after_most", "before_most", "rested"})
"""Keys that a document of the first version may lack."""
_LABELS = frozenset({"schema", "id", "digest", "message"})
"""Keys that name a document, or word it, and hold no number of it."""


def split_common(before: Any, after: Any) -> tuple[Any, Any, dict[str, tuple[Any, Any]]]:
    """Return two documents without their revised numbers, and both values of each of those.

    A key that one of them lacks stays in the other, unless the first version did not know it yet.
    """
    revised: dict[str, tuple[Any, Any]] = {}

    def split(old: Any, new: Any, where: str) -> tuple[Any, Any]:
        if isinstance(old, dict) and isinstance(new, dict):
            was: dict[str, Any] = {}
            now: dict[str, Any] = {}
            for key in sorted((old.keys() | new.keys()) - _LABELS):
                if key in REVISED_NUMBERS and key in old and key in new:
                    revised[f"{where}.{key}".lstrip(".")] = (old[key], new[key])
                elif key in old and key in new:
                    was[key], now[key] = split(old[key], new[key], f"{where}.{key}")
                elif key in old:
                    was[key] = old[key]
                elif key not in _ADDED:
                    now[key] = new[key]
            return was, now
        if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
            items = [
                split(*pair, f"{where}[{i}]") for i, pair in enumerate(zip(old, new, strict=True))
            ]
            return [one for one, _ in items], [other for _, other in items]
        return old, new

    return (*split(before, after, ""), revised)
