"""Choice of the fit for given records and options."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from dashpot.base.errors import ReadError
from dashpot.reading.columns.file_kinds import get_kind_command, get_kind_label
from dashpot.registry import FITS, KINDS, RESPONSES

BENCH = frozenset(kind.name for kind in KINDS.values() if kind.fit_route == "bench")
"""Kinds of tests of a part on a bench, whose solid is fitted."""
VIBRATION = frozenset(
    kind.name for kind in KINDS.values() if kind.fit_route == "hits" or kind.name in RESPONSES
)
"""Kinds that are of a mass on its seals."""

_MAX_NAMED = 3
"""Files of one kind that a sentence names."""


def find_selected_fit(options: Collection[str]) -> str:
    """Return the fit that one of these options selects; empty if none does."""
    return next((fit.name for fit in FITS.values() if set(fit.selecting) & set(options)), "")


def route(kinds: Mapping[str, str], *, masses: int = 0, selected: str = "") -> str:
    """Return the fit that records mean.

    Parameters
    ----------
    kinds : mapping of str to str
        The kind of each file, as :func:`~dashpot.reading.readers.detect_kind.recognise` names it.
    masses : int
        How many masses were given.
    selected : str
        The fit that an option selects (:func:`find_selected_fit`).

    Raises
    ------
    ReadError
        If records of these kinds are not fitted, or not together.

    Examples
    --------
    >>> route({"seal.csv": "relaxation", "hammer.csv": "impact"}, masses=1)
    'joint'
    >>> route({"hammer.csv": "impact"})
    'hits'
    """
    present_kinds = set(kinds.values())
    vibration_kinds = present_kinds & VIBRATION
    if vibration_kinds and present_kinds <= VIBRATION:
        return _route_vibration(kinds, masses=masses, selected=selected)
    if vibration_kinds and present_kinds <= VIBRATION | BENCH | {"fit"}:
        if masses and selected:
            raise ReadError(
                f"{_format_file_kinds(kinds)}. A level, a density and a shape are of the vibration "
                "alone. Leave them out, or fit the files one by one."
            )
        if masses:
            _refuse_several(kinds)
            return "joint"
        raise ReadError(
            "A test and a hammer test are fitted together under a mass. Give the test "
            "mass, such as --mass 104g."
        )
    common_route = _find_common_meaning(present_kinds)
    if common_route:
        return common_route
    if len(kinds) == 1:
        ((path, kind),) = kinds.items()
        raise ReadError(
            f"{path} is {get_kind_label(kind)}: {get_kind_command(kind) or 'it is not fitted'}."
        )
    raise ReadError(
        f"These records are not fitted together: {_format_file_kinds(kinds)}. Fit them one by one."
    )


def _route_vibration(kinds: Mapping[str, str], *, masses: int, selected: str) -> str:
    if selected:
        return selected
    if masses > 1:
        return "masses"
    if masses:
        _refuse_several(kinds)
        return "joint"
    common_route = _find_common_meaning(set(kinds.values()))
    if common_route:
        return common_route
    raise ReadError(
        f"{_format_file_kinds(kinds)}. They are not fitted together. Fit them one by one."
    )


def _refuse_several(kinds: Mapping[str, str]) -> None:
    """Refuse more than one FRF of one mass: hits are averaged, FRFs are not."""
    vibration_files = {path: kind for path, kind in kinds.items() if kind in VIBRATION}
    if len(vibration_files) == 1 or set(vibration_files.values()) == {"impact"}:
        return
    if "impact" in vibration_files.values():
        raise ReadError(
            f"{_format_file_kinds(vibration_files)}. They are not fitted together. Fit them one by "
            "one."
        )
    raise ReadError(
        f"{_format_file_kinds(vibration_files)}, and one FRF is fitted under one mass. Give one of "
        "them, or the level or the mass of each, such as --amplitude 0.02N --amplitude 0.5N."
    )


def _format_file_kinds(kinds: Mapping[str, str]) -> str:
    """Return a text with the kinds of the files and some of their names."""
    grouped: dict[str, list[str]] = {}
    for path, kind in kinds.items():
        grouped.setdefault(get_kind_label(kind), []).append(Path(path).name)
    return "; ".join(f"{_join_names(names)} {kind}" for kind, names in grouped.items())


def _join_names(names: Sequence[str]) -> str:
    if len(names) == 1:
        return f"{names[0]} is"
    names_listed = names if len(names) <= _MAX_NAMED else names[: _MAX_NAMED - 1]
    last = names[-1] if names_listed is names else f"{len(names) - len(names_listed)} more"
    first = names_listed[:-1] if names_listed is names else names_listed
    return f"{', '.join(first)} and {last} are each"


def _find_common_meaning(present_kinds: set[str]) -> str:
    """Return the fit that all these kinds mean; empty if they mean several."""
    words = {KINDS[kind].fit_route if kind in KINDS else "" for kind in present_kinds}
    return words.pop() if len(words) == 1 else ""
