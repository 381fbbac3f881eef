"""Which fit records mean, together and with what was said of them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Literal, TypeAlias

from dashpot.base.errors import ReadError
from dashpot.io.readers.recognise import called

Meant: TypeAlias = Literal[
    "bench", "hits", "modes", "masses", "joint", "level", "rod", "cld", "stress-strain",
    "indentation",
]  # fmt: skip

VIBRATION = frozenset({"impact", "frf", "transmissibility"})
"""Kinds that are of a mass on its seals."""
TESTS = frozenset({"relaxation", "dma", "master-curve", "modulus", "creep"})
"""Kinds of tests of a part on a bench, whose solid is fitted."""
BENCH = TESTS | {"fit"}
_ALONE: Mapping[str, Meant] = {
    "cld": "cld", "stress-strain": "stress-strain", "indentation": "indentation",
    "strain-sweep": "level", "cyclic": "level",
}  # fmt: skip
"""What kinds mean that are fitted with their own kind alone."""
NO_MASS = (
    "the file holds a transmissibility, which tells the stiffness over the mass and neither alone: "
    "give the mass (--mass)"
)
_NO_FIT = {
    "temperature-sweep": "it tells no relaxation times; sweep the frequency",
    "one-frequency": "it tells no relaxation times; sweep the frequency",
    "fit": "it is fitted already; for a prediction: dashpot predict",
    "model": "it is a solid already; for a prediction: dashpot predict",
    "door": "for its modes: dashpot predict",
    "lot": "to compare it: dashpot compare",
    "folder": "for a table of its tests: dashpot batch",
}  # fmt: skip


def route(
    kinds: Mapping[str, str], *, masses: int = 0, levels: bool = False, rod: bool = False
) -> Meant:
    """Return the fit that records mean.

    Parameters
    ----------
    kinds : mapping of str to str
        The kind of each file, as :func:`~dashpot.io.readers.recognise.recognise` names it.
    masses : int
        How many masses were given.
    levels : bool
        Whether the level of each FRF was given, or the resonance at a level was asked for.
    rod : bool
        Whether a density or a shape was.

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
    have = set(kinds.values())
    for kind, meant in _ALONE.items():
        if have == {kind}:
            return meant
    if have <= {"strain-sweep", "cyclic"}:
        return "level"
    shaken = have & VIBRATION
    if shaken and have <= VIBRATION:
        return _of_vibration(kinds, masses=masses, levels=levels, rod=rod)
    if shaken and have <= VIBRATION | BENCH:
        if masses:
            _refuse_several(kinds)
            return "joint"
        raise ReadError(
            "A test and a hammer file are fitted together under a mass. Give the mass of the "
            "block, such as --mass 104g."
        )
    if have <= TESTS:
        return "bench"
    if len(kinds) == 1:
        ((path, kind),) = kinds.items()
        raise ReadError(f"{path} is {called(kind)}: {_NO_FIT.get(kind, 'it is not fitted')}.")
    raise ReadError(f"These records are not fitted together: {_said(kinds)}. Fit them one by one.")


def _of_vibration(kinds: Mapping[str, str], *, masses: int, levels: bool, rod: bool) -> Meant:
    if levels:
        return "level"
    if rod:
        return "rod"
    if masses > 1:
        return "masses"
    if masses:
        _refuse_several(kinds)
        return "joint"
    have = set(kinds.values())
    if "transmissibility" in have:
        path = next(path for path, kind in kinds.items() if kind == "transmissibility")
        raise ReadError(f"{path}: {NO_MASS}")
    if have == {"impact"}:
        return "hits"
    if have == {"frf"}:
        return "modes"
    raise ReadError(f"{_said(kinds)}. They are not fitted together. Fit them one by one.")


def _refuse_several(kinds: Mapping[str, str]) -> None:
    """Refuse more than one FRF of one mass: hits are averaged, FRFs are not."""
    shaken = {path: kind for path, kind in kinds.items() if kind in VIBRATION}
    if len(shaken) == 1 or set(shaken.values()) == {"impact"}:
        return
    if "impact" in shaken.values():
        raise ReadError(f"{_said(shaken)}. They are not fitted together. Fit them one by one.")
    raise ReadError(
        f"{_said(shaken)}, and one FRF is fitted under one mass. Give one of them, or the level or "
        "the mass of each, such as --level 0.02N --level 0.5N."
    )


def _said(kinds: Mapping[str, str]) -> str:
    """What each file is, in a sentence."""
    return "; ".join(f"{Path(path).name} is {called(kind)}" for path, kind in kinds.items())
