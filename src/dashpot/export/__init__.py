"""Decks: a solid as text for a solver, one target, one file.

Every target is a function ``target(solid, *, units, specimen, allow, form, ...)`` of a
bare :class:`~dashpot.solids.maxwell.Solid` or of a
:class:`~dashpot.datamodel.fit.Fit`, which brings its pedigree and must be worth exporting.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib import import_module
from inspect import signature
from types import MappingProxyType

from dashpot.base.choices import DECKS
from dashpot.base.errors import ExportError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.specimen import Specimen
from dashpot.export.deck import DeckText
from dashpot.export.deck_validation import PROBLEMS, option_of
from dashpot.export.unit_systems import UNIT_SYSTEMS
from dashpot.extensions.amplitude.level_results import LevelFit
from dashpot.extensions.materials.hyperelastic.datamodel import HyperelasticFit
from dashpot.extensions.materials.hyperelastic.material_cards import hyperelastic_card
from dashpot.registry import SOLVER_INPUTS
from dashpot.solids.maxwell import Solid

_MODULES = {name: import_module(SOLVER_INPUTS[name]) for name in DECKS}
FORMS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {name: module.FORMS for name, module in _MODULES.items()}
)
"""The forms each target can write; the first is what it writes if not told."""

SUFFIXES: Mapping[str, str] = MappingProxyType(
    {name: module.SUFFIX for name, module in _MODULES.items()}
)
"""Of the file that each target's decks are kept in."""

NEEDS: Mapping[str, Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {name: getattr(module, "NEEDS", {}) for name, module in _MODULES.items()}
)
"""Arguments that a form of a target cannot do without."""

TARGETS: Mapping[str, Callable[..., DeckText]] = MappingProxyType(
    {name: getattr(module, name) for name, module in _MODULES.items()}
)
"""Every target by its name on the command line."""


def __getattr__(name: str) -> Callable[..., DeckText]:
    """A target is an attribute, too: ``export.nastran``."""
    if name not in TARGETS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return TARGETS[name]


def _asked_as(name: str, *, elsewhere: bool) -> str:
    """The option of an argument that a target lacks, and which other targets have it."""
    those = [one for one in TARGETS if name in signature(TARGETS[one]).parameters]
    more = f". Those of {', '.join(those)} do" if those and elsewhere else ""
    return option_of(name) + more


def reads(target: str, argument: str) -> bool:
    """Return whether a target, in its usual form, makes anything of an argument."""
    write = TARGETS[target]
    able: Mapping[str, tuple[str, ...]] = write.only  # type: ignore[attr-defined]
    return argument in signature(write).parameters and (
        FORMS[target][0] in able.get(argument, FORMS[target])
    )


def deck_for(
    target: str,
    found: Solid | Fit | LevelFit | HyperelasticFit,
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
    found : Solid or Fit or LevelFit or HyperelasticFit
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
    write = TARGETS.get(target) or _plugged(target)
    material = isinstance(found, HyperelasticFit)
    known = signature(hyperelastic_card if material else write).parameters
    made = {name: value for name, value in choices.items() if value is not None}
    for name in made:
        if name not in known:
            raise ExportError(f"{target} decks take no {_asked_as(name, elsewhere=not material)}")
    if isinstance(found, HyperelasticFit):
        if seals != 1 or compression is not None:
            raise ExportError("a material card takes no --seals and no --compression")
        return hyperelastic_card(target, found, temperature=temperature, **made)  # type: ignore[arg-type]
    if isinstance(found, Solid):
        if compression is not None:
            raise ExportError("a bare solid has no elastic law; leave out --compression")
        made.setdefault("specimen", Specimen(temperature=temperature))
        return write(seals * found, **made)
    here = _of_seals(found, seals, compression)
    if temperature is not None:
        made["specimen"] = replace(here.specimen, temperature=temperature)
    return write(here, **made)


def _of_seals(found: Fit | LevelFit, seals: float, compression: float | None) -> Fit | LevelFit:
    """The fit of so many seals, side by side, at a compression."""
    if compression is not None:
        if isinstance(found, LevelFit):
            raise ExportError("FRFs at levels are of one compression; leave out --compression")
        found = found.at_compression(compression)
    return found if seals == 1 else found.in_parallel(seals)


def _plugged(target: str) -> Callable[..., DeckText]:
    """The target that a plug-in brings."""
    from dashpot.base.plugins import named, offered_too
    from dashpot.export.plugin_decks import target_of

    plugin = named("decks", target)
    if plugin is None:
        raise ExportError(
            f"'{target}' is no solver; expected one of {', '.join(TARGETS)}."
            f"{offered_too('decks')}".rstrip(".")
        )
    return target_of(plugin)


__all__ = [
    "FORMS", "NEEDS", "PROBLEMS", "SUFFIXES", "TARGETS", "UNIT_SYSTEMS", "DeckText", "deck_for",
    "hyperelastic_card", "reads",
]  # fmt: skip
