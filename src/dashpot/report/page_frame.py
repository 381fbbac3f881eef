"""Frame of every page: templates, security policy and attached files."""

from __future__ import annotations

import base64
import hashlib
import shlex
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from dashpot.base import dataclass, field, number_format
from dashpot.base.checks import Use, Verdict
from dashpot.base.errors import ExportError
from dashpot.base.number_format import format_band
from dashpot.base.plain_text import sentence
from dashpot.base.units import convert_to_unit
from dashpot.base.version import byline, software
from dashpot.datamodel.fit import Fit
from dashpot.export import SUFFIXES, DeckText, deck_for, uses_argument
from dashpot.export.deck import NonlinearFit
from dashpot.export.frequency_tables import round_band_inwards
from dashpot.plot import style as drawing_style
from dashpot.registry import require_handler

if TYPE_CHECKING:
    from jinja2 import Environment


# Templates, filters, marks and security policy.


VERDICT_COLOURS: dict[Use, str] = {
    "use": "good", "no test": "note", "use with care": "care", "do not use": "bad",
}  # fmt: skip
"""The style of each verdict; its text is next to the colour."""


@cache
def environment(package: str) -> Environment:
    """The templates of a package, and the shared ones; inserted text is escaped."""
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    result = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader("dashpot.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    result.filters.update(
        words=number_format.split_identifier,
        sentence=sentence,
        readable=number_format.format_typographic,
        shorter=number_format.shorten_number,
        rounded=number_format.round_to_error,
        hertz=number_format.hertz,
    )
    return result


def render_template(name: str, contents: dict[str, Any]) -> str:
    """Return a page of the core's own templates as HTML."""
    return str(environment("dashpot.report").get_template(name).render(contents))


@cache
def _read_page_part(package: str, *path: str) -> str:
    """Return the file of a part of a page other than HTML."""
    return resources.files(package).joinpath(*path).read_text("utf-8").strip()


def frame() -> dict[str, Any]:
    """Return the common parts of every page: style, script, policy, software versions."""
    style = f"{drawing_style.css()}\n{_read_page_part('dashpot.report', 'templates', 'report.css')}"
    name = _read_page_part("dashpot.report", "templates", "report.js")
    # the one page holds the modules one after the other, so the second imports nothing
    script = f"{_read_page_part('dashpot.plot', 'charts.js')}\n{name.partition(chr(10))[2]}"
    return {
        "byline": byline("report"),
        "style": style,
        "script": script,
        "policy": f"default-src 'none'; img-src data:; style-src {digest(style)}; "
        f"script-src {digest(script)}; base-uri 'none'; form-action 'none'",
        "versions": software().items(),
    }


def encode_data_uri(kind: str, text: str) -> str:
    """Return a link with the file embedded."""
    return f"data:{kind};base64,{base64.b64encode(text.encode()).decode()}"


def digest(text: str) -> str:
    """Return the hash of a script or style for the content security policy."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


# Attached files: documents, tables, and decks with their command.


_UNIT_SYSTEM = "mm-t-s"
_SOLVERS = {"nastran": "Nastran", "abaqus": "Abaqus"}
"""Decks of a page, and the text of their links."""
_SPECIMEN_DATA = {"temperature": "temperature", "length": "contact length"}
"""Data of the specimen that a deck should state; it is marked without."""


class DeckSource(Protocol):
    """Result whose page holds decks."""

    @property
    def verdict(self) -> Verdict: ...  # noqa: D102


@dataclass(frozen=True)
class DeckTerms:
    """Options of the decks on the page of a result.

    Attributes
    ----------
    band : (float, float) or None
        Where they hold, Hz; None of a law without frequencies.
    choices : mapping of str to str
        Options of the target.
    allowed_unknowns : tuple of str
        Missing data of the specimen, allowed by name.
    reason : str
        Reason for a missing deck.
    """

    band: tuple[float, float] | None
    choices: Mapping[str, str] = field(default_factory=dict)
    allowed_unknowns: tuple[str, ...] = ()
    reason: str = "the tests do not determine every parameter"


class Attachment(NamedTuple):
    """File attached to the page.

    Attributes
    ----------
    name : str
        File name.
    label : str
        Text of its link.
    about : str
        Contents.
    link : str
        Its bytes as a data URI: no server, a link that holds its file.
    """

    name: str
    label: str
    about: str
    link: str


def attachment(name: str, label: str, description: str, kind: str, text: str) -> Attachment:
    """Return a text as a file inside the page."""
    return Attachment(name, label, description, encode_data_uri(kind, text))


class AttachedDeck(NamedTuple):
    """Deck attached to the page, and the command that makes it from the result's document.

    Attributes
    ----------
    target : str
    text : DeckText
    options : tuple of str
        Options of ``dashpot export FILE``.
    """

    target: str
    text: DeckText
    options: tuple[str, ...]


def find_terms(result: Fit | NonlinearFit) -> DeckTerms:
    """Return the options of a fit's decks: those of a part, or of a material."""
    material = isinstance(result, Fit) and result.unit == "Pa"
    conditions_wanted = ["temperature"] if material else list(_SPECIMEN_DATA)
    unstated = tuple(name for name in conditions_wanted if getattr(result.specimen, name) is None)
    return DeckTerms(result.band, {"form": "prony"} if material else {}, unstated)


