"""Decks: a solid as text for a solver, one target, one file.

Every target is a function ``target(solid, *, units, specimen, allow, form, ...)`` of a
bare :class:`~dashpot.solids.maxwell.Solid` or of a
:class:`~dashpot.records.fit.Fit`, which brings its pedigree and must be worth exporting.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from inspect import signature
from types import MappingProxyType

from dashpot.base.errors import ExportError
from dashpot.export import abaqus as _abaqus
from dashpot.export import adams as _adams
from dashpot.export import ansys as _ansys
from dashpot.export import calculix as _calculix
from dashpot.export import csv as _csv
from dashpot.export import lsdyna as _lsdyna
from dashpot.export import nastran as _nastran
from dashpot.export import opensees as _opensees
from dashpot.export import radioss as _radioss
from dashpot.export import statespace as _statespace
from dashpot.export.deck import DeckText
from dashpot.export.hyperelastic import hyperelastic_card
from dashpot.export.notation import UNIT_SYSTEMS
from dashpot.export.opening import PROBLEMS
from dashpot.kinds.hyperelastic.record import HyperelasticFit
from dashpot.kinds.level.levels import LevelFit
from dashpot.records.fit import Fit

_MODULES = {
    module.__name__.rpartition(".")[2]: module
    for module in (
        _nastran, _abaqus, _ansys, _lsdyna, _calculix, _opensees, _adams, _csv, _radioss,
        _statespace,
    )
}  # fmt: skip
FORMS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {name: module.FORMS for name, module in _MODULES.items()}
)
"""The forms each target can write; the first is what it writes if not told."""

nastran = _nastran.nastran
abaqus = _abaqus.abaqus
ansys = _ansys.ansys
lsdyna = _lsdyna.lsdyna
calculix = _calculix.calculix
opensees = _opensees.opensees
adams = _adams.adams
csv = _csv.csv
radioss = _radioss.radioss
statespace = _statespace.statespace

TARGETS: Mapping[str, Callable[..., DeckText]] = MappingProxyType(
    {name: getattr(module, name) for name, module in _MODULES.items()}
)
"""Every target by its name on the command line."""


def deck_for(
    target: str,
    found: Fit | LevelFit | HyperelasticFit,
    *,
    seals: float = 1.0,
    compression: float | None = None,
    temperature: float | None = None,
    **choices: object,
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
        return hyperelastic_card(target, found, temperature=temperature, **made)  # type: ignore[arg-type]
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
