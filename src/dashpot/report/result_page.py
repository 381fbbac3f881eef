"""The page of a result that was judged: one grammar for every kind."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from dashpot.base.checks import Check, Verdict
from dashpot.base.provenance import Source
from dashpot.base.serialisation import Serialisable
from dashpot.plot.picture import Picture
from dashpot.report import attachments, tables
from dashpot.report.attachments import attachment
from dashpot.report.figures import LEAD, RenderedFigure, render_figure
from dashpot.report.first_screen import tally
from dashpot.report.page_content import CollapsibleSection, KindPage, kind_page
from dashpot.report.page_frame import COLOURS, frame

_COLUMNS = 2
"""Strips side by side in the figure of a page, at most."""


_ALL = "numbers.json"
"""Every number of a result of which a file keeps the fit."""


def build_page_contents(
    found: Any, *, lead: Picture | None = None, beside: Sequence[Picture] = ()
) -> dict[str, Any]:
    """What the page of a result of a kind holds.

    Parameters
    ----------
    found
        It was judged.
    lead : Picture, optional
        The figure that answers, where more is known than `found` itself tells.
    beside : sequence of Picture
        Figures of the records behind it, which are folded.
    """
    page = kind_page(found)
    figure = lead or page.picture
    folds = (
        *(CollapsibleSection("The test", one.caption, None, one) for one in beside),
        *page.folds,
    )
    names = dict.fromkeys(one.file for one in page.sources)
    document = f"{page.name}.json"
    text = text_of(found.kept)
    told = "every number" if found.kept is found else "the fit, for other commands"
    files = [attachment(document, f"Download {document}", told, "application/json", text)]
    behind = attachments.load_exportable(text)
    decks = () if behind is None else attachments.decks(behind)
    files += attachments.attach_decks(decks, document)
    if found.kept is not found:
        whole = text_of(found)
        files.append(attachment(_ALL, _ALL, "every number", "application/json", whole))
    return {
        **judgement(page.name, found.verdict, found.checks, page.sources),
        "title": ", ".join(names) or page.about,
        "page": page,
        "figures": {"lead": _wide(figure, "lead")}
        | {
            f"fold{i}": _wide(one.picture, f"fold{i}") for i, one in enumerate(folds) if one.picture
        },
        "folds": folds,
        "files": files,
        "about_decks": "" if behind is None else attachments.format_deck_note(behind, decks),
    }


def judgement(
    name: str, verdict: Verdict, checks: Sequence[Check], sources: Sequence[Source]
) -> dict[str, Any]:
    """What every page of a judged result holds: verdict, checks, files behind it."""
    every = tuple(dict.fromkeys(checks))
    also = [one for one in every if one.failed and one not in verdict.because]
    return {
        **frame(),
        "verdict": verdict,
        "colour": COLOURS[verdict.use],
        "weighty": (*verdict.because, *also),
        "tally": tally(every, every),
        "checks": tables.checks([(name, every)], every),
        "sources": sources,
        "simulated": list(dict.fromkeys(one.file for one in sources if one.simulated)),
    }


def _wide(picture: Picture, name: str) -> RenderedFigure:
    """A figure for the 760 px of a page, or for less."""
    columns = min(picture.columns, len(picture.strips), _COLUMNS)
    each = (LEAD - 24 * (columns - 1)) / columns
    return render_figure(replace(picture, name=name, columns=columns), width=each)


def has_kind_page(found: object) -> bool:
    """Whether a result has all that its page holds."""
    try:
        return isinstance(kind_page(found), KindPage)
    except TypeError:
        return False


def text_of(found: Serialisable) -> str:
    """The JSON that ``dashpot fit --json`` prints."""
    return json.dumps(found.document, indent=2, ensure_ascii=False, allow_nan=False)
