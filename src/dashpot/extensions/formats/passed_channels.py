"""Notes on the channels of a file that are passed over."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from dashpot.base.provenance import Caution
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.header_units import split_unit
from dashpot.reading.columns.vocabulary import Role

_ROLES: tuple[Role, ...] = ("force", "displacement", "acceleration", "stress", "strain")

_MAX_LISTED = 8


def note_passed(skipped_channels: Mapping[str, str], kept_names: Iterable[str]) -> list[str]:
    """Note the channels that are omitted, by their content.

    A caution where one is named for a role of a test as well as any channel that is kept: another
    may then have taken its place.
    """
    kept_names = list(kept_names)
    reasons: dict[tuple[str, bool], list[str]] = {}
    for name, reason in skipped_channels.items():
        has_role = names_role_as_well([name], kept_names)
        reasons.setdefault((reason, has_role), []).append(f"'{name}'")
    notes: list[str] = []
    for (reason, has_role), names in reasons.items():
        more_text = f" and {len(names) - _MAX_LISTED} more" if len(names) > _MAX_LISTED else ""
        hold = "hold" if len(names) > 1 else "holds"
        note = f"{', '.join(names[:_MAX_LISTED])}{more_text} {hold} {reason}: passed over"
        notes.append(Caution(note) if has_role else note)
    return notes


def names_role_as_well(skipped_names: Iterable[str], names: Iterable[str]) -> bool:
    """Return whether a channel's name fits a role of a test as well as that of a kept one.

    >>> names_role_as_well(["Force"], ["t", "Ch 3"]), names_role_as_well(["Temp"], ["t", "Force"])
    (True, False)
    """
    scores, best = _score_roles(skipped_names), _score_roles(names)
    return any(
        max(scores[role], default=0.0) >= max(vocabulary.MIN_SCORE, *best[role], 0.0)
        for role in _ROLES
    )


def _score_roles(names: Iterable[str]) -> dict[Role, Sequence[float]]:
    """Return the score of each name for each role."""
    matched = [vocabulary.matches(split_unit(name)[0]) for name in names]
    return {role: [scores.get(role, 0.0) for scores in matched] for role in _ROLES}
