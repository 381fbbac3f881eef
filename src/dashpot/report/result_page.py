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
    result: Any, *, lead: Picture | None = None, pictures: Sequence[Picture] = ()
) -> dict[str, Any]:
    """What the page of a result of a kind holds.

    Parameters
    ----------
    result
        It was judged.
    lead : Picture, optional
        The figure that answers, where more is known than `result` itself tells.
    pictures : sequence of Picture
        Figures of the records behind it, which are folded.
    """
    page = kind_page(result)
    figure = lead or page.picture
    folds = (
        *(CollapsibleSection("The test", picture.caption, None, picture) for picture in pictures),
        *page.folds,
    )
    names = dict.fromkeys(source.file for source in page.sources)
    document = f"{page.name}.json"
    text = text_of(result.kept)
    sentence = "every number" if result.kept is result else "the fit, for other commands"
    files = [attachment(document, f"Download {document}", sentence, "application/json", text)]
    behind = attachments.load_exportable(text)
    decks = () if behind is None else attachments.decks(behind)
    files += attachments.attach_decks(decks, document)
    if result.kept is not result:
        whole = text_of(result)
        files.append(attachment(_ALL, _ALL, "every number", "application/json", whole))
    return {
        **judgement(page.name, result.verdict, result.checks, page.sources),
        "title": ", ".join(names) or page.about,
        "page": page,
        "figures": {"lead": _wide(figure, "lead")}
        | {
            f"fold{i}": _wide(fold.picture, f"fold{i}")
            for i, fold in enumerate(folds)
            if fold.picture
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
    also = [check for check in every if check.failed and check not in verdict.because]
    return {
        **frame(),
        "verdict": verdict,
        "colour": COLOURS[verdict.use],
        "weighty": (*verdict.because, *also),
        "tally": tally(every, every),
        "checks": tables.checks([(name, every)], every),
        "sources": sources,
        "simulated": list(dict.fromkeys(source.file for source in sources if source.simulated)),
    }


def _wide(picture: Picture, name: str) -> RenderedFigure:
    """A figure for the 760 px of a page, or for less."""
    columns = min(picture.columns, len(picture.strips), _COLUMNS)
    ratio = (LEAD - 24 * (columns - 1)) / columns
    return render_figure(replace(picture, name=name, columns=columns), width=ratio)


def has_kind_page(result: object) -> bool:
    """Whether a result has all that its page holds."""
    try:
        return isinstance(kind_page(result), KindPage)
    except TypeError:
        return False


def text_of(document: Serialisable) -> str:
    """The JSON that ``dashpot fit --json`` prints."""
    return json.dumps(document.document, indent=2, ensure_ascii=False, allow_nan=False)
