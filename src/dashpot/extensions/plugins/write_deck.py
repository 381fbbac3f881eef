"""Decks of plug-ins: the solid as plain numbers in, cards as text out."""

from __future__ import annotations

from collections.abc import Collection
from importlib import import_module

from dashpot.base.plain_text import escape_terminal_text
from dashpot.datamodel.specimen import Specimen
from dashpot.export.deck import DeckText, Exportable
from dashpot.export.deck_validation import Target, open_deck
from dashpot.extensions.plugins.contract import refuse_result
from dashpot.registry.plugins import Plugin

_FORM = "arms"
_COMMENT = "$"
"""The sign before a remark, where the module of the plug-in states no ``COMMENT``."""


def make_writer(plugin: Plugin) -> Target:
    """Return the function that writes the decks of a plug-in.

    Its function gets ``{"k_inf", "b", "k", "tau", "temperature", "length", "band", "verdict"}``,
    SI, the name of the unit system and its own name. dashpot writes the kind and the origin of the
    deck above it.
    """

    def write(
        solid: Exportable,
        *,
        units: str | None = None,
        specimen: Specimen | None = None,
        allow: Collection[str] = (),
        form: str = _FORM,
    ) -> DeckText:
        deck = open_deck(
            solid, plugin.name, form, (_FORM,), units=units, specimen=specimen, allow=allow
        )
        function = plugin.load()
        model = deck.model
        parameters = {
            "k_inf": float(model.k_inf), "b": float(model.b), "k": list(map(float, model.k)),
            "tau": list(map(float, model.tau)), "temperature": deck.specimen.temperature,
            "length": deck.specimen.length, "band": deck.band and list(deck.band),
            "verdict": deck.fit.verdict.use if deck.fit else None,
        }  # fmt: skip
        try:
            cards = function(parameters, units=deck.units.name, name=plugin.name)
        except Exception as error:  # noqa: BLE001  others' code may raise anything
            plugin.raise_failure(error)
        if not isinstance(cards, str) or not cards.strip():
            text = "an empty text" if isinstance(cards, str) else f"a {type(cards).__name__}"
            refuse_result(plugin, text, "the cards of a deck as one text")
        comment = getattr(import_module(plugin.value.partition(":")[0]), "COMMENT", _COMMENT)
        return deck.format_text(
            str(comment),
            f"deck by {plugin.label}",
            escape_terminal_text(cards).splitlines(),
            verified=f"not verified by dashpot: written by {plugin.label}",
        )

    return write  # type: ignore[return-value]  # a plug-in has no options of its own
