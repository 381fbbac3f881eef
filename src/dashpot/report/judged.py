"""The page of a result that was judged: one grammar for every kind."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from dashpot.base.documents import Documented
from dashpot.plot.picture import Picture
from dashpot.report import attached
from dashpot.report.answer import tally
from dashpot.report.attached import attachment
from dashpot.report.figures import LEAD, Drawn, drawn
from dashpot.report.kind_page import Fold, KindPage, kind_page
from dashpot.report.pages import COLOURS, frame
from dashpot.report.tables import checks

_COLUMNS = 2
"""Strips side by side in the figure of a page, at most."""


_ALL = "numbers.json"
"""Every number of a result of which a file keeps the fit."""


def contents(
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
    folds = (*(Fold("The test", one.caption, None, one) for one in beside), *page.folds)
    names = dict.fromkeys(one.file for one in page.sources)
    weighed = found.verdict.because
    also = [one for one in dict.fromkeys(found.checks) if one.failed and one not in weighed]
    document = f"{page.name}.json"
    text = text_of(found.kept)
    told = "every number" if found.kept is found else "the fit, for other commands"
    files = [attachment(document, f"Download {document}", told, "application/json", text)]
    behind = attached.exported(text)
    decks = () if behind is None else attached.decks(behind)
    files += attached.attached(decks, document)
    if found.kept is not found:
        whole = text_of(found)
        files.append(attachment(_ALL, _ALL, "every number", "application/json", whole))
    return {
        **frame(),
        "title": ", ".join(names) or page.about,
        "page": page,
        "verdict": found.verdict,
        "colour": COLOURS[found.verdict.use],
        "figures": {"lead": _wide(figure, "lead")}
        | {
            f"fold{i}": _wide(one.picture, f"fold{i}") for i, one in enumerate(folds) if one.picture
        },
        "folds": folds,
        "weighty": (*weighed, *also),
        "tally": tally(dict.fromkeys(found.checks), found.checks),
        "checks": checks([(page.name, found.checks)], found.checks),
        "sources": page.sources,
        "simulated": list(dict.fromkeys(one.file for one in page.sources if one.simulated)),
        "files": files,
        "about_decks": "" if behind is None else attached.about(behind, decks),
    }


def _wide(picture: Picture, name: str) -> Drawn:
    """A figure for the 760 px of a page, or for less."""
    columns = min(picture.columns, len(picture.strips), _COLUMNS)
    each = (LEAD - 24 * (columns - 1)) / columns
    return drawn(replace(picture, name=name, columns=columns), width=each)


def paged(found: object) -> bool:
    """Whether a result has all that its page holds."""
    try:
        return isinstance(kind_page(found), KindPage)
    except TypeError:
        return False


def text_of(found: Documented) -> str:
    """The JSON that ``dashpot fit --json`` prints."""
    return json.dumps(found.document, indent=2, ensure_ascii=False, allow_nan=False)
