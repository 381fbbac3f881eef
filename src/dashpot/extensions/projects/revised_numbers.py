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
_ADDED = frozenset(
    {"error_in_band", "largest_error_in_band", "after_most", "before_most", "rested"}
)
"""Keys that a document of the first version may lack."""
_LABELS = frozenset({"schema", "id", "digest", "message"})
"""Keys of names and texts, without numbers of the document."""


def split_common(earlier_document: Any, second: Any) -> tuple[Any, Any, dict[str, tuple[Any, Any]]]:
    """Return two documents without their revised numbers, and both values of each of those.

    A key that one of them lacks stays in the other, unless the first version did not know it yet.
    """
    revised: dict[str, tuple[Any, Any]] = {}

    def split(old: Any, new: Any, key_path: str) -> tuple[Any, Any]:
        if isinstance(old, dict) and isinstance(new, dict):
            first_part: dict[str, Any] = {}
            second_part: dict[str, Any] = {}
            for key in sorted((old.keys() | new.keys()) - _LABELS):
                if key in REVISED_NUMBERS and key in old and key in new:
                    revised[f"{key_path}.{key}".lstrip(".")] = (old[key], new[key])
                elif key in old and key in new:
                    first_part[key], second_part[key] = split(
                        old[key], new[key], f"{key_path}.{key}"
                    )
                elif key in old:
                    first_part[key] = old[key]
                elif key not in _ADDED:
                    second_part[key] = new[key]
            return first_part, second_part
        if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
            items = [
                split(*pair, f"{key_path}[{i}]")
                for i, pair in enumerate(zip(old, new, strict=True))
            ]
            return [key for key, _ in items], [other for _, other in items]
        return old, new

    return (*split(earlier_document, second, ""), revised)