def _find_deck_terms(source: DeckSource) -> DeckTerms:
    terms: DeckTerms = require_handler("deck terms", source)(source)
    return terms


def decks(source: DeckSource, compression: float | None = None) -> tuple[AttachedDeck, ...]:
    """Decks of one seal, or cards of a material, over the band of its tests and no further.

    Missing data of the specimen are allowed by name, so each deck lists them in its header. A deck
    is omitted if the model may not be used, is not identified, or lacks a number.

    Parameters
    ----------
    source : Fit or another result that a row names
    compression : float, optional
        About which the deck is of small vibration, m.
    """
    if source.verdict.use == "do not use":
        return ()
    deck_arguments: dict[str, Any] = {}
    options = ["--unit-system", _UNIT_SYSTEM]
    if compression is not None:
        depth = f"{round(convert_to_unit(compression, 'mm'), 4)}mm"
        deck_arguments["compression"] = depth
        options += ["--compression", depth]
    terms = _find_deck_terms(source)
    deck_arguments |= terms.choices
    options += [word for name, value in terms.choices.items() for word in (f"--{name}", value)]
    band_argument: dict[str, Any] = {}
    if terms.band and not terms.choices:
        band_argument["frequency_range"] = round_band_inwards(terms.band)
    options += [word for name in terms.allowed_unknowns for word in ("--allow", name)]
    attached = []
    for target in _SOLVERS:
        band = band_argument if uses_argument(target, "frequency_range") else {}
        try:
            text = deck_for(
                target,
                source,
                units=_UNIT_SYSTEM,
                allow=terms.allowed_unknowns,
                **deck_arguments,
                **band,
            )
        except ExportError:
            continue
        band_words = [
            word for low, high in band.values() for word in ("--band", f"{low!r}:{high!r}Hz")
        ]
        attached.append(AttachedDeck(target, text, ("--to", target, *options, *band_words)))
    return tuple(attached)


def format_deck_note(source: DeckSource, decks: Sequence[AttachedDeck]) -> str:
    """Return the note on the validity of the decks, or why there is none."""
    if source.verdict.use == "do not use":
        return ""
    terms = _find_deck_terms(source)
    if not decks:
        return f"No solver input is here, because {terms.reason}."
    unstated_words = " and ".join(
        words for name, words in _SPECIMEN_DATA.items() if name in decks[0].options
    )
    remark = f" Before you use one, state {unstated_words}." if unstated_words else ""
    return (
        f"Solver inputs are valid {format_band(terms.band)}.{remark}"
        if terms.band
        else remark.strip()
    )


def attach_decks(decks: Sequence[AttachedDeck], document: str) -> list[Attachment]:
    """Decks as files inside the page, each with its command of the result's document."""
    files = []
    for i, (target, text, options) in enumerate(decks):
        command = shlex.join(("dashpot", "export", document, *options))
        files.append(
            attachment(
                f"model.{SUFFIXES[target]}",
                _SOLVERS[target] + " input" * (i == 0),
                f"deck, {_UNIT_SYSTEM}; the same as {command}",
                "text/plain",
                text,
            )
        )
    return files
