"""Suggestions for unknown keys of ``--machine``."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from types import MappingProxyType

from dashpot.base.errors import DataError
from dashpot.base.units import parse_quantity

_STIFFNESS_KEYS = frozenset({
    "stiffness", "machine-stiffness", "frame-stiffness", "load-cell-stiffness", "cell-stiffness",
    "rigidity", "k",
})  # fmt: skip
MACHINE_SYNONYMS: Mapping[str, str] = MappingProxyType(
    {
        "delay": "sync", "lag": "sync", "latency": "sync", "synchronisation": "sync",
        "synchronization": "sync", "skew": "sync", "zero-drift": "drift",
        "flexibility": "compliance", "give": "compliance", "deflection": "compliance",
        "filter": "force-filter", "low-pass": "force-filter", "lowpass": "force-filter",
        "bandwidth": "force-filter", "cutoff": "force-filter", "pause": "rest",
        "temperature": "oven", "cable-stiffness": "cable",
        "coupling": "high-pass", "ac-coupling": "high-pass", "highpass": "high-pass",
        "corner": "high-pass",
    }
)  # fmt: skip
"""Key of ``--machine`` by synonyms."""
_MIN_SIMILARITY = 0.85
"""Least ratio of `difflib` of a misspelt name and one of these, of 1."""


def suggest_machine_key(key: str, text: str) -> str:
    """Return the known key that is nearest to an unknown one; "" if there is none.

    Parameters
    ----------
    key : str
        As it was typed, in lower case and with dashes.
    text : str
        Its value, such as ``"30N/mm"``.

    Examples
    --------
    >>> suggest_machine_key("stiffness", "30N/mm")
    'Give its inverse, the compliance: --machine compliance=33.33um/N'
    """
    known_names = (*_STIFFNESS_KEYS, *MACHINE_SYNONYMS)
    key = next(iter(get_close_matches(key, known_names, 1, _MIN_SIMILARITY)), key)
    if key in _STIFFNESS_KEYS:
        return f"Give its inverse, the compliance: --machine compliance={_format_inverse(text)}"
    return f"Did you mean '{MACHINE_SYNONYMS[key]}'?" if key in MACHINE_SYNONYMS else ""


def _format_inverse(text: str) -> str:
    """Return the compliance of a stiffness, or the example of the documentation."""
    try:
        stiffness = parse_quantity(text, "stiffness")
    except DataError:
        stiffness = 0.0
    return f"{1e6 / stiffness:.4g}um/N" if stiffness > 0 else "33um/N, which is 1/(30 N/mm)"
