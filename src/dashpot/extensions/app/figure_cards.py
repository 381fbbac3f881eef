"""Cards of a page: their layout side by side, and shared keys."""

from __future__ import annotations

import re
from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from typing import NamedTuple

from dashpot.extensions.app.view_models import render_template
from dashpot.plot.picture import Panel, Picture
from dashpot.plot.svg import strip, swatch
from dashpot.report.result_page import AppCard
from dashpot.report.tables import TextTable

TWO, CARD = 700.0, 18.0
"""Width of two cards side by side, and width of a card's border, px."""


class FigureCard(NamedTuple):
    """Card of a page: its title, its contents, and how many are side by side."""

    title: str
    html: str
    across: int = 1


def draw_cards(cards: Sequence[AppCard], width: float) -> list[FigureCard]:
    """Return what an extension shows, as cards; of a drawing with a title the first strip alone."""
    drawn: list[FigureCard] = []
    for title, content, across in cards:
        if isinstance(content, Picture):
            strips = make_figure_cards(content, width)
            drawn += [strips[0]._replace(title=title)] if title else strips
        elif isinstance(content, TextTable):
            html = render_template("cells", head=content.head, rows=content.rows)
            drawn.append(FigureCard(title, html, across))
        elif isinstance(content, str):
            drawn.append(FigureCard(title, content, across))
        else:
            drawn.append(FigureCard(title, small_multiples(content, "shape", width), across))
    return drawn


def make_figure_cards(picture: Picture, width: float) -> list[FigureCard]:
    """A card for each strip of a picture, two in a row; one for more than two that are alike."""
    cards: list[FigureCard] = []
    # what is named at its line in one card is in no key of the others
    key = {mark.label for mark in picture.key}
    for row in _rows(picture):
        name = f"bench{len(cards)}"
        if len(row) > 2:
            svg = small_multiples([panel for (panel,) in row], name, width)
            cards.append(FigureCard(re.split("[:,]", picture.caption)[0], svg))
        else:
            cards += [
                _card(f"{name}-{i}", panels, width, len(row), key) for i, panels in enumerate(row)
            ]
    return cards


def _rows(picture: Picture) -> list[tuple[tuple[Panel, ...], ...]]:
    """The strips that stand beside each other: all that are alike, of three others the last two."""
    strips = picture.strips
    if picture.rows:
        return [row for _, row in picture.strip_rows]
    if len(strips) > 2 and _are_alike(strips):
        return [strips[i : i + 3] for i in range(0, len(strips), 3)]
    odd = len(strips) % 2
    return [strips[:odd]] * odd + [strips[i : i + 2] for i in range(odd, len(strips), 2)]


def _are_alike(strips: tuple[tuple[Panel, ...], ...]) -> bool:
    """Return whether each is one panel, and all show the same quantity or the same marks."""
    shown = {panels[0].y.label for panels in strips}
    marks = {tuple(mark.label for mark in Picture("", "", (panels,)).key) for panels in strips}
    return all(len(panels) == 1 for panels in strips) and 1 in {len(shown), len(marks)}


def _card(
    name: str, panels: tuple[Panel, ...], width: float, across: int, key: AbstractSet[str]
) -> FigureCard:
    """One strip under its title; an axis that says no more than the title is named there."""
    first, *below = panels
    bare = not (first.title or first.note or first.drawing)
    title = first.title or (first.y.label if bare else first.y.label.partition(",")[0])
    drawing = (replace(first, title="", without_y_label=bare), *below)
    across = across if width >= TWO else 1
    svg = strip(drawing, name=name, width=(width - 8 * (across - 1)) / across - CARD, kind="figure")
    samples = [sample for sample in _samples(drawing, name) if sample[1] in key]
    html = render_template("figure", key=samples, svg=svg, title="", note="")
    return FigureCard(title[:1].upper() + title[1:], html, across)


def _samples(panels: Sequence[Panel], name: str) -> list[tuple[str, str]]:
    """Return what each mark looks like, and its name."""
    key = Picture(name, "", (tuple(panels),)).key
    return [(swatch(mark, name=f"{name}-k{i}"), mark.label) for i, mark in enumerate(key)]


def small_multiples(panels: Sequence[Panel], name: str, width: float) -> str:
    """Panels of one kind under one key, all in a row, or two where that is too narrow."""
    many = len(panels) if width >= TWO else 2
    ratio = (width - CARD - 8 * (many - 1)) / many
    drawn = []
    for i, panel in enumerate(panels):
        (left, right), (low, high) = panel.x.limits, panel.y.limits
        most = ratio * (high - low) / (right - left) if panel.square else panel.height
        low_one = replace(panel, height=min(panel.height, most))
        drawn.append(strip((low_one,), name=f"{name}-{i}", width=ratio, kind="figure"))
    return render_template("shapes", key=_samples(panels, name), drawn=drawn, two=many == 2)
