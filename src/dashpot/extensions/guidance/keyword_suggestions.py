"""Suggestions for a keyword of a Python function that there is not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from types import MappingProxyType

FORMER_KEYWORDS: Mapping[str, str] = MappingProxyType({
    "between": "compression_limits", "by": "label_pattern", "cuts": "time_limits",
    "known": "prior", "memory": "relaxation", "only": "temperature", "slam": "drop",
    "wanted": "max_std",
})  # fmt: skip
"""Present name of a keyword by its former name."""
READ_KEYS: Mapping[str, Sequence[str]] = MappingProxyType({
    "part": ("cycle", "format", "segment", "sheet"),
    "text": ("decimal", "delimiter", "encoding", "skip"),
})  # fmt: skip
"""Mapping of `dashpot.read` that holds a key."""


def suggest_keyword(name: str, keywords: Sequence[str]) -> str:
    """Return the keyword of a function that another name means, as it is written, or empty.

    >>> suggest_keyword("massse", ["mass", "seals"]), suggest_keyword("n_arms", ["arms", "mass"])
    ('mass=', 'arms=')
    """
    group = next((key for key, names in READ_KEYS.items() if name in names), "")
    if group in keywords:
        return f'{group}={{"{name}": ...}}'
    if name in FORMER_KEYWORDS:
        return f"{FORMER_KEYWORDS[name]}="
    from dashpot.extensions.guidance.option_suggestions import OPTION_SYNONYMS  # loads click

    meanings = OPTION_SYNONYMS.get(name.lower().replace("_", "-"), ())
    synonyms = (word for word in meanings if word in keywords)
    return next((f"{word}=" for word in (*get_close_matches(name, keywords, 1), *synonyms)), "")
