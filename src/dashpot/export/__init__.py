"""Decks: a solid as text for a solver, one target, one file.

Every target is a function ``target(solid, *, units, specimen, allow, form, ...)``, made by
:func:`~dashpot.export.opening.target`, of a bare :class:`~dashpot.solids.maxwell.Solid` or of a
:class:`~dashpot.records.fit.Fit`, which brings its pedigree and must be worth exporting.
"""

from __future__ import annotations

from dataclasses import replace
from inspect import signature
from typing import Any

from dashpot.base.errors import ExportError
from dashpot.export.abaqus import abaqus
from dashpot.export.adams import adams
from dashpot.export.ansys import ansys
from dashpot.export.calculix import calculix
from dashpot.export.csv import csv
from dashpot.export.deck import DeckText
from dashpot.export.hyperelastic import hyperelastic_card
from dashpot.export.lsdyna import lsdyna
from dashpot.export.nastran import nastran
from dashpot.export.notation import UNIT_SYSTEMS
from dashpot.export.opening import FORMS, PROBLEMS, TARGETS
from dashpot.export.opensees import opensees
from dashpot.export.radioss import radioss
from dashpot.export.statespace import statespace
from dashpot.records.fit import Fit
from dashpot.records.hyperelastic import HyperelasticFit
from dashpot.records.level import LevelFit


def deck_for(
    target: str,
    found: Fit | LevelFit | HyperelasticFit,
    *,
    seals: float = 1.0,
    compression: float | None = None,
    temperature: float | None = None,
    **choices: Any,
) -> DeckText:
    """Return the deck of a fit for one of :data:`TARGETS`: of so many seals, side by side.

    Parameters
    ----------
    target : str
    found : Fit or LevelFit or HyperelasticFit
        Of one seal; of a material, whose card is written.
    seals : float
    compression : float, optional
        Of the seals, m: the deck is of small vibration about it.
    temperature : float, optional
        Of the seals, K; by default that of the fit.
    **choices
        Arguments of the target; one that is None was not chosen.

    Raises
    ------
    ExportError
        If there is no such target, it takes no such choice, or refuses the fit.
    """
    if target not in TARGETS:
        raise ExportError(f"'{target}' is no solver; expected one of {', '.join(TARGETS)}")
    material = isinstance(found, HyperelasticFit)
    known = signature(hyperelastic_card if material else TARGETS[target]).parameters
    made = {name: value for name, value in choices.items() if value is not None}
    for name in made:
        if name not in known:
            raise ExportError(
                f"{target} decks take no --{name.removeprefix('frequency_').replace('_', '-')}"
            )
    if isinstance(found, HyperelasticFit):
        if seals != 1 or compression is not None:
            raise ExportError("a material card takes no --seals and no --compression")
        return hyperelastic_card(target, found, temperature=temperature, **made)
    if compression is not None:
        if isinstance(found, LevelFit):
            raise ExportError("FRFs at levels are of one compression; leave out --compression")
        found = found.at_compression(compression)
    if seals != 1:
        found = found.in_parallel(seals)
    if temperature is not None:
        made["specimen"] = replace(found.specimen, temperature=temperature)
    return TARGETS[target](found, **made)


__all__ = [
    "FORMS",
    "PROBLEMS",
    "TARGETS",
    "UNIT_SYSTEMS",
    "DeckText",
    "abaqus",
    "adams",
    "ansys",
    "calculix",
    "csv",
    "deck_for",
    "hyperelastic_card",
    "lsdyna",
    "nastran",
    "opensees",
    "radioss",
    "statespace",
]
