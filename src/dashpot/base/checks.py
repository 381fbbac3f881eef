"""Named pass/fail checks: a value, a limit, a sentence."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """One named question put to a record or a result, and its answer in words.

    Attributes
    ----------
    name : str
        Stable identifier, ``snake_case``.
    passed : bool
        The answer.
    value, limit : float or None
        What was measured and what it was held against (None where there is no number).
    says : str
        The sentence the user reads: what was found, what it means, what to do.
    """

    name: str
    passed: bool
    says: str
    value: float | None = None
    limit: float | None = None
