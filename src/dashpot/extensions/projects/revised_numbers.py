"""Numbers of a result that later editions compute otherwise, and why."""

from __future__ import annotations

from typing import Any

_ERRORS = "errors hold what machine, drift and climate may do unseen"
REVISED_NUMBERS: dict[str, str] = {
    "covariance": _ERRORS,
    "standard_error": f"{_ERRORS}; k_inf has none, for no test bounds it from below",
    "interval_95": f"{_ERRORS}; k_inf has an upper limit alone",
    "noise_covariance": _ERRORS,
    "dof": _ERRORS,
    "parameter_changes": "the errors beside each change are the new ones",
    "end_of_hold_limits": "limits count every loading on record; a joint fit has those of its hold",
    "band_hz": "the band ends where the loss factor is not known to 30 %",
}
"""Reasons by key of a fit: why its number is another than in a document of the first version.

The solid, its residual and what is predicted from it are none of these.
"""
_LABELS = frozenset({"schema", "id", "digest"})
"""Keys that name a document and hold no number of it."""


def split_common(before: Any, after: Any) -> tuple[Any, Any, dict[str, tuple[Any, Any]]]:
    """Return what two documents both hold, and beside it both values of each revised number."""
    revised: dict[str, tuple[Any, Any]] = {}

    def split(old: Any, new: Any, where: str) -> tuple[Any, Any]:
        if isinstance(old, dict) and isinstance(new, dict):
            pairs = {}
            for key in sorted((old.keys() & new.keys()) - _LABELS):
                if key in REVISED_NUMBERS:
                    revised[f"{where}.{key}".lstrip(".")] = (old[key], new[key])
                else:
                    pairs[key] = split(old[key], new[key], f"{where}.{key}")
            return {key: one for key, (one, _) in pairs.items()}, {
                key: other for key, (_, other) in pairs.items()
            }
        if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
            items = [
                split(*pair, f"{where}[{i}]") for i, pair in enumerate(zip(old, new, strict=True))
            ]
            return [one for one, _ in items], [other for _, other in items]
        return old, new

    return (*split(before, after, ""), revised)
