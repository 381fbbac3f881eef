"""Solver inputs (decks): a solid as text for a finite-element or multibody solver.

Every target is a function ``target(solid, *, units, specimen, allow, form, ...)`` of a
bare :class:`~dashpot.solids.maxwell.Solid` or of a
:class:`~dashpot.datamodel.fit.Fit`, whose source and checks the header lists.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from importlib import import_module
from inspect import signature
from typing import Any

from dashpot.base.errors import ExportError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.specimen import Specimen
from dashpot.export.deck import DeckText
from dashpot.export.deck_validation import PROBLEMS, get_option_name
from dashpot.export.unit_systems import UNIT_SYSTEMS
from dashpot.registry import SOLVER_INPUTS, SOLVER_NAMES, find_handler, require_handler
from dashpot.solids.maxwell import Solid


class _SolverAttribute(Mapping[str, Any]):
    """Attribute of the module of each solver, by default its writer; imported when used."""

    def __init__(self, attribute: str = "", *default: object) -> None:
        self._attribute, self._default = attribute, default

    def __getitem__(self, name: str) -> Any:
        module = import_module(SOLVER_INPUTS[name].module)
        return getattr(module, self._attribute or name, *self._default)

    def __iter__(self) -> Iterator[str]:
        return iter(SOLVER_INPUTS)

    def __len__(self) -> int:
        return len(SOLVER_INPUTS)


FORMS: Mapping[str, tuple[str, ...]] = _SolverAttribute("FORMS")
"""Forms that each target can write; the first is the default."""

SUFFIXES: Mapping[str, str] = _SolverAttribute("SUFFIX")
"""File ending of the decks of each target."""

NEEDS: Mapping[str, Mapping[str, tuple[str, ...]]] = _SolverAttribute("NEEDS", {})
"""Arguments that a form of a target requires."""

TARGETS: Mapping[str, Callable[..., DeckText]] = _SolverAttribute()
"""Every target by its name on the command line."""


def __getattr__(name: str) -> Callable[..., DeckText]:
    """Return the writer of a target: ``export.nastran``."""
    if name not in TARGETS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return TARGETS[name]


def _format_unsupported_option(name: str, *, alternative: bool) -> str:
    """Return the option of an argument that a target lacks, and which other targets have it."""
    other_targets = [text for text in TARGETS if name in signature(TARGETS[text]).parameters]
    hint = f". Those of {', '.join(other_targets)} do" if other_targets and alternative else ""
    return get_option_name(name) + hint


def uses_argument(target: str, argument: str) -> bool:
    """Return whether a target, in its usual form, uses an argument."""
    write = TARGETS[target]
    forms_by_argument: Mapping[str, tuple[str, ...]] = write.only  # type: ignore[attr-defined]
    return argument in signature(write).parameters and (
        FORMS[target][0] in forms_by_argument.get(argument, FORMS[target])
    )


def deck_for(
    target: str,
    result: object,
    *,
    seals: float = 1.0,
    compression: float | None = None,
    temperature: float | None = None,
    **choices: object,
) -> DeckText:
    """Return the deck of a fit for one of :data:`TARGETS`, of `seals` seals in parallel.

    Parameters
    ----------
    target : str
        Or a synonym of it, such as ``"mapdl"``, in upper or lower case.
    result : Solid, Fit or another result that a row names
        Result of one seal, or of a material, whose card is written.
    seals : float
    compression : float, optional
        Compression of the seals, m: the deck is of small vibration about it.
    temperature : float, optional
        Temperature of the seals, K; by default that of the fit.
    **choices
        Arguments of the target; None is the same as omitted.

    Raises
    ------
    ExportError
        If the target is unknown, does not have such an option, or refuses the fit.
    """
    target = SOLVER_NAMES.get(target.lower(), target)
    find_writer(target)
    export = find_handler("export", result)
    if export is None:
        raise ExportError(
            f"a {type(result).__name__} is neither a fit nor a model. Fit a test first: "
            "dp.fit(dp.read(FILE)); read a stored fit: dp.read(FIT)"
        )
    given_options = {name: value for name, value in choices.items() if value is not None}
    deck: DeckText = export(
        target,
        result,
        seals=seals,
        compression=compression,
        temperature=temperature,
        **given_options,
    )
    return deck


def refuse_unused_options(
    target: str, write: Callable[..., DeckText], choices: Collection[str], *, outside: bool = True
) -> None:
    """Raise where the writer of a deck does not take an option.

    Raises
    ------
    ExportError
        The message lists the solvers whose decks take it if `outside`.
    """
    parameters = signature(write).parameters
    for name in choices:
        if name not in parameters:
            raise ExportError(
                f"{target} decks take no {_format_unsupported_option(name, alternative=outside)}"
            )


def export_solid(
    target: str,
    solid: Solid,
    *,
    seals: float,
    compression: float | None,
    temperature: float | None,
    **choices: object,
) -> DeckText:
    """Return the deck of `seals` models in parallel."""
    write = find_writer(target)
    refuse_unused_options(target, write, choices)
    if compression is not None:
        raise ExportError("a model in memory has no elastic law; leave out --compression")
    choices.setdefault("specimen", Specimen(temperature=temperature))
    return write(seals * solid, **choices)


def export_fit(
    target: str,
    fit: Fit,
    *,
    seals: float,
    compression: float | None,
    temperature: float | None,
    **choices: object,
) -> DeckText:
    """Return the deck of the fit of `seals` seals in parallel, at a compression."""
    write = find_writer(target)
    refuse_unused_options(target, write, choices)
    loaded_fit = fit if compression is None else fit.at_compression(compression)
    if seals != 1:
        loaded_fit = loaded_fit.in_parallel(seals)
    if temperature is not None:
        choices["specimen"] = replace(loaded_fit.specimen, temperature=temperature)
    return write(loaded_fit, **choices)


def find_writer(target: str) -> Callable[..., DeckText]:
    """Return the writer of a solver's decks, built in or of a plug-in.

    Raises
    ------
    ExportError
        If there is no such solver.
    """
    if target in TARGETS:
        return TARGETS[target]
    from dashpot.registry.plugins import find_plugin, format_plugin_names

    plugin = find_plugin("solver_inputs", target)
    if plugin is None:
        raise ExportError(
            f"'{target}' is no solver; expected one of {', '.join(TARGETS)}."
            f"{format_plugin_names('solver_inputs')}".rstrip(".")
        )
    write: Callable[..., DeckText] = require_handler("solver input", plugin)(plugin)
    return write


__all__ = [
    "FORMS", "NEEDS", "PROBLEMS", "SUFFIXES", "TARGETS", "UNIT_SYSTEMS", "DeckText", "deck_for",
    "export_fit", "export_solid", "find_writer", "refuse_unused_options",
    "uses_argument",
]  # fmt: skip
